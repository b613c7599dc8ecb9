//! A quarter gait traced once more, sampled at equal power and with the costates λ₁, λ₂ integrated along: the evidence.

mod second_variation;

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use super::{Cycle, SMOOTH, Samples};
use crate::displacement::flow::Leg;
use crate::displacement::height::Extremal;
use crate::momentum::{Motion, pose_rates, shape};
use crate::region::Region;
use crate::runge_kutta::{Point, StepControl, System, advance};
use second_variation::{Push, SecondVariation};

/// Traced state: φ₁, φ₂, x, y, θ, λ₁, λ₂ over the power length.
type Traced = [f64; 7];

/// Numbers gathered along the trace, for the certificate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evidence {
    /// Largest `|H_u|`, over L.
    pub(crate) h_u: f64,
    /// Largest distance of a singular arc from the zero of the height \[rad\].
    pub(crate) off_zero: f64,
    /// Smallest multiplier on a bound, over the largest |height| there; none without such arcs.
    pub(crate) multiplier: Option<f64>,
    /// Smallest slope of the height across a singular arc; none without such arcs.
    pub(crate) legendre_clebsch: Option<f64>,
    /// Largest gradient of the height along the quarter: the scale of that slope.
    pub(crate) steepest: f64,
    /// The second variation; none without singular arcs.
    pub(crate) second_variation: Option<SecondVariation>,
    /// Largest overstepping of a bound \[rad\].
    pub(crate) overstepped: f64,
    /// |λ₁ + λ₂| at the start.
    pub(crate) start_transversality: f64,
    /// |λ₁ − λ₂| at the end.
    pub(crate) end_transversality: f64,
    /// |λ₄| at the end.
    pub(crate) final_lambda4: f64,
    /// |φ₁ − φ₂| at the start and |φ₁ + φ₂| at the end, the larger.
    pub(crate) off_symmetry_lines: f64,
    /// Largest jump between the arcs of the search and of the trace \[rad\].
    pub(crate) retraced: f64,
}

/// A quarter gait, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct QuarterTrace {
    pub(crate) samples: Samples,
    pub(crate) first_direction: Vector2<f64>,
    pub(crate) last_direction: Vector2<f64>,
    pub(crate) evidence: Evidence,
}

const CONTROL: StepControl = StepControl {
    tolerance: 1e-13,
    longest: f64::INFINITY,
};
/// Fewest intervals of an arc: the interpolation takes five samples on the same side of a corner, and needs more where the
/// arc is curved.
const FEWEST: usize = 6;
const FEWEST_CURVED: usize = 24;

/// The dynamics of state and costates with the power length as independent variable.
struct Equations<'a> {
    extremal: Extremal<'a>,
    motion: Motion,
}

impl System<7> for Equations<'_> {
    fn rate(&self, z: &Traced) -> Traced {
        let (phi, pose) = (shape(z), [z[2], z[3], z[4]]);
        let (slopes, direction) = match self.motion {
            Motion::Singular => {
                let (height, slopes) = self.extremal.height_and_slopes(&phi, &pose);
                (slopes, height.singular_direction())
            }
            Motion::Along(track) => (self.extremal.slopes(&phi, &pose), track.direction(&phi)),
        };
        let [x, y, theta, speed] = pose_rates(&slopes.connection, &slopes.power, z[4], &direction);
        // λ̇ᵢ = −∂H/∂φᵢ on a free arc; along a bound the multiplier pushes along its normal and keeps H_u at zero.
        let mut costate = -(slopes.by_angle.transpose() * direction);
        if let Motion::Along(track) = self.motion {
            costate -= track.inwards(&phi) * (slopes.height * track.way);
        }
        [direction.x, direction.y, x, y, theta, costate.x, costate.y].map(|rate| rate / speed)
    }
}

impl Equations<'_> {
    fn direction(&self, phi: &Vector2<f64>, pose: &[f64; 3]) -> Vector2<f64> {
        match self.motion {
            Motion::Singular => self
                .extremal
                .height_and_gradient(phi, pose)
                .0
                .singular_direction(),
            Motion::Along(track) => track.direction(phi),
        }
    }
}

impl QuarterTrace {
    /// Traces the arcs of a quarter. None where an integration fails, or there are no arcs.
    pub(crate) fn new(
        extremal: Extremal<'_>,
        region: &Region,
        legs: &[Leg],
        samples: usize,
    ) -> Option<Self> {
        let (first, last) = (legs.first()?, legs.last()?);
        let total = last.to[5] - first.from[5];
        let mut here = start(&extremal, first);
        let mut trace = Self {
            samples: Samples {
                phi: vec![shape(&here)],
                along: vec![0.0],
                ..Samples::default()
            },
            first_direction: Vector2::zeros(),
            last_direction: Vector2::zeros(),
            evidence: Evidence::start(&here),
        };
        for leg in legs {
            let equations = Equations {
                extremal,
                motion: leg.motion,
            };
            let leg_length = leg.to[5] - leg.from[5];
            let fewest = match leg.motion {
                Motion::Along(track) if track.piece.is_none() => FEWEST,
                _ => FEWEST_CURVED,
            };
            let intervals = (fewest..samples)
                .find(|&count| count as f64 * total >= samples as f64 * leg_length)
                .unwrap_or(samples.max(fewest));
            let direction = equations.direction(&shape(&here), &[here[2], here[3], here[4]]);
            trace.begin_arc(direction);
            let from = trace.samples.phi.len() - 1;
            let step = leg.length / intervals as f64;
            let mut before = None;
            let mut point = Point::new(&equations, here);
            for interval in 0..intervals {
                let push = trace
                    .evidence
                    .evaluate(&equations, region, &here, last.to[2]);
                trace.evidence.vary(before, push, step);
                before = push;
                point = advance(&equations, point, leg_length / intervals as f64, CONTROL)?;
                here = point.z;
                let along = leg.from[5] - first.from[5]
                    + leg_length * (interval + 1) as f64 / intervals as f64;
                trace.samples.phi.push(shape(&here));
                trace.samples.along.push(along);
            }
            let push = trace
                .evidence
                .evaluate(&equations, region, &here, last.to[2]);
            trace.evidence.vary(before, push, step);
            let gap = (shape(&here) - shape(&leg.to)).norm();
            trace.evidence.retraced = trace.evidence.retraced.max(gap);
            let to = trace.samples.phi.len() - 1;
            trace.samples.arcs.push((kind(leg.motion), from, to));
            trace.last_direction = equations.direction(&shape(&here), &[here[2], here[3], here[4]]);
        }
        trace.evidence.end(&extremal, &here);
        Some(trace)
    }

