//! Sweeps as a cluster runs them: split, killed, broken, on a full disk, and many.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use crate::binary::{command, number, on_a_small_disk, typed};

const SPEC: &str = r#"
swimmer = "purcell"
objective = "displacement"
max_rate = 1.0
block = 4
[bounds]
max_angle = 2.4
[[axis]]
name = "links.ratio"
from = 0.8
to = 1.4
count = 12
[[axis]]
name = "sphere.radius"
from = 0.0
to = 0.4
count = 12
"#;

fn planned(folder: &Path, spec: &str) {
    fs::write(folder.join("spec.toml"), spec).unwrap();
    typed(folder, "sweep plan spec.toml -o out").with_status(0);
}

/// The hash of the table of a finished sweep.
fn table(folder: &Path) -> String {
    let merged = typed(folder, "sweep merge out -o all.parquet --json --overwrite").with_status(0);
    merged.json()["sha256"].as_str().unwrap().to_owned()
}

/// Table of an uninterrupted run.
fn whole() -> String {
    let folder = tempfile::tempdir().unwrap();
    planned(folder.path(), SPEC);
    let ran = typed(folder.path(), "sweep run out --json")
        .with_status(0)
        .json();
    assert_eq!(
        (&ran["tasks"], &ran["done"], &ran["failed"]),
        (&144.into(), &144.into(), &0.into())
    );
    table(folder.path())
}

#[test]
fn the_table_is_the_same_after_ten_kills_and_of_any_shards() {
    let whole = whole();
    let folder = tempfile::tempdir().unwrap();
    planned(folder.path(), SPEC);
    let mut killed = 0;
    for kill in 0..10_u64 {
        let mut run = command(folder.path(), &["sweep", "run", "out", "--threads", "2"]);
        let mut run = run
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Anywhere: in the first block, between two, in a write.
        sleep(Duration::from_millis(20 + (kill * 7919) % 130));
        if run.try_wait().unwrap().is_none() {
            run.kill().unwrap();
            killed += 1;
        }
        run.wait().unwrap();
    }
    let status = typed(folder.path(), "sweep status out --json")
        .with_status(0)
        .json();
    assert_eq!(status["blocks_broken"], 0, "{status:#}");
    println!(
        "killed {killed} times, {} of 144 done by then",
        status["done"]
    );
    typed(folder.path(), "sweep run out").with_status(0);
    assert_eq!(table(folder.path()), whole);

    for (shards, threads) in [(2, 1), (7, 2)] {
        let folder = tempfile::tempdir().unwrap();
        planned(folder.path(), SPEC);
        for shard in 1..=shards {
            let line = format!("sweep run out --shard {shard}/{shards} --threads {threads}");
            typed(folder.path(), &line).with_status(0);
        }
        assert_eq!(
            table(folder.path()),
            whole,
            "{shards} shards, {threads} threads"
        );
    }
}

#[test]
fn a_task_of_a_job_array_runs_its_shard() {
    let folder = tempfile::tempdir().unwrap();
    planned(folder.path(), &SPEC.replace("displacement", "stub"));
    let run = |variables: &[(&str, &str)]| -> crate::binary::Ran {
        let mut run = command(folder.path(), &["sweep", "run", "out", "--json"]);
        run.envs(variables.iter().copied()).output().unwrap().into()
    };
    let third = run(&[
        ("SLURM_ARRAY_TASK_ID", "3"),
        ("SLURM_ARRAY_TASK_MIN", "1"),
        ("SLURM_ARRAY_TASK_COUNT", "5"),
    ]);
    let third = third.with_status(0).json();
    assert_eq!(
        (&third["shard"], &third["blocks"]),
        (&"3/5".into(), &7.into())
    );
    for wrong in ["9", "x"] {
        run(&[
            ("SLURM_ARRAY_TASK_ID", wrong),
            ("SLURM_ARRAY_TASK_COUNT", "5"),
        ])
        .with_status(2);
    }
    typed(folder.path(), "sweep run out --shard 0/5").with_status(2);
}

/// A quarter of the last block fits.
#[test]
fn a_full_disk_is_an_error_and_leaves_no_half_part() {
    let folder = tempfile::tempdir().unwrap();
    planned(
        folder.path(),
        &SPEC
            .replace("displacement", "stub")
            .replace("block = 4", "block = 64"),
    );
    let ran: crate::binary::Ran = on_a_small_disk(folder.path(), 1, &["sweep", "run", "out"])
        .output()
        .unwrap()
        .into();
    let ran = ran.with_status(1);
    assert!(ran.stderr.contains("nothing was changed there"), "{ran}");
    let status = typed(folder.path(), "sweep status out --json")
        .with_status(0)
        .json();
    assert_eq!(
        (&status["blocks_done"], &status["blocks_broken"]),
        (&0.into(), &0.into())
    );
    let parts = folder.path().join("out/parts/000000");
    assert_eq!(fs::read_dir(parts).map_or(0, Iterator::count), 0);

    typed(folder.path(), "sweep run out").with_status(0);
    let words = ["sweep", "merge", "out", "-o", "all.parquet"];
    let merged: crate::binary::Ran = on_a_small_disk(folder.path(), 2, &words)
        .output()
        .unwrap()
        .into();
    merged.with_status(1);
    assert!(!folder.path().join("all.parquet").exists());
    let left = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 2, "the spec and the folder");
}

