//! Colour bar next to a figure of a continuous field, with the exponent of its numbers in its name.

use plotters::prelude::*;

use super::chart::label_format;
use super::palette::Palette;
use super::style::{AXIS, Area, INK, NAMES, NUMBERS, SCALE, letters, said, stroke};

/// From the figure to the bar, the bar, and its numbers and name; pixels of the page.
const GAP: i32 = 22;
const BAR: i32 = 20;
const LABELS: i32 = 84;
/// Right of the name, which would lose its edge otherwise.
const MARGIN: i32 = 8;
/// Width of the whole, pixels of the page.
pub(crate) const WIDTH: i32 = GAP + BAR + LABELS + MARGIN;
/// Pieces of one colour each.
const PIECES: u32 = 96;

/// A field's range and name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColourBar {
    /// Name of the field, with its unit.
    pub(crate) name: String,
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) palette: Palette,
}

impl ColourBar {
    /// Colour of a value.
    pub(crate) fn color(&self, value: f64) -> RGBColor {
        let width = self.high - self.low;
        self.palette.color(if width > 0.0 {
            (value - self.low) / width
        } else {
            0.5
        })
    }

    /// Draws the bar with about so many numbers in an area of [`WIDTH`], below a margin in pixels of the page.
    ///
    /// # Errors
    /// Errors of the drawing library.
    pub(crate) fn draw(&self, area: &Area<'_>, top: i32, numbers: u8) -> Result<(), String> {
        let largest = self.low.abs().max(self.high.abs());
        let exponent = if largest > 0.0 {
            largest.log10().floor()
        } else {
            0.0
        };
        let unit = 10_f64.powf(exponent);
        // A constant field has a bar of one colour.
        let half = 0.5 * f64::max(self.high - self.low, 1e-9 * unit) / unit;
        let middle = 0.5 * (self.low + self.high) / unit;
        let (low, high) = (middle - half, middle + half);
        let mut chart = ChartBuilder::on(area)
            .margin_top(top * SCALE)
            .margin_left(GAP * SCALE)
            .margin_right(MARGIN * SCALE)
            .right_y_label_area_size(LABELS * SCALE)
            .build_cartesian_2d(0.0..1.0, low..high)
            .map_err(|error| said(&error))?;
        let step = (high - low) / f64::from(PIECES);
        let pieces = (0..PIECES).map(|piece| {
            let from = low + step * f64::from(piece);
            let color = self.color((from + 0.5 * step) * unit);
            // A little overlap leaves no seams.
            Rectangle::new(
                [(0.0, from), (1.0, (from + 1.6 * step).min(high))],
                color.filled(),
            )
        });
        chart.draw_series(pieces).map_err(|error| said(&error))?;
        let name = if exponent == 0.0 {
            self.name.clone()
        } else {
            format!("10{} × {}", superscript(exponent), self.name)
        };
        chart
            .configure_mesh()
            .disable_mesh()
            .disable_x_axis()
            .y_labels(numbers.into())
            .y_label_formatter(&label_format(&(low..high), numbers))
            .axis_style(stroke(AXIS, 1.0))
            .set_all_tick_mark_size(5 * SCALE)
            .label_style(letters(NUMBERS, INK))
            .axis_desc_style(letters(NAMES, INK))
            .y_desc(name)
            .draw()
            .map_err(|error| said(&error))?;
        let frame = Rectangle::new([(0.0, low), (1.0, high)], stroke(AXIS, 1.0));
        chart
            .draw_series(std::iter::once(frame))
            .map_err(|error| said(&error))?;
        Ok(())
    }
}

/// A whole number as an exponent.
fn superscript(exponent: f64) -> String {
    format!("{exponent:.0}")
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            _ => '⁹',
        })
        .collect()
}
