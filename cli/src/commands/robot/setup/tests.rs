//! Every prompt of a set-up against y, n, text that is no answer, and the end of input; on a twin in virtual time.

use clap::Parser as _;
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
        let mut bench = Bench {
            line: &mut line,
            operator: &operator,
            interrupt: &interrupt,
            before,
        };
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
