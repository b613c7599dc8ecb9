//! Samples of every message, for golden files and corruption tests. Only appended to.
use heapless::{String, Vec};
use link_protocol::*;

pub(crate) const CONFIGURATION: Configuration = Configuration {
    middle_m: 0.071,
    front_m: 0.137,
    back_m: 0.137,
    chi: 3.598,
    tangential_drag: TangentialDrag::LogAspect(4.543),
    sphere_radius_m: 0.0692,
    max_angle: 2.8,
    max_rate: 3.5,
};

const TABLE: TableInfo = TableInfo {
    knots: 512,
    crc32: 0xDEAD_BEEF,
    stored: true,
    min_period_us: 2_512_345,
};

fn hello() -> Hello {
    // A separate line of the golden file fixes the schema key itself.
    Hello {
        protocol_min: 0x10,
        protocol_current: 0x10,
        schema_key: *b"schemakey"[..8].first_chunk().unwrap(),
        host_nonce: 0x1234_5678,
    }
}

fn hello_reply() -> HelloReply {
    HelloReply {
        host_nonce: 0x1234_5678,
        protocol_min: 0x10,
        protocol_current: 0x10,
        schema_key: hello().schema_key,
        firmware: FirmwareVersion {
            major: 0,
            minor: 1,
            patch: 0,
            commit: *b"0123abcd",
        },
        board: Board::NanoRp2040Connect,
        reset_reason: ResetReason::Watchdog,
        crash_message: true,
        session: 0xBEEF,
        boot_nonce: 0xCAFE_F00D,
        limits: RobotLimits {
            max_angle: 2.8,
            max_rate: 3.5,
            pulse_min_ns: 1_300_000,
            pulse_max_ns: 1_700_000,
            max_knots: 512,
            upload_window: 1024,
        },
        buffer: 2048,
    }
}

fn status() -> Status {
    Status {
        robot_us: 3_600_000_000,
        state: StateName::Playing,
        cause: StopCause::Boot,
        flags: Flags::DETACHED.with(Flags::CYCLE_FLASH, true),
        cycle: 2,
        cycles: 3,
        period_us: 30_000_000,
        phase: 0x8000,
        setpoint: [12_217, -12_217],
        battery_mv: Some(5_012),
        table: Some(TABLE),
        upload: Some(1040),
        settings_crc32: 0xFEED_F00D,
        estops: 2,
    }
}

fn telemetry() -> Telemetry {
    Telemetry {
        robot_us: 3_600_000_000,
        state: StateName::Starting,
        cause: StopCause::LinkLost,
        flags: Flags::BATTERY_LOW,
        cycle: 0,
        cycles: 3,
        phase: 0xFFFF,
        setpoint: [-1, 28_000],
        pulse_ns: [1_500_000, 1_602_190],
        battery_mv: None,
        pose: Pose {
            x: 0.0125,
            y: -0.003,
            theta: 0.25,
        },
        frames_ok: 65_535,
        frames_bad: 3,
    }
}

fn counters() -> Counters {
    Counters {
        frames: DecodeCounters {
            ok: u32::MAX,
            bad_crc: 1,
            overflow: 2,
            bad_cobs: 3,
            trailing_bytes: 4,
            not_understood: 5,
        },
        acted: 6,
        replayed: 7,
        superseded: 8,
        stale: 9,
        refused: 10,
        dropped: 11,
        late_ticks: 12,
        clamped: 13,
    }
}

