//! A simulated laboratory in virtual time: robot, tank and cameras with their faults. It shares only the model and the gait curves
//! with the code under test: joints, servos, integration (Runge–Kutta) and cameras are its own.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::OnceLock;

use experiment::{Controller, FilterCounts, Goal, Options, Pose, Request};
use forecast::{Family, Planner, Scaled, Servos, Step, Tank};
use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::{AnyGait, GaitFile, ServoFile};
use swimmer_model::{Gait, Model, Swimmer};

use crate::cameras::{self, Cameras, Faults};

pub(crate) const TANK: Tank = Tank {
    length: 1.0,
    width: 0.6,
};
pub(crate) const MARGIN: f64 = 0.01;
const STEP_S: f64 = 0.01;
/// Period of the quickest gait, the turn \[s\].
const QUICKEST_S: f64 = 1.5;
/// Share of a cycle at each end in which the joints stand, in the robot's tables.
const STAND: f64 = 4.0 / 512.0;

/// Gaits that join at the straight shape (`swimmer optimize steer --swimmer robot --playable --shape 0,0 -o straight`).
pub(crate) fn family() -> Family {
    let file = ServoFile::default();
    let gaits = ["forward", "left", "turn-left"].map(|name| {
        let path = format!("{}/tests/straight/{name}.gait", env!("CARGO_MANIFEST_DIR"));
        let gait = AnyGait::from_file(&GaitFile::load(Path::new(&path)).unwrap()).unwrap();
        let fastest = (0..4000).map(|i| {
            let rate = gait.at((f64::from(i) + 0.5) / 4000.0).rate;
            rate.x.abs().max(rate.y.abs())
        });
        let period = fastest.fold(0.0, f64::max) / file.max_rate;
        (gait, period)
    });
    Family {
        gaits,
        mirrored: false,
    }
}

pub(crate) fn servos() -> Servos {
    Servos {
        file: ServoFile::default(),
        pulse_step_ns: 0,
    }
}

pub(crate) fn model() -> Model<f64> {
    Model::new(&Swimmer::robot()).unwrap()
}

/// The planner that the controller believes in.
pub(crate) fn planner() -> Planner {
    static PLANNER: OnceLock<Planner> = OnceLock::new();
    PLANNER
        .get_or_init(|| Planner::new(model(), family(), servos(), Some(TANK), MARGIN).unwrap())
        .clone()
}

/// Properties of the laboratory that the controller does not know.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth {
    pub(crate) chi_factor: f64,
    pub(crate) radius_factor: f64,
    /// Joint angle over shaft angle.
    pub(crate) gain: [f64; 2],
    /// \[m/s\], and \[rad/s\].
    pub(crate) drift: [f64; 3],
    /// Share of the frames that are missing, in bursts.
    pub(crate) blanks: f64,
    pub(crate) latency_s: f64,
    pub(crate) jitter_s: f64,
    /// This joint does not move from then on.
    pub(crate) blocked: Option<(usize, f64)>,
    /// The cameras see nothing from then on.
    pub(crate) cut_s: Option<f64>,
    /// Longest time from a request to the play \[s\].
    pub(crate) upload_s: f64,
}

impl Truth {
    /// The robot is as the model says; good cameras.
    pub(crate) fn faultless() -> Self {
        Self {
            chi_factor: 1.0,
            radius_factor: 1.0,
            gain: [1.0; 2],
            drift: [0.0; 3],
            blanks: 0.01,
            latency_s: 0.02,
            jitter_s: 0.002,
            blocked: None,
            cut_s: None,
            upload_s: 2.0,
        }
    }

    /// The robot of the acceptance test: χ +5 %, servo gain −3 %, 0.2 mm/s of drift in a direction of the seed, 30 % of the frames
    /// blank in bursts, 80 ms of latency with jitter.
    pub(crate) fn hard(seed: u64) -> Self {
        let angle = ChaCha8Rng::seed_from_u64(1000 + seed).random::<f64>() * std::f64::consts::TAU;
        Self {
            chi_factor: 1.05,
            gain: [0.97; 2],
            drift: [2e-4 * angle.cos(), 2e-4 * angle.sin(), 0.0],
            blanks: 0.3,
            latency_s: 0.08,
            jitter_s: 0.01,
            ..Self::faultless()
        }
    }
}

