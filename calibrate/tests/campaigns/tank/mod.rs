//! A small tank of our own: a swimmer that plays a gait, and cameras with every fault that recordings have. Kept apart from
//! the twin, so that neither can hide the other's mistakes.
#![allow(dead_code)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::fmt::Write;
use std::path::PathBuf;

use calibrate::{RunData, Timing, read_tracks};
use gait_player::GaitTable;
use gait_player::servo::ServoMap;
use gait_player::servo::plant::{PlantParameters, ServoPlant};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::{
    AnyGait, Campaign, CampaignRun, GaitSpec, Known, PointName, Reflector, Reflectors, RunTiming,
    ServoFile, SwimmerFile, TrackSettings,
};
use swimmer_model::{Gait, Model, Pose, Swimmer};

/// The first heading, rad.
const HEADING: f64 = 0.8;

/// One recording.
#[derive(Clone)]
pub(crate) struct Tank {
    pub(crate) swimmer: Swimmer<f64>,
    pub(crate) servo: Option<ServoFile>,
    pub(crate) gait: AnyGait,
    pub(crate) period_s: f64,
    pub(crate) cycles: u32,
    pub(crate) rate_hz: f64,
    /// Noise of each coordinate, m.
    pub(crate) noise: f64,
    /// Velocity of the fluid along the first heading, m/s.
    pub(crate) current: f64,
    /// Chance that a reflector is missing in a frame.
    pub(crate) dropout: f64,
    /// Stretches (first frame, frames) in which both are missing.
    pub(crate) gaps: Vec<(usize, usize)>,
    /// Displacement of reflectors from their places in the three frames next to such a stretch, m.
    pub(crate) tails: f64,
    /// Stretches in which the labels are exchanged.
    pub(crate) swaps: Vec<(usize, usize)>,
    pub(crate) ghosts: bool,
    pub(crate) seed: u64,
    /// Rest before and after, s.
    pub(crate) rest_s: f64,
    /// Steps of the midpoint rule from frame to frame.
    pub(crate) steps: u32,
}

impl Tank {
    pub(crate) fn new(swimmer: Swimmer<f64>, gait: AnyGait) -> Self {
        Self {
            swimmer,
            servo: None,
            gait,
            period_s: 10.0,
            cycles: 5,
            rate_hz: 100.0,
            noise: 3e-4,
            current: 0.0,
            dropout: 0.005,
            gaps: Vec::new(),
            tails: 0.0,
            swaps: Vec::new(),
            ghosts: true,
            seed: 1,
            rest_s: 1.3,
            steps: 5,
        }
    }

    /// No noise, nothing missing, no ghosts.
    pub(crate) fn perfect(mut self) -> Self {
        (self.noise, self.dropout, self.ghosts) = (0.0, 0.0, false);
        self
    }

    /// The middle link's pose in every frame.
    pub(crate) fn poses(&self) -> Vec<Pose<f64>> {
        let model = Model::new(&self.swimmer).unwrap();
        let soft_s = 1.5;
        let moving = soft_s + self.period_s * f64::from(self.cycles);
        let total = moving + 2.0 * self.rest_s;
        let start = self.gait.at(0.0).phi;
        let wanted = |t: f64| {
            let t = t - self.rest_s;
            if t < 0.0 {
                Vector2::zeros()
            } else if t < soft_s {
                start * (t / soft_s)
            } else if t < moving {
                self.gait.at((t - soft_s) / self.period_s).phi
            } else {
                start
            }
        };
        let table = self
            .servo
            .map(|_| GaitTable::from_fn(512, |u| self.gait.at(u).phi.into()).unwrap());
        let servos = self.servo.map(|servo| {
            (
                PlantParameters {
                    max_rate: servo.max_rate,
                    dead_band: servo.dead_band,
                    pulse_step_ns: 0,
                },
                servo,
            )
        });
        let mut shafts = [ServoPlant::new(0.0); 2];
        // Steps that fit into frames and into ticks of 20 ms.
        let per_frame = self.steps;
        let dt = 1.0 / (self.rate_hz * f64::from(per_frame));
        // Ticks begin with the cycle, as the brain's do.
        let tick_of = |t: f64| {
            ((t - self.rest_s - soft_s) / 0.02 + 1e-9).floor() * 0.02 + self.rest_s + soft_s
        };
        let mut pose = Pose::new(0.4, -0.2, HEADING);
        let mut phi = wanted(0.0);
        let mut out = vec![pose];
        for step in 1..=(total / dt) as u32 {
            let (before, t) = (f64::from(step - 1) * dt, f64::from(step) * dt);
            let next = match &servos {
                None => wanted(t),
                Some((plant, servo)) => {
                    let map = ServoMap {
                        centre_ns: (servo.centre_us * 1e3) as u32,
                        slope_rad_per_us: servo.slope_rad_per_us as f32,
                        ..ServoMap::ROBOT
                    };
                    let tick = tick_of(before);
                    let since = tick - self.rest_s - soft_s;
                    let command = if since >= 0.0 && since < moving - soft_s {
                        let table = table.as_ref().unwrap();
                        let in_cycle = (since.rem_euclid(self.period_s) * 1e6).round() as u32
                            % (self.period_s * 1e6) as u32;
                        table
                            .at(table.phase(in_cycle, (self.period_s * 1e6) as u32))
                            .angles
                    } else {
                        let phi = wanted(tick);
                        [phi.x as f32, phi.y as f32]
                    };
                    for (shaft, angle) in shafts.iter_mut().zip(command) {
                        shaft.advance(plant, plant.command(&map, map.pulse_ns(angle)), dt);
                    }
                    Vector2::new(shafts[0].angle, shafts[1].angle)
                }
            };
            pose =
                pose * Pose::exp(&(model.local_connection(&((phi + next) / 2.0)) * (next - phi)));
            phi = next;
            if step % per_frame == 0 {
                out.push(pose);
            }
        }
        out
    }

