//! What is told where gaits carry ever farther and none farthest: how far they come, one of them, and the gait that a user wants
//! instead, the fastest one.

use std::fmt;
use std::path::PathBuf;

use gait_optimizer::{
    Certificate, DisplacementProblem, Member, OptimalGait, SpeedProblem, Supremum, fastest,
};
use serde::Serialize;
use swimmer_files::{Bounds, SwimmerFile};

use super::answer::Quarter;
use super::better::command;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::{self, Rows};
use crate::threads;

/// How fast servos are taken to turn where the swimmer file does not say, rad/s.
const RATE: f64 = 1.0;

/// The whole document.
#[derive(Debug, Serialize)]
pub(super) struct NoOptimum {
    #[serde(skip)]
    name: String,
    error: String,
    /// False.
    exists: bool,
    /// What X/L of the members tends to, and how far off that may be.
    supremum_over_length: f64,
    supremum_uncertainty_over_length: f64,
    best_member: BestMember,
    /// Each farther than the one before.
    members: Vec<MemberAnswer>,
    /// The best local optimum that was found, which the members outdo.
    local_optimum: Option<LocalOptimum>,
    /// The fastest gait of servos with a limit; null where there is none.
    priced: Option<Priced>,
    seconds: f64,
}

/// How narrow the slits of a gait are, and how far it carries.
#[derive(Debug, Serialize)]
struct MemberAnswer {
    gap_rad: f64,
    displacement_over_length: f64,
}

/// The member that carries farthest.
#[derive(Debug, Serialize)]
struct BestMember {
    displacement_over_length: f64,
    displacement_m: f64,
    gap_rad: f64,
    links_cross: f64,
    /// Joint angles along the quarter, a polygon, rad.
    quarter: Vec<[f64; 2]>,
    /// The gait file that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    gait: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct LocalOptimum {
    #[serde(flatten)]
    quarter: Quarter,
    links_cross: f64,
    certificate: Certificate,
}

/// The gait that a user wants instead.
#[derive(Debug, Serialize)]
struct Priced {
    command: String,
    max_rate_rad_per_s: f64,
    speed_over_length_per_s: f64,
    displacement_over_length: f64,
    displacement_m: f64,
    period_s: f64,
    heading_rad: f64,
}

impl NoOptimum {
    pub(super) fn new(
        (file, swimmer): (&SwimmerFile, &str),
        problem: &DisplacementProblem,
        supremum: &Supremum,
        found: Option<&OptimalGait>,
    ) -> Option<Self> {
        let best = supremum.members.last()?;
        let priced = Priced::new(file, swimmer, &problem.bounds);
        let instead = priced.as_ref().map_or_else(String::new, |priced| {
            format!("; the fastest gait exists: `{}`", priced.command)
        });
        Some(Self {
            name: file.name.clone(),
            error: format!(
                "no gait within these bounds carries farthest: those that reach shapes off the bounds along ever narrower slits \
                 come up to X/L = {:.6}, and none gets there{instead}",
                supremum.over_length
            ),
            exists: false,
            supremum_over_length: supremum.over_length,
            supremum_uncertainty_over_length: supremum.uncertainty,
            best_member: BestMember {
                displacement_over_length: best.displacement_over_length,
                displacement_m: best.displacement_over_length * file.swimmer.total_length(),
                gap_rad: best.gap,
                links_cross: best.links_cross,
                quarter: best.quarter.iter().map(|phi| [phi.x, phi.y]).collect(),
                gait: None,
            },
            members: supremum.members.iter().map(MemberAnswer::of).collect(),
            local_optimum: found.map(|gait| LocalOptimum {
                quarter: gait.into(),
                links_cross: gait.links_cross,
                certificate: gait.certificate.clone(),
            }),
            priced,
            seconds: 0.0,
        })
    }

    /// Writes the best member where that is asked for, and tells all.
    pub(super) fn told(
        mut self,
        best: Option<(&Member, PathBuf)>,
        seconds: f64,
        output: Output,
    ) -> Outcome {
        if let Some((member, path)) = best {
            member.gait_file(&self.name).save(&path)?;
            self.best_member.gait = Some(path);
        }
        self.seconds = seconds;
        output.answer(&self);
        Err(Failure::Answered(self.error))
    }
}

impl MemberAnswer {
    fn of(member: &Member) -> Self {
        Self {
            gap_rad: member.gap,
            displacement_over_length: member.displacement_over_length,
        }
    }
}

impl Priced {
    /// Within the same bounds on whole cycles: those on quarters make no sense for it.
    fn new(file: &SwimmerFile, swimmer: &str, bounds: &Bounds) -> Option<Self> {
        let rate = file.servo.map_or(RATE, |servo| servo.max_rate);
        let bounds = Bounds {
            min_angle: None,
            sector: false,
            ..*bounds
        };
        let found = fastest(&SpeedProblem {
            bounds,
            threads: threads::available(),
            ..SpeedProblem::new(file.swimmer, [rate; 2])
        })
        .ok()?;
        let told = rate.to_string();
        Some(Self {
            command: command(
                "optimize speed",
                swimmer,
                &bounds,
                Some(("--max-rate", &told)),
            ),
            max_rate_rad_per_s: rate,
            speed_over_length_per_s: found.speed_over_length,
            displacement_over_length: found.distance_over_length,
            displacement_m: found.distance_over_length * file.swimmer.total_length(),
            period_s: found.period,
            heading_rad: found.heading,
        })
    }
}

impl fmt::Display for NoOptimum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row(
            "supremum",
            format!(
                "X/L = {:.6} (± {:.0e}), which no gait reaches",
                self.supremum_over_length, self.supremum_uncertainty_over_length
            ),
        );
        for member in &self.members {
            rows.row(
                "a gait",
                format!(
                    "X/L = {:.6}, with slits {:.4} rad wide",
                    member.displacement_over_length, member.gap_rad
                ),
            );
        }
        rows.row(
            "the last of these",
            format!(
                "{} per cycle, links cross {}",
                quantity::length(self.best_member.displacement_m),
                quantity::crossing(self.best_member.links_cross)
            ),
        );
        if let Some(local) = &self.local_optimum {
            local.quarter.outdone_row(&mut rows);
        }
        if let Some(priced) = &self.priced {
            rows.row(
                "the fastest instead",
                format!(
                    "`{}`: {} per cycle in {:.2} s, {} off the mean heading",
                    priced.command,
                    quantity::length(priced.displacement_m),
                    priced.period_s,
                    quantity::angle(priced.heading_rad)
                ),
            );
        }
        if let Some(path) = &self.best_member.gait {
            rows.row("the last written to", path.display().to_string());
        }
        write!(f, "{}, no optimum of displacement\n{rows}", self.name)
    }
}
