//! One cycle in motion: the body where it is, the way that its centre has gone, and the place in the gait.

use nalgebra::Vector2;

use super::body::{BodyStyle, Window, covered, draw};
use super::joints::Plane;
use super::{Swimming, time_color};
use crate::failure::Outcome;
use crate::raster::{gif, painted};
use crate::report::drawing::{Anchor, Drawing};
use crate::report::style::{AXIS, INK, Point, TITLE, WORDS, number};

/// Frame rate.
pub(crate) const FRAMES_PER_SECOND: u16 = 20;
/// Width and height of the images, pixels.
pub(crate) const SIZE: (u16, u16) = (640, 330);
/// Images of the cycle: it takes three seconds.
const FRAMES: u16 = 60;
/// Duration of the last image, hundredths of a second.
const STAY: u16 = 120;
/// Corner and size of the body's scene; those of the plane of the joint angles follow.
const SCENE: [Point; 2] = [(16.0, 44.0), (390.0, 234.0)];
const PLANE: (Point, f64) = ((460.0, 64.0), 164.0);

/// The first cycle as a looping GIF.
///
/// # Errors
/// Errors of the painting.
pub(crate) fn animation(swimming: &Swimming) -> Outcome<Vec<u8>> {
    let cycle = swimming.a_cycle();
    let moments = swimming.moments.get(..=cycle).unwrap_or_default();
    let places: Vec<Vector2<f64>> = moments
        .iter()
        .flat_map(|moment| covered(swimming, moment))
        .collect();
    let window = Window::showing(&places, SCENE[0], SCENE[1], f64::INFINITY);
    let mut images = Vec::new();
    for frame in 0..=FRAMES {
        let now = usize::from(frame) * cycle / usize::from(FRAMES);
        let drawing = image(swimming, &window, now);
        let shown_for = if frame == FRAMES {
            STAY
        } else {
            100 / FRAMES_PER_SECOND
        };
        images.push((painted(&drawing.svg(), 1.0)?, shown_for));
    }
    gif(&images)
}

fn image(swimming: &Swimming, window: &Window, now: usize) -> Drawing {
    let (width, height) = (f64::from(SIZE.0), f64::from(SIZE.1));
    let mut drawing = Drawing::new(swimming.name(), width, height);
    drawing.words((16.0, 28.0), TITLE, INK, Anchor::Start, &swimming.title);
    let plane = Plane::new(swimming, PLANE.0, PLANE.1);
    plane.frame(&mut drawing);
    plane.gait(&mut drawing, swimming, false);
    let (Some(first), Some(moment)) = (swimming.moments.first(), swimming.moments.get(now)) else {
        return drawing;
    };
    let ghost = BodyStyle {
        color: AXIS,
        opacity: 0.35,
        whole: false,
    };
    draw(&mut drawing, window, swimming, first, ghost);
    let color = time_color(0.75);
    let body = BodyStyle {
        color,
        opacity: 1.0,
        whole: true,
    };
    draw(&mut drawing, window, swimming, moment, body);
    let gone = swimming.moments.get(..=now).unwrap_or_default();
    let path: Vec<Point> = gone
        .iter()
        .map(|moment| window.at(&moment.pose.position()))
        .collect();
    drawing.line(&path, 3.6, (plotters::style::WHITE, 0.8));
    drawing.line(&path, 2.0, (time_color(0.0), 1.0));
    let shapes: Vec<Point> = gone.iter().map(|moment| plane.at(moment.phi)).collect();
    drawing.line(&shapes, 2.4, (color, 1.0));
    drawing.disc(plane.at(moment.phi), 6.0, (color, 1.0));
    let along = moment.pose.position().x / swimming.length();
    let caption = format!("x/L = {}", number(along, 3));
    drawing.words((16.0, height - 16.0), WORDS, INK, Anchor::Start, &caption);
    drawing
}
