//! How far gaits carry where none carries farthest: members that grow towards a supremum.
//!
//! Without a price on length a gait may reach shapes off all bounds along a slit, out and back. Of closed curves that do not touch
//! themselves the limit is none, so there is no optimum: narrower slits carry farther. A direct method climbs polygons whose
//! strands are held a gap apart ([`curve`]); as the gap is halved they give a growing sequence of gaits and its limit.
//!
//! No climb finds every kind of gait from its own starts, but what is far off within wide bounds is near within tight ones. So
//! the leading joint's least angle is lowered rung by rung, from as tight as it can be, and what carries farthest on a rung is
//! where climbs of the next one start, beside their own: relaxing that bound lowers no answer.

mod curve;
mod excursion;
mod kinds;
mod member;

use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::Model;

use super::DisplacementProblem;
use crate::optimal_gait::OptimalGait;
use crate::parallel::in_parallel;
use crate::problem::tightened;
use crate::region::Region;
use curve::{Ground, Mesh};
use kinds::{Kind, across, distinct, explored};
pub use member::Member;

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

/// How far gaps are closed.
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
const FINE_MOVES: usize = 1500;
/// By about this much, relatively, climbs from unlike starts come to different limits.
const SPREAD: f64 = 2e-4;
/// What carries this much farther, relatively, is another gait.
const FARTHER: f64 = 1e-5;
/// Kinds that are handed to a wider problem, and whose gaps are closed.
const CLOSED: usize = 2;
/// Least angles of rungs are multiples of this \[rad\].
const RUNG: f64 = 0.1;
/// So much less, relatively, a kind may carry while gaps are wide.
const WIDE: f64 = 1e-2;

/// Suprema of displacement for one problem after another; remembers every rung that was climbed, which problems share.
///
/// ```
/// use gait_optimizer::{DisplacementProblem, Heading, Suprema, displacement};
/// use swimmer_model::Swimmer;
///
/// let backwards = Some(Heading::Backwards);
/// let problem = DisplacementProblem { heading: backwards, ..DisplacementProblem::new(Swimmer::purcell()) }.with_max_angle(2.0);
/// let found = displacement(&problem)?;
/// let supremum = Suprema::new(2).of(&problem, Some(&found)).unwrap();
/// let members: Vec<_> = supremum.members.iter().map(|member| -member.displacement_over_length).collect();
/// assert!(members.is_sorted() && members[0] > -found.displacement_over_length);
/// assert!(-supremum.over_length >= members[members.len() - 1]);
/// # Ok::<(), gait_optimizer::DisplacementError>(())
/// ```
#[derive(Debug, Default)]
pub struct Suprema {
    threads: usize,
    rungs: Vec<Rung>,
}

/// What climbs within some bounds come to.
#[derive(Debug)]
struct Rung {
    /// Its quarters keep between their images.
    problem: DisplacementProblem,
    /// From its own starts and from the tighter rung's kinds, farthest first.
    kinds: Vec<Kind>,
    /// How far over L a gait carries that the search for optima met.
    seen: f64,
    /// Of the kind that carries farthest as its gaps close, each farther than the one before; none before anybody asks.
    members: Option<Vec<Member>>,
}

impl Suprema {
    /// Of no problem yet; climbs on so many threads, on which no answer depends.
    pub fn new(threads: usize) -> Self {
        Self {
            threads,
            rungs: Vec::new(),
        }
    }

    /// How far gaits carry that are no optimum, where they carry farther than the optimum that was found (none for none). None
    /// where no such gait was met, or the problem asks for simple gaits, or has no upper bound.
    pub fn of(
        &mut self,
        problem: &DisplacementProblem,
        found: Option<&OptimalGait>,
    ) -> Option<Supremum> {
        if !problem.may_have_slits() {
            return None;
        }
        let model = problem.validated().ok()?;
        let least = found.map_or(0.0, |gait| gait.displacement_over_length.abs());
        let threads = self.threads;
        let rung = self.rung(problem, &model)?;
        if rung.kinds.first()?.1 < least * (1.0 - WIDE) {
            return None;
        }
        let seen = rung.seen;
        let members = rung.members(&model, threads).iter();
        let members = members.filter(|member| member.carried() > least * (1.0 + FARTHER));
        let members: Vec<Member> = members.map(|member| member.of(problem)).collect();
        let last = members.last()?.carried();
        let grown = match members.as_slice() {
            [.., before, _] => last - before.carried(),
            _ => 0.0,
        };
        Some(Supremum {
            over_length: problem.heading().sign() * (last + grown).max(seen),
            uncertainty: grown.max(SPREAD * last),
            members,
        })
    }

