//! Multi-start pipeline from random starts to certified optima: coarse curves, classes, polish, classes again.

use nalgebra::{DMatrix, Vector2};
use swimmer_files::AnyGait;
use swimmer_model::{Model, Stroke, Tolerance, swim};

use super::barrier::Barrier;
use super::distinct::{Outline, Symmetries, classes};
use super::newton::{Newton, Settings, Stationary};
use super::objective::Aim;
use super::starts::{fitted, off_centre, start};
use super::{Atlas, AtlasProblem, Optimum, StartCurves};
use crate::certificate::{crossings, double_area, turning_number};
use crate::closed_curve::{Basis, Functional};
use crate::optimal_gait::OptimalGait;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

/// Distance \[rad\] and relative difference of the values below which coarse curves are equal.
const SAME_COARSE: (f64, f64) = (1e-3, 0.05);
/// Distance \[rad\] and relative difference of the values below which polished gaits are equal.
const SAME: (f64, f64) = (1e-7, 0.02);
/// Distance from the horizon below which a curve counts as diverged \[rad\].
const LEAVING: f64 = 0.3;

/// Number of sides of the polygon that represents a coarse curve.
const SIDES: usize = 240;

/// Approximate share of the starts in the work; the rest is polish.
const STARTS: f64 = 0.5;

/// Search for one objective.
pub(super) trait MultiStart: Sync {
    /// Sequence of κ of the coarse objective.
    const ENERGY_WEIGHTS: &'static [f64];
    /// Settings of the coarse solution.
    const SETTINGS: Settings;
    /// `true` if only simple curves count; the coarse curve is the last simple one.
    const SIMPLE: bool;

    /// Value of a gait, to be maximised.
    fn value(gait: &OptimalGait) -> f64;

    /// Value of a stroke of a swimmer with unit length.
    fn value_of(stroke: &Stroke<f64>) -> f64;

    /// Known gaits that are additional starts, with complete certificates.
    fn known(&self, problem: &AtlasProblem) -> Vec<OptimalGait>;

    /// Polishes and certifies a coarse curve, run counter-clockwise.
    fn polished(
        &self,
        functional: &Functional<'_>,
        barrier: &Barrier,
        coarse: &Stationary,
    ) -> Option<OptimalGait>;
}

/// Result of a start.
enum Ended {
    Nowhere,
    Left,
    At(Box<Settled>),
}

struct Settled {
    stationary: Stationary,
    points: Vec<Vector2<f64>>,
}

pub(super) fn run<S: MultiStart>(
    problem: &AtlasProblem,
    model: &Model<f64>,
    objective: &S,
    watch: Watch<'_>,
) -> Atlas {
    let basis = Basis::fourier(problem.order, 8 + 2 * problem.order);
    let functional = Functional::new(model, &basis);
    let links = &model.swimmer().links;
    let clearance = problem.bounds.clearance / problem.swimmer.total_length();
    let barrier = Barrier::new(&problem.bounds, *links, clearance, Region::HORIZON);
    let symmetries = Symmetries {
        swap: model.swimmer().is_symmetric(),
        turns: problem.bounds.max_angle.is_none() && !problem.bounds.no_overlap,
    };
    let known = match problem.from {
        StartCurves::Random => objective.known(problem),
        StartCurves::OffCentre => Vec::new(),
    };
    // A known gait that is certified for the same bounds is listed in any case.
    let kept = |known: &OptimalGait| known.bounds == problem.bounds && known.certificate.pass();
    let is_kept = |index: usize| {
        let known = known.get(index.wrapping_sub(problem.starts));
        known.is_some_and(kept)
    };
    let count = problem.starts + known.len();
    let ended = in_parallel(
        count,
        problem.threads,
        &|share| watch(STARTS * share),
        || Newton::new(functional, barrier),
        |newton, index| {
            let curve = match known.get(index.wrapping_sub(problem.starts)) {
                Some(known) => fitted(known, &basis, &barrier),
                None => match problem.from {
                    StartCurves::Random => start(&basis, &barrier, problem.seed, index),
                    StartCurves::OffCentre => off_centre(&basis, &barrier, index),
                },
            };
            coarse::<S>(newton, &basis, curve, symmetries.turns)
        },
    );
    let mut atlas = Atlas::default();
    let mut settled = Vec::new();
    for (index, one) in ended.into_iter().enumerate() {
        let counts = usize::from(!is_kept(index));
        match one {
            Ended::Nowhere => atlas.unsettled += counts,
            Ended::Left => atlas.left += counts,
            Ended::At(one) => settled.push((one, counts)),
        }
    }
    let outlines: Vec<(f64, Outline)> = settled
        .iter()
        .map(|(one, _)| {
            let distance = one.stationary.values.displacement.norm();
            (distance, Outline::new(&one.points))
        })
        .collect();
    let coarse_classes = classes(&outlines, symmetries, SAME_COARSE.0, SAME_COARSE.1);
    let polished = in_parallel(
        coarse_classes.len(),
        problem.threads,
        &|share| watch(STARTS + (1.0 - STARTS) * share),
        || (),
        |(), class| {
            let first = coarse_classes.get(class)?.first()?;
            objective.polished(&functional, &barrier, &settled.get(*first)?.0.stationary)
        },
    );
    let mut gaits: Vec<(OptimalGait, usize)> = Vec::new();
    for (class, gait) in coarse_classes.iter().zip(polished) {
        let starts = class.iter().filter_map(|&index| settled.get(index));
        let starts = starts.map(|(_, counts)| counts).sum();
        if let Some(gait) = gait {
            gaits.push((gait, starts));
            continue;
        }
        atlas.uncertified += starts;
        let first = class.first().and_then(|&index| settled.get(index));
        let value = first.and_then(|(one, _)| value_of::<S>(model, &one.points));
        let values = [atlas.best_uncertified, value];
        atlas.best_uncertified = values.into_iter().flatten().reduce(f64::max);
    }
    // A known gait that is a saddle among all curves is not listed; its displacement is reported.
    let saddles = known
        .iter()
        .filter(|known| known.bounds == problem.bounds && !kept(known));
    let values = saddles.map(S::value).chain(atlas.best_uncertified);
    atlas.best_uncertified = values.reduce(f64::max);
    gaits.extend(known.into_iter().filter(kept).map(|known| (known, 1)));
    atlas.optima = distinct::<S>(&gaits, symmetries);
    let found: usize = atlas.optima.iter().map(|optimum| optimum.found).sum();
    atlas.starts = found + atlas.unsettled + atlas.left + atlas.uncertified;
    atlas
}

