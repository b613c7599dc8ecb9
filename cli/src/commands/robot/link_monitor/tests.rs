//! The monitor next to a twin in virtual time, which another program drives: departures, stops without cameras and at a wall.

use std::collections::VecDeque;
use std::io;
use std::ops::ControlFlow;
use std::sync::Mutex;

use clap::Parser as _;
use gait_player::GaitTable;
use host_link::session::SessionConfig;
use host_link::{Port, Robot};
use link_protocol::{StateName, StopCause};
use swimmer_model::Model;

use super::super::port::{AnyPort, BAUD, Means, Pace, open_filmed};
use super::*;
use crate::virtual_robot::EmulatedBoard;

#[derive(clap::Parser)]
struct Words {
    #[arg(long)]
    port: String,
    #[command(flatten)]
    monitor: LinkMonitorOptions,
}

type Tape = Arc<Mutex<VecDeque<Traffic>>>;

/// A port that records what passes.
struct Recorded {
    port: AnyPort,
    tape: Tape,
}

impl Port for Recorded {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let count = self.port.read(buf, timeout)?;
        let traffic = Traffic::FromRobot(self.port.now(), buf[..count].into());
        self.tape.lock().unwrap().push_back(traffic);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let traffic = Traffic::ToRobot(self.port.now(), bytes.into());
        self.tape.lock().unwrap().push_back(traffic);
        self.port.write(bytes)
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}

/// A driver with a twin, and the monitor that follows them.
struct Laboratory {
    robot: Robot<Recorded>,
    tape: Tape,
    cameras: TankCameras,
    monitor: MonitorThread,
    /// Time from which the cameras are dark \[s\].
    dark_from_s: f64,
    lines: Vec<MonitorLine>,
    model: Model<f64>,
    /// Largest coordinate of a part of the body while the robot plays \[m\], at times \[s\].
    reaches: Vec<(f64, f64)>,
    /// Times of the demanded stops \[s\].
    stops_s: Vec<f64>,
}

impl Laboratory {
    /// `arguments` are those of `swimmer lab`.
    fn new(arguments: &[&str]) -> Self {
        let words = Words::parse_from([&["lab"], arguments].concat());
        let options = words.monitor.cameras(true).unwrap().unwrap();
        let session = SessionConfig::new(5);
        let means = Means {
            pace: Pace::AsFastAsPossible,
            baud: BAUD,
            session,
            board: EmulatedBoard::default(),
        };
        let opened = open_filmed(&words.port, &means, &options.file, 1, &options.tank).unwrap();
        let tape = Tape::default();
        let port = Recorded {
            port: opened.port,
            tape: Arc::clone(&tape),
        };
        let cameras = options.tank.clone();
        let model = crate::arguments::model(&options.file).unwrap();
        let monitor = options.thread(Arc::default()).unwrap();
        let robot = Robot::connect_with(port, session).unwrap();
        Self {
            robot,
            tape,
            cameras,
            monitor,
            dark_from_s: f64::INFINITY,
            lines: Vec::new(),
            model,
            reaches: Vec::new(),
            stops_s: Vec::new(),
        }
    }

    fn now_s(&self) -> f64 {
        self.robot.port().now().as_secs_f64()
    }

    /// Time and largest coordinate of a part of the body, if the robot plays.
    fn reach(&self, now_s: f64, [x, y, heading]: [f64; 3]) -> Option<(f64, f64)> {
        let telemetry = self.robot.telemetry()?;
        let swimmer = self.model.swimmer();
        let shape = telemetry.setpoint.map(|angle| f64::from(angle) * 1e-4);
        let pose = swimmer_model::Pose::new(x, y, heading);
        let outline = swimmer.links.outline(&shape.into());
        let points = outline.map(|point| pose.transform(&point).amax());
        let sphere = pose.position().amax() + swimmer.sphere_radius;
        let reach_m = points.into_iter().fold(sphere, f64::max);
        (telemetry.state == StateName::Playing).then_some((now_s, reach_m))
    }

