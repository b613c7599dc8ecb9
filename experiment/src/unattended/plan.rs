//! Plan of an experiment: the trials in their order.

use std::collections::BTreeSet;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{AdaptiveSpec, Journal, Measure, StartPose, StopRules};

/// Ordered list of trials, with the gaits that they play. It does not change once it is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// SHA-256 of the spec's text.
    pub spec_sha256: String,
    /// Seed of the order.
    pub seed: u64,
    /// Repeats of each gait.
    pub repeats: u32,
    /// Cycles before those that count.
    pub run_in: u32,
    /// Seconds at rest before a trial.
    pub settle_s: f64,
    /// Level of the intervals.
    pub level: f64,
    /// Gaits.
    pub gaits: Vec<PlannedGait>,
    /// Neighbours that the robot would refuse.
    pub left_out: Vec<LeftOut>,
    /// Goal of an adaptive campaign, whose trials the journal names as they are chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adaptive: Option<AdaptiveSpec>,
    /// Trials in their order.
    pub trials: Vec<Trial>,
}

/// Gait of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedGait {
    /// Its name.
    pub name: String,
    /// Gait file in the folder of the experiment.
    pub file: String,
    /// Duration of a cycle \[s\].
    pub period_s: f64,
    /// Counted cycles of a trial.
    pub cycles: u32,
    /// Predicted net motion of a cycle as the servos play it, in the frame of the middle link at its start: x and y \[m\].
    pub predicted_xy_m: [f64; 2],
    /// Predicted net turn of a cycle \[rad\].
    pub predicted_turn_rad: f64,
    /// Quantity in which an optimum is compared with its neighbours.
    pub measure: Measure,
    /// The optimum that it is a neighbour of.
    pub neighbour_of: Option<String>,
    /// Size over that of the optimum.
    pub size: f64,
}

/// Neighbour that is not played.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// Its name.
    pub gait: String,
    /// Reason.
    pub reason: String,
}

/// One trial.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trial {
    /// Number, from 1, in the order in which trials are run.
    pub number: u32,
    /// Block, from 1: every gait occurs once in it.
    pub block: u32,
    /// Name of the gait.
    pub gait: String,
}

impl PlannedGait {
    /// Predicted displacement of a cycle \[m\].
    pub fn predicted_m(&self) -> f64 {
        self.predicted_xy_m[0].hypot(self.predicted_xy_m[1])
    }
}

impl Plan {
    /// The gait of a trial. `None` if the plan has none of that name.
    pub fn gait(&self, trial: &Trial) -> Option<&PlannedGait> {
        self.gaits.iter().find(|gait| gait.name == trial.gait)
    }

    /// The trial of this number.
    pub fn trial(&self, number: u32) -> Option<&Trial> {
        self.trials.iter().find(|trial| trial.number == number)
    }

    /// Problem of a plan that was read from a file: numbers or names that do not match. `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let names: BTreeSet<&str> = self.gaits.iter().map(|gait| gait.name.as_str()).collect();
        if names.len() != self.gaits.len() {
            return Some("two of its gaits have one name".to_owned());
        }
        for (index, trial) in self.trials.iter().enumerate() {
            if trial.number as usize != index + 1 {
                return Some(format!("trial {} is out of order", trial.number));
            }
            if !names.contains(trial.gait.as_str()) {
                return Some(format!("trial {} plays an unknown gait", trial.number));
            }
        }
        None
    }

    /// SHA-256 of the plan's content, by which a journal names its plan. Chosen trials of an adaptive campaign are not part of it.
    pub fn sha256(&self) -> String {
        // A plan consists of numbers and texts, which always have a JSON form.
        let text = if self.adaptive.is_some() {
            let trials = Vec::new();
            serde_json::to_vec(&Self {
                trials,
                ..self.clone()
            })
        } else {
            serde_json::to_vec(self)
        };
        hexadecimal(&text.unwrap_or_default())
    }

    /// The plan with the trials that the journal of an adaptive campaign has chosen; any other plan as it is.
    #[must_use]
    pub fn with_chosen(&self, journal: &Journal) -> Self {
        let mut plan = self.clone();
        if self.adaptive.is_some() {
            plan.trials = journal
                .chosen()
                .map(|(number, gait)| Trial {
                    number,
                    block: number,
                    gait: gait.to_owned(),
                })
                .collect();
        }
        plan
    }
}

/// SHA-256 of some bytes, as 64 hexadecimal digits.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    Sha256::digest(bytes)
        .iter()
        .fold(String::new(), |mut text, byte| {
            // Writing to a String cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// Trials of these gaits in randomised complete blocks: each block is a random order of all gaits (Fisher–Yates shuffle). The same
/// seed gives the same order.
///
/// ```
/// use experiment::unattended::randomised;
///
/// let names = ["a", "b", "c"].map(str::to_owned);
/// let trials = randomised(&names, 4, 7);
/// assert_eq!(trials, randomised(&names, 4, 7));
/// for block in 1..=4 {
///     let mut gaits: Vec<&str> = trials.iter().filter(|t| t.block == block).map(|t| t.gait.as_str()).collect();
///     gaits.sort_unstable();
///     assert_eq!(gaits, ["a", "b", "c"]);
/// }
/// ```
pub fn randomised(gaits: &[String], repeats: u32, seed: u64) -> Vec<Trial> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut trials = Vec::with_capacity(gaits.len() * repeats as usize);
    for block in 1..=repeats {
        let mut order: Vec<&String> = gaits.iter().collect();
        for last in (1..order.len()).rev() {
            order.swap(last, rng.random_range(0..=last));
        }
        for gait in order {
            trials.push(Trial {
                number: u32::try_from(trials.len() + 1).unwrap_or(u32::MAX),
                block,
                gait: gait.clone(),
            });
        }
    }
    trials
}

impl super::Spec {
    /// The plan of a spec whose gaits are known.
    pub fn plan(&self, text: &str, gaits: Vec<PlannedGait>, left_out: Vec<LeftOut>) -> Plan {
        let names: Vec<String> = gaits.iter().map(|gait| gait.name.clone()).collect();
        Plan {
            spec_sha256: hexadecimal(text.as_bytes()),
            seed: self.seed,
            repeats: self.repeats,
            run_in: self.run_in,
            settle_s: self.settle_s,
            level: self.level,
            trials: randomised(&names, self.repeats, self.seed),
            gaits,
            left_out,
            adaptive: self.adaptive,
        }
    }
}

impl StartPose {
    /// The target of a [`crate::Controller`].
    pub fn target(&self) -> crate::Target {
        crate::Target {
            x_m: self.x_m,
            y_m: self.y_m,
            heading_rad: Some(self.heading_rad),
        }
    }
}

impl StopRules {
    /// Returns `true` if an attempt of this number is not followed by another.
    pub(super) fn gives_up_after(&self, attempt: u32) -> bool {
        attempt >= self.attempts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every gait is as often first as any other, within chance.
    #[test]
    fn every_gait_is_first_equally_often() {
        let names: Vec<String> = (0..5).map(|i| format!("g{i}")).collect();
        let trials = randomised(&names, 2000, 3);
        let mut first = [0_u32; 5];
        for block in trials.chunks(5) {
            let index = names.iter().position(|name| *name == block[0].gait);
            first[index.unwrap()] += 1;
        }
        // Binomial: 400 ± 18.
        assert!(
            first.iter().all(|count| (310..490).contains(count)),
            "{first:?}"
        );
        assert_ne!(randomised(&names, 5, 1), randomised(&names, 5, 2));
    }
}
