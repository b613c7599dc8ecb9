//! `cargo xtask bench`: runs our benches, the timing of the lab page, and Python packages for comparison ("peers") with one thread,
//! all in one run on one machine, and prints the ratios.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::debian;
use crate::disk::{entries, make_folder, read_bytes, write};
use crate::failure::{Failure, Outcome};
use crate::lab;
use crate::run::{cargo, command, read, run, target_folder, works};

/// Script that times the peers; it runs next to a copy of their modules.
const PEERS: &str = include_str!("bench/peers.py");
/// Open implementation of the GPOPS-II algorithm. It pins an older `CasADi`, so it has its own environment.
const YAPSS: &str = "yapss==0.2.3";
/// Script of the peers that uses it.
const YAPSS_SCRIPT: &str = "yap.py";
/// Newest versions at the time of writing, pinned so that ratios can be compared over time.
const PACKAGES: [&str; 4] = [
    "numpy==2.4.6",
    "scipy==1.17.1",
    "casadi==3.8.2",
    "pandas==3.1.1",
];
/// Variables that limit the libraries under `NumPy` to one thread.
const ONE_THREAD: [&str; 3] = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// Comparison of one of our benches with the peers.
struct Comparison {
    what: &'static str,
    /// Our bench, by the name of criterion's folder.
    ours: &'static str,
    /// Our implementation.
    by: &'static str,
    /// Key in the peers' JSON, and display name.
    peers: &'static [(&'static str, &'static str)],
}

const COMPARISONS: [Comparison; 8] = [
    Comparison {
        what: "A and W at one shape",
        ours: "f64/connection and power",
        by: "swimmer-model",
        peers: &[
            ("numpy_one", "NumPy, one shape a call"),
            ("casadi_one", "CasADi, one shape a call"),
        ],
    },
    Comparison {
        what: "A and W at 10 000 shapes a call, a shape",
        ours: "batch/connection and power, a shape",
        by: "gait-optimizer, in batches",
        peers: &[
            ("numpy_batch", "NumPy, 10 000 shapes a call, per shape"),
            ("casadi_batch", "CasADi, 10 000 shapes a call, per shape"),
        ],
    },
    Comparison {
        what: "one cycle of the best circle (ours: all of it, to 1e-10)",
        ours: "f64/stroke of the best circle",
        by: "swimmer-model",
        peers: &[("quarter_cycle", "gaits.py, a quarter of it by symmetry")],
    },
    Comparison {
        what: "Purcell's small Lighthill gait (ours: no guess, polished, with its certificate)",
        ours: "efficiency/purcell, small",
        by: COLD,
        peers: &[
            ("casadi purcell small", "CasADi 20x5, built and solved"),
            (
                "casadi warm purcell small",
                "CasADi 20x5, solved from a Fourier start",
            ),
            ("fourier purcell small", "Fourier chain N = 1, 2, 3"),
            (
                "shooting purcell small",
                "SciPy shooting from a guess right to 1e-4",
            ),
            ("yapss 1.3", "YAPSS, 10 segments, from a circle"),
        ],
    },
    Comparison {
        what: "Purcell's large Lighthill gait",
        ours: "efficiency/purcell, large",
        by: COLD,
        peers: &[
            ("casadi purcell large", "CasADi 20x5, built and solved"),
            (
                "casadi warm purcell large",
                "CasADi 20x5, solved from a Fourier start",
            ),
            ("fourier purcell large", "Fourier chain N = 1, 2, 3"),
            (
                "shooting purcell large",
                "SciPy shooting from a guess right to 1e-4",
            ),
            ("yapss 3.0", "YAPSS, 10 segments, from a circle"),
        ],
    },
    Comparison {
        what: "the robot's small Lighthill gait",
        ours: "efficiency/robot, small",
        by: COLD,
        peers: &[
            ("casadi robot small", "CasADi 20x5, built and solved"),
            (
                "casadi warm robot small",
                "CasADi 20x5, solved from a Fourier start",
            ),
            ("fourier robot small", "Fourier chain N = 1, 2, 3"),
            (
                "shooting robot small",
                "SciPy shooting from a guess right to 1e-4",
            ),
        ],
    },
    Comparison {
        what: "the robot's large Lighthill gait",
        ours: "efficiency/robot, large",
        by: COLD,
        peers: &[
            ("casadi robot large", "CasADi 20x5, built and solved"),
            (
                "casadi warm robot large",
                "CasADi 20x5, solved from a Fourier start",
            ),
            ("fourier robot large", "Fourier chain N = 1, 2, 3"),
            (
                "shooting robot large",
                "SciPy shooting from a guess right to 1e-4",
            ),
        ],
    },
    Comparison {
        what: "a wide Motive file of 20 000 frames and ten markers (6.0 MB), text to positions",
        ours: "reading/wide, ten markers",
        by: "calibrate, with its header understood",
        peers: &[
            ("reading csv", "Python's csv module and float()"),
            ("reading pandas", "pandas.read_csv"),
        ],
    },
];

