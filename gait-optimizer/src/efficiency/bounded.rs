//! Bounded efficiency gaits, by homotopy (continuation) from the free gait while the bounds tighten.
//!
//! The name of a gait identifies the free gait from which its branch starts. The branch is followed step by step
//! (`extremal::continuation`). Where it ends, no gait of the name exists, even if other gaits satisfy the bounds.

use std::f64::consts::PI;
use std::fmt;

use swimmer_model::{Links, Model};

use super::chain::Origin;
use super::{Branch, EfficiencyError, EfficiencyProblem, PolishedGait, certified, finished};
use crate::certificate::{crossings, turning_number};
use crate::extremal::Extremal;
use crate::extremal::continuation::{Ended, Path, Tightness};
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use crate::region::Clearance;

/// Share of the free gait's efficiency below which a branch counts as ended.
const FADED: f64 = 1e-4;

/// Bounds at which a branch ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachedBounds {
    /// Bound on both angles \[rad\].
    pub max_angle: f64,
    /// φ₁ = φ₂ \[rad\] at which the tips of the shortened and of the full side links meet, while the side links count as shortened.
    pub tips_meet: Option<[f64; 2]>,
}

impl fmt::Display for ReachedBounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "|phi| <= {:.6} rad", self.max_angle)?;
        match self.tips_meet {
            Some([at, last]) => write!(
                f,
                ", and crossing links forbidden only where their tips are shortened to meet at phi1 = phi2 = {at:.6} rad \
                 instead of {last:.6} rad"
            ),
            None => Ok(()),
        }
    }
}

/// Follows a free gait that violates the bounds until it satisfies them.
pub(super) fn bounded(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    free: &PolishedGait,
    watch: Watch<'_>,
) -> Result<OptimalGait, EfficiencyError> {
    let (branch, bounds) = (problem.branch, &problem.bounds);
    let start = &free.extremal;
    let floor = start.efficiency(model) * FADED;
    let farthest = free.gait.phi().iter().map(nalgebra::Vector2::amax);
    let farthest = farthest.fold(0.0, f64::max) + 1e-6;
    let keeps = |extremal: &Extremal| keeps_its_name(branch, model, extremal, (floor, farthest));
    let path = Path {
        model,
        clearance: bounds.clearance / problem.swimmer.total_length(),
        keeps: &keeps,
        watch,
    };
    let links = model.swimmer().links;
    let max_angle = bounds.max_angle.unwrap_or(f64::INFINITY);
    let fold = bounds
        .no_overlap
        .then(|| Clearance::fold(links.front, links.middle, path.clearance));
    let folded = farthest.min(fold.unwrap_or(f64::INFINITY));
    let tight = folded.min(max_angle);
    let at = |max_angle: f64, share: f64| Tightness { max_angle, share };
    let links_kept = f64::from(u8::from(bounds.no_overlap));
    let followed = |way: &[Tightness]| {
        let (mut extremal, mut reached) = (start.clone(), at(farthest, 0.0));
        for &stage in way {
            if stage != reached {
                extremal = path.follow(extremal, reached, stage)?;
                reached = stage;
            }
        }
        Ok(extremal)
    };
    // The largest angle is tightened first; if that fails, last.
    let angle_last = || {
        let way = [at(folded, 0.0), at(folded, 1.0), at(tight, 1.0)];
        (bounds.no_overlap && tight < folded)
            .then(|| followed(&way).ok())
            .flatten()
    };
    let extremal = followed(&[at(tight, 0.0), at(tight, links_kept)])
        .or_else(|ended| angle_last().ok_or(ended))
        .map_err(|ended| branch_ends(branch, &links, &ended))?;
    let of = (problem, model, bounds);
    let found =
        finished(of, extremal, Origin::arcs()).map_err(|error| EfficiencyError::NotFollowed {
            branch,
            reason: error.to_string(),
        })?;
    certified(branch, found.gait)
}

/// Checks the properties that a gait must keep along the branch. The error names the lost property. The least efficiency is that of a gait
/// with angles up to `farthest`; in small bounds the efficiency grows as the square of the angles.
fn keeps_its_name(
    branch: Branch,
    model: &Model<f64>,
    extremal: &Extremal,
    (floor, farthest): (f64, f64),
) -> Result<(), &'static str> {
    if extremal.heading() * branch.sign() <= 0.0 {
        return Err(match branch {
            Branch::Small => "X > 0",
            Branch::Large => "X < 0",
        });
    }
    if extremal.start().x <= branch.least_start() {
        return Err("a start angle of its branch (above 0 for small, above 2 rad for large)");
    }
    let cycle = extremal
        .cycle(model, 256)
        .ok_or("arcs that can be followed")?;
    let reach = cycle.phi.iter().map(nalgebra::Vector2::amax);
    let share = reach.fold(0.0, f64::max) / farthest;
    if extremal.efficiency(model) < floor * share.powi(2).min(1.0) {
        return Err("any displacement worth the name (the efficiency fades to nothing)");
    }
    if crossings(&cycle.phi) > 0 || (turning_number(&cycle.phi) - 1.0).abs() > 1e-6 {
        return Err("a simple curve");
    }
    Ok(())
}

fn branch_ends(branch: Branch, links: &Links<f64>, ended: &Ended) -> EfficiencyError {
    let (at, reason) = match ended {
        Ended::Fold { at, other } => (
            at,
            format!(
                "there it folds: it meets another extremal (which starts at {:.4} rad shortly before), and beyond there is \
                 neither",
                other.start().x
            ),
        ),
        Ended::NoneBeyond { at, reason } => (at, format!("beyond, {reason}")),
        Ended::OtherBranch { at } => (at, "beyond, only other branches are found".to_owned()),
        Ended::Property { at, property } => (at, format!("there it loses {property}")),
    };
    let tips = |share: f64| (-links.middle / (2.0 * share * links.front)).acos();
    EfficiencyError::BranchEnds {
        branch,
        reached: ReachedBounds {
            max_angle: at.max_angle,
            tips_meet: (at.share > 0.0).then(|| [tips(at.share), tips(1.0)].map(or_folded)),
        },
        reason,
    }
}

/// Angle at which the tips meet, or π if the links are too short to meet.
fn or_folded(angle: f64) -> f64 {
    if angle.is_finite() { angle } else { PI }
}
