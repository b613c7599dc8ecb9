//! Sweeps from the spec to the table: identical bytes for every split, no lost and no incomplete part.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::RowAccessor as _;
use sweep::{Plan, Ran, Running, Shard, Slice, SweepError, doubts, map, merge, run, status};

const GRID: &str = r#"
swimmer = "purcell"
objective = "displacement"
max_rate = 1.0
block = 8
anchor = 4
[bounds]
max_angle = 2.4
[[axis]]
name = "drag.chi"
values = [1.8, 2.0, 2.2]
[[axis]]
name = "sphere.radius"
from = 0.0
to = 0.3
count = 9
"#;

fn plan(text: &str) -> Plan {
    Plan::of_spec(text, "spec.toml".as_ref()).unwrap()
}

fn ran(plan: &Plan, folder: &Path, shard: Shard, threads: usize) -> Ran {
    run(
        plan,
        folder,
        &Running {
            shard,
            threads,
            seconds: &|| 0.0,
            watch: &|_| (),
        },
    )
    .unwrap()
}

/// Table of a sweep that is run in `shards` shards of `threads` threads.
fn table(text: &str, shards: u64, threads: usize) -> Vec<u8> {
    let plan = plan(text);
    let folder = tempfile::tempdir().unwrap();
    for number in 1..=shards {
        ran(
            &plan,
            folder.path(),
            Shard::new(number, shards).unwrap(),
            threads,
        );
    }
    let table = folder.path().join("all.parquet");
    merge(&plan, folder.path(), &table).unwrap();
    fs::read(table).unwrap()
}

#[test]
fn the_table_does_not_depend_on_shards_and_threads() {
    let whole = table(GRID, 1, 1);
    for (shards, threads) in [(1, 2), (2, 1), (7, 2)] {
        assert!(
            table(GRID, shards, threads) == whole,
            "{shards} shards, {threads} threads"
        );
    }
}

/// Payload of a callback that ends a run.
struct Enough;

#[test]
fn a_callback_ends_a_run_and_finished_blocks_stay() {
    let plan = plan(GRID);
    for threads in [1, 3] {
        let folder = tempfile::tempdir().unwrap();
        let calls = AtomicU64::new(0);
        let running = Running {
            shard: Shard::WHOLE,
            threads,
            seconds: &|| 0.0,
            watch: &|_| {
                calls.fetch_add(1, Ordering::Relaxed);
                resume_unwind(Box::new(Enough));
            },
        };
        let ended = catch_unwind(AssertUnwindSafe(|| run(&plan, folder.path(), &running)));
        // The payload of any thread reaches the caller.
        assert!(ended.unwrap_err().is::<Enough>());
        let blocks = calls.into_inner();
        assert!((1..=threads as u64).contains(&blocks), "{blocks} blocks");
        let status = status(&plan, folder.path()).unwrap();
        assert_eq!(status.blocks_done, blocks);
        assert!(blocks < status.blocks);
        let rest = ran(&plan, folder.path(), Shard::WHOLE, threads);
        assert_eq!((rest.skipped, rest.tasks), (blocks, plan.tasks()));
    }
}

#[test]
fn shards_are_read() {
    assert_eq!("2/7".parse(), Ok(Shard::new(2, 7).unwrap()));
    for text in ["", "2", "0/7", "8/7", "two/7", "1/2/3"] {
        let shard: Result<Shard, String> = text.parse();
        assert!(shard.is_err(), "{text}");
    }
}

