//! Ensemble of the possible swimmers: values of a gait over it, and the gait that is best for its mean.

use swimmer_files::Bounds;
use swimmer_model::{InvalidSwimmer, Swimmer};

use super::newton::Design;
use super::uncertainty::Uncertainty;
use super::{Over, RobustError, Values};
use crate::member::Member;
use crate::parallel::Watch;

/// Ensemble of swimmers of a problem.
pub(super) struct Ensemble<'a> {
    swimmer: &'a Swimmer<f64>,
    uncertainty: &'a Uncertainty,
    pub(super) nominal: Member,
    /// Grid from which the search for the worst case starts.
    pub(super) grid: Vec<([f64; 3], Member)>,
    /// Members with their weights in the mean.
    pub(super) normal: Vec<(Member, f64)>,
    /// Receives 1 before each solution and each search for the worst case; the rest of the work has no known length.
    watch: Watch<'a>,
}

/// Worst case of a gait.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lowest {
    pub(super) value: f64,
    place: [f64; 3],
    pub(super) member: Member,
}

/// Solution, with the members that its first-order condition weights: for the worst case, the active ones.
pub(super) struct RobustSolution<P> {
    pub(super) over: Over,
    pub(super) point: P,
    pub(super) weighted: Vec<(Member, f64)>,
}

impl<P> RobustSolution<P> {
    /// Active members of the worst case; empty for a mean.
    pub(super) fn holders(&self) -> &[(Member, f64)] {
        match self.over {
            Over::Worst => &self.weighted,
            Over::Mean => &[],
        }
    }
}

/// Number of the lowest grid points from which the minimum is searched.
const DESCENTS: usize = 2;
/// Accuracy of the worst case as a share of the grid spacing; the error of its value is quadratic in it.
const FINEST: f64 = 1e-6;
/// Distance in half widths below which two worst cases are the same one.
const SAME: f64 = 0.5;
/// Smallest step of the homotopy in the weights.
const SMALLEST_STEP: f64 = 0.05;

impl<'a> Ensemble<'a> {
    pub(super) fn new(
        swimmer: &'a Swimmer<f64>,
        bounds: &Bounds,
        uncertainty: &'a Uncertainty,
        watch: Watch<'a>,
    ) -> Result<Self, RobustError> {
        uncertainty.validate()?;
        swimmer.common_drag().map_err(InvalidSwimmer::Uncommon)?;
        if bounds.no_overlap && uncertainty.gain_is_open() {
            return Err(RobustError::Clearance);
        }
        let grid = uncertainty.grid().into_iter();
        let grid = grid.map(|place| Ok((place, uncertainty.at(swimmer, place)?)));
        Ok(Self {
            swimmer,
            uncertainty,
            nominal: uncertainty.at(swimmer, [0.0; 3])?,
            grid: grid.collect::<Result<_, InvalidSwimmer>>()?,
            normal: uncertainty.normal(swimmer)?,
            watch,
        })
    }

    /// Least value over the ensemble. Returns `None` if every value is NaN.
    pub(super) fn lowest(&self, value: impl Fn(&Member) -> f64) -> Option<Lowest> {
        (self.watch)(1.0);
        let seen = self.grid.iter().map(|&(place, member)| Lowest {
            value: value(&member),
            place,
            member,
        });
        let mut seen: Vec<Lowest> = seen.filter(|one| !one.value.is_nan()).collect();
        seen.sort_by(|a, b| a.value.total_cmp(&b.value));
        seen.truncate(DESCENTS);
        let ends = seen.into_iter().map(|start| self.downhill(start, &value));
        ends.min_by(|a, b| a.value.total_cmp(&b.value))
    }

