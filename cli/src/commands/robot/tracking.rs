//! Poses of the robot by the cameras, on the port's clock, while a command holds the robot.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

use experiment::{CameraDelay, Course, FilterEvent, FilterOptions, Pose, PoseFilter};
use pose_source::{Frame, Received, Recorder, Settings, SourceName, Stream};
use swimmer_files::{PointName, Reflector, Reflectors, RigidBody};
use swimmer_model::Links;

use super::access::RobotConnection;
use super::tank_cameras::TankCameras;
use crate::arguments::angle;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::aside;
use crate::recording::LiveAxes;

/// Longest time until the cameras show the robot and its front \[s\].
pub(super) const PATIENCE_S: f64 = 20.0;
/// Frames that are read at once from a stream; the rest follows at the next beat.
const MOST_AT_ONCE: usize = 512;
/// Period of the quickest cycle that a robot plays, a turn of `optimize steer` \[s\].
const QUICKEST_S: f64 = 1.5;
/// Names of the reflectors unless others are given.
const FRONT: &str = "Front";
const BACK: &str = "Back";

/// Origin of the frames.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Tracking")]
pub(crate) struct Tracked {
    /// Where the cameras' frames come from: natnet[:HOST[,LOCAL]] (Motive), tcp:HOST:PORT (JSON lines), - (JSON lines on standard
    /// input), or `twin` for the cameras of --port twin or emulator
    #[arg(long, value_name = "SOURCE")]
    pub(super) track: SourceName,
    #[command(flatten)]
    pub(super) visible: Visible,
}

/// Names of what the cameras see, and the source's axes.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Tracking")]
pub(crate) struct Visible {
    /// Name of the reflector at the front end of the middle link; `Front` if left out
    #[arg(long, value_name = "NAME")]
    front: Option<String>,
    /// Name of the reflector at its back end; `Back` if left out
    #[arg(long, value_name = "NAME")]
    back: Option<String>,
    /// Name of a rigid body instead, with its pivot at the centre of the middle link and its axis along it. A source with one body
    /// and without these reflectors needs no name
    #[arg(long, value_name = "NAME", conflicts_with_all = ["front", "back"])]
    body: Option<String>,
    /// Heading of the robot at the start, within 90°: for reflectors without names
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    facing: Option<f64>,
    #[command(flatten)]
    axes: LiveAxes,
}

impl Tracked {
    /// Source of these frames, and what is in them.
    pub(crate) fn new(track: SourceName, visible: Visible) -> Self {
        Self { track, visible }
    }

    /// Source and names of these cameras.
    pub(crate) fn cameras(&self) -> CamerasOf<'_> {
        self.visible.of(&self.track)
    }

    /// Reflectors or body that were named; `None` if none was.
    pub(crate) fn reflectors(&self, links: &Links<f64>) -> Option<Reflectors> {
        let Visible {
            front, back, body, ..
        } = &self.visible;
        let is_named = front.is_some() || back.is_some() || body.is_some();
        is_named.then(|| self.visible.reflectors(links))
    }
}

impl Visible {
    /// Names of the reflectors or of the rigid body, and the source's axes. `None` for the usual names.
    pub(crate) fn new(
        front: Option<String>,
        back: Option<String>,
        body: Option<String>,
        facing: Option<f64>,
        axes: LiveAxes,
    ) -> Self {
        Self {
            front,
            back,
            body,
            facing,
            axes,
        }
    }

    /// Reflectors at the ends of the middle link, and the body, by their names.
    fn reflectors(&self, links: &Links<f64>) -> Reflectors {
        let reflector = |name: Option<&String>, usual: &str, along: f64| Reflector {
            point: PointName::Named(name.map_or_else(|| usual.to_owned(), Clone::clone)),
            at: [along, 0.0],
        };
        Reflectors {
            front: reflector(self.front.as_ref(), FRONT, links.middle / 2.0),
            back: reflector(self.back.as_ref(), BACK, -links.middle / 2.0),
            sides: None,
            body: self.body.clone().map(RigidBody::named),
        }
    }

    /// Cameras behind a source that see these things.
    pub(super) fn of<'a>(&'a self, source: &'a SourceName) -> CamerasOf<'a> {
        CamerasOf {
            source,
            visible: self,
        }
    }
}

/// Source of frames, and what is in them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CamerasOf<'a> {
    pub(super) source: &'a SourceName,
    pub(super) visible: &'a Visible,
}

