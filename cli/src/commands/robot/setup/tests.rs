//! Every prompt of a set-up against y, n, text that is no answer, and the end of input; on a twin in virtual time.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::rc::Rc;

use clap::Parser as _;
use host_link::Port;
use link_protocol::StateName;

use super::*;
use crate::output::capture;

#[derive(clap::Parser)]
struct Words {
    #[command(flatten)]
    access: Access,
    #[command(flatten)]
    setup: Setup,
}

/// Effect of one answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effect {
    /// The next prompt follows.
    GoesOn,
    /// The same prompt waits for another answer.
    AsksAgain,
    /// The set-up ends.
    Leaves,
}
use Effect::{AsksAgain, GoesOn, Leaves};

/// A prompt: its first words, an answer with which the set-up goes on, and the effects of y, n and `perhaps`.
struct Prompt(&'static str, &'static str, [Effect; 3]);

const CONFIRMS: [Effect; 3] = [GoesOn, Leaves, AsksAgain];
const VALUE: [Effect; 3] = [AsksAgain, AsksAgain, AsksAgain];
const OFFERS: [Effect; 3] = [GoesOn, AsksAgain, AsksAgain];

const PROMPTS: &[Prompt] = &[
    Prompt("Take the horns off", "", CONFIRMS),
    Prompt("The front servo turns", "", CONFIRMS),
    Prompt("Which one turned?", "none", VALUE),
    Prompt("The pulses are off: no servo turned", "y", CONFIRMS),
    Prompt("The front servo turns", "yes", CONFIRMS),
    Prompt("Which one turned?", "front", VALUE),
    Prompt("The back servo turns", "", CONFIRMS),
    Prompt("Which one turned?", "back", VALUE),
    Prompt("Both servos stand at their centres", "", CONFIRMS),
    Prompt("front, 1 of 4", "-24", VALUE),
    Prompt("front, 2 of 4", "-1", VALUE),
    Prompt("front, 3 of 4", "24", VALUE),
    Prompt("front, 4 of 4", "1", VALUE),
    Prompt("front: dead band", "", OFFERS),
    Prompt("front: how far", "60 60", OFFERS),
    Prompt("back, 1 of 4", "-24", VALUE),
    Prompt("back, 2 of 4", "-1", VALUE),
    Prompt("back, 3 of 4", "24", VALUE),
    Prompt("back, 4 of 4", "1", VALUE),
    Prompt("back: dead band", "", OFFERS),
    Prompt("back: how far", "60 60", OFFERS),
    Prompt(
        "Which swimmer is it? A preset (purcell, robot, robot-slender, elastic-tail)",
        "",
        OFFERS,
    ),
    Prompt("Are both links straight", "", CONFIRMS),
    // The swing is optional: its n passes over the two prompts of each joint.
    Prompt("Swing each joint once", "y", [GoesOn, GoesOn, AsksAgain]),
    Prompt("front: to ", "", CONFIRMS),
    Prompt("front: did it turn all the way", "", CONFIRMS),
    Prompt("back: to ", "", CONFIRMS),
    Prompt("back: did it turn all the way", "", CONFIRMS),
    Prompt("Write a swimmer file", "", [AsksAgain, GoesOn, AsksAgain]),
];

/// Result of a set-up with these answers.
struct Left {
    /// Error at its end; `None` after success.
    failure: Option<String>,
    printed: String,
    /// After the robot was left.
    state: StateName,
}

fn set_up(answers: &[&str]) -> Left {
    let words = Words::parse_from(["setup", "--port", "twin"]);
    let output = Output { json: false };
    let (left, printed) = capture(|| {
        let operator = Operator::with_script(answers, output);
        let mut line = words
            .access
            .connect("swimmer robot setup", Pace::AsFastAsPossible)
            .unwrap();
        let before = JOINTS.map(|joint| line.robot.servo(joint).unwrap());
        let interrupt = Interrupt::default();
        let mut bench = Bench::new(&words.access, &mut line, &operator, &interrupt, before);
        let done = bench.everything(&words.setup, None);
        let failure = done.err().map(|failure| failure.to_string());
        if failure.is_some() {
            bench.leave();
        }
        (failure, line.robot.status().unwrap().state)
    });
    Left {
        failure: left.0,
        printed: printed.document,
        state: left.1,
    }
}

