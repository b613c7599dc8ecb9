//! Requests that a fuzzer can find: mostly ones that a robot would grant, so that stories get past the first refusal.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use arbitrary::Arbitrary;
use gait_player::GaitTable;
use link_protocol::{
    Begin, Checked, Chunk, Configuration, Follow, Joint, Key, MAX_SIGNED_CHUNK, Play, Request,
    ServoSettings, TangentialDrag,
};

/// Tables that a story may upload: circles of 0.4 to 2.8 rad with few knots, so that one is soon across.
static TABLES: LazyLock<[GaitTable; 4]> =
    LazyLock::new(|| [0.4, 1.2, 2.0, 2.8].map(|amplitude| circle(amplitude, 52)));

fn circle(amplitude: f64, knots: usize) -> GaitTable {
    GaitTable::from_fn(knots, |u| {
        let angle = TAU * (u + 0.125);
        [amplitude * angle.cos(), amplitude * angle.sin()]
    })
    .expect("a circle within the table's range")
}

/// Bytes of a table in one request, so that a signature fits as well.
pub const PIECE: usize = MAX_SIGNED_CHUNK;

/// The table of this number.
pub fn table(which: u8) -> &'static GaitTable {
    &TABLES[usize::from(which) % TABLES.len()]
}

/// One request of an operator.
#[derive(Arbitrary, Debug, Clone)]
pub enum Ask {
    Status,
    Counters,
    Configuration,
    Table,
    CrashMessage,
    ClearResets,
    Arm,
    ClearEStop {
        count: u8,
    },
    Play {
        cycles: u8,
        tenths: u8,
        detached: bool,
    },
    Pause {
        detached: bool,
    },
    Resume,
    Stop,
    EStop,
    Begin {
        which: u8,
    },
    Chunk {
        which: u8,
        piece: u8,
        upload: u16,
    },
    Commit {
        upload: u16,
    },
    Follow {
        upload: u16,
        cycles: u8,
        tenths: u8,
    },
    Trim {
        back: bool,
        trim: i16,
    },
    Servo {
        back: bool,
    },
    SetServo {
        back: bool,
        centre_ns: u32,
        slope: f32,
        reversed: bool,
        trim: i16,
    },
    Configure {
        lengths: [f32; 3],
        chi: f32,
        sphere: f32,
        drag: f32,
        max_angle: f32,
        max_rate: f32,
    },
    SetKey {
        key: Option<u8>,
    },
}

impl Ask {
    /// The request on the wire. A story names the last upload by 0: `upload_now` is the number that the robot gave it. Plays name
    /// what the host has `checked`.
    pub fn request(&self, upload_now: u16, checked: Checked) -> Request {
        let number = |upload: u16| if upload == 0 { upload_now } else { upload };
        let joint = |back| if back { Joint::Back } else { Joint::Front };
        match *self {
            Self::Status => Request::Status,
            Self::Counters => Request::Counters,
            Self::Configuration => Request::Configuration,
            Self::Table => Request::Table,
            Self::CrashMessage => Request::CrashMessage,
            Self::ClearResets => Request::ClearResets,
            Self::Arm => Request::Arm,
            Self::ClearEStop { count } => Request::ClearEStop {
                count: count.into(),
            },
            Self::Play {
                cycles,
                tenths,
                detached,
            } => Request::Play(Play {
                cycles: cycles.into(),
                period_us: u32::from(tenths) * 100_000,
                detached,
                checked,
            }),
            Self::Pause { detached } => Request::Pause { detached },
            Self::Resume => Request::Resume,
            Self::Stop => Request::Stop,
            Self::EStop => Request::EStop,
            Self::Begin { which } => {
                let table = table(which);
                let len = table.bytes().len().try_into().unwrap_or(u16::MAX);
                Request::Begin(Begin {
                    slot: 0,
                    len,
                    crc32: table.crc32(),
                })
            }
            Self::Chunk {
                which,
                piece,
                upload,
            } => {
                let bytes = table(which).bytes();
                let start = usize::from(piece) * PIECE % bytes.len();
                let end = bytes.len().min(start + PIECE);
                let data = heapless::Vec::from_slice(&bytes[start..end]).unwrap_or_default();
                Request::Chunk(Chunk {
                    upload: number(upload),
                    offset: start as u16,
                    data,
                })
            }
            Self::Commit { upload } => Request::Commit {
                upload: number(upload),
            },
            Self::Follow {
                upload,
                cycles,
                tenths,
            } => Request::Follow(Follow {
                upload: number(upload),
                cycles: cycles.into(),
                period_us: u32::from(tenths) * 100_000,
                checked,
            }),
            Self::Trim { back, trim } => Request::Trim {
                joint: joint(back),
                trim,
            },
            Self::Servo { back } => Request::Servo(joint(back)),
            Self::SetServo {
                back,
                centre_ns,
                slope,
                reversed,
                trim,
            } => Request::SetServo {
                joint: joint(back),
                settings: ServoSettings {
                    centre_ns,
                    slope_rad_per_us: slope,
                    reversed,
                    trim,
                },
            },
            Self::Configure {
                lengths: [middle_m, front_m, back_m],
                chi,
                sphere,
                drag,
                max_angle,
                max_rate,
            } => Request::Configure(Configuration {
                middle_m,
                front_m,
                back_m,
                chi,
                tangential_drag: TangentialDrag::LogAspect(drag),
                sphere_radius_m: sphere,
                max_angle,
                max_rate,
            }),
            Self::SetKey { key } => Request::SetKey(key.map(|letter| Key([letter; Key::LEN]))),
        }
    }
}