    fn reach(&self) -> f64 {
        self.swimmer.links.middle / 2.0
    }

    /// Camera frames: front, back and two ghosts, (x, y, height).
    fn frames(&self) -> Vec<[Option<[f64; 3]>; 4]> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut ghosts = [None; 2];
        let beside = |i: usize| {
            let near = |(a, n): &(usize, usize)| i + 3 >= *a && i < a + n + 3;
            if self.gaps.iter().any(near) {
                self.tails
            } else {
                0.0
            }
        };
        let within = |stretches: &[(usize, usize)], i: usize| {
            stretches.iter().any(|(a, n)| i >= *a && i < a + n)
        };
        let see = |(i, pose): (usize, Pose<f64>)| {
            let mut points: [Option<[f64; 3]>; 4] = [None; 4];
            for (place, along) in points.iter_mut().zip([self.reach(), -self.reach()]) {
                let drifted = self.current * i as f64 / self.rate_hz;
                let p = pose.transform(&Vector2::new(along, 0.0))
                    + Vector2::new(HEADING.cos(), HEADING.sin()) * drifted;
                let [a, b, c]: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(&mut rng));
                if rng.random::<f64>() >= self.dropout && !within(&self.gaps, i) {
                    *place = Some([
                        p.x + self.noise * a + beside(i),
                        p.y + self.noise * b,
                        0.05 + self.noise * c,
                    ]);
                }
            }
            if within(&self.swaps, i) {
                points.swap(0, 1);
            }
            for (ghost, place) in ghosts.iter_mut().zip(&mut points[2..]) {
                let (dx, dy, chance): (f64, f64, f64) = (rng.random(), rng.random(), rng.random());
                *ghost = match *ghost {
                    None if chance < 0.01 => {
                        Some([pose.x + 0.2 * (dx - 0.5), pose.y + 0.2 * (dy - 0.5), 0.05])
                    }
                    Some(_) if chance < 0.02 => None,
                    same => same,
                };
                *place = ghost.filter(|_| self.ghosts);
            }
            points
        };
        self.poses().into_iter().enumerate().map(see).collect()
    }

    /// Format of Motive: Y up, (x, y) = (Z, X), six digits.
    pub(crate) fn motive(&self) -> String {
        let names = ["Front", "Back", "Unlabeled 1201", "Unlabeled 1202"];
        let frames = self.frames();
        let rate = self.rate_hz;
        let mut out = format!(
            "Format Version,1.23,Take Name,tank,Take Notes,,Capture Frame Rate,{rate:.6},Export Frame Rate,{rate:.6},Total Frames in Take,{n},Total Exported Frames,{n},Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global\r\n\r\n",
            n = frames.len()
        );
        let row = |cell: &dyn Fn(usize, usize) -> String| {
            let places = (0..4).flat_map(|p| (0..3).map(move |a| (p, a)));
            places.fold(String::new(), |row, (p, a)| row + "," + &cell(p, a))
        };
        write!(
            out,
            ",Type{}\r\n,Name{}\r\n,ID{}\r\n,{}\r\nFrame,Time (Seconds){}\r\n",
            row(&|_, _| "Marker".into()),
            row(&|p, _| names[p].into()),
            row(&|p, _| format!("\"A{p}\"")),
            row(&|_, _| "Position".into()),
            row(&|_, a| ["X", "Y", "Z"][a].into())
        )
        .unwrap();
        for (i, points) in frames.iter().enumerate() {
            write!(out, "{i},{:.6}", i as f64 / rate).unwrap();
            for point in points {
                match point {
                    Some([x, y, h]) => write!(out, ",{y:.6},{h:.6},{x:.6}").unwrap(),
                    None => out.push_str(",,,"),
                }
            }
            out.push_str("\r\n");
        }
        out
    }

    /// A plain table at full precision.
    pub(crate) fn table(&self) -> String {
        let mut out = String::from("t,x1,y1,x2,y2,x3,y3,x4,y4\n");
        for (i, points) in self.frames().iter().enumerate() {
            write!(out, "{:?}", i as f64 / self.rate_hz).unwrap();
            for point in points {
                match point {
                    Some([x, y, _]) => write!(out, ",{x:?},{y:?}").unwrap(),
                    None => out.push_str(",,"),
                }
            }
            out.push('\n');
        }
        out
    }

    pub(crate) fn run_of(&self, text: &str) -> RunData {
        let file = PathBuf::from(format!("run{}.csv", self.seed));
        RunData {
            track: read_tracks(text.as_bytes(), &file).unwrap(),
            file,
            gait: self.gait.clone(),
            gait_name: "test".into(),
            period_s: self.period_s,
            front: None,
            timing: Timing::default(),
        }
    }

    pub(crate) fn run(&self) -> RunData {
        self.run_of(&self.motive())
    }

    pub(crate) fn reflectors(&self, front: PointName, back: PointName) -> Reflectors {
        Reflectors {
            front: Reflector {
                point: front,
                at: [self.reach(), 0.0],
            },
            back: Reflector {
                point: back,
                at: [-self.reach(), 0.0],
            },
            body: None,
            sides: None,
        }
    }

    pub(crate) fn named(&self) -> Reflectors {
        self.reflectors(
            PointName::Named("Front".into()),
            PointName::Named("Back".into()),
        )
    }

    pub(crate) fn auto(&self) -> Reflectors {
        self.reflectors(PointName::Auto, PointName::Auto)
    }
}

