//! The table of calls, and what lives from one call to the next.
//!
//! A room of the page adds its calls as one table of its own (`[(&str, Call)]`) to `TABLES`. What must live longer than a call
//! (a session, a robot) is put into [`Lab::kept`] and known to the page by its number.

use std::any::Any;
use std::collections::BTreeMap;

use serde::Serialize;
use serde::de::DeserializeOwned;

#[cfg(feature = "calibrate")]
use crate::calibration;
#[cfg(feature = "drive")]
use crate::drive;
#[cfg(feature = "explore")]
use crate::explore;

/// What a call answers.
#[derive(Debug, PartialEq)]
pub enum Answer {
    /// One JSON document.
    Json(String),
    /// Numbers or a file, as the call tells: little-endian.
    Bytes(Vec<u8>),
}

/// Answered, or the reason why not, in one sentence for the reader.
pub type Outcome = Result<Answer, String>;

/// A call: what lives on, and the bytes that the page wrote (JSON unless the call says otherwise).
pub type Call = fn(&mut Lab, &[u8]) -> Outcome;

/// Every call, room by room.
const TABLES: &[&[(&str, Call)]] = &[
    #[cfg(feature = "explore")]
    explore::CALLS,
    #[cfg(feature = "drive")]
    drive::CALLS,
    #[cfg(feature = "calibrate")]
    calibration::CALLS,
];

/// What lives from one call to the next.
#[derive(Default)]
pub struct Lab {
    /// Things that the page knows by number.
    pub kept: Kept,
    /// What explore has read and mapped last.
    #[cfg(feature = "explore")]
    pub explore: explore::Memory,
}

/// Performs a call by name.
///
/// # Errors
/// No call has the name, or the call itself has a reason.
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

/// The JSON that a call takes.
///
/// # Errors
/// It is none, or lacks a key.
pub fn parsed<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    serde_json::from_slice(bytes).map_err(|why| format!("reading what the page asked: {why}"))
}

/// The answer as JSON.
///
/// # Errors
/// A key is no text.
pub fn json<T: Serialize>(answer: &T) -> Outcome {
    serde_json::to_string(answer)
        .map(Answer::Json)
        .map_err(|why| format!("writing the answer: {why}"))
}

/// The answer as numbers, one behind the other.
///
/// # Errors
/// None; the type is that of a call.
pub fn numbers(values: impl IntoIterator<Item = f64>) -> Outcome {
    Ok(Answer::Bytes(
        values.into_iter().flat_map(f64::to_le_bytes).collect(),
    ))
}

/// Things that outlive a call, by number.
#[derive(Default)]
pub struct Kept {
    things: BTreeMap<u32, Box<dyn Any>>,
    last: u32,
}

impl Kept {
    /// Keeps a thing and numbers it.
    pub fn keep<T: 'static>(&mut self, thing: T) -> u32 {
        self.last += 1;
        self.things.insert(self.last, Box::new(thing));
        self.last
    }

    /// A thing by its number.
    ///
    /// # Errors
    /// There is none of that number and kind.
    pub fn get<T: 'static>(&mut self, number: u32) -> Result<&mut T, String> {
        self.things
            .get_mut(&number)
            .and_then(|thing| thing.downcast_mut())
            .ok_or_else(|| format!("looking for number {number}: it is gone; open it again"))
    }

    /// Lets go of a thing.
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
        assert!(reason.contains("reading what the page asked"), "{reason}");
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
