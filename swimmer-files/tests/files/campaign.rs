//! Campaign files: the documented example, relative paths, a place for every mistake.

use std::path::Path;

use swimmer_files::{
    Axes, Campaign, FileError, GaitSpec, PointName, RigidBody, SwimmerFile, TrackSettings,
};

const EXAMPLE: &str = r#"swimmer = "robot-slender"        # or a file
[reflectors]
front = { point = "Front", at = [0.0355, 0.0] }
back = { point = ["x2", "y2"], at = [-0.0355, 0.0] }
[[run]]
track = "eps030.csv"
gait = "circle:30deg"
period_s = 30.0
[[run]]
track = "tracks/b.csv"
gait = "b.gait:cw"
period_s = 24
"#;

fn read(text: &str) -> Result<Campaign, FileError> {
    Campaign::parse(text, Path::new("tank/campaign.toml"))
}

#[test]
fn the_documented_example() {
    let campaign = read(EXAMPLE).unwrap();
    assert_eq!(
        campaign.swimmer,
        SwimmerFile::preset("robot-slender").unwrap()
    );
    assert_eq!(
        campaign.reflectors.front.point,
        PointName::Named("Front".to_owned())
    );
    assert_eq!(
        campaign.reflectors.back.point,
        PointName::Columns("x2".to_owned(), "y2".to_owned())
    );
    assert_eq!(campaign.runs.len(), 2);
    assert_eq!(campaign.runs[0].track, Path::new("tank/eps030.csv"));
    assert_eq!(campaign.runs[0].gait, "circle:30deg".parse().unwrap());
    assert_eq!(
        campaign.runs[1].gait,
        GaitSpec::File {
            path: "tank/b.gait".into(),
            reversed: true
        }
    );
    assert!((campaign.runs[1].period_s - 24.0).abs() < f64::EPSILON);
}

#[test]
fn a_swimmer_file_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut swimmer = SwimmerFile::preset("robot").unwrap();
    swimmer.name = "ours".to_owned();
    swimmer.save(&folder.path().join("our-robot.toml")).unwrap();
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, EXAMPLE.replace("robot-slender", "our-robot.toml")).unwrap();
    for file in ["eps030.csv", "tracks/b.csv", "b.gait"] {
        let file = folder.path().join(file);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, "").unwrap();
    }
    assert_eq!(Campaign::load(&path).unwrap().swimmer, swimmer);
    // A mistake in the swimmer file is reported there.
    std::fs::write(folder.path().join("our-robot.toml"), "name = 1").unwrap();
    assert!(
        Campaign::load(&path)
            .unwrap_err()
            .to_string()
            .contains("our-robot.toml:1:8")
    );
}

#[test]
fn a_file_that_is_not_there_is_told_with_the_line_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    let text = format!("{EXAMPLE}log = \"b.mcap\"\n");
    std::fs::write(&path, &text).unwrap();
    std::fs::create_dir(folder.path().join("tracks")).unwrap();
    for (file, line) in [
        ("eps030.csv", 6),
        ("tracks/b.csv", 10),
        ("b.gait", 11),
        ("b.mcap", 13),
    ] {
        let error = Campaign::load(&path).unwrap_err();
        assert_eq!(error.place().map(|place| place.0), Some(line), "{error}");
        let file = folder.path().join(file);
        let reported = format!("no file {}", file.display());
        assert!(error.to_string().contains(&reported), "{error}");
        std::fs::write(file, "").unwrap();
    }
    assert_eq!(Campaign::load(&path).unwrap().runs.len(), 2);
}

#[test]
fn mistakes_have_a_place() {
    let cases = [
        (
            "\"robot-slender\"",
            "\"missing.toml\"",
            (1, 11),
            "missing.toml",
        ),
        ("circle:30deg", "circle:30grad", (7, 8), "not an angle"),
        ("period_s = 30.0", "period_s = 0", (8, 12), "positive"),
        ("track = \"eps030.csv\"", "track = \"\"", (6, 9), "path"),
        ("at = [0.0355, 0.0]", "at = [nan, 0.0]", (3, 33), "finite"),
        ("at = [0.0355, 0.0]", "at = [0.0355]", (3, 33), "length"),
        ("[-0.0355, 0.0]", "[0.0355, 0.0]", (4, 8), "same place"),
        (
            "gait = \"b.gait:cw\"",
            "gate = \"b.gait:cw\"",
            (11, 1),
            "unknown field `gate`",
        ),
        (
            "point = \"Front\"",
            "point = 3",
            (3, 19),
            "pair of column names",
        ),
    ];
    for (good, bad, place, message) in cases {
        let error = read(&EXAMPLE.replacen(good, bad, 1)).expect_err(bad);
        assert!(error.to_string().contains(message), "{bad}: {error}");
        assert_eq!(error.place(), Some(place), "{bad}: {error}");
    }
    let no_runs = EXAMPLE.split("[[run]]").next().unwrap();
    assert!(
        read(no_runs)
            .unwrap_err()
            .to_string()
            .contains("at least one")
    );
}