#[allow(clippy::too_many_lines)] // one entry per request
pub(crate) fn requests() -> std::vec::Vec<(&'static str, Request)> {
    let chunk = |len: usize| Chunk {
        upload: 7,
        offset: 1040,
        data: Vec::from_slice(&vec![0xA5; len]).unwrap(),
    };
    let servo = ServoSettings {
        centre_ns: 1_500_000,
        slope_rad_per_us: 0.0274,
        reversed: true,
        trim: -175,
    };
    vec![
        ("request/status", Request::Status),
        ("request/counters", Request::Counters),
        ("request/configuration", Request::Configuration),
        ("request/configure", Request::Configure(CONFIGURATION)),
        (
            "request/configure half thickness",
            Request::Configure(Configuration {
                tangential_drag: TangentialDrag::HalfThickness(0.0025),
                ..CONFIGURATION
            }),
        ),
        (
            "request/configure over viscosity",
            Request::Configure(Configuration {
                tangential_drag: TangentialDrag::OverViscosity(1.383),
                ..CONFIGURATION
            }),
        ),
        ("request/servo", Request::Servo(Joint::Back)),
        (
            "request/set servo",
            Request::SetServo {
                joint: Joint::Front,
                settings: servo,
            },
        ),
        (
            "request/trim",
            Request::Trim {
                joint: Joint::Back,
                trim: -200,
            },
        ),
        (
            "request/begin",
            Request::Begin(Begin {
                slot: 0,
                len: 2048,
                crc32: 0xDEAD_BEEF,
            }),
        ),
        ("request/chunk of one", Request::Chunk(chunk(1))),
        ("request/chunk, full", Request::Chunk(chunk(MAX_CHUNK))),
        ("request/commit", Request::Commit { upload: 7 }),
        ("request/arm", Request::Arm),
        (
            "request/play",
            Request::Play(Play {
                cycles: 3,
                period_us: 30_000_000,
                detached: true,
                checked: CHECKED,
            }),
        ),
        ("request/pause", Request::Pause { detached: true }),
        ("request/resume", Request::Resume),
        ("request/stop", Request::Stop),
        ("request/estop", Request::EStop),
        ("request/clear resets", Request::ClearResets),
        ("request/crash message", Request::CrashMessage),
        ("request/table", Request::Table),
        ("request/set key", Request::SetKey(Some(KEY))),
        ("request/no key", Request::SetKey(None)),
        ("request/bench", Request::Bench),
        ("request/pulse range", Request::PulseRange(Joint::Front)),
        (
            "request/set pulse range",
            Request::SetPulseRange {
                joint: Joint::Back,
                range: RANGE,
            },
        ),
        ("request/clear estop", Request::ClearEStop { count: 2 }),
        ("request/enter boot loader", Request::EnterBootLoader),
        (
            "request/follow",
            Request::Follow(Follow {
                upload: 7,
                cycles: 11,
                period_us: 3_840_000,
                checked: CHECKED,
            }),
        ),
        (
            "request/set passive",
            Request::SetPassive(Some(Joint::Back)),
        ),
        ("request/set no passive", Request::SetPassive(None)),
    ]
}

#[allow(clippy::too_many_lines)] // one entry per reason
fn refusals() -> std::vec::Vec<(&'static str, Refusal)> {
    vec![
        ("refused/stale session", Refusal::StaleSession),
        ("refused/superseded", Refusal::Superseded { last: 300 }),
        (
            "refused/version",
            Refusal::Version {
                min: 0x10,
                current: 0x10,
            },
        ),
        ("refused/not understood", Refusal::NotUnderstood),
        ("refused/not armed", Refusal::NotArmed),
        ("refused/e-stopped", Refusal::EStopped),
        (
            "refused/wrong state",
            Refusal::WrongState(StateName::Settling),
        ),
        (
            "refused/battery",
            Refusal::BatteryLow {
                measured_mv: 4_321,
                limit_mv: 4_400,
            },
        ),
        ("refused/reset loop", Refusal::ResetLoop { wait_s: 42 }),
        ("refused/no table", Refusal::NoTable),
        ("refused/no such slot", Refusal::NoSuchSlot(3)),
        ("refused/bad length", Refusal::BadLength(2047)),
        ("refused/no upload", Refusal::NoUpload),
        (
            "refused/chunk out of range",
            Refusal::ChunkOutOfRange { wanted: 104 },
        ),
        ("refused/incomplete", Refusal::Incomplete { wanted: 208 }),
        (
            "refused/crc",
            Refusal::CrcMismatch {
                expected: 1,
                received: 2,
            },
        ),
        (
            "refused/angle",
            Refusal::AngleLimit {
                joint: Joint::Front,
                knot: 511,
                angle: -29_000,
                limit: 28_000,
            },
        ),
        (
            "refused/rate",
            Refusal::RateLimit {
                joint: Joint::Back,
                knot: 0,
                min_period_us: 2_512_345,
            },
        ),
        (
            "refused/not closed",
            Refusal::NotClosed {
                joint: Joint::Front,
                step: 30_000,
                largest: 153,
            },
        ),
        (
            "refused/crossing",
            Refusal::LinksCross {
                place: CrossingPlace::Gait(77),
                phi1: 18_330,
                phi2: 18_330,
            },
        ),
        (
            "refused/crossing ramp",
            Refusal::LinksCross {
                place: CrossingPlace::Ramp,
                phi1: -1,
                phi2: 1,
            },
        ),
        ("refused/detached", Refusal::DetachedTooLong),
        ("refused/swap pending", Refusal::SwapPending),
        ("refused/bad value", Refusal::BadValue { field: 4 }),
        ("refused/slow", Refusal::SlowToNeutral { needs_ms: 1_200 }),
        ("refused/busy", Refusal::Busy),
        ("refused/key needed", Refusal::KeyNeeded),
        ("refused/wrong key", Refusal::WrongKey),
        ("refused/needs presence", Refusal::NeedsPresence),
        ("refused/not fresh", Refusal::NotFresh),
        (
            "refused/not joined",
            Refusal::NotJoined {
                joint: Joint::Back,
                step: -127,
            },
        ),
        (
            "refused/other table",
            Refusal::OtherTable { held: 0xDEAD_BEEF },
        ),
        (
            "refused/other settings",
            Refusal::OtherSettings { held: 0xFEED_F00D },
        ),
        ("refused/e-stop count", Refusal::EStopCount { count: 3 }),
    ]
}

