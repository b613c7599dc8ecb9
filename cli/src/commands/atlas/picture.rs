//! All gaits of an atlas in one picture: closed curves in the plane of joint angles, as SVG.

use std::fmt::Write;

use gait_optimizer::Optimum;

use crate::report::escaped;

/// Width and height of the plane.
const SIDE: f64 = 720.0;
const MARGIN: f64 = 60.0;
const COLOURS: [&str; 10] = [
    "#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#e377c2", "#17becf",
    "#7f7f7f", "#bcbd22",
];
/// Gaits that are drawn; the table has all.
const MOST: usize = 20;

/// The picture's text.
pub(super) fn svg(title: &str, optima: &[Optimum]) -> String {
    let reach = optima
        .iter()
        .take(MOST)
        .flat_map(|optimum| optimum.gait.phi())
        .map(|phi| phi.x.abs().max(phi.y.abs()))
        .fold(1.0, f64::max)
        * 1.05;
    let place = |value: f64| MARGIN + SIDE * (value + reach) / (2.0 * reach);
    let (x, y) = (place, |value: f64| 2.0 * MARGIN + SIDE - place(value));
    let (width, height) = (SIDE + 2.0 * MARGIN + 260.0, SIDE + 2.0 * MARGIN);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"14\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    line(format!(
        "<text x=\"{MARGIN}\" y=\"32\" font-size=\"18\">{}</text>",
        escaped(title)
    ));
    line(format!(
        "<rect x=\"{MARGIN}\" y=\"{MARGIN}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#444\"/>"
    ));
    for tick in (-7..=7).filter(|tick| f64::from(*tick).abs() <= reach) {
        let value = f64::from(tick);
        let (across, along) = (x(value), y(value));
        let bottom = MARGIN + SIDE;
        line(format!(
            "<path d=\"M{across:.2} {MARGIN}V{bottom}M{MARGIN} {along:.2}H{bottom}\" stroke=\"#e4e4e4\"/>\
             <text x=\"{across:.2}\" y=\"{:.2}\" text-anchor=\"middle\">{tick}</text>\
             <text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"end\">{tick}</text>",
            bottom + 18.0,
            MARGIN - 8.0,
            along + 5.0
        ));
    }
    line(format!(
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">φ₁ [rad]</text>\
         <text x=\"18\" y=\"{:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 18 {:.1})\">φ₂ [rad]</text>",
        MARGIN + SIDE / 2.0,
        height - 14.0,
        MARGIN + SIDE / 2.0,
        MARGIN + SIDE / 2.0
    ));
    for (number, optimum) in optima.iter().take(MOST).enumerate() {
        let colour = COLOURS[number % COLOURS.len()];
        let dash = if number < COLOURS.len() {
            ""
        } else {
            " stroke-dasharray=\"6 3\""
        };
        let mut path = String::new();
        for (index, phi) in optimum.gait.phi().iter().enumerate() {
            let word = if index == 0 { 'M' } else { 'L' };
            // Writing to a string cannot fail.
            let _ = write!(path, "{word}{:.2} {:.2}", x(phi.x), y(phi.y));
        }
        line(format!(
            "<path d=\"{path}Z\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dash}/>"
        ));
        let (left, top) = (MARGIN + SIDE + 16.0, MARGIN + 20.0 + 36.0 * number as f64);
        line(format!(
            "<path d=\"M{left} {:.1}h26\" stroke=\"{colour}\" stroke-width=\"3\"{dash}/>\
             <text x=\"{:.1}\" y=\"{top:.1}\">{}: |d|/L = {:.5}</text>\
             <text x=\"{:.1}\" y=\"{:.1}\" fill=\"#555\">ξ = {:.4e}, found {}</text>",
            top - 5.0,
            left + 34.0,
            number + 1,
            optimum.distance_over_length,
            left + 34.0,
            top + 16.0,
            optimum.gait.efficiency,
            optimum.found
        ));
    }
    out.push_str("</svg>\n");
    out
}
