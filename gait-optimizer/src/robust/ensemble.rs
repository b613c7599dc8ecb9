//! All swimmers that are left open: what a gait brings with them, and the gait that is best for their mean or their worst.

use swimmer_files::Bounds;
use swimmer_model::{InvalidSwimmer, Swimmer};

use super::newton::Design;
use super::uncertainty::Uncertainty;
use super::{Over, RobustError, Values};
use crate::member::Member;

/// All swimmers of a problem.
pub(super) struct Ensemble<'a> {
    swimmer: &'a Swimmer<f64>,
    uncertainty: &'a Uncertainty,
    pub(super) nominal: Member,
    /// Where the search for the worst case begins.
    pub(super) grid: Vec<([f64; 3], Member)>,
    /// With their weights in the mean.
    pub(super) normal: Vec<(Member, f64)>,
}

/// The worst case of a gait.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lowest {
    pub(super) value: f64,
    place: [f64; 3],
    pub(super) member: Member,
}

/// A gait found, and the members that its first-order condition weighs: for the worst case those that hold it.
pub(super) struct Found<P> {
    pub(super) over: Over,
    pub(super) point: P,
    pub(super) weighted: Vec<(Member, f64)>,
}

impl<P> Found<P> {
    /// Who holds the worst case; nobody holds a mean.
    pub(super) fn holders(&self) -> &[(Member, f64)] {
        match self.over {
            Over::Worst => &self.weighted,
            Over::Mean => &[],
        }
    }
}

/// Of the grid, so many of the lowest are gone downhill from.
const DESCENTS: usize = 2;
/// Shares of the grid's spacing down to which the worst case is known: its value is off by the square of it.
const FINEST: f64 = 1e-6;
/// A worst case that moved by less, in half widths, is still the same.
const SAME: f64 = 0.5;
/// Smallest step along the weights.
const SMALLEST_STEP: f64 = 0.05;

impl<'a> Ensemble<'a> {
    pub(super) fn new(
        swimmer: &'a Swimmer<f64>,
        bounds: &Bounds,
        uncertainty: &'a Uncertainty,
    ) -> Result<Self, RobustError> {
        uncertainty.validate()?;
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
        })
    }

    /// The least value over all that is left open; none where no value is a number.
    pub(super) fn lowest(&self, value: impl Fn(&Member) -> f64) -> Option<Lowest> {
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

    /// Coordinate by coordinate, with ever smaller steps.
    fn downhill(&self, mut here: Lowest, value: &impl Fn(&Member) -> f64) -> Lowest {
        let axes = self.uncertainty.axes();
        let moved = |mut place: [f64; 3], index: usize, share: f64| {
            let (axis, before) = (axes[index], place[index]);
            place[index] = axis.within(before + share * axis.half_step());
            // Not where it is already at the end, or nothing is open.
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

    /// Whether two worst cases are one that the gait moved along.
    pub(super) fn is_same(&self, one: &Lowest, other: &Lowest) -> bool {
        let [one, other] = [one, other].map(|lowest| self.uncertainty.half_widths(lowest.place));
        one.iter().zip(&other).all(|(a, b)| (a - b).abs() < SAME)
    }

    /// The gait that is best for a weighted mean, near `start`; where it is too far from there, along the weights from the nominal
    /// optimum.
    pub(super) fn solve<D: Design>(
        &self,
        design: &D,
        start: &D::Point,
        members: &[(Member, f64)],
    ) -> Result<D::Point, RobustError> {
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

    /// What a gait brings.
    pub(super) fn values<D: Design>(&self, design: &D, point: &D::Point) -> Values {
        self.brings(|member| design.value(point, member), design.unit())
    }

    /// The same of any value in this unit.
    pub(super) fn brings(&self, value: impl Fn(&Member) -> f64, unit: f64) -> Values {
        let mean = self.normal.iter();
        let mean: f64 = mean.map(|(member, weight)| value(member) * weight).sum();
        Values {
            nominal: unit * value(&self.nominal),
            worst: unit * self.lowest(&value).map_or(f64::NAN, |lowest| lowest.value),
            mean: unit * mean,
        }
    }

    /// The swimmers of the grid, which reaches to the border of all that is left open.
    pub(super) fn on_grid(&self) -> impl Iterator<Item = &Member> {
        self.grid.iter().map(|(_, member)| member)
    }

    /// Whether another branch of optima than the nominal one holds a gait that was found from it: it is better for the estimates
    /// themselves, or what is best for them near it is another gait than the nominal optimum.
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