#[test]
fn what_recordings_do_not_say_themselves() {
    assert_eq!(read(EXAMPLE).unwrap().tracks, TrackSettings::default());
    let settings = "[tracks]\nscale = 0.0005\nrate_hz = 30\naxes = \"x,-y\"\nlikelihood = 0.8\n";
    let with =
        |settings: &str| read(&EXAMPLE.replacen("[[run]]", &format!("{settings}[[run]]"), 1));
    assert_eq!(
        with(settings).unwrap().tracks,
        TrackSettings {
            scale: Some(0.0005),
            rate_hz: Some(30.0),
            axes: Some(Axes::IMAGE),
            likelihood: Some(0.8),
        }
    );
    for (wrong, why) in [
        ("scale = 0.0", "must be a positive number"),
        ("rate_hz = -30.0", "must be a positive number"),
        ("axes = \"x,x\"", "no axes"),
        ("zoom = 2.0", "unknown field"),
    ] {
        let error = with(&format!("[tracks]\n{wrong}\n"))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("campaign.toml:6:") && error.contains(why),
            "{error}"
        );
    }
}

#[test]
fn front_and_clock_of_a_run() {
    let text = r#"swimmer = "robot"
[reflectors]
front = { point = { near = [0.4, -0.2] }, at = [0.0355, 0.0] }
back = { point = "auto", at = [-0.0355, 0.0] }
[[run]]
track = "a.csv"
gait = "circle:30deg"
period_s = 30.0
front = "Nose"
log = "link.mcap"
play = 2
clock_offset_s = -1.25
[[run]]
track = "b.csv"
gait = "circle:50deg"
period_s = 30.0
cycle_start_s = 4.5
"#;
    let campaign = read(text).unwrap();
    assert_eq!(
        campaign.reflectors.front.point,
        PointName::Near([0.4, -0.2])
    );
    let [a, b] = &campaign.runs[..] else { panic!() };
    assert_eq!(a.front, Some(PointName::Named("Nose".into())));
    assert_eq!(a.timing.log.as_deref(), Some(Path::new("tank/link.mcap")));
    assert_eq!(
        (a.timing.play, a.timing.clock_offset_s),
        (Some(2), Some(-1.25))
    );
    assert_eq!((b.timing.cycle_start_s, &b.timing.log), (Some(4.5), &None));

    // The swimmer is a preset, and the log's folder is the campaign's.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, text.replace("circle:50deg", "b.gait")).unwrap();
    let files = ["campaign.toml", "a.csv", "link.mcap", "b.csv", "b.gait"];
    for file in &files[1..] {
        std::fs::write(folder.path().join(file), "").unwrap();
    }
    assert_eq!(
        Campaign::files(&path).unwrap(),
        files.map(|file| folder.path().join(file))
    );

    for (from, to, place, why) in [
        ("play = 2", "play = 0", "tank/campaign.toml:11:8", "from 1"),
        (
            "log = \"link.mcap\"\n",
            "",
            "tank/campaign.toml:10:8",
            "name it by `log`",
        ),
        (
            "-1.25",
            "inf",
            "tank/campaign.toml:12:18",
            "finite number of seconds",
        ),
        (
            "[0.4, -0.2]",
            "[0.4, nan]",
            "tank/campaign.toml:3",
            "finite lengths",
        ),
    ] {
        let error = read(&text.replace(from, to)).unwrap_err().to_string();
        assert!(error.contains(place) && error.contains(why), "{error}");
    }
    for (text, point) in [
        ("Front", PointName::Named("Front".into())),
        ("auto", PointName::Auto),
        ("x1,y1", PointName::Columns("x1".into(), "y1".into())),
        ("-0.5, 0.25", PointName::Near([-0.5, 0.25])),
    ] {
        assert_eq!(text.parse(), Ok(point));
    }
    assert!("0.5,y1".parse::<PointName>().is_err() && "".parse::<PointName>().is_err());
}

