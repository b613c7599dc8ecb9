//! `swimmer optimize steer`: the fastest gaits to steer by, from one common shape.

use std::path::Path;

use gait_optimizer::{Joined, SpeedProblem, SteerProblem, Steering, steer};
use swimmer_files::SwimmerFile;
use swimmer_model::Pose;

use super::{Objective, SearchResult, Task};
use crate::arguments::{angle, rate};
use crate::bounds::CycleBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::own_robot::servo_rates;
use crate::progress::Progress;
use crate::quantity;
use crate::threads;

/// Find the fastest gaits forward, backward, to either side and round, all through one common shape at which they join
///
/// Backward, right and the turn to the right are the others run backwards, which undoes them exactly. Of
/// the shapes tried, the one at which joining costs the three least is chosen. The cost and a certificate of each gait are printed.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Steer {
    /// No servo turns faster than this angle a second; a second one is that of joint 2
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2, required_unless_present = "playable")]
    max_rate: Vec<f64>,
    #[command(flatten)]
    bounds: CycleBounds,
    /// The shape at which the gaits shall join: φ₁ and φ₂
    #[arg(long, value_name = "ANGLE,ANGLE", value_parser = shape, allow_hyphen_values = true)]
    pub(crate) shape: Option<[f64; 2]>,
}

fn shape(text: &str) -> Result<[f64; 2], String> {
    let (one, two) = text
        .split_once(',')
        .ok_or_else(|| format!("`{text}` is no shape: give ANGLE,ANGLE, as 80deg,32deg"))?;
    Ok([angle(one.trim())?, angle(two.trim())?])
}

impl Steer {
    /// Playable gaits that join at the straight shape.
    pub(crate) fn straight() -> Self {
        Self {
            max_rate: Vec::new(),
            bounds: CycleBounds::for_playing(),
            shape: Some([0.0; 2]),
        }
    }

    /// The rates of the servos \[rad/s\].
    ///
    /// # Errors
    /// [`Failure::BadInput`] where there is none.
    pub(crate) fn rates(&self, file: &SwimmerFile) -> Outcome<[f64; 2]> {
        servo_rates(&self.max_rate, self.bounds.playable(), file)
            .ok_or_else(|| Failure::BadInput("give --max-rate or --playable".to_owned()))
    }

    /// The gaits.
    ///
    /// # Errors
    /// Those of the search.
    pub(crate) fn find(&self, file: &SwimmerFile) -> Outcome<Steering> {
        let progress = Progress::with_share("looking for gaits that join");
        let problem = SteerProblem {
            of: SpeedProblem {
                bounds: self.bounds.of(file),
                threads: threads::available(),
                ..SpeedProblem::new(file.swimmer, self.rates(file)?)
            },
            shape: self.shape,
        };
        Ok(steer(&problem, &|share| progress.at_share(share))?)
    }
}

/// The gaits with their names: each kind, and the same run backwards.
pub(crate) fn named(steering: &Steering) -> [(&'static str, &Joined, bool); 6] {
    let Steering {
        forward,
        left,
        turn,
        ..
    } = steering;
    [
        ("forward", forward, false),
        ("backward", forward, true),
        ("left", left, false),
        ("right", left, true),
        ("turn-left", turn, false),
        ("turn-right", turn, true),
    ]
}

/// Searches the gaits that join at the straight shape, and writes them into a folder.
///
/// # Errors
/// Those of the search and of the disk.
pub(crate) fn write_straight(file: &SwimmerFile, folder: &Path) -> Outcome {
    let steering = Steer::straight().find(file)?;
    for (name, joined, backwards) in named(&steering) {
        let gait = joined.gait_file(&file.name, backwards);
        gait.save(&folder.join(format!("{name}.gait")))?;
    }
    Ok(())
}

impl Objective for Steer {
    const FOLDER: bool = true;
    const WRITES: &'static str = "Write the six gaits into this folder";

    fn search(&self, task: &Task) -> Outcome<SearchResult> {
        let file = &task.file;
        let steering = task.timed(|| self.find(file))?;
        let [one, two] = steering.shape.map(quantity::angle);
        let mut document = Document::new(format!(
            "{}: six gaits that join at ({one}, {two}), the best of {} shapes",
            file.name, steering.shapes
        ));
        let gaits = named(&steering).map(|(name, joined, backwards)| {
            let file_name = format!("{name}.gait");
            let mut gait = Document::default();
            add(&mut gait, &mut document, file, (name, joined, backwards));
            gait.key_if("gait", task.output.map(|folder| folder.join(&file_name)));
            (gait, (file_name, joined.gait_file(&file.name, backwards)))
        });
        let (documents, gaits): (Vec<_>, Vec<_>) = gaits.into_iter().unzip();
        document
            // Where the gaits join, and how many shapes were tried.
            .key("shape_rad", steering.shape)
            .key("shapes", steering.shapes)
            .key("gaits", documents)
            .key("seconds", task.seconds.get());
        Ok(SearchResult { document, gaits })
    }
}

/// Adds one of the six, and its line to the answer.
fn add(
    gait: &mut Document,
    document: &mut Document,
    file: &SwimmerFile,
    (name, joined, backwards): (&'static str, &Joined, bool),
) {
    let length = file.swimmer.total_length();
    let turns = name.starts_with("turn");
    let [x, y, theta] = joined.net;
    let there = Pose::new(x, y, theta);
    let net = if backwards { there.inverse() } else { there };
    let certificate = &joined.gait.certificate;
    gait.key("name", name)
        // Motion of a cycle in the frame of the middle link at the common shape.
        .key("x_m", net.x * length)
        .key("y_m", net.y * length)
        .key("rotation_rad", net.theta)
        .key("period_s", joined.period)
        // |d|/(L T), or of those that turn |Δθ|/T.
        .key("speed_over_length_per_s", (!turns).then_some(joined.rate))
        .key("rotation_rad_per_s", turns.then_some(joined.rate))
        // Share of the fastest gait's speed.
        .key("joining_costs", joined.cost())
        .key("certificate", certificate.clone());
    let checks = certificate.checks();
    let verdict = match checks.iter().filter(|check| !check.pass).count() {
        0 => format!("{} conditions hold", checks.len()),
        fails => format!("{fails} of {} conditions fail", checks.len()),
    };
    document.row(
        name,
        format!(
            "({}, {}, {}) in {:.3} s; joining costs {:.2} %; {verdict}",
            quantity::length(net.x * length),
            quantity::length(net.y * length),
            quantity::angle(net.theta),
            joined.period,
            joined.cost() * 100.0
        ),
    );
}
