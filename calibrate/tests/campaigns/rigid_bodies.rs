//! Campaigns whose middle link is a rigid body of the tracking program. The simulated laboratory (`lab`) shares no code with the
//! workspace.

use crate::lab;

use std::fmt::Write;
use std::io::Cursor;
use std::path::Path;

use calibrate::{CampaignData, FitOptions, FrontRule, calibrate_campaign};
use lab::Lab;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::Campaign;

/// Place of the body's pivot on the link \[m\], and direction of its own axis from the link \[deg\].
const AT: [f64; 2] = [0.011, -0.006];
const TURNED_DEG: f64 = 25.0;

/// Table of the body's position and angle in one run, with noise of 0.3 mm and 0.3°. Every fiftieth pose is missing.
fn body_table(lab: &Lab, run: usize) -> String {
    let mut rng = ChaCha8Rng::seed_from_u64(run as u64);
    let mut text = "t,x,y,yaw_deg\n".to_owned();
    for (index, state) in lab.states(run).iter().enumerate() {
        let mut noise = |deviation: f64| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            deviation * normal
        };
        let (s, c) = state[2].sin_cos();
        let x = state[0] + c * AT[0] - s * AT[1] + noise(3e-4);
        let y = state[1] + s * AT[0] + c * AT[1] + noise(3e-4);
        let yaw = state[2].to_degrees() - TURNED_DEG + noise(0.3);
        let t = index as f64 / lab.cameras.rate_hz;
        if index % 50 == 17 {
            writeln!(text, "{t:.3},,,").unwrap();
        } else {
            writeln!(text, "{t:.3},{x:.6},{y:.6},{yaw:.4}").unwrap();
        }
    }
    text
}

#[test]
fn a_rigid_body_gives_the_true_parameters() {
    let lab = Lab::new(3);
    let by_reflectors = lab.campaign_text("robot-slender");
    let front = by_reflectors.find("front =").unwrap();
    let run = by_reflectors.find("[[run]]").unwrap();
    let text = format!(
        "{}body = {{ name = \"x,y\", at = [{}, {}], heading_deg = {TURNED_DEG:.1} }}\n{}",
        &by_reflectors[..front],
        AT[0],
        AT[1],
        &by_reflectors[run..]
    );
    let mut campaign = Campaign::parse(&text, Path::new("campaign.toml")).unwrap();
    campaign.swimmer = lab.known();
    let open = |path: &Path| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let run: usize = name.strip_prefix("run").unwrap().parse().unwrap();
        Ok(Cursor::new(body_table(&lab, run)))
    };
    let data = CampaignData::load_by(&campaign, open).unwrap();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    for run in &found.runs {
        assert_eq!(run.poses.front, FrontRule::Body);
    }
    let (radius, chi) = (lab.body.sphere, lab.body.chi);
    println!(
        "r_s {:.5} of {radius:.5}, chi {:.4} of {chi:.4}",
        found.fit.sphere_radius, found.fit.chi
    );
    assert!((found.fit.sphere_radius / radius - 1.0).abs() < 0.03);
    assert!((found.fit.chi / chi - 1.0).abs() < 0.03);
}
