//! All gaits of an atlas in one picture: closed curves in the plane of joint angles, as SVG.

use gait_optimizer::OptimalGait;

use crate::failure::Outcome;
use crate::picture_file::FigureWidth;
use crate::report::chart::{Chart, Point, Series};
use crate::report::style::CURVES;

/// Largest number of gaits in the picture; the table has all. More curves than colours cannot be distinguished.
const MOST: usize = 2 * CURVES.len();
/// Width and height, pixels of the page.
const SIZE: (i32, i32) = (620, 580);

/// The picture's text, each gait with its value, the best on top; the second half of the gaits is dashed.
///
/// # Errors
/// Errors of the drawing.
pub(super) fn svg(
    title: String,
    optima: &[(&OptimalGait, String)],
    width: FigureWidth,
) -> Outcome<String> {
    let mut series = Vec::new();
    let mut legend = Vec::new();
    for (number, ((gait, value), color)) in optima.iter().zip(CURVES.iter().cycle()).enumerate() {
        if number >= MOST {
            break;
        }
        let points: Vec<Point> = gait.phi().iter().map(|phi| (phi.x, phi.y)).collect();
        let (color, breadth) = (*color, 2.0);
        series.push(Series::Arrows {
            points: points.clone(),
            color,
        });
        series.push(if number < CURVES.len() {
            Series::Line {
                points,
                color,
                width: breadth,
            }
        } else {
            Series::Dashes {
                points,
                color,
                width: breadth,
            }
        });
        let dashed = if number < CURVES.len() {
            ""
        } else {
            ", dashed"
        };
        legend.push((format!("{}: {value}{dashed}", number + 1), color));
    }
    series.reverse();
    Chart {
        title,
        x_label: "φ₁ [rad]".into(),
        y_label: "φ₂ [rad]".into(),
        size: SIZE,
        equal_axes: true,
        series,
        legend,
    }
    .wide(width)
    .svg()
}
