//! Swimmers with a passive joint: one servo drives the other joint, and the passive one follows its spring.

use std::fmt;
use std::str::FromStr;

use passive_joint::{LimitCycle, PassiveError, PassiveJoint, Waveform, over_viscosity};
use swimmer_files::{GaitFile, GaitSpec, JointName, PassiveFile, Spring, SwimmerFile, parse_angle};
use swimmer_model::{Gait, Model};

use crate::source::curve;
use crate::{Context, Error, GaitSource, Subject, SwimmerSource, model, warn_if_for_another};

/// Largest amplitude of `sine:AMPLITUDE` \[rad\].
const LARGEST_AMPLITUDE: f64 = std::f64::consts::PI;
/// Samples of a limit cycle.
pub const SAMPLES: usize = 1024;

/// Motion of the servos: `sine:AMPLITUDE`, which drives one joint, or a gait.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// The driven joint follows `amplitude` cos 2πu.
    Sine {
        /// Amplitude \[rad\].
        amplitude: f64,
    },
    /// A gait. With a passive joint only the other joint of it is driven.
    Gait(GaitSpec),
    /// The same as samples.
    Samples(Box<GaitFile>),
}

/// Name of samples in messages.
const UNNAMED: &str = "the gait";

impl FromStr for Drive {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some(amplitude) = text.strip_prefix("sine:") else {
            return text
                .parse()
                .map(Self::Gait)
                .map_err(|error: swimmer_files::GaitSpecError| error.to_string());
        };
        let amplitude = parse_angle(amplitude).map_err(|error| format!("`{text}`: {error}"))?;
        if amplitude > 0.0 && amplitude <= LARGEST_AMPLITUDE {
            Ok(Self::Sine { amplitude })
        } else {
            Err(format!(
                "`{text}`: the amplitude is {amplitude} rad; it must be above 0 and at most {LARGEST_AMPLITUDE}"
            ))
        }
    }
}

impl Drive {
    /// The drive as people name it.
    pub fn readable(&self) -> String {
        match self {
            Self::Sine { amplitude } => {
                // A round number of degrees is printed as such.
                let circle = GaitSpec::Circle {
                    amplitude: *amplitude,
                    clockwise: false,
                };
                circle.readable().replacen("circle", "sine", 1)
            }
            Self::Gait(spec) => spec.readable(),
            Self::Samples(_) => UNNAMED.to_owned(),
        }
    }
}

impl fmt::Display for Drive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sine { amplitude } => write!(f, "sine:{amplitude:?}"),
            Self::Gait(spec) => spec.fmt(f),
            Self::Samples(_) => f.write_str(UNNAMED),
        }
    }
}

/// Passive joint of a request; the `[passive]` table of the swimmer file supplies what is missing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// The passive joint.
    pub joint: Option<JointName>,
    /// Its spring.
    pub spring: Option<Spring>,
}

impl Options {
    /// The passive joint with its spring. Returns `None` if neither request nor file names one.
    ///
    /// # Errors
    /// Only one of joint and spring is known.
    pub fn resolved(&self, file: &SwimmerFile) -> Result<Option<PassiveFile>, Error> {
        let in_file = file
            .passive
            .filter(|passive| self.joint.is_none_or(|joint| joint == passive.joint));
        let joint = self.joint.or(in_file.map(|passive| passive.joint));
        let spring = self.spring.or(in_file.map(|passive| passive.spring));
        match (joint, spring) {
            (Some(joint), Some(spring)) => Ok(Some(PassiveFile { joint, spring })),
            (None, None) => Ok(None),
            (Some(joint), None) => Err(Error::refused(format!(
                "the {joint} joint is passive: give its spring by --stiffness or --relaxation, or as [passive] in the swimmer file"
            ))),
            (None, Some(_)) => Err(Error::refused(
                "a spring needs its joint: add --passive front or --passive back",
            )),
        }
    }
}

/// Limit cycle of a passive joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// The passive joint with its spring over the cycle.
    pub passive: PassiveJoint,
    /// Passive angle at the start of the cycle \[rad\].
    pub start: f64,
    /// Relaxation time over the period.
    pub relaxation_share: f64,
}

