//! `swimmer paper` as the validation suite: every number of the paper comes out, or is marked with the reason.

use std::collections::HashSet;
use std::fs;

use crate::binary::{swimmer, swimmer_in};

#[test]
fn every_number_of_the_paper() {
    let document = swimmer(&["paper", "--json"]).with_status(0).json();
    let rows = document["rows"].as_array().unwrap();
    assert!(rows.len() >= 50, "{}", rows.len());
    let mut ids = HashSet::new();
    let mut open = 0;
    for row in rows {
        let id = row["id"].as_str().unwrap();
        assert!(ids.insert(id), "{id} twice");
        assert!(row["quantity"].is_string(), "{row}");
        assert!(
            row["paper"].is_number() || row["paper"].is_string(),
            "{row}"
        );
        assert!(
            row["ours"].is_number() && row["deviation"].is_number(),
            "{row}"
        );
        if row["pass"].is_null() {
            open += 1;
            assert!(row["note"].is_string(), "no reason: {row}");
        } else {
            assert_eq!(row["pass"], true, "{row}");
        }
    }
    assert!(open * 10 <= rows.len(), "{open} of {}", rows.len());
    // Numbers that the paper prints are counted apart from its statements, which have none.
    for (kind, claim) in [("numbers", "number"), ("statements", "statement")] {
        let of_kind: Vec<_> = rows.iter().filter(|row| row["claim"] == claim).collect();
        let passed = of_kind.iter().filter(|row| row["pass"] == true).count();
        let tally = &document[kind];
        assert_eq!(tally["reproduced"], passed, "{tally}");
        assert_eq!(tally["differ"], 0, "{tally}");
        assert_eq!(tally["open"], of_kind.len() - passed, "{tally}");
    }
    for row in rows.iter().filter(|row| row["claim"] == "number") {
        let paper = row["paper"].to_string();
        assert!(paper.contains(|c: char| c.is_ascii_digit()), "{row}");
    }
    // The ratios by name.
    for (id, paper) in [
        ("displacement.c_over_b", 1.55),
        ("displacement.d_over_b", 2.04),
        ("displacement.d_over_c", 1.31),
        ("lighthill.purcell.large_over_small", 1.46),
        ("lighthill.purcell.large_over_square", 1.20),
        ("lighthill.robot.large_over_small", 1.45),
        ("lighthill.robot.large_over_square", 1.90),
    ] {
        let row = rows.iter().find(|row| row["id"] == id).unwrap();
        let ours = row["ours"].as_f64().unwrap();
        assert!((ours / paper - 1.0).abs() < 0.01, "{row}");
    }
}

#[test]
fn the_figures_and_the_page() {
    let folder = tempfile::tempdir().unwrap();
    swimmer_in(folder.path(), &["paper", "-o", "out"]).with_status(0);
    let out = folder.path().join("out");
    let names: Vec<String> = fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let pictures: Vec<&str> = names
        .iter()
        .filter_map(|name| name.strip_suffix(".svg"))
        .collect();
    assert!(pictures.len() >= 15, "{names:?}");
    for picture in pictures {
        let pixels = fs::read(out.join(format!("{picture}.png"))).unwrap();
        assert!(pixels.starts_with(b"\x89PNG"), "{picture}");
        let table = fs::read_to_string(out.join(format!("{picture}.csv"))).unwrap();
        assert!(table.lines().count() > 50, "{picture}");
        assert!(
            !table.contains("NaN") && !table.contains("inf"),
            "{picture}"
        );
    }
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    super::figures::fits_a_telephone(&page);
    // Self-contained: nothing is fetched.
    assert!(page.contains("</html>") && !page.contains("src=") && !page.contains("<link"));
    // A folder with something in it is left alone.
    swimmer_in(folder.path(), &["paper", "-o", "out"]).with_status(2);
}
