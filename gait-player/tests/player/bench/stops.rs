//! Benches in every powered state, and the expected course of a stop.
#![allow(dead_code, clippy::wildcard_imports)] // each test uses a part of it, and all messages of the protocol
#![allow(clippy::float_cmp)] // neutral is exact

use super::*;

pub(crate) const TICK: u64 = TICK_US as u64;

/// Returns one attached bench per powered state.
pub(crate) fn powered() -> Vec<Bench> {
    let table = circle(1.2);
    let mut holding = Bench::new();
    holding.upload(&table);
    holding.done(ARM);
    holding.tick();
    let mut starting = Bench::new();
    starting.upload(&table);
    starting.done(ARM);
    starting.done(play(3, 5_000_000));
    starting.run(SECOND / 2);
    let mut playing = Bench::playing(&table, play(3, 5_000_000));
    playing.run(2 * SECOND);
    let mut paused = Bench::playing(&table, play(3, 5_000_000));
    paused.run(SECOND);
    paused.done(Request::Pause { detached: false });
    paused.tick();
    let benches = vec![holding, starting, playing, paused];
    let names: Vec<_> = benches.iter().map(|bench| bench.output.state).collect();
    assert_eq!(
        names,
        [
            StateName::Holding,
            StateName::Starting,
            StateName::Playing,
            StateName::Paused
        ]
    );
    benches
}

/// Runs ticks until a stop begins (at neutral there is no ramp); returns the duration, µs.
pub(crate) fn until_stopping(bench: &mut Bench, at_most_us: u64) -> u64 {
    let start = bench.now_us;
    while !matches!(
        bench.output.state,
        StateName::Stopping | StateName::Settling
    ) {
        assert!(
            bench.now_us - start <= at_most_us,
            "still {:?}",
            bench.output.state
        );
        bench.tick();
    }
    bench.now_us - start
}

/// Checks a stop to its end: ramp straight to neutral at the full rate, half a second there, pulses off.
pub(crate) fn follow_stop(bench: &mut Bench, cause: StopCause) {
    let from = bench.output.setpoint;
    let longest = f64::from(from[0].abs().max(from[1].abs())) / 3.5;
    let took = bench.until(StateName::Settling, 2 * SECOND);
    assert!(
        took as f64 <= longest * 1e6 + TICK as f64,
        "{took} {longest}"
    );
    assert_eq!(bench.output.setpoint, [0.0; 2]);
    let settled = bench.until(StateName::Stopped, SECOND);
    assert_eq!(settled, 500_000);
    assert_eq!(bench.output.pulses_ns, None);
    assert_eq!(bench.status().cause, cause);
}
