//! The firmware's log.

use std::time::Duration;

use emulator::LogLevel;

use crate::rig::{self, Image};

/// It comes out in words, with the emulated time, and begins with what runs.
#[test]
fn a_board_says_in_its_log_what_it_runs() {
    for image in [Image::Nano, Image::Pico] {
        let mut board = rig::board(image);
        board.run(Duration::from_millis(50)).unwrap();
        let log = board.take_events().log;
        let [line] = &log[..] else {
            panic!("one line when nothing goes wrong, not {log:?}");
        };
        println!("{line}");
        assert_eq!(line.level, LogLevel::Info);
        let said = format!("swimmer firmware {}, commit ", env!("CARGO_PKG_VERSION"));
        assert!(line.text.starts_with(&said), "{line}");
        assert!(
            line.at > Duration::ZERO && line.at < Duration::from_millis(50),
            "{line}"
        );
    }
}
