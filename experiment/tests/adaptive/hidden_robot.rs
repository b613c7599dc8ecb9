//! Robot whose χ and r_s are not those of its file, in a tank with currents, under cameras with noise. It shares only the model with the
//! code under test: integration (Runge–Kutta) and cameras are its own. Tracks are measured as those of a campaign, by `calibrate`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use calibrate::{RunData, Timing, TrackOptions, calibrate_run, read_tracks_with};
use experiment::adaptive::MeasuredTrial;
use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::{AnyGait, PointName, Reflector, Reflectors, SwimmerFile};
use swimmer_model::{Gait as _, Model, Pose};

pub(crate) const PERIOD_S: f64 = 12.0;
/// Cycles of a trial, with one of run-in.
pub(crate) const CYCLES: u32 = 5;
/// Rest before a trial \[s\].
pub(crate) const SETTLE_S: f64 = 20.0;
const RATE_HZ: f64 = 30.0;
const FRAMES: u32 = 360;
/// Half of the distance between the reflectors \[m\].
const REACH_M: f64 = 0.0355;
/// Noise of a reflector's coordinate: from frame to frame, and of a wobble that lasts for about a second \[m\].
const NOISE_M: f64 = 7.5e-4;
const WOBBLE_M: f64 = 9e-4;
const WOBBLE_S: f64 = 1.0;
/// Current of a trial, each component \[m/s\].
const CURRENT: f64 = 4.5e-5;

/// Hidden robot.
pub(crate) struct HiddenRobot {
    file: SwimmerFile,
    truth: Model<f64>,
    rng: ChaCha8Rng,
    /// Poses of one cycle of each gait that was played, with that at its end.
    cycles: BTreeMap<usize, Vec<Pose<f64>>>,
}

impl HiddenRobot {
    /// χ and r_s within 15 % of the file's.
    pub(crate) fn new(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(9000 + seed);
        let file = SwimmerFile::preset("robot").unwrap();
        let mut swimmer = file.swimmer;
        swimmer.chi *= rng.random_range(0.85..1.15);
        swimmer.sphere_radius *= rng.random_range(0.85..1.15);
        Self {
            file,
            truth: Model::new(&swimmer).unwrap(),
            rng,
            cycles: BTreeMap::new(),
        }
    }

    /// True χ and r_s \[m\].
    pub(crate) fn truth(&self) -> [f64; 2] {
        let swimmer = self.truth.swimmer();
        [swimmer.chi, swimmer.sphere_radius]
    }

    /// Plays, tracks and measures one trial.
    pub(crate) fn trial(&mut self, candidate: usize, gait: &AnyGait) -> MeasuredTrial {
        let text = self.table(candidate, gait);
        let reflectors = reflectors();
        let track = read_tracks_with(
            text.as_bytes(),
            Path::new("trial.csv"),
            &TrackOptions::default(),
        );
        let run = RunData {
            file: "trial.csv".into(),
            track: track.unwrap(),
            gait: gait.clone(),
            gait_name: String::new(),
            period_s: PERIOD_S,
            front: None,
            timing: Timing::default(),
        };
        let measured = calibrate_run(&run, &reflectors, &self.file).unwrap().cycles;
        let quantities = [measured.x, measured.delta_y, measured.delta_theta];
        MeasuredTrial {
            candidate,
            values: quantities.map(|quantity| quantity.mean),
            standard_errors: quantities.map(|quantity| quantity.se),
        }
    }

    /// Plays one trial. Returns its track as a table.
    pub(crate) fn table(&mut self, candidate: usize, gait: &AnyGait) -> String {
        let truth = &self.truth;
        let cycle = self
            .cycles
            .entry(candidate)
            .or_insert_with(|| swum(truth, gait))
            .clone();
        self.track(&cycle)
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }

    /// Table of the reflectors.
    fn track(&mut self, cycle: &[Pose<f64>]) -> String {
        let step = *cycle.last().unwrap();
        let heading = self.rng.random_range(-3.0..3.0);
        let mut start = Pose::new(0.0, 0.0, heading);
        let current = Vector2::new(self.normal(), self.normal()) * CURRENT;
        let memory = (-1.0 / (RATE_HZ * WOBBLE_S)).exp();
        let mut wobble = [0.0; 4];
        for value in &mut wobble {
            *value = WOBBLE_M * self.normal();
        }
        let mut text = "t,Front_x,Front_y,Back_x,Back_y\n".to_owned();
        let mut frame = 0_u32;
        for _ in 0..CYCLES {
            for pose in &cycle[..cycle.len() - 1] {
                let time = f64::from(frame) / RATE_HZ;
                let here = start * *pose;
                let drifted = here.position() + current * time;
                let (sin, cos) = here.theta.sin_cos();
                let _ = write!(text, "{time:.4}");
                for (index, wobble) in wobble.iter_mut().enumerate() {
                    let innovation: f64 = StandardNormal.sample(&mut self.rng);
                    let noise: f64 = StandardNormal.sample(&mut self.rng);
                    *wobble =
                        memory * *wobble + WOBBLE_M * (1.0 - memory * memory).sqrt() * innovation;
                    let along = if index < 2 { REACH_M } else { -REACH_M };
                    let exact = if index % 2 == 0 {
                        drifted.x + along * cos
                    } else {
                        drifted.y + along * sin
                    };
                    let _ = write!(text, ",{:.7}", exact + *wobble + NOISE_M * noise);
                }
                text.push('\n');
                frame += 1;
            }
            start = start * step;
        }
        text
    }
}

fn reflectors() -> Reflectors {
    let reflector = |name: &str, along: f64| Reflector {
        point: PointName::Named(name.to_owned()),
        at: [along, 0.0],
    };
    Reflectors {
        front: reflector("Front", REACH_M),
        back: reflector("Back", -REACH_M),
        sides: None,
        body: None,
    }
}

/// Poses of one cycle at the cameras' frames, and at its end.
fn swum(model: &Model<f64>, gait: &AnyGait) -> Vec<Pose<f64>> {
    const STEPS: u32 = 8;
    let step = 1.0 / f64::from(FRAMES * STEPS);
    let slope = |u: f64, pose: Vector3<f64>| {
        let point = gait.at(u);
        let body = model.local_connection(&point.phi) * point.rate;
        let (sin, cos) = pose.z.sin_cos();
        Vector3::new(
            cos * body.x - sin * body.y,
            sin * body.x + cos * body.y,
            body.z,
        )
    };
    let mut pose = Vector3::zeros();
    let mut poses = vec![Pose::new(0.0, 0.0, 0.0)];
    for frame in 0..FRAMES {
        for inner in 0..STEPS {
            let u = f64::from(frame * STEPS + inner) * step;
            // Rates at corners are those of the side on which the step lies.
            let (from, middle, to) = (u + 1e-9, u + 0.5 * step, u + step - 1e-9);
            let k1 = slope(from, pose);
            let k2 = slope(middle, pose + k1 * (0.5 * step));
            let k3 = slope(middle, pose + k2 * (0.5 * step));
            let k4 = slope(to, pose + k3 * step);
            pose += (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (step / 6.0);
        }
        poses.push(Pose::new(pose.x, pose.y, pose.z));
    }
    poses
}
