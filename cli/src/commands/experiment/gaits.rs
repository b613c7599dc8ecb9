//! Gaits of a spec: read, optimised, scaled to neighbours, and predicted.

use std::ffi::OsString;
use std::path::Path;

use experiment::GaitOnRobot;
use experiment::unattended::{
    GaitSource, LeftOut, Measure, PlannedGait, Spec, SpecGait, SpecPeriod,
};
use forecast::path::Polyline;
use forecast::playlist::leads_to;
use forecast::{Played, Servos, Tank, forecast, until_wall};
use link_protocol::MAX_KNOTS;
use nalgebra::Vector2;
use operations::ErrorKind;
use swimmer_files::{AnyGait, Bounds, GaitFile, Objective, SwimmerFile};
use swimmer_model::{Gait as _, Model, Pose};

use crate::arguments::{load_gait, model};
use crate::captured::run_quietly;
use crate::commands::optimize::steer::write_straight;
use crate::commands::robot::table_of;
use crate::failure::{Failure, Outcome};
use crate::output::aside;

/// Samples of a gait file that is made here.
const SAMPLES: usize = 2048;
/// Period at which a forecast gives the shortest period \[s\].
const SLOW_S: f64 = 60.0;

/// Maker of the gaits of an experiment.
pub(super) struct Maker<'a> {
    pub(super) spec: &'a Spec,
    /// Folder of the spec.
    pub(super) home: &'a Path,
    /// Folder of the experiment, in the making.
    pub(super) draft: &'a Path,
    model: Model<f64>,
    servos: Servos,
}

/// Gait with its file, before it is planned.
struct Named {
    name: String,
    file: GaitFile,
    neighbour_of: Option<String>,
    size: f64,
}

impl<'a> Maker<'a> {
    pub(super) fn new(
        spec: &'a Spec,
        home: &'a Path,
        draft: &'a Path,
        swimmer: &'a SwimmerFile,
    ) -> Outcome<Self> {
        Ok(Self {
            spec,
            home,
            draft,
            model: model(swimmer)?,
            servos: Servos::on_the_robot(swimmer.servo.unwrap_or_default()),
        })
    }

    /// Plans every gait with its neighbours, and writes its file.
    ///
    /// # Errors
    /// If a gait cannot be found, or the robot would refuse it.
    pub(super) fn all(&self) -> Outcome<(Vec<PlannedGait>, Vec<LeftOut>)> {
        let (mut planned, mut left_out) = (Vec::new(), Vec::new());
        for gait in &self.spec.gaits {
            let file = self.file(gait)?;
            let of = |name: String, file, size, neighbour_of| Named {
                name,
                file,
                neighbour_of,
                size,
            };
            let optimum = of(gait.name.clone(), file.clone(), 1.0, None);
            planned.push(
                self.planned(gait, &file, &optimum).map_err(|reason| {
                    Failure::BadInput(format!("gait `{}`: {reason}", gait.name))
                })?,
            );
            let Some(share) = gait.neighbours else {
                continue;
            };
            for (sign, size) in [('-', 1.0 - share), ('+', 1.0 + share)] {
                let name = format!("{}{sign}{}", gait.name, (share * 100.0).round());
                let scaled = self.scaled(&file, size)?;
                let neighbour = of(name.clone(), scaled, size, Some(gait.name.clone()));
                match self.planned(gait, &file, &neighbour) {
                    Ok(gait) => planned.push(gait),
                    Err(reason) => {
                        aside(&format!("note: {name} is left out: {reason}"));
                        left_out.push(LeftOut { gait: name, reason });
                    }
                }
            }
        }
        Ok((planned, left_out))
    }

    /// Gait file of an entry of the spec.
    fn file(&self, gait: &SpecGait) -> Outcome<GaitFile> {
        match &gait.source {
            GaitSource::Gait(spec) => {
                let spec = spec.clone().from_folder(self.home);
                if matches!(spec, swimmer_files::GaitSpec::File { .. }) {
                    return Ok(operations::GaitSource::from(spec).file(operations::Files::Disk)?);
                }
                Ok(GaitFile::sampled(&load_gait(&spec)?, SAMPLES))
            }
            GaitSource::Optimize(words) => self.optimized(&gait.name, words),
        }
    }

    /// Runs `swimmer optimize` in this process.
    fn optimized(&self, name: &str, words: &[String]) -> Outcome<GaitFile> {
        let path = self.draft.join(format!(".{name}.optimum"));
        let swimmer = self.draft.join(super::folder::SWIMMER);
        let mut all: Vec<OsString> = vec!["optimize".into()];
        all.extend(words.iter().map(OsString::from));
        if !words.iter().any(|word| word == "--swimmer") {
            all.extend(["--swimmer".into(), swimmer.into_os_string()]);
        }
        all.extend(["-o".into(), path.clone().into_os_string()]);
        run_quietly(all).map_err(|error| {
            let text = format!(
                "gait `{name}`: swimmer optimize {}: {}",
                words.join(" "),
                error.message
            );
            match error.kind {
                ErrorKind::BadInput => Failure::BadInput(text),
                ErrorKind::Failed => Failure::Tried(text),
            }
        })?;
        let file = GaitFile::load(&path)?;
        let _ = std::fs::remove_file(&path);
        Ok(file)
    }

