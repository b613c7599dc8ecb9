//! What an extremal's certificate rests on: its arcs followed again in the plain form of the maximum principle.
//!
//! Position, heading and the costates λ₁, λ₂ of the paper (section V) are carried along with λ₅ = −½; the curvature of the
//! connection and second derivatives, from which the reduced flow is made, do not appear. Every piece starts anew from the
//! shape and direction of the chain, while the pose runs on, so that the momenta are checked over the whole chain.

use nalgebra::{Vector2, Vector3};
use swimmer_model::Model;

use super::equations::{Motion, STATE, State, momentum, shape};
use super::shooting::Chain;
use super::structure::multiplier;
use super::wall::{Wall, Walls};
use crate::momentum::Momentum;
use crate::runge_kutta::{Point, StepControl, System, advance};

/// The largest deviations along a chain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Evidence {
    /// Gap \[rad\] between the end of a piece and the start of the next, in shape and direction.
    pub(crate) off_extremal: f64,
    /// The least and the most of 2H, which is the power: 1 where a piece begins.
    pub(crate) power: [f64; 2],
    /// Body momentum against what the pose makes of p, over |p|.
    pub(crate) momentum: f64,
    /// The least push of a bound; none without arcs along bounds.
    pub(crate) multiplier: Option<f64>,
    /// How far beyond a bound any sample is.
    pub(crate) overstepped: f64,
    /// Net displacement of the chain, in the frame of its start.
    pub(crate) displacement: Vector2<f64>,
}

/// φ₁, φ₂, x, y, θ, λ₁, λ₂.
type Plain = [f64; 7];

/// Looks at each piece this often.
const LOOKS: usize = 6;
const CONTROL: StepControl = StepControl {
    tolerance: 1e-13,
    longest: f64::INFINITY,
};

/// The paper's equations with p = (λ₃, `λ_y`) and c for constants.
struct Equations<'a> {
    model: &'a Model<f64>,
    wall: Option<(&'a Wall, f64)>,
    momentum: Momentum,
}

impl Equations<'_> {
    fn body_momentum(&self, s: &Plain) -> Vector3<f64> {
        self.momentum.at(&[s[2], s[3], s[4]])
    }

    /// The control: from `H_u = 0`, or along the bound at constant power.
    fn control(&self, s: &Plain) -> Vector2<f64> {
        let phi = Vector2::new(s[0], s[1]);
        let (a, w) = self.model.connection_and_power(&phi);
        match self.wall {
            None => {
                let force = Vector2::new(s[5], s[6]) + a.transpose() * self.body_momentum(s);
                let det = w.m11 * w.m22 - w.m12 * w.m12;
                Vector2::new(
                    w.m22 * force.x - w.m12 * force.y,
                    w.m11 * force.y - w.m12 * force.x,
                ) / det
            }
            Some((wall, near)) => {
                let (sin, cos) = wall.tangent(&phi, near).sin_cos();
                let e = Vector2::new(cos, sin);
                e / e.dot(&(w * e)).sqrt()
            }
        }
    }
}

impl System<7> for Equations<'_> {
    fn rate(&self, s: &Plain) -> Plain {
        let u = self.control(s);
        let d = self.model.first_derivatives(&Vector2::new(s[0], s[1]));
        let mu = self.body_momentum(s);
        let body = d.connection * u;
        let (sin, cos) = s[4].sin_cos();
        let force = |joint: usize| {
            0.5 * u.dot(&(d.d_power[joint] * u)) - mu.dot(&(d.d_connection[joint] * u))
        };
        [
            u.x,
            u.y,
            cos * body.x - sin * body.y,
            sin * body.x + cos * body.y,
            body.z,
            force(0),
            force(1),
        ]
    }
}