#[test]
fn the_table_is_sorted_and_whole() {
    let plan = plan(GRID);
    let folder = tempfile::tempdir().unwrap();
    ran(&plan, folder.path(), Shard::WHOLE, 2);
    let path = folder.path().join("all.parquet");
    let merged = merge(&plan, folder.path(), &path).unwrap();
    assert_eq!((merged.tasks, merged.failed, merged.certified), (27, 0, 27));
    let reader = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    for (key, row) in reader.get_row_iter(None).unwrap().enumerate() {
        let row = row.unwrap();
        let point = plan.point(key as u64);
        assert_eq!(row.get_long(0).unwrap(), i64::try_from(key).unwrap());
        for (column, value) in point.iter().enumerate() {
            assert_eq!(
                row.get_double(column + 1).unwrap().to_bits(),
                value.to_bits()
            );
        }
        assert!(row.get_double(3).unwrap() > 0.0);
        let names: Vec<_> = row
            .get_column_iter()
            .map(|(name, _)| name.clone())
            .collect();
        assert_eq!(
            names[..4],
            ["key", "drag.chi", "sphere.radius", "objective"]
        );
    }
    let metadata = reader.metadata().file_metadata();
    let told = metadata.key_value_metadata().unwrap();
    assert!(
        told.iter()
            .any(|pair| pair.value.as_deref() == Some(plan.hash().as_str()))
    );
}

#[test]
fn what_is_finished_is_passed_over_and_what_is_broken_is_made_again() {
    let plan = plan(GRID);
    let folder = tempfile::tempdir().unwrap();
    ran(&plan, folder.path(), Shard::new(1, 2).unwrap(), 1);
    let unfinished = merge(&plan, folder.path(), &folder.path().join("x")).unwrap_err();
    assert!(
        matches!(
            unfinished,
            SweepError::Unfinished {
                missing: 2,
                first: 1,
                ..
            }
        ),
        "{unfinished}"
    );
    let rest = ran(&plan, folder.path(), Shard::WHOLE, 1);
    assert_eq!((rest.done, rest.skipped), (4, 2));
    let whole = |name: &str| {
        let path = folder.path().join(name);
        merge(&plan, folder.path(), &path).unwrap();
        fs::read(path).unwrap()
    };
    let before = whole("before");

    let part = folder.path().join("parts/000000/000000002.part");
    let mut bytes = fs::read(&part).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&part, bytes).unwrap();
    assert_eq!(status(&plan, folder.path()).unwrap().blocks_broken, 1);
    merge(&plan, folder.path(), &folder.path().join("x")).unwrap_err();
    assert!(!folder.path().join("x").exists());
    assert_eq!(ran(&plan, folder.path(), Shard::WHOLE, 1).skipped, 3);
    assert!(whole("after") == before);
}

#[test]
fn a_plan_never_changes() {
    let folder = tempfile::tempdir().unwrap();
    let ours = plan(GRID);
    let path = ours.save(folder.path()).unwrap();
    ours.save(folder.path()).unwrap();
    assert_eq!(Plan::load(folder.path()).unwrap(), ours);
    let other = plan(&GRID.replace("2.4", "2.3"));
    assert_ne!(other.hash(), ours.hash());
    let refused = other.save(folder.path()).unwrap_err();
    assert!(matches!(refused, SweepError::OtherPlan { .. }), "{refused}");
    let elsewhere = tempfile::tempdir().unwrap();
    fs::write(elsewhere.path().join("mine"), "mine").unwrap();
    let taken = ours.save(elsewhere.path()).unwrap_err();
    assert!(matches!(taken, SweepError::Taken { .. }), "{taken}");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("2.4", "2.5")).unwrap();
    let changed = Plan::load(folder.path()).unwrap_err();
    assert!(matches!(changed, SweepError::Changed { .. }), "{changed}");
}

