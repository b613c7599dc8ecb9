//! A list of steps with a banner and the wall time of each, and a summary at the end.

use std::time::{Duration, Instant};

use crate::failure::Outcome;

/// Steps taken so far.
#[derive(Default)]
pub(crate) struct Steps {
    taken: Vec<(String, Duration)>,
}

impl Steps {
    /// Takes one step; a step that fails ends the chore.
    ///
    /// # Errors
    /// The step's own.
    pub(crate) fn take<T>(&mut self, name: &str, step: impl FnOnce() -> Outcome<T>) -> Outcome<T> {
        println!("\n==== {name} ====");
        let start = Instant::now();
        let outcome = step();
        let wall = start.elapsed();
        let verdict = if outcome.is_ok() { "ok" } else { "FAILED" };
        println!("==== {name}: {verdict} after {} ====", clock(wall));
        self.taken.push((name.to_owned(), wall));
        outcome
    }

    /// One line a step.
    pub(crate) fn summary(&self) -> String {
        let total = self.taken.iter().map(|(_, wall)| *wall).sum();
        let mut lines = String::new();
        for (name, wall) in self
            .taken
            .iter()
            .map(|(name, wall)| (name.as_str(), *wall))
            .chain([("all steps", total)])
        {
            lines.push_str(&line(name, wall));
        }
        lines
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
    use crate::failure::Failure;

    #[test]
    fn the_clock_is_read_by_people() {
        assert_eq!(clock(Duration::from_millis(3210)), "3.2 s");
        assert_eq!(clock(Duration::from_secs(65)), "1 m 05 s");
    }

    #[test]
    fn the_summary_names_each_step_and_the_whole() {
        let mut steps = Steps::default();
        assert_eq!(steps.take("one", || Ok(1)).unwrap(), 1);
        assert!(
            steps
                .take::<()>("two", || Err(Failure::new("a", "b", "c")))
                .is_err()
        );
        let summary = steps.summary();
        let names: Vec<_> = summary
            .lines()
            .map(|line| line.trim_start().split("  ").last().unwrap())
            .collect();
        assert_eq!(names, ["one", "two", "all steps"]);
    }
}
