//! The swimmer itself: snapshots along its path, and one cycle in motion.

mod animation;
mod body;
mod joints;
mod snapshots;

pub(crate) use animation::{FRAMES_PER_SECOND, SIZE as ANIMATION_SIZE, animation};
pub(crate) use snapshots::snapshots;

use plotters::style::RGBColor;
use swimmer_model::{Gait, Link, Links, Model, Pose, Tolerance, trajectory};

use super::palette::Palette;

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

/// Colour of an instant, 0 for the first and 1 for the last: *viridis* but for its brightest fifth, light to dark, so that the
/// colour-blind can order them, too.
fn time_color(share: f64) -> RGBColor {
    Palette::Sequential.color(0.8 * (1.0 - share.clamp(0.0, 1.0)))
}