impl CamerasOf<'_> {
    /// Refuses a source that cannot show this robot. `is_fresh`: the robot is a virtual one of this process.
    ///
    /// # Errors
    /// [`Failure::BadInput`].
    pub(super) fn check(&self, is_fresh: bool) -> Outcome {
        let problem = match self.source {
            SourceName::File(path) => format!(
                "{} is a recording, or does not exist: the robot needs cameras that see it now, as natnet:HOST or tcp:HOST:PORT",
                path.display()
            ),
            SourceName::Twin if !is_fresh => {
                "--track twin are the cameras of a fresh virtual robot: give --port twin or emulator; `swimmer twin --natnet` streams \
                 those of a twin behind another port"
                    .to_owned()
            }
            SourceName::Twin => return Ok(()),
            _ if is_fresh => {
                "only --track twin sees a fresh virtual robot; `swimmer twin --pty LINK --natnet ADDR` makes one that other cameras see"
                    .to_owned()
            }
            _ => return Ok(()),
        };
        Err(Failure::BadInput(problem))
    }

    /// Opens the source. Frames of a fresh virtual robot come by `tank`.
    ///
    /// # Errors
    /// A connection that is refused.
    pub(super) fn open(&self, tank: TankCameras, links: &Links<f64>) -> Outcome<Tracking> {
        let middle_m = links.middle;
        let named = self.visible;
        let reflectors = named.reflectors(links);
        let may_take_a_body = named.front.is_none() && named.back.is_none() && named.body.is_none();
        let options = FilterOptions {
            period_s: QUICKEST_S,
            ..FilterOptions::new(reflectors, middle_m)
        };
        let filter = filter(&options)?;
        let frames = if *self.source == SourceName::Twin {
            Frames::Tank(tank)
        } else {
            let settings = Settings {
                options: named.axes.options(),
                ..Settings::default()
            };
            Frames::Stream(Stream::open(self.source, &settings)?)
        };
        Ok(Tracking {
            source: self.source.to_string(),
            frames,
            options,
            filter,
            may_take_a_body,
            facing: named.facing,
            delay: CameraDelay::default(),
            track: None,
            ended: false,
        })
    }
}

fn filter(options: &FilterOptions) -> Outcome<PoseFilter> {
    PoseFilter::new(options.clone()).ok_or_else(|| {
        Failure::BadInput(
            "the middle link has no length: cameras cannot show its heading".to_owned(),
        )
    })
}

#[derive(Debug)]
enum Frames {
    /// Received on the stream's own clock.
    Stream(Stream),
    /// Received on the port's clock.
    Tank(TankCameras),
}

/// Recording of the frames in a file.
struct Track {
    path: PathBuf,
    recorder: Recorder,
}

/// Source of poses.
pub(super) struct Tracking {
    source: String,
    frames: Frames,
    options: FilterOptions,
    filter: PoseFilter,
    /// The only rigid body of the source may take the place of reflectors that are missing.
    may_take_a_body: bool,
    facing: Option<f64>,
    delay: CameraDelay,
    track: Option<Track>,
    ended: bool,
}

impl Tracking {
    /// Poses of the frames that have arrived, with times on the port's clock, of which `port_s` is the present time \[s\].
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub(super) fn poses(&mut self, port_s: f64) -> Outcome<Vec<Pose>> {
        let (frames, now_s) = match &self.frames {
            Frames::Tank(cameras) => (cameras.take(), port_s),
            Frames::Stream(stream) => {
                let frames = received(stream, &self.source, &mut self.ended);
                (frames, stream.now_s())
            }
        };
        let mut poses = Vec::new();
        for frame in frames {
            if let Some(track) = &mut self.track {
                let written = track.recorder.write(&frame);
                written.map_err(|error| Failure::tried(&error))?;
            }
            self.identify(&frame)?;
            if let Some(event) = self.filter.push(&frame) {
                report(event);
            }
            if let Some(pose) = self.filter.take_pose(now_s) {
                let time_s = pose.time_s + (port_s - now_s);
                poses.push(self.delay.dated(&Pose { time_s, ..pose }));
            }
        }
        Ok(poses)
    }

    /// Follows the only rigid body of the source if the reflectors are not in its frames, and settles the front by the heading.
    fn identify(&mut self, frame: &Frame) -> Outcome {
        if self.filter.knows_front() {
            return Ok(());
        }
        if let Some(facing) = self.facing {
            self.filter.face(facing);
        }
        if !self.may_take_a_body {
            return Ok(());
        }
        let has_reflectors = [FRONT, BACK]
            .iter()
            .any(|name| frame.marker(name).is_some());
        self.may_take_a_body = !has_reflectors;
        if let ([body], false) = (frame.bodies.as_slice(), has_reflectors)
            && let Some(name) = &body.name
        {
            aside(&format!(
                "note: the cameras show no reflectors {FRONT} and {BACK}: the pose is that of the rigid body {name}."
            ));
            self.options.reflectors.body = Some(RigidBody::named(name.clone()));
            self.filter = filter(&self.options)?;
            self.may_take_a_body = false;
        }
        Ok(())
    }