/// The effect of `answer` to prompt `number`, where the answers end with it.
fn effect(number: usize, answer: &str) -> (Effect, Left) {
    let before = PROMPTS[..number].iter().map(|prompt| prompt.1);
    let answers: Vec<&str> = before.chain([answer]).collect();
    let left = set_up(&answers);
    let question = PROMPTS[number].0;
    let effect = match left.failure.as_deref() {
        None => GoesOn,
        Some(failure) => match failure.strip_prefix("nobody answered: ") {
            Some(waiting) if waiting.starts_with(question) => AsksAgain,
            Some(_) => GoesOn,
            None => Leaves,
        },
    };
    (effect, left)
}

#[test]
fn only_enter_or_y_go_on_at_every_prompt() {
    for (number, Prompt(question, _, effects)) in PROMPTS.iter().enumerate() {
        for (answer, expected) in ["y", "n", "perhaps"].into_iter().zip(effects) {
            let (effect, left) = effect(number, answer);
            let why = left.failure.as_deref().unwrap_or("done");
            assert_eq!(effect, *expected, "`{answer}` to `{question}`: {why}");
            assert_eq!(left.state, StateName::Stopped, "`{answer}` to `{question}`");
        }
    }
}

/// No prompt goes on when the input ends at it.
#[test]
fn the_end_of_input_leaves_at_every_prompt() {
    for (number, Prompt(question, ..)) in PROMPTS.iter().enumerate() {
        let answers: Vec<&str> = PROMPTS[..number].iter().map(|prompt| prompt.1).collect();
        let left = set_up(&answers);
        let failure = left.failure.unwrap();
        let waiting = failure.strip_prefix("nobody answered: ");
        assert!(
            waiting.is_some_and(|waiting| waiting.starts_with(question)),
            "at `{question}`: {failure}"
        );
        assert_eq!(left.state, StateName::Stopped);
    }
}

/// `no` to the first question started the pulses once.
#[test]
fn no_pulse_comes_before_the_horns_are_off() {
    for answers in [
        &["no", "", "", "", ""][..],
        &["n"],
        &["nope"],
        &["0"],
        &["yes no"],
        &[],
    ] {
        let left = set_up(answers);
        assert!(left.failure.is_some());
        assert!(!left.printed.contains("pulses begin"), "{answers:?}");
    }
    assert!(set_up(&["Y"]).printed.contains("pulses begin"));
}

#[test]
fn every_printed_line_fits_a_terminal() {
    let answers: Vec<&str> = PROMPTS.iter().map(|prompt| prompt.1).collect();
    let left = set_up(&answers);
    assert_eq!(left.failure, None);
    for line in left.printed.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

/// A port over which nothing passes from `from` to `to`, in either direction.
struct Stalling<P> {
    port: P,
    from: Duration,
    to: Duration,
}

impl<P: Port> Stalling<P> {
    fn is_stalled(&self) -> bool {
        (self.from..self.to).contains(&self.port.now())
    }
}

impl<P: Port> Port for Stalling<P> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let was_stalled = self.is_stalled();
        let count = self.port.read(buf, timeout)?;
        Ok(if was_stalled || self.is_stalled() {
            0
        } else {
            count
        })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.is_stalled() {
            return Ok(());
        }
        self.port.write(bytes)
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}

/// Takes no byte and has none, for the moment in which a port is wrapped.
struct NoPort;

impl Port for NoPort {
    fn read(&mut self, _: &mut [u8], _: Duration) -> io::Result<usize> {
        Ok(0)
    }

    fn write(&mut self, _: &[u8]) -> io::Result<()> {
        Ok(())
    }

    fn now(&self) -> Duration {
        Duration::ZERO
    }
}

/// Calls of a person for the same question before the answer: half a second of beats.
const THINKS: u32 = 25;