    /// Largest reach in the first so many seconds of the play \[m\].
    fn largest_reach_m(&self, within_s: f64) -> f64 {
        let began_s = self.reaches[0].0;
        let early = self
            .reaches
            .iter()
            .filter(|(time_s, _)| time_s - began_s < within_s);
        early.map(|(_, reach_m)| *reach_m).fold(0.0, f64::max)
    }

    /// One turn of the monitor, and its demands.
    fn turn(&mut self) {
        let now_s = self.now_s();
        if now_s > self.dark_from_s {
            self.cameras.take();
        }
        let now_us = self.robot.port().now().as_micros();
        let now_us = u64::try_from(now_us).unwrap();
        self.monitor.clock_us.store(now_us, Ordering::Relaxed);
        let traffic = std::mem::take(&mut *self.tape.lock().unwrap());
        let mut reports = self.monitor.turn(traffic.into_iter()).unwrap();
        // Evaluations take no virtual time.
        for evaluated in self.monitor.evaluator.wait().unwrap() {
            self.monitor.follower.evaluated(evaluated);
        }
        reports.extend(self.monitor.turn(std::iter::empty()).unwrap());
        for report in reports {
            match report {
                MonitorReport::Pose(Some(pose)) => self.reaches.extend(self.reach(now_s, pose)),
                MonitorReport::Pose(None) => {}
                MonitorReport::Lines(lines) => self.lines = lines,
                MonitorReport::Stop => {
                    self.stops_s.push(now_s);
                    self.robot.stop().unwrap();
                }
            }
        }
    }

    fn wait(&mut self, time: Duration) {
        let end = self.robot.port().now() + time;
        while self.robot.port().now() < end {
            let listened = self.robot.listen(BEAT, |_| ControlFlow::Continue(()));
            listened.unwrap();
            self.turn();
        }
    }

    /// Reads what a page reads, and uploads a circle of 70° that swims forwards.
    fn upload(&mut self) {
        self.upload_in_sense(1.0);
    }

    /// A circle in the negative sense swims backwards.
    fn upload_in_sense(&mut self, sense: f64) {
        self.robot.configuration().unwrap();
        let table = GaitTable::from_fn(128, |u| {
            let (sin, cos) = (std::f64::consts::TAU * (sense * u + 0.125)).sin_cos();
            [cos, sin].map(|part| 70.0_f64.to_radians() * part)
        })
        .unwrap();
        let patience = Duration::from_mins(1);
        let go_on = |_| ControlFlow::Continue(());
        self.robot.upload(table.bytes(), patience, go_on).unwrap();
        self.wait(Duration::from_secs(1));
    }

    /// Plays cycles of 10 s until the robot is at rest.
    fn play(&mut self, cycles: u32) {
        self.robot.arm(false).unwrap();
        self.robot
            .play(cycles, Duration::from_secs(10), false)
            .unwrap();
        self.wait(Duration::from_secs(1));
        while self.robot.telemetry().unwrap().state != StateName::Stopped {
            self.wait(Duration::from_millis(100));
        }
        self.wait(Duration::from_secs(1));
    }

    fn cause(&self) -> StopCause {
        self.robot.telemetry().unwrap().cause
    }

    fn warnings(&self) -> Vec<&str> {
        let warns = self.lines.iter().filter(|line| line.warns);
        warns.map(|line| line.text.as_str()).collect()
    }
}

#[test]
fn a_play_that_goes_as_predicted_is_compared_and_left_alone() {
    let mut laboratory = Laboratory::new(&["--port", "twin", "--track", "twin"]);
    laboratory.upload();
    laboratory.play(3);
    assert_eq!(laboratory.cause(), StopCause::Finished);
    assert_eq!(laboratory.warnings(), Vec::<&str>::new());
    assert!(laboratory.stops_s.is_empty());
    let texts: Vec<&str> = laboratory.lines.iter().map(|line| &*line.text).collect();
    for (line, begins) in texts.iter().zip([
        "cycle 1: ",
        "cycle 2: ",
        "cycle 3: ",
        "Predicted over 3 cycles: ",
        "Tracked: ",
    ]) {
        assert!(line.starts_with(begins), "{texts:?}");
    }
    assert_eq!(texts.len(), 5, "{texts:?}");
    for line in &texts[..3] {
        let words: Vec<&str> = line.split([' ', ',']).collect();
        let mm = |index: usize| words[index].parse::<f64>().unwrap();
        let (measured, interval, predicted) = (mm(2), mm(5), mm(9));
        // Half widths of 95 %: four standard deviations.
        assert!((measured - predicted).abs() < 2.0 * interval, "{line}");
    }
}