enum Motion {
    Rest,
    Upload {
        until: f64,
        gait: Scaled,
        step: Step,
    },
    Play {
        gait: Scaled,
        step: Step,
        began: f64,
    },
    Ramp {
        from: [f64; 2],
        began: f64,
    },
}

/// Notice to the controller.
pub(crate) enum Notice {
    Began(f64),
    AtRest,
}

pub(crate) struct Lab {
    model: Model<f64>,
    pub(crate) truth: Truth,
    pub(crate) now: f64,
    pub(crate) pose: swimmer_model::Pose<f64>,
    shafts: [f64; 2],
    joints: Vector2<f64>,
    motion: Motion,
    rng: ChaCha8Rng,
    camera: ChaCha8Rng,
    blank: bool,
    under_way: Vec<(f64, Pose)>,
    pub(crate) notices: Vec<Notice>,
    pub(crate) touched_wall: bool,
    pub(crate) moved_last: f64,
    /// Share of a cycle at each end in which the joints stand.
    stand: f64,
    /// Shape before a play.
    rest: [f64; 2],
}

impl Lab {
    pub(crate) fn new(truth: Truth, pose: swimmer_model::Pose<f64>, seed: u64) -> Self {
        let mut swimmer = Swimmer::robot();
        swimmer.chi *= truth.chi_factor;
        swimmer.sphere_radius *= truth.radius_factor;
        Self {
            model: Model::new(&swimmer).unwrap(),
            truth,
            now: 0.0,
            pose,
            shafts: [0.0; 2],
            joints: Vector2::zeros(),
            motion: Motion::Rest,
            rng: ChaCha8Rng::seed_from_u64(seed),
            camera: ChaCha8Rng::seed_from_u64(seed + 1_000_000),
            blank: false,
            under_way: Vec::new(),
            notices: Vec::new(),
            touched_wall: false,
            moved_last: 0.0,
            stand: STAND,
            rest: [0.0; 2],
        }
    }

    /// The joints are at the start of a gait that goes on and on, where a soft start has led them.
    pub(crate) fn is_ramped_to(&mut self, start: Vector2<f64>) {
        self.rest = start.into();
        self.shafts = self.rest;
        let gain = self.truth.gain;
        self.joints = Vector2::new(gain[0] * start.x, gain[1] * start.y);
        self.stand = 0.0;
    }

    pub(crate) fn start(&mut self, gait: Scaled, step: Step) {
        let until = self.now + self.truth.upload_s * self.rng.random_range(0.5..1.0);
        self.motion = Motion::Upload { until, gait, step };
    }

    pub(crate) fn stop(&mut self) {
        self.motion = Motion::Ramp {
            from: self.shafts,
            began: self.now,
        };
    }

    pub(crate) fn is_at_rest(&self) -> bool {
        matches!(self.motion, Motion::Rest)
    }

    /// Shapes that the robot commands now.
    fn command(&mut self) -> [f64; 2] {
        match &self.motion {
            Motion::Rest => [0.0; 2],
            Motion::Upload { until, gait, step } => {
                if self.now >= *until {
                    self.notices.push(Notice::Began(self.now));
                    self.motion = Motion::Play {
                        gait: gait.clone(),
                        step: *step,
                        began: self.now,
                    };
                    return self.command();
                }
                self.rest
            }
            Motion::Play { gait, step, began } => {
                // Set-points change 50 times a second.
                let elapsed = ((self.now - began) / 0.02 + 1e-6).floor() * 0.02;
                let cycles = elapsed / step.period;
                if cycles >= f64::from(step.cycles) - 1e-9 {
                    let end = gait.at(0.0).phi;
                    self.motion = Motion::Ramp {
                        from: end.into(),
                        began: self.now,
                    };
                    return self.command();
                }
                let stand = self.stand;
                let moved = ((cycles.fract() - stand) / (1.0 - 2.0 * stand)).clamp(0.0, 1.0);
                gait.at(if moved >= 1.0 { 0.0 } else { moved }).phi.into()
            }
            &Motion::Ramp { from, began } => {
                let largest = from[0].abs().max(from[1].abs());
                let share = if largest > 1e-9 {
                    (1.0 - 2.0 * (self.now - began) / largest).max(0.0)
                } else {
                    0.0
                };
                if share <= 0.0 && self.now - began > 0.1 {
                    self.motion = Motion::Rest;
                    self.notices.push(Notice::AtRest);
                }
                [from[0] * share, from[1] * share]
            }
        }
    }