/// The program's memory is limited to 1 GiB.
#[cfg(target_os = "linux")]
#[test]
fn a_million_designs_fit_into_a_gibibyte() {
    let folder = tempfile::tempdir().unwrap();
    planned(
        folder.path(),
        "swimmer = \"purcell\"\nobjective = \"stub\"\n\
         [[axis]]\nname = \"drag.chi\"\nfrom = 1\nto = 4\ncount = 1000\n\
         [[axis]]\nname = \"sphere.radius\"\nfrom = 0\nto = 1\ncount = 1000\n",
    );
    for line in [
        "sweep run out --threads 2",
        "sweep status out",
        "sweep merge out -o all.parquet --json",
    ] {
        let mut shell = std::process::Command::new("sh");
        let limited = [
            "-c",
            "ulimit -v 1048576; exec \"$@\"",
            "sh",
            env!("CARGO_BIN_EXE_swimmer"),
        ];
        shell.current_dir(folder.path()).args(limited);
        let ran: crate::binary::Ran = shell.args(line.split(' ')).output().unwrap().into();
        let ran = ran.with_status(0);
        if line.ends_with("--json") {
            let merged = ran.json();
            assert_eq!(merged["done"], 1_000_000);
            println!("a table of {} bytes", merged["bytes"]);
        }
    }
}

#[test]
fn a_map_is_drawn_and_exported() {
    let folder = tempfile::tempdir().unwrap();
    planned(folder.path(), SPEC);
    typed(folder.path(), "sweep run out").with_status(0);
    for quantity in [
        "displacement",
        "efficiency",
        "speed",
        "amplitude",
        "structure",
        "pareto",
    ] {
        let line = format!("sweep map out --quantity {quantity} -o {quantity}.svg");
        typed(folder.path(), &line).with_status(0);
        let svg = fs::read_to_string(folder.path().join(format!("{quantity}.svg"))).unwrap();
        assert!(svg.contains("<svg") && svg.len() > 2000);
    }
    let line = "sweep map out --across sphere.radius --export map.json -o map.png --json";
    let answer = typed(folder.path(), line).with_status(0).json();
    assert_eq!(
        (&answer["designs"], &answer["without_gait"]),
        (&144.into(), &0.into())
    );
    let text = fs::read_to_string(folder.path().join("map.json")).unwrap();
    let map: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(map["format"], "swimmer-sweep-map 1");
    assert_eq!(map["axes"][0]["name"], "sphere.radius");
    let names: Vec<_> = map["quantities"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["name"])
        .collect();
    assert!(
        names.contains(&&"displacement_over_length".into()),
        "{names:?}"
    );
    assert_eq!(map["quantities"][0]["values"].as_array().unwrap().len(), 12);
    assert!(number(&map["pareto"][0], "efficiency") > 0.0);
    // A design of the front is named by its place on the plan's axes, and the map has the same numbers there.
    let axes = map["plan_axes"].as_array().unwrap();
    let at = |name: &str| axes.iter().position(|axis| axis["name"] == name).unwrap();
    let design = &map["pareto"][0]["design"];
    let cell = |axis: usize| {
        let place = &map["axes"][axis];
        let value = &design[at(place["name"].as_str().unwrap())];
        let values = place["values"].as_array().unwrap();
        values.iter().position(|one| one == value).unwrap()
    };
    let quantities = map["quantities"].as_array().unwrap();
    let of = |name: &str| quantities.iter().find(|one| one["name"] == name).unwrap();
    assert_eq!(
        of("efficiency")["values"][cell(1)][cell(0)],
        map["pareto"][0]["efficiency"]
    );
    typed(folder.path(), "sweep map out --at sphere.radius=x -o y.svg").with_status(2);
    typed(folder.path(), "sweep map out --up drag.chi").with_status(2);
}

#[test]
fn a_script_for_slurm_needs_a_time() {
    let folder = tempfile::tempdir().unwrap();
    planned(folder.path(), SPEC);
    let refused = typed(folder.path(), "sweep submit slurm out --shards 3").with_status(2);
    assert!(refused.stderr.contains("--time MINUTES"), "{refused}");
    typed(folder.path(), "sweep run out --shard 1/18").with_status(0);
    let line = "sweep submit slurm out --shards 3 --cores 2 --option=--partition=short --json";
    let answer = typed(folder.path(), line).with_status(0).json();
    assert_eq!(
        (&answer["minutes"], &answer["job"]),
        (&5.into(), &serde_json::Value::Null)
    );
    let script = fs::read_to_string(folder.path().join("out/slurm.sh")).unwrap();
    for line in [
        "#SBATCH --array=1-3",
        "#SBATCH --requeue",
        "#SBATCH --cpus-per-task=2",
        "#SBATCH --time=5",
        "#SBATCH --partition=short",
    ] {
        assert!(script.lines().any(|one| one == line), "{script}");
    }
}

/// Prints the speed-up of two threads over one, the best of three runs each: a figure for a quiet machine, so it is printed, not
/// checked.
#[test]
#[ignore = "takes a minute, and tells times"]
fn strong_scaling_on_two_cores() {
    let folder = tempfile::tempdir().unwrap();
    let spec = SPEC.replace("count = 12", "count = 24");
    fs::write(folder.path().join("spec.toml"), spec).unwrap();
    let mut best = [f64::INFINITY; 2];
    for round in 0..3 {
        for (threads, best) in (1..).zip(&mut best) {
            let sweep = format!("of-{threads}-{round}");
            typed(folder.path(), &format!("sweep plan spec.toml -o {sweep}")).with_status(0);
            let line = format!("sweep run {sweep} --threads {threads} --json");
            let ran = typed(folder.path(), &line).with_status(0).json();
            *best = best.min(number(&ran, "seconds"));
        }
    }
    let [one, two] = best;
    println!(
        "576 designs: {one:.2} s on one thread, {two:.2} s on two, {:.2} times as fast",
        one / two
    );
}
