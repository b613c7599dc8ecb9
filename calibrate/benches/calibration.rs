//! Durations of reading wide files, of their poses, of fits of six runs, and of a recording of twenty minutes from its bytes to
//! the fit.

#[path = "../tests/campaigns/tank/mod.rs"]
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
    group.bench_function("wide, four markers", |b| {
        b.iter(|| read_tracks(black_box(text.as_bytes()), Path::new("f")).map(|f| f.frames()));
    });
    let shared = shared_with_peers();
    group.throughput(Throughput::Bytes(shared.len() as u64));
    group.bench_function("wide, ten markers", |b| {
        b.iter(|| read_tracks(black_box(shared.as_bytes()), Path::new("f")).map(|f| f.frames()));
    });
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

/// The very file that the Python peers make for themselves (`wide_text` in `xtask/src/bench/peers.py`).
fn shared_with_peers() -> String {
    let (frames, markers) = (20_000, 10);
    let row = |cell: &dyn Fn(usize) -> String| {
        let cells = (0..3 * markers).map(|i| ",".to_owned() + &cell(i));
        cells.collect::<Vec<_>>().concat()
    };
    let mut out = format!(
        "Format Version,1.23,Export Frame Rate,100,Length Units,Meters,Coordinate Space,Global\n\n,Type{}\n,Name{}\n,{}\n\
         Frame,Time (Seconds){}\n",
        row(&|_| "Marker".into()),
        row(&|i| format!("Marker {}", i / 3)),
        row(&|_| "Position".into()),
        row(&|i| ["X", "Y", "Z"][i % 3].into())
    );
    for frame in 0..frames {
        let time = frame as f64 / 100.0;
        let cells = row(&|i| {
            let digits = (frame * 7919 + i * 104_729) % 4_000_000;
            format!("{:.6}", digits as f64 / 1e6 - 2.0)
        });
        out += &[
            &*frame.to_string(),
            ",",
            &format!("{time:.6}"),
            &*cells,
            "\n",
        ]
        .concat();
    }
    out
}

/// A Motive recording of twenty minutes at 100 Hz, and what it takes from its bytes to fitted parameters.
fn whole_recording(c: &mut Criterion) {
    let tank = Tank {
        period_s: 30.0,
        cycles: 39,
        ..Tank::new(Swimmer::robot(), AnyGait::circle(1.2))
    };
    let text = tank.motive();
    let (campaign, mut data) = campaign(
        &tank,
        &[1.2_f64.to_degrees()],
        |_| text.clone(),
        tank.named(),
    );
    let mut group = c.benchmark_group("whole");
    group.sample_size(10);
    group.bench_function("20 min at 100 Hz, bytes to fit", |b| {
        b.iter(|| {
            data.runs[0] = tank.run_of(black_box(&text));
            calibrate_campaign(&campaign, &data, FitOptions::default()).map(|f| f.fit.chi)
        });
    });
    group.finish();
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

criterion_group!(benches, reading, whole_recording, fitting);
criterion_main!(benches);
