//! Each way in which a port gives no robot has its own sentence, word for word. Behind these ports stand devices that are
//! silent, at another speed, or of another version.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use host_link::Port as _;
use host_link::port::PtyPort;
use link_protocol::{
    Board, Decoder, FirmwareVersion, Header, HelloReply, Message, ResetReason, RobotLimits,
    SCHEMA_KEY,
};

use crate::binary::swimmer_in;

/// A device behind a pseudo-terminal, which answers whatever it hears with what `answer` makes of it.
struct Device {
    folder: tempfile::TempDir,
    ended: Arc<AtomicBool>,
    life: Option<JoinHandle<()>>,
}

impl Device {
    fn new(mut answer: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut port = PtyPort::open(Some(&folder.path().join("port"))).unwrap();
        let ended = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ended);
        let life = std::thread::spawn(move || {
            let mut bytes = [0; 256];
            while !end.load(Ordering::SeqCst) {
                let count = port.read(&mut bytes, Duration::from_millis(20)).unwrap();
                if count > 0 {
                    port.write(&answer(&bytes[..count])).unwrap();
                }
            }
        });
        Self {
            folder,
            ended,
            life: Some(life),
        }
    }

    /// Message of `swimmer robot info` about it, and the exit status.
    fn sentence(&self) -> String {
        let ran =
            swimmer_in(self.folder.path(), &["robot", "info", "--port", "port"]).with_status(1);
        assert!(ran.stdout.is_empty(), "{ran}");
        ran.stderr
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::SeqCst);
        let _ = self.life.take().map(JoinHandle::join);
    }
}

/// Times vary by a few milliseconds.
fn without_times() -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.add_filter(r"in \d+ ms", "in [TIME] ms");
    settings.add_filter(r"for \d+\.\d s", "for [TIME] s");
    // A greeting's nonce is drawn, and a small one is shorter.
    settings.add_filter(r"\(\d+ bytes\) sent", "([N] bytes) sent");
    settings.add_filter(
        r"\(\d+ bytes\) received, \d+ broken",
        "([N] bytes) received, [N] broken",
    );
    settings
}

/// The page for the first day says what the program says.
#[test]
fn the_first_day_quotes_what_is_said() {
    let page = include_str!("../../../docs/first-day.md");
    let silent = Device::new(|_| Vec::new()).sentence();
    let garbage = Device::new(|bytes| vec![0x93; bytes.len()].into_iter().chain([0]).collect());
    let echo = Device::new(<[u8]>::to_vec).sentence();
    for (sentence, words) in [
        (&silent, "is the robot on and paired, and is this its port?"),
        (
            &silent,
            "Without its Bluetooth module's STATE wire it hears and never answers",
        ),
        (&garbage.sentence(), "bytes come but none make sense: "),
        (&echo, "what is sent comes back unchanged"),
    ] {
        assert!(sentence.contains(words), "{sentence}");
        assert!(page.contains(words), "the page does not say {words:?}");
    }
}

