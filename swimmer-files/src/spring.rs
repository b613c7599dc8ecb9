//! Torsion spring of a passive joint, as swimmer files, gait files and flags give it.

use std::fmt;
use std::str::FromStr;

use link_protocol::Joint;

/// Strength of a torsion spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spring {
    /// Stiffness k \[N m/rad\]. It needs the viscosity of the fluid.
    Stiffness(f64),
    /// Relaxation time `μ W_pp(0)/k` of the joint on the straight swimmer \[s\].
    Relaxation(f64),
}

/// The `[passive]` table of a swimmer file: a joint with a spring in place of a servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassiveFile {
    /// The passive joint.
    pub joint: JointName,
    /// Its spring.
    pub spring: Spring,
}

/// The passive joint that a gait file names: its samples are the response of that joint, and the other joint is driven.
///
/// ```
/// use swimmer_files::GaitSpring;
///
/// let spring: GaitSpring = "back relaxation=0.35".parse().unwrap();
/// assert_eq!(spring.relaxation, 0.35);
/// assert_eq!(spring.to_string(), "back relaxation=0.35");
/// assert!("middle relaxation=0.35".parse::<GaitSpring>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaitSpring {
    /// The passive joint.
    pub joint: JointName,
    /// Relaxation time of the joint as a share of the period.
    pub relaxation: f64,
}

/// A joint with its word in files and on the command line, `front` or `back`.
///
/// ```
/// use link_protocol::Joint;
/// use swimmer_files::JointName;
///
/// assert_eq!("back".parse(), Ok(JointName(Joint::Back)));
/// assert_eq!(JointName(Joint::Front).to_string(), "front");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointName(pub Joint);

impl FromStr for JointName {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "front" => Ok(Self(Joint::Front)),
            "back" => Ok(Self(Joint::Back)),
            _ => Err("a joint is front or back"),
        }
    }
}

impl fmt::Display for JointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            Joint::Front => "front",
            Joint::Back => "back",
        })
    }
}

impl FromStr for GaitSpring {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let problem = "a passive joint is front or back, then relaxation=SHARE, a number above 0";
        let (joint, share) = text.split_once(" relaxation=").ok_or(problem)?;
        let relaxation: f64 = share.trim().parse().map_err(|_| problem)?;
        if !(relaxation > 0.0 && relaxation.is_finite()) {
            return Err(problem);
        }
        Ok(Self {
            joint: joint.trim().parse()?,
            relaxation,
        })
    }
}

impl fmt::Display for GaitSpring {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} relaxation={:?}", self.joint, self.relaxation)
    }
}
