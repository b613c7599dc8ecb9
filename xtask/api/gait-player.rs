// What `gait-player` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Boot {
    pub reset_reason: ResetReason,
    pub nonce: u32,
    pub session_seed: u16,
    pub kept: u32,
    pub crash_message: String<96>,
    pub starts: Option<ShortStarts>,
}
impl Boot {
    pub fn power_on(nonce: u32, session_seed: u16) -> Self {}
}
#[derive(Clone)]
pub struct Brain {}
impl Brain {
    pub fn new(config: BrainConfig) -> Self {}
    pub fn load<S: Storage>(&mut self, storage: &mut S) -> Result<(), S::Error> {}
    pub fn receive(&mut self, now_us: u64, transport: Transport, bytes: &[u8]) {}
    pub fn tick(&mut self, now_us: u64, inputs: &Inputs) -> Output {}
    pub fn kept(&self) -> u32 {}
    pub fn transmit(&mut self, transport: Transport, out: &mut [u8]) -> usize {}
    pub fn serve_storage<S: Storage>(
        &mut self,
        now_us: u64,
        storage: &mut S,
    ) -> Result<(), S::Error> {}
}
impl Brain {
    pub fn counters(&self) -> Counters {}
}
#[derive(Clone, Debug)]
pub struct BrainConfig {
    pub identity: Identity,
    pub limits: Limits,
    pub configuration: Configuration,
    pub servos: [ServoSettings; 2],
    pub buffer: u16,
    pub boot: Boot,
}
impl BrainConfig {
    pub fn robot(identity: Identity, boot: Boot) -> Self {}
}
#[derive(Clone, Copy, Debug)]
pub struct CrashNote {}
impl CrashNote {
    pub const NONE: Self = Self {
        len: 0,
        text: [0; ROOM],
        crc32: 0,
    };
    pub fn panicked(file: &str, line: u32, message: impl fmt::Display) -> Self {}
    pub fn faulted(address: u32, caller: u32) -> Self {}
    pub fn message(&self) -> String<ROOM> {}
}
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GaitTable {}
impl GaitTable {
    pub const fn empty() -> Self {}
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableError> {}
    pub fn from_fn(
        knots: usize,
        mut curve: impl FnMut(f64) -> [f64; 2],
    ) -> Result<Self, TableError> {}
    pub fn bytes(&self) -> &[u8] {}
    pub fn crc32(&self) -> u32 {}
    pub fn knots(&self) -> usize {}
    pub fn knot(&self, index: usize) -> [i16; 2] {}
    pub fn knot_angles(&self, index: usize) -> [f32; 2] {}
    pub fn phase(&self, in_cycle_us: u32, period_us: u32) -> Phase {}
    pub fn at(&self, phase: Phase) -> Shape {}
}
impl GaitTable {
    pub fn interval_period(&self, interval: usize, limits: &Limits) -> f32 {}
}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    pub firmware: FirmwareVersion,
    pub board: Board,
}
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    pub battery_mv: Option<u16>,
    pub link_up: bool,
    pub usb_up: bool,
    pub present: bool,
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    pub max_angle: f32,
    pub max_rate: f32,
    pub pulse_min_ns: u32,
    pub pulse_max_ns: u32,
    pub centre_ns: u32,
    pub slope_rad_per_us: f32,
    pub battery_limit_mv: u16,
}
impl Limits {
    pub const ROBOT: Self = Self {
        max_angle: 2.8,
        max_rate: 3.5,
        pulse_min_ns: 1_300_000,
        pulse_max_ns: 1_700_000,
        centre_ns: ServoMap::ROBOT.centre_ns,
        slope_rad_per_us: ServoMap::ROBOT.slope_rad_per_us,
        battery_limit_mv: 4_400,
    };
    #[must_use]
    pub fn tightened(&self, configuration: &Configuration) -> Self {}
    pub fn allows_centre(&self, centre_ns: u32) -> bool {}
    pub fn allows_slope(&self, slope_rad_per_us: f32) -> bool {}
    pub fn max_step(&self) -> f32 {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    pub pulses_ns: Option<[u32; 2]>,
    pub setpoint: [f32; 2],
    pub led: bool,
    pub cycle_flash: bool,
    pub state: StateName,
    pub kept: u32,
    pub storage_wanted: bool,
    pub starts: ShortStarts,
    pub boot_loader: bool,
}
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShortStarts {
    pub runs: u8,
}
impl ShortStarts {
    pub const LEN: usize = 12;
    pub const MOST: u8 = 3;
    pub fn encode(self) -> [u8; Self::LEN] {}
    pub fn decode(bytes: &[u8; Self::LEN]) -> Option<Self> {}
}
pub const TICK_US: u32 = 20_000;
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    Uart,
    Usb,
}
impl Transport {
    pub const ALL: [Self; 2] = [Self::Uart, Self::Usb];
}
pub mod brain {
    pub use crate::Boot;
    pub use crate::Brain;
    pub use crate::BrainConfig;
    pub use crate::Identity;
    pub use crate::Inputs;
    pub use crate::Output;
    pub use crate::Transport;
}
pub mod clearance {
    pub const MARGIN_TURN: f32 = 0.0175;
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum Way {
        Unknown,
        Clear,
        Crosses([f32; 2]),
    }
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct WayCheck {}
    impl WayCheck {
        pub fn new(from: [f32; 2], to: [f32; 2]) -> Self {}
        pub fn advance(&mut self, links: &Links<f32>) -> Way {}
    }
    pub fn clearance(links: &Links<f32>, phi: [f32; 2]) -> f32 {}
    pub fn margin(links: &Links<f32>) -> f32 {}
    pub fn motion(links: &Links<f32>, turn: [f32; 2]) -> f32 {}
}
pub mod limits {
    pub const CENTRE_ROOM_NS: u32 = 20_000;
    pub use crate::Limits;
    pub const SLOPE_ROOM: f32 = 0.1;
}
pub mod playback {
    #[derive(Clone, Copy, Debug)]
    pub struct Playback<'a> {
        pub table: &'a GaitTable,
        pub period_us: u32,
        pub maps: [ServoMap; 2],
        pub limits: Limits,
        pub plant: PlantParameters,
    }
    impl Playback<'_> {
        pub fn cycle(&self, cycle: u32, mut visit: impl FnMut(PlayedPoint)) {}
        pub fn command(&self, setpoint: [f32; 2]) -> [f64; 2] {}
    }
    impl Playback<'_> {
        pub fn through(
            &self,
            setpoints: impl IntoIterator<Item = [f32; 2]>,
            mut visit: impl FnMut(PlayedPoint),
        ) {}
    }
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct PlayedLeg<'a> {
        pub table: &'a GaitTable,
        pub cycles: u32,
        pub period_us: u32,
    }
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct PlayedPoint {
        pub time_s: f64,
        pub angles: [f64; 2],
        pub command: [f64; 2],
    }
    pub fn setpoints(
        legs: &[PlayedLeg<'_>],
        limits: &Limits,
        mut visit: impl FnMut([f32; 2]),
    ) {}
}
pub mod ramp {
    pub const NEUTRAL: [f32; 2] = [0.0; 2];
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Ramp {}
    impl Ramp {
        pub fn soft(
            from: [f32; 2],
            to: [f32; 2],
            via_neutral: bool,
            limits: &Limits,
        ) -> Self {}
        pub fn to_neutral(from: [f32; 2], limits: &Limits) -> Self {}
        pub fn duration_us(&self) -> u32 {}
        pub fn at(&self, elapsed_us: u64) -> [f32; 2] {}
    }
}
pub mod servo {
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct ServoMap {
        pub centre_ns: u32,
        pub slope_rad_per_us: f32,
        pub reversed: bool,
        pub trim: f32,
    }
    impl ServoMap {
        pub const ROBOT: Self = Self {
            centre_ns: 1_500_000,
            slope_rad_per_us: 0.0274,
            reversed: false,
            trim: 0.0,
        };
        pub fn pulse_ns(&self, angle: f32) -> u32 {}
        pub fn angle(&self, pulse_ns: u32) -> f32 {}
        pub fn step_ns(&self, step: f32) -> u32 {}
    }
    impl From<ServoSettings> for ServoMap {}
    pub mod plant {
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct PlantParameters {
            pub max_rate: f64,
            pub dead_band: f64,
            pub pulse_step_ns: u32,
        }
        impl PlantParameters {
            pub const IDEAL: Self = Self {
                max_rate: f64::INFINITY,
                dead_band: 0.0,
                pulse_step_ns: 0,
            };
            pub fn command(&self, map: &ServoMap, pulse_ns: u32) -> f64 {}
        }
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct ServoPlant {
            pub angle: f64,
        }
        impl ServoPlant {
            pub const fn new(angle: f64) -> Self {}
            pub fn time_to_rest(
                &self,
                parameters: &PlantParameters,
                command: f64,
            ) -> f64 {}
            pub fn advance(
                &mut self,
                parameters: &PlantParameters,
                command: f64,
                seconds: f64,
            ) {}
        }
    }
}
pub mod storage {
    pub const MAX_SETTINGS: usize = 96;
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct MemoryStorage {
        pub slots: [Vec<u8>; SLOTS],
        pub settings: Option<Vec<u8>>,
        pub starts: Option<[u8; ShortStarts::LEN]>,
    }
    impl MemoryStorage {
        pub fn erased() -> Self {}
    }
    impl Default for MemoryStorage {}
    impl Storage for MemoryStorage {
        type Error = Infallible;
    }
    pub const PAGE: usize = 256;
    pub const SLOTS: usize = 2;
    pub const SLOT_PAGES: usize = 1 + link_protocol::MAX_TABLE / PAGE;
    pub trait Storage {
        type Error;
        fn read(
            &mut self,
            slot: usize,
            offset: usize,
            bytes: &mut [u8],
        ) -> Result<(), Self::Error>;
        fn erase(&mut self, slot: usize) -> Result<(), Self::Error>;
        fn program(
            &mut self,
            slot: usize,
            page: usize,
            bytes: &[u8; PAGE],
        ) -> Result<(), Self::Error>;
        fn load_settings(
            &mut self,
            bytes: &mut [u8; MAX_SETTINGS],
        ) -> Result<Option<usize>, Self::Error>;
        fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;
        fn load_starts(
            &mut self,
            bytes: &mut [u8; ShortStarts::LEN],
        ) -> Result<bool, Self::Error>;
        fn save_starts(
            &mut self,
            bytes: &[u8; ShortStarts::LEN],
        ) -> Result<(), Self::Error>;
    }
}
pub mod table {
    pub use link_protocol::MAX_KNOTS;
    pub use crate::GaitTable;
    pub const KNOT_BYTES: usize = 4;
    pub const MIN_KNOTS: usize = 2;
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Phase {
        pub interval: usize,
        pub fraction: f32,
    }
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Shape {
        pub angles: [f32; 2],
        pub slopes: [f32; 2],
    }
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum TableError {
        Knots(usize),
        Bytes(usize),
        Angle { joint: Joint, knot: usize, angle: f64 },
    }
    impl fmt::Display for TableError {}
    impl core::error::Error for TableError {}
    pub mod check {
        #[derive(Clone, Debug)]
        pub struct Checker {}
        impl Checker {
            pub const fn new() -> Self {}
            pub fn advance(
                &mut self,
                table: &GaitTable,
                links: &Links<f32>,
                work: u32,
            ) -> Option<Facts> {}
        }
        impl Default for Checker {}
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Facts {}
        impl Facts {
            pub fn allow(&self, limits: &Limits) -> Result<(), Refusal> {}
            pub fn min_period_us(&self, limits: &Limits) -> u32 {}
            pub fn allow_period(
                &self,
                limits: &Limits,
                period_us: u32,
            ) -> Result<(), Refusal> {}
        }
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Largest {
            pub joint: Joint,
            pub knot: u16,
            pub value: f32,
        }
    }
}
