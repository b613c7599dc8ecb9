//! Snapshots of the swimmer along its path, coloured by time, with the path of its centre, a scale and the gait.

use nalgebra::Vector2;

use super::body::{BodyStyle, Window, covered, draw, extent};
use super::joints::Plane;
use super::{Swimming, time_color};
use crate::picture_file::{COLUMN, FigureWidth};
use crate::report::drawing::{Anchor, Drawing};
use crate::report::style::{INK, Point, TITLE, WORDS, arrows, broken};

/// Places in the picture, pixels of the page.
struct Layout {
    width: f64,
    /// Left end and width of the swimmer's area.
    left: f64,
    scene: f64,
    /// Greatest and least height of that area.
    tallest: f64,
    least: f64,
    /// Side of the plane of the joint angles.
    plane: f64,
    /// The plane and the colours of time are below the swimmer instead of next to it.
    is_column: bool,
}

impl Layout {
    fn new(width: FigureWidth) -> Self {
        match width {
            FigureWidth::Page => Self {
                width: 900.0,
                left: 24.0,
                scene: 590.0,
                tallest: 460.0,
                least: 250.0,
                plane: 208.0,
                is_column: false,
            },
            FigureWidth::Column => Self {
                width: f64::from(COLUMN),
                left: 8.0,
                scene: f64::from(COLUMN) - 16.0,
                tallest: 420.0,
                least: 0.0,
                plane: 200.0,
                is_column: true,
            },
        }
    }

    /// Corner of the plane, and left end, width and height of the colours of time, for a scene of this top and height.
    fn plane_and_time(&self, top: f64, height: f64) -> (Point, Point, f64) {
        if self.is_column {
            let corner = (66.0, top + height + BELOW + 20.0);
            let left = corner.0 + self.plane + 36.0;
            let time = (left, corner.1 + 0.5 * self.plane);
            return (corner, time, self.width - 16.0 - left);
        }
        let corner = (668.0, top + (height - self.plane) / 2.0);
        (corner, (corner.0, top + height + 20.0), self.plane)
    }

    /// Height of the whole picture.
    fn height(&self, top: f64, height: f64) -> f64 {
        let plane = if self.is_column {
            self.plane + 52.0
        } else {
            0.0
        };
        top + height + BELOW + plane
    }
}

/// Bodies of one cycle, the last one included, and at most of several: more hide each other.
const OF_ONE: usize = 9;
const OF_SEVERAL: usize = 5;
/// Air around the scene.
const AIR: f64 = 14.0;
/// Under the scene: scale and colours of time.
const BELOW: f64 = 54.0;
/// Length of the arrow heads on the path.
const HEAD: f64 = 10.0;
/// Pieces of the colour bar.
const PIECES: u8 = 60;

/// The picture as SVG.
pub(crate) fn snapshots(swimming: &Swimming, width: FigureWidth) -> String {
    let layout = Layout::new(width);
    let shown = shown(swimming);
    let bodies = shown
        .iter()
        .filter_map(|place| swimming.moments.get(*place));
    let places: Vec<Vector2<f64>> = bodies
        .flat_map(|moment| covered(swimming, moment))
        .chain(swimming.moments.iter().map(|moment| moment.pose.position()))
        .collect();
    let (low, high) = extent(&places);
    let (across, up) = ((high.x - low.x).max(1e-9), (high.y - low.y).max(1e-9));
    let inner = layout.scene - 2.0 * AIR;
    let scale = (inner / across).min((layout.tallest - 2.0 * AIR) / up);
    let height = (scale * up + 2.0 * AIR).max(layout.least);
    #[allow(clippy::cast_possible_truncation)] // hundreds
    let lines = broken(
        &swimming.title,
        TITLE,
        (layout.width - 2.0 * layout.left) as i32,
    );
    let top = match lines.len() {
        0 => 8.0,
        lines => 22.0 + 24.0 * lines as f64,
    };
    let window = Window::showing(
        &places,
        (layout.left + AIR, top + AIR),
        (inner, height - 2.0 * AIR),
        scale,
    );
    let mut drawing = Drawing::new(swimming.name(), layout.width, layout.height(top, height));
    for (number, line) in lines.iter().enumerate() {
        let at = (layout.left, 28.0 + 24.0 * number as f64);
        drawing.words(at, TITLE, INK, Anchor::Start, line);
    }
    bodies_and_path(&mut drawing, &window, swimming, &shown);
    scale_bar(&mut drawing, swimming, &layout, scale, top + height + 20.0);
    let (corner, time, time_width) = layout.plane_and_time(top, height);
    time_bar(&mut drawing, swimming, time, time_width);
    let plane = Plane::new(swimming, corner, layout.plane);
    plane.frame(&mut drawing);
    plane.gait(&mut drawing, swimming, swimming.cycles == 1);
    for place in &shown {
        if let Some(moment) = swimming.moments.get(*place) {
            let color = time_color(share(swimming, *place));
            drawing.disc(plane.at(moment.phi), 5.0, (color, 1.0));
        }
    }
    drawing.svg()
}

