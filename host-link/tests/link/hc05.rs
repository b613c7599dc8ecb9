//! Setup of the HC-05 against a scripted module, with the variants of several makers and with faults at the bench.

use crate::fake_module;

use fake_module::{FakeModule, Maker, Trouble};
use host_link::hc05::{Hc05Error, ModuleSettings, Outcome, Setting, Uart, converse};

fn wanted() -> ModuleSettings {
    ModuleSettings::new(115_200, Some("swimmer".to_owned()), Some("4711".to_owned())).unwrap()
}

fn set_up(module: &mut FakeModule) -> Result<Outcome, Hc05Error> {
    converse(module, &wanted(), false)
}

#[test]
fn modules_of_all_makers_are_set_up_and_read_back() {
    for maker in [Maker::Version2, Maker::Version3, Maker::Forgetful] {
        let mut module = FakeModule::new(maker);
        let outcome = set_up(&mut module).unwrap();
        assert_eq!(
            outcome.differed,
            [Setting::Role, Setting::Name, Setting::Pin, Setting::Uart],
            "{maker:?}"
        );
        assert_eq!(outcome.before.uart, Some(Uart::at(9600)));
        assert_eq!(outcome.after.uart, Some(Uart::at(115_200)));
        // In the module itself: no quotes in the PIN, for any maker's style.
        assert_eq!(module.pin, "4711", "{maker:?}");
        assert_eq!(module.name, "swimmer");
        assert_eq!((module.uart.as_str(), module.role), ("115200,0,0", 0));
        assert!(module.was_reset);
    }
}

#[test]
fn what_is_right_already_is_left_alone() {
    let mut module = FakeModule::new(Maker::Version3);
    set_up(&mut module).unwrap();
    (module.sets, module.was_reset) = (0, false);
    let outcome = set_up(&mut module).unwrap();
    assert_eq!(outcome.differed, []);
    assert_eq!(outcome.before, outcome.after);
    assert!(module.sets == 0 && !module.was_reset);
}

#[test]
fn a_check_changes_nothing() {
    let mut module = FakeModule::new(Maker::Version2);
    let outcome = converse(&mut module, &wanted(), true).unwrap();
    assert_eq!(
        outcome.differed,
        [Setting::Role, Setting::Name, Setting::Pin, Setting::Uart]
    );
    assert_eq!(outcome.before.version.as_deref(), Some("2.0-20100601"));
    assert!(module.sets == 0 && !module.was_reset);
    // A setting that was not requested does not count as different.
    let only_speed = ModuleSettings::new(9600, None, None).unwrap();
    let outcome = converse(&mut module, &only_speed, true).unwrap();
    assert_eq!(outcome.differed, [Setting::Role]);
}

/// Some modules answer the first line with an error, and echo their input.
#[test]
fn a_cold_start_and_an_echo_do_no_harm() {
    for trouble in [Trouble::ColdStart, Trouble::EchoAndAnswer] {
        let mut module = FakeModule::new(Maker::Version2).with(trouble);
        assert!(set_up(&mut module).is_ok(), "{trouble:?}");
    }
}

#[test]
fn each_trouble_has_its_own_sentence_and_advice() {
    let sentence = |trouble| {
        let mut module = FakeModule::new(Maker::Version3).with(trouble);
        set_up(&mut module).unwrap_err().to_string()
    };
    let cases = [
        (
            Trouble::Silent,
            "says nothing",
            "exchange the wires at TXD and RXD",
        ),
        (Trouble::WrongBaud, "another speed", "--at-baud 9600"),
        (Trouble::LoopBack, "comes straight back", "TX and RX touch"),
        (
            Trouble::OnlyErrors,
            "no HC-05 in AT mode",
            "hold its button",
        ),
        (
            Trouble::SilentFromUart,
            "not to `AT+UART?`",
            "held all the time",
        ),
        (
            Trouble::RefusesName,
            "refuses `AT+NAME=swimmer` with ERROR (3)",
            "shorter",
        ),
        (Trouble::RefusesPin, "ERROR (1D)", "four digits"),
        (
            Trouble::KeepsNothing,
            "now reads HC-05 instead of swimmer",
            "held all the time",
        ),
    ];
    for (trouble, what, advice) in cases {
        let text = sentence(trouble);
        assert!(
            text.contains(what) && text.contains(advice),
            "{trouble:?}: {text}"
        );
    }
}

/// An early failure leaves the known speed, and the dialogue always ends.
#[test]
fn every_trouble_ends_and_the_speed_is_set_last() {
    for trouble in [
        Trouble::Silent,
        Trouble::WrongBaud,
        Trouble::LoopBack,
        Trouble::OnlyErrors,
        Trouble::RefusesName,
        Trouble::RefusesPin,
        Trouble::SilentFromUart,
        Trouble::KeepsNothing,
    ] {
        let mut module = FakeModule::new(Maker::Version3).with(trouble);
        assert!(set_up(&mut module).is_err());
        assert!(
            host_link::Port::now(&module) < std::time::Duration::from_secs(15),
            "{trouble:?}"
        );
        assert_eq!(module.uart, "9600,0,0", "{trouble:?}");
    }
}
