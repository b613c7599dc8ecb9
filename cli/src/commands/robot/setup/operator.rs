//! Dialogue with the operator at the bench: prints a question, reads a line, keeps the link alive meanwhile. A script may give
//! the answers.
//!
//! Nothing moves after an answer that is not understood: a confirmation accepts Enter or y alone, and repeats the question
//! otherwise.

use std::cell::RefCell;
use std::io::{self, BufRead as _, IsTerminal as _};
use std::str::FromStr;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crossterm::terminal;
use host_link::session::cause_in_words;
use link_protocol::{StateName, StopCause};
use textwrap::WordSplitter;

use super::super::access::{BEAT, RobotConnection};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Reason of a set-up that the operator left.
pub(super) const LEFT: &str = "left the setup";
/// Longest line of text, in columns.
const WIDEST: usize = 80;

/// Returns the answer to a question, once it is known.
#[cfg(test)]
type Person = Box<dyn FnMut(&str) -> Option<String>>;

/// Source of the answers.
enum Answers {
    /// Lines of the standard input, or of a script.
    Lines {
        lines: mpsc::Receiver<String>,
        /// Line that was read too early.
        kept: RefCell<Option<String>>,
    },
    /// An operator of a test, who reads the question, thinks, and answers.
    #[cfg(test)]
    Person(RefCell<Person>),
}

impl Answers {
    fn lines(lines: mpsc::Receiver<String>) -> Self {
        let kept = RefCell::default();
        Self::Lines { lines, kept }
    }

    /// The next line, if there is one.
    #[cfg_attr(not(test), allow(unused_variables))]
    fn next(&self, question: &str) -> Result<String, mpsc::TryRecvError> {
        match self {
            Self::Lines { lines, kept } => match kept.take() {
                Some(line) => Ok(line),
                None => lines.try_recv(),
            },
            #[cfg(test)]
            Self::Person(person) => {
                (person.borrow_mut())(question).ok_or(mpsc::TryRecvError::Empty)
            }
        }
    }

    /// Keeps a line for the next question.
    fn keep(&self, line: String) {
        match self {
            Self::Lines { kept, .. } => *kept.borrow_mut() = Some(line),
            #[cfg(test)]
            Self::Person(_) => {}
        }
    }
}

/// Operator at the bench, who watches the robot and answers questions.
pub(super) struct Operator {
    answers: Answers,
    interrupt: Interrupt,
    output: Output,
    /// The answers come from a script: they are printed, as a terminal shows typed ones.
    scripted: bool,
}

