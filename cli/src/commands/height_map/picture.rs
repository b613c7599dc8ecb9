//! The height map as a figure: colours for height, lines for the zero-level curves and for gaits.

use contour::ContourBuilder;
use gait_optimizer::{HeightMap, LevelCurve, Row};
use nalgebra::DMatrix;
use operations::height_map::NamedGait;
use plotters::prelude::*;
use swimmer_model::Gait as _;

use crate::failure::{Failure, Outcome};
use crate::picture_file::{COLUMN, FigureWidth};
use crate::report::colour_bar::{self, ColourBar};
use crate::report::palette::Palette;
use crate::report::style::{
    AXIS, Area, CURVES, INK, LEGEND_INDENT, LEGEND_LINE, NAMES, NUMBERS, Point, SCALE, TITLE,
    WORDS, ZERO_CURVE, arrows, broken, finished, head, legend, letters, number, said, stroke,
};

/// Contents of the figure.
#[derive(Debug)]
pub(crate) struct Figure<'a> {
    pub(crate) title: String,
    /// The height with its unit, next to the colour bar.
    pub(crate) quantity: &'static str,
    pub(crate) map: &'a HeightMap,
    pub(crate) row: Row,
    pub(crate) curves: &'a [LevelCurve],
    pub(crate) gaits: &'a [NamedGait],
    pub(crate) width: FigureWidth,
}

impl Figure<'_> {
    /// Side of the map, pixels of the page.
    fn side(&self) -> i32 {
        match self.width {
            FigureWidth::Page => MAP,
            FigureWidth::Column => COLUMN - LEFT - colour_bar::WIDTH,
        }
    }

    /// Numbers along an axis.
    fn numbers(&self) -> u8 {
        match self.width {
            FigureWidth::Page => 9,
            FigureWidth::Column => 5,
        }
    }

    /// Names of the gaits on lines, and the colour with the first of each.
    fn legend(&self) -> Vec<(String, Option<RGBColor>)> {
        let width = self.side() + colour_bar::WIDTH - LEGEND_INDENT;
        let named = self.gaits.iter().zip(CURVES.iter().cycle());
        named
            .flat_map(|(gait, color)| {
                let colors = std::iter::once(Some(*color)).chain(std::iter::repeat(None));
                broken(&gait.name, WORDS, width).into_iter().zip(colors)
            })
            .collect()
    }
}

/// Side of the map in pixels of the page.
const MAP: i32 = 520;
const LEFT: i32 = 76;
/// Left of the label of φ₂, which would lose its edge otherwise.
const MARGIN: i32 = 12;
const BOTTOM: i32 = 50;
const TOP: i32 = 44;
/// Nodes in each direction between which the edges of the colours are interpolated.
const NODES: usize = 131;
/// Steps of colour on either side of zero.
const SHADES: i32 = 24;
/// Points a gait is drawn with.
const GAIT_POINTS: u32 = 1500;

/// The figure as SVG.
///
/// # Errors
/// [`Failure::Tried`] when the drawing library gives up.
pub(crate) fn svg(figure: &Figure<'_>) -> Outcome<String> {
    let lines = figure.legend().len();
    let legend = i32::try_from(lines).unwrap_or(i32::MAX / 1000) * LEGEND_LINE;
    let legend = if legend > 0 { legend + 10 } else { 0 };
    let side = figure.side();
    let size = (
        LEFT + side + colour_bar::WIDTH,
        TOP + side + BOTTOM + legend,
    );
    let mut text = String::new();
    {
        let pixels = (
            (size.0 * SCALE).unsigned_abs(),
            (size.1 * SCALE).unsigned_abs(),
        );
        let area = SVGBackend::with_string(&mut text, pixels).into_drawing_area();
        draw(figure, &area).map_err(|reason| {
            Failure::Tried(format!("cannot draw the map of {}: {reason}", figure.title))
        })?;
    }
    Ok(finished(&text, size, &figure.title))
}

