//! A flash that holds anything: the brain wakes up stopped, and nothing it loads lets a pulse out of the window.
#![no_main]

use gait_player::{Inputs, Limits, TICK_US, Transport};
use libfuzzer_sys::fuzz_target;
use link_protocol::{Header, Message, Play, Request, StateName};
use swimmer_fuzz::robot::{WildStorage, woken};
use swimmer_fuzz::wire;

fuzz_target!(|data: (&[u8], &[u8])| {
    let (settings, slots) = data;
    let mut brain = woken(&mut WildStorage { slots, settings });
    let inputs = Inputs {
        link_up: true,
        ..Inputs::default()
    };
    assert_eq!(brain.tick(20_000, &inputs).state, StateName::Stopped);
    brain.receive(
        20_000,
        Transport::Uart,
        &wire::frame(Header::new(0, 0), &wire::hello(1)),
    );
    // The session that a start with this seed opens first.
    let ask = |brain: &mut gait_player::Brain, now, sequence, request: Request| {
        for session in [0x1000, 0x1001] {
            let header = Header::new(session, sequence);
            for message in [wire::heartbeat(now), Message::Request(request.clone())] {
                brain.receive(now, Transport::Uart, &wire::frame(header, &message));
            }
        }
    };
    ask(&mut brain, 20_000, 1, Request::Arm);
    let checked = brain.held();
    ask(
        &mut brain,
        20_000,
        2,
        Request::Play(Play {
            cycles: 1,
            period_us: 4_000_000,
            detached: true,
            checked,
        }),
    );
    let window = Limits::ROBOT.pulse_min_ns..=Limits::ROBOT.pulse_max_ns;
    for tick in 2..300_u64 {
        let pulses = brain.tick(tick * u64::from(TICK_US), &inputs).pulses_ns;
        assert!(
            pulses.is_none_or(|pulses| pulses.iter().all(|pulse| window.contains(pulse))),
            "{pulses:?}"
        );
    }
});
