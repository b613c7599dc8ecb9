//! Immutable plan of a sweep: the rule that maps a task to its design, and the hash of its content.

use std::fs;
use std::path::{Path, PathBuf};

use gait_optimizer::Bounds;
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use swimmer_files::{FileError, SwimmerFile, write_atomically};

use crate::field::Design as DesignPoint;
use crate::{Aim, Field, SweepError};

/// Spacing of the values between two ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Linear: equal differences.
    Lin,
    /// Logarithmic: equal ratios.
    Log,
}

/// Values of an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Values {
    /// Explicit list.
    List {
        /// Values in any order.
        values: Vec<f64>,
    },
    /// Interval: `count` values in a grid, or any value in a random or Sobol design.
    Range {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Number of values in a grid; 0 in the other designs.
        count: u64,
        /// Spacing.
        scale: Scale,
    },
}

/// Axis of a sweep: a parameter and its values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Parameter.
    pub name: Field,
    /// Its values.
    #[serde(flatten)]
    pub values: Values,
}

impl Axis {
    /// Number of values in a grid.
    pub fn count(&self) -> u64 {
        match &self.values {
            Values::List { values } => values.len() as u64,
            Values::Range { count, .. } => *count,
        }
    }

    /// Value with this index in a grid.
    pub fn value(&self, index: u64) -> f64 {
        match &self.values {
            Values::List { values } => usize::try_from(index)
                .ok()
                .and_then(|index| values.get(index))
                .copied()
                .unwrap_or(f64::NAN),
            Values::Range { count, to, .. } if *count > 1 && index + 1 == *count => *to,
            Values::Range { count, .. } => {
                self.between(index as f64 / count.saturating_sub(1).max(1) as f64)
            }
        }
    }

    /// Value at a fraction (0 to 1) of the interval.
    fn between(&self, share: f64) -> f64 {
        match &self.values {
            Values::List { .. } => f64::NAN,
            Values::Range {
                from, to, scale, ..
            } => match scale {
                Scale::Lin => from + (to - from) * share,
                Scale::Log => from * (to / from).powf(share),
            },
        }
    }
}

/// Selection of the designs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub enum Design {
    /// Every combination of the axes' values; the last axis changes fastest.
    Grid,
    /// Independent, uniformly distributed points.
    Random {
        /// Number of points.
        count: u64,
        /// Seed of the random numbers.
        seed: u64,
    },
    /// The first points of an Owen-scrambled Sobol sequence.
    Sobol {
        /// Number of points, at most [`Design::MOST_SOBOL`].
        count: u64,
        /// Seed of the scrambling.
        seed: u32,
    },
}

impl Design {
    /// Length of the sequence.
    pub const MOST_SOBOL: u64 = 1 << 16;
}

/// Bounds as a plan stores them; angles in rad, the clearance in m.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct KeptBounds {
    pub(crate) max_angle: Option<f64>,
    pub(crate) min_angle: Option<f64>,
    pub(crate) sector: bool,
    pub(crate) no_overlap: bool,
    pub(crate) clearance: f64,
}

impl From<KeptBounds> for Bounds {
    fn from(kept: KeptBounds) -> Self {
        Self {
            max_angle: kept.max_angle,
            min_angle: kept.min_angle,
            sector: kept.sector,
            no_overlap: kept.no_overlap || kept.clearance > 0.0,
            clearance: kept.clearance,
        }
    }
}

/// Content of a plan that is hashed and written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Content {
    pub(crate) format: String,
    pub(crate) version: String,
    pub(crate) objective: Aim,
    pub(crate) block: u64,
    pub(crate) anchor: u64,
    pub(crate) starts: Option<u32>,
    pub(crate) max_rate: Option<[f64; 2]>,
    /// Text of the swimmer file.
    pub(crate) swimmer: String,
    pub(crate) bounds: KeptBounds,
    pub(crate) design: Design,
    pub(crate) axis: Vec<Axis>,
}

/// First words of a plan's text.
pub(crate) const FORMAT: &str = "swimmer-sweep-plan 1";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Immutable plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    content: Content,
    text: String,
    hash: [u8; 32],
    base: SwimmerFile,
}

impl Plan {
    /// File name in the folder of a sweep.
    pub const FILE: &'static str = "plan.toml";

    /// Returns the plan of a spec. The path of a swimmer file is relative to the spec.
    ///
    /// # Errors
    /// [`SweepError::File`] with line, column and remedy.
    pub fn of_spec(text: &str, path: &Path) -> Result<Self, SweepError> {
        let mut content = crate::spec::read(text, path)?;
        FORMAT.clone_into(&mut content.format);
        VERSION.clone_into(&mut content.version);
        let text = toml::to_string(&content)
            .map_err(|error| FileError::at(path, 1, 1, error.to_string()))?;
        Self::of_text(text, path)
    }

    fn of_text(text: String, path: &Path) -> Result<Self, SweepError> {
        let content: Content = toml::from_str(&text).map_err(|error| {
            FileError::at(path, 1, 1, format!("this is no plan: {}", error.message()))
        })?;
        if content.version != VERSION || content.format != FORMAT {
            return Err(SweepError::OtherVersion {
                path: path.to_path_buf(),
                theirs: content.version,
                ours: VERSION.to_owned(),
            });
        }
        let base = SwimmerFile::parse(&content.swimmer, path)?;
        Ok(Self {
            hash: Sha256::digest(text.as_bytes()).into(),
            content,
            text,
            base,
        })
    }