#[test]
fn a_hundred_million_tasks_are_a_rule() {
    let text = "swimmer = \"purcell\"\nobjective = \"stub\"\ndesign = \"random\"\ncount = 100000000\n\
        [[axis]]\nname = \"drag.chi\"\nfrom = 1\nto = 4\n\
        [[axis]]\nname = \"sphere.radius\"\nfrom = 0\nto = 1\n";
    let random = plan(text);
    assert_eq!(
        (random.tasks(), random.block_size(), random.blocks()),
        (100_000_000, 16_384, 6_104)
    );
    // A point does not depend on the order of the calls.
    let last = random.point(99_999_999);
    assert_eq!(last, plan(text).point(99_999_999));
    assert_ne!(last, random.point(99_999_998));
    let grid = plan(
        "swimmer = \"purcell\"\nobjective = \"stub\"\n\
        [[axis]]\nname = \"drag.chi\"\nfrom = 1\nto = 4\ncount = 10000\n\
        [[axis]]\nname = \"sphere.radius\"\nfrom = 0.001\nto = 1\nscale = \"log\"\ncount = 10000\n",
    );
    assert_eq!(grid.tasks(), 100_000_000);
    assert_eq!(grid.point(99_999_999), [4.0, 1.0]);
    assert_eq!(grid.point(0), [1.0, 0.001]);
}

#[test]
fn sobol_points_fill_every_cell() {
    let plan = plan(
        "swimmer = \"purcell\"\nobjective = \"stub\"\ndesign = \"sobol\"\ncount = 256\nseed = 3\n\
        [[axis]]\nname = \"drag.chi\"\nfrom = 1\nto = 2\n\
        [[axis]]\nname = \"sphere.radius\"\nfrom = 0\nto = 1\n",
    );
    // A (0, 8, 2) net: one point in each of 16 × 16 squares.
    let mut seen = std::collections::BTreeSet::new();
    for key in 0..256 {
        let point = plan.point(key);
        seen.insert([point[0] - 1.0, point[1]].map(|share| (share * 16.0).floor().to_bits()));
    }
    assert_eq!(seen.len(), 256);
}

#[test]
fn mistakes_are_told_with_their_place() {
    for (wrong, place, said) in [
        ("objective = \"fast\"", ":3:13:", "none of displacement"),
        ("objective = \"speed\"", ":3:13:", "max_rate"),
        ("gait = \"small\"", ":3:8:", "objective = \"efficiency\""),
        ("colour = 1", ":3:1:", "colour"),
        ("design = \"random\"", ":3:10:", "count"),
        ("block = 0", ":3:9:", "block = 0 must be from 1"),
    ] {
        let head = if wrong.starts_with("objective") {
            format!("swimmer = \"purcell\"\n\n{wrong}")
        } else {
            format!("swimmer = \"purcell\"\nobjective = \"displacement\"\n{wrong}")
        };
        let text = format!("{head}\n[[axis]]\nname = \"drag.chi\"\nvalues = [2]\n");
        let told = Plan::of_spec(&text, "mine.toml".as_ref())
            .unwrap_err()
            .to_string();
        assert!(
            told.contains(&format!("mine.toml{place}")) && told.contains(said),
            "{told}"
        );
    }
    for (axis, said) in [
        (
            "name = \"drag.chy\"\nvalues = [1]",
            "did you mean drag.chi?",
        ),
        (
            "name = \"fluid.density\"\nvalues = [1]",
            "does not change which gait is best",
        ),
        ("name = \"drag.chi\"\nvalues = [0]", "0 is no value of it"),
        (
            "name = \"drag.chi\"\nfrom = 1\nto = 2",
            "a grid needs count",
        ),
        (
            "name = \"drag.chi\"\nfrom = 1",
            "say values = [...], or from and to",
        ),
        ("name = \"drag.chi\"\nvalues = []", "no values"),
        (
            "name = \"sphere.radius\"\nfrom = 0\nto = 1\ncount = 3\nscale = \"log\"",
            "above zero",
        ),
        (
            "name = \"links.side\"\nvalues = [1]\n[[axis]]\nname = \"links.ratio\"\nvalues = [1]",
            "say the same thing twice",
        ),
        (
            "name = \"bounds.no_overlap\"\nvalues = [true]\n[[axis]]\nname = \"bounds.clearance\"\nvalues = [0.1]",
            "say the same thing twice",
        ),
        (
            "name = \"bounds.sector\"\nvalues = [0, 1]",
            "say values = [false, true]",
        ),
        (
            "name = \"bounds.sector\"\nfrom = false\nto = true\ncount = 2",
            "say values = [false, true]",
        ),
        (
            "name = \"drag.chi\"\nvalues = [true]",
            "neither true nor false",
        ),
        (
            "name = \"bounds.no_overlap\"\nvalues = [true]\n[bounds]\nclearance = 0.1",
            "a clearance keeps the links apart in every design",
        ),
        (
            "name = \"objective\"\nvalues = [\"speed\"]",
            "the objective is an axis, too",
        ),
    ] {
        let text =
            format!("swimmer = \"purcell\"\nobjective = \"displacement\"\n[[axis]]\n{axis}\n");
        let error = Plan::of_spec(&text, "mine.toml".as_ref()).unwrap_err();
        assert!(
            error.is_bad_input() && error.to_string().contains(said),
            "{error}"
        );
    }
}