/// Our search for a Lighthill gait.
const COLD: &str = "gait-optimizer, cold";

/// Runs the benches and, if they are available, the peers of `folder`.
///
/// # Errors
/// One of our benches fails. A peer that cannot run is reported and skipped.
pub(crate) fn run_all(folder: &Path) -> Outcome {
    run(
        &mut cargo(["bench", "--workspace", "--bench", "*"]),
        "fix what the benches report above",
    )?;
    if let Err(failure) = lab::bench() {
        println!("\n!!!! the lab page was NOT MEASURED !!!!\n{failure}");
    }
    let target = target_folder()?;
    match peers_times(folder, &target.join("peers")) {
        Ok(times) => print_comparisons(&target, &times),
        Err(failure) => {
            println!("\n!!!! NOT COMPARED with the Python peers !!!!\n{failure}");
            Ok(())
        }
    }
}

/// Copies the peers, creates their virtual environment if it is missing, and times them.
fn peers_times(folder: &Path, place: &Path) -> Outcome<Value> {
    make_folder(place)?;
    for module in entries(folder, |name| {
        Path::new(name)
            .extension()
            .is_some_and(|ending| ending == "py")
    })? {
        // `fs::copy` would also copy a write protection, and the next run could not replace the file.
        write(
            &place.join(module.file_name().unwrap_or_default()),
            read_bytes(&module)?,
        )?;
    }
    write(&place.join("peers.py"), PEERS)?;
    let python = environment(place)?;
    let mut times = command(python);
    times.current_dir(place).arg("peers.py");
    for name in ONE_THREAD {
        times.env(name, "1");
    }
    let next = "run it by hand to see why";
    let times = read(&mut times, next)?;
    let mut times: Value = serde_json::from_str(&times)
        .map_err(|why| Failure::new("reading what peers.py printed", why, next))?;
    match yapss_times(place) {
        Ok(found) => {
            for (start, seconds) in found {
                times[format!("yapss {start}")] = seconds.into();
            }
        }
        Err(failure) => println!("\n!!!! YAPSS NOT COMPARED !!!!\n{failure}"),
    }
    Ok(times)
}

/// Times of YAPSS for Purcell's swimmer with ten segments, by the radius of the initial circle.
fn yapss_times(place: &Path) -> Outcome<Vec<(String, f64)>> {
    let python = place.join("yapss/bin/python");
    if !works(command(&python).args(["-c", "import yapss"])) {
        run(
            command("python3")
                .args(["-m", "venv"])
                .arg(place.join("yapss")),
            "check `python3 -m venv --help`",
        )?;
        run(
            command(&python).args(["-m", "pip", "install", "--quiet", YAPSS]),
            "check the network and the package index of pip, and repeat the command",
        )?;
    }
    let mut script = command(python);
    script.current_dir(place).arg(YAPSS_SCRIPT);
    for name in ONE_THREAD {
        script.env(name, "1");
    }
    let printed = read(&mut script, "run it by hand to see why")?;
    Ok(printed.lines().filter_map(yapss_line).collect())
}

/// `yapss eps0 1.3 seg 10 col 6 xi=0.0123 time 0.17 s …` with ten segments: start and seconds.
fn yapss_line(line: &str) -> Option<(String, f64)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let after = |name: &str| {
        let at = words.iter().position(|word| *word == name)?;
        words.get(at + 1).copied()
    };
    (after("seg")? == "10").then_some(())?;
    Some((after("eps0")?.to_owned(), after("time")?.parse().ok()?))
}

