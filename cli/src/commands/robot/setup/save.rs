//! The end of a setup: everything onto the robot, a look at it, and the swimmer file.

use std::path::{Path, PathBuf};

use link_protocol::{Configuration, Joint};
use swimmer_files::{ServoFile, SwimmerFile};
use twin::configuration;

use super::super::preflight::configured;
use super::super::servo::{self, Set};
use super::measured::{Measured, full_range};
use super::operator::takes_it;
use super::output::{Done, Servo};
use super::{Bench, JOINTS, Setup, export};
use crate::failure::{Failure, Outcome};
use crate::quantity;

/// Presets as which a robot can be configured.
fn configurable_presets() -> Vec<&'static str> {
    let can_be = |name: &&str| {
        SwimmerFile::preset(name).is_some_and(|file| file.swimmer.common_drag().is_ok())
    };
    SwimmerFile::PRESETS.into_iter().filter(can_be).collect()
}

impl Bench<'_> {
    /// Swimmer whose lengths the robot has.
    pub(super) fn swimmer(&mut self, named: Option<SwimmerFile>) -> Outcome<SwimmerFile> {
        if let Some(file) = named {
            return Ok(file);
        }
        let present = self.resuming(|bench| Ok(bench.line.robot.configuration()?))?;
        let (name, swimmer) = configured(&present);
        let lengths = [
            swimmer.links.front,
            swimmer.links.middle,
            swimmer.links.back,
        ];
        let [front, middle, back] = lengths.map(|metres| (metres * 1e5).round() / 1e2);
        let question = format!(
            "Which swimmer is it? A preset ({}) or the path of a swimmer file with its lengths; Enter: as the robot is configured, {name} ({front} / {middle} / {back} mm)",
            configurable_presets().join(", ")
        );
        let standard = SwimmerFile {
            name,
            swimmer,
            fluid: None,
            servo: None,
            passive: None,
        };
        self.ask(&question, |answer| match answer {
            answer if takes_it(answer) => Ok(standard.clone()),
            path => SwimmerFile::find(path).map_err(|error| error.to_string()),
        })
    }

    /// Everything onto the robot; gives the file that says the same.
    pub(super) fn save(
        &mut self,
        swimmer: &SwimmerFile,
        joints: [&Measured; 2],
    ) -> Outcome<SwimmerFile> {
        // A repetition sets the same values.
        self.may_be_changed = true;
        self.resuming(|bench| bench.save_once(swimmer, joints))
    }

    fn save_once(&mut self, swimmer: &SwimmerFile, joints: [&Measured; 2]) -> Outcome<SwimmerFile> {
        let robot = &mut self.line.robot;
        let present = robot.configuration()?;
        let limits = robot.info().limits;
        let try_open = joints.map(|measured| measured.ends[1].max(-measured.ends[0]));
        let max_angle = try_open[0]
            .max(try_open[1])
            .min(f64::from(limits.max_angle));
        #[allow(clippy::cast_possible_truncation)] // the wire's precision
        let wanted = Configuration {
            max_angle: limits.max_angle.min(max_angle as f32),
            max_rate: present.max_rate,
            ..configuration(&swimmer.swimmer, &ServoFile::default())?
        };
        robot.configure(wanted)?;
        for (joint, measured) in JOINTS.into_iter().zip(joints) {
            let full = full_range(&limits);
            servo::set_range(robot, joint, full)?;
            servo::set(robot, joint, measured.settings)?;
            servo::set_range(robot, joint, measured.range(full))?;
        }
        self.line.stored("the servos' maps are")?;
        // From here on there is nothing to put back.
        self.before = joints.map(|measured| measured.settings);
        let base = swimmer.servo.unwrap_or_default();
        Ok(SwimmerFile {
            servo: Some(ServoFile {
                max_angle: (max_angle * 1e4).round() / 1e4,
                max_rate: f64::from(wanted.max_rate).min(base.max_rate),
                dead_band: export::rounded(joints[0].dead_band.max(joints[1].dead_band)),
                ..base
            }),
            ..swimmer.clone()
        })
    }

    /// The joints straight by the new maps, and, if wanted, once to their ends.
    pub(super) fn verify(&mut self, front: &Measured, back: &Measured) -> Outcome {
        self.power()?;
        let band = quantity::angle(front.dead_band.max(back.dead_band));
        let question =
            format!("Are both links straight, as nearly as a dead band of ±{band} lets them?");
        if !self.yes(&question, true)? {
            return Err(Failure::Tried(
                "with the saved settings the links are not straight: did a horn slip, or was an angle read with the wrong sign? Run `swimmer robot setup` again"
                    .to_owned(),
            ));
        }
        let question = "Swing each joint once, slowly, to its ends, to see that nothing touches? (The gait that the robot holds is replaced by that swing.)";
        if self.yes(question, false)? {
            self.swing(Joint::Front, front.ends)?;
            self.power()?;
            self.swing(Joint::Back, back.ends)?;
        }
        self.rest()
    }

    /// The swimmer file, where one is wanted, and the answer.
    pub(super) fn written(
        &mut self,
        arguments: &Setup,
        file: SwimmerFile,
        joints: [Measured; 2],
    ) -> Outcome<Done> {
        let set = self.resuming(|bench| {
            let robot = &mut bench.line.robot;
            Ok([
                Set::read(robot, Joint::Front)?,
                Set::read(robot, Joint::Back)?,
            ])
        })?;
        let place = match &arguments.output {
            Some(place) => Some(place.clone()),
            None => self.ask(
                "Write a swimmer file with these servos? Type its name, as ours.toml; Enter or n: none",
                file_name,
            )?,
        };
        if let Some(place) = &place {
            export::write(place, &file, &set)?;
        }
        let servo = file.servo.unwrap_or_default();
        let [front, back] = set;
        let dead_bands = joints.map(|measured| measured.dead_band);
        Ok(Done {
            swimmer: file.name,
            front: Servo {
                set: front,
                dead_band_rad: dead_bands[0],
            },
            back: Servo {
                set: back,
                dead_band_rad: dead_bands[1],
            },
            dead_band_rad: servo.dead_band,
            max_angle_rad: servo.max_angle,
            file: place.map(|place| place.display().to_string()),
        })
    }
}

/// Parses the name of a swimmer file to write; `None` if there shall be no file.
fn file_name(answer: &str) -> Result<Option<PathBuf>, String> {
    match answer {
        "" | "n" | "no" => Ok(None),
        name if Path::new(name).extension().is_some_and(|end| end == "toml") => {
            export::may_be_written(Path::new(name), None)
                .map(|()| Some(PathBuf::from(name)))
                .map_err(|failure| failure.to_string())
        }
        _ => Err("Type a name that ends in .toml, or Enter for no file.".to_owned()),
    }
}
