//! Picture of a map: coloured cells with a scale, fold lines; or the Pareto set.

use plotters::prelude::{ColorMap as _, RGBColor, ViridisRGB};
use sweep::{Map, MapAxis};

use super::map::MapQuantity;
use crate::failure::{Failure, Outcome};
use crate::report::chart::{Chart, INK, MEASURED, Series};

/// Size of the picture in pixels of the page.
const SIZE: (i32, i32) = (720, 520);
/// Kinds of gait that get a colour and a name of their own; the rest share one.
const KINDS: [RGBColor; 9] = [
    RGBColor(0x1f, 0x6f, 0xb2),
    RGBColor(0xd3, 0x5b, 0x1e),
    RGBColor(0x3a, 0x9d, 0x5d),
    RGBColor(0xd8, 0xb9, 0xe6),
    RGBColor(0xc9, 0xa2, 0x27),
    RGBColor(0x8c, 0x56, 0x4b),
    RGBColor(0x9d, 0xc6, 0xe8),
    RGBColor(0xe3, 0x77, 0xc2),
    RGBColor(0x7f, 0x7f, 0x7f),
];

/// The picture as SVG.
pub(super) fn drawn(map: &Map, what: MapQuantity) -> Outcome<String> {
    match what {
        MapQuantity::Pareto => pareto(map),
        MapQuantity::Structure => structure(map),
        _ => quantity(map, what),
    }
}

fn named(axis: &MapAxis) -> String {
    if axis.unit.is_empty() {
        axis.name.to_owned()
    } else {
        format!("{} [{}]", axis.name, axis.unit)
    }
}

fn chart(map: &Map, title: String, series: Vec<Series>, legend: Vec<(String, RGBColor)>) -> Chart {
    let [x, y] = &map.axes;
    let white = map.status.iter().flatten().any(|status| *status == "none");
    Chart {
        title: if white {
            format!("{title} (white: no gait)")
        } else {
            title
        },
        x_label: named(x),
        y_label: named(y),
        size: SIZE,
        equal_axes: false,
        series,
        legend,
    }
}

/// Cells reach under their neighbours by this share, so that no light shows between them.
const UNDER: f64 = 0.04;

/// One cell's corners and colour.
fn cell(map: &Map, row: usize, column: usize, color: RGBColor) -> Option<([f64; 4], RGBColor)> {
    let [x, y] = map.axes.each_ref().map(MapAxis::borders);
    let (left, low) = (*x.get(column)?, *y.get(row)?);
    let (right, high) = (*x.get(column + 1)?, *y.get(row + 1)?);
    let under = |from: f64, to: f64| to + UNDER * (to - from);
    Some(([left, low, under(left, right), under(low, high)], color))
}

fn folds(map: &Map) -> impl Iterator<Item = Series> {
    map.folds.iter().map(|line| Series::Line {
        points: line.iter().map(|[x, y]| (*x, *y)).collect(),
        color: INK,
        width: 1.0,
    })
}

fn quantity(map: &Map, what: MapQuantity) -> Outcome<String> {
    let (name, title) = match what {
        MapQuantity::Efficiency => ("efficiency", "Lighthill efficiency"),
        MapQuantity::Speed => ("speed_over_length_per_s", "speed |d|/(L T) [1/s]"),
        MapQuantity::Amplitude => ("amplitude_rad", "largest joint angle [rad]"),
        MapQuantity::Rotation => ("rotation_rad", "rotation of a cycle [rad]"),
        MapQuantity::Lateral => ("lateral_over_length", "Y/L of a cycle"),
        _ => ("displacement_over_length", "X/L of a cycle"),
    };
    let found = map.quantities.iter().find(|one| one.name == name);
    let values = &found
        .ok_or_else(|| {
            let there: Vec<_> = map.quantities.iter().map(|one| one.name).collect();
            Failure::BadInput(format!(
                "no design of this map has a {name}; there are {} (a speed needs max_rate in the spec)",
                there.join(", ")
            ))
        })?
        .values;
    let all = values.iter().flatten().flatten().copied();
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let color = |value: f64| {
        let share = if high > low {
            (value - low) / (high - low)
        } else {
            0.5
        };
        #[allow(clippy::cast_possible_truncation)] // 0 to 1
        let share = share as f32;
        ViridisRGB.get_color(share)
    };
    let cells = values.iter().enumerate().flat_map(|(row, values)| {
        values
            .iter()
            .enumerate()
            .filter_map(move |(column, value)| cell(map, row, column, color((*value)?)))
    });
    let mut series = vec![Series::Cells(cells.collect())];
    series.extend(folds(map));
    let step = |share: f64| low + share * (high - low);
    let legend = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| {
        (
            format!("{:.4}", step(share)).replace('-', "\u{2212}"),
            color(step(share)),
        )
    });
    chart(
        map,
        format!("{title}, best for {}", map.objective),
        series,
        legend.to_vec(),
    )
    .svg()
}

fn structure(map: &Map) -> Outcome<String> {
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    for arcs in map.structure.iter().flatten().flatten() {
        *counts.entry(arcs.as_str()).or_default() += 1;
    }
    let mut kinds: Vec<(&str, usize)> = counts.into_iter().collect();
    kinds.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    let color = |arcs: &str| {
        let place = kinds.iter().position(|(kind, _)| *kind == arcs);
        KINDS[place.unwrap_or(KINDS.len()).min(KINDS.len() - 1)]
    };
    let cells = map.structure.iter().enumerate().flat_map(|(row, kinds)| {
        kinds
            .iter()
            .enumerate()
            .filter_map(move |(column, kind)| cell(map, row, column, color(kind.as_deref()?)))
    });
    let mut series = vec![Series::Cells(cells.collect())];
    series.extend(folds(map));
    let named = kinds.iter().take(KINDS.len() - 1);
    let mut legend: Vec<(String, RGBColor)> = named
        .map(|(kind, count)| (format!("{kind}: {count}"), color(kind)))
        .collect();
    let rest = kinds.iter().skip(KINDS.len() - 1);
    let rest: usize = rest.map(|(_, count)| count).sum();
    if rest > 0 {
        legend.push((format!("others: {rest}"), KINDS[KINDS.len() - 1]));
    }
    chart(
        map,
        format!("arcs of the gait best for {}", map.objective),
        series,
        legend,
    )
    .svg()
}

fn pareto(map: &Map) -> Outcome<String> {
    if map.pareto.is_empty() {
        return Err(Failure::BadInput(
            "no design has a speed: say max_rate in the spec, and plan again".to_owned(),
        ));
    }
    let points: Vec<(f64, f64)> = map
        .pareto
        .iter()
        .map(|one| (one.speed, 1e2 * one.efficiency))
        .collect();
    Chart {
        title: format!(
            "designs that none beats in both; gaits best for {}",
            map.objective
        ),
        x_label: "speed |d|/(L T) [1/s]".to_owned(),
        y_label: "Lighthill efficiency [%]".to_owned(),
        size: SIZE,
        equal_axes: false,
        series: vec![
            Series::Line {
                points: points.clone(),
                color: MEASURED,
                width: 1.0,
            },
            Series::Dots {
                points,
                color: MEASURED,
                radius: 3.0,
            },
        ],
        legend: Vec::new(),
    }
    .svg()
}