fn draw(figure: &Figure<'_>, area: &Area<'_>) -> Result<(), String> {
    area.fill(&WHITE).map_err(|error| said(&error))?;
    let side = figure.side();
    area.draw_text(
        &figure.title,
        &letters(TITLE, INK),
        (LEFT * SCALE, 14 * SCALE),
    )
    .map_err(|error| said(&error))?;
    let (_, upper) = area.split_vertically(0);
    let (map_area, bar_area) = upper.split_horizontally((LEFT + side) * SCALE);
    let half_width = figure.map.half_width();
    let grid = figure.map.grid(figure.row, NODES);
    let largest = grid.heights.amax().max(f64::MIN_POSITIVE);

    let (map_area, _) = map_area.split_vertically((TOP + side + BOTTOM) * SCALE);
    let mut chart = ChartBuilder::on(&map_area)
        .margin_top(TOP * SCALE)
        .margin_left(MARGIN * SCALE)
        .x_label_area_size(BOTTOM * SCALE)
        .y_label_area_size((LEFT - MARGIN) * SCALE)
        .build_cartesian_2d(-half_width..half_width, -half_width..half_width)
        .map_err(|error| said(&error))?;
    let lowest = Rectangle::new(
        [(-half_width, -half_width), (half_width, half_width)],
        color(-SHADES).filled(),
    );
    chart
        .draw_series(std::iter::once(lowest))
        .map_err(|error| said(&error))?;
    let regions = regions(&grid.heights, half_width, largest)?;
    let regions = regions
        .into_iter()
        .map(|region| Polygon::new(region.edge, color(region.shade).filled()));
    chart.draw_series(regions).map_err(|error| said(&error))?;
    // Broad, so that they show on either side of a gait that runs along them.
    for curve in figure.curves {
        let points = curve.points.iter().map(|phi| (phi.x, phi.y));
        chart
            .draw_series(LineSeries::new(points, stroke(INK, ZERO_CURVE)))
            .map_err(|error| said(&error))?;
    }
    for (NamedGait { gait, .. }, color) in figure.gaits.iter().zip(CURVES.iter().cycle()) {
        let points: Vec<Point> = (0..=GAIT_POINTS)
            .map(|k| {
                gait.at(f64::from(k % GAIT_POINTS) / f64::from(GAIT_POINTS))
                    .phi
            })
            .map(|phi| (phi.x, phi.y))
            .collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), stroke(*color, 2.6)))
            .map_err(|error| said(&error))?;
        let heads = arrows(&points)
            .into_iter()
            .map(|(at, along)| EmptyElement::at(at) + Polygon::new(head(along), color.filled()));
        chart.draw_series(heads).map_err(|error| said(&error))?;
    }
    // Axes last, over the colours.
    chart
        .configure_mesh()
        .disable_mesh()
        .x_labels(figure.numbers().into())
        .y_labels(figure.numbers().into())
        .x_label_formatter(&|value| number(*value, 1))
        .y_label_formatter(&|value| number(*value, 1))
        .axis_style(stroke(AXIS, 1.0))
        .set_all_tick_mark_size(5 * SCALE)
        .label_style(letters(NUMBERS, INK))
        .axis_desc_style(letters(NAMES, INK))
        .x_desc("front joint φ₁ [rad]")
        .y_desc("back joint φ₂ [rad]")
        .draw()
        .map_err(|error| said(&error))?;
    chart
        .draw_series(std::iter::once(Rectangle::new(
            [(-half_width, -half_width), (half_width, half_width)],
            stroke(AXIS, 1.0),
        )))
        .map_err(|error| said(&error))?;
    let (bar_area, _) = bar_area.split_vertically((TOP + side) * SCALE);
    let bar = ColourBar {
        name: figure.quantity.to_owned(),
        low: -largest,
        high: largest,
        palette: Palette::Diverging,
    };
    bar.draw(&bar_area, TOP, figure.numbers())?;
    let lines = figure.legend();
    let named = lines.iter().map(|(name, color)| (name.as_str(), *color));
    legend(area, (LEFT, TOP + side + BOTTOM), named)
}

/// Region of the map that is painted with one colour, before the regions inside it.
struct Region {
    /// Closed curve along which the height is constant, and where the map ends along its edge.
    edge: Vec<Point>,
    shade: i32,
    area: f64,
}

