//! How far gaits carry where none carries farthest: members that grow towards a supremum.
//!
//! Without a price on length a gait may reach shapes off all bounds along a slit, out and back. Of closed curves that do not touch
//! themselves the limit is none, so there is no optimum: narrower slits carry farther. A direct method climbs polygons whose
//! strands are held a gap apart ([`curve`]); as the gap is halved they give a growing sequence of gaits and its limit.

mod curve;
mod excursion;

use nalgebra::Vector2;
use swimmer_files::{Bounds, GaitFile, SwimmerHash};
use swimmer_model::{Model, Swimmer};

use super::best::best;
use super::{DisplacementProblem, OUTDONE, displacement};
use crate::OptimalGait;
use crate::cycle::{Cycle, Samples};
use crate::region::Region;
use curve::{Ground, Mesh};

/// What gaits come near to that none reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct Supremum {
    /// The limit of X over L as the gaps close, signed: of the members below, so that another kind of gait may still go beyond.
    pub over_length: f64,
    /// How far off the limit of this kind of gait may be: what the last halving of the gap brought, and at least 2e-4 of the limit,
    /// by about which climbs from unlike starts differ.
    pub uncertainty: f64,
    /// Gaits, each with narrower gaps and farther than the one before. At least one.
    pub members: Vec<Member>,
}

/// A gait that carries farther than every local optimum found, and is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Between parts of the quarter that would touch \[rad\].
    pub gap: f64,
    /// X over L of the cycle, signed, as the model swims it.
    pub displacement_over_length: f64,
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// Joint angles at the corners of the quarter, from φ₁ = φ₂ to φ₁ = −φ₂ \[rad\].
    pub quarter: Vec<Vector2<f64>>,
    swimmer: Swimmer<f64>,
    bounds: Bounds,
    cycle: Cycle,
}

/// Where polygons look for their kind, and how far gaps are closed then.
const COARSE: Mesh = Mesh {
    gap: 0.02,
    side: 0.08,
};
const FINER: [Mesh; 4] = [
    Mesh {
        gap: 0.02,
        side: 0.05,
    },
    Mesh {
        gap: 0.01,
        side: 0.04,
    },
    Mesh {
        gap: 0.005,
        side: 0.03,
    },
    Mesh {
        gap: 0.0025,
        side: 0.02,
    },
];
/// Most moves of a climb.
const COARSE_MOVES: usize = 600;
const FINE_MOVES: usize = 1500;
/// Most slits tried from a start, and from one polygon.
const MOST_TRIED: usize = 12;
const TRIED_AT_ONCE: usize = 5;
/// By about this much, relatively, climbs from unlike starts come to different limits.
const SPREAD: f64 = 2e-4;
/// What carries this much farther, relatively, is another gait.
const FARTHER: f64 = 1e-5;
/// Kinds whose gaps are closed, and by how much they differ, relatively, while gaps are wide.
const CLOSED: usize = 2;
const ALIKE: f64 = 1e-4;
/// So much less, relatively, a kind may carry while gaps are wide.
const WIDE: f64 = 1e-2;

