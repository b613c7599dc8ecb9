//! Campaigns of a laboratory that does not know its swimmer: a twin plays circles behind its link, cameras write tracking
//! files, and everything that goes wrong in laboratories goes wrong by chance: noise, drop-outs, exchanged labels, a camera
//! clock that runs differently, fluid that drifts.

use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Duration;

use calibrate::{CampaignData, RunData, Timing, read_tracks};
use gait_player::GaitTable;
use host_link::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::{
    AnyGait, Campaign, CampaignRun, GaitSpec, Known, PointName, Reflector, Reflectors, RunTiming,
    ServoFile, SwimmerFile, TrackSettings,
};
use swimmer_model::{Gait as _, Swimmer};
use twin::{CameraConfig, Twin, TwinConfig, TwinPort, WireSpeed};

/// True state of one laboratory.
#[derive(Debug, Clone)]
pub(crate) struct Laboratory {
    pub(crate) swimmer: Swimmer<f64>,
    pub(crate) servo: ServoFile,
    /// True zeros of the joints \[rad\].
    pub(crate) offsets: [f64; 2],
    /// Amplitudes \[deg\].
    pub(crate) amplitudes: Vec<f64>,
    pub(crate) cycles: u32,
    pub(crate) period_s: u32,
    pub(crate) camera: CameraConfig,
    /// Stretches of exchanged labels in each run.
    pub(crate) swaps: usize,
    /// Cameras' clock over the robot's.
    pub(crate) clock: f64,
    /// Deviation of the fluid's velocity from run to run \[m/s\].
    pub(crate) drift: f64,
    /// Random walk within a run \[m/√s\].
    pub(crate) walk: f64,
    pub(crate) seed: u64,
}

impl Laboratory {
    /// A laboratory of good cameras, still fluid and a known swimmer.
    pub(crate) fn quiet(seed: u64) -> Self {
        Self {
            swimmer: Swimmer::robot(),
            servo: ServoFile::default(),
            offsets: [0.0; 2],
            amplitudes: vec![30.0, 50.0, 70.0, 90.0, 110.0],
            cycles: 6,
            period_s: 8,
            camera: CameraConfig {
                noise_sd: 3e-4,
                ..CameraConfig::default()
            },
            swaps: 0,
            clock: 1.0,
            drift: 0.0,
            walk: 0.0,
            seed,
        }
    }

    /// Everything by chance: noise of 0.1 to 1 mm, 5 to 9 amplitudes, 5 to 20 cycles.
    pub(crate) fn by_chance(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut within = |low: f64, high: f64| rng.random_range(low..high);
        let swimmer = Swimmer {
            sphere_radius: within(0.03, 0.1),
            chi: within(2.0, 5.0),
            ..Swimmer::robot()
        };
        let servo = ServoFile {
            dead_band: within(0.0, 0.03),
            ..ServoFile::default()
        };
        let mut log = |low: f64, high: f64| within(low.ln(), high.ln()).exp();
        let camera = CameraConfig {
            noise_sd: log(1e-4, 1e-3),
            single_dropout: log(1e-3, 2e-2),
            burst_dropout: log(1e-4, 2e-3),
            ..CameraConfig::default()
        };
        let (drift, walk) = (log(1e-6, 2e-5), log(5e-6, 5e-5));
        let clock = 1.0 + within(-1e-3, 1e-3);
        let runs: usize = rng.random_range(5..=9);
        let spread = 90.0 / runs as f64;
        let amplitudes = (0..runs)
            .map(|i| 20.0 + spread * (i as f64 + rng.random_range(0.1..0.9)))
            .collect();
        Self {
            swimmer,
            servo,
            offsets: [0.0; 2],
            amplitudes,
            cycles: rng.random_range(5..=20),
            period_s: rng.random_range(6..=12),
            camera,
            swaps: rng.random_range(0..=3),
            clock,
            drift,
            walk,
            seed,
        }
    }