/// Regions of the colours by marching squares, larger ones first: painted in this order they need no holes, because level curves do
/// not cross. `heights` are at square nodes over angles up to `half_width` \[rad\], φ₁ along the columns.
///
/// # Errors
/// Errors of the contour library.
fn regions(heights: &DMatrix<f64>, half_width: f64, largest: f64) -> Result<Vec<Region>, String> {
    let (across, up) = heights.shape();
    let step = 2.0 * half_width / across.saturating_sub(1).max(1) as f64;
    let shades = -SHADES + 1..=SHADES;
    let levels: Vec<f64> = shades
        .clone()
        .map(|shade| (f64::from(shade) - 0.5) / f64::from(SHADES) * largest)
        .collect();
    // The library puts the first node half a step from its origin.
    let origin = -half_width - 0.5 * step;
    let contours = ContourBuilder::new(across, up, true)
        .x_origin(origin)
        .y_origin(origin)
        .x_step(step)
        .y_step(step)
        .contours(heights.as_slice(), &levels)
        .map_err(|error| said(&error))?;
    let mut regions = Vec::new();
    for (contour, shade) in contours.iter().zip(shades) {
        for polygon in contour.geometry() {
            let outer = std::iter::once((polygon.exterior(), shade));
            // Inside a hole the height is below the level.
            let holes = polygon.interiors().iter().map(|hole| (hole, shade - 1));
            for (ring, shade) in outer.chain(holes) {
                let edge: Vec<Point> = ring
                    .coords()
                    .map(|at| {
                        let within = |angle: f64| angle.clamp(-half_width, half_width);
                        (within(at.x), within(at.y))
                    })
                    .collect();
                let area = area(&edge);
                regions.push(Region { edge, shade, area });
            }
        }
    }
    // A stable order: of regions that fill the map, the higher level comes last.
    regions.sort_by(|one, other| other.area.total_cmp(&one.area));
    Ok(regions)
}

/// Area inside a closed polygon.
fn area(corners: &[Point]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let twice: f64 = corners
        .iter()
        .zip(next)
        .map(|(from, to)| from.0 * to.1 - to.0 * from.1)
        .sum();
    0.5 * twice.abs()
}

/// The colour of a step between −`SHADES` and `SHADES`.
fn color(shade: i32) -> RGBColor {
    let share = 0.5 * (1.0 + f64::from(shade) / f64::from(SHADES));
    Palette::Diverging.color(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_has_the_colour_of_its_height() {
        // Hills, hollows and a saddle, which give regions inside regions.
        let count = 61;
        let place = |k: usize| 2.0 * (k as f64 / 30.0 - 1.0);
        let height = |x: f64, y: f64| (2.0 * x).sin() * (1.5 * y).cos() + 0.3 * x;
        let heights = DMatrix::from_fn(count, count, |i, j| height(place(i), place(j)));
        let largest = heights.amax();
        let regions = regions(&heights, 2.0, largest).unwrap();
        let inside = |edge: &[Point], (x, y): Point| {
            let next = edge.iter().cycle().skip(1);
            let crossings = edge.iter().zip(next).filter(|(from, to)| {
                (from.1 > y) != (to.1 > y)
                    && x < from.0 + (y - from.1) / (to.1 - from.1) * (to.0 - from.0)
            });
            crossings.count() % 2 == 1
        };
        let mut worst = 0.0_f64;
        for i in 0..40 {
            for j in 0..40 {
                let at = (
                    -1.9 + 3.8 / 39.0 * f64::from(i),
                    -1.9 + 3.8 / 39.0 * f64::from(j),
                );
                let painted = regions.iter().rfind(|region| inside(&region.edge, at));
                let shade = painted.map_or(-SHADES, |region| region.shade);
                let exact = height(at.0, at.1) / largest * f64::from(SHADES);
                worst = worst.max((f64::from(shade) - exact).abs());
            }
        }
        // Half a shade, and what linear interpolation leaves.
        assert!(worst < 0.6, "{worst}");
    }
}
