//! An example at the end of each command's help.

use clap::Command;

/// The words of a command, and what is typed after `swimmer`.
pub(super) const EXAMPLES: [(&str, &str); 62] = [
    ("demo", "demo --swimmer robot -o demo"),
    (
        "simulate",
        "simulate --swimmer robot --gait circle:70deg --picture way.svg",
    ),
    (
        "optimize displacement",
        "optimize displacement --swimmer robot --max-angle 2.8 -o best.gait",
    ),
    (
        "optimize efficiency",
        "optimize efficiency --swimmer purcell --gait large",
    ),
    (
        "optimize turning",
        "optimize turning --swimmer robot --max-angle 2.8 --no-overlap -o left.gait",
    ),
    (
        "optimize sideways",
        "optimize sideways --swimmer robot --max-angle 2.8",
    ),
    (
        "optimize speed",
        "optimize speed --swimmer robot --max-rate 60deg --max-angle 2.8 -o fast.gait",
    ),
    (
        "optimize steer",
        "optimize steer --swimmer robot --playable -o gaits",
    ),
    (
        "optimize passive",
        "optimize passive --swimmer elastic-tail --max-angle 1 -o tail.gait",
    ),
    (
        "atlas",
        "atlas --swimmer robot --objective efficiency --max-angle 2.8 --no-overlap",
    ),
    ("certify", "certify --swimmer robot --gait best.gait"),
    (
        "height-map",
        "height-map --swimmer robot -o map.svg --gait best.gait",
    ),
    ("lab", "lab --port twin"),
    ("sweep plan", "sweep plan morphology.toml -o morphology"),
    ("sweep run", "sweep run morphology --shard 2/7"),
    ("sweep status", "sweep status morphology"),
    (
        "sweep merge",
        "sweep merge morphology -o morphology.parquet",
    ),
    (
        "sweep map",
        "sweep map morphology --across links.ratio --up sphere.radius -o map.svg",
    ),
    (
        "sweep submit slurm",
        "sweep submit slurm morphology --shards 64 --cores 4 --submit",
    ),
    ("paper", "paper -o paper"),
    (
        "plan",
        "plan --swimmer robot --playable --gaits gaits --to 0.2,0.1,90deg --tank 1.0x0.6",
    ),
    ("swimmers", "swimmers robot"),
    ("gaits", "gaits"),
    ("completions", "completions bash"),
    ("man", "man -o man1"),
    ("experiment plan", "experiment plan missing.toml"),
    (
        "experiment run",
        "experiment run missing.toml --port twin --track twin",
    ),
    ("experiment status", "experiment status missing.toml"),
    ("experiment report", "experiment report missing.toml"),
    ("experiment pack", "experiment pack missing"),
    ("robot info", "robot info --port /tmp/robot"),
    ("robot status", "robot status --port /tmp/robot --json"),
    (
        "robot configure",
        "robot configure --swimmer ours.toml --port /tmp/robot",
    ),
    (
        "robot upload",
        "robot upload best.gait --dry-run --swimmer robot --tank 1.0x0.6",
    ),
    ("robot arm", "robot arm --port /tmp/robot"),
    (
        "robot play",
        "robot play --gait circle:70deg --cycles 3 --period 30 --port /tmp/robot",
    ),
    (
        "robot go",
        "robot go --port twin --track twin --tank 1.2x1.2 --to 0.1,-0.05,90deg --gaits gaits",
    ),
    ("robot pause", "robot pause --detach --port /tmp/robot"),
    ("robot resume", "robot resume --port /tmp/robot"),
    ("robot stop", "robot stop --port /tmp/robot"),
    ("robot estop", "robot estop --clear --port /tmp/robot"),
    ("robot trim", "robot trim --front 2deg --port /tmp/robot"),
    ("robot servo", "robot servo front --port /tmp/robot"),
    ("robot setup", "robot setup -o ours.toml --port /tmp/robot"),
    ("robot flash", "robot flash robot.uf2"),
    ("robot watch", "robot watch --port /tmp/robot"),
    (
        "robot log",
        "robot log run.mcap --seconds 60 --port /tmp/robot",
    ),
    ("robot hc05", "robot hc05 --port /dev/ttyUSB0"),
    (
        "robot key make",
        "robot key make robot.key --port /tmp/robot",
    ),
    ("robot key set", "robot key set robot.key --port /tmp/robot"),
    (
        "robot key clear",
        "robot key clear --key robot.key --port /tmp/robot",
    ),
    ("robot key", "robot key make robot.key --port /tmp/robot"),
    ("robot replay", "robot replay run.mcap"),
    (
        "twin",
        "twin --pty /tmp/robot --faults drop=5% --track run.csv",
    ),
    ("calibrate", "calibrate campaign.toml -o fit"),
    ("track", "track natnet:192.168.1.10 -o run.csv"),
    ("tracks", "tracks run.csv"),
    ("optimize", "optimize displacement --swimmer purcell"),
    ("robot", "robot stop --port /tmp/robot"),
    ("experiment", "experiment plan missing.toml"),
    ("sweep", "sweep plan morphology.toml -o morphology"),
    ("sweep submit", "sweep submit slurm morphology --shards 64"),
];

