//! The body at one instant, drawn where it is; and the window through which the plane is seen.

use nalgebra::Vector2;
use plotters::style::RGBColor;
use swimmer_model::{Link, Links};

use super::{Moment, Swimming};
use crate::report::drawing::Drawing;
use crate::report::style::Point;

/// Breadth of a link over L.
const BREADTH: f64 = 0.026;

/// From metres to pixels of the page.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Pixels of a metre.
    pub(super) scale: f64,
    /// Position of the origin.
    pub(super) origin: Point,
}

impl Window {
    /// View of these places, centred in a box with this corner and size, with at most this many pixels per metre.
    pub(super) fn showing(
        places: &[Vector2<f64>],
        at: Point,
        (width, height): (f64, f64),
        largest: f64,
    ) -> Self {
        let (low, high) = extent(places);
        let (across, up) = ((high.x - low.x).max(1e-9), (high.y - low.y).max(1e-9));
        let scale = (width / across).min(height / up).min(largest);
        let middle = (low + high) / 2.0;
        Self {
            scale,
            origin: (
                at.0 + width / 2.0 - scale * middle.x,
                at.1 + height / 2.0 + scale * middle.y,
            ),
        }
    }

    pub(super) fn at(&self, place: &Vector2<f64>) -> Point {
        (
            self.origin.0 + self.scale * place.x,
            self.origin.1 - self.scale * place.y,
        )
    }
}

/// The corners of the box around places.
pub(super) fn extent(places: &[Vector2<f64>]) -> (Vector2<f64>, Vector2<f64>) {
    let start = (
        Vector2::repeat(f64::INFINITY),
        Vector2::repeat(f64::NEG_INFINITY),
    );
    let finite = places
        .iter()
        .filter(|place| place.iter().all(|x| x.is_finite()));
    let (low, high) = finite.fold(start, |(low, high), place| {
        (low.inf(place), high.sup(place))
    });
    if low.x > high.x {
        return (Vector2::zeros(), Vector2::repeat(1.0));
    }
    (low, high)
}

/// Tip of the back link, back joint, front joint, tip of the front link, in the plane.
pub(super) fn outline(links: &Links<f64>, moment: &Moment) -> [Vector2<f64>; 4] {
    links
        .outline(&moment.phi.into())
        .map(|place| moment.pose.transform(&place))
}

/// Centre of the link that carries the sphere, in the plane.
fn sphere_centre(swimming: &Swimming, moment: &Moment) -> Vector2<f64> {
    let [back_tip, back, front, front_tip] = outline(&swimming.links, moment);
    match swimming.sphere_on {
        Link::Middle => moment.pose.position(),
        Link::Front => (front + front_tip) * 0.5,
        Link::Back => (back + back_tip) * 0.5,
    }
}

/// Everything that a body at an instant covers, for a window around it.
pub(super) fn covered(swimming: &Swimming, moment: &Moment) -> Vec<Vector2<f64>> {
    let breadth = BREADTH * swimming.length();
    let around = |place: Vector2<f64>, reach: f64| {
        [
            place + Vector2::new(reach, reach),
            place - Vector2::new(reach, reach),
        ]
    };
    let links = outline(&swimming.links, moment)
        .into_iter()
        .flat_map(|place| around(place, breadth));
    let sphere = around(sphere_centre(swimming, moment), swimming.sphere_radius);
    links.chain(sphere).collect()
}

/// Style of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyStyle {
    pub(super) color: RGBColor,
    pub(super) opacity: f64,
    /// With joints, a mark at its head and the sphere; else a ghost.
    pub(super) whole: bool,
}

/// Draws the body.
pub(super) fn draw(
    drawing: &mut Drawing,
    window: &Window,
    swimming: &Swimming,
    moment: &Moment,
    look: BodyStyle,
) {
    let breadth = (BREADTH * swimming.length() * window.scale).max(2.5);
    let [back_tip, back, front, front_tip] =
        outline(&swimming.links, moment).map(|place| window.at(&place));
    let centre = window.at(&sphere_centre(swimming, moment));
    if swimming.sphere_radius > 0.0 && look.whole {
        let radius = swimming.sphere_radius * window.scale;
        drawing.disc(centre, radius, (look.color, 0.07));
        drawing.ring(centre, radius, 1.2, (look.color, 0.5));
    }
    let body = [back_tip, back, front, front_tip];
    drawing.line(&body, breadth, (look.color, look.opacity));
    if look.whole {
        let white = RGBColor(255, 255, 255);
        for joint in [back, front] {
            drawing.disc(joint, 0.34 * breadth, (white, 1.0));
        }
        drawing.disc(front_tip, 0.75 * breadth, (look.color, look.opacity));
    }
}
