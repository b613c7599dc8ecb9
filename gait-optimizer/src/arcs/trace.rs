//! A chain of arcs followed once more, state by state at equal steps of power length, for its samples and what is read off them.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::cycle::Samples;
use crate::momentum::{Flow, Momentum, Motion, State, shape};
use crate::runge_kutta::{Point, StepControl, System, advance};

/// The arcs, each with its states from its beginning to its end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trace {
    pub(crate) arcs: Vec<(Motion, Vec<State>)>,
    /// The direction in which each arc sets out and the one that it ends in.
    directions: Vec<[Vector2<f64>; 2]>,
}

const CONTROL: StepControl = StepControl {
    tolerance: 1e-13,
    longest: f64::INFINITY,
};
/// Fewest intervals of an arc: the interpolation takes five samples on the same side of a corner, and needs more where the arc is
/// curved.
const FEWEST: usize = 8;
const FEWEST_CURVED: usize = 24;
/// Directions this close in angle \[rad\] make no corner.
pub(crate) const SMOOTH: f64 = 1e-7;

/// The dynamics of an arc over the power length.
pub(crate) struct ByPower<'a>(pub(crate) Flow<'a>);

impl System<6> for ByPower<'_> {
    fn rate(&self, z: &State) -> State {
        let rate = self.0.rate(z);
        rate.map(|part| part / rate[5])
    }
}

impl Trace {
    /// Follows arcs of these power lengths, one after the other, with about so many intervals in all. States fall on the `cuts`,
    /// shares of the whole. None where an integration fails.
    pub(crate) fn new(
        (model, momentum): (&Model<f64>, Momentum),
        start: State,
        route: &[(Motion, f64)],
        cuts: &[f64],
        intervals: usize,
    ) -> Option<Self> {
        let total: f64 = route.iter().map(|(_, length)| length).sum();
        let mut trace = Self {
            arcs: Vec::with_capacity(route.len()),
            directions: Vec::with_capacity(route.len()),
        };
        let (mut here, mut done) = (start, 0.0);
        for &(motion, length) in route {
            let system = ByPower(Flow {
                model,
                momentum,
                motion,
            });
            let fewest = match motion {
                Motion::Along(track) if track.wall.edge().is_some() => FEWEST,
                _ => FEWEST_CURVED,
            };
            let mut states = vec![here];
            let (from, to) = (done / total, (done + length) / total);
            let inner = cuts
                .iter()
                .filter(|&&cut| cut > from + 1e-6 && cut < to - 1e-6);
            let ends: Vec<f64> = inner.copied().chain([to]).collect();
            let starts = [from].into_iter().chain(ends.iter().copied());
            for (from, to) in starts.zip(&ends) {
                let count = (fewest..intervals)
                    .find(|&count| count as f64 >= intervals as f64 * (to - from))
                    .unwrap_or(intervals.max(fewest));
                let step = (to - from) * total / count as f64;
                let mut point = Point::new(&system, here);
                for _ in 0..count {
                    point = advance(&system, point, step, CONTROL)?;
                    states.push(point.z);
                }
                here = point.z;
            }
            let ends = [states.first()?, &here].map(|z| system.0.direction(z));
            trace.directions.push(ends);
            trace.arcs.push((motion, states));
            done += length;
        }
        Some(trace)
    }

    /// The direction in which it sets out and the one that it ends in.
    pub(crate) fn ends(&self) -> Option<[Vector2<f64>; 2]> {
        Some([self.directions.first()?[0], self.directions.last()?[1]])
    }

    /// The samples; of a closed curve there may be a corner at the first, where the last arc meets it.
    pub(crate) fn samples(&self, closed: bool) -> Samples {
        let mut samples = Samples::default();
        let mut before = self
            .directions
            .last()
            .map(|ends| ends[1])
            .filter(|_| closed);
        for ((motion, states), [sets_out, ends]) in self.arcs.iter().zip(&self.directions) {
            let from = samples.phi.len().saturating_sub(1);
            if before.is_some_and(|before| (sets_out - before).norm() > SMOOTH) {
                samples.corners.push(from);
            }
            before = Some(*ends);
            let new = states.iter().skip(usize::from(!samples.phi.is_empty()));
            for z in new {
                samples.phi.push(shape(z));
                samples.along.push(z[5]);
            }
            samples
                .arcs
                .push((motion.kind(), from, samples.phi.len() - 1));
        }
        samples
    }
}