/// Returns `true` if a closed polygon turns once and does not cross itself.
fn is_simple(points: &[Vector2<f64>]) -> bool {
    (turning_number(points).abs() - 1.0).abs() < 1e-6 && crossings(points) == 0
}

/// Value of a coarse curve. Returns `None` if it cannot be integrated.
fn value_of<S: MultiStart>(model: &Model<f64>, points: &[Vector2<f64>]) -> Option<f64> {
    let sides = points.len().saturating_sub(1) as f64;
    let u: Vec<f64> = (0..points.len()).map(|k| k as f64 / sides).collect();
    let curve = AnyGait::from_samples(&u, points, &[]).ok()?;
    Some(S::value_of(&swim(model, &curve, &Tolerance::default())))
}

/// Merges equal gaits and sorts them, best first.
fn distinct<S: MultiStart>(gaits: &[(OptimalGait, usize)], symmetries: Symmetries) -> Vec<Optimum> {
    let outlines: Vec<(f64, Outline)> = gaits
        .iter()
        .map(|(gait, _)| (S::value(gait), Outline::new(gait.phi())))
        .collect();
    let mut optima = Vec::new();
    for class in classes(&outlines, symmetries, SAME.0, SAME.1) {
        let found = class.iter().filter_map(|&index| gaits.get(index));
        // A known gait whose start leads to another gait found both.
        let found = found.map(|(_, found)| *found).sum::<usize>().max(1);
        if let Some((gait, _)) = class.first().and_then(|&index| gaits.get(index)) {
            optima.push(Optimum {
                distance_over_length: distance(gait),
                simple: is_simple(gait.phi()),
                gait: gait.clone(),
                found,
            });
        }
    }
    optima.sort_by(|a, b| S::value(&b.gait).total_cmp(&S::value(&a.gait)));
    optima
}

/// |d| over L.
pub(super) fn distance(gait: &OptimalGait) -> f64 {
    let (x, y) = (gait.displacement_over_length, gait.lateral_over_length);
    x.hypot(y)
}

/// Solves one start to a coarse optimum.
fn coarse<S: MultiStart>(
    newton: &mut Newton<'_>,
    basis: &Basis,
    start: DMatrix<f64>,
    may_leave: bool,
) -> Ended {
    let mut curve = start;
    let mut last = None;
    for &energy_weight in S::ENERGY_WEIGHTS {
        let aim = Aim { energy_weight };
        let Some(stationary) = newton.solve(aim, &curve, &S::SETTINGS) else {
            break;
        };
        let points: Vec<_> = (0..=SIDES)
            .map(|k| basis.shape(&stationary.coefficients, (k % SIDES) as f64 / SIDES as f64))
            .collect();
        let far = points.iter().map(Vector2::amax).fold(0.0, f64::max);
        if may_leave && far > Region::HORIZON - LEAVING {
            return Ended::Left;
        }
        if S::SIMPLE && !is_simple(&points) {
            break;
        }
        curve.clone_from(&stationary.coefficients);
        last = Some((stationary, points));
    }
    let Some((mut stationary, mut points)) = last else {
        return Ended::Nowhere;
    };
    if double_area(&points) < 0.0 {
        basis.reverse(&mut stationary.coefficients);
        points.reverse();
    }
    Ended::At(Box::new(Settled { stationary, points }))
}
