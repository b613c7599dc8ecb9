//! Calls of the Calibrate tab: dropped files give the same fit as the library.
#![cfg(feature = "robot")]

use calibrate::{CampaignData, FitOptions, calibrate_campaign};
use serde_json::{Value, json};
use swimmer_files::{Campaign, SwimmerFile};
use swimmer_lab::calls::{CallOutput, Lab, call};

/// Files as the page packs them.
fn packed(files: &[(&str, &str)]) -> Vec<u8> {
    let list: Vec<Value> = files
        .iter()
        .map(|(name, text)| json!({ "name": name, "length": text.len() }))
        .collect();
    let list = Value::from(list).to_string();
    let mut bytes = u32::try_from(list.len()).unwrap().to_le_bytes().to_vec();
    bytes.extend(list.as_bytes());
    for (_, text) in files {
        bytes.extend(text.as_bytes());
    }
    bytes
}

/// Stated results of four circles.
fn campaign(swimmer: &str) -> String {
    let runs = [
        (40, 1.77, 9.9, 26.0),
        (60, 4.12, 15.2, 38.3),
        (80, 7.1, 20.8, 49.7),
        (100, 9.5, 26.4, 60.1),
    ];
    runs.iter().fold(format!("swimmer = \"{swimmer}\"\n"), |text, (amplitude, x, delta_y, turn)| {
        text + &format!(
            "[[run]]\ngait = \"circle:{amplitude}deg\"\nperiod_s = 30.0\nx_mm = {x}\nx_se_mm = 0.05\ndelta_y_mm = {delta_y}\n\
             delta_y_se_mm = 0.2\ndelta_theta_deg = {turn}\ndelta_theta_se_deg = 0.4\n"
        )
    })
}

fn output_of(lab: &mut Lab, name: &str, bytes: &[u8]) -> Result<Value, String> {
    match call(lab, name.as_bytes(), bytes)? {
        CallOutput::Json(text) => Ok(serde_json::from_str(&text).unwrap()),
        CallOutput::Bytes(_) => Err("bytes".to_owned()),
    }
}

#[test]
fn a_campaign_is_fitted_as_by_the_library() {
    let ours = SwimmerFile::preset("robot").unwrap().to_toml();
    let text = campaign("ours.toml");
    let mut lab = Lab::default();
    let files = packed(&[("ours.toml", &ours), ("campaign.toml", &text)]);
    let output = output_of(&mut lab, "calibrate", &files).unwrap();

    let same = Campaign::parse(&campaign("robot"), "campaign.toml".as_ref()).unwrap();
    let data = CampaignData::load(&same).unwrap();
    let found = calibrate_campaign(&same, &data, FitOptions::default()).unwrap();
    assert_eq!(output["chi"], found.fit.chi);
    assert_eq!(output["sphere_radius_m"], found.fit.sphere_radius);
    assert_eq!(output["runs"].as_array().unwrap().len(), 4);

    let number = json!({ "number": output["number"] }).to_string();
    let assessed = output_of(&mut lab, "calibrate assessment", number.as_bytes()).unwrap();
    assert!(assessed["verdict"].is_string(), "{assessed}");
    output_of(&mut lab, "calibrate close", number.as_bytes()).unwrap();
    let gone = output_of(&mut lab, "calibrate evidence", number.as_bytes()).unwrap_err();
    assert!(gone.contains("gone"), "{gone}");
}

#[test]
fn a_gait_of_another_size_is_told() {
    let ours = SwimmerFile::preset("robot").unwrap().to_toml();
    let text = campaign("ours.toml").replace("circle:40deg", "circle:46deg");
    let files = packed(&[("ours.toml", &ours), ("campaign.toml", &text)]);
    let output = output_of(&mut Lab::default(), "calibrate", &files).unwrap();
    let warnings = output["warnings"].as_array().unwrap();
    let said = |warning: &Value| {
        warning
            .as_str()
            .unwrap()
            .contains("not of 46.000°, compared with the other runs")
    };
    assert_eq!(
        warnings.iter().filter(|warning| said(warning)).count(),
        1,
        "{warnings:?}"
    );
}

#[test]
fn what_was_not_dropped_is_named() {
    let mut lab = Lab::default();
    let files = packed(&[("campaign.toml", &campaign("ours.toml"))]);
    let reason = output_of(&mut lab, "calibrate", &files).unwrap_err();
    assert!(reason.contains("ours.toml"), "{reason}");
    let reason = output_of(&mut lab, "calibrate", &packed(&[("notes.txt", "")])).unwrap_err();
    assert!(reason.contains("campaign"), "{reason}");
    assert!(
        output_of(&mut lab, "calibrate", &[1, 0])
            .unwrap_err()
            .contains("less than it said")
    );
}
