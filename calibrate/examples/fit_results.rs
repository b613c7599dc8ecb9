//! A fit of the sphere and χ to reported results: `cargo run --release -p calibrate --example fit_results CAMPAIGN.toml`

use calibrate::{CampaignData, FitOptions, JointEstimate, assess, calibrate_campaign};
use swimmer_files::Campaign;

/// Three circles of the paper's robot, as read off a figure, rounded to a tenth of a millimetre.
const TOLD: &str = r#"
swimmer = "robot"
[[run]]
gait = "circle:40deg"
period_s = 30.0
cycles = 7
x_mm = 1.7
x_se_mm = 0.05
[[run]]
gait = "circle:70deg"
period_s = 30.0
cycles = 7
x_mm = 5.6
x_se_mm = 0.05
[[run]]
gait = "circle:100deg"
period_s = 30.0
cycles = 7
x_mm = 9.5
x_se_mm = 0.05
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let campaign = match std::env::args().nth(1) {
        Some(path) => Campaign::load(path.as_ref())?,
        None => Campaign::parse(TOLD, "told.toml".as_ref())?,
    };
    let data = CampaignData::load(&campaign)?;
    let found = calibrate_campaign(&campaign, &data, FitOptions::default())?;
    let [low, high] = found.fit.intervals.chi;
    println!("r_s = {:.2} mm", 1e3 * found.fit.sphere_radius);
    println!("chi = {:.3}, {low:.3} to {high:.3}", found.fit.chi);
    let assessment = assess(&found, &JointEstimate::of(&found)?, None);
    println!("{}: {}", assessment.verdict, assessment.reasons.join("; "));
    Ok(())
}
