//! Cost of a tick on the host, playing a table of 512 knots. The emulator measures the chip's figure.
#![allow(missing_docs)]
#[path = "../tests/player/bench/mod.rs"]
mod bench;

use bench::{Bench, circle, play};
use criterion::{Criterion, criterion_group, criterion_main};
use gait_player::table::check::Checker;

fn tick(c: &mut Criterion) {
    let mut playing = Bench::playing(&circle(1.2), play(0, 5_000_000));
    c.bench_function(
        "tick while playing, telemetry and keep-alives included",
        |b| {
            b.iter(|| {
                playing.telemetry.clear();
                playing.tick()
            });
        },
    );
    let table = circle(1.9);
    let links = swimmer_model::Swimmer::robot().links;
    c.bench_function("check of a table of 512 knots", |b| {
        b.iter(|| Checker::new().advance(&table, &links, u32::MAX));
    });
}

criterion_group!(benches, tick);
criterion_main!(benches);
