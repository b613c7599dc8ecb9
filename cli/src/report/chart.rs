//! One chart in the common style, as inline SVG: thin axes, few ticks, the paper's colours.

use std::ops::Range;

use plotters::prelude::*;

use super::colour_bar::{self, ColourBar};
use super::placing::Obstacles;
use super::style::{
    AXIS, Area, LEGEND_INDENT, LEGEND_LINE, NAMES, NUMBERS, SCALE, TITLE, WORDS, arrows, broken,
    finished, head, legend, letters, pixels, said, stroke,
};
pub(crate) use super::style::{INK, Point};
use crate::failure::{Failure, Outcome};
use crate::picture_file::{COLUMN, FigureWidth};

/// Colour of measurements.
pub(crate) const MEASURED: RGBColor = RGBColor(0x1f, 0x6f, 0xb2);
/// The slender model without a sphere.
pub(crate) const SLENDER: RGBColor = RGBColor(0x3a, 0x9d, 0x5d);
/// Colour of the fitted model's predictions.
pub(crate) const PREDICTED: RGBColor = RGBColor(0xd3, 0x5b, 0x1e);
/// Arcs on a bound, as a broad band under what was played.
pub(crate) const BOUND: RGBColor = RGBColor(0xd8, 0xb9, 0xe6);
/// Singular arcs, as a broad band.
pub(crate) const SINGULAR: RGBColor = RGBColor(0xc3, 0xcd, 0xd6);
/// A broad band of what was measured, to draw a prediction upon.
pub(crate) const MEASURED_BAND: RGBColor = RGBColor(0x9d, 0xc6, 0xe8);
const FAINT: RGBColor = RGBColor(0xe3, 0xe7, 0xeb);

/// Discs that words keep off; of more, a word would find no place.
const MOST_OBSTACLES: usize = 60;
/// Left end of the legend, and height of a line of the title, pixels of the page.
const LEGEND_LEFT: i32 = 64;
const TITLE_LINE: i32 = 25;
/// Names below the horizontal axis.
const MOST_NAMES: usize = 20;

/// Something drawn on a chart.
#[derive(Debug, Clone)]
pub(crate) enum Series {
    /// A curve; `width` in pixels of the page.
    Line {
        points: Vec<Point>,
        color: RGBColor,
        width: f64,
    },
    /// A curve of dashes.
    Dashes {
        points: Vec<Point>,
        color: RGBColor,
        width: f64,
    },
    /// Filled discs; `radius` in pixels of the page.
    Dots {
        points: Vec<Point>,
        color: RGBColor,
        radius: f64,
    },
    /// Discs with a vertical bar of ± the third number.
    Bars {
        points: Vec<(f64, f64, f64)>,
        color: RGBColor,
    },
    /// Filled rectangles, each from (left, low) to (right, high), without air around them.
    Cells(Vec<([f64; 4], RGBColor)>),
    /// Heads of arrows along a closed curve, the way its points run; on equal axes.
    Arrows { points: Vec<Point>, color: RGBColor },
    /// Colour bar of the field whose cells are drawn, to the right of the axes.
    ColourBar(ColourBar),
    /// Names under 1, 2, 3 … of the horizontal axis instead of numbers.
    Names(Vec<String>),
    /// A short label next to a point.
    Word {
        at: Point,
        text: String,
        color: RGBColor,
    },
}

/// Contents and axes of a chart.
#[derive(Debug, Clone)]
pub(crate) struct Chart {
    /// Title; empty if the page has it.
    pub(crate) title: String,
    /// Under the horizontal axis, with its unit.
    pub(crate) x_label: String,
    /// Beside the vertical axis, with its unit.
    pub(crate) y_label: String,
    /// Width and height in pixels of the page, without the legend.
    pub(crate) size: (i32, i32),
    /// One unit is as long up as it is across.
    pub(crate) equal_axes: bool,
    /// Drawn in this order.
    pub(crate) series: Vec<Series>,
    /// Names of curves, listed below; for a figure without a caption.
    pub(crate) legend: Vec<(String, RGBColor)>,
}

/// Pixels of the page for a number on the horizontal axis.
const NUMBER_WIDTH: i32 = 62;

impl Chart {
    /// The same chart in a figure of a width in print: a column has its own proportions, since letters stay as they are.
    #[must_use]
    pub(crate) fn wide(mut self, width: FigureWidth) -> Self {
        if width == FigureWidth::Column && self.size.0 > COLUMN {
            // A little taller: axes' names and numbers take the same height.
            self.size = (COLUMN, self.size.1 * COLUMN * 11 / (self.size.0 * 10));
        }
        self
    }

