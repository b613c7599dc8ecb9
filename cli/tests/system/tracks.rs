//! `swimmer tracks` on the real files of the shared collection, and on broken ones.

use std::path::PathBuf;

use serde_json::Value;

use crate::binary::{swimmer, swimmer_in};

/// What must be said of each file.
struct Expected {
    file: &'static str,
    format: &'static str,
    rate_hz: f64,
    unit: &'static str,
    frames: u64,
}

/// The figures of the collection's manifest.
const COLLECTION: [Expected; 12] = [
    Expected {
        file: "motive_v1.23_ernesto_rb_markers.csv",
        format: "motive-1.23",
        rate_hz: 120.0,
        unit: "m",
        frames: 499,
    },
    Expected {
        file: "motive_v1.23_pathviewr_feb20_trunc.csv",
        format: "motive-1.23",
        rate_hz: 100.0,
        unit: "m",
        frames: 100,
    },
    Expected {
        file: "motive_v1.23_pathviewr_rb100.csv",
        format: "motive-1.23",
        rate_hz: 100.0,
        unit: "m",
        frames: 934,
    },
    Expected {
        file: "motive_v1.24_slow5_EXCERPT.csv",
        format: "motive-1.24",
        rate_hz: 120.0,
        unit: "cm",
        frames: 8,
    },
    Expected {
        file: "tt_v1.0_olin.csv",
        format: "trackingtools-1.0",
        rate_hz: 250.0,
        unit: "m",
        frames: 1668,
    },
    Expected {
        file: "motive_v1.1_olin.csv",
        format: "motive-1.1",
        rate_hz: 120.0,
        unit: "m",
        frames: 548,
    },
    Expected {
        file: "motive_v1.1_tensegrity_unlabeled13.csv",
        format: "motive-1.1",
        rate_hz: 120.0,
        unit: "m",
        frames: 1694,
    },
    Expected {
        file: "tracker6_multi_brocku.txt",
        format: "tracker",
        rate_hz: 0.0,
        unit: "unknown",
        frames: 1,
    },
    Expected {
        file: "tracker_single_brocku.txt",
        format: "tracker",
        rate_hz: 31.25,
        unit: "unknown",
        frames: 2,
    },
    Expected {
        file: "tracker_wide_arnoldjames_EXCERPT.csv",
        format: "tracker",
        rate_hz: 30.0,
        unit: "unknown",
        frames: 6,
    },
    Expected {
        file: "qtm_Measurement1_TRIMMED.tsv",
        format: "qtm",
        rate_hz: 100.0,
        unit: "mm",
        frames: 2,
    },
    Expected {
        file: "trc_README_example.trc",
        format: "trc",
        rate_hz: 60.0,
        unit: "mm",
        frames: 2,
    },
];

#[test]
fn every_real_file_is_read() {
    let collection = PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../shared/optitrack"
    ));
    if !collection.is_dir() {
        eprintln!(
            "\n*** SKIPPED: no collection of real tracking files at {} ***\n",
            collection.display()
        );
        return;
    }
    for expected in COLLECTION {
        let path = collection.join(expected.file);
        if !path.is_file() {
            eprintln!("\n*** SKIPPED: {} is missing ***\n", path.display());
            continue;
        }
        let ran = swimmer(&["tracks", path.to_str().unwrap(), "--json"]);
        let held = ran.with_status(0).json();
        assert_eq!(held["format"], expected.format, "{held:#}");
        // Stamps are rounded, or jitter.
        let rate = &held["rate_hz"];
        if expected.frames == 1 {
            assert!(rate.is_null(), "a single frame tells no rate: {held:#}");
        } else {
            let off = rate.as_f64().unwrap() - expected.rate_hz;
            assert!(off.abs() <= 5e-3 * expected.rate_hz, "{held:#}");
        }
        assert_eq!(held["unit"], expected.unit, "{held:#}");
        assert_eq!(held["frames"], expected.frames, "{held:#}");
        assert!(!held["points"].as_array().unwrap().is_empty(), "{held:#}");
    }
}

#[test]
fn a_broken_file_has_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = "t,x1,y1,x2,y2\n0,1,2,3,4\n0.01,1,two,3,4\n";
    std::fs::write(folder.path().join("broken.csv"), text).unwrap();
    let ran = swimmer_in(folder.path(), &["tracks", "broken.csv", "--json"]).with_status(2);
    assert!(
        ran.stderr.contains("broken.csv:3:8"),
        "line 3, column 8 holds `two`: {ran}"
    );
    assert!(matches!(ran.json()["error"], Value::String(_)), "{ran}");
}

#[test]
fn an_unclosed_quote_has_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = "Format Version,1.23,Take Name,\"tank,Export Frame Rate,100\n\nFrame,Time\n";
    std::fs::write(folder.path().join("quote.csv"), text).unwrap();
    let ran = swimmer_in(folder.path(), &["tracks", "quote.csv"]).with_status(2);
    assert!(ran.stderr.contains("quote.csv:1:"), "{ran}");
}

#[test]
fn a_single_frame_tells_no_rate() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("one.csv"),
        "t,x1,y1,x2,y2\n0.5,0.1,0.2,0.3,0.4\n",
    )
    .unwrap();
    let words = ["tracks", "one.csv", "--scale", "1"];
    let ran = swimmer_in(folder.path(), &[&words[..], &["--json"]].concat()).with_status(0);
    let holdings = ran.json();
    assert_eq!(holdings.get("rate_hz"), Some(&Value::Null), "{ran}");
    assert_eq!(holdings["frames"], 1);
    let ran = swimmer_in(folder.path(), &words).with_status(0);
    assert!(
        ran.stdout.contains("unknown") && !ran.stdout.contains("0 Hz"),
        "{ran}"
    );
}
