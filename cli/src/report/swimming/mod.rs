//! The swimmer itself: snapshots along its path, and one cycle in motion.

mod animation;
mod body;
mod joints;
mod snapshots;

pub(crate) use animation::{FRAMES_PER_SECOND, SIZE as ANIMATION_SIZE, animation};
pub(crate) use snapshots::snapshots;

use plotters::style::RGBColor;
use swimmer_model::{Gait, Link, Links, Model, Pose, Tolerance, trajectory};

/// Poses and shapes of the body, from the first instant to the last.
#[derive(Debug, Clone)]
pub(crate) struct Swimming {
    /// Title of the picture; empty if a page has it.
    pub(crate) title: String,
    /// Lengths of the links, m.
    pub(crate) links: Links<f64>,
    /// Radius of the sphere, m; 0 for none.
    pub(crate) sphere_radius: f64,
    /// Link at whose centre the sphere sits.
    pub(crate) sphere_on: Link,
    /// Number of cycles.
    pub(crate) cycles: u32,
    /// The instants, evenly spaced, both ends included; as many in each cycle.
    pub(crate) moments: Vec<Moment>,
}

/// One instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    /// Joint angles, rad.
    pub(crate) phi: [f64; 2],
    /// Pose of the middle link; lengths in m.
    pub(crate) pose: Pose<f64>,
}

/// Instants in a cycle.
const A_CYCLE: usize = 240;

/// Colours of time, from the first instant to the last: *viridis* but for its brightest fifth, light to dark, so that the
/// colour-blind can order them, too.
const TIME: [[f64; 3]; 6] = [
    [122.0, 209.0, 81.0],
    [53.0, 183.0, 121.0],
    [33.0, 145.0, 140.0],
    [49.0, 104.0, 142.0],
    [65.0, 68.0, 135.0],
    [68.0, 1.0, 84.0],
];

impl Swimming {
    /// Name of its pictures, for readers of screens.
    fn name(&self) -> &str {
        match self.title.as_str() {
            "" => "The swimmer along its path, and its gait in the plane of the joint angles",
            title => title,
        }
    }

    /// A gait as the model swims it.
    pub(crate) fn in_the_model(
        title: String,
        model: &Model<f64>,
        gait: &(impl Gait<f64> + ?Sized),
        cycles: u32,
    ) -> Self {
        let mut cycle = Vec::with_capacity(A_CYCLE + 1);
        trajectory(model, gait, &Tolerance::default(), A_CYCLE, |point| {
            cycle.push(Moment {
                phi: point.phi.into(),
                pose: point.pose,
            });
        });
        let last = cycle.pop();
        let net = last.map_or_else(Pose::identity, |moment| moment.pose);
        let mut start = Pose::identity();
        let mut moments = Vec::new();
        for _ in 0..cycles {
            moments.extend(cycle.iter().map(|moment| Moment {
                pose: start * moment.pose,
                ..*moment
            }));
            start = start * net;
        }
        moments.extend(last.map(|moment| Moment {
            pose: start,
            ..moment
        }));
        Self {
            title,
            links: model.swimmer().links,
            sphere_radius: model.swimmer().sphere_radius,
            sphere_on: model.swimmer().sphere_on,
            cycles,
            moments,
        }
    }

    /// L, m.
    fn length(&self) -> f64 {
        self.links.front + self.links.middle + self.links.back
    }

    /// Instants in a cycle.
    fn a_cycle(&self) -> usize {
        self.moments.len().saturating_sub(1) / usize::try_from(self.cycles.max(1)).unwrap_or(1)
    }
}

/// The colour of an instant, 0 for the first and 1 for the last.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // places among six, parts of a byte
fn time_color(share: f64) -> RGBColor {
    let place = share.clamp(0.0, 1.0) * (TIME.len() - 1) as f64;
    let below = (place.floor() as usize).min(TIME.len() - 2);
    let part = place - below as f64;
    let mixed = |index: usize| {
        let (low, high) = (TIME[below][index], TIME[below + 1][index]);
        (low + part * (high - low)).round() as u8
    };
    RGBColor(mixed(0), mixed(1), mixed(2))
}
