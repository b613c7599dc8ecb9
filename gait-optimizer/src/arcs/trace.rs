//! Sampling of a chain of arcs at equal steps of power length.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::cycle::Samples;
use crate::momentum::{Flow, Momentum, Motion, State, shape};
use crate::runge_kutta::{Point, StepControl, System, advance};

const CONTROL: StepControl = StepControl::to(1e-13);
/// Least number of intervals of an arc: the interpolation needs five samples on the same side of a corner, and more on a curved arc.
const FEWEST: usize = 8;
const FEWEST_CURVED: usize = 24;
/// Change of direction \[rad\] below which there is no corner.
pub(crate) const SMOOTH: f64 = 1e-7;

/// Dynamics of an arc over the power length.
pub(crate) struct ByPower<'a>(pub(crate) Flow<'a>);

impl System<6> for ByPower<'_> {
    fn rate(&self, z: &State) -> State {
        let rate = self.0.rate(z);
        rate.map(|part| part / rate[5])
    }
}

/// Samples consecutive arcs with these power lengths in about `intervals` intervals, and returns the directions at their ends. The
/// `cuts`, shares of the whole, are sample points. If the chain is `closed`, there may be a corner at the first sample. Returns
/// `None` if an integration fails.
pub(crate) fn sampled(
    (model, momentum): (&Model<f64>, Momentum),
    start: State,
    route: &[(Motion, f64)],
    (cuts, intervals): (&[f64], usize),
    closed: bool,
) -> Option<(Samples, [Vector2<f64>; 2])> {
    let total: f64 = route.iter().map(|(_, length)| length).sum();
    let mut samples = Samples {
        phi: vec![shape(&start)],
        along: vec![start[5]],
        ..Samples::default()
    };
    let mut directions: Vec<[Vector2<f64>; 2]> = Vec::with_capacity(route.len());
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
        let (sets_out, first) = (system.0.direction(&here), samples.phi.len() - 1);
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
                samples.phi.push(shape(&point.z));
                samples.along.push(point.z[5]);
            }
            here = point.z;
        }
        let before = directions.last();
        if before.is_some_and(|[_, before]| (sets_out - before).norm() > SMOOTH) {
            samples.corners.push(first);
        }
        directions.push([sets_out, system.0.direction(&here)]);
        let last = samples.phi.len() - 1;
        samples.arcs.push((motion.kind(), first, last));
        done += length;
    }
    let [sets_out, ends] = [directions.first()?[0], directions.last()?[1]];
    if closed && (sets_out - ends).norm() > SMOOTH {
        samples.corners.insert(0, 0);
    }
    Some((samples, [sets_out, ends]))
}