/// Follows a chain again; none where that fails.
pub(crate) fn follow(model: &Model<f64>, walls: &Walls, chain: &Chain) -> Option<Evidence> {
    let first = momentum(chain.states.first()?);
    let constants = Momentum {
        p: first.xy(),
        c: first.z,
    };
    let mut evidence = Evidence {
        off_extremal: 0.0,
        power: [1.0; 2],
        momentum: 0.0,
        multiplier: None,
        overstepped: f64::NEG_INFINITY,
        displacement: Vector2::zeros(),
    };
    let mut pose = [0.0; 3];
    let nexts = chain.pieces().skip(1).map(|(arc, stretch, state)| {
        let kinks = matches!(stretch.entry, super::shooting::Entry::Corner(_));
        Some((arc, kinks, *state))
    });
    for ((index, arc, state), next) in chain.pieces().zip(nexts.chain([None])) {
        let equations = Equations {
            model,
            wall: match &arc.motion {
                Motion::Free => None,
                Motion::Along(wall) => Some((wall, state[2])),
            },
            momentum: constants,
        };
        let mut here = start(&equations, state, &pose);
        let share = arc.length / arc.pieces as f64;
        for _ in 0..LOOKS {
            let point = Point::new(&equations, here);
            here = advance(&equations, point, share / LOOKS as f64, CONTROL)?.z;
            evidence.evaluate(&equations, walls, &here);
        }
        pose = [here[2], here[3], here[4]];
        if let Some((next_index, kinks, next)) = next {
            let u = equations.control(&here);
            let turned = (u.y.atan2(u.x) - next[2]).sin().abs();
            let kinked = kinks && next_index != index;
            let gap = (Vector2::new(here[0], here[1]) - shape(&next)).amax();
            evidence.off_extremal =
                evidence
                    .off_extremal
                    .max(gap)
                    .max(if kinked { 0.0 } else { turned });
            let off = equations.body_momentum(&here) - momentum(&next);
            evidence.momentum = evidence.momentum.max(off.amax() / constants.p.norm());
        }
    }
    evidence.displacement = Vector2::new(pose[0], pose[1]);
    Some(evidence)
}

/// The plain state of a chain's state at a pose: the costates follow from `H_u = 0`.
fn start(equations: &Equations<'_>, state: &State, pose: &[f64; 3]) -> Plain {
    let phi = shape(state);
    let mut plain = [phi.x, phi.y, pose[0], pose[1], pose[2], 0.0, 0.0];
    let (a, w) = equations.model.connection_and_power(&phi);
    let (sin, cos) = state[2].sin_cos();
    let e = Vector2::new(cos, sin);
    let u = e / e.dot(&(w * e)).sqrt();
    let costate = w * u - a.transpose() * equations.body_momentum(&plain);
    plain[5] = costate.x;
    plain[6] = costate.y;
    plain
}

impl Evidence {
    fn evaluate(&mut self, equations: &Equations<'_>, walls: &Walls, s: &Plain) {
        let phi = Vector2::new(s[0], s[1]);
        let u = equations.control(s);
        let power = u.dot(&(equations.model.power_matrix(&phi) * u));
        // A power that is no number makes the range infinite.
        let [least, most] = [f64::NEG_INFINITY, f64::INFINITY]
            .map(|wide| if power.is_nan() { wide } else { power });
        self.power = [self.power[0].min(least), self.power[1].max(most)];
        if let Some((_, depth)) = walls.nearest(&phi) {
            self.overstepped = self.overstepped.max(depth);
        }
        if let Some((wall, _)) = equations.wall {
            let mu = equations.body_momentum(s);
            let state: [f64; STATE] = [phi.x, phi.y, u.y.atan2(u.x), mu.x, mu.y, mu.z];
            let push = multiplier(equations.model, wall, &state);
            self.multiplier = Some(self.multiplier.map_or(push, |least| least.min(push)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extremal::flow::flowed;
    use crate::extremal::shooting::{Entry, Stretch};
    use swimmer_model::Swimmer;

    /// An extremal of the reduced flow is one of the paper's costate equations: canonical momenta, pose carried along, no
    /// curvature, no magnetic field.
    #[test]
    fn the_flow_is_the_papers_costate_system() {
        for (swimmer, z) in [
            (Swimmer::purcell(), [0.7, -1.3, 2.1, 3.0, -1.2, 0.4]),
            (Swimmer::robot(), [-2.4, 1.1, -0.6, -12.0, 5.0, 1.7]),
        ] {
            let model = Model::new(&swimmer).unwrap();
            let flow = |length| flowed(&model, &Motion::Free, &z, length).unwrap();
            let chain = Chain {
                arcs: vec![Stretch {
                    motion: Motion::Free,
                    entry: Entry::Smooth,
                    pieces: 2,
                    length: 0.6,
                }],
                states: vec![z, flow(0.3).0],
            };
            let evidence = follow(&model, &Walls::default(), &chain).unwrap();
            assert!(evidence.off_extremal < 1e-10 && evidence.momentum < 1e-10);
            let gain = momentum(&z).xy().dot(&evidence.displacement);
            assert!((gain - flow(0.6).1).abs() < 1e-10, "{evidence:?}");
        }
    }
}
