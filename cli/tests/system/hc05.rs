//! The shipped binary sets up a module on a pseudo-terminal.

#[path = "../../../host-link/tests/link/fake_module/mod.rs"]
mod fake_module;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use fake_module::{FakeModule, Maker, Trouble};
use host_link::Port;
use host_link::port::PtyPort;

use crate::binary::{Ran, swimmer_in};

/// Runs `swimmer robot hc05` against a module; returns both.
fn set_up(module: FakeModule, words: &[&str]) -> (FakeModule, Ran) {
    let folder = tempfile::tempdir().unwrap();
    let mut pty = PtyPort::open(Some(&folder.path().join("adapter"))).unwrap();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let module = scope.spawn(|| serve(&mut pty, module, &over));
        let words = [&["robot", "hc05", "--port", "adapter"], words].concat();
        let finished = swimmer_in(Path::new(folder.path()), &words);
        over.store(true, Ordering::Relaxed);
        (module.join().unwrap(), finished)
    })
}

fn serve(pty: &mut PtyPort, mut module: FakeModule, over: &AtomicBool) -> FakeModule {
    let mut bytes = [0; 256];
    while !over.load(Ordering::Relaxed) {
        let count = pty.read(&mut bytes, Duration::from_millis(20)).unwrap_or(0);
        module.write(&bytes[..count]).unwrap();
        while let Ok(count @ 1..) = module.read(&mut bytes, Duration::ZERO) {
            pty.write(&bytes[..count]).unwrap();
        }
    }
    module
}

#[test]
fn a_module_is_set_up_then_found_right() {
    let wanted = ["--name", "swimmer", "--pin", "4711", "--json"];
    let (module, finished) = set_up(FakeModule::new(Maker::Version3), &wanted);
    let answer = finished.with_status(0).json();
    assert_eq!(answer["before"]["baud"], 9600, "{answer:#}");
    assert_eq!(answer["after"]["baud"], 115_200, "{answer:#}");
    assert_eq!(answer["after"]["parity"], "none", "{answer:#}");
    assert_eq!(
        answer["differed"].as_array().unwrap().len(),
        4,
        "{answer:#}"
    );
    assert_eq!(
        (module.name.as_str(), module.pin.as_str()),
        ("swimmer", "4711")
    );
    assert!(module.was_reset && module.sets == 4);

    let (module, finished) = set_up(module, &[&wanted[..], &["--check"]].concat());
    let answer = finished.with_status(0).json();
    assert!(
        answer["differed"].as_array().unwrap().is_empty(),
        "{answer:#}"
    );
    let (module, finished) = set_up(module, &["--baud", "9600", "--check", "--json"]);
    let answer = finished.with_status(1).json();
    assert_eq!(answer["before"]["baud"], 115_200, "{answer:#}");
    assert!(
        answer["error"]
            .as_str()
            .unwrap()
            .contains("without --check"),
        "{answer:#}"
    );
    let (module, finished) = set_up(module, &["--baud", "9600", "--check"]);
    let text = finished.with_status(1).stdout;
    assert!(
        text.contains("115200 baud, 1 stop bit(s), parity none  <- not as wanted"),
        "{text}"
    );
    assert_eq!(module.sets, 4, "a check sets nothing");
}

#[test]
fn a_silent_module_is_told_apart_and_exits_with_1() {
    let silent = FakeModule::new(Maker::Version3).with(Trouble::Silent);
    let (_, finished) = set_up(silent, &["--json"]);
    let answer = finished.with_status(1).json();
    assert!(
        answer["error"]
            .as_str()
            .unwrap()
            .contains("hold its button"),
        "{answer:#}"
    );
}