/// How far gaits carry that are no optimum, where they carry farther than the optimum that was found (none for none). None where
/// no such gait was met, or the problem asks for simple gaits, or has no upper bound.
///
/// ```
/// use gait_optimizer::{DisplacementProblem, Heading, displacement, displacement_supremum};
/// use swimmer_model::Swimmer;
///
/// let backwards = Some(Heading::Backwards);
/// let problem = DisplacementProblem { heading: backwards, ..DisplacementProblem::new(Swimmer::purcell()) };
/// let found = displacement(&problem.with_max_angle(2.0))?;
/// let supremum = displacement_supremum(&problem.with_max_angle(2.0), Some(&found)).unwrap();
/// let members: Vec<_> = supremum.members.iter().map(|member| -member.displacement_over_length).collect();
/// assert!(members.is_sorted() && members[0] > -found.displacement_over_length);
/// assert!(-supremum.over_length >= members[members.len() - 1]);
/// # Ok::<(), gait_optimizer::DisplacementError>(())
/// ```
pub fn displacement_supremum(
    problem: &DisplacementProblem,
    found: Option<&OptimalGait>,
) -> Option<Supremum> {
    let sectored = problem.bounds.sector && !problem.simple && problem.bounds.max_angle.is_some();
    if !problem.may_touch() && !sectored {
        return None;
    }
    let model = problem.validated().ok()?;
    let bounds = problem.touching();
    let region = Region::new(&bounds, &problem.swimmer.links);
    let ground = Ground {
        model: &model,
        region: &region,
        sign: problem.heading().sign(),
    };
    let least = found.map_or(0.0, |gait| gait.displacement_over_length.abs());
    let (own, known) = kinds(&ground, problem, found);
    let tighter = tighter(problem).flat_map(|problem| {
        let region = Region::new(&problem.touching(), &problem.swimmer.links);
        let within = Ground {
            region: &region,
            ..ground
        };
        let (kinds, _) = kinds(&within, &problem, displacement(&problem).ok().as_ref());
        kinds.into_iter().take(CLOSED)
    });
    let tighter = tighter.map(|(kind, _)| explored(&ground, &kind));
    let mut kinds = distinct(own.into_iter().chain(tighter).collect());
    kinds.retain(|(_, carried)| *carried > least * (1.0 - WIDE));
    let closed = kinds.iter().take(CLOSED).map(|(kind, _)| {
        let members = ground.members(problem, kind, least * (1.0 + FARTHER));
        (members.last().map_or(0.0, Member::carried), members)
    });
    let (_, members) = closed.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let last = members.last()?.carried();
    let grown = match members.as_slice() {
        [.., before, _] => last - before.carried(),
        _ => 0.0,
    };
    Some(Supremum {
        over_length: ground.sign * (last + grown).max(known),
        uncertainty: grown.max(SPREAD * last),
        members,
    })
}

impl Ground<'_> {
    /// Gaits of one kind with narrower gaps from one to the next, each of which carries farther than the one before, and the first
    /// farther than `least`.
    fn members(
        &self,
        problem: &DisplacementProblem,
        kind: &[Vector2<f64>],
        least: f64,
    ) -> Vec<Member> {
        let mut here = kind.to_vec();
        let mut members: Vec<Member> = Vec::new();
        for mesh in FINER {
            (here, _) = self.climbed(&here, mesh, FINE_MOVES);
            let farther = members.last().map_or(least, Member::carried);
            if self.is_member(&here, mesh)
                && let Some(member) = Member::new(problem, self.model, &here, mesh.gap)
                && self.sign * member.displacement_over_length > farther
            {
                members.push(member);
            }
        }
        members
    }
}

/// Problems whose gaits are gaits of this one.
fn tighter(problem: &DisplacementProblem) -> impl Iterator<Item = DisplacementProblem> {
    /// \[rad\]
    const BY: f64 = 0.1;
    let bounds = problem.bounds;
    let higher = bounds.min_angle.map(|angle| Bounds {
        min_angle: Some(angle + BY),
        ..bounds
    });
    let lower = bounds.max_angle.map(|angle| Bounds {
        max_angle: Some(angle - BY),
        ..bounds
    });
    let apart = (!bounds.no_overlap).then_some(Bounds {
        no_overlap: true,
        ..bounds
    });
    let all = [higher, lower, apart].into_iter().flatten();
    all.map(|bounds| DisplacementProblem { bounds, ..*problem })
}

/// A polygon at rest and what it carries.
type Kind = (Vec<Vector2<f64>>, f64);

/// What climbs from a problem's own starts come to, farthest first, and how far over L gaits carry that were met by the search for
/// optima.
fn kinds(
    ground: &Ground<'_>,
    problem: &DisplacementProblem,
    found: Option<&OptimalGait>,
) -> (Vec<Kind>, f64) {
    let least = found.map_or(0.0, |gait| gait.displacement_over_length.abs());
    let bounds = problem.touching();
    let within = (&bounds, ground.region);
    let (_, seen) = best(problem, ground.model, within, 0.0);
    let farthest = seen.farthest(problem, ground.model, within, least * (1.0 + OUTDONE));
    let known = farthest
        .as_ref()
        .map_or(least, |gait| gait.displacement_over_length.abs());
    let gaits = found.into_iter().chain(&farthest).map(of_gait);
    let starts = gaits.chain(across(problem));
    (
        distinct(starts.map(|start| explored(ground, &start)).collect()),
        known,
    )
}