    /// Waits until the cameras show the robot and its front.
    ///
    /// # Errors
    /// [`Failure::Tried`] if they do not, or if the operator stops; the link's.
    pub(super) fn wait_for_robot(
        &mut self,
        line: &mut RobotConnection,
        interrupt: &Interrupt,
    ) -> Outcome {
        let begun_s = port_s(line);
        while !self.knows_front() {
            line.beat()?;
            let now_s = port_s(line);
            self.poses(now_s)?;
            if interrupt.requested() {
                return Err(Failure::Tried(format!(
                    "{}: nothing was moved",
                    interrupt.pressed()
                )));
            }
            if self.ended || now_s - begun_s > PATIENCE_S {
                return Err(Failure::Tried(self.not_shown()));
            }
        }
        Ok(())
    }

    /// Returns `true` once the cameras have shown the robot and its front.
    pub(super) fn knows_front(&self) -> bool {
        self.filter.knows_front()
    }

    /// Reason why no pose is known, with the next step.
    pub(super) fn not_shown(&self) -> String {
        let (counts, source) = (self.filter.counts(), &self.source);
        let advice = if self.filter.is_tracked() {
            "two points are the reflectors, but none of them has its name, so that the front is unknown. Name them with --front and \
             --back, or give the robot's heading with --facing"
        } else {
            "name the reflectors with --front and --back, or the rigid body with --body"
        };
        format!(
            "the cameras do not show the robot: {} frames from {source}, {} with both reflectors or the body; `swimmer track {source}` \
             lists what they see; {advice}",
            counts.frames, counts.both
        )
    }

    /// A play began: the first cycle of its course shows the delay of the cameras.
    pub(super) fn play_began(&mut self, course: Course, began_s: f64) {
        self.delay.began(course, began_s);
    }

    /// The play under way was interrupted.
    pub(super) fn play_interrupted(&mut self) {
        self.delay.interrupt();
    }

    /// Delay of the cameras that they do not state \[s\]; `None` until a play has shown it.
    pub(super) fn delay_s(&self) -> Option<f64> {
        self.delay.delay_s()
    }

    /// Records the frames from now on into this CSV file, in place of one of the same name.
    ///
    /// # Errors
    /// If it cannot be made.
    pub(super) fn begin_track(&mut self, path: &Path) -> Outcome {
        let recorder = Recorder::create(path).map_err(|error| Failure::tried(&error))?;
        self.track = recorder.map(|recorder| Track {
            path: path.to_path_buf(),
            recorder,
        });
        Ok(())
    }

    /// Ends the recording, and waits until it is on the disk.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn end_track(&mut self) -> Outcome {
        let Some(Track { path, recorder }) = self.track.take() else {
            return Ok(());
        };
        recorder.finish().map_err(|error| Failure::tried(&error))?;
        let synced = std::fs::File::open(&path).and_then(|file| file.sync_all());
        synced.map_err(|error| {
            Failure::Tried(format!(
                "cannot write {}: {error}; is the disk full?",
                path.display()
            ))
        })
    }
}

/// Time on the port's clock \[s\].
pub(super) fn port_s(line: &RobotConnection) -> f64 {
    use host_link::Port as _;
    line.robot.port().now().as_secs_f64()
}

fn received(stream: &Stream, source: &str, ended: &mut bool) -> VecDeque<Frame> {
    let mut frames = VecDeque::new();
    while !*ended && frames.len() < MOST_AT_ONCE {
        match stream.next(Duration::ZERO) {
            Received::Frame(frame) => frames.push_back(frame),
            Received::Nothing => break,
            Received::Ended(outcome) => {
                *ended = true;
                let why = outcome
                    .err()
                    .map_or_else(String::new, |error| format!(": {error}"));
                aside(&format!("note: {source} has ended{why}."));
            }
        }
    }
    frames
}

fn report(event: FilterEvent) {
    match event {
        FilterEvent::Jumped {
            moved_m,
            turned_rad,
        } => aside(&format!(
            "note: the tracked pose jumped by {:.0} mm and {:.0}°: were the cameras or the robot moved?",
            moved_m * 1e3,
            turned_rad.to_degrees()
        )),
        FilterEvent::Lost => aside("note: the cameras see the robot no more."),
        FilterEvent::ClockSet => aside("note: the camera clock was set back."),
        FilterEvent::Found | FilterEvent::TurnedRound => {}
    }
}
