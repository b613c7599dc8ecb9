//! `motion`: poses of one cycle for the animation, with the body and the force of the fluid along it.

use operations::{Files, GaitSource};
use serde::Deserialize;
use swimmer_model::{Gait, Tolerance, trajectory};

use crate::calls::{Lab, Outcome, numbers, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct MotionRequest {
    swimmer: SwimmerText,
    gait: GaitSource,
    /// Number of equal steps of u.
    intervals: usize,
}

/// For each of the `intervals + 1` instants 26 numbers: u; φ₁, φ₂; x, y, θ of the middle link; the four points of the body from
/// the back tip to the front tip; and for the back, the middle and the front link the force per length (over μ, for a cycle of one
/// second) at both ends. In metres, as seen from the tank; the pose starts at the origin along x.
pub(super) fn motion(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: MotionRequest = parsed(bytes)?;
    let (_, model) = request.swimmer.model()?;
    let gait = request.gait.read(Files::Unavailable)?;
    let intervals = request.intervals.clamp(1, 10_000);
    let mut out = Vec::with_capacity(26 * (intervals + 1));
    trajectory(&model, &gait, &Tolerance::default(), intervals, |point| {
        let (phi, pose) = (point.phi, point.pose);
        out.extend([point.u, phi.x, phi.y, pose.x, pose.y, pose.theta]);
        for corner in model.swimmer().links.outline(&phi) {
            let place = pose.transform(&corner);
            out.extend([place.x, place.y]);
        }
        let (sin, cos) = pose.theta.sin_cos();
        // Outside a viscous fluid no force is drawn.
        let forces = model
            .link_forces(&phi, &gait.at(point.u).rate)
            .map_or_else(Default::default, |links| links.map(|link| link.density));
        for force in forces.into_iter().flatten() {
            out.extend([cos * force.x - sin * force.y, sin * force.x + cos * force.y]);
        }
    });
    numbers(out)
}