    /// Draws the chart.
    ///
    /// # Errors
    /// [`Failure::Tried`] when the drawing library gives up.
    pub(crate) fn svg(&self) -> Outcome<String> {
        let mut text = String::new();
        let legend = self.legend_lines();
        let lines = i32::try_from(legend.len()).unwrap_or(i32::MAX / 1000);
        let size = (self.size.0, self.size.1 + LEGEND_LINE * lines);
        {
            let drawn = [size.0, size.1].map(|side| (side * SCALE).unsigned_abs());
            let area = SVGBackend::with_string(&mut text, drawn.into()).into_drawing_area();
            self.draw(&area, &legend).map_err(|reason| {
                Failure::Tried(format!(
                    "cannot draw the chart of {} over {}: {reason}",
                    self.y_label, self.x_label
                ))
            })?;
        }
        Ok(finished(&text, size, &self.name()))
    }

    /// Name for readers of screens: the title, or the axes.
    fn name(&self) -> String {
        match (self.title.as_str(), self.x_label.as_str()) {
            ("", "") => format!("{} of each", self.y_label),
            ("", x_label) => format!("{} over {x_label}", self.y_label),
            (title, _) => title.to_owned(),
        }
    }

    /// Names of curves, on several lines if they are wider than the figure; only the first line has a colour.
    fn legend_lines(&self) -> Vec<(String, Option<RGBColor>)> {
        let of_one = |(name, color): &(String, RGBColor)| {
            let lines = broken(name, WORDS, self.size.0 - LEGEND_LEFT - LEGEND_INDENT);
            let colors = std::iter::once(Some(*color)).chain(std::iter::repeat(None));
            lines.into_iter().zip(colors).collect::<Vec<_>>()
        };
        self.legend.iter().flat_map(of_one).collect()
    }

    /// Lines of the title.
    fn title_lines(&self) -> Vec<String> {
        broken(&self.title, TITLE, self.size.0 - LEGEND_LEFT)
    }

    /// Width of the numbers at the y axis and of its name \[px\].
    fn label_width(y_range: &Range<f64>) -> i32 {
        let format = label_format(y_range, 6);
        let longest = [y_range.start, y_range.end].map(|value| format(&value).chars().count());
        let beyond_four = longest.into_iter().max().unwrap_or(0).saturating_sub(4);
        64 + 8 * i32::try_from(beyond_four).unwrap_or(0)
    }

