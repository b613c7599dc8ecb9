//! Status, telemetry and LED of the brain.

use super::outbox::What;
use super::state::State;
use super::{Brain, Transport};
use crate::TICK_US;
use link_protocol::{
    ANGLE_UNIT_RAD, Checked, Counters, DecodeCounters, Flags, Header, HelloReply, Joint, MAX_KNOTS,
    Message, PROTOCOL_CURRENT, PROTOCOL_MIN, RobotLimits, SCHEMA_KEY, StateName, Status, TableInfo,
    Telemetry,
};

/// Ticks between telemetry frames: 25 frames per second.
const TELEMETRY_TICKS: u64 = 2;
/// Most bytes of chunks in flight.
const UPLOAD_WINDOW: u16 = 1024;
/// Duration of the LED flash at a cycle's start, µs.
const FLASH_US: u32 = 100_000;

impl Brain {
    pub(super) fn hello_reply(&self, host_nonce: u32, session: u16) -> HelloReply {
        HelloReply {
            host_nonce,
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            firmware: self.identity.firmware,
            board: self.identity.board,
            reset_reason: self.boot.reset_reason,
            crash_message: !self.boot.crash_message.is_empty(),
            session,
            boot_nonce: self.session.boot_nonce(),
            limits: RobotLimits {
                max_angle: self.limits.max_angle,
                max_rate: self.limits.max_rate,
                pulse_min_ns: self.limits.pulse_min_ns,
                pulse_max_ns: self.limits.pulse_max_ns,
                max_knots: MAX_KNOTS as u16,
                upload_window: UPLOAD_WINDOW,
            },
            buffer: self.buffer,
        }
    }

    pub(super) fn status(&self, now_us: u64) -> Status {
        let (cycle, cycles, phase) = self.cycle();
        Status {
            robot_us: now_us,
            state: self.state.name(),
            cause: self.cause,
            flags: self.flags(now_us),
            cycle,
            cycles,
            period_us: self.last_play.map_or(0, |play| play.request.period_us),
            phase,
            setpoint: self.setpoint_units(),
            battery_mv: self.battery.mv(),
            table: self.table_info(),
            upload: self.tables.uploaded(),
            settings_crc32: self.settings_crc32(),
            estops: self.estops,
        }
    }

    /// Table and settings that a play must match. The table's checksum is 0 without a table.
    pub fn held(&self) -> Checked {
        Checked {
            table_crc32: self.tables.active_crc32().unwrap_or_default(),
            settings_crc32: self.settings_crc32(),
        }
    }

    /// E-stops since the start.
    pub fn estops(&self) -> u32 {
        self.estops
    }

    pub(super) fn table_info(&self) -> Option<TableInfo> {
        self.tables.info(self.persist.table_stored(), |facts| {
            facts.min_period_us(&self.limits)
        })
    }

    /// Counts of received, refused and dropped frames since the start.
    pub fn counters(&self) -> Counters {
        Counters {
            frames: self.frames(),
            dropped: self
                .outboxes
                .iter()
                .fold(0, |sum, outbox| sum.wrapping_add(outbox.dropped())),
            ..self.counted
        }
    }

    /// Decoder counters, summed over both transports.
    fn frames(&self) -> DecodeCounters {
        let [uart, usb] = [0, 1].map(|transport: usize| self.decoders[transport].counters());
        DecodeCounters {
            ok: uart.ok.wrapping_add(usb.ok),
            bad_crc: uart.bad_crc.wrapping_add(usb.bad_crc),
            overflow: uart.overflow.wrapping_add(usb.overflow),
            bad_cobs: uart.bad_cobs.wrapping_add(usb.bad_cobs),
            trailing_bytes: uart.trailing_bytes.wrapping_add(usb.trailing_bytes),
            not_understood: uart.not_understood.wrapping_add(usb.not_understood),
        }
    }