#[test]
fn a_departure_is_named_within_two_cycles() {
    let mut laboratory = Laboratory::new(&["--port", "twin:robot-slender", "--track", "twin"]);
    laboratory.upload();
    laboratory.play(2);
    let warnings = laboratory.warnings();
    let [warning] = warnings[..] else {
        panic!("{:?}", laboratory.lines)
    };
    assert!(
        warning.starts_with("the robot departs from the prediction since cycle 1: "),
        "{warning}"
    );
    assert!(laboratory.stops_s.is_empty(), "the play goes on");
}

#[test]
fn a_robot_that_is_not_seen_for_five_seconds_is_stopped() {
    let mut laboratory = Laboratory::new(&["--port", "twin", "--track", "twin"]);
    laboratory.upload();
    laboratory.dark_from_s = laboratory.now_s() + 20.0;
    laboratory.play(9);
    assert_eq!(laboratory.cause(), StopCause::Requested);
    let [stop_s] = laboratory.stops_s[..] else {
        panic!("{:?}", laboratory.stops_s)
    };
    let blank_s = stop_s - laboratory.dark_from_s;
    assert!((4.9..5.2).contains(&blank_s), "{blank_s} s");
    let warning = laboratory.warnings().pop().unwrap().to_owned();
    assert!(
        warning.starts_with("The robot was stopped: the robot was not seen for 5.0 s"),
        "{warning}"
    );
    assert_eq!(laboratory.monitor.pose, None, "the page is told so");
}

/// No table passed over the link, so that no cycle is compared.
#[test]
fn a_play_of_an_unknown_gait_is_guarded_too() {
    let mut laboratory = Laboratory::new(&["--port", "twin", "--track", "twin"]);
    laboratory.upload();
    laboratory.monitor.follower.forget_tables();
    laboratory.dark_from_s = laboratory.now_s() + 20.0;
    laboratory.play(9);
    assert_eq!(laboratory.stops_s.len(), 1);
    let warnings = laboratory.warnings();
    assert!(
        warnings[0].contains("was not uploaded by a page of this server"),
        "{warnings:?}"
    );
    assert!(
        warnings[1].contains("was not seen for 5.0 s"),
        "{warnings:?}"
    );
}

#[test]
fn a_robot_near_a_wall_is_stopped_before_it_touches() {
    let wide = ["--port", "twin", "--track", "twin", "--tank", "9x9"];
    let mut free = Laboratory::new(&wide);
    free.upload_in_sense(-1.0);
    free.play(6);
    assert!(free.stops_s.is_empty());
    let (early_m, far_m) = (free.largest_reach_m(20.0), free.largest_reach_m(60.0));
    assert!(far_m > early_m + 0.005, "{early_m} m, then {far_m} m");

    // The margin is reached in the third cycle or later.
    let half_m = early_m + 0.012;
    let tank = format!("{0}x{0}", 2.0 * half_m);
    let narrow = ["--port", "twin", "--track", "twin", "--tank", &tank];
    let mut laboratory = Laboratory::new(&narrow);
    laboratory.upload_in_sense(-1.0);
    laboratory.play(6);
    assert_eq!(laboratory.stops_s.len(), 1);
    assert_eq!(laboratory.cause(), StopCause::Requested);
    let warnings = laboratory.warnings();
    let stopped = "The robot was stopped: the robot came nearer to a wall than 10 mm.";
    assert_eq!(warnings.last(), Some(&stopped), "{warnings:?}");
    let played_s = laboratory.stops_s[0] - laboratory.reaches[0].0;
    assert!((20.0..60.0).contains(&played_s), "{played_s} s");
    // It stopped where the margin is, and not at the wall.
    let reach_m = laboratory.largest_reach_m(60.0);
    assert!(reach_m < half_m - 0.007, "{reach_m} m of {half_m} m");
}