    #[allow(clippy::too_many_lines)] // one chart, part after part
    fn draw(
        &self,
        whole: &Area<'_>,
        legend_lines: &[(String, Option<RGBColor>)],
    ) -> Result<(), String> {
        whole.fill(&WHITE).map_err(|error| said(&error))?;
        let named = legend_lines
            .iter()
            .map(|(name, color)| (name.as_str(), *color));
        legend(whole, (LEGEND_LEFT, self.size.1), named)?;
        let (area, _) = whole.split_vertically(self.size.1 * SCALE);
        let bar = self.colour_bar();
        let width = self.size.0 - bar.map_or(0, |_| colour_bar::WIDTH);
        let (area, beside) = area.split_horizontally(width * SCALE);
        let label_height = 42 * SCALE;
        let (top, right) = (self.top() * SCALE, 24 * SCALE);
        let inside = |label_width: i32| {
            (
                width * SCALE - label_width - right,
                self.size.1 * SCALE - label_height - top,
            )
        };
        let label_width = Self::label_width(&self.ranges(inside(64 * SCALE)).1) * SCALE;
        if let Some(bar) = bar {
            let (beside, _) = beside.split_vertically(self.size.1 * SCALE - label_height);
            let numbers = if self.size.0 > COLUMN { 9 } else { 6 };
            bar.draw(&beside, self.top(), numbers)?;
        }
        let mut title_top = 10;
        // A long title begins where the figure does.
        let title_lines = self.title_lines();
        let title_left = if title_lines.len() > 1 {
            LEGEND_INDENT * SCALE / 4
        } else {
            label_width
        };
        for line in &title_lines {
            whole
                .draw_text(line, &letters(TITLE, INK), (title_left, title_top * SCALE))
                .map_err(|error| said(&error))?;
            title_top += TITLE_LINE;
        }
        let (x_range, y_range) = self.ranges(inside(label_width));
        let x_numbers = (inside(label_width).0 / (NUMBER_WIDTH * SCALE)).clamp(3, 7);
        let x_numbers = u8::try_from(x_numbers).unwrap_or(7);
        let x_label = label_format(&x_range, x_numbers);
        let mut chart = ChartBuilder::on(&area)
            .margin_top(top)
            .margin_left(8 * SCALE)
            .margin_right(right)
            .x_label_area_size(label_height)
            .y_label_area_size(label_width - 8 * SCALE)
            .build_cartesian_2d(x_range.clone(), y_range.clone())
            .map_err(|error| said(&error))?;
        chart
            .configure_mesh()
            .x_labels(
                self.names()
                    .map_or(x_numbers.into(), |names| names.len() + 2),
            )
            .y_labels(6)
            .x_label_formatter(&|value| self.x_name(*value).unwrap_or_else(|| x_label(value)))
            .y_label_formatter(&label_format(&y_range, 6))
            .max_light_lines(0)
            .bold_line_style(ShapeStyle {
                color: FAINT.into(),
                filled: false,
                stroke_width: SCALE.unsigned_abs(),
            })
            .axis_style(ShapeStyle {
                color: AXIS.into(),
                filled: false,
                stroke_width: SCALE.unsigned_abs(),
            })
            .set_all_tick_mark_size(4 * SCALE)
            .label_style(letters(NUMBERS, INK))
            .axis_desc_style(letters(NAMES, INK))
            .x_desc(self.x_label.as_str())
            .y_desc(self.y_label.as_str())
            .draw()
            .map_err(|error| said(&error))?;
        let mut places = Obstacles::default();
        for series in &self.series {
            if let Series::Dots { points, radius, .. } = series
                && points.len() <= MOST_OBSTACLES
            {
                for point in points {
                    places.disc(chart.backend_coord(point), pixels(*radius));
                }
            }
        }
        for series in &self.series {
            match series {
                Series::Line {
                    points,
                    color,
                    width,
                } => {
                    chart
                        .draw_series(LineSeries::new(
                            points.iter().copied(),
                            stroke(*color, *width),
                        ))
                        .map_err(|error| said(&error))?;
                }
                Series::Dashes {
                    points,
                    color,
                    width,
                } => {
                    let dashes = DashedLineSeries::new(
                        points.iter().copied(),
                        5 * SCALE,
                        4 * SCALE,
                        stroke(*color, *width),
                    );
                    chart.draw_series(dashes).map_err(|error| said(&error))?;
                }
                Series::Dots {
                    points,
                    color,
                    radius,
                } => {
                    let discs = points
                        .iter()
                        .map(|point| Circle::new(*point, pixels(*radius), color.filled()));
                    chart.draw_series(discs).map_err(|error| said(&error))?;
                }
                Series::Bars { points, color } => {
                    let bars = points.iter().map(|&(x, y, half)| {
                        PathElement::new([(x, y - half), (x, y + half)], stroke(*color, 1.5))
                    });
                    chart.draw_series(bars).map_err(|error| said(&error))?;
                    let discs = points
                        .iter()
                        .map(|&(x, y, _)| Circle::new((x, y), pixels(3.6), color.filled()));
                    chart.draw_series(discs).map_err(|error| said(&error))?;
                }
                Series::Arrows { points, color } => {
                    let heads = arrows(points).into_iter().map(|(at, along)| {
                        EmptyElement::at(at) + Polygon::new(head(along), color.filled())
                    });
                    chart.draw_series(heads).map_err(|error| said(&error))?;
                }
                Series::Cells(cells) => {
                    let cells = cells.iter().map(|([left, low, right, high], color)| {
                        Rectangle::new([(*left, *low), (*right, *high)], color.filled())
                    });
                    chart.draw_series(cells).map_err(|error| said(&error))?;
                }
                Series::Names(_) | Series::ColourBar(_) => {}
                Series::Word { at, text, color } => {
                    let style = letters(WORDS, *color);
                    let count = i32::try_from(text.chars().count()).unwrap_or(0);
                    let size = (count * WORDS * SCALE * 3 / 5, WORDS * SCALE);
                    let usual = (6 * SCALE, -8 * SCALE);
                    let within = (width * SCALE, self.size.1 * SCALE);
                    let placed = places.word(chart.backend_coord(at), size, usual, within);
                    let (x, y) = placed.offset;
                    if placed.is_far {
                        // The edge that faces the point.
                        let corner = (x + (-x).clamp(0, size.0), y + (-y).clamp(0, size.1));
                        let joined = EmptyElement::at(*at)
                            + PathElement::new(vec![(0, 0), corner], stroke(AXIS, 0.8));
                        chart
                            .draw_series(std::iter::once(joined))
                            .map_err(|error| said(&error))?;
                    }
                    let word = EmptyElement::at(*at) + Text::new(text.clone(), (x, y), style);
                    chart
                        .draw_series(std::iter::once(word))
                        .map_err(|error| said(&error))?;
                }
            }
        }
        Ok(())
    }

    /// Above the plane of the axes, pixels of the page.
    fn top(&self) -> i32 {
        if self.title.is_empty() {
            return 10;
        }
        let more = self.title_lines().len().saturating_sub(1);
        44 + TITLE_LINE * i32::try_from(more).unwrap_or(0)
    }

