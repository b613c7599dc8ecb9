//! Solution of one design: by a full search, or by continuation from the gait of a neighbouring design.

use gait_optimizer::{
    Branch, DisplacementError, DisplacementProblem, EfficiencyProblem, EfficiencySeed, Fastest,
    OptimalGait, SidewaysProblem, SpeedProblem, TurningProblem, displacement, displacement_near,
    efficiency, sideways, turning,
};
use serde::{Deserialize, Serialize};

use crate::field::Design;
use crate::row::Row;

/// Objective of the gaits of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aim {
    /// Largest net displacement, of simple gaits with the paper's two symmetries, in either sense.
    Displacement,
    /// Lighthill efficiency, small gait.
    EfficiencySmall,
    /// Lighthill efficiency, large gait.
    EfficiencyLarge,
    /// Largest displacement per unit of time under the servos' rates.
    Speed,
    /// Largest rotation.
    Turning,
    /// Largest displacement across the heading.
    Sideways,
    /// Smooth function of the key without any solution, to test a machine or a scheduler.
    Stub,
}

impl Aim {
    /// All objectives, in the order of their indices in a plan.
    pub const ALL: [Self; 7] = [
        Self::Displacement,
        Self::EfficiencySmall,
        Self::EfficiencyLarge,
        Self::Speed,
        Self::Turning,
        Self::Sideways,
        Self::Stub,
    ];

    /// Objective with this word; `efficiency` means the small gait. Returns `None` for an unknown word.
    ///
    /// ```
    /// use sweep::Aim;
    ///
    /// assert_eq!(Aim::of_word("efficiency"), Some(Aim::EfficiencySmall));
    /// assert_eq!(Aim::of_word("speed").map(Aim::quantity), Some("|d|/(L T) [1/s]"));
    /// assert_eq!(Aim::of_word("height"), None);
    /// ```
    pub fn of_word(word: &str) -> Option<Self> {
        let small = (word == "efficiency").then_some(Self::EfficiencySmall);
        small.or_else(|| Self::ALL.into_iter().find(|aim| aim.word() == word))
    }

    /// Index in [`Aim::ALL`], which a plan stores as a value of an axis.
    pub(crate) fn index(self) -> f64 {
        let places = Self::ALL.into_iter().position(|aim| aim == self);
        places.unwrap_or(0) as f64
    }

    pub(crate) fn of_index(index: f64) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|aim| (aim.index() - index).abs() < 0.5)
    }

    /// Word of the objective in specs and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::EfficiencySmall => "efficiency small",
            Self::EfficiencyLarge => "efficiency large",
            Self::Speed => "speed",
            Self::Turning => "turning",
            Self::Sideways => "sideways",
            Self::Stub => "stub",
        }
    }

    /// Maximised quantity with its unit.
    pub fn quantity(self) -> &'static str {
        match self {
            Self::Displacement => "|X|/L",
            Self::EfficiencySmall | Self::EfficiencyLarge => "ξ",
            Self::Speed => "|d|/(L T) [1/s]",
            Self::Turning => "rotation [rad]",
            Self::Sideways => "|Y|/L",
            Self::Stub => "stub",
        }
    }

    /// Returns `true` if a neighbour's gait can serve as a start.
    pub(crate) fn follows(self) -> bool {
        matches!(
            self,
            Self::Displacement | Self::EfficiencySmall | Self::EfficiencyLarge | Self::Speed
        )
    }
}

/// Gait in the form from which a neighbour can start.
#[derive(Debug, Clone)]
enum Held {
    Gait(Box<OptimalGait>),
    Seed(Box<EfficiencySeed>),
    Fastest(Box<Fastest>),
    Nothing,
}

/// Solved design.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) row: Row,
    held: Held,
}

impl Solved {
    /// Solution without a gait from which a neighbour could start.
    pub(crate) fn of_row(row: Row) -> Self {
        Self {
            row,
            held: Held::Nothing,
        }
    }

    /// Returns `true` if two solutions of a design are the same gait: equal value within a relative tolerance, and the same arcs.
    pub(crate) fn same(&self, other: &Self) -> bool {
        const SAME: f64 = 1e-7;
        let (Some(a), Some(b)) = (self.row.objective, other.row.objective) else {
            return false;
        };
        self.row.arcs == other.row.arcs && (a - b).abs() <= SAME * a.abs().max(b.abs())
    }
}

/// Samples of a quarter gait. The stored numbers do not depend on them: X/L and ξ are computed from the arcs, and the certificate
/// requests more samples if it needs them.
const QUARTER: usize = 64;

/// Reason why a design has no gait.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Missing {
    pub(crate) reason: String,
    /// Value of a gait whose certificate fails; a gait with a lower value is not the best.
    pub(crate) outdone: Option<f64>,
}

impl From<String> for Missing {
    fn from(reason: String) -> Self {
        Self {
            reason,
            outdone: None,
        }
    }
}

impl From<DisplacementError> for Missing {
    fn from(error: DisplacementError) -> Self {
        Self {
            reason: error.to_string(),
            outdone: match error {
                DisplacementError::NotCertified {
                    displacement_over_length,
                    ..
                } => Some(displacement_over_length.abs()),
                DisplacementError::Saddle { gait } => Some(gait.displacement_over_length.abs()),
                _ => None,
            },
        }
    }
}

/// Result of a design.
pub(crate) type DesignOutcome = Result<Solved, Missing>;

/// Solver of the designs of a plan.
pub(crate) trait Solve {
    /// Solves a design by the search of the objective.
    fn cold(&self, design: &Design, key: u64) -> DesignOutcome;
    /// Solves a design from its neighbour's solution. Returns `None` if that leads to no certified gait.
    fn warm(&self, design: &Design, key: u64, near: &Solved) -> Option<Solved>;
    /// Derives the result from that of a design with other servo rates. Returns `None` if the rates affect the best gait.
    fn timed_anew(&self, design: &Design, key: u64, same: &DesignOutcome) -> Option<DesignOutcome>;
}

