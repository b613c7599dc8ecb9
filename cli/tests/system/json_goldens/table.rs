//! Table of the commands whose documents are kept.

/// Commands that run one after the other in a folder of their own.
pub(crate) struct Session {
    /// Folder of the documents under `tests/golden/json`.
    pub(crate) name: &'static str,
    /// Folder whose files the session starts with, relative to this crate.
    pub(crate) files: Option<&'static str>,
    pub(crate) commands: &'static [Command],
}

/// A command whose document is kept.
pub(crate) struct Command {
    /// Name of the document's file, without its ending.
    pub(crate) document: &'static str,
    /// Exit status.
    pub(crate) status: i32,
    /// Words after `swimmer`.
    pub(crate) words: &'static str,
    /// Keys of times that this run took, in addition to those that are always filtered.
    pub(crate) times: &'static [&'static str],
}

/// A session without files.
const fn bare(name: &'static str, commands: &'static [Command]) -> Session {
    Session {
        name,
        files: None,
        commands,
    }
}

/// A session that starts with the files of a folder.
const fn with(files: &'static str, name: &'static str, commands: &'static [Command]) -> Session {
    Session {
        name,
        files: Some(files),
        commands,
    }
}

/// A command that succeeds.
const fn done(document: &'static str, words: &'static str) -> Command {
    Command {
        document,
        status: 0,
        words,
        times: &[],
    }
}

/// A command that succeeds, with keys of times that depend on the run.
const fn timed(
    document: &'static str,
    words: &'static str,
    times: &'static [&'static str],
) -> Command {
    Command {
        document,
        status: 0,
        words,
        times,
    }
}

/// A command that tries and fails.
const fn failed(document: &'static str, words: &'static str) -> Command {
    Command {
        document,
        status: 1,
        words,
        times: &[],
    }
}

/// A command that refuses its words or files.
const fn bad_input(document: &'static str, words: &'static str) -> Command {
    Command {
        document,
        status: 2,
        words,
        times: &[],
    }
}

