//! Common look of all figures: colours, sizes, strokes, subscripts, arrow heads, legends.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::TextStyle;

/// Plotters rounds to whole pixels; drawing this many times larger and showing it smaller keeps curves smooth.
pub(crate) const SCALE: i32 = 8;

/// Text, axes' names and the fitted model.
pub(crate) const INK: RGBColor = RGBColor(0x1d, 0x24, 0x2c);
/// Axes, ticks and frames.
pub(crate) const AXIS: RGBColor = RGBColor(0x9a, 0xa5, 0xb1);
/// Curves of one kind in turn; they stand out from each other, also for the colour-blind, and from the colours of a height map.
pub(crate) const CURVES: [RGBColor; 5] = [
    RGBColor(0x00, 0x8a, 0x5e),
    RGBColor(0xe0, 0x9b, 0x00),
    RGBColor(0x7a, 0x2e, 0xa6),
    RGBColor(0x6b, 0x4a, 0x2b),
    RGBColor(0xd6, 0x3a, 0x8f),
];
/// Sizes of letters in pixels of the page: numbers on axes, their names, words in the figure, its title.
pub(crate) const NUMBERS: i32 = 16;
/// See [`NUMBERS`].
pub(crate) const NAMES: i32 = 17;
/// See [`NUMBERS`].
pub(crate) const WORDS: i32 = 15;
/// See [`NUMBERS`].
pub(crate) const TITLE: i32 = 19;
/// Width of a zero-level curve: a gait that runs along it leaves it visible on either side.
pub(crate) const ZERO_CURVE: f64 = 5.0;

/// Height of a legend's line, pixels of the page.
pub(crate) const LEGEND_LINE: i32 = 22;
/// From the left end of a legend to its names, pixels of the page.
pub(crate) const LEGEND_INDENT: i32 = 40;
/// Average width of a letter over its size; those of the built-in typeface are about as wide.
const LETTER_WIDTH: f64 = 0.56;
/// Arrow heads on a closed curve.
const ARROWS: usize = 4;
/// An arrow head from its tip to its back, and half as wide as it is at the back, pixels of the page.
const HEAD: [f64; 2] = [11.0, 4.6];

/// Area of a figure.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// A place in the units of the axes.
pub(crate) type Point = (f64, f64);

/// Letters of a size in pixels of the page.
pub(crate) fn letters(size: i32, color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", size * SCALE).into_font().color(&color)
}

/// A line of a width in pixels of the page.
pub(crate) fn stroke(color: RGBColor, width: f64) -> ShapeStyle {
    color.stroke_width(pixels(width).unsigned_abs())
}

/// Pixels of the drawing.
#[allow(clippy::cast_possible_truncation)] // A few thousand at most.
pub(crate) fn pixels(page_pixels: f64) -> i32 {
    (page_pixels * f64::from(SCALE)).round() as i32
}

/// Message of the drawing library.
pub(crate) fn said(error: &dyn std::fmt::Display) -> String {
    error.to_string()
}

/// A number with the typographer's minus, and none before zero.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let zero = value.abs() < 0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap_or(6));
    format!("{:.decimals$}", if zero { 0.0 } else { value }).replace('-', "\u{2212}")
}

/// Attributes that give a drawing its name, for readers of screens; `H_x` is written without its bar.
pub(crate) fn named(name: &str) -> String {
    let plain = split(name, |index| index.to_string());
    let escaped = plain
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;");
    format!("role=\"img\" aria-label=\"{escaped}\"")
}