/// Answers by the words of a question, after a while; counts the answers.
fn person(
    answered: &Rc<RefCell<BTreeMap<String, u32>>>,
) -> impl FnMut(&str) -> Option<String> + use<> {
    let answered = Rc::clone(answered);
    let (mut thinking, mut turning) = (0, "front");
    move |question| {
        thinking = (thinking + 1) % THINKS;
        if thinking > 0 || question.is_empty() {
            return None;
        }
        *answered
            .borrow_mut()
            .entry(question.to_owned())
            .or_default() += 1;
        for joint in ["front", "back"] {
            if question.starts_with(&format!("The {joint} servo turns")) {
                turning = joint;
            }
        }
        let known = PROMPTS
            .iter()
            .rev()
            .find(|prompt| question.starts_with(prompt.0));
        Some(
            match known {
                Some(Prompt("Which one turned?", ..)) => turning,
                Some(prompt) => prompt.1,
                None => "",
            }
            .to_owned(),
        )
    }
}

/// Result of a set-up whose link stalls.
struct Stalled {
    done: Option<String>,
    printed: String,
    answered: BTreeMap<String, u32>,
    maps: [ServoSettings; 2],
    /// At the end, on the port's clock.
    now: Duration,
}

/// Sets a twin up while its link stalls for three seconds from `from` on.
fn set_up_with_stall(from: Duration) -> Stalled {
    let words = Words::parse_from(["setup", "--port", "twin"]);
    let output = Output { json: false };
    let answered = Rc::default();
    let ((done, maps, now), printed) = capture(|| {
        let operator = Operator::with_person(person(&answered), output);
        let mut line = words
            .access
            .connect("swimmer robot setup", Pace::AsFastAsPossible)
            .unwrap();
        let before = JOINTS.map(|joint| line.robot.servo(joint).unwrap());
        let port = std::mem::replace(line.robot.port_mut(), Box::new(NoPort));
        let to = from.saturating_add(Duration::from_secs(3));
        *line.robot.port_mut() = Box::new(Stalling { port, from, to });
        let interrupt = Interrupt::default();
        let mut bench = Bench::new(&words.access, &mut line, &operator, &interrupt, before);
        let done = bench.everything(&words.setup, None);
        let done = done.map(|done| done.to_string());
        let maps = JOINTS.map(|joint| line.robot.servo(joint).unwrap());
        let status = line.robot.status().unwrap();
        assert_eq!(status.state, StateName::Stopped);
        (
            done.map_err(|failure| failure.to_string()),
            maps,
            line.robot.port().now(),
        )
    });
    assert!(
        done.is_ok(),
        "{done:?} after a stall at {from:?}: {}",
        printed.document
    );
    Stalled {
        done: done.ok(),
        printed: printed.document,
        answered: answered.take(),
        maps,
        now,
    }
}

/// A stall at any time: the set-up goes on with the answers so far, and comes to the same maps. Only consent to a motion that was
/// interrupted is given twice.
#[test]
fn a_link_that_stalls_is_waited_for_and_no_answer_is_lost() {
    let smooth = set_up_with_stall(Duration::MAX);
    assert!(!smooth.printed.contains("The link was lost"));
    let (mut start, mut lost) = (Duration::from_millis(700), 0);
    while start < smooth.now {
        let stalled = set_up_with_stall(start);
        assert_eq!(stalled.done, smooth.done, "a stall at {start:?}");
        assert_eq!(stalled.maps, smooth.maps, "a stall at {start:?}");
        for (question, count) in &smooth.answered {
            let again = stalled.answered.get(question).copied().unwrap_or(0);
            // A motion that was interrupted is repeated only after another consent.
            let is_consent = question.contains("Is the way free?");
            assert!(
                again == *count || is_consent && again == count + 1,
                "`{question}` was answered {again} times instead of {count} with a stall at {start:?}"
            );
        }
        lost += u32::from(stalled.printed.contains("The link was lost"));
        start += Duration::from_millis(1_700);
    }
    assert!(lost > 10, "{lost} stalls were seen");
}