/// Python of a virtual environment with the peers' packages.
fn environment(place: &Path) -> Outcome<PathBuf> {
    let python = place.join("venv/bin/python");
    if !works(command(&python).args(["-c", "import numpy, scipy"])) {
        debian::ensure_tool(
            command("python3").args(["-c", "import venv, ensurepip"]),
            &["python3", "python3-venv"],
        )?;
        run(
            command("python3")
                .args(["-m", "venv"])
                .arg(place.join("venv")),
            "check `python3 -m venv --help`",
        )?;
    }
    for package in PACKAGES {
        let module = package.split('=').next().unwrap_or(package);
        if works(command(&python).args(["-c", &format!("import {module}")])) {
            continue;
        }
        let next = "check the network and the package index of pip, and repeat the command";
        let installed = run(
            command(&python).args(["-m", "pip", "install", "--quiet", package]),
            next,
        );
        match installed {
            Err(failure) if module == "casadi" || module == "pandas" => {
                println!("\n!!!! {module} NOT COMPARED !!!!\n{failure}");
            }
            outcome => outcome?,
        }
    }
    Ok(python)
}

fn print_comparisons(target: &Path, times: &Value) -> Outcome {
    println!("\nBeside the Python peers, same run, one thread:");
    for comparison in COMPARISONS {
        let ours = our_time(target, comparison.ours)?;
        println!(
            "\n{}\n  {:>12}           {}",
            comparison.what,
            duration(ours),
            comparison.by
        );
        for (key, name) in comparison.peers {
            match times[*key].as_f64() {
                Some(theirs) => println!(
                    "  {:>12} {:>8} {name}",
                    duration(theirs),
                    ratio(theirs / ours)
                ),
                None => println!("  {:>12} {:>8} {name}", "skipped", ""),
            }
        }
    }
    for gait in [
        "purcell small",
        "purcell large",
        "robot small",
        "robot large",
    ] {
        if let Some(efficiency) = times[format!("xi {gait}")].as_f64() {
            println!("CasADi finds xi = {efficiency:.12} for the gait {gait}.");
        }
    }
    if let Some(displacement) = times["displacement_over_length"].as_f64() {
        println!("\ngaits.py finds X/L = {displacement:.10} for that circle.");
    }
    Ok(())
}

/// Time of one call \[s\]: the median in criterion's folder.
fn our_time(target: &Path, bench: &str) -> Outcome<f64> {
    let path = target
        .join("criterion")
        .join(bench)
        .join("new/estimates.json");
    let next = "check that the bench still has this name";
    let estimates: Value = serde_json::from_slice(&read_bytes(&path)?)
        .map_err(|why| Failure::new(format!("reading {}", path.display()), why, next))?;
    estimates["median"]["point_estimate"]
        .as_f64()
        .map(|nanoseconds| nanoseconds * 1e-9)
        .ok_or_else(|| {
            Failure::new(
                format!("reading {}", path.display()),
                "it has no median",
                next,
            )
        })
}

fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-6 => (s * 1e9, "ns"),
        s if s < 1e-3 => (s * 1e6, "us"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    format!("{value:.2} {unit}")
}

fn ratio(times: f64) -> String {
    if times < 10.0 {
        format!("x {times:.2}")
    } else {
        format!("x {times:.0}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_and_ratios_are_short() {
        assert_eq!(duration(1.234e-7), "123.40 ns");
        assert_eq!(duration(0.0456), "45.60 ms");
        assert_eq!(ratio(1.234), "x 1.23");
        assert_eq!(ratio(987.6), "x 988");
    }

    #[test]
    fn reads_what_yapss_prints() {
        let line = "yapss eps0 1.3 seg 10 col 6 xi=0.0123641546 time 0.17 s ";
        assert_eq!(yapss_line(line), Some(("1.3".to_owned(), 0.17)));
        assert_eq!(
            yapss_line("yapss eps0 1.3 seg 5 col 6 xi=0.01 time 0.17 s"),
            None
        );
        assert_eq!(yapss_line("IPOPT says hello"), None);
    }

    #[test]
    fn reads_the_median_that_criterion_left() {
        let target = tempfile::tempdir().unwrap();
        let file = target
            .path()
            .join("criterion/f64/some bench/new/estimates.json");
        write(
            &file,
            r#"{"median":{"point_estimate":250.0},"mean":{"point_estimate":300.0}}"#,
        )
        .unwrap();
        assert!((our_time(target.path(), "f64/some bench").unwrap() - 250e-9).abs() < 1e-15);
        assert!(our_time(target.path(), "f64/another").is_err());
    }
}
