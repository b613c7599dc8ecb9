//! The brain in its shell, with the witness of promises R4 and R6 on its pulses.

use gait_player::storage::{MAX_SETTINGS, MemoryStorage, PAGE, Storage};
use gait_player::{
    Boot, Brain, BrainConfig, Identity, Inputs, Limits, Output, ShortStarts, TICK_US, Transport,
};
use link_protocol::{Board, Checked, FirmwareVersion, ResetReason, StateName};

/// The robot: brain, storage that outlives resets, and a clock that starts anew with each.
pub struct FuzzedRobot {
    brain: Brain,
    pub storage: MemoryStorage,
    pub inputs: Inputs,
    now_us: u64,
    starts: u16,
    last: Option<Output>,
    /// An arm has reached the robot since it last stood in a latched stop.
    pub armed: bool,
    /// A servo's map or limits were changed: the largest step is no longer known.
    pub remapped: bool,
}

impl Default for FuzzedRobot {
    fn default() -> Self {
        let boot = Boot::power_on(1, 0x1000);
        Self {
            brain: brain(boot),
            storage: MemoryStorage::erased(),
            inputs: Inputs {
                battery_mv: Some(5_000),
                link_up: true,
                ..Inputs::default()
            },
            now_us: 0,
            starts: 0,
            last: None,
            armed: false,
            remapped: false,
        }
    }
}

fn brain(boot: Boot) -> Brain {
    let firmware = FirmwareVersion {
        major: 0,
        minor: 1,
        patch: 0,
        commit: [0; 8],
    };
    Brain::new(BrainConfig::robot(
        Identity {
            firmware,
            board: Board::Twin,
        },
        boot,
    ))
}

impl FuzzedRobot {
    /// Bytes from the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.brain.receive(self.now_us, Transport::Uart, bytes);
    }

    /// Table and settings as a play must name them.
    pub fn held(&self) -> Checked {
        self.brain.held()
    }

    /// The robot's clock, µs.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Bytes to the line.
    pub fn transmit(&mut self, out: &mut Vec<u8>) {
        let mut bytes = [0; 64];
        loop {
            let count = self.brain.transmit(Transport::Uart, &mut bytes);
            if count == 0 {
                return;
            }
            out.extend_from_slice(&bytes[..count]);
        }
    }

    /// The next tick, `late_us` after it is due, and a step of storing where the brain wants one.
    pub fn tick(&mut self, late_us: u32) -> Output {
        self.now_us += u64::from(TICK_US) + u64::from(late_us);
        let output = self.brain.tick(self.now_us, &self.inputs);
        self.witness(&output, late_us);
        if output.storage_wanted {
            assert_eq!(
                output.pulses_ns, None,
                "storing while the servos are powered"
            );
            let _ = self.brain.serve_storage(self.now_us, &mut self.storage);
        }
        output
    }

    /// A reset, or a power cut (which forgets what the watchdog's registers keep).
    pub fn reset(&mut self, reset_reason: ResetReason) {
        self.starts = self.starts.wrapping_add(1);
        let kept = match (reset_reason, &self.last) {
            (ResetReason::PowerOn, _) | (_, None) => 0,
            (_, Some(output)) => output.kept,
        };
        let boot = Boot {
            reset_reason,
            kept,
            ..Boot::power_on(u32::from(self.starts), self.starts << 8)
        };
        self.brain = brain(boot);
        let _ = self.brain.load(&mut self.storage);
        self.now_us = 0;
        self.last = None;
        self.armed = false;
        let output = self.tick(0);
        assert_eq!(output.pulses_ns, None, "a reset powers the servos");
    }

    /// R4: window and step. R6: no pulses out of a latched stop without an arm.
    fn witness(&mut self, output: &Output, late_us: u32) {
        let limits = Limits::ROBOT;
        if let Some(pulses) = output.pulses_ns {
            let window = limits.pulse_min_ns..=limits.pulse_max_ns;
            assert!(
                pulses.iter().all(|pulse| window.contains(pulse)),
                "outside the window: {pulses:?}"
            );
        }
        let latched = |state| matches!(state, StateName::Stopped | StateName::EStopped);
        if let Some(last) = self.last {
            if let (Some(before), Some(now), false) =
                (last.pulses_ns, output.pulses_ns, self.remapped)
            {
                let step = gait_player::servo::ServoMap::ROBOT.step_ns(limits.max_step());
                assert!(
                    (0..2).all(|joint| now[joint].abs_diff(before[joint]) <= step),
                    "a step from {before:?} to {now:?} after {late_us} µs more than a tick"
                );
            }
            assert!(
                !latched(last.state) || latched(output.state) || self.armed,
                "from {:?} to {:?} without an arm",
                last.state,
                output.state
            );
        }
        if latched(output.state) {
            assert_eq!(output.pulses_ns, None, "pulses in {:?}", output.state);
            self.armed = false;
        }
        self.last = Some(*output);
    }
}

/// Storage with whatever a fuzzer puts there.
pub struct WildStorage<'a> {
    pub slots: &'a [u8],
    pub settings: &'a [u8],
}

impl Storage for WildStorage<'_> {
    type Error = ();

    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), ()> {
        for (index, byte) in bytes.iter_mut().enumerate() {
            *byte = self
                .slots
                .get(slot * 2560 + offset + index)
                .copied()
                .unwrap_or(0xFF);
        }
        Ok(())
    }

    fn erase(&mut self, _slot: usize) -> Result<(), ()> {
        Err(())
    }

    fn program(&mut self, _slot: usize, _page: usize, _bytes: &[u8; PAGE]) -> Result<(), ()> {
        Err(())
    }

    fn load_settings(&mut self, bytes: &mut [u8; MAX_SETTINGS]) -> Result<Option<usize>, ()> {
        let count = self.settings.len().min(MAX_SETTINGS);
        bytes[..count].copy_from_slice(&self.settings[..count]);
        Ok((count > 0).then_some(count))
    }

    fn save_settings(&mut self, _bytes: &[u8]) -> Result<(), ()> {
        Err(())
    }

    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, ()> {
        self.read(0, 0, bytes).map(|()| true)
    }

    fn save_starts(&mut self, _bytes: &[u8; ShortStarts::LEN]) -> Result<(), ()> {
        Err(())
    }
}

/// A brain that starts from this storage.
pub fn woken(storage: &mut WildStorage) -> Brain {
    let mut brain = brain(Boot::power_on(1, 0x1000));
    let _ = brain.load(storage);
    brain
}
