//! Every command × what goes wrong around it: what happens, as one table. No cell is a panic, a loss or a lie.

use std::fmt::Write as _;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::{scope, sleep};
use std::time::Duration;

use crate::binary::{Ran, command, interrupt, on_a_small_disk};
use crate::laboratory::laboratory;

/// A command as it works, in the folder of [`laboratory()`].
struct Row {
    words: &'static str,
    /// The word that names a file to be read.
    reads: Option<&'static str>,
    /// The file or folder that is written.
    writes: Option<&'static str>,
    /// Goes on until Ctrl-C.
    lasts: bool,
    /// Takes a while, so that Ctrl-C may come in between.
    while_working: bool,
    /// Takes long: only what ends early is tried.
    long: bool,
}

const fn row(words: &'static str) -> Row {
    Row {
        words,
        reads: None,
        writes: None,
        lasts: false,
        while_working: false,
        long: false,
    }
}

impl Row {
    const fn reads(self, word: &'static str) -> Self {
        Self {
            reads: Some(word),
            ..self
        }
    }
    const fn writes(self, word: &'static str) -> Self {
        Self {
            writes: Some(word),
            ..self
        }
    }
    const fn lasts(self) -> Self {
        Self {
            lasts: true,
            ..self
        }
    }
    const fn works_a_while(self) -> Self {
        Self {
            while_working: true,
            ..self
        }
    }
    const fn long(self) -> Self {
        Self {
            while_working: true,
            long: true,
            ..self
        }
    }
}

