//! Duration of a height map with its frame.

use criterion::{Criterion, criterion_group, criterion_main};
use gait_optimizer::{HeightMap, Row};
use swimmer_model::Swimmer;

fn maps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("height map");
    for (name, swimmer) in [("purcell", Swimmer::purcell()), ("robot", Swimmer::robot())] {
        group.bench_function(format!("{name}, 201 x 201, 2.8 rad"), |bench| {
            bench.iter(|| HeightMap::new(&swimmer, 2.8).map(|map| map.grid(Row::X, 201)));
        });
        group.bench_function(format!("{name}, zero-level curves"), |bench| {
            let map = HeightMap::new(&swimmer, 2.8);
            bench.iter(|| map.as_ref().map(|map| map.zero_curves(Row::X)));
        });
    }
    group.finish();
}

criterion_group!(benches, maps);
criterion_main!(benches);