/// Each design has the result of a plan with its objective alone; designs of different objectives are not neighbours.
#[test]
fn the_objective_is_an_axis() {
    let rest = "max_rate = 1.0\n[bounds]\nmax_angle = 2.0\n\
         [[axis]]\nname = \"sphere.radius\"\nfrom = 0.0\nto = 0.2\ncount = 3\n";
    let words = ["displacement", "efficiency small", "turning"];
    let axis = format!("[[axis]]\nname = \"objective\"\nvalues = {words:?}\n");
    let rows = |text: &str| {
        let (plan, folder) = (plan(text), tempfile::tempdir().unwrap());
        ran(&plan, folder.path(), Shard::WHOLE, 1);
        assert_eq!(doubts(&plan, folder.path()).unwrap(), []);
        let table = folder.path().join("all.parquet");
        merge(&plan, folder.path(), &table).unwrap();
        let reader = SerializedFileReader::new(fs::File::open(table).unwrap()).unwrap();
        let rows = reader.get_row_iter(None).unwrap();
        rows.map(|row| {
            let row = row.unwrap();
            let of = |name: &str| {
                let mut columns = row.get_column_iter();
                columns
                    .find(|(column, _)| *column == name)
                    .map(|(_, field)| field.to_string())
            };
            let best_for = of("best_for").map(|word| word.replace('"', ""));
            (
                best_for,
                of("sphere.radius").unwrap(),
                of("objective").unwrap(),
                of("arcs").unwrap(),
            )
        })
        .collect::<Vec<_>>()
    };
    let swimmer = "swimmer = \"purcell\"\n";
    for all in [
        format!("{swimmer}{rest}{axis}"),
        format!(
            "{swimmer}{}",
            rest.replacen("[[axis]]", &format!("{axis}[[axis]]"), 1)
        ),
    ] {
        let all = rows(&all);
        assert_eq!(all.len(), 9);
        for word in words {
            let gait = if word.starts_with("efficiency") {
                "objective = \"efficiency\""
            } else {
                &format!("objective = \"{word}\"")
            };
            let alone = rows(&format!("{swimmer}{gait}\n{rest}"));
            let ours: Vec<_> = all
                .iter()
                .filter(|row| row.0.as_deref() == Some(word))
                .collect();
            for (ours, alone) in ours.iter().zip(&alone) {
                assert_eq!((&ours.1, &ours.3), (&alone.1, &alone.3), "{word}");
                let [ours, alone] = [&ours.2, &alone.2].map(|value| value.parse::<f64>().unwrap());
                assert!((ours / alone - 1.0).abs() < 1e-7, "{word}: {ours} {alone}");
            }
            assert_eq!((ours.len(), alone.len()), (3, 3));
        }
    }
    let refused = |axis: &str| {
        let text = format!("swimmer = \"purcell\"\nmax_rate = 1.0\n{axis}");
        Plan::of_spec(&text, "mine.toml".as_ref())
            .unwrap_err()
            .to_string()
    };
    let objective = "[[axis]]\nname = \"objective\"\n";
    assert!(
        refused(&format!("{objective}values = [\"spped\"]"))
            .contains("say values = [\"displacement\"")
    );
    assert!(
        refused(&format!("{objective}from = 1\nto = 2\ncount = 2"))
            .contains("say values = [\"displacement\"")
    );
    assert!(refused("[[axis]]\nname = \"drag.chi\"\nvalues = [2.0]\n").contains("no objective"));
    let quarter = "[[axis]]\nname = \"bounds.min_angle\"\nvalues = [1.0]\n";
    let both = format!("{objective}values = [\"displacement\", \"speed\"]\n{quarter}");
    assert!(refused(&both).contains("displacement gaits alone"));
}