#[test]
fn reflectors_on_the_side_links() {
    let text = "swimmer = \"robot\"\n[reflectors]\nfront = { point = \"F\", at = [0.03, 0.0] }\nback = { point = \"B\", at = [-0.03, 0.0] }\n\
                front_link = { point = \"F1\", at = [0.1, 0.0] }\nback_link = { point = \"auto\", at = [0.08, 0.01] }\n\
                [[run]]\ntrack = \"a.csv\"\ngait = \"circle:1\"\nperiod_s = 10.0\n";
    let read = |text: &str| Campaign::parse(text, Path::new("tank/campaign.toml"));
    let [front, back] = read(text).unwrap().reflectors.sides.unwrap();
    assert_eq!(front.point, PointName::Named("F1".into()));
    assert_eq!((back.point, back.at), (PointName::Auto, [0.08, 0.01]));
    let lone = text.replace("front_link = { point = \"F1\", at = [0.1, 0.0] }\n", "");
    for (text, place, why) in [
        (lone, "tank/campaign.toml:5:13", "go together"),
        (
            text.replace("[0.1, 0.0]", "[0.0, 0.0]"),
            "tank/campaign.toml:5:14",
            "on the joint",
        ),
        (
            text.replace("\"auto\"", "{ near = [0.1, 0.2] }"),
            "tank/campaign.toml:6:13",
            "not by a place",
        ),
    ] {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(place) && error.contains(why), "{error}");
    }
}

/// A campaign of one run without a track.
fn reported(numbers: &str) -> String {
    format!("swimmer = \"robot\"\n[[run]]\ngait = \"circle:70deg\"\nperiod_s = 26.0\n{numbers}\n")
}

#[test]
fn results_instead_of_a_track() {
    let read = |text: &str| Campaign::parse(text, Path::new("tank/campaign.toml"));
    let campaign = read(&reported(
        "x_mm = 12.5\nx_sd_mm = 0.5\ncycles = 6\ndelta_theta_deg = 30.0\ndelta_theta_se_deg = 0.4",
    ))
    .unwrap();
    let [run] = &campaign.runs[..] else {
        panic!("{campaign:?}");
    };
    assert_eq!(run.track, Path::new("tank/campaign.toml:3"));
    let results = run.reported.as_ref().unwrap();
    assert_eq!((results.cycles, results.delta_y), (Some(6), None));
    let x = results.x.unwrap();
    assert!((x.mean - 0.0125).abs() < 1e-15 && (x.sd.unwrap() - 5e-4).abs() < 1e-15);
    let theta = results.delta_theta.unwrap();
    assert!((theta.mean - 30_f64.to_radians()).abs() < 1e-15 && theta.sd.is_none());
    for (numbers, place, why) in [
        ("", "3:8", "needs x_mm"),
        ("x_mm = nan", "5:8", "finite"),
        ("x_mm = 1.0\nx_sd_mm = 0.1", "6:11", "number of `cycles`"),
        (
            "x_mm = 1.0\nx_sd_mm = 0.1\ncycles = 1",
            "6:11",
            "2 at least",
        ),
        ("x_mm = 1.0\nx_se_mm = -0.1", "6:11", "positive"),
        ("x_mm = 1.0\nx_se_mm = 0.1\nx_sd_mm = 0.1", "6:11", "both"),
        ("x_mm = 1.0\ndelta_y_se_mm = 0.1", "6:17", "not there"),
        ("delta_y_mm = -1.0", "5:14", "half of a range"),
        ("x_mm = 1.0\ncycles = 2.5", "6:10", "1, 2, 3"),
        ("x_mm = 1.0\nlog = \"a.mcap\"", "6:7", "about a track"),
        ("x_mm = 1.0\ntrack = \"a.csv\"", "5:8", "not both"),
        ("x_mm = 1.0\nresults = \"a.csv\"", "5:8", "next to a table"),
        ("x_cm = 1.0", "5:1", "unknown field"),
    ] {
        let text = reported(numbers).replace("[[run]]", if numbers.contains("track") {
            "[reflectors]\nfront = { point = \"F\", at = [0.03, 0.0] }\nback = { point = \"B\", at = [-0.03, 0.0] }\n[[run]]"
        } else {
            "[[run]]"
        });
        let error = read(&text).unwrap_err().to_string();
        let place = if numbers.contains("track") {
            "8:8"
        } else {
            place
        };
        let place = format!("tank/campaign.toml:{place}");
        assert!(
            error.contains(&place) && error.contains(why),
            "{numbers}: {error}"
        );
    }
    let tracked =
        "swimmer = \"robot\"\n[[run]]\ntrack = \"a.csv\"\ngait = \"circle:1\"\nperiod_s = 10.0\n";
    let error = read(tracked).unwrap_err().to_string();
    assert!(
        error.contains("3:9") && error.contains("[reflectors]"),
        "{error}"
    );
}

