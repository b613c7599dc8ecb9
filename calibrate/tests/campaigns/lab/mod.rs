//! An independent laboratory that shares no code with the project: its own swimmer ([`body`]), joints and integration ([`swim`]),
//! cameras ([`cameras`]) and files ([`files`]), so that no model confirms itself. `lab_check.rs` compares it with printed
//! numbers.
//!
//! A [`Lab`] is the truth; [`Lab::campaign`] is what its people write down and record. Everything is seeded.
// Each test takes of it what it needs.

pub(crate) mod body;
pub(crate) mod cameras;
pub(crate) mod files;
pub(crate) mod swim;
pub(crate) mod walls;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use calibrate::{CampaignData, RunData, Timing, read_tracks};
use swimmer_files::{AnyGait, Campaign, ServoFile, SwimmerFile};

pub(crate) use body::Body;
pub(crate) use cameras::{Bump, Cameras, Faults, Places};
pub(crate) use swim::{Joint, Loop, Play, State};

/// One run as it really went.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    /// Amplitude of the circle \[deg\].
    pub(crate) degrees: f64,
    /// `true` if it ran clockwise, which is not written down.
    pub(crate) clockwise: bool,
    /// Factor of the tank's walls on every translation.
    pub(crate) wall: f64,
    /// Start pose: x, y \[m\] and heading \[rad\].
    pub(crate) start: [f64; 3],
    pub(crate) faults: Faults,
}

impl Run {
    pub(crate) fn of(degrees: f64) -> Self {
        Self {
            degrees,
            clockwise: false,
            wall: 1.0,
            start: [0.4, -0.2, 0.8],
            faults: Faults::default(),
        }
    }
}

/// True state of a laboratory.
#[derive(Debug, Clone)]
pub(crate) struct Lab {
    pub(crate) body: Body,
    /// Lengths of the links as its people write them down: middle, front, back \[m\].
    pub(crate) stated: [f64; 3],
    pub(crate) joints: [Joint; 2],
    pub(crate) cameras: Cameras,
    /// True positions of the reflectors. The campaign always states that they sit at the ends of the middle link, and those of
    /// the side links at [`SIDE_PLACE`].
    pub(crate) places: Places,
    pub(crate) period_s: f64,
    pub(crate) cycles: u32,
    pub(crate) runs: Vec<Run>,
    /// The servos that the swimmer file names; `None` for ideal ones.
    pub(crate) known_servo: Option<ServoFile>,
    /// `true` if the campaign names points (`Front`, `Back`), `false` if it leaves them to be found.
    pub(crate) named: bool,
    /// `true` if a flash marks the starts of cycles.
    pub(crate) flash: bool,
    /// Inner measures of the tank about the origin, if its walls act on the swimmer \[m\].
    pub(crate) walls: Option<[f64; 2]>,
    /// `true` if the campaign states them.
    pub(crate) walls_stated: bool,
    pub(crate) seed: u64,
}

/// Stated position of side links' reflectors: outwards from the joint, to the left \[m\].
pub(crate) const SIDE_PLACE: [f64; 2] = [0.1, 0.0];

impl Lab {
    /// Six circles of six cycles under cameras of 100 Hz and 0.3 mm, nothing wrong: r_s 54.5 mm, χ 2.93.
    pub(crate) fn new(seed: u64) -> Self {
        let body = Body::ROBOT;
        Self {
            body,
            stated: [body.middle, body.front, body.back],
            joints: [Joint::EXACT; 2],
            cameras: Cameras::FULL,
            places: Places {
                front: [body.middle / 2.0, 0.0],
                back: [-body.middle / 2.0, 0.0],
                sides: None,
            },
            period_s: 10.0,
            cycles: 6,
            runs: [30.0, 50.0, 70.0, 85.0, 100.0, 110.0].map(Run::of).to_vec(),
            known_servo: None,
            named: true,
            flash: false,
            walls: None,
            walls_stated: false,
            seed,
        }
    }

    /// The same at 20 Hz, a few milliseconds a campaign.
    pub(crate) fn sparse(seed: u64) -> Self {
        Self {
            cameras: Cameras::SPARSE,
            ..Self::new(seed)
        }
    }

    /// With runs of these amplitudes \[deg\].
    pub(crate) fn with_runs(mut self, degrees: &[f64]) -> Self {
        self.runs = degrees.iter().copied().map(Run::of).collect();
        self
    }

    /// With each run in another direction and at another place of the tank.
    pub(crate) fn with_runs_all_over(mut self) -> Self {
        for (index, run) in self.runs.iter_mut().enumerate() {
            let turn = 2.4 * index as f64;
            let away = 0.1 + 0.08 * index as f64;
            run.start = [away * turn.cos(), away * turn.sin(), 0.8 + turn];
        }
        self
    }

    /// With this gain of both joints.
    pub(crate) fn with_gain(mut self, gain: f64) -> Self {
        for joint in &mut self.joints {
            joint.gain = gain;
        }
        self
    }

    /// With reflectors on the side links, where the campaign says.
    pub(crate) fn with_side_reflectors(mut self) -> Self {
        self.places.sides = Some([SIDE_PLACE; 2]);
        self
    }

