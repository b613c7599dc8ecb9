//! `swimmer tracks` on a recording in every format, and on broken ones.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use crate::binary::{swimmer, swimmer_in};

/// The project's own recordings, one in every format; `calibrate` holds what they must say.
#[test]
fn every_format_is_told_by_name() {
    let folder = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../calibrate/tests/formats"
    ));
    let mut formats = BTreeSet::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let frames_alone = ["deeplabcut", "sleap"]
            .iter()
            .any(|of| name.starts_with(of));
        let rate: &[&str] = if frames_alone {
            &["--rate", "100"]
        } else {
            &[]
        };
        let words = [&["tracks", path.to_str().unwrap(), "--json"], rate].concat();
        let held = swimmer(&words).with_status(0).json();
        let format = held["format"].as_str().unwrap().to_owned();
        // The version of the exporter is part of the format.
        if let Some((_, version)) = name.trim_end_matches(".csv").split_once("-1.") {
            assert!(
                format.ends_with(&format!("-1.{version}")),
                "{name}: {format}"
            );
        }
        assert!(held["frames"].as_u64().unwrap() > 1, "{name}: {held:#}");
        assert!(
            !held["points"].as_array().unwrap().is_empty(),
            "{name}: {held:#}"
        );
        formats.insert(format);
    }
    for format in [
        "motive-1.23",
        "trackingtools-1.0",
        "tracker",
        "deeplabcut",
        "table",
        "trc",
        "qtm",
    ] {
        assert!(formats.contains(format), "{format} of {formats:?}");
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