fn replies() -> std::vec::Vec<(&'static str, Reply)> {
    let servo = ServoSettings {
        centre_ns: 1_488_000,
        slope_rad_per_us: 0.0274,
        reversed: false,
        trim: 20,
    };
    let idle = Status {
        table: None,
        upload: None,
        battery_mv: None,
        ..status()
    };
    vec![
        ("reply/done", Reply::Done),
        ("reply/working", Reply::Working),
        ("reply/status", Reply::Status(status())),
        ("reply/status, empty", Reply::Status(idle)),
        ("reply/counters", Reply::Counters(counters())),
        ("reply/configuration", Reply::Configuration(CONFIGURATION)),
        ("reply/servo", Reply::Servo(servo)),
        (
            "reply/wanted",
            Reply::Wanted {
                upload: 7,
                offset: 1144,
            },
        ),
        (
            "reply/crash message",
            Reply::CrashMessage(String::try_from("panicked at control.rs:42").unwrap()),
        ),
        ("reply/table", Reply::Table(Some(TABLE))),
        ("reply/no table", Reply::Table(None)),
        (
            "reply/bench",
            Reply::Bench(BenchStatus {
                window_s: 119,
                usb: true,
                short_starts: 2,
                built: CONFIGURATION,
            }),
        ),
        ("reply/pulse range", Reply::PulseRange(RANGE)),
    ]
}

pub(crate) const KEY: Key = Key(*b"not a secret key");

const RANGE: PulseRange = PulseRange {
    shortest_ns: 1_392_000,
    longest_ns: 1_608_000,
};

const CHECKED: Checked = Checked {
    table_crc32: 0xDEAD_BEEF,
    settings_crc32: 0xFEED_F00D,
};

/// Named samples of every message.
pub(crate) fn messages() -> std::vec::Vec<(&'static str, Message)> {
    let mut all = vec![
        ("hello", Message::Hello(hello())),
        ("hello reply", Message::HelloReply(hello_reply())),
        ("telemetry", Message::Telemetry(telemetry())),
        (
            "heartbeat",
            Message::Heartbeat(Heartbeat {
                host_us: 1_234_567_890_123,
                heard_us: 42_000,
            }),
        ),
        (
            "pong",
            Message::Pong(Pong {
                host_us: 1_234_567_890_123,
                received_us: 42_000,
                sent_us: 42_017,
            }),
        ),
    ];
    all.extend(
        requests()
            .into_iter()
            .map(|(name, request)| (name, Message::Request(request))),
    );
    all.extend(
        replies()
            .into_iter()
            .map(|(name, reply)| (name, Message::Reply(reply))),
    );
    all.extend(
        refusals()
            .into_iter()
            .map(|(name, refusal)| (name, Message::Reply(Reply::Refused(refusal)))),
    );
    all
}

/// Frame of a message as in the golden files: session 0xBEEF, sequence 300, without the burst start.
pub(crate) fn frame(message: &Message) -> std::vec::Vec<u8> {
    let mut out = [0; MAX_ENCODED];
    let len = encode(Header::new(0xBEEF, 300), message, &mut out).unwrap();
    out[1..len].to_vec()
}