impl Operator {
    /// Reads answers from the standard input.
    pub(super) fn new(interrupt: Interrupt, output: Output) -> Self {
        let (sender, answers) = mpsc::channel();
        // Reads until the program ends: a blocking read cannot be cancelled.
        thread::spawn(move || {
            for line in io::stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self {
            answers: Answers::lines(answers),
            interrupt,
            output,
            scripted: !io::stdin().is_terminal(),
        }
    }

    /// Gives these answers, one after the other, and then none.
    #[cfg(test)]
    pub(super) fn with_script(answers: &[&str], output: Output) -> Self {
        let (sender, receiver) = mpsc::channel();
        for answer in answers {
            sender.send((*answer).to_owned()).unwrap();
        }
        Self {
            answers: Answers::lines(receiver),
            interrupt: Interrupt::default(),
            output,
            scripted: true,
        }
    }

    /// Asks this person, who returns `None` until there is an answer.
    #[cfg(test)]
    pub(super) fn with_person(
        person: impl FnMut(&str) -> Option<String> + 'static,
        output: Output,
    ) -> Self {
        Self {
            answers: Answers::Person(RefCell::new(Box::new(person))),
            interrupt: Interrupt::default(),
            output,
            scripted: true,
        }
    }

    /// Prints a text, wrapped at words.
    pub(super) fn tell(&self, text: &str) {
        self.output.line(&wrapped(text, width()));
    }

    /// Repeats a question until `read` accepts the answer. `armed`: the servos have power, and must keep it.
    ///
    /// # Errors
    /// [`Failure::Tried`] if the operator leaves, the answers end or the robot stops by itself.
    pub(super) fn ask<T>(
        &self,
        line: &mut RobotConnection,
        armed: bool,
        question: &str,
        read: impl Fn(&str) -> Result<T, String>,
    ) -> Outcome<T> {
        if !self.scripted {
            // Lines typed before the question was printed do not answer it.
            while self.answers.next("").is_ok() {}
        }
        self.tell(question);
        loop {
            let answer = self.answer(line, armed, question)?;
            if self.scripted {
                self.tell(&format!("> {answer}"));
            }
            if is_leave(&answer) {
                return Err(Failure::Tried(LEFT.to_owned()));
            }
            match read(&answer) {
                Ok(value) => return Ok(value),
                Err(problem) => self.tell(&problem),
            }
        }
    }

    /// Goes on only after Enter or y. `question` is answered by yes if it is safe to go on.
    ///
    /// # Errors
    /// The errors of the dialogue; [`Failure::Tried`] after n.
    pub(super) fn confirm(
        &self,
        line: &mut RobotConnection,
        armed: bool,
        question: &str,
    ) -> Outcome {
        let asked = format!("{question} [Enter or y: go on; n: leave]");
        let advice = "Nothing moves before Enter or y; n leaves the setup.";
        if self.ask(line, armed, &asked, |answer| {
            yes_or_no(answer, true, advice)
        })? {
            return Ok(());
        }
        Err(Failure::Tried(format!("left the setup at `{question}`")))
    }

    /// Asks a question with two answers; an empty answer is `standard`.
    ///
    /// # Errors
    /// The errors of the dialogue.
    pub(super) fn yes(
        &self,
        line: &mut RobotConnection,
        armed: bool,
        question: &str,
        standard: bool,
    ) -> Outcome<bool> {
        let choice = if standard { "[Y/n]" } else { "[y/N]" };
        self.ask(line, armed, &format!("{question} {choice}"), |answer| {
            yes_or_no(answer, standard, "Answer y or n.")
        })
    }

    /// Waits with the link kept alive.
    ///
    /// # Errors
    /// The errors of the dialogue.
    pub(super) fn wait(&self, line: &mut RobotConnection, armed: bool, time: Duration) -> Outcome {
        let mut waited = Duration::ZERO;
        while waited < time {
            self.beat(line, armed)?;
            waited += BEAT;
        }
        Ok(())
    }

    fn answer(&self, line: &mut RobotConnection, armed: bool, question: &str) -> Outcome<String> {
        loop {
            match self.answers.next(question) {
                Ok(answer) => return Ok(answer.trim().to_owned()),
                Err(mpsc::TryRecvError::Empty) => self.beat(line, armed)?,
                Err(mpsc::TryRecvError::Disconnected) => {
                    return Err(Failure::Tried(format!("nobody answered: {question}")));
                }
            }
        }
    }

    fn beat(&self, line: &mut RobotConnection, armed: bool) -> Outcome {
        if self.interrupt.requested() {
            return Err(Failure::Tried(format!(
                "{}: left the setup",
                self.interrupt.pressed()
            )));
        }
        let news = line.beat()?;
        match news.filter(|telemetry| armed && has_stopped(telemetry.state)) {
            Some(telemetry) => {
                let text = format!("the robot stopped: {}", cause_in_words(telemetry.cause));
                Err(match telemetry.cause {
                    StopCause::LinkLost => Failure::LinkLost(text),
                    _ => Failure::Tried(text),
                })
            }
            None => Ok(()),
        }
    }

    /// Returns `true` if the operator leaves: by Ctrl-C, by q, or at the end of the answers. Other lines that are typed are dropped,
    /// since no question waits for one; those of a script are answers to the questions that follow.
    pub(super) fn leaves(&self) -> bool {
        loop {
            match self.answers.next("") {
                Ok(answer) if is_leave(answer.trim()) => return true,
                Ok(answer) if self.scripted => {
                    self.answers.keep(answer);
                    return self.interrupt.requested();
                }
                Ok(_) => {}
                Err(mpsc::TryRecvError::Empty) => return self.interrupt.requested(),
                Err(mpsc::TryRecvError::Disconnected) => return true,
            }
        }
    }
}

/// Returns `true` if the pulses are off or about to go off. A robot that holds may still give the end of an earlier play as its cause.
fn has_stopped(state: StateName) -> bool {
    matches!(
        state,
        StateName::Stopped | StateName::EStopped | StateName::Stopping | StateName::Settling
    )
}

fn is_leave(answer: &str) -> bool {
    matches!(answer, "q" | "quit")
}

/// Columns of the terminal, at most [`WIDEST`].
fn width() -> usize {
    let columns = io::stdout()
        .is_terminal()
        .then(|| terminal::size().ok())
        .flatten()
        .map(|(columns, _)| usize::from(columns));
    columns.unwrap_or(WIDEST).clamp(20, WIDEST)
}

/// Breaks lines between words.
fn wrapped(text: &str, width: usize) -> String {
    let options = textwrap::Options::new(width)
        .word_splitter(WordSplitter::NoHyphenation)
        .break_words(false);
    textwrap::fill(text, options)
}

/// Returns `true` for y, `false` for n, and `standard` for an empty answer.
fn yes_or_no(answer: &str, standard: bool, advice: &str) -> Result<bool, String> {
    match answer.to_lowercase().as_str() {
        "" => Ok(standard),
        "n" | "no" => Ok(false),
        _ if takes_it(answer) => Ok(true),
        _ => Err(advice.to_owned()),
    }
}

/// Accepts the value that a question offers: Enter or y.
pub(super) fn takes_it(answer: &str) -> bool {
    matches!(answer.to_lowercase().as_str(), "" | "y" | "yes")
}

/// Parses an angle in degrees, with or without its unit, into radians.
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
    fn lines_break_between_words() {
        let text = "Put the horns on both servos.\nUse `--pulse-range`, 1400-1600.";
        for width in [20, 27, 80] {
            let wrapped = wrapped(text, width);
            assert!(
                wrapped.lines().all(|line| line.chars().count() <= width),
                "{wrapped}"
            );
            let words = |text: &str| {
                text.split_whitespace()
                    .map(str::to_owned)
                    .collect::<Vec<_>>()
            };
            assert_eq!(words(&wrapped), words(text));
        }
    }

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
