//! Table of calls, and the state between calls.
//!
//! Each tab of the page adds its calls as one table (`[(&str, Call)]`) to `TABLES`. Objects that outlive a call, such as a session
//! or a robot, are stored in [`Lab::kept`], and the page refers to them by number.

use std::any::Any;
use std::collections::BTreeMap;

use serde::Serialize;
use serde::de::DeserializeOwned;

#[cfg(feature = "robot")]
use crate::calibration;
#[cfg(feature = "robot")]
use crate::drive;
#[cfg(feature = "explore")]
use crate::explore;

/// Output of a call.
#[derive(Debug, PartialEq)]
pub enum CallOutput {
    /// JSON document.
    Json(String),
    /// Numbers (little-endian) or a file, depending on the call.
    Bytes(Vec<u8>),
}

/// Output, or an error message of one sentence for the user.
pub type Outcome = Result<CallOutput, String>;

/// Call: takes the state and the bytes that the page wrote (JSON unless the call documents another format).
pub type Call = fn(&mut Lab, &[u8]) -> Outcome;

/// All calls, by tab.
const TABLES: &[&[(&str, Call)]] = &[
    #[cfg(feature = "explore")]
    explore::CALLS,
    #[cfg(feature = "robot")]
    drive::CALLS,
    #[cfg(feature = "robot")]
    calibration::CALLS,
];

/// State between calls.
#[derive(Default)]
pub struct Lab {
    /// Objects to which the page refers by number.
    pub kept: Kept,
    /// Last height map of the Explore tab.
    #[cfg(feature = "explore")]
    pub explore: explore::Memory,
}

/// Performs a call by name.
///
/// # Errors
/// The name is unknown, or the call fails.
pub fn call(lab: &mut Lab, name: &[u8], bytes: &[u8]) -> Outcome {
    let perform = TABLES
        .iter()
        .flat_map(|table| table.iter())
        .find_map(|(known, perform)| (known.as_bytes() == name).then_some(perform));
    match perform {
        Some(perform) => perform(lab, bytes),
        None => Err(format!(
            "calling `{}`: the module has no such call; page and module are of different versions",
            String::from_utf8_lossy(name)
        )),
    }
}

/// Parses the JSON arguments of a call.
///
/// # Errors
/// The JSON is invalid or lacks a key.
pub fn parsed<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    serde_json::from_slice(bytes).map_err(|why| format!("reading the page's request: {why}"))
}

/// Returns an output as JSON.
///
/// # Errors
/// A key is not a string.
pub fn json<T: Serialize>(output: &T) -> Outcome {
    serde_json::to_string(output)
        .map(CallOutput::Json)
        .map_err(|why| format!("writing the answer: {why}"))
}

/// Returns an output as consecutive numbers.
///
/// # Errors
/// Never fails; the type is that of a call.
pub fn numbers(values: impl IntoIterator<Item = f64>) -> Outcome {
    Ok(CallOutput::Bytes(
        values.into_iter().flat_map(f64::to_le_bytes).collect(),
    ))
}

/// Objects that outlive a call, by number.
#[derive(Default)]
pub struct Kept {
    things: BTreeMap<u32, Box<dyn Any>>,
    last: u32,
}

impl Kept {
    /// Stores an object and returns its number.
    pub fn keep<T: 'static>(&mut self, thing: T) -> u32 {
        self.last += 1;
        self.things.insert(self.last, Box::new(thing));
        self.last
    }

    /// Returns an object by its number.
    ///
    /// # Errors
    /// No object has this number and type.
    pub fn get<T: 'static>(&mut self, number: u32) -> Result<&mut T, String> {
        self.things
            .get_mut(&number)
            .and_then(|thing| thing.downcast_mut())
            .ok_or_else(|| format!("looking for number {number}: it is gone; open it again"))
    }

    /// Releases an object.
    pub fn drop(&mut self, number: u32) {
        self.things.remove(&number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_call_and_bad_json_say_so() {
        let mut lab = Lab::default();
        let reason = call(&mut lab, b"swim!", b"{}").unwrap_err();
        assert!(reason.contains("`swim!`"), "{reason}");
        let reason = call(&mut lab, b"simulate", b"{").unwrap_err();
        assert!(reason.contains("reading the page's request"), "{reason}");
    }

    #[test]
    fn names_are_given_once() {
        let mut names: Vec<_> = TABLES
            .iter()
            .flat_map(|table| table.iter())
            .map(|(name, _)| name)
            .collect();
        let all = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all);
    }

    #[test]
    fn what_is_kept_is_found_by_number_and_kind() {
        let mut kept = Kept::default();
        let number = kept.keep(String::from("twin"));
        assert_eq!(kept.get::<String>(number).unwrap(), "twin");
        assert!(kept.get::<u8>(number).is_err());
        kept.drop(number);
        assert!(kept.get::<String>(number).unwrap_err().contains("gone"));
    }
}