    /// A problem's rung, by way of all tighter ones.
    fn rung(&mut self, problem: &DisplacementProblem, model: &Model<f64>) -> Option<&mut Rung> {
        let place = |rungs: &[Rung], of| rungs.iter().position(|rung| rung.problem == of);
        let first = DisplacementProblem {
            bounds: problem.touching(),
            heading: Some(problem.heading()),
            ..*problem
        };
        let down = std::iter::successors(Some(first), tighter);
        let unknown: Vec<_> = down
            .take_while(|problem| place(&self.rungs, *problem).is_none())
            .collect();
        let own = |(): &mut (), at: usize| Rung::new(unknown[at], model);
        let own = in_parallel(unknown.len(), self.threads, &|_| (), || (), own);
        for mut rung in own.into_iter().rev() {
            let tighter = tighter(&rung.problem).and_then(|of| place(&self.rungs, of));
            if let Some(tighter) = tighter.and_then(|place| self.rungs.get(place)) {
                rung.go_on_from(tighter, model);
            }
            self.rungs.push(rung);
        }
        let place = place(&self.rungs, first)?;
        self.rungs.get_mut(place)
    }
}

impl Rung {
    /// From the problem's own starts.
    fn new(problem: DisplacementProblem, model: &Model<f64>) -> Self {
        let region = Region::new(&problem.bounds, &problem.swimmer.links);
        let met = kinds::met(&problem, model, &region);
        // Rungs run in the least angle alone: what a smaller largest angle leads to is met here, where they end.
        let smaller = tightened(&problem.bounds).filter(|bounds| bounds.min_angle.is_none());
        let beside = smaller.map(|bounds| {
            let region = Region::new(&bounds, &problem.swimmer.links);
            kinds::met(&DisplacementProblem { bounds, ..problem }, model, &region)
        });
        let ground = Ground::new(&problem, model, &region);
        let seen = met.iter().map(|(_, far)| *far).fold(0.0, f64::max);
        let met = met.into_iter().chain(beside.into_iter().flatten());
        let starts = met.map(|(quarter, _)| quarter).chain(across(&problem));
        let kinds = starts.map(|start| explored(&ground, &start)).collect();
        Self {
            problem,
            kinds: distinct(kinds),
            seen,
            members: None,
        }
    }

    /// And from what a tighter rung came to.
    fn go_on_from(&mut self, tighter: &Self, model: &Model<f64>) {
        let region = Region::new(&self.problem.bounds, &self.problem.swimmer.links);
        let ground = Ground::new(&self.problem, model, &region);
        let handed = tighter.kinds.iter().take(CLOSED);
        let handed = handed.map(|(kind, _)| explored(&ground, kind));
        self.kinds = distinct(self.kinds.drain(..).chain(handed).collect());
    }

    fn members(&mut self, model: &Model<f64>, threads: usize) -> &[Member] {
        let Self { problem, kinds, .. } = self;
        self.members.get_or_insert_with(|| {
            let region = Region::new(&problem.bounds, &problem.swimmer.links);
            let ground = Ground::new(problem, model, &region);
            let close = |(): &mut (), kind: usize| ground.members(problem, &kinds[kind].0);
            let closed = in_parallel(kinds.len().min(CLOSED), threads, &|_| (), || (), close);
            let carried = |members: &Vec<Member>| members.last().map_or(0.0, Member::carried);
            let best = closed
                .into_iter()
                .max_by(|a, b| carried(a).total_cmp(&carried(b)));
            best.unwrap_or_default()
        })
    }
}

/// The next tighter rung: its gaits are gaits of this problem. None where it leaves no room.
fn tighter(problem: &DisplacementProblem) -> Option<DisplacementProblem> {
    let bounds = problem.bounds;
    let region = Region::new(&bounds, &problem.swimmer.links);
    let next = (bounds.min_angle.unwrap_or(0.0) / RUNG + 1.0 + 1e-6).floor() * RUNG;
    (next < region.reach()).then_some(DisplacementProblem {
        bounds: Bounds {
            min_angle: Some(next),
            ..bounds
        },
        ..*problem
    })
}

impl Ground<'_> {
    /// Gaits of one kind with narrower gaps from one to the next, each of which carries farther than the one before.
    fn members(&self, problem: &DisplacementProblem, kind: &[Vector2<f64>]) -> Vec<Member> {
        let mut here = kind.to_vec();
        let mut members: Vec<Member> = Vec::new();
        for mesh in FINER {
            (here, _) = self.climbed(&here, mesh, FINE_MOVES);
            let farther = members.last().map_or(0.0, Member::carried);
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