    /// Lives for a hundredth of a second.
    pub(crate) fn advance(&mut self) {
        let servo = ServoFile::default();
        let command = self.command();
        let mut turned = self.joints;
        for (joint, command) in command.into_iter().enumerate() {
            let error = command - self.shafts[joint];
            let excess = error.abs() - servo.dead_band;
            if excess > 0.0 {
                self.shafts[joint] += excess.min(servo.max_rate * STEP_S).copysign(error);
            }
            let blocked = self
                .truth
                .blocked
                .is_some_and(|(which, since)| which == joint && self.now >= since);
            if !blocked {
                turned[joint] = self.truth.gain[joint] * self.shafts[joint];
            }
        }
        if (turned - self.joints).norm() > 1e-6 {
            self.moved_last = self.now;
        }
        self.move_joints(turned);
        self.now += STEP_S;
        let [x, y, turn] = self.truth.drift;
        self.pose.x += x * STEP_S;
        self.pose.y += y * STEP_S;
        self.pose.theta += turn * STEP_S;
        let swimmer = self.model.swimmer();
        let outline = swimmer
            .links
            .outline(&self.joints)
            .map(|end| self.pose.transform(&end));
        let beyond = |at: &Vector2<f64>, radius: f64| {
            at.x.abs() + radius > 0.5 * TANK.length || at.y.abs() + radius > 0.5 * TANK.width
        };
        self.touched_wall |= outline.iter().any(|at| beyond(at, 0.0))
            || beyond(&self.pose.position(), swimmer.sphere_radius);
        self.expose();
    }

    fn move_joints(&mut self, to: Vector2<f64>) {
        let (from, turn) = (self.joints, to - self.joints);
        let slope = |u: f64, pose: Vector3<f64>| {
            let body = self.model.local_connection(&(from + turn * u)) * turn;
            let (sin, cos) = pose.z.sin_cos();
            Vector3::new(
                cos * body.x - sin * body.y,
                sin * body.x + cos * body.y,
                body.z,
            )
        };
        let start = Vector3::new(self.pose.x, self.pose.y, self.pose.theta);
        let k1 = slope(0.0, start);
        let k2 = slope(0.5, start + k1 * 0.5);
        let k3 = slope(0.5, start + k2 * 0.5);
        let k4 = slope(1.0, start + k3);
        let end = start + (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
        self.pose = swimmer_model::Pose::new(end.x, end.y, end.z);
        self.joints = to;
    }

    fn expose(&mut self) {
        let chance: f64 = self.camera.random();
        // Bursts of 0.2 s on average.
        let ends = 0.05;
        let starts = ends * self.truth.blanks / (1.0 - self.truth.blanks);
        self.blank = if self.blank {
            chance >= ends
        } else {
            chance < starts
        };
        let [x, y, heading, delay]: [f64; 4] =
            std::array::from_fn(|_| StandardNormal.sample(&mut self.camera));
        let cut = self.truth.cut_s.is_some_and(|cut| self.now >= cut);
        if self.blank || cut {
            return;
        }
        // Two reflectors, 0.3 mm each, 71 mm apart.
        let (sigma_position_m, sigma_heading_rad) = (2.1e-4, 6e-3);
        let pose = Pose {
            time_s: self.now,
            x_m: self.pose.x + sigma_position_m * x,
            y_m: self.pose.y + sigma_position_m * y,
            heading_rad: swimmer_model::wrapped_angle(
                self.pose.theta + sigma_heading_rad * heading,
            ),
            sigma_position_m,
            sigma_heading_rad,
        };
        let delay = self.truth.latency_s + self.truth.jitter_s * delay.abs();
        self.under_way.push((self.now + delay, pose));
    }

    /// Poses that have arrived by now.
    pub(crate) fn arrived(&mut self) -> Vec<Pose> {
        let now = self.now;
        let (here, later) = self
            .under_way
            .drain(..)
            .partition(|(arrival, _)| *arrival <= now);
        self.under_way = later;
        let here: Vec<(f64, Pose)> = here;
        here.into_iter().map(|(_, pose)| pose).collect()
    }
}

/// Runs a controller in the laboratory until it is over, or until a time \[s\].
pub(crate) fn drive(
    lab: &mut Lab,
    controller: &mut Controller,
    until_s: f64,
    mut watch: impl FnMut(&mut Lab, &mut Controller),
) {
    let planner = planner();
    while lab.now < until_s && !controller.is_over() {
        lab.advance();
        for pose in lab.arrived() {
            controller.pose(&pose);
        }
        watch(lab, controller);
        exchange(lab, controller, &planner);
    }
}

/// Passes the robot's notices to the controller, and its requests to the robot.
fn exchange(lab: &mut Lab, controller: &mut Controller, planner: &Planner) {
    for notice in std::mem::take(&mut lab.notices) {
        match notice {
            // The clocks match within 20 ms.
            Notice::Began(time) => controller.play_began(time + 0.01),
            Notice::AtRest => controller.at_rest(lab.now),
        }
    }
    while let Some(request) = controller.poll(lab.now) {
        match request {
            Request::Play(step) => lab.start(planner.gait(&step.member), step),
            Request::Stop => lab.stop(),
            Request::Evaluate(evaluation) => controller.evaluated(&evaluation.run()),
        }
    }
}

/// Result of a drive by frames.
pub(crate) struct DriveByFrames {
    pub(crate) controller: Controller,
    pub(crate) counts: FilterCounts,
    /// Poses of the filter that are off the truth by more than [`FAR_SIGMAS`] standard deviations.
    pub(crate) far: Vec<FarPose>,
    pub(crate) poses: usize,
}

/// Pose of the filter that is off the truth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FarPose {
    pub(crate) off_m: f64,
    pub(crate) turned_rad: f64,
}

