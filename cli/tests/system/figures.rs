//! Common look of every figure and every page.

use std::fs;

use crate::binary::typed;

/// Every table of a page scrolls by itself or breaks its lines, and every figure shrinks: nothing is wider than a telephone.
#[track_caller]
pub(crate) fn fits_a_telephone(page: &str) {
    for (place, _) in page.match_indices("<table") {
        let before = &page[..place];
        let scrolls = before.ends_with("<div class=scroll tabindex=0>");
        let breaks = before
            .rfind("<figure")
            .is_some_and(|figure| page[figure..].starts_with("<figure class=files>"));
        assert!(scrolls || breaks, "{}", &page[place..place + 80]);
    }
    for rule in [
        "width=device-width",
        ".scroll { overflow-x: auto; }",
        "svg { display: block; width: 100%; height: auto; }",
        "figure, section { min-width: 0; }",
        ".grid, dl { grid-template-columns: minmax(0, 1fr); }",
    ] {
        assert!(page.contains(rule), "{rule}");
    }
    subscripts_are_real(page);
}

/// Text of figures and pages has no `H_x` in it; gait files and columns may.
#[track_caller]
fn subscripts_are_real(page: &str) {
    for typed in ["H_x", "H_y", "r_s"] {
        assert!(!page.contains(typed), "{typed}");
    }
}

/// Widths of the lines of this colour, in units of the drawing.
fn widths(svg: &str, color: &str) -> Vec<u32> {
    let lines = svg.split("<polyline").skip(1);
    let drawn = lines
        .filter_map(|line| line.split('>').next())
        .filter(|line| line.contains(color));
    let width = |line: &str| {
        let (_, rest) = line.split_once("stroke-width=\"")?;
        rest.split_once('"')?.0.parse().ok()
    };
    drawn.filter_map(width).collect()
}

#[test]
fn gaits_have_a_direction_and_leave_the_zero_curve_visible() {
    let folder = tempfile::tempdir().unwrap();
    let line = "height-map --swimmer robot --gait circle:70deg --gait square:1:cw -o map.svg";
    typed(folder.path(), line).with_status(0);
    let map = fs::read_to_string(folder.path().join("map.svg")).unwrap();
    let arrows = |color: &str| {
        let polygons = map.split("<polygon").skip(1);
        let of_gait = |polygon: &&str| polygon.split('>').next().unwrap().contains(color);
        polygons.filter(of_gait).count()
    };
    assert_eq!(
        [arrows("#008A5E"), arrows("#E09B00")],
        [4, 4],
        "four arrows a gait"
    );
    assert!(map.len() < 400_000, "{} bytes", map.len());
    let (zero, gait) = (widths(&map, "#1D242C"), widths(&map, "#008A5E"));
    assert!(
        zero.iter()
            .all(|zero| gait.iter().all(|gait| *zero > *gait + 16)),
        "{zero:?} {gait:?}"
    );
    assert!(!zero.is_empty() && !gait.is_empty());
    assert!(map.contains("H<tspan"), "the axis of the colours");
    subscripts_are_real(&map);

    let line =
        "atlas --swimmer purcell --objective displacement --max-angle 2.8 --starts 12 -o atlas";
    typed(folder.path(), line).with_status(0);
    let atlas = fs::read_to_string(folder.path().join("atlas/atlas.svg")).unwrap();
    let gaits = atlas.matches("|d|/L").count();
    assert!(gaits >= 2 && atlas.matches("<polygon").count() == 4 * gaits);
    // One style: the same letters, axes and colours.
    for (figure, name) in [(&map, "map"), (&atlas, "atlas")] {
        for mark in [
            "#1D242C",
            "#9AA5B1",
            "#008A5E",
            "sans-serif",
            "fill=\"#FFFFFF\"",
        ] {
            assert!(figure.contains(mark), "{name}: {mark}");
        }
    }
}