    pub(crate) fn with_noise(mut self, noise: f64) -> Self {
        self.cameras.noise = noise;
        self
    }

    pub(crate) fn play(&self, run: &Run) -> Play {
        Play {
            gait: Loop::Circle(run.degrees.to_radians()),
            clockwise: run.clockwise,
            period_s: self.period_s,
            cycles: self.cycles,
            rest_s: 1.3,
            soft_s: 1.5,
        }
    }

    /// True course of a run.
    pub(crate) fn states(&self, index: usize) -> Vec<State> {
        let run = &self.runs[index];
        swim::swim(
            &self.body,
            &self.joints,
            &self.play(run),
            (run.wall, self.walls),
            self.cameras.rate_hz,
            run.start,
        )
    }

    fn frames(&self, index: usize) -> Vec<cameras::Frame> {
        cameras::see(
            &self.states(index),
            &self.body,
            &self.places,
            &self.cameras,
            &self.runs[index].faults,
            self.seed * 1000 + index as u64,
        )
    }

    fn marked(&self) -> usize {
        if self.places.sides.is_some() { 4 } else { 2 }
    }

    /// A run's recording as a plain table.
    pub(crate) fn table(&self, index: usize) -> String {
        files::table(&self.frames(index), self.cameras.rate_hz, self.marked())
    }

    /// A run's recording as Motive writes it.
    pub(crate) fn motive(&self, index: usize) -> String {
        files::motive(&self.frames(index), self.cameras.rate_hz, self.marked())
    }

    /// The swimmer as its people know it: lengths, form of c_t and servos, but χ = 2 and no sphere.
    pub(crate) fn known(&self) -> SwimmerFile {
        let mut known = SwimmerFile::preset("robot-slender").expect("a preset");
        let links = &mut known.swimmer.links;
        [links.middle, links.front, links.back] = self.stated;
        known.servo = self.known_servo;
        known
    }

    /// The campaign file's text; tracks are called `run0.csv` and so on.
    pub(crate) fn campaign_text(&self, swimmer: &str) -> String {
        let half = self.stated[0] / 2.0;
        let point = |name: &str| {
            if self.named {
                name.to_owned()
            } else {
                "auto".to_owned()
            }
        };
        let mut out = format!("swimmer = \"{swimmer}\"\n[reflectors]\n");
        let mut reflector = |key: &str, name: &str, at: [f64; 2]| {
            writeln!(
                out,
                "{key} = {{ point = \"{name}\", at = [{:?}, {:?}] }}",
                at[0], at[1]
            )
            .expect("a String takes all");
        };
        reflector("front", &point("Front"), [half, 0.0]);
        reflector("back", &point("Back"), [-half, 0.0]);
        if self.places.sides.is_some() {
            reflector("front_link", "FrontLink", SIDE_PLACE);
            reflector("back_link", "BackLink", SIDE_PLACE);
        }
        if let (Some([x, y]), true) = (self.walls, self.walls_stated) {
            writeln!(out, "[known]\ntank = {{ size = [{x:?}, {y:?}] }}")
                .expect("a String takes all");
        }
        for (index, run) in self.runs.iter().enumerate() {
            write!(
                out,
                "[[run]]\ntrack = \"run{index}.csv\"\ngait = \"circle:{}deg\"\nperiod_s = {:?}\n",
                run.degrees, self.period_s
            )
            .expect("a String takes all");
        }
        out
    }

    /// The campaign and its data in memory, by way of plain tables.
    pub(crate) fn campaign(&self) -> (Campaign, CampaignData) {
        let text = self.campaign_text("robot-slender");
        let mut campaign =
            Campaign::parse(&text, Path::new("campaign.toml")).expect("a campaign of ours");
        campaign.swimmer = self.known();
        let runs = (0..self.runs.len()).map(|index| self.run(index)).collect();
        let told = Vec::new();
        (
            campaign,
            CampaignData {
                runs,
                reported_gaits: told,
                ..CampaignData::default()
            },
        )
    }

    /// A run, read from its table.
    pub(crate) fn run(&self, index: usize) -> RunData {
        let file = PathBuf::from(format!("run{index}.csv"));
        let degrees = self.runs[index].degrees;
        RunData {
            track: read_tracks(self.table(index).as_bytes(), &file).expect("a table of ours"),
            file,
            gait: AnyGait::circle(degrees.to_radians()),
            gait_name: format!("circle:{degrees}deg"),
            period_s: self.period_s,
            front: None,
            timing: Timing {
                cycle_start_s: self
                    .flash
                    .then(|| self.play(&self.runs[index]).first_cycle_s()),
                ..Timing::default()
            },
        }
    }

    /// Writes campaign, swimmer and Motive files into a folder; the campaign's path.
    pub(crate) fn write(&self, folder: &Path) -> std::io::Result<PathBuf> {
        let path = folder.join("campaign.toml");
        std::fs::write(&path, self.campaign_text("swimmer.toml"))?;
        std::fs::write(folder.join("swimmer.toml"), self.known().to_toml())?;
        for index in 0..self.runs.len() {
            std::fs::write(folder.join(format!("run{index}.csv")), self.motive(index))?;
        }
        Ok(path)
    }
}
