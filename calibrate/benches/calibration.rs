//! How fast: a wide file of 3 MB read, poses of it, and one fit of six runs.

#[path = "../tests/tank/mod.rs"]
mod tank;

use std::hint::black_box;
use std::path::Path;

use calibrate::{FitOptions, PoseOptions, calibrate_campaign, poses, read_tracks};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use swimmer_files::AnyGait;
use swimmer_model::Swimmer;
use tank::{Tank, campaign};

fn reading(c: &mut Criterion) {
    let tank = Tank {
        period_s: 30.0,
        cycles: 20,
        ..Tank::new(Swimmer::robot(), AnyGait::circle(1.0))
    };
    let text = tank.motive();
    let mut group = c.benchmark_group("reading");
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function(
        format!("wide file of {:.1} MB", text.len() as f64 / 1e6),
        |b| {
            b.iter(|| read_tracks(black_box(text.as_bytes()), Path::new("f")).map(|f| f.frames()));
        },
    );
    group.finish();
    let run = tank.run_of(&text);
    c.bench_function("poses of 60000 frames", |b| {
        b.iter(|| {
            poses(
                black_box(&run.track),
                &tank.named(),
                &PoseOptions::default(),
            )
            .map(|t| t.samples.len())
        });
    });
}

fn fitting(c: &mut Criterion) {
    let tank = Tank::new(Swimmer::robot(), AnyGait::circle(1.0));
    let degrees = [30.0, 50.0, 70.0, 85.0, 100.0, 110.0];
    let mut group = c.benchmark_group("fitting");
    group.sample_size(10);
    for (name, servo) in [
        ("ideal servos", None),
        ("played paths", Some(swimmer_files::ServoFile::default())),
    ] {
        let tank = Tank {
            servo,
            ..tank.clone()
        };
        let (campaign, data) = campaign(&tank, &degrees, Tank::motive, tank.named());
        group.bench_function(format!("six runs, {name}"), |b| {
            b.iter(|| {
                calibrate_campaign(black_box(&campaign), &data, FitOptions::default())
                    .map(|f| f.fit.chi)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, reading, fitting);
criterion_main!(benches);