impl Subject {
    /// Reads a swimmer and the motion of its servos; a passive joint responds in its limit cycle.
    ///
    /// # Errors
    /// A source cannot be read or is invalid, a sine has no passive joint, or the spring has no limit cycle.
    pub fn load_driven(
        swimmer: &SwimmerSource,
        drive: &Drive,
        options: &Options,
        period_s: f64,
        context: &mut Context,
    ) -> Result<Self, Error> {
        let file = swimmer.load(context)?;
        let elastic = options.resolved(&file)?;
        let Some(elastic) = elastic else {
            return Self::without_spring(file, drive, context);
        };
        let model = model(&file)?;
        let joint = elastic.joint.0;
        let over_viscosity = over_viscosity(elastic.spring, &model, joint, file.fluid.as_ref())?;
        let passive = PassiveJoint::new(joint, over_viscosity * period_s)?;
        let response = match drive {
            Drive::Sine { amplitude } => {
                let sine = Waveform::sine(*amplitude).driving(passive.driven());
                respond(&model, &sine, passive)?
            }
            Drive::Gait(spec) => {
                let gait = GaitSource::from(spec.clone()).load_for(&file, context)?;
                respond(&model, &gait, passive)?
            }
            Drive::Samples(samples) => {
                warn_if_for_another(&file, samples, UNNAMED, context);
                respond(&model, &curve(samples)?, passive)?
            }
        };
        let (samples, response) = response;
        Ok(Self {
            gait: curve(&samples)?,
            samples: Some(GaitFile {
                swimmer_name: Some(file.name.clone()),
                swimmer_hash: Some(file.hash()),
                ..samples
            }),
            response: Some(response),
            file,
            model,
        })
    }

    /// A gait as it is. A gait file may name a passive joint, whose response it holds.
    fn without_spring(
        file: SwimmerFile,
        drive: &Drive,
        context: &mut Context,
    ) -> Result<Self, Error> {
        let (gait, named) = match drive {
            Drive::Sine { .. } => {
                return Err(Error::refused(format!(
                    "{drive} drives one joint: name the passive one by --passive front or --passive back, and its spring by \
                     --stiffness or --relaxation"
                )));
            }
            Drive::Gait(spec) => {
                let source = GaitSource::from(spec.clone());
                let gait = source.load_for(&file, context)?;
                let named = match spec {
                    GaitSpec::File { .. } => source.file(context.files)?.passive,
                    GaitSpec::Circle { .. } | GaitSpec::Square { .. } => None,
                };
                (gait, named)
            }
            Drive::Samples(samples) => {
                warn_if_for_another(&file, samples, UNNAMED, context);
                (curve(samples)?, samples.passive)
            }
        };
        let model = model(&file)?;
        let response = named
            .map(|named| {
                let joint = named.joint.0;
                let passive = PassiveJoint::relaxing_in(&model, joint, named.relaxation)?;
                Ok::<_, PassiveError>(Response {
                    passive,
                    start: gait.at(0.0).phi[joint.index()],
                    relaxation_share: named.relaxation,
                })
            })
            .transpose()?;
        Ok(Self {
            file,
            model,
            gait,
            samples: None,
            response,
        })
    }
}

/// The limit cycle of a drive, as samples.
fn respond(
    model: &Model<f64>,
    drive: &impl Gait<f64>,
    passive: PassiveJoint,
) -> Result<(GaitFile, Response), Error> {
    let cycle = LimitCycle::new(model, drive, passive)?;
    let response = Response {
        passive,
        start: cycle.start(),
        relaxation_share: passive.relaxation_share(model),
    };
    Ok((cycle.gait_file(SAMPLES), response))
}

impl From<PassiveError> for Error {
    /// A search that does not converge was valid; everything else is bad input.
    fn from(error: PassiveError) -> Self {
        match error {
            PassiveError::NotConverged { .. } | PassiveError::NoOptimum { .. } => {
                Self::failed(&error)
            }
            _ => Self::bad_input(&error),
        }
    }
}