/// Farthest first, without those that carry as far as another.
fn distinct(mut kinds: Vec<Kind>) -> Vec<Kind> {
    kinds.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    kinds.dedup_by(|(_, a), (_, b)| (*b - *a).abs() < ALIKE * *b);
    kinds
}

/// The first quarter of a gait.
fn of_gait(gait: &OptimalGait) -> Vec<Vector2<f64>> {
    let quarter = gait.u().partition_point(|&u| u < 0.25 - 1e-12);
    gait.phi().iter().take(quarter + 1).copied().collect()
}

/// Straight across between the diagonals, along the bounds.
fn across(problem: &DisplacementProblem) -> impl Iterator<Item = Vec<Vector2<f64>>> {
    let places = [problem.bounds.max_angle, problem.bounds.min_angle];
    places.into_iter().flatten().map(|angle| {
        let [from, to] = [angle, -angle].map(|one| Vector2::new(one, angle));
        (0..=8)
            .map(|k| from + (to - from) * (f64::from(k) / 8.0))
            .collect()
    })
}

/// What a start climbs to, with every slit that pays, and how far that carries.
fn explored(ground: &Ground<'_>, start: &[Vector2<f64>]) -> Kind {
    let (mut here, mut carried) = ground.climbed(start, COARSE, COARSE_MOVES);
    let mut tried = 0;
    'further: while tried < MOST_TRIED {
        let excursions = ground.excursions(&here, COARSE);
        for excursion in excursions.iter().take(TRIED_AT_ONCE) {
            tried += 1;
            let taken = excursion.taken(&here, COARSE);
            let (there, farther) = ground.climbed(&taken, COARSE, COARSE_MOVES);
            if farther > carried * (1.0 + FARTHER) {
                (here, carried) = (there, farther);
                continue 'further;
            }
        }
        break;
    }
    (here, carried)
}

impl Member {
    /// |X| over L.
    fn carried(&self) -> f64 {
        self.displacement_over_length.abs()
    }

    /// The cycle of a quarter, at constant power, swum by the model; none where it cannot be.
    fn new(
        problem: &DisplacementProblem,
        model: &Model<f64>,
        corners: &[Vector2<f64>],
        gap: f64,
    ) -> Option<Self> {
        let mut quarter = corners.to_vec();
        quarter.dedup_by(|a, b| (*a - *b).norm() < 1e-12);
        let mut along = vec![0.0];
        for side in quarter.windows(2) {
            let [from, to] = side else { continue };
            let way = to - from;
            let (_, power) = model.connection_and_power(&((from + to) * 0.5));
            let length = way.dot(&(power * way)).max(0.0).sqrt();
            along.push(along.last()? + length);
        }
        let samples = Samples {
            corners: (1..quarter.len().checked_sub(1)?).collect(),
            phi: quarter.clone(),
            along,
            arcs: Vec::new(),
        };
        let cycle = samples.unfolded([false; 2]);
        let stroke = cycle.swum(model)?;
        Some(Self {
            gap,
            displacement_over_length: stroke.displacement_over_length().x,
            links_cross: cycle.links_cross(model),
            quarter,
            swimmer: problem.swimmer,
            bounds: problem.bounds,
            cycle,
        })
    }

    /// What a gait file holds of it: a gait within the bounds, for no objective. `swimmer_name` is for people.
    pub fn gait_file(&self, swimmer_name: &str) -> GaitFile {
        GaitFile {
            swimmer_name: Some(swimmer_name.to_owned()),
            swimmer_hash: Some(SwimmerHash::of(&self.swimmer)),
            ..self.cycle.file(self.bounds)
        }
    }
}