/// The command with an example at the end of each help that has none.
pub(super) fn with_examples(command: Command) -> Command {
    within(command, "")
}

fn within(command: Command, words: &str) -> Command {
    let example = EXAMPLES
        .iter()
        .find_map(|(of, example)| (*of == words).then_some(example));
    let command = match example {
        Some(example) if command.get_after_help().is_none() => {
            command.after_help(format!("Example: swimmer {example}"))
        }
        _ => command,
    };
    command.mut_subcommands(|inner| {
        let name = inner.get_name().to_owned();
        within(inner, format!("{words} {name}").trim_start())
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::commands::command;

    /// The reference of the book lists every command with its purpose, and one of its pages holds the help of each. That the help
    /// is up to date is checked by the transcripts.
    #[test]
    fn every_command_has_its_help_in_the_book() {
        let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference");
        let index = std::fs::read_to_string(reference.join("commands.md")).unwrap();
        let mut book = index.clone();
        for page in std::fs::read_dir(reference.join("commands")).unwrap() {
            book += &std::fs::read_to_string(page.unwrap().path()).unwrap();
        }
        let mut left = vec![("swimmer".to_owned(), command())];
        while let Some((words, inner)) = left.pop() {
            assert!(
                book.contains(&format!("\n$ {words} --help\n")),
                "no page of docs/reference/commands has `$ {words} --help`"
            );
            let row = index
                .lines()
                .find(|row| row.starts_with(&format!("| [`{words}`](")));
            let purpose = inner.get_about().unwrap().to_string().replace('|', "\\|");
            assert!(
                words == "swimmer"
                    || row.is_some_and(|row| row.ends_with(&format!("| {purpose} |"))),
                "docs/reference/commands.md has no row `{words}` with its purpose, {purpose}"
            );
            left.extend(inner.get_subcommands().map(|inner| {
                let words = format!("{words} {}", inner.get_name());
                (words, inner.clone())
            }));
        }
    }

    /// Every command that does something has one, and each is understood.
    #[test]
    fn every_command_has_an_example_that_can_be_typed() {
        let mut left = vec![(String::new(), command())];
        while let Some((words, inner)) = left.pop() {
            assert!(
                words.is_empty() || inner.get_after_help().is_some(),
                "`{words}` has no example"
            );
            left.extend(inner.get_subcommands().map(|inner| {
                let words = format!("{words} {}", inner.get_name());
                (words.trim_start().to_owned(), inner.clone())
            }));
        }
        for (of, example) in EXAMPLES {
            let words = format!("swimmer {example}");
            let parsed = command().try_get_matches_from(words.split(' '));
            assert!(parsed.is_ok(), "{of}: {words}: {parsed:?}");
        }
    }
}