#[test]
fn a_choice_is_an_axis() {
    let folder = |text: &str| {
        let (plan, folder) = (plan(text), tempfile::tempdir().unwrap());
        ran(&plan, folder.path(), Shard::WHOLE, 1);
        (plan, folder)
    };
    let (plan, all) = folder(
        "swimmer = \"purcell\"\nobjective = \"displacement\"\n[bounds]\nmax_angle = 2.9\n\
         [[axis]]\nname = \"bounds.sector\"\nvalues = [false, true]\n\
         [[axis]]\nname = \"bounds.no_overlap\"\nvalues = [false, true]\n",
    );
    assert_eq!(plan.point(1), [0.0, 1.0]);
    let slice = Slice::first(&plan).unwrap();
    let found = map(&plan, all.path(), &slice).unwrap();
    let quantity =
        |map: &sweep::Map, row: usize, column: usize| map.quantities[0].values[row][column];
    for (sector, no_overlap) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let (alone, one) = folder(&format!(
            "swimmer = \"purcell\"\nobjective = \"displacement\"\n\
             [bounds]\nmax_angle = 2.9\nsector = {}\nno_overlap = {}\n\
             [[axis]]\nname = \"drag.chi\"\nvalues = [2]\n[[axis]]\nname = \"sphere.radius\"\nvalues = [0]\n",
            sector == 1,
            no_overlap == 1,
        ));
        let told = map(&alone, one.path(), &Slice::first(&alone).unwrap()).unwrap();
        let (ours, told) = (quantity(&found, no_overlap, sector), quantity(&told, 0, 0));
        assert_eq!(
            ours.map(f64::to_bits),
            told.map(f64::to_bits),
            "{sector} {no_overlap}"
        );
    }
    let farthest = |row, column| quantity(&found, row, column).unwrap().abs();
    assert!(
        farthest(1, 1) < 0.9 * farthest(0, 1),
        "crossing links reach farther"
    );
    assert!(
        farthest(0, 0) < farthest(0, 1),
        "the sector is that of the other way"
    );
    assert_eq!(doubts(&plan, all.path()).unwrap(), []);
}

#[test]
fn a_map_has_the_grids_numbers_and_its_folds() {
    let plan = plan(&GRID.replace("max_angle = 2.4", "max_angle = 2.8"));
    let folder = tempfile::tempdir().unwrap();
    ran(&plan, folder.path(), Shard::WHOLE, 2);
    let slice = Slice::first(&plan).unwrap();
    let found = map(&plan, folder.path(), &slice).unwrap();
    assert_eq!(found.axes.each_ref().map(|axis| axis.values.len()), [3, 9]);
    assert!(
        found
            .quantities
            .iter()
            .all(|one| one.values.len() == 9 && one.values[0].len() == 3)
    );
    let kinds: std::collections::BTreeSet<_> = found.structure.iter().flatten().collect();
    assert_eq!(kinds.len() > 1, !found.folds.is_empty());
    assert!(!found.pareto.is_empty());
    assert!(
        found.pareto.windows(2).all(|pair| {
            pair[0].speed < pair[1].speed && pair[0].efficiency > pair[1].efficiency
        })
    );
    doubts(&plan, folder.path()).unwrap();
}
