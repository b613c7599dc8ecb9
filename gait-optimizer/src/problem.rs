//! Validation shared by all searches: the swimmer, and bounds that suit the class of gaits.

use swimmer_files::Bounds;
use swimmer_model::{InvalidSwimmer, Links, Model, Swimmer};

use crate::region::Region;

/// Invalid input of an optimisation problem.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidProblem {
    /// The swimmer's parameters are out of range.
    #[error("cannot optimise this swimmer: {0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// A gait with the paper's two symmetries rests on front and back links being alike.
    #[error(
        "the side links differ ({}): a gait with the paper's two symmetries needs them alike; `swimmer atlas` \
         finds gaits of swimmers like this",
        difference(*front, *back)
    )]
    Asymmetric {
        /// l₁ \[m\].
        front: f64,
        /// l₂ \[m\].
        back: f64,
    },
    /// A bound on an angle makes no sense.
    #[error("{name} = {value} rad: {problem}")]
    Bound {
        /// Which.
        name: &'static str,
        /// Its value \[rad\].
        value: f64,
        /// Violated requirement.
        problem: &'static str,
    },
    /// A clearance that no shape can have.
    #[error(
        "clearance = {value} m: the side links hang {middle} m apart on the middle link, so their clearance must be below \
         that and not below 0"
    )]
    Clearance {
        /// Its value \[m\].
        value: f64,
        /// l₀ \[m\].
        middle: f64,
    },
    /// A bound on quarters, for gaits that are not made of four like ones or have none of this kind.
    #[error(
        "`{name}` bounds the quarters of a displacement gait with the paper's symmetries; leave it out here: this takes a largest \
         angle and links kept from crossing"
    )]
    QuarterBound {
        /// Which.
        name: &'static str,
    },
}

/// Difference of the side links: in length, or else in drag.
fn difference(front: f64, back: f64) -> String {
    if (front - back).abs() <= 1e-12 * front.abs() {
        format!("in drag, both {front} m long")
    } else {
        format!("front {front} m, back {back} m")
    }
}

/// Class of gaits that a problem is restricted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GaitClass {
    /// Made of four like quarters, which may have bounds of their own.
    Quarters,
    /// With the paper's symmetries, bounded as closed curves are.
    Symmetric,
    /// Any closed curve.
    Closed,
}

/// The swimmer with L = 1, of a problem that makes sense.
pub(crate) fn validated(
    swimmer: &Swimmer<f64>,
    bounds: &Bounds,
    class: GaitClass,
) -> Result<Model<f64>, InvalidProblem> {
    let Links {
        front,
        back,
        middle,
    } = swimmer.links;
    let model = Model::new(&swimmer.of_unit_length())?;
    swimmer.check_regular()?;
    if class != GaitClass::Closed && !swimmer.is_symmetric() {
        return Err(InvalidProblem::Asymmetric { front, back });
    }
    if class == GaitClass::Quarters {
        lower_bound(bounds)?;
    } else if bounds.min_angle.is_some() || bounds.sector {
        let name = if bounds.sector { "sector" } else { "min_angle" };
        return Err(InvalidProblem::QuarterBound { name });
    }
    let problem = "an upper bound must be above 0 and at most one turn, 6.283 rad";
    if let Some(value) = bounds.max_angle
        && !(value > 0.0 && value <= Region::HORIZON)
    {
        return Err(InvalidProblem::Bound {
            name: "max_angle",
            value,
            problem,
        });
    }
    let value = bounds.clearance;
    if !(value >= 0.0 && value < middle) {
        return Err(InvalidProblem::Clearance { value, middle });
    }
    Ok(model)
}

fn lower_bound(bounds: &Bounds) -> Result<(), InvalidProblem> {
    let Some(value) = bounds.min_angle else {
        return Ok(());
    };
    let problem = if !(value > 0.0 && value < Region::HORIZON) {
        "a lower bound must be above 0 and below one turn"
    } else if bounds.max_angle.is_some_and(|max| value >= max) {
        "the lower bound must be below the upper one"
    } else {
        return Ok(());
    };
    Err(InvalidProblem::Bound {
        name: "min_angle",
        value,
        problem,
    })
}
