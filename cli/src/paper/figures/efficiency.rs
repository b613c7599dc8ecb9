//! The figures of section V: efficiency over amplitude, and Lighthill gaits.

use gait_optimizer::{BestAmplitude, OptimalGait};
use swimmer_files::AnyGait;
use swimmer_model::Stroke;

use super::{Figure, SQUARE, WIDE, drawn, samples};
use crate::report::chart::{INK, MEASURED, PREDICTED, SLENDER};
use validation::{Lighthill, Simple};

/// ξ of circles and squares at constant power, with the Lighthill gaits as marks.
pub(super) fn efficiency_over_amplitude(
    name: &'static str,
    title: &'static str,
    simple: &Simple,
    gaits: &Lighthill,
) -> Figure {
    let [circles, squares] = &simple.curves;
    let curve = |swum: &[(f64, Stroke<f64>)]| {
        swum.iter()
            .map(|(amplitude, stroke)| (*amplitude, stroke.efficiency_constant_power()))
            .collect()
    };
    // Where a circle through the same start would stand.
    let place = |gait: &OptimalGait| (gait.start_angle * std::f64::consts::SQRT_2, gait.efficiency);
    Figure::new(
        name,
        title,
        "At constant power: <i style='color:#3a9d5d'></i>circles <i style='color:#1d242c'></i>squares \
         <i class=dot style='color:#d35b1e'></i>Lighthill gaits, at √2 φ₁(t₀)",
        ["amplitude ε [rad]", "ξ"],
        WIDE,
    )
    .line("circles", SLENDER, curve(circles))
    .line("squares", INK, curve(squares))
    .mark("small", PREDICTED, place(&gaits.small))
    .mark("large", PREDICTED, place(&gaits.large))
}

/// The small and the large Lighthill gait, dashed the simple gaits that they grow from.
pub(super) fn lighthill(
    name: &'static str,
    title: &'static str,
    gaits: &Lighthill,
    simple: &Simple,
) -> Figure {
    let [circles, squares] = &simple.efficiency;
    let mut figure = Figure::new(
        name,
        title,
        "<i style='color:#d35b1e'></i>small <i style='color:#1f6fb2'></i>large; dashed: best circle and best large square",
        ["φ₁ [rad]", "φ₂ [rad]"],
        SQUARE,
    );
    let amplitude = |best: Option<&BestAmplitude>| best.map(|best| best.amplitude);
    if let Some(amplitude) = amplitude(circles.first()) {
        figure = figure.dashes("best circle", PREDICTED, drawn(&AnyGait::circle(amplitude)));
    }
    if let Some(amplitude) = amplitude(squares.get(1)) {
        figure = figure.dashes(
            "best large square",
            MEASURED,
            drawn(&AnyGait::square(amplitude)),
        );
    }
    figure.gait("small", PREDICTED, samples(&gaits.small)).gait(
        "large",
        MEASURED,
        samples(&gaits.large),
    )
}
