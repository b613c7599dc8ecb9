//! The gait in the plane of the joint angles, as a small plot next to the body.

use plotters::style::RGBColor;

use super::{Swimming, time_color};
use crate::report::drawing::{Anchor, Drawing};
use crate::report::style::{AXIS, INK, Point, arrows};

/// A square of the page that shows the plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    corner: Point,
    side: f64,
    /// The largest angle that is shown, rad.
    reach: f64,
}

/// Sizes of letters: numbers at the axes, and names of the axes.
const NUMBERS: i32 = 15;
const NAMES: i32 = 15;
/// Behind the curve, and the lines where an angle is zero.
const PAPER: RGBColor = RGBColor(0xf5, 0xf7, 0xf9);
const ZERO: RGBColor = RGBColor(0xd5, 0xdb, 0xe1);

impl Plane {
    /// A square with its upper left corner there, large enough for the gait.
    pub(super) fn new(swimming: &Swimming, corner: Point, side: f64) -> Self {
        let angles = swimming.moments.iter().flat_map(|moment| moment.phi);
        let largest = angles.fold(0.1_f64, |most, angle| most.max(angle.abs()));
        Self {
            corner,
            side,
            reach: 1.15 * largest,
        }
    }

    pub(super) fn at(&self, [front, back]: [f64; 2]) -> Point {
        let unit = 0.5 * self.side / self.reach;
        (
            self.corner.0 + 0.5 * self.side + unit * front,
            self.corner.1 + 0.5 * self.side - unit * back,
        )
    }

    /// Paper, axes and the angles at their ends.
    pub(super) fn frame(&self, drawing: &mut Drawing) {
        let (left, top) = self.corner;
        let (right, bottom) = (left + self.side, top + self.side);
        let (x, y) = self.at([0.0, 0.0]);
        drawing.rectangle(self.corner, (right, bottom), (PAPER, 1.0));
        drawing.line(&[(left, y), (right, y)], 1.0, (ZERO, 1.0));
        drawing.line(&[(x, top), (x, bottom)], 1.0, (ZERO, 1.0));
        let tick = self.tick();
        let degrees = |angle: f64| {
            let text = format!("{:.0}°", angle.to_degrees());
            text.replace('-', "\u{2212}")
        };
        for angle in [-tick, tick] {
            let (across, down) = (self.at([angle, 0.0]).0, self.at([0.0, angle]).1);
            drawing.line(
                &[(across, bottom - 4.0), (across, bottom)],
                1.0,
                (AXIS, 1.0),
            );
            drawing.line(&[(left, down), (left + 4.0, down)], 1.0, (AXIS, 1.0));
            let text = degrees(angle);
            drawing.words((across, bottom + 17.0), NUMBERS, INK, Anchor::Middle, &text);
            drawing.words((left - 6.0, down + 5.0), NUMBERS, INK, Anchor::End, &text);
        }
        drawing.words((x, bottom + 17.0), NAMES, INK, Anchor::Middle, "front φ₁");
        let above = (left, top - 6.0);
        drawing.words(above, NAMES, INK, Anchor::Start, "back φ₂");
    }

    /// The first cycle of the gait, in the colours of time where there is no other.
    pub(super) fn gait(&self, drawing: &mut Drawing, swimming: &Swimming, colored: bool) {
        let cycle = swimming.a_cycle();
        let points: Vec<Point> = swimming
            .moments
            .iter()
            .take(cycle + 1)
            .map(|moment| self.at(moment.phi))
            .collect();
        if !colored {
            drawing.line(&points, 2.0, (AXIS, 1.0));
            return;
        }
        let pieces = points.len().saturating_sub(1).max(1);
        for (number, piece) in points.windows(2).enumerate() {
            let color = time_color((number as f64 + 0.5) / pieces as f64);
            drawing.line(piece, 2.6, (color, 1.0));
        }
        // Heads are eighths of the curve from its start, and so are the marks of the shapes: these begin between two of them.
        let mut points = points;
        points.pop();
        let between = points.len() / 16;
        points.rotate_left(between);
        for (at, along) in arrows(&points) {
            drawing.arrow_head(at, along, 11.0, (INK, 1.0));
        }
    }

    /// A round angle near the edge, rad.
    fn tick(&self) -> f64 {
        let steps = [
            5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0, 360.0_f64,
        ];
        let fits = |degrees: &&f64| degrees.to_radians() <= 0.85 * self.reach;
        let largest = steps.iter().rev().find(fits).unwrap_or(&5.0);
        largest.to_radians()
    }
}