    /// The campaign as the laboratory writes it down: lengths, servos and the form of `c_t`, but χ = 2 and no sphere.
    pub(crate) fn campaign(&self) -> (Campaign, CampaignData) {
        let runs: Vec<RunData> = (0..self.amplitudes.len()).map(|i| self.run(i)).collect();
        let listed = self.amplitudes.iter().zip(&runs).map(|(degrees, run)| {
            let amplitude = degrees.to_radians();
            CampaignRun {
                reported: None,
                track: run.file.clone(),
                gait: GaitSpec::Circle {
                    amplitude,
                    clockwise: false,
                },
                period_s: run.period_s,
                front: None,
                timing: RunTiming::default(),
                exclude: None,
            }
        });
        let reach = self.swimmer.links.middle / 2.0;
        let reflector = |name: &str, at: f64| Reflector {
            point: PointName::Named(name.into()),
            at: [at, 0.0],
        };
        let campaign = Campaign {
            swimmer_path: None,
            swimmer: SwimmerFile {
                name: "known".into(),
                swimmer: Swimmer {
                    chi: 2.0,
                    sphere_radius: 0.0,
                    ..self.swimmer
                },
                fluid: None,
                servo: Some(self.servo),
                passive: None,
            },
            reflectors: Reflectors {
                front: reflector("Front", reach),
                back: reflector("Back", -reach),
                body: None,
                sides: None,
            },
            tracks: TrackSettings::default(),
            known: Known::default(),
            runs: listed.collect(),
        };
        (
            campaign,
            CampaignData {
                runs,
                ..CampaignData::default()
            },
        )
    }

    fn run(&self, index: usize) -> RunData {
        let gait = AnyGait::circle(self.amplitudes[index].to_radians());
        let text = self.spoil(&self.swim(index, &gait), index);
        let file = PathBuf::from(format!("run{index}.csv"));
        RunData {
            track: read_tracks(text.as_bytes(), &file).unwrap(),
            file,
            gait,
            gait_name: format!("circle:{}deg", self.amplitudes[index]),
            period_s: f64::from(self.period_s),
            front: None,
            timing: Timing::default(),
        }
    }

    /// Uploads, plays and records: the tracking file.
    fn swim(&self, index: usize, gait: &AnyGait) -> String {
        let seed = self.seed * 100 + index as u64;
        let mut config = TwinConfig::from_parts(self.swimmer, &self.servo, seed);
        config.camera = self.camera.clone();
        let port = TwinPort::new(Twin::new(config).unwrap(), WireSpeed::robot());
        let mut robot = Robot::connect(port, seed).unwrap();
        let table = GaitTable::from_fn(512, |u| {
            let phi = gait.at(u).phi;
            [phi.x + self.offsets[0], phi.y + self.offsets[1]]
        })
        .unwrap();
        robot
            .upload(table.bytes(), Duration::from_mins(1), |_| {
                ControlFlow::Continue(())
            })
            .unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("track.csv");
        robot
            .port_mut()
            .device_mut()
            .start_recording(&path)
            .unwrap();
        robot.arm(false).unwrap();
        let period = Duration::from_secs(self.period_s.into());
        robot.play(self.cycles, period, false).unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap();
        robot.port_mut().device_mut().finish_recording().unwrap();
        std::fs::read_to_string(path).unwrap()
    }

    /// Faults that the cameras' makers do not exclude: exchanged labels, another clock, and a drifting fluid.
    fn spoil(&self, text: &str, index: usize) -> String {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed * 100 + index as u64);
        rng.set_stream(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let velocity = [self.drift * normal(), self.drift * normal()];
        let rate = f64::from(twin::Camera::RATE_HZ) / self.clock;
        let frames = text.lines().count() - 7;
        let swaps: Vec<(usize, usize)> = (0..self.swaps)
            .map(|_| {
                let from = normal().abs() * frames as f64 / 2.0;
                (from as usize, 3 + (40.0 * normal().abs()) as usize)
            })
            .collect();
        let mut away = [0.0; 2];
        let mut out = String::with_capacity(text.len());
        for (number, line) in text.lines().enumerate() {
            if number == 0 {
                let stated = format!("Rate,{}.000000", twin::Camera::RATE_HZ);
                out += &line.replace(&stated, &format!("Rate,{rate:.9}"));
            } else if number < 7 {
                out += line;
            } else {
                let frame = number - 7;
                let cells: Vec<&str> = line.split(',').collect();
                write!(out, "{frame},{:.6}", frame as f64 / rate).unwrap();
                for (away, velocity) in away.iter_mut().zip(velocity) {
                    *away += velocity / rate + self.walk * normal() / rate.sqrt();
                }
                let swapped = swaps.iter().any(|(a, n)| (*a..a + n).contains(&frame));
                let order = if swapped { [1, 0, 2, 3] } else { [0, 1, 2, 3] };
                for point in order {
                    let triple = &cells[2 + 3 * point..5 + 3 * point];
                    if triple[0].is_empty() {
                        out += ",,,";
                        continue;
                    }
                    let value = |axis: usize| triple[axis].parse::<f64>().unwrap();
                    // (x, y) = (Z, X).
                    let (x, z) = (value(0) + away[1], value(2) + away[0]);
                    write!(out, ",{x:.6},{},{z:.6}", triple[1]).unwrap();
                }
            }
            out += "\r\n";
        }
        out
    }
}