    /// Writes the plan into the folder of a sweep, which is created if it is missing. An identical plan is left as it is.
    ///
    /// # Errors
    /// [`SweepError::OtherPlan`] if the folder has another plan, [`SweepError::Taken`] if it has other files, or the error of the file.
    pub fn save(&self, folder: &Path) -> Result<PathBuf, SweepError> {
        let path = folder.join(Self::FILE);
        if path.exists() {
            let there = Self::load(folder)?;
            return if there.hash == self.hash {
                Ok(path)
            } else {
                Err(SweepError::OtherPlan {
                    folder: folder.to_path_buf(),
                    there: there.hash(),
                    ours: self.hash(),
                })
            };
        }
        if fs::read_dir(folder).is_ok_and(|mut there| there.next().is_some()) {
            return Err(SweepError::Taken {
                folder: folder.to_path_buf(),
            });
        }
        let text = format!("# sha256 {}\n{}", self.hash(), self.text);
        write_atomically(&path, text.as_bytes())?;
        Ok(path)
    }

    /// Reads the plan of a folder.
    ///
    /// # Errors
    /// The plan is missing, was changed, or was made by another version.
    pub fn load(folder: &Path) -> Result<Self, SweepError> {
        let path = folder.join(Self::FILE);
        let text = fs::read_to_string(&path).map_err(|source| FileError::Read {
            path: path.clone(),
            source,
        })?;
        let (told, rest) = text
            .strip_prefix("# sha256 ")
            .and_then(|rest| rest.split_once('\n'))
            .ok_or_else(|| SweepError::Changed { path: path.clone() })?;
        let plan = Self::of_text(rest.to_owned(), &path);
        if hex(&Sha256::digest(rest.as_bytes())) != told {
            return Err(SweepError::Changed { path });
        }
        plan
    }

    /// Hash of the content, 64 hexadecimal digits.
    pub fn hash(&self) -> String {
        hex(&self.hash)
    }

    pub(crate) fn hash_bytes(&self) -> &[u8; 32] {
        &self.hash
    }

    /// Text without the hash.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    pub(crate) fn content(&self) -> &Content {
        &self.content
    }

    /// Objectives of the gaits; several if the objective is an axis.
    pub fn objectives(&self) -> Vec<Aim> {
        let mut axes = self.axes().iter();
        match axes.find(|axis| axis.name == Field::Objective) {
            Some(axis) => (0..axis.count())
                .filter_map(|index| Aim::of_index(axis.value(index)))
                .collect(),
            None => vec![self.content.objective],
        }
    }

    /// Name of the swimmer that the designs modify.
    pub fn swimmer_name(&self) -> &str {
        &self.base.name
    }

    /// Axes of the plan.
    pub fn axes(&self) -> &[Axis] {
        &self.content.axis
    }

    /// Selection of the designs.
    pub fn design(&self) -> Design {
        self.content.design
    }

    /// Number of designs; their keys are 0 … tasks − 1.
    pub fn tasks(&self) -> u64 {
        match self.content.design {
            Design::Grid => self.axes().iter().map(Axis::count).product(),
            Design::Random { count, .. } | Design::Sobol { count, .. } => count,
        }
    }

    /// Number of tasks of a block; the last block may have fewer.
    pub fn block_size(&self) -> u64 {
        self.content.block
    }

    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        self.tasks().div_ceil(self.content.block)
    }

    /// Keys of a block.
    pub fn keys(&self, block: u64) -> std::ops::Range<u64> {
        let from = block.saturating_mul(self.content.block);
        from.min(self.tasks())..from.saturating_add(self.content.block).min(self.tasks())
    }

    /// Index of a task's value on each axis of a grid; empty in the other designs.
    pub fn indices(&self, key: u64) -> Vec<u64> {
        if self.content.design != Design::Grid {
            return Vec::new();
        }
        let mut rest = key;
        let mut indices: Vec<u64> = self
            .axes()
            .iter()
            .rev()
            .map(|axis| {
                let index = rest % axis.count();
                rest /= axis.count();
                index
            })
            .collect();
        indices.reverse();
        indices
    }

    /// Values of the axes of a task.
    pub fn point(&self, key: u64) -> Vec<f64> {
        let axes = self.axes().iter();
        match self.content.design {
            Design::Grid => axes
                .zip(self.indices(key))
                .map(|(axis, index)| axis.value(index))
                .collect(),
            Design::Random { seed, .. } => {
                let mut draws = ChaCha8Rng::seed_from_u64(seed);
                // A number takes two words, so any point can be computed directly.
                draws.set_word_pos(2 * u128::from(key) * axes.len() as u128);
                axes.map(|axis| {
                    axis.between((draws.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
                })
                .collect()
            }
            Design::Sobol { seed, .. } => {
                let index = u32::try_from(key).unwrap_or(u32::MAX);
                axes.zip(0..)
                    .map(|(axis, dimension)| {
                        axis.between(f64::from(sobol_burley::sample(index, dimension, seed)))
                    })
                    .collect()
            }
        }
    }

    /// Design of a task.
    pub(crate) fn design_of(&self, key: u64) -> DesignPoint {
        let mut design = DesignPoint {
            swimmer: self.base.swimmer,
            bounds: self.content.bounds.into(),
            rates: self.content.max_rate,
            aim: self.content.objective,
        };
        for (axis, value) in self.axes().iter().zip(self.point(key)) {
            axis.name.set(&mut design, value);
        }
        design
    }
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
