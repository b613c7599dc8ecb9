//! Speed: the fastest gait for the worst swimmer, or in the mean, under the servos' rates.

use swimmer_model::Stroke;

use super::ensemble::Ensemble;
use super::newton::Design;
use super::worst::find;
use super::{Over, RobustError, Robustness, Uncertainty};
use crate::certificate::Condition;
use crate::cycle::Cycle;
use crate::member::Member;
use crate::numerics::worse;
use crate::parallel::Watch;
use crate::region::Region;
use crate::speed::{Fastest, Polished, Setting, SpeedProblem, mended, speed_of, told};

/// A robust fastest gait.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustSpeed {
    /// The gait, timed as it shall run; its numbers are those of the estimates' swimmer.
    pub fastest: Fastest,
    /// Cost and benefit of robustness, in |d|/(L T) \[1/s\].
    pub robustness: Robustness,
}

/// Chains of arcs about the fastest one of the estimates' swimmer.
struct Chains<'a> {
    setting: &'a Setting<'a>,
    start: Polished,
    /// The faster servo's rate.
    unit: f64,
}

impl Design for Chains<'_> {
    type Point = Polished;

    fn start(&self) -> Polished {
        self.start.clone()
    }

    fn value(&self, chain: &Polished, member: &Member) -> f64 {
        speed_of(chain, member)
    }

    fn swum(&self, chain: &Polished, stroke: &Stroke<f64>) -> f64 {
        stroke.displacement.norm() / chain.layout.period(&chain.z)
    }

    fn unit(&self) -> f64 {
        self.unit
    }

    /// Newton's method on all conditions, with an active-set update of the arcs.
    fn solve(&self, start: &Polished, members: &[(Member, f64)]) -> Result<Polished, RobustError> {
        let setting = Setting {
            members,
            ..self.setting.clone()
        };
        let chain = mended(&setting, start.links.clone());
        chain.ok_or(RobustError::NotConverged {
            residual: f64::INFINITY,
        })
    }
}

/// Largest rotation of a swimmer in a cycle \[rad\]. Fails unless it is negligible.
fn turns_nobody(ensemble: &Ensemble<'_>, cycle: &Cycle) -> Result<f64, RobustError> {
    let turns = ensemble.on_grid().map(|member| {
        let swum = cycle.turned(member.gain).swum(&member.model);
        swum.map_or(f64::NAN, |stroke| stroke.rotation.abs())
    });
    let rotation = turns.fold(0.0, worse);
    if rotation.is_nan() || rotation > Condition::NobodyTurns.tolerance() {
        return Err(RobustError::Turns { rotation });
    }
    Ok(rotation)
}

/// The gait of highest speed |d|/T, in the worst case or in the mean over the uncertainty, for servos with these rates. The
/// estimates replace r_s and χ of the problem's swimmer, and their fastest gait is computed first. No swimmer may rotate along
/// the gait.
///
/// # Errors
/// [`RobustError`] if no robust gait is found.
///
/// ```
/// use gait_optimizer::{Bounds, Over, SpeedProblem, Uncertainty, robust_speed};
/// use swimmer_model::Swimmer;
///
/// let purcell = Swimmer::purcell();
/// let problem = SpeedProblem {
///     bounds: Bounds::within(2.0),
///     starts: 3,
///     ..SpeedProblem::new(purcell, [1.0; 2])
/// };
/// let uncertainty = Uncertainty { gain_interval: [0.98, 1.02], ..Uncertainty::none(0.0, 2.0) };
/// let found = robust_speed(&problem, &uncertainty, Over::Worst, &|_| ()).unwrap();
/// assert!(found.robustness.values.worst >= found.robustness.nominal.worst);
/// ```
pub fn robust_speed(
    problem: &SpeedProblem,
    uncertainty: &Uncertainty,
    over: Over,
    watch: Watch<'_>,
) -> Result<RobustSpeed, RobustError> {
    let ensemble = Ensemble::new(&problem.swimmer, &problem.bounds, uncertainty, watch)?;
    let problem = &SpeedProblem {
        swimmer: ensemble.nominal.swimmer,
        ..*problem
    };
    let optimum = problem.watched(watch)?;
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    let setting = problem.setting(&ensemble.nominal.model, &region);
    let lost = || RobustError::Structure {
        problem: "the fastest gait's arcs do not lead back to it",
    };
    turns_nobody(&ensemble, &optimum.gait.cycle)?;
    let design = Chains {
        start: mended(&setting, optimum.links.clone()).ok_or_else(lost)?,
        setting: &setting,
        unit: problem.fast(),
    };
    let found = find(&design, &ensemble, over)?;
    let weighed = Setting {
        members: &found.weighted,
        ..setting.clone()
    };
    let mut fastest = told(problem, &weighed, &found.point).ok_or_else(lost)?;
    (fastest.starts, fastest.found) = (optimum.starts, optimum.found);
    let nominal = ensemble.values(&design, &design.start);
    let gait = &mut fastest.gait;
    let turns = Condition::NobodyTurns.check(turns_nobody(&ensemble, &gait.cycle)?);
    let certificate = gait.certificate.clone().with(vec![turns]);
    let cycles = [&gait.cycle, &optimum.gait.cycle];
    let (robustness, certificate) =
        Robustness::certified(&ensemble, &design, &found, nominal, cycles, certificate)?;
    gait.certificate = certificate;
    Ok(RobustSpeed {
        fastest,
        robustness,
    })
}