    fn flags(&self, now_us: u64) -> Flags {
        Flags::default()
            .with(Flags::BATTERY_LOW, self.battery.low())
            .with(Flags::RESET_LOOP, self.resets.wait_s().is_some())
            .with(Flags::LINK_SILENT, self.session.silent(now_us))
            .with(Flags::DETACHED, self.state.detached())
            .with(Flags::SWAP_PENDING, self.tables.swap().is_some())
            .with(Flags::UNSAVED, self.persist.unsaved())
            .with(Flags::CYCLE_FLASH, self.cycle_flash())
            .with(Flags::STORAGE_FAILED, self.persist.failed())
            .with(Flags::KEY_SET, self.settings.key.is_some())
            .with(
                Flags::PRESENT,
                self.bench.open(now_us) || self.session.transport() == Some(Transport::Usb),
            )
            .with(Flags::SHORT_STARTS, self.resets.locked_by_starts())
            .with(
                Flags::FRONT_PASSIVE,
                self.settings.passive == Some(Joint::Front),
            )
            .with(
                Flags::BACK_PASSIVE,
                self.settings.passive == Some(Joint::Back),
            )
    }

    /// Finished cycles, requested cycles, and fraction of the present cycle in 2⁻¹⁶.
    fn cycle(&self) -> (u32, u32, u16) {
        self.last_play.map_or((0, 0, 0), |play| {
            let phase = (u64::from(play.in_cycle_us()) << 16) / play.period_us();
            (play.cycles_done() as u32, play.request.cycles, phase as u16)
        })
    }

    fn setpoint_units(&self) -> [i16; 2] {
        self.commanded
            .map(|angle| libm::roundf(angle / ANGLE_UNIT_RAD) as i16)
    }

    /// Sends telemetry if it is due and a host listens.
    pub(super) fn send_telemetry(&mut self, now_us: u64) {
        let Some(transport) = self.session.transport() else {
            return;
        };
        if !self.tick.is_multiple_of(TELEMETRY_TICKS) {
            return;
        }
        let (cycle, cycles, phase) = self.cycle();
        let frames = self.frames();
        let telemetry = Telemetry {
            robot_us: now_us,
            state: self.state.name(),
            cause: self.cause,
            flags: self.flags(now_us),
            cycle,
            cycles,
            phase,
            setpoint: self.setpoint_units(),
            pulse_ns: self.output.pulses_ns.unwrap_or_default(),
            battery_mv: self.battery.mv(),
            pose: self.odometer.pose(),
            frames_ok: frames.ok as u16,
            frames_bad: frames.bad() as u16,
        };
        let header = Header::new(self.session.number(), self.telemetry_sequence);
        self.telemetry_sequence = self.telemetry_sequence.wrapping_add(1);
        let telemetry = Message::Telemetry(telemetry);
        self.send(transport, header, &telemetry, true, What::Telemetry);
    }

    pub(super) fn cycle_flash(&self) -> bool {
        matches!(self.state, State::Playing { .. })
            && self
                .last_play
                .is_some_and(|play| play.in_cycle_us() < FLASH_US)
    }

    /// LED pattern. Playing: flash per cycle. Other powered states: on. While the bench window is open: dark for a moment each
    /// second. E-stop: fast. Low battery: two blinks a second. Arming locked: three blinks every two seconds. Stopped: one
    /// blink every two seconds.
    pub(super) fn led(&self, now_us: u64) -> bool {
        let ms = self.tick * u64::from(TICK_US) / 1000;
        match self.state.name() {
            StateName::Playing => self.cycle_flash(),
            StateName::Stopped | StateName::EStopped if self.bench.open(now_us) => ms % 1000 >= 100,
            StateName::EStopped => ms % 200 < 100,
            StateName::Stopped if self.battery.low() => {
                ms % 1000 < 100 || (200..300).contains(&(ms % 1000))
            }
            StateName::Stopped if self.resets.wait_s().is_some() => {
                ms % 2000 < 500 && ms % 200 < 100
            }
            StateName::Stopped => ms % 2000 < 60,
            _ => true,
        }
    }
}