/// Sessions of seconds; the longest stand first, because each thread takes the next that is left.
#[rustfmt::skip]
pub(super) const SESSIONS: &[Session] = &[
    bare("paper", &[
        done("paper", "paper"),
    ]),
    bare("demo", &[
        done("demo", "demo -o lab"),
        done("tracks", "tracks lab/circle-070.csv"),
        done("calibrate", "calibrate lab/campaign.toml -o fit"),
        done("fit-also", "calibrate lab/campaign.toml --fit-also deadband,offsets --advise"),
    ]),
    bare("best-gait", &[
        done("optimize", "optimize displacement --swimmer robot --max-angle 2 --no-overlap -o best.gait"),
        bad_input("optimize-refused", "optimize displacement --swimmer robot --max-angle 2 --no-overlap -o best.gait"),
        done("certify", "certify --swimmer robot --gait best.gait"),
        done("height-map", "height-map --swimmer robot -o map.svg --gait best.gait"),
        done("simulate", "simulate --swimmer robot --gait best.gait --picture way.svg"),
        done("played", "simulate --swimmer robot --gait best.gait --played"),
        done("upload-dry-run", "robot upload best.gait --dry-run --swimmer robot --tank 1.0x0.6"),
        done("upload", "robot upload best.gait --port twin"),
        done("play", "robot play --gait circle:70deg --cycles 2 --log run.mcap --port twin"),
        done("replay", "robot replay run.mcap"),
    ]),
    bare("simulate", &[
        done("best-circle", "simulate --swimmer purcell --gait circle:1.6331625"),
        done("large-circle", "simulate --swimmer purcell --gait circle:3.647415"),
        done("square", "simulate --swimmer purcell --gait square:180deg"),
        done("almost-square", "simulate --swimmer purcell --gait square:179.9deg"),
        done("robot", "simulate --swimmer robot --gait circle:70deg"),
        done("clockwise", "simulate --swimmer robot --gait circle:70deg:cw"),
        done("cycles", "simulate --swimmer robot --gait circle:70deg --cycles 3 --trajectory path.csv"),
        done("played", "simulate --swimmer robot --gait circle:70deg --played --knots 12 --period 20"),
        done("picture", "simulate --swimmer robot --gait circle:70deg --picture way.svg"),
        bad_input("no-cycles", "simulate --swimmer robot --gait circle:1 --cycles 0"),
        bad_input("no-gait", "simulate --swimmer robot"),
        bad_input("no-such-swimmer", "simulate --swimmer robto --gait circle:70deg"),
        bad_input("no-such-file", "simulate --swimmer robot --gait lost.gait"),
        bad_input("no-such-shape", "simulate --swimmer robot --gait circel:70deg"),
        bad_input("no-such-unit", "simulate --swimmer robot --gait circle:70degrees"),
        bad_input("picture-refused", "simulate --swimmer robot --gait circle:70deg --picture way.jpg"),
    ]),
    with("tests/cmd/angles.in", "angles", &[
        bad_input("degrees", "simulate --swimmer degrees.toml --gait circle:70deg"),
        bad_input("dead-band", "simulate --swimmer dead-band.toml --gait circle:70deg"),
        bad_input("gait-file", "simulate --swimmer robot --gait degrees.gait"),
        done("doubtful", "simulate --swimmer doubtful.toml --gait circle:70deg"),
        bad_input("negative", "height-map --swimmer robot --max-angle -1deg"),
    ]),
    with("tests/cmd/own-robot.in", "own-robot", &[
        done("swimmers", "swimmers"),
        done("swimmers-robot", "swimmers robot"),
        done("gaits", "gaits"),
        done("simulate", "simulate --swimmer ours.toml --gait circle:70deg"),
        done("simulate-fluid", "simulate --swimmer ours.toml --gait circle:70deg --period 5"),
        done("simulate-too-fast", "simulate --swimmer ours.toml --gait circle:100deg --period 8"),
        done("optimize", "optimize displacement --swimmer ours.toml --max-angle 1.2"),
        done("playable", "optimize displacement --swimmer ours.toml --playable"),
        failed("upload-refused", "robot upload circle:110deg --dry-run --swimmer ours.toml"),
    ]),
    with("tests/cmd/robot.in", "dry-run", &[
        done("sluggish", "robot upload circle:10deg --dry-run --swimmer sluggish.toml"),
        done("tank", "robot upload circle:120deg --dry-run --swimmer robot --tank 1.0x0.6"),
        done("start", "robot upload circle:120deg --dry-run --port twin --period 20 --tank 1.0x0.6 --start -0.2,0 --heading 180deg"),
        failed("too-wide", "robot upload circle:170deg --dry-run --swimmer robot"),
    ]),
    bare("displacement", &[
        done("purcell", "optimize displacement --swimmer purcell"),
        done("robot-70deg", "optimize displacement --swimmer robot --max-angle 70deg"),
        done("sector", "optimize displacement --swimmer robot --max-angle 2.8 --sector"),
        done("robot", "optimize displacement --swimmer robot --max-angle 2.8"),
        done("timed", "optimize displacement --swimmer robot --max-angle 2.8 --max-rate 3.5 --period 7"),
        bad_input("no-such-angle", "optimize displacement --swimmer robot --max-angle -1"),
    ]),
    bare("efficiency", &[
        done("small", "optimize efficiency --swimmer purcell"),
        done("large", "optimize efficiency --swimmer purcell --gait large"),
        done("fourier", "optimize efficiency --swimmer robot --gait large --method fourier"),
        done("bounded", "optimize efficiency --swimmer robot --gait large --max-angle 2.8"),
        done("timed", "optimize efficiency --swimmer purcell --max-angle 1.5 --max-rate 0.5 --period 15.12"),
    ]),
    bare("collocation", &[
        done("large", "optimize efficiency --swimmer robot --gait large --method collocation"),
    ]),
    bare("turning", &[
        done("bounded", "optimize turning --swimmer robot --max-angle 2.8 --no-overlap -o left.gait"),
        done("certify", "certify --swimmer robot --gait left.gait"),
        done("overlap", "optimize turning --swimmer robot --max-angle 2.8"),
        done("unbounded", "optimize turning --swimmer robot --no-overlap"),
        done("sideways", "optimize sideways --swimmer robot --max-angle 2.8"),
    ]),
    bare("speed", &[
        done("robot", "optimize speed --swimmer robot --max-rate 60deg --max-angle 160deg"),
        done("purcell", "optimize speed --swimmer purcell --max-rate 1 --max-angle 2"),
        done("playable", "optimize speed --swimmer robot --playable"),
        bad_input("refused", "optimize speed --swimmer robot"),
    ]),
    bare("passive", &[
        done("sine", "simulate --swimmer elastic-tail --gait sine:1 --period 1 -o sine.gait"),
        done("file", "simulate --swimmer purcell --gait sine.gait"),
        bad_input("no-joint", "simulate --swimmer purcell --gait sine:1"),
        done("displacement", "optimize passive --swimmer elastic-tail --max-angle 1 --harmonics 2"),
        bad_input("no-rate", "optimize passive --swimmer elastic-tail --max-angle 1 --most speed"),
    ]),
    with("tests/cmd/robust.in", "robust", &[
        done("displacement", "optimize displacement --swimmer robot --max-angle 2.8 --robust fit.json"),
        done("efficiency", "optimize efficiency --swimmer robot --robust fit.json --over mean --order 3"),
        done("efficiency-gain", "optimize efficiency --swimmer robot --robust fit-gain.json --order 2"),
        done("speed", "optimize speed --swimmer robot --max-angle 2.8 --max-rate 1 --robust fit.json --gain 0.98 1.02"),
        bad_input("broken", "optimize displacement --swimmer robot --max-angle 2.8 --robust broken.json"),
    ]),
    bare("atlas", &[
        done("displacement", "atlas --swimmer purcell --objective displacement --max-angle 2.8 --starts 24"),
        done("efficiency", "atlas --swimmer purcell --objective efficiency --starts 1"),
        done("speed", "atlas --swimmer robot --objective speed --max-rate 1 --max-angle 2 --starts 4"),
        done("continued", "atlas --swimmer robot --objective efficiency --continue max-angle=2.8..2.4 --steps 5 --gait large"),
        bad_input("refused", "atlas --swimmer robot --objective speed"),
    ]),
    bare("shell", &[
        done("man", "man -o man1"),
        bad_input("no-such-command", "dance"),
    ]),
    bare("certify", &[
        bad_input("no-objective", "certify --swimmer purcell --gait circle:1.2"),
        failed("displacement", "certify --swimmer purcell --gait circle:1.2 --objective displacement"),
        failed("square", "certify --swimmer purcell --gait square:180deg --objective turning --no-overlap"),
    ]),
    with("../docs/how-to/own-gait.in", "own-gait", &[
        done("simulate", "simulate --swimmer robot --gait mine.gait"),
        failed("certify", "certify --swimmer robot --gait mine.gait --objective displacement"),
    ]),
    with("../docs/how-to/own-tracking.in", "own-tracking", &[
        done("tracks", "tracks mine.csv"),
        bad_input("lost", "tracks lost.csv"),
    ]),
    bare("height-map", &[
        done("gaits", "height-map --swimmer purcell --max-angle 3 --gait circle:1 --gait square:1.2rad:cw"),
        bad_input("too-wide", "height-map --swimmer robot --gait circle:3"),
        bad_input("refused", "height-map --swimmer purcell -o map.jpg"),
    ]),
    with("../docs/how-to/sweeps.in", "sweep", &[
        done("plan", "sweep plan small.toml -o small"),
        done("run", "sweep run small"),
        done("status", "sweep status small"),
        done("merge", "sweep merge small -o small.parquet"),
        done("map", "sweep map small -o map.svg"),
        done("submit", "sweep submit slurm small --shards 2"),
    ]),
    with("../experiment/tests/straight", "live", &[
        // A keep-alive more or less, .35 ms each, as the machine is busy.
        timed("go", "robot go --to 0.02,0.05 --within 10mm,1deg --tank 1.2x1.2 --gaits . --port twin --track twin", &["duration_s"]),
    ]),
    bare("robot", &[
        done("info", "robot info --port twin"),
        done("status", "robot status --port twin"),
        done("upload", "robot upload circle:70deg --port twin"),
        done("play", "robot play --gait circle:70deg --cycles 2 --period 10 --port twin"),
        done("detach", "robot play --gait circle:30deg --cycles 3 --period 10 --detach --port twin"),
        done("stop", "robot stop --port twin"),
        done("estop", "robot estop --port twin"),
        done("trim", "robot trim --front 2deg --back -1.5deg --port twin"),
        done("configure", "robot configure --swimmer robot --max-angle 2.5 --port twin"),
        failed("no-table", "robot play --cycles 2 --port twin"),
        failed("bad-table", "robot upload square:3.1 --port twin"),
        failed("too-fast", "robot play --gait circle:70deg --period 1 --cycles 1 --port twin"),
        failed("no-pause", "robot pause --port twin"),
        failed("no-port", "robot info --port gone"),
        done("watch", "robot watch --seconds 0.2 --port twin"),
        failed("setup-refused", "robot setup --port twin"),
        bad_input("hc05-refused", "robot hc05 --port twin"),
    ]),
    with("tests/cmd/key.in", "key", &[
        done("set", "robot key set robot.key --port twin"),
        bad_input("short", "robot info --key short.key --port twin"),
        done("make", "robot key make fresh.key --port twin"),
        done("clear", "robot key clear --key robot.key --port twin"),
    ]),
];

/// Sessions that take more than ten seconds.
#[rustfmt::skip]
pub(super) const LONG_SESSIONS: &[Session] = &[
    bare("steer", &[
        done("steer", "optimize steer --swimmer robot --playable -o gaits"),
        done("plan", "plan --swimmer robot --playable --gaits gaits --to 0.2,0.1,90deg --tank 1.0x0.6 -o way.playlist"),
        done("play", "robot play --playlist way.playlist --tank 1.0x0.6 --port twin"),
    ]),
];