/// Instants of the snapshots: eighths of a single cycle, whole cycles of several.
fn shown(swimming: &Swimming) -> Vec<usize> {
    let last = swimming.moments.len().saturating_sub(1);
    let cycles = usize::try_from(swimming.cycles.max(1)).unwrap_or(1);
    let (pieces, every) = match cycles {
        1 => (OF_ONE - 1, 1),
        several => (several, several.div_ceil(OF_SEVERAL - 1)),
    };
    // The last one always; from there back, evenly.
    let mut places: Vec<usize> = (0..=pieces)
        .rev()
        .step_by(every)
        .map(|piece| piece * last / pieces)
        .collect();
    places.reverse();
    places
}

fn share(swimming: &Swimming, place: usize) -> f64 {
    place as f64 / swimming.moments.len().saturating_sub(1).max(1) as f64
}

fn bodies_and_path(drawing: &mut Drawing, window: &Window, swimming: &Swimming, shown: &[usize]) {
    let last = shown.last().copied().unwrap_or_default();
    for place in shown {
        if let Some(moment) = swimming.moments.get(*place) {
            let age = share(swimming, *place);
            let look = BodyStyle {
                color: time_color(age),
                opacity: if *place == last {
                    1.0
                } else {
                    0.30 + 0.25 * age
                },
                whole: *place == last,
            };
            draw(drawing, window, swimming, moment, look);
        }
    }
    let path: Vec<Point> = swimming
        .moments
        .iter()
        .map(|moment| window.at(&moment.pose.position()))
        .collect();
    drawing.line(&path, 4.0, (plotters::style::WHITE, 0.85));
    let pieces = path.len().saturating_sub(1).max(1);
    for (number, piece) in path.windows(2).enumerate() {
        let color = time_color((number as f64 + 0.5) / pieces as f64);
        drawing.line(piece, 2.0, (color, 1.0));
    }
    direction(drawing, swimming, &path);
    if let Some(end) = path.last() {
        drawing.disc(*end, 5.0, (plotters::style::WHITE, 1.0));
        drawing.disc(*end, 3.4, (time_color(1.0), 1.0));
    }
}

/// Arrow heads along the path of a single cycle; of several cycles, whose path runs back and forth, an arrow of the net motion.
fn direction(drawing: &mut Drawing, swimming: &Swimming, path: &[Point]) {
    if swimming.cycles == 1 {
        for (at, along) in arrows(path) {
            drawing.arrow_head(at, along, HEAD, (INK, 1.0));
        }
        return;
    }
    let (Some(start), Some(end)) = (path.first(), path.last()) else {
        return;
    };
    let net = (end.0 - start.0, end.1 - start.1);
    let length = net.0.hypot(net.1);
    if length > 2.0 * HEAD {
        let at = (start.0 + 0.55 * net.0, start.1 + 0.55 * net.1);
        drawing.line(&[*start, *end], 1.2, (INK, 1.0));
        drawing.arrow_head(at, (net.0 / length, net.1 / length), 1.4 * HEAD, (INK, 1.0));
    }
}

/// A bar of a round part of L, about a fifth of the scene long.
fn scale_bar(drawing: &mut Drawing, swimming: &Swimming, layout: &Layout, scale: f64, y: f64) {
    let length = swimming.length();
    let wanted = 0.2 * layout.scene / (scale * length);
    let rounds = [
        0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0_f64,
    ];
    let fits = |part: &&f64| **part <= wanted;
    let part = rounds.iter().rev().find(fits).copied().unwrap_or(0.01);
    let left = layout.left + AIR;
    let right = left + part * length * scale;
    drawing.line(&[(left, y), (right, y)], 2.4, (INK, 1.0));
    for end in [left, right] {
        drawing.line(&[(end, y - 5.0), (end, y + 5.0)], 1.6, (INK, 1.0));
    }
    let metres = part * length;
    let caption = if metres < 1.0 {
        format!("{part} L = {} mm", (metres * 1e4).round() / 10.0)
    } else {
        format!("{part} L = {} m", (metres * 1e2).round() / 100.0)
    };
    drawing.words((right + 10.0, y + 5.0), WORDS, INK, Anchor::Start, &caption);
}

/// Legend of the colours.
fn time_bar(drawing: &mut Drawing, swimming: &Swimming, (left, y): Point, width: f64) {
    let step = width / f64::from(PIECES);
    for piece in 0..PIECES {
        let from = left + step * f64::from(piece);
        let color = time_color((f64::from(piece) + 0.5) / f64::from(PIECES));
        // A little overlap leaves no seams.
        drawing.rectangle((from, y - 6.0), (from + step + 0.3, y + 4.0), (color, 1.0));
    }
    let cycles = match swimming.cycles {
        1 => "1 cycle".to_owned(),
        cycles => format!("{cycles} cycles"),
    };
    drawing.words((left, y + 22.0), WORDS, INK, Anchor::Start, "time 0");
    drawing.words((left + width, y + 22.0), WORDS, INK, Anchor::End, &cycles);
}
