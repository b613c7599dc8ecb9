//! Picture of a map: coloured cells with a scale, fold lines; or the Pareto set.

use plotters::prelude::RGBColor;
use sweep::{Map, MapAxis, Pareto};

use super::map::MapQuantity;
use crate::failure::{Failure, Outcome};
use crate::picture_file::FigureWidth;
use crate::quantity;
use crate::report::chart::{Chart, INK, MEASURED, Series};
use crate::report::colour_bar::ColourBar;
use crate::report::palette::Palette;

/// Size of the picture in pixels of the page.
const SIZE: (i32, i32) = (720, 520);
/// Designs behind the Pareto front.
const BEHIND: RGBColor = RGBColor(0xb4, 0xbd, 0xc6);
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
pub(super) fn drawn(map: &Map, what: MapQuantity, width: FigureWidth) -> Outcome<String> {
    let chart = match what {
        MapQuantity::Pareto => pareto(map)?,
        MapQuantity::Structure => structure(map),
        _ => quantity(map, what)?,
    };
    chart.wide(width).svg()
}

/// Words with their unit.
fn labelled(words: &str, unit: &str) -> String {
    if unit.is_empty() {
        words.to_owned()
    } else {
        format!("{words} [{unit}]")
    }
}

fn named(axis: &MapAxis) -> String {
    labelled(axis.words, axis.unit)
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

fn quantity(map: &Map, what: MapQuantity) -> Outcome<Chart> {
    let name = match what {
        MapQuantity::Efficiency => "efficiency",
        MapQuantity::Speed => "speed_over_length_per_s",
        MapQuantity::Amplitude => "amplitude_rad",
        MapQuantity::Rotation => "rotation_rad",
        MapQuantity::Lateral => "lateral_over_length",
        _ => "displacement_over_length",
    };
    let found = map.quantities.iter().find(|one| one.name == name);
    let found = found.ok_or_else(|| {
        let there: Vec<_> = map.quantities.iter().map(|one| one.name).collect();
        Failure::BadInput(format!(
            "no design of this map has a {name}; there are {} (a speed needs max_rate in the spec)",
            there.join(", ")
        ))
    })?;
    let values = &found.values;
    let all = values.iter().flatten().flatten().copied();
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let bar = ColourBar {
        name: labelled(found.words, found.unit),
        low,
        high,
        palette: Palette::Sequential,
    };
    let cells = values.iter().enumerate().flat_map(|(row, values)| {
        values
            .iter()
            .enumerate()
            .filter_map(|(column, value)| cell(map, row, column, bar.color((*value)?)))
            .collect::<Vec<_>>()
    });
    let mut series = vec![Series::Cells(cells.collect())];
    series.extend(folds(map));
    series.push(Series::ColourBar(bar.clone()));
    let title = format!("{}, best for {}", found.words, map.objective);
    Ok(chart(map, title, series, Vec::new()))
}

fn structure(map: &Map) -> Chart {
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
}

fn pareto(map: &Map) -> Outcome<Chart> {
    if map.pareto.is_empty() {
        return Err(Failure::BadInput(
            "no design has a speed: say max_rate in the spec, and plan again".to_owned(),
        ));
    }
    let place = |speed: f64, efficiency: f64| (speed, 1e2 * efficiency);
    let points: Vec<(f64, f64)> = map
        .pareto
        .iter()
        .map(|one| place(one.speed, one.efficiency))
        .collect();
    let column = |name: &str| map.quantities.iter().find(|one| one.name == name);
    let designs = column("speed_over_length_per_s").zip(column("efficiency"));
    let designs = designs.map_or_else(Vec::new, |(speed, efficiency)| {
        let pairs = speed.values.iter().flatten();
        pairs
            .zip(efficiency.values.iter().flatten())
            .filter_map(|(speed, efficiency)| Some(place((*speed)?, (*efficiency)?)))
            .collect()
    });
    let ends: Vec<(&str, &Pareto)> = match map.pareto.as_slice() {
        [] => Vec::new(),
        [both] => vec![("fastest and most efficient", both)],
        [efficient, .., fast] => vec![("most efficient", efficient), ("fastest", fast)],
    };
    let words = ends.into_iter().map(|(best, one)| Series::Word {
        at: place(one.speed, one.efficiency),
        text: format!("{best}: {}", design(map, one)),
        color: INK,
    });
    let front = [
        Series::Dots {
            points: designs,
            color: BEHIND,
            radius: 1.8,
        },
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
    ];
    Ok(Chart {
        title: format!(
            "designs that none beats in both; gaits best for {}",
            map.objective
        ),
        x_label: "speed |d|/(L T) [1/s]".to_owned(),
        y_label: "Lighthill efficiency ξ [%]".to_owned(),
        size: SIZE,
        equal_axes: false,
        series: front.into_iter().chain(words).collect(),
        legend: vec![
            (
                "not beaten in both, of the whole sweep".to_owned(),
                MEASURED,
            ),
            ("designs of this map".to_owned(), BEHIND),
        ],
    })
}

/// Name of a design of the front: its values on the axes of the plan.
fn design(map: &Map, one: &Pareto) -> String {
    let values = map.plan_axes.iter().zip(&one.design);
    let values = values.map(|(axis, value)| {
        let symbol = axis.words.rsplit(' ').next().unwrap_or_default();
        let is_symbol = symbol.chars().any(|letter| !letter.is_ascii_alphabetic());
        let name = if is_symbol { symbol } else { axis.words };
        let number = quantity::significant(*value, 3);
        labelled(&format!("{name} {number}"), axis.unit).replace(['[', ']'], "")
    });
    values.collect::<Vec<_>>().join(", ")
}
