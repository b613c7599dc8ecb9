//! Orientation columns of a plain table: quaternions (`qx,qy,qz,qw`, `field.pose.orientation.x`, …) and yaw angles.

use crate::tracks::rotation::Rotation;

/// Words that stand for an orientation, and those that stand for the position that goes with it.
const ORIENTATION: [&str; 5] = ["orientation", "rotation", "quaternion", "quat", "rot"];
const POSITION: [&str; 4] = ["position", "translation", "pos", "trans"];
/// Names of an angle about the tank's normal.
const YAW: [&str; 5] = ["yaw", "theta", "θ", "heading", "psi"];
const SEPARATORS: [char; 6] = [' ', '_', '.', '-', ':', '/'];

/// An orientation among a table's columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RotationColumns {
    /// The name of its point; empty if the columns have none.
    stem: String,
    pub(super) rotation: Rotation,
    /// `true` if the angle has no stated unit.
    pub(super) without_unit: bool,
}

impl RotationColumns {
    /// Returns `true` if it belongs to the point of these position columns.
    pub(super) fn is_of(&self, point: &str) -> bool {
        without(point, &POSITION).eq_ignore_ascii_case(&self.stem)
    }
}

/// The name of a point without the word for its position: `field.pose.position` → `field.pose`.
pub(super) fn point_name(stem: &str) -> String {
    let name = without(stem, &POSITION);
    if name.is_empty() {
        stem.to_owned()
    } else {
        name
    }
}

/// A name without the last or first of these words and the separators there.
fn without(name: &str, words: &[&str]) -> String {
    let lower = name.to_lowercase();
    let whole = |cut: &str| cut.trim_matches(SEPARATORS).to_owned();
    for word in words {
        if let Some(rest) = lower.strip_suffix(word)
            && (rest.is_empty() || rest.ends_with(SEPARATORS))
        {
            return whole(name.get(..rest.len()).unwrap_or(""));
        }
        if let Some(rest) = lower.strip_prefix(word)
            && rest.starts_with(SEPARATORS)
        {
            return whole(name.get(name.len() - rest.len()..).unwrap_or(""));
        }
    }
    name.to_owned()
}

/// The orientations among columns of these names and units, and the columns that they take.
pub(super) fn orientations(names: &[(&str, Option<&str>)]) -> Vec<RotationColumns> {
    let mut found = Vec::new();
    for (name, _) in names {
        found.extend(quaternion(name, names));
    }
    for (column, (name, unit)) in names.iter().enumerate() {
        let lower = name.to_lowercase();
        if YAW.contains(&lower.as_str()) || without(name, &YAW) != *name {
            let stem = if YAW.contains(&lower.as_str()) {
                String::new()
            } else {
                without(name, &YAW)
            };
            let radians = match unit.map(str::to_lowercase).as_deref() {
                Some("deg" | "°" | "degree" | "degrees") => 1_f64.to_radians(),
                _ => 1.0,
            };
            found.push(RotationColumns {
                stem,
                rotation: Rotation::Yaw(column, radians),
                without_unit: unit.is_none(),
            });
        }
    }
    found
}

/// The quaternion whose real part is the column of this name.
fn quaternion(name: &str, names: &[(&str, Option<&str>)]) -> Option<RotationColumns> {
    let before = name.strip_suffix(['w', 'W'])?;
    let named = |letter: char| {
        let whole = format!("{before}{letter}");
        names
            .iter()
            .position(|(name, _)| name.eq_ignore_ascii_case(&whole))
    };
    let stem = match before.strip_suffix(['q', 'Q']) {
        Some(rest) if rest.is_empty() || rest.ends_with(SEPARATORS) => {
            without(rest.trim_end_matches(SEPARATORS), &ORIENTATION)
        }
        _ => {
            let whole = before.trim_end_matches(SEPARATORS);
            let rest = without(whole, &ORIENTATION);
            let is_word = rest != whole || ORIENTATION.contains(&whole.to_lowercase().as_str());
            is_word.then_some(rest)?
        }
    };
    let columns = [named('x')?, named('y')?, named('z')?, named('w')?];
    Some(RotationColumns {
        stem,
        rotation: Rotation::Quaternion(columns),
        without_unit: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &str) -> Vec<RotationColumns> {
        let names: Vec<(&str, Option<&str>)> = names.split(',').map(|name| (name, None)).collect();
        orientations(&names)
    }

    #[test]
    fn quaternions_and_yaws_have_their_points() {
        let [found] = &of(
            "time,field.pose.position.x,field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w",
        )[..] else {
            panic!()
        };
        assert!(found.is_of("field.pose.position"));
        assert_eq!(found.rotation, Rotation::Quaternion([2, 3, 4, 5]));
        let [found] = &of("t,x,y,z,qx,qy,qz,qw")[..] else {
            panic!()
        };
        assert!(found.is_of(""));
        let [a, b] = &of("t,a_x,a_y,a_yaw,b_x,b_y,yaw_b")[..] else {
            panic!()
        };
        assert!(a.is_of("a") && b.is_of("b") && !a.is_of("b"));
        assert_eq!(
            (&a.rotation, &b.rotation),
            (&Rotation::Yaw(3, 1.0), &Rotation::Yaw(6, 1.0))
        );
        assert!(of("t,x,y,window,narrow,w").is_empty());
        assert_eq!(point_name("field.pose.position"), "field.pose");
    }
}
