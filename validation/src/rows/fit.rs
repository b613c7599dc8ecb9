//! Rows of section II.C: the fit of the sphere and of χ. The paper's recordings are not public; circles that the fitted robot swims stand in.

use std::fmt::Write as _;

use calibrate::{CampaignData, FitOptions, calibrate_campaign};
use swimmer_files::{AnyGait, Campaign};
use swimmer_model::{Tolerance, swim};

use super::computed::Computed;
use crate::study::Study;

/// Amplitudes of the circles \[deg\].
const DEGREES: [f64; 6] = [30.0, 50.0, 70.0, 85.0, 100.0, 110.0];

/// Radius and drag ratio that the paper's criterion finds from X, ΔY and Δθ, from a start without sphere and with χ = 2.
pub(super) fn fit(study: &Study) -> Vec<Computed> {
    let [radius, chi] = fitted(study).unwrap_or([f64::NAN; 2]);
    vec![("fit.sphere_radius", radius), ("fit.chi", chi)]
}

fn fitted(study: &Study) -> Option<[f64; 2]> {
    let mut text = "swimmer = \"robot-slender\"\n".to_owned();
    let mut gaits = Vec::new();
    for degrees in DEGREES {
        let circle = AnyGait::circle(degrees.to_radians());
        let swum = swim(&study.robot, &circle, &Tolerance::default());
        write!(
            text,
            "[[run]]\ngait = \"circle:{degrees:?}deg\"\nperiod_s = 26.0\nx_mm = {:?}\ndelta_y_mm = {:?}\ndelta_theta_deg = {:?}\n",
            1e3 * swum.displacement.x,
            1e3 * swum.delta_y,
            swum.delta_theta.to_degrees(),
        )
        .ok()?;
        gaits.push(circle);
    }
    let mut campaign = Campaign::parse(&text, "circles.toml".as_ref()).ok()?;
    // Ideal servos, as in the paper's simulations.
    campaign.swimmer.servo = None;
    let data = CampaignData {
        reported_gaits: gaits,
        ..CampaignData::default()
    };
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).ok()?;
    Some([found.fit.sphere_radius, found.fit.chi])
}