#[test]
fn a_table_of_results() {
    let folder = tempfile::tempdir().unwrap();
    let write = |table: &str| {
        std::fs::write(folder.path().join("figure.csv"), table).unwrap();
        let path = folder.path().join("campaign.toml");
        let text = reported("results = \"figure.csv\"").replace("circle:70deg", "circle");
        std::fs::write(&path, text).unwrap();
        Campaign::load(&path)
    };
    let campaign = write(
        "# read off the figure\namplitude_deg;x_mm;x_sd_mm;cycles\n40;10.1;0.4;5\n\n60;15.0;;\n",
    )
    .unwrap();
    let gaits: Vec<String> = campaign
        .runs
        .iter()
        .map(|run| run.gait.to_string())
        .collect();
    assert!(gaits[0].contains("circle") && gaits.len() == 2, "{gaits:?}");
    assert!(campaign.runs[1].track.ends_with("figure.csv:5"));
    assert_eq!(
        campaign.runs[1].reported.as_ref().unwrap().x.unwrap().sd,
        None
    );
    let files = Campaign::files(&folder.path().join("campaign.toml")).unwrap();
    assert!(files.iter().any(|file| file.ends_with("figure.csv")));
    for (table, place, why) in [
        ("", "figure.csv:1:1", "empty"),
        ("amplitude_deg,x_mm\n", "figure.csv:1:1", "no line"),
        (
            "amplitude_deg,x_cm\n40,1\n",
            "figure.csv:1:2",
            "no column `x_cm`",
        ),
        ("x_mm,x_mm\n1,1\n", "figure.csv:1:2", "second column"),
        (
            "amplitude_deg,x_mm\n40\n",
            "figure.csv:2:1",
            "1 cells under 2",
        ),
        (
            "amplitude_deg,x_mm\n40,ten\n",
            "figure.csv:2:2",
            "no number",
        ),
        ("amplitude_deg,x_mm\n-40,1\n", "figure.csv:2:1", "above 0"),
        ("x_mm\n1\n", "figure.csv:2:1", "no amplitude"),
        (
            "amplitude_deg,x_mm,x_sd_mm\n40,1,1\n",
            "figure.csv:2:3",
            "cycles",
        ),
        (
            "amplitude_deg,gait,x_mm\n40,circle:1,1\n",
            "figure.csv:2:1",
            "one of",
        ),
    ] {
        let error = write(table).unwrap_err().to_string();
        assert!(
            error.contains(place) && error.contains(why),
            "{table}: {error}"
        );
    }
    std::fs::remove_file(folder.path().join("figure.csv")).unwrap();
    let error = Campaign::load(&folder.path().join("campaign.toml"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("campaign.toml:5:11"), "{error}");
}

#[test]
fn a_rigid_body_in_place_of_two_reflectors() {
    let text = "swimmer = \"robot\"\n[reflectors]\nbody = \"robot\"\n[[run]]\ntrack = \"a.csv\"\ngait = \"circle:1\"\nperiod_s = 10.0\n";
    let read = |text: &str| Campaign::parse(text, Path::new("tank/campaign.toml"));
    let reflectors = read(text).unwrap().reflectors;
    assert_eq!(reflectors.body, Some(RigidBody::named("robot".into())));
    // Its places on the link are the ends of the middle link.
    let half = SwimmerFile::preset("robot").unwrap().swimmer.links.middle / 2.0;
    assert_eq!(
        [reflectors.front.at, reflectors.back.at],
        [[half, 0.0], [-half, 0.0]]
    );
    let table = "{ name = \"b\", at = [0.01, -0.02], axis = \"-z\", heading_deg = 90.0 }";
    let body = read(&text.replace("\"robot\"\n[[", &format!("{table}\n[[")));
    let body = body.unwrap().reflectors.body.unwrap();
    assert_eq!((body.at, body.axis), ([0.01, -0.02], Some((2, -1.0))));
    assert!((body.heading_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    let bad = |with: &str| read(&text.replace("body = \"robot\"", with)).unwrap_err();
    let end = "{ point = \"F\", at = [0.03, 0.0] }";
    for (with, place, why) in [
        ("body = \"\"".to_owned(), ":3:8", "name of a rigid body"),
        (
            format!("body = {}", table.replace("-z", "w")),
            ":3:8",
            "x, y, z",
        ),
        (
            format!("body = {}", table.replace("90.0", "nan")),
            ":3:8",
            "finite",
        ),
        (
            format!("body = {}", table.replace("axis", "axes")),
            ":3:8",
            "a body is a name",
        ),
        (
            format!("body = \"robot\"\nfront = {end}"),
            ":4:9",
            "remove one of them",
        ),
        (format!("front = {end}"), ":3:9", "`front` and `back`"),
    ] {
        let error = bad(&with).to_string();
        assert!(error.contains(place) && error.contains(why), "{error}");
    }
}