const ROWS: [Row; 54] = [
    row("demo --swimmer good.toml -o out")
        .reads("good.toml")
        .writes("out")
        .works_a_while(),
    row("simulate --swimmer good.toml --gait circle:1 --trajectory t.csv")
        .reads("good.toml")
        .writes("t.csv"),
    row("simulate --swimmer good.toml --gait sine:1 --passive back --relaxation 5 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("optimize passive --swimmer good.toml --passive back --relaxation 5 --max-angle 1 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("optimize displacement --swimmer good.toml --max-angle 2.8 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("optimize efficiency --swimmer good.toml --max-angle 2.8 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("optimize turning --swimmer good.toml --max-angle 2.8 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("optimize sideways --swimmer good.toml --max-angle 2.8 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("optimize speed --swimmer good.toml --max-rate 1 --max-angle 2.8 -o o.gait")
        .reads("good.toml")
        .writes("o.gait"),
    row("atlas --swimmer good.toml --objective displacement --starts 100000 -o out")
        .reads("good.toml")
        .writes("out")
        .long(),
    row("atlas --swimmer good.toml --objective displacement --starts 4 -o out")
        .reads("good.toml")
        .writes("out"),
    row("certify --swimmer robot --gait good.gait --objective displacement").reads("good.gait"),
    row("height-map --swimmer good.toml -o m.svg")
        .reads("good.toml")
        .writes("m.svg"),
    row("simulate --swimmer good.toml --gait good.gait --picture p.png")
        .reads("good.gait")
        .writes("p.png"),
    row("sweep plan spec.toml -o out")
        .reads("spec.toml")
        .writes("out"),
    row("sweep run swept --threads 1"),
    row("sweep status swept"),
    row("sweep merge swept -o t.parquet").writes("t.parquet"),
    row("sweep map swept --quantity structure -o m.svg").writes("m.svg"),
    row("sweep submit slurm swept --time 5 -o s.sh").writes("s.sh"),
    row("paper -o out").writes("out").works_a_while(),
    row("swimmers robot"),
    row("gaits"),
    row("completions bash"),
    row("man -o out").writes("out"),
    row("tracks run.csv").reads("run.csv"),
    row("calibrate campaign.toml -o out")
        .reads("campaign.toml")
        .writes("out"),
    row("twin --pty link --track k.csv").writes("k.csv").lasts(),
    row("lab --port twin --page page.html --no-browser")
        .reads("page.html")
        .lasts(),
    row("lab --export out.html --page page.html")
        .reads("page.html")
        .writes("out.html"),
    row("robot info --port twin"),
    row("robot status --port twin --log l.mcap").writes("l.mcap"),
    row("robot configure --swimmer good.toml --port twin").reads("good.toml"),
    row("robot upload good.gait --port twin").reads("good.gait"),
    row("robot arm --port twin").lasts(),
    row("robot play --gait good.gait --cycles 1 --port twin").reads("good.gait"),
    row("robot play --gait circle:1 --port twin").lasts(),
    row("robot go --to 9,9 --tank 1x1 --track twin --port twin"),
    row("robot pause --port twin"),
    row("robot resume --port twin"),
    row("robot stop --port twin"),
    row("robot estop --port twin"),
    row("robot estop --clear --port twin"),
    row("robot trim --front 1deg --port twin"),
    row("robot servo front --port twin"),
    row("robot setup -o s.toml --port twin").writes("s.toml"),
    row("robot flash image.uf2 --by-hand --drive drive").reads("image.uf2"),
    row("robot watch --port twin").lasts(),
    row("robot log g.mcap --port twin").writes("g.mcap").lasts(),
    row("robot key make lab.key --port twin").writes("lab.key"),
    row("robot key set good.key --port twin").reads("good.key"),
    row("robot hc05 --port /dev/null"),
    row("robot upload good.gait --dry-run --swimmer good.toml").reads("good.toml"),
    row("robot replay good.mcap").reads("good.mcap"),
];

/// Status and reason; fails where it is a panic or a death.
fn told(words: &str, ran: &Ran) -> String {
    assert!(
        (0..=2).contains(&ran.status) && !ran.stderr.contains("panicked"),
        "{words}: {ran}"
    );
    let reason = ran.stderr.lines().rfind(|line| line.starts_with("error: "));
    let Some(reason) = reason.filter(|_| ran.status != 0) else {
        assert_eq!(ran.status, 0, "no reason given, {words}: {ran}");
        return "0".to_owned();
    };
    let reason: String = reason.chars().skip(7).take(70).collect();
    format!("{}: {}", ran.status, reason.replace('|', "/").trim())
}

fn run(mut command: Command) -> Ran {
    command.stdin(Stdio::null()).output().unwrap().into()
}

fn words(row: &Row, with: Option<(&str, &str)>) -> Vec<String> {
    row.words
        .split(' ')
        .map(|word| match with {
            Some((from, to)) if from == word => to.to_owned(),
            _ => word.to_owned(),
        })
        .collect()
}

fn made(folder: &Path, words: &[String]) -> Command {
    command(
        folder,
        &words.iter().map(String::as_str).collect::<Vec<_>>(),
    )
}

/// The cells of a row.
fn cells(row: &Row) -> Vec<String> {
    let mut cells = vec![
        reads_instead(row, "lost"),
        reads_instead(row, "wrong"),
        finds_it_there(row),
        interrupted(row),
    ];
    if row.long {
        cells.extend([
            "not tried: takes long".to_owned(),
            "not tried: takes long".to_owned(),
        ]);
    } else {
        cells.extend([prints_onto_a_full_disk(row), writes_onto_a_full_disk(row)]);
    }
    let narrow = [words(row, None), vec!["--help".to_owned()]].concat();
    let folder = laboratory();
    let mut command = made(folder.path(), &narrow);
    command.env("COLUMNS", "20");
    cells.push(told(row.words, &run(command)));
    if row.long {
        cells.extend([
            "not tried: takes long".to_owned(),
            "not tried: takes long".to_owned(),
        ]);
    } else {
        cells.extend(without_colour_or_reader(row));
    }
    cells
}

fn none() -> String {
    "–".to_owned()
}

/// Another file than the one that is to be read.
fn reads_instead(row: &Row, instead: &str) -> String {
    row.reads.map_or_else(none, |file| {
        let folder = laboratory();
        let ending = file.rsplit('.').next().unwrap_or_default();
        let instead = format!("{instead}.{ending}");
        let words = words(row, Some((file, &instead)));
        let ran = run(made(folder.path(), &words));
        assert_eq!(ran.status, 2, "{words:?}: {ran}");
        told(row.words, &ran)
    })
}

/// The output file exists already.
fn finds_it_there(row: &Row) -> String {
    row.writes.map_or_else(none, |file| {
        let folder = laboratory();
        let place = folder.path().join(file);
        let place = if file == "out" {
            std::fs::create_dir(&place).unwrap();
            place.join("mine")
        } else {
            place
        };
        std::fs::write(&place, "mine").unwrap();
        let ran = run(made(folder.path(), &words(row, None)));
        assert_eq!(std::fs::read_to_string(&place).unwrap(), "mine", "{ran}");
        assert_eq!(ran.status, 2, "{ran}");
        told(row.words, &ran)
    })
}

fn interrupted(row: &Row) -> String {
    let folder = laboratory();
    if row.lasts {
        return told(row.words, &ended(made(folder.path(), &words(row, None))));
    }
    if !row.while_working {
        return "ends by itself".to_owned();
    }
    let ran = ended(made(folder.path(), &words(row, None)));
    if ran.status != 0 {
        let left = row
            .writes
            .is_some_and(|file| folder.path().join(file).exists());
        assert!(!left, "half-written: {ran}");
    }
    // The progress depends on the machine: it was done, had begun nothing, or reports the interruption.
    let interrupted = ran.status == 1 && ran.stderr.contains("nothing was kept");
    assert!(matches!(ran.status, 0 | -1) || interrupted, "{ran}");
    "done before, or ends and nothing is left".to_owned()
}

/// Standard output takes nothing.
fn prints_onto_a_full_disk(row: &Row) -> String {
    let folder = laboratory();
    let mut command = made(folder.path(), &words(row, None));
    command.stdout(File::options().write(true).open("/dev/full").unwrap());
    command.stderr(Stdio::piped()).stdin(Stdio::null());
    let child = command.spawn().unwrap();
    if row.lasts {
        sleep(Duration::from_millis(1500));
        interrupt(&child);
    }
    told(row.words, &child.wait_with_output().unwrap().into())
}

/// Files take nothing: the command says so, and leaves nothing but what a recording held by then.
fn writes_onto_a_full_disk(row: &Row) -> String {
    row.writes.map_or_else(none, |file| {
        let folder = laboratory();
        let words = words(row, None);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let mut command = on_a_small_disk(folder.path(), 0, &words);
        command.stdin(Stdio::null());
        let ran = if row.lasts {
            ended(command)
        } else {
            run(command)
        };
        assert_eq!(ran.status, 1, "{words:?}: {ran}");
        let place = folder.path().join(file);
        let kept = match std::fs::metadata(&place) {
            Ok(found) if found.is_dir() => std::fs::read_dir(&place).unwrap().count() as u64,
            Ok(found) => found.len(),
            Err(_) => 0,
        };
        assert_eq!(kept, 0, "half-written: {ran}");
        told(row.words, &ran)
    })
}

/// A normal run without colours; and the same into a pipe without a reader.
fn without_colour_or_reader(row: &Row) -> [String; 2] {
    let folder = laboratory();
    let mut command = made(folder.path(), &words(row, None));
    command.env("NO_COLOR", "1");
    let plain = if row.lasts {
        ended(command)
    } else {
        run(command)
    };
    let escapes = format!("{}{}", plain.stdout, plain.stderr).contains('\u{1b}');
    assert!(!escapes, "{plain}");
    let folder = laboratory();
    let mut command = made(folder.path(), &words(row, None));
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    command.stdout(writer.try_clone().unwrap()).stderr(writer);
    let mut child = command.stdin(Stdio::null()).spawn().unwrap();
    if row.lasts {
        sleep(Duration::from_millis(1500));
        interrupt(&child);
    }
    let status = child.wait().unwrap().code();
    assert_eq!(status, Some(plain.status), "closed pipe: {}", row.words);
    [told(row.words, &plain), plain.status.to_string()]
}

/// Output of a command that Ctrl-C ends after 1.5 s.
fn ended(mut command: Command) -> Ran {
    command.stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    sleep(Duration::from_millis(1500));
    interrupt(&child);
    child.wait_with_output().unwrap().into()
}

#[cfg(target_os = "linux")]
#[test]
fn every_command_whatever_goes_wrong() {
    let mut table = String::from(
        "| command | missing file | wrong type | existing output | Ctrl-C | full disk (stdout) | full disk (files) | narrow (--help) | no colour | closed pipe |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let filled: Vec<Vec<String>> = scope(|scope| {
        let halves: Vec<_> = ROWS
            .chunks(ROWS.len().div_ceil(2))
            .map(|rows| scope.spawn(|| rows.iter().map(cells).collect::<Vec<_>>()))
            .collect();
        halves
            .into_iter()
            .flat_map(|half| half.join().unwrap())
            .collect()
    });
    for (row, cells) in ROWS.iter().zip(filled) {
        writeln!(table, "| {} | {} |", row.words, cells.join(" | ")).unwrap();
    }
    insta::assert_snapshot!("table", table);
}