const FAR_SIGMAS: f64 = 5.0;

/// Drives to a goal by frames of faulty cameras, which the pose filter turns into poses. The run begins once the filter knows the
/// front.
pub(crate) fn drive_by_frames(
    lab: &mut Lab,
    goal: &Goal,
    faults: Faults,
    seed: u64,
    until_s: f64,
) -> DriveByFrames {
    let planner = planner();
    let mut controller = None;
    let (mut far, mut poses, mut truth) = (Vec::new(), 0, Vec::new());
    let mut cameras = Cameras::new(faults, seed);
    let mut filter = cameras::filter(faults.latency_s, QUICKEST_S, None);
    let mut under_way = VecDeque::new();
    while lab.now < until_s && !controller.as_ref().is_some_and(Controller::is_over) {
        lab.advance();
        truth.push(lab.pose);
        if lab.truth.cut_s.is_none_or(|cut| lab.now < cut) {
            under_way.push_back(cameras.expose(lab.now, &lab.pose));
        }
        while let Some(frame) = under_way.pop_front_if(|frame| frame.received_s <= lab.now) {
            filter.push(&frame);
            if let (Some(pose), Some(controller)) = (filter.take_pose(lab.now), &mut controller) {
                poses += 1;
                far.extend(far_pose(&pose, &truth));
                controller.pose(&pose);
            }
        }
        if controller.is_none() && filter.knows_front() {
            let options = Options::default();
            controller = Some(Controller::new(
                planner.clone(),
                goal.clone(),
                options,
                lab.now,
            ));
        }
        if let Some(controller) = &mut controller {
            exchange(lab, controller, &planner);
        }
    }
    DriveByFrames {
        controller: controller.expect("the front was never known"),
        counts: filter.counts(),
        far,
        poses,
    }
}

/// Compares a pose with the true ones, one every [`STEP_S`] from time zero. Returns `None` if it is near.
fn far_pose(pose: &Pose, truth: &[swimmer_model::Pose<f64>]) -> Option<FarPose> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a time of the run
    let step = (pose.time_s / STEP_S).round().max(1.0) as usize - 1;
    let there = truth.get(step.min(truth.len() - 1))?;
    let off_m = (pose.x_m - there.x).hypot(pose.y_m - there.y);
    let turned_rad = swimmer_model::wrapped_angle(pose.heading_rad - there.theta).abs();
    let sigmas = (off_m / pose.sigma_position_m).max(turned_rad / pose.sigma_heading_rad);
    (sigmas > FAR_SIGMAS).then_some(FarPose { off_m, turned_rad })
}
