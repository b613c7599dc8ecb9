//! `[reflectors] body`: the rigid body of a campaign.

use toml::Spanned;

use super::RigidBody;
use super::raw::{RawBody, RawBodyTable};
use crate::FileError;

/// Returns the rigid body.
///
/// # Errors
/// An empty name, a length or an angle that is not finite, or an unknown axis, at the body's place.
pub(super) fn body(
    raw: Spanned<RawBody>,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<RigidBody, FileError> {
    let place = raw.span().start;
    let table = match raw.into_inner() {
        RawBody::Name(name) => RawBodyTable {
            name,
            at: [0.0; 2],
            axis: None,
            heading_deg: 0.0,
        },
        RawBody::Table(table) => table,
    };
    if table.name.trim().is_empty() {
        let problem = "body is the name of a rigid body in the tracking file".to_owned();
        return Err(error(place, problem));
    }
    if !table.at.iter().all(|value| value.is_finite()) {
        let problem = format!("at = {:?} must be two finite lengths in metres", table.at);
        return Err(error(place, problem));
    }
    if !table.heading_deg.is_finite() {
        let problem = format!(
            "heading_deg = {} must be a finite angle in degrees",
            table.heading_deg
        );
        return Err(error(place, problem));
    }
    let axis = table.axis.as_deref().map(axis).transpose();
    Ok(RigidBody {
        name: table.name,
        at: table.at,
        axis: axis.map_err(|problem| error(place, problem))?,
        heading_rad: table.heading_deg.to_radians(),
    })
}

/// Parses `x`, `-z` and the like.
fn axis(text: &str) -> Result<(usize, f64), String> {
    let (letter, sign) = match text.trim().strip_prefix('-') {
        Some(rest) => (rest, -1.0),
        None => (text.trim().trim_start_matches('+'), 1.0),
    };
    let index = ["x", "y", "z"]
        .iter()
        .position(|axis| letter.eq_ignore_ascii_case(axis));
    index
        .map(|index| (index, sign))
        .ok_or_else(|| format!("axis = \"{text}\" is one of x, y, z, -x, -y and -z"))
}