    /// The same curve at another size, within the angles that the optimum is bound to and the servos reach.
    fn scaled(&self, file: &GaitFile, size: f64) -> Outcome<GaitFile> {
        let curve = AnyGait::from_file(file).map_err(|error| Failure::tried(&error))?;
        let limit = self.servos.largest_angle();
        let limit = file
            .bounds
            .max_angle
            .map_or(limit, |angle| angle.min(limit));
        let mut scaled = GaitFile::sampled(&curve, SAMPLES);
        let clipped = |phi: &Vector2<f64>| phi.map(|angle| (angle * size).abs() > limit);
        let is_clipped: Vec<_> = scaled.phi.iter().map(clipped).collect();
        for phi in &mut scaled.phi {
            *phi = phi.map(|angle| (angle * size).clamp(-limit, limit));
        }
        // Where a limit is met or left, the curve has a corner.
        let bends = is_clipped.windows(2).zip(scaled.u.windows(2));
        let bends = bends.filter_map(|(pair, u)| match pair {
            [before, after] if before != after => {
                let is_met = (0..2).any(|joint| !before[joint] && after[joint]);
                Some(if is_met { u[1] } else { u[0] })
            }
            _ => None,
        });
        scaled.corners.extend(bends.filter(|u| *u < 1.0));
        scaled.corners.sort_by(f64::total_cmp);
        scaled.corners.dedup();
        scaled.bounds = Bounds::default();
        Ok(scaled)
    }

    /// Checks and predicts a gait, and writes its file. The error is the reason for which the robot cannot play it.
    fn planned(
        &self,
        spec: &SpecGait,
        optimum: &GaitFile,
        gait: &Named,
    ) -> Result<PlannedGait, String> {
        if let Some(spring) = gait.file.passive {
            return Err(format!(
                "it leaves the {} joint to a spring; an experiment drives both joints",
                spring.joint
            ));
        }
        let curve = AnyGait::from_file(&gait.file).map_err(|error| error.to_string())?;
        let played = |period: f64| Played {
            servos: self.servos,
            period,
            knots: MAX_KNOTS,
        };
        let of = |period: f64| {
            forecast(&self.model, &curve, &played(period)).map_err(|error| error.to_string())
        };
        let period_s = match spec.period {
            SpecPeriod::Seconds(seconds) => seconds,
            SpecPeriod::Shortest => (of(SLOW_S)?.verdict.min_period * 1e3).ceil() / 1e3,
        };
        let predicted = of(period_s)?;
        if predicted.verdict.min_period > period_s {
            return Err(format!(
                "the servos need {:.3} s for a cycle, and the period is {period_s} s",
                predicted.verdict.min_period
            ));
        }
        if let Some(refusal) = predicted.refusal() {
            return Err(format!("the robot would refuse it: {refusal}"));
        }
        let cycles = self.spec.run_in + spec.cycles;
        self.has_room(&curve, cycles)?;
        let table = table_of(&curve).map_err(|error| error.to_string())?;
        let period_us = played(period_s).period_us();
        let on_robot = GaitOnRobot::new(&self.model, &table, period_us, &self.servos, cycles);
        let net = on_robot.mean_motion(self.spec.run_in..cycles);
        let path = format!("gaits/{}.gait", gait.name);
        gait.file
            .save(&self.draft.join(&path))
            .map_err(|error| error.to_string())?;
        let is_speed = optimum.objective == Objective::Speed;
        Ok(PlannedGait {
            name: gait.name.clone(),
            file: path,
            period_s,
            cycles: spec.cycles,
            predicted_xy_m: [net.x, net.y],
            predicted_turn_rad: net.theta,
            measure: if is_speed {
                Measure::Speed
            } else {
                Measure::Displacement
            },
            neighbour_of: gait.neighbour_of.clone(),
            size: gait.size,
        })
    }

    /// Checks that a trial from the start pose stays clear of the walls by the margin.
    fn has_room(&self, curve: &AnyGait, cycles: u32) -> Result<(), String> {
        let (tank, margin) = (self.spec.tank, self.spec.margin_m);
        let inner = Tank {
            length: tank.length - 2.0 * margin,
            width: tank.width - 2.0 * margin,
        };
        let start = &self.spec.start;
        let first = Polyline::new([Vector2::zeros(), curve.at(0.0).phi]);
        let pose = Pose::new(start.x_m, start.y_m, start.heading_rad);
        let pose = pose * leads_to(&self.model, &first);
        let meeting = until_wall(&self.model, curve, &inner, &pose);
        match meeting {
            Some(meeting) if meeting.cycles < f64::from(cycles) => Err(format!(
                "from the start pose {} comes within {margin} m of a wall after {:.1} cycles, and a trial has {cycles}; play fewer cycles, \
                 or start elsewhere",
                meeting.part.word(),
                meeting.cycles
            )),
            _ => Ok(()),
        }
    }
}

/// Writes the gaits that drive to the start pose: those of a folder, or those of `optimize steer`.
///
/// # Errors
/// As the search and the disk.
pub(super) fn drive(maker: &Maker<'_>, swimmer: &SwimmerFile) -> Outcome {
    let target = maker.draft.join(super::folder::DRIVE);
    std::fs::create_dir_all(&target).map_err(|error| {
        Failure::Tried(format!(
            "cannot make the folder {}: {error}",
            target.display()
        ))
    })?;
    let Some(folder) = &maker.spec.drive else {
        return write_straight(swimmer, &target);
    };
    for name in ["forward", "left", "turn-left"] {
        let file = format!("{name}.gait");
        // Read first: an error names the place in the file.
        GaitFile::load(&maker.home.join(folder).join(&file))?.save(&target.join(&file))?;
    }
    Ok(())
}