#[test]
fn a_silent_port() {
    let device = Device::new(|_| Vec::new());
    without_times().bind(|| insta::assert_snapshot!(device.sentence(), @r"
note: while connecting: no valid frame from the robot for [TIME] s; still trying.
error: while connecting: no answer after 5 tries in [TIME] ms (5 frames ([N] bytes) sent, 4 of them again; 0 frames ([N] bytes) received, [N] broken, 0 foreign); is the robot on and paired, and is this its port? Without its Bluetooth module's STATE wire it hears and never answers
"));
}

#[test]
fn a_device_at_another_speed() {
    let device = Device::new(|bytes| {
        bytes
            .iter()
            .map(|byte| byte.wrapping_mul(37) | 0x81)
            .chain([0])
            .collect()
    });
    without_times().bind(|| insta::assert_snapshot!(device.sentence(), @r"
note: while connecting: no valid frame from the robot for [TIME] s; still trying.
error: while connecting: no answer after 5 tries in [TIME] ms (5 frames ([N] bytes) sent, 4 of them again; 0 frames ([N] bytes) received, [N] broken, 0 foreign); bytes come but none make sense: is this the robot's port, is its Bluetooth module set to 115200 baud (AT+UART=115200,0,0; a robot built for another speed wants --baud), and are all grounds joined?
"));
}

/// The line runs at the speed of the firmware's build, as the other end sees it.
#[test]
fn a_line_at_the_speed_that_was_named() {
    use rustix::fs::{Mode, OFlags, open};
    let device = Device::new(|_| Vec::new());
    let folder = device.folder.path();
    for (words, speed) in [(&[][..], 115_200), (&["--baud", "57600"], 57_600)] {
        let words = [&["robot", "info", "--port", "port"], words].concat();
        swimmer_in(folder, &words).with_status(1);
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK;
        let line = open(folder.join("port"), flags, Mode::empty()).unwrap();
        let settings = rustix::termios::tcgetattr(&line).unwrap();
        assert_eq!(settings.output_speed(), speed);
    }
}

/// A robot that answers a greeting with these versions and this schema key.
fn robot_of(versions: [u8; 2], schema_key: [u8; 8]) -> Device {
    let mut decoder = Decoder::new();
    Device::new(move |bytes| {
        let mut answer = Vec::new();
        for received in bytes.iter().filter_map(|&byte| decoder.push(byte)) {
            let Ok(Message::Hello(hello)) = received.message else {
                continue;
            };
            let reply = Message::HelloReply(HelloReply {
                host_nonce: hello.host_nonce,
                protocol_min: versions[0],
                protocol_current: versions[1],
                schema_key,
                firmware: FirmwareVersion {
                    major: 0,
                    minor: 9,
                    patch: 2,
                    commit: *b"0123abcd",
                },
                board: Board::NanoRp2040Connect,
                reset_reason: ResetReason::PowerOn,
                crash_message: false,
                session: 7,
                boot_nonce: 1,
                limits: RobotLimits {
                    max_angle: 2.8,
                    max_rate: 3.5,
                    pulse_min_ns: 1_383_212,
                    pulse_max_ns: 1_616_788,
                    max_knots: 512,
                    upload_window: 1024,
                },
                buffer: 1024,
            });
            let mut frame = [0; link_protocol::MAX_ENCODED];
            let header = Header::new(0, received.header.sequence);
            let length = link_protocol::encode(header, &reply, &mut frame).unwrap();
            answer.extend_from_slice(&frame[..length]);
        }
        answer
    })
}

#[test]
fn a_robot_of_a_later_version() {
    insta::assert_snapshot!(robot_of([0x30, 0x41], SCHEMA_KEY).sentence(), @"error: the robot's firmware 0.9.2 (0123abcd) speaks versions 3.0 to 4.1 of the protocol, this program 1.0 to 1.0: update this program");
}

#[test]
fn a_robot_of_an_earlier_version() {
    insta::assert_snapshot!(robot_of([1, 2], SCHEMA_KEY).sentence(), @"error: the robot's firmware 0.9.2 (0123abcd) speaks versions 0.1 to 0.2 of the protocol, this program 1.0 to 1.0: update the robot's firmware");
}

#[test]
fn a_robot_of_another_build() {
    let mut filters = insta::Settings::clone_current();
    filters.add_filter("[0-9a-f]{16}", "[KEY]");
    filters.bind(|| {
        insta::assert_snapshot!(robot_of([0x10, 0x10], [1; 8]).sentence(), @"error: the robot's firmware 0.9.2 (0123abcd) and this program both speak version 1.0 of the protocol but disagree on its messages (keys [KEY] and [KEY]): build both from the same commit");
    });
}

#[test]
fn a_file_that_is_no_port() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("port"), "no port").unwrap();
    let ran = swimmer_in(folder.path(), &["robot", "info", "--port", "port"]).with_status(1);
    insta::assert_snapshot!(ran.stderr, @"error: opening port: it is there, but it is no serial port; name one (`swimmer robot info` without --port finds it)");
}

#[test]
fn nobody_at_a_tcp_port() {
    let free = std::net::TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    let port = format!("tcp:{free}");
    let folder = tempfile::tempdir().unwrap();
    let ran = swimmer_in(folder.path(), &["robot", "info", "--port", &port]).with_status(1);
    let mut filters = insta::Settings::clone_current();
    filters.add_filter(r"127\.0\.0\.1:\d+", "[ADDRESS]");
    filters.bind(|| insta::assert_snapshot!(ran.stderr, @"error: cannot connect to the robot at [ADDRESS]: Connection refused (os error 111); is `swimmer twin --tcp` running?"));
}

/// Among several ports, the one with a robot is used, and named; the reasons against the others are printed.
#[test]
fn the_robot_among_several_ports() {
    let silent = Device::new(|_| Vec::new());
    let _twin = crate::binary::TwinProcess::start(silent.folder.path(), &[]);
    let robot = |ports: &str| {
        swimmer_in(
            silent.folder.path(),
            &["robot", "info", "--port", ports, "--json"],
        )
    };
    let found = robot("nowhere,robot").with_status(0);
    assert_eq!(found.json()["board"], "twin", "{found}");
    insta::assert_snapshot!(found.stderr, @"The robot is at robot.");
    let nobody = robot("nowhere,port").with_status(1);
    insta::assert_snapshot!(nobody.stderr, @"
error: no robot answers at any port; is it switched on and paired? Tried:
  nowhere: opening nowhere: there is no such port; is the robot switched on and paired, and the path right?
  port: no answer within 4 s
");
}
