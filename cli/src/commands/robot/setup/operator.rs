//! Questions to whoever stands at the bench: a line out, a line in, and the link kept while nobody answers. The answers may
//! come from a script.

use std::io::{self, BufRead as _, IsTerminal as _};
use std::str::FromStr;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use host_link::robot::await_play::at_rest;
use host_link::session::cause_in_words;

use super::super::access::{BEAT, Line};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Someone who looks at the robot and answers.
pub(super) struct Operator {
    answers: mpsc::Receiver<String>,
    interrupt: Interrupt,
    output: Output,
    /// A script's answers are shown, as a terminal shows what is typed.
    echoes: bool,
}

impl Operator {
    /// Listens to the standard input.
    pub(super) fn new(interrupt: Interrupt, output: Output) -> Self {
        let (sender, answers) = mpsc::channel();
        // It reads until the program ends; nobody can be made to answer.
        thread::spawn(move || {
            for line in io::stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self {
            answers,
            interrupt,
            output,
            echoes: !io::stdin().is_terminal(),
        }
    }

    /// Says something.
    pub(super) fn tell(&self, text: &str) {
        self.output.line(text);
    }

    /// Asks until the answer makes sense. `armed`: the servos have power, and are to keep it.
    ///
    /// # Errors
    /// [`Failure::Tried`] where the operator leaves, the answers end or the robot stops by itself.
    pub(super) fn ask<T>(
        &self,
        line: &mut Line,
        armed: bool,
        question: &str,
        read: impl Fn(&str) -> Result<T, String>,
    ) -> Outcome<T> {
        self.tell(question);
        loop {
            let answer = self.answer(line, armed, question)?;
            if self.echoes {
                self.tell(&format!("> {answer}"));
            }
            if matches!(answer.as_str(), "q" | "quit") {
                return Err(Failure::Tried("left the setup".to_owned()));
            }
            match read(&answer) {
                Ok(value) => return Ok(value),
                Err(problem) => self.tell(&problem),
            }
        }
    }

    /// Waits for Enter.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub(super) fn confirm(&self, line: &mut Line, armed: bool, text: &str) -> Outcome {
        self.ask(line, armed, &format!("{text} [Enter]"), |_| Ok(()))
    }

    /// A question with two answers; an empty one is `standard`.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub(super) fn yes(
        &self,
        line: &mut Line,
        armed: bool,
        question: &str,
        standard: bool,
    ) -> Outcome<bool> {
        let choice = if standard { "[Y/n]" } else { "[y/N]" };
        self.ask(
            line,
            armed,
            &format!("{question} {choice}"),
            |answer| match answer.to_lowercase().as_str() {
                "" => Ok(standard),
                "y" | "yes" => Ok(true),
                "n" | "no" => Ok(false),
                _ => Err("Answer y or n.".to_owned()),
            },
        )
    }

    /// Lets time pass with the link kept.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub(super) fn wait(&self, line: &mut Line, armed: bool, time: Duration) -> Outcome {
        let mut waited = Duration::ZERO;
        while waited < time {
            self.beat(line, armed)?;
            waited += BEAT;
        }
        Ok(())
    }

    fn answer(&self, line: &mut Line, armed: bool, question: &str) -> Outcome<String> {
        loop {
            match self.answers.try_recv() {
                Ok(answer) => return Ok(answer.trim().to_owned()),
                Err(mpsc::TryRecvError::Empty) => self.beat(line, armed)?,
                Err(mpsc::TryRecvError::Disconnected) => {
                    return Err(Failure::Tried(format!("nobody answered: {question}")));
                }
            }
        }
    }

    fn beat(&self, line: &mut Line, armed: bool) -> Outcome {
        if self.interrupt.requested() {
            return Err(Failure::Tried(format!(
                "{}: left the setup",
                self.interrupt.pressed()
            )));
        }
        let news = line.beat()?;
        match news.filter(|told| armed && at_rest(told.state, told.cause)) {
            Some(told) => Err(Failure::Tried(format!(
                "the robot stopped: {}",
                cause_in_words(told.cause)
            ))),
            None => Ok(()),
        }
    }
}

/// An angle in degrees, with or without its unit; in radians.
pub(super) fn degrees(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches("deg").trim_end_matches('°').trim();
    f64::from_str(number)
        .ok()
        .filter(|degrees| degrees.abs() <= 360.0)
        .map(f64::to_radians)
        .ok_or_else(|| "Write an angle in degrees, as 12 or -7.5.".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_at_the_bench_are_degrees() {
        for text in ["-7.5", "-7.5deg", "-7.5°", " -7.5 "] {
            assert!((degrees(text.trim()).unwrap().to_degrees() + 7.5).abs() < 1e-12);
        }
        for text in ["", "left", "nan", "1000", "1rad"] {
            assert!(degrees(text).is_err(), "{text}");
        }
    }
}
