//! Evaluation of tracked cycles on a thread of its own.
//!
//! Naming a departure compares a cycle with many courses, which may take longer than the robot waits for a keep-alive. The thread
//! that holds the link goes on meanwhile.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use experiment::{Evaluated, Evaluation};

use crate::failure::{Failure, Outcome};

/// Thread that evaluates cycles, one after the other.
#[derive(Debug)]
pub(super) struct Evaluator {
    cycles: Sender<Box<Evaluation>>,
    results: Receiver<Evaluated>,
    outstanding: usize,
}

impl Evaluator {
    /// Starts the thread. It ends with this value.
    ///
    /// # Errors
    /// [`Failure::Tried`] if the system starts no thread.
    pub(super) fn start(
        evaluate: impl Fn(Evaluation) -> Evaluated + Send + 'static,
    ) -> Outcome<Self> {
        let (cycles, to_evaluate) = channel::<Box<Evaluation>>();
        let (done, results) = channel();
        let run = move || {
            for evaluation in to_evaluate {
                if done.send(evaluate(*evaluation)).is_err() {
                    break;
                }
            }
        };
        thread::Builder::new()
            .name("evaluation of cycles".to_owned())
            .spawn(run)
            .map_err(|error| {
                Failure::Tried(format!(
                    "cannot start a thread that evaluates the cycles: {error}"
                ))
            })?;
        Ok(Self {
            cycles,
            results,
            outstanding: 0,
        })
    }

    /// Queues a cycle.
    ///
    /// # Errors
    /// [`Failure::Tried`] if the thread has ended.
    pub(super) fn submit(&mut self, evaluation: Box<Evaluation>) -> Outcome {
        self.cycles.send(evaluation).map_err(|_| ended())?;
        self.outstanding += 1;
        Ok(())
    }

    /// Results that are there, in the order of the cycles.
    pub(super) fn take(&mut self) -> Vec<Evaluated> {
        let results: Vec<Evaluated> = self.results.try_iter().collect();
        self.outstanding = self.outstanding.saturating_sub(results.len());
        results
    }

    /// Waits for the results of all cycles.
    ///
    /// # Errors
    /// [`Failure::Tried`] if the thread has ended.
    pub(super) fn wait(&mut self) -> Outcome<Vec<Evaluated>> {
        let mut results = Vec::with_capacity(self.outstanding);
        while self.outstanding > 0 {
            results.push(self.results.recv().map_err(|_| ended())?);
            self.outstanding -= 1;
        }
        Ok(results)
    }
}

fn ended() -> Failure {
    Failure::Tried("the evaluation of cycles has ended by an error of this program".to_owned())
}