/// The same swimmer as it is known before a calibration: χ = 2 and no sphere.
pub(crate) fn known(truth: &Swimmer<f64>, servo: Option<ServoFile>) -> SwimmerFile {
    SwimmerFile {
        name: "known".into(),
        swimmer: Swimmer {
            chi: 2.0,
            sphere_radius: 0.0,
            ..*truth
        },
        fluid: None,
        servo,
        passive: None,
    }
}

/// Runs at several amplitudes with the settings of `tank`, and their campaign.
pub(crate) fn campaign(
    tank: &Tank,
    degrees: &[f64],
    text: impl Fn(&Tank) -> String,
    reflectors: Reflectors,
) -> (Campaign, calibrate::CampaignData) {
    let runs: Vec<RunData> = degrees
        .iter()
        .zip(0..)
        .map(|(amplitude, i)| {
            let run = Tank {
                gait: AnyGait::circle(amplitude.to_radians()),
                seed: tank.seed * 1000 + i,
                ..tank.clone()
            };
            run.run_of(&text(&run))
        })
        .collect();
    let listed = degrees
        .iter()
        .zip(&runs)
        .map(|(amplitude, run)| CampaignRun {
            reported: None,
            track: run.file.clone(),
            gait: GaitSpec::Circle {
                amplitude: amplitude.to_radians(),
                clockwise: false,
            },
            period_s: run.period_s,
            front: None,
            timing: RunTiming::default(),
            exclude: None,
        });
    let campaign = Campaign {
        swimmer: known(&tank.swimmer, tank.servo),
        swimmer_path: None,
        reflectors,
        tracks: TrackSettings::default(),
        known: Known::default(),
        runs: listed.collect(),
    };
    (
        campaign,
        calibrate::CampaignData {
            runs,
            ..calibrate::CampaignData::default()
        },
    )
}