    /// A new arc sets out in this direction: is there a corner?
    fn begin_arc(&mut self, direction: Vector2<f64>) {
        if self.samples.arcs.is_empty() {
            self.first_direction = direction;
        } else if (direction - self.last_direction).norm() > SMOOTH {
            self.samples.corners.push(self.samples.phi.len() - 1);
        }
    }

    pub(crate) fn start(&self) -> Vector2<f64> {
        self.samples.phi.first().copied().unwrap_or_default()
    }

    pub(crate) fn end(&self) -> Vector2<f64> {
        self.samples.phi.last().copied().unwrap_or_default()
    }

    /// The full cycle.
    pub(crate) fn cycle(&self) -> Cycle {
        let (first, last) = (self.first_direction, self.last_direction);
        // Square to φ₁ = φ₂ (φ₁ = −φ₂) is a direction without a part along it.
        let square = [first.x + first.y, last.x - last.y].map(|along| along.abs() < SMOOTH);
        self.samples.unfolded(square)
    }
}

/// The first state, with the costates that `H_u = 0` asks for.
fn start(extremal: &Extremal<'_>, leg: &Leg) -> Traced {
    let z = leg.from;
    let momentum = extremal.slopes(&shape(&z), &[z[2], z[3], z[4]]).momentum;
    [z[0], z[1], z[2], z[3], z[4], -momentum.x, -momentum.y]
}

fn kind(motion: Motion) -> ArcKind {
    match motion {
        Motion::Singular => ArcKind::Singular,
        Motion::Along(track) => track.bound.kind(),
    }
}

impl Evidence {
    fn start(z: &Traced) -> Self {
        Self {
            h_u: 0.0,
            off_zero: 0.0,
            multiplier: None,
            legendre_clebsch: None,
            steepest: 0.0,
            second_variation: None,
            overstepped: f64::NEG_INFINITY,
            start_transversality: (z[5] + z[6]).abs(),
            end_transversality: f64::NAN,
            final_lambda4: f64::NAN,
            off_symmetry_lines: (z[0] - z[1]).abs(),
            retraced: 0.0,
        }
    }

    /// Takes in one sample of an arc; what a push there does to the displacement, where pushes are free.
    fn evaluate(
        &mut self,
        equations: &Equations<'_>,
        region: &Region,
        z: &Traced,
        final_x: f64,
    ) -> Option<Push> {
        let (phi, pose) = (shape(z), [z[2], z[3], z[4]]);
        let extremal = &equations.extremal;
        let (height, slopes) = extremal.height_and_slopes(&phi, &pose);
        let h_u = slopes.momentum + Vector2::new(z[5], z[6]);
        self.h_u = self.h_u.max(h_u.norm());
        self.overstepped = self.overstepped.max(region.overstepped(&phi));
        let slope = height.gradient.norm();
        self.steepest = self.steepest.max(slope);
        if let Motion::Along(track) = equations.motion {
            let multiplier = track.way * height.value;
            self.multiplier = Some(
                self.multiplier
                    .map_or(multiplier, |least| least.min(multiplier)),
            );
            None
        } else {
            self.off_zero = self.off_zero.max(height.value.abs() / slope);
            // Slope towards the left of the motion.
            let direction = height.singular_direction();
            let left = height
                .gradient
                .dot(&Vector2::new(-direction.y, direction.x));
            self.legendre_clebsch =
                Some(self.legendre_clebsch.map_or(left, |least| least.min(left)));
            Some(Push::new(
                extremal.sign,
                &slopes.curvature,
                pose[2],
                final_x - pose[0],
                left,
            ))
        }
    }

    /// Takes in the stretch between two samples of a singular arc.
    fn vary(&mut self, before: Option<Push>, after: Option<Push>, step: f64) {
        if let (Some(before), Some(after)) = (before, after) {
            self.second_variation
                .get_or_insert_default()
                .step(&before, &after, step);
        }
    }

    fn end(&mut self, extremal: &Extremal<'_>, z: &Traced) {
        self.end_transversality = (z[5] - z[6]).abs();
        self.final_lambda4 = (z[3] - extremal.final_y).abs();
        self.off_symmetry_lines = self.off_symmetry_lines.max((z[0] + z[1]).abs());
    }
}