/// A finished drawing of this size in pixels of the page: named, on white, shown at its true size, with real subscripts.
pub(crate) fn finished(drawing: &str, size: (i32, i32), name: &str) -> String {
    let drawn = format!("width=\"{}\" height=\"{}\"", size.0 * SCALE, size.1 * SCALE);
    let shown = format!("width=\"{}\" height=\"{}\" {}", size.0, size.1, named(name));
    // Text stands on lines of its own, between those of its tags.
    let mut within_text = false;
    let lines = drawing.replacen(&drawn, &shown, 1);
    let lines = lines.lines().map(|line| {
        let line_is_text = within_text && !line.starts_with('<');
        if line.starts_with("<text") {
            within_text = true;
        } else if line.starts_with("</text") {
            within_text = false;
        }
        if line_is_text {
            subscripted(line)
        } else {
            line.to_owned()
        }
    });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

/// Text of a drawing in which `H_x` shows an x below the line.
pub(super) fn subscripted(text: &str) -> String {
    split(text, |index| {
        // The following text is raised again; the length is that of the subscript's smaller letters.
        format!(
            "<tspan dy=\"0.3em\" font-size=\"72%\">{index}</tspan><tspan dy=\"-0.216em\">\u{200b}</tspan>"
        )
    })
}

/// Text of a page in which `H_x` shows an x below the line.
pub(crate) fn subscripts(html: &str) -> String {
    split(html, |index| format!("<sub>{index}</sub>"))
}

/// The text with every second letter of a pair as `H_x` turned into something else.
fn split(text: &str, index: impl Fn(char) -> String) -> String {
    let letters: Vec<char> = text.chars().collect();
    let word = |place: Option<usize>| {
        let letter = place.and_then(|place| letters.get(place));
        letter.is_some_and(|letter| letter.is_alphanumeric() || *letter == '_')
    };
    let mut out = String::with_capacity(text.len());
    let mut place = 0;
    while let Some(&letter) = letters.get(place) {
        out.push(letter);
        if let [base, '_', below] = letters.get(place..place + 3).unwrap_or_default()
            && base.is_alphabetic()
            && below.is_alphabetic()
            && !word(place.checked_sub(1))
            && !word(Some(place + 3))
        {
            out.push_str(&index(*below));
            place += 2;
        }
        place += 1;
    }
    out
}

/// Positions and directions (unit vectors) of a curve's arrow heads: evenly spaced along it.
pub(crate) fn arrows(points: &[Point]) -> Vec<(Point, Point)> {
    let steps = points.windows(2).filter_map(|pair| match pair {
        [from, to] => Some((*from, *to, (to.0 - from.0).hypot(to.1 - from.1))),
        _ => None,
    });
    let steps: Vec<_> = steps.filter(|step| step.2 > 0.0).collect();
    let length: f64 = steps.iter().map(|step| step.2).sum();
    let mut heads = Vec::new();
    let mut gone = 0.0;
    for (from, to, step) in steps {
        let next = (heads.len() as f64 + 0.5) / ARROWS as f64 * length;
        if heads.len() < ARROWS && gone + step >= next {
            let share = ((next - gone) / step).clamp(0.0, 1.0);
            let along = ((to.0 - from.0) / step, (to.1 - from.1) / step);
            let at = (
                from.0 + share * (to.0 - from.0),
                from.1 + share * (to.1 - from.1),
            );
            heads.push((at, along));
        }
        gone += step;
    }
    heads
}

/// The corners of an arrow head around its place, pixels of the drawing; the axes have equal units.
pub(crate) fn head((x, y): Point) -> Vec<(i32, i32)> {
    let [length, half] = HEAD;
    let corner = |along: f64, across: f64| {
        (
            pixels(along * x - across * y),
            // Pixels count downwards.
            pixels(-(along * y + across * x)),
        )
    };
    vec![
        corner(0.5 * length, 0.0),
        corner(-0.5 * length, half),
        corner(-0.5 * length, -half),
    ]
}

/// Lines of a text whose letters have this size, none wider than `width` if its words allow; pixels of the page.
pub(crate) fn broken(text: &str, size: i32, width: i32) -> Vec<String> {
    if text.is_empty() {
        return Vec::new();
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // hundreds
    let letters = (f64::from(width.max(0)) / (f64::from(size) * LETTER_WIDTH)).floor() as usize;
    let options = textwrap::Options::new(letters.max(1)).break_words(false);
    let lines = textwrap::wrap(text, options);
    lines
        .into_iter()
        .map(std::borrow::Cow::into_owned)
        .collect()
}

/// Names of curves with a piece of each, one below the other from a corner on; a line without a colour goes on with the name above it.
/// Pixels of the page.
///
/// # Errors
/// Errors of the drawing library.
pub(crate) fn legend<'a>(
    area: &Area<'_>,
    (left, top): (i32, i32),
    curves: impl Iterator<Item = (&'a str, Option<RGBColor>)>,
) -> Result<(), String> {
    let mut y = top + LEGEND_LINE / 2;
    for (name, color) in curves {
        if let Some(color) = color {
            let piece = PathElement::new(
                [(left * SCALE, y * SCALE), ((left + 30) * SCALE, y * SCALE)],
                stroke(color, 2.6),
            );
            area.draw(&piece).map_err(|error| said(&error))?;
        }
        let at = ((left + LEGEND_INDENT) * SCALE, (y - 8) * SCALE);
        area.draw_text(name, &letters(WORDS, INK), at)
            .map_err(|error| said(&error))?;
        y += LEGEND_LINE;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_letter_below_another_is_a_subscript() {
        assert_eq!(
            subscripts("H_x / L, r_s"),
            "H<sub>x</sub> / L, r<sub>s</sub>"
        );
        assert_eq!(subscripts("H_θ"), "H<sub>θ</sub>");
        for kept in ["run_a", "a_bc", "x_1", "_x", "a_", "my_r_s"] {
            assert_eq!(subscripts(kept), kept);
        }
        let drawing =
            "<svg width=\"80\" height=\"160\">\n<text x=\"1\">\nr_s [mm]\n</text>\n</svg>\n";
        let text = finished(drawing, (10, 20), "r_s over \"x\"");
        assert!(
            text.starts_with(
                "<svg width=\"10\" height=\"20\" role=\"img\" aria-label=\"rs over &quot;x&quot;\">"
            ),
            "{text}"
        );
        assert!(
            text.contains("r<tspan dy=\"0.3em\" font-size=\"72%\">s</tspan>")
                && !text.contains("r_s")
        );
    }

    #[test]
    fn arrows_point_the_way_the_curve_runs() {
        let square = [
            (1.0, 1.0),
            (-1.0, 1.0),
            (-1.0, -1.0),
            (1.0, -1.0),
            (1.0, 1.0),
        ];
        let heads = arrows(&square);
        assert_eq!(
            heads,
            [
                ((0.0, 1.0), (-1.0, 0.0)),
                ((-1.0, 0.0), (0.0, -1.0)),
                ((0.0, -1.0), (1.0, 0.0)),
                ((1.0, 0.0), (0.0, 1.0)),
            ]
        );
        // Upwards is towards smaller pixels.
        assert!(head((0.0, 1.0)).iter().map(|corner| corner.1).min() == Some(-44));
        assert!(arrows(&[]).is_empty() && arrows(&[(1.0, 1.0), (1.0, 1.0)]).is_empty());
    }
}