    fn colour_bar(&self) -> Option<&ColourBar> {
        self.series.iter().find_map(|series| match series {
            Series::ColourBar(bar) => Some(bar),
            _ => None,
        })
    }

    /// Labels at 1, 2, 3 …, if the horizontal axis is not a scale.
    fn names(&self) -> Option<&[String]> {
        self.series.iter().find_map(|series| match series {
            Series::Names(names) => Some(names.as_slice()),
            _ => None,
        })
    }

    fn x_name(&self, value: f64) -> Option<String> {
        let mut names = self.names()?.iter().enumerate();
        // More names than fit are thinned.
        let every = names.len().div_ceil(MOST_NAMES).max(1);
        let is_there = |(place, _): &(usize, &String)| {
            place.is_multiple_of(every) && (*place as f64 + 1.0 - value).abs() < 1e-6
        };
        Some(
            names
                .find(is_there)
                .map_or_else(String::new, |(_, name)| name.clone()),
        )
    }

    /// Ranges of the axes: all points with a margin, and equal units if requested.
    fn ranges(&self, inside: (i32, i32)) -> (Range<f64>, Range<f64>) {
        let points: Vec<Point> = self.series.iter().flat_map(Series::extent).collect();
        let mut x = with_air(points.iter().map(|point| point.0));
        let mut y = with_air(points.iter().map(|point| point.1));
        if self.equal_axes {
            let (width, height) = (f64::from(inside.0), f64::from(inside.1));
            let unit = ((x.end - x.start) / width).max((y.end - y.start) / height);
            x = widened(&x, unit * width);
            y = widened(&y, unit * height);
        }
        (x, y)
    }
}

impl Series {
    fn extent(&self) -> Vec<Point> {
        match self {
            Self::Line { points, .. } | Self::Dashes { points, .. } | Self::Dots { points, .. } => {
                points.clone()
            }
            Self::Bars { points, .. } => points
                .iter()
                .flat_map(|&(x, y, half)| [(x, y - half), (x, y + half)])
                .collect(),
            Self::Cells(cells) => cells
                .iter()
                .flat_map(|([left, low, right, high], _)| [(*left, *low), (*right, *high)])
                .collect(),
            Self::Word { at, .. } => vec![*at],
            Self::Names(_) | Self::Arrows { .. } | Self::ColourBar(_) => Vec::new(),
        }
    }
}

fn with_air(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return 0.0..1.0;
    }
    let air = if high > low {
        0.05 * (high - low)
    } else {
        high.abs().max(1.0) * 0.1
    };
    low - air..high + air
}

fn widened(range: &Range<f64>, length: f64) -> Range<f64> {
    let middle = f64::midpoint(range.start, range.end);
    middle - 0.5 * length..middle + 0.5 * length
}

/// Fewest decimals that distinguish neighbouring ticks.
pub(crate) fn label_format(range: &Range<f64>, ticks: u8) -> impl Fn(&f64) -> String {
    let step = (range.end - range.start) / f64::from(ticks);
    let decimals = if step > 0.0 {
        (-step.log10()).ceil().clamp(0.0, 6.0)
    } else {
        0.0
    };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Between 0 and 6.
    let decimals = decimals as usize;
    move |value: &f64| {
        let zero = value.abs() < 1e-9 * step.abs().max(f64::MIN_POSITIVE);
        format!("{:.decimals$}", if zero { 0.0 } else { *value }).replace('-', "\u{2212}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<Point>) -> Chart {
        Chart {
            title: String::new(),
            x_label: "x [mm]".into(),
            y_label: "y [mm]".into(),
            size: (400, 300),
            equal_axes: true,
            series: vec![Series::Line {
                points,
                color: INK,
                width: 1.5,
            }],
            legend: Vec::new(),
        }
    }

    #[test]
    fn ranges_hold_every_point_and_keep_units_equal() {
        let (x, y) = chart(vec![(0.0, 0.0), (10.0, 1.0)]).ranges((300, 200));
        assert!(x.start < 0.0 && x.end > 10.0 && y.start < 0.0 && y.end > 1.0);
        assert!(((x.end - x.start) / 300.0 - (y.end - y.start) / 200.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_to_draw_is_still_a_chart() {
        for points in [vec![], vec![(f64::NAN, 1.0)], vec![(2.0, 2.0)]] {
            let svg = chart(points).svg().unwrap();
            assert!(
                svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"),
                "{svg}"
            );
        }
    }

    #[test]
    fn labels_tell_ticks_apart() {
        let format = label_format(&(0.0..0.7), 7);
        assert_eq!(format(&0.1), "0.1");
        assert_eq!(format(&-0.1), "\u{2212}0.1");
        assert_eq!(label_format(&(0.0..700.0), 7)(&100.0), "100");
    }
}
