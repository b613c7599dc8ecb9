//! Sequence of steps, each with a banner and its wall time, and a summary at the end.

use std::time::{Duration, Instant};

use crate::failure::{Failure, Outcome};

/// Completed steps.
#[derive(Default)]
pub(crate) struct Steps {
    taken: Vec<Step>,
}

struct Step {
    name: String,
    wall: Duration,
    failure: Option<Failure>,
}

impl Steps {
    /// Runs a step. Returns `None` if it fails; steps that need its result must then be skipped.
    pub(crate) fn take<T>(&mut self, name: &str, step: impl FnOnce() -> Outcome<T>) -> Option<T> {
        println!("\n==== {name} ====");
        let start = Instant::now();
        let outcome = step();
        let wall = start.elapsed();
        let verdict = if outcome.is_ok() { "ok" } else { "FAILED" };
        println!("==== {name}: {verdict} after {} ====", clock(wall));
        let (result, failure) = match outcome {
            Ok(result) => (Some(result), None),
            Err(failure) => (None, Some(failure)),
        };
        self.taken.push(Step {
            name: name.to_owned(),
            wall,
            failure,
        });
        result
    }

    /// Summary with one line per step.
    pub(crate) fn summary(&self) -> String {
        let mut lines = String::new();
        for step in &self.taken {
            let mark = if step.failure.is_some() {
                "  FAILED"
            } else {
                ""
            };
            lines.push_str(&line(&format!("{}{mark}", step.name), step.wall));
        }
        lines + &line("all steps", self.taken.iter().map(|step| step.wall).sum())
    }

    /// Returns an error if a step failed.
    ///
    /// # Errors
    /// The failures of all steps.
    pub(crate) fn verdict(self) -> Outcome {
        let count = self.taken.len();
        let failures: Vec<_> = self
            .taken
            .into_iter()
            .filter_map(|step| step.failure)
            .collect();
        if failures.is_empty() {
            return Ok(());
        }
        let why: Vec<_> = failures.iter().map(ToString::to_string).collect();
        Err(Failure::new(
            format!("testing: {} of {count} steps failed", failures.len()),
            format!("\n\n{}\n", why.join("\n\n")),
            "repeat the command after fixing them",
        ))
    }
}

fn line(name: &str, wall: Duration) -> String {
    format!("{:>9}  {name}\n", clock(wall))
}

/// `1 m 05 s`, or `3.2 s`.
fn clock(wall: Duration) -> String {
    let seconds = wall.as_secs();
    if seconds < 60 {
        format!("{:.1} s", wall.as_secs_f64())
    } else {
        format!("{} m {:02} s", seconds / 60, seconds % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_is_read_by_people() {
        assert_eq!(clock(Duration::from_millis(3210)), "3.2 s");
        assert_eq!(clock(Duration::from_secs(65)), "1 m 05 s");
    }

    #[test]
    fn the_summary_names_each_step_and_the_verdict_each_failure() {
        let mut steps = Steps::default();
        assert_eq!(steps.take("one", || Ok(1)), Some(1));
        assert_eq!(
            steps.take::<()>("two", || Err(Failure::new("a", "b", "c"))),
            None
        );
        let summary = steps.summary();
        let names: Vec<_> = summary
            .lines()
            .filter_map(|line| line.split("s  ").nth(1))
            .collect();
        assert_eq!(names, ["one", "two  FAILED", "all steps"]);
        let verdict = steps.verdict().unwrap_err().to_string();
        assert!(verdict.contains("1 of 2 steps failed"), "{verdict}");
        assert!(verdict.contains("a: b"), "{verdict}");
    }

    #[test]
    fn all_well_is_well() {
        let mut steps = Steps::default();
        steps.take("one", || Ok(()));
        assert!(steps.verdict().is_ok());
    }
}