/// Solver with the options of a spec.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solver {
    /// Number of starts of a search; `None` for the default.
    pub(crate) starts: Option<u32>,
}

impl Solver {
    fn of_displacement(design: &Design) -> DisplacementProblem {
        DisplacementProblem {
            bounds: design.bounds,
            quarter_samples: QUARTER,
            ..DisplacementProblem::new(design.swimmer)
        }
    }

    fn of_efficiency(design: &Design) -> EfficiencyProblem {
        let branch = if design.aim == Aim::EfficiencyLarge {
            Branch::Large
        } else {
            Branch::Small
        };
        EfficiencyProblem {
            bounds: design.bounds,
            quarter_samples: QUARTER,
            ..EfficiencyProblem::new(design.swimmer, branch)
        }
    }

    fn of_speed(self, design: &Design) -> Result<SpeedProblem, String> {
        let rates = design
            .rates
            .ok_or_else(|| "no rate of the servos is given".to_owned())?;
        let problem = SpeedProblem {
            bounds: design.bounds,
            ..SpeedProblem::new(design.swimmer, rates)
        };
        Ok(SpeedProblem {
            starts: self.starts.map_or(problem.starts, |starts| starts as usize),
            ..problem
        })
    }

    fn solved(design: &Design, key: u64, warm: bool, held: Held) -> Solved {
        let mut row = match &held {
            Held::Gait(gait) => Row::of(gait, design.rates),
            Held::Seed(seed) => Row::of(seed.gait(), design.rates),
            Held::Fastest(found) => Row {
                speed_over_length_per_s: Some(found.speed_over_length),
                period_s: Some(found.period),
                ..Row::of(&found.gait, None)
            },
            Held::Nothing => Row::default(),
        };
        let size = |value: Option<f64>| value.map(f64::abs);
        row.key = key;
        row.warm = warm;
        row.objective = match design.aim {
            Aim::Displacement => size(row.displacement_over_length),
            Aim::EfficiencySmall | Aim::EfficiencyLarge => row.efficiency,
            Aim::Speed => row.speed_over_length_per_s,
            Aim::Turning => size(row.rotation_rad),
            Aim::Sideways => size(row.lateral_over_length),
            Aim::Stub => row.objective,
        };
        Solved { row, held }
    }
}

impl Solve for Solver {
    fn cold(&self, design: &Design, key: u64) -> DesignOutcome {
        let of_gait =
            |gait: OptimalGait| Self::solved(design, key, false, Held::Gait(Box::new(gait)));
        match design.aim {
            Aim::Displacement => displacement(&Self::of_displacement(design))
                .map(of_gait)
                .map_err(Missing::from),
            Aim::EfficiencySmall | Aim::EfficiencyLarge => efficiency(&Self::of_efficiency(design))
                .map(EfficiencySeed::new)
                .map(|seed| Self::solved(design, key, false, Held::Seed(Box::new(seed))))
                .map_err(|error| error.to_string().into()),
            Aim::Speed => gait_optimizer::fastest(&self.of_speed(design)?)
                .map(|found| Self::solved(design, key, false, Held::Fastest(Box::new(found))))
                .map_err(|error| error.to_string().into()),
            Aim::Turning => turning(&TurningProblem {
                swimmer: design.swimmer,
                bounds: design.bounds,
            })
            .map(|found| of_gait(found.gait))
            .map_err(|error| error.to_string().into()),
            Aim::Sideways => {
                let usual = SidewaysProblem::new(design.swimmer);
                let problem = SidewaysProblem {
                    bounds: design.bounds,
                    starts: self.starts.map_or(usual.starts, |starts| starts as usize),
                    ..usual
                };
                sideways(&problem, &|_| ())
                    .map(|found| of_gait(found.gait))
                    .map_err(|error| error.to_string().into())
            }
            Aim::Stub => Ok(stub(key)),
        }
    }

    fn warm(&self, design: &Design, key: u64, near: &Solved) -> Option<Solved> {
        let held = match (&near.held, design.aim) {
            (Held::Gait(gait), Aim::Displacement) => {
                let next = displacement_near(&Self::of_displacement(design), gait)?;
                Held::Gait(Box::new(next))
            }
            (Held::Seed(seed), Aim::EfficiencySmall | Aim::EfficiencyLarge) => {
                Held::Seed(Box::new(seed.near(&Self::of_efficiency(design))?))
            }
            (Held::Fastest(fastest), Aim::Speed) => {
                Held::Fastest(Box::new(self.of_speed(design).ok()?.near(fastest)?))
            }
            _ => return None,
        };
        Some(Self::solved(design, key, true, held))
    }

    fn timed_anew(&self, design: &Design, key: u64, same: &DesignOutcome) -> Option<DesignOutcome> {
        if design.aim == Aim::Speed {
            return None;
        }
        Some(match same {
            Ok(found) => Ok(Self::solved(
                design,
                key,
                found.row.warm,
                found.held.clone(),
            )),
            Err(missing) => Err(missing.clone()),
        })
    }
}

/// Row of the objective `stub`.
fn stub(key: u64) -> Solved {
    let wave = (key as f64 * 1e-3).sin();
    Solved::of_row(Row {
        key,
        objective: Some(2.0 + wave),
        displacement_over_length: Some(wave),
        efficiency: Some(0.5 * wave * wave),
        certified: Some(true),
        arcs: Some(if wave > 0.0 { "upper" } else { "lower" }.to_owned()),
        ..Row::default()
    })
}