    /// Coordinate descent with decreasing steps.
    fn downhill(&self, mut here: Lowest, value: &impl Fn(&Member) -> f64) -> Lowest {
        let axes = self.uncertainty.axes();
        let moved = |mut place: [f64; 3], index: usize, share: f64| {
            let (axis, before) = (axes[index], place[index]);
            place[index] = axis.within(before + share * axis.half_step());
            // No step beyond the end of an axis, or along an axis without extent.
            let moves = (place[index] - before).abs() > 0.0;
            let member = self.uncertainty.at(self.swimmer, place).ok();
            let member = member.filter(|_| moves)?;
            let value = value(&member);
            Some(Lowest {
                value,
                place,
                member,
            })
        };
        let mut share = 1.0;
        while share > FINEST {
            let steps = [0, 1, 2].map(|index| [(index, share), (index, -share)]);
            let places = steps.into_iter().flatten();
            let better = places
                .filter_map(|(index, share)| moved(here.place, index, share))
                .find(|there| there.value < here.value);
            match better {
                Some(there) => here = there,
                None => share *= 0.5,
            }
        }
        here
    }

    /// Returns `true` if two worst cases are the same one, displaced by a change of the gait.
    pub(super) fn is_same(&self, one: &Lowest, other: &Lowest) -> bool {
        let [one, other] = [one, other].map(|lowest| self.uncertainty.half_widths(lowest.place));
        one.iter().zip(&other).all(|(a, b)| (a - b).abs() < SAME)
    }

    /// Gait that is best for a weighted mean, near `start`. If that is too far away, follows a homotopy in the weights from the nominal
    /// optimum.
    pub(super) fn solve<D: Design>(
        &self,
        design: &D,
        start: &D::Point,
        members: &[(Member, f64)],
    ) -> Result<D::Point, RobustError> {
        (self.watch)(1.0);
        match design.solve(start, members) {
            Err(RobustError::NotConverged { .. }) => self.followed(design, members),
            other => other,
        }
    }

    fn followed<D: Design>(
        &self,
        design: &D,
        members: &[(Member, f64)],
    ) -> Result<D::Point, RobustError> {
        let mut here = design.start();
        let (mut share, mut step) = (0.0, 0.25);
        while share < 1.0 {
            (self.watch)(1.0);
            let next = f64::min(share + step, 1.0);
            let scaled = members.iter().map(|(one, weight)| (*one, weight * next));
            let mut mixed = vec![(self.nominal, 1.0 - next)];
            mixed.extend(scaled);
            match design.solve(&here, &mixed) {
                Ok(there) => (here, share) = (there, next),
                Err(error) if step < SMALLEST_STEP => return Err(error),
                Err(_) => step *= 0.5,
            }
        }
        Ok(here)
    }

    /// Values of a gait over the ensemble.
    pub(super) fn values<D: Design>(&self, design: &D, point: &D::Point) -> Values {
        self.brings(|member| design.value(point, member), design.unit())
    }

    /// Values of any function of the members, in this unit.
    pub(super) fn brings(&self, value: impl Fn(&Member) -> f64, unit: f64) -> Values {
        let mean = self.normal.iter();
        let mean: f64 = mean.map(|(member, weight)| value(member) * weight).sum();
        Values {
            nominal: unit * value(&self.nominal),
            worst: unit * self.lowest(&value).map_or(f64::NAN, |lowest| lowest.value),
            mean: unit * mean,
        }
    }

    /// Swimmers of the grid, which extends to the boundary of the ensemble.
    pub(super) fn on_grid(&self) -> impl Iterator<Item = &Member> {
        self.grid.iter().map(|(_, member)| member)
    }

    /// Returns `true` if a gait is not on the branch of the nominal optimum: it is better for the estimates themselves, or the optimum
    /// for the estimates near it is another gait.
    pub(super) fn is_off_branch<D: Design>(&self, design: &D, point: &D::Point) -> bool {
        let value = |point: &D::Point| design.value(point, &self.nominal);
        let nominal = value(&design.start());
        let close = 1e-6 * nominal.abs();
        if value(point) > nominal + close {
            return true;
        }
        let back = design.solve(point, &[(self.nominal, 1.0)]);
        back.is_ok_and(|back| (value(&back) - nominal).abs() > close)
    }
}
