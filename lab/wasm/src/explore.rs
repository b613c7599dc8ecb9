//! Calls of the Explore tab: `swimmer`, `simulate`, `certify`, `optimize`, `height-map`, like the commands of those names, and
//! additional data for the figures.

mod certify;
mod map;
mod motion;
mod objective;
mod optimize;
mod simulate;
mod swimmer;

use crate::calls::Call;

pub use map::Memory;

/// Calls by name.
pub(crate) const CALLS: &[(&str, Call)] = &[
    ("swimmer", swimmer::swimmer),
    ("net", simulate::net),
    ("simulate", simulate::simulate),
    ("gait-file", simulate::gait_file),
    ("tank", simulate::tank),
    ("certify", certify::run),
    ("optimize", optimize::optimize),
    ("height-map", map::height_map),
    ("height-grid", map::height_grid),
    ("motion", motion::motion),
];

#[cfg(test)]
mod tests {
    use crate::calls::{CallOutput, Lab, call};
    use serde_json::{Value, json};

    fn output_of(lab: &mut Lab, name: &str, question: &Value) -> Value {
        let output = call(lab, name.as_bytes(), question.to_string().as_bytes()).unwrap();
        match output {
            CallOutput::Json(text) => serde_json::from_str(&text).unwrap(),
            CallOutput::Bytes(bytes) => match String::from_utf8(bytes.clone()) {
                Ok(text) if text.starts_with('#') => Value::from(text),
                _ => Value::from(
                    bytes
                        .chunks_exact(8)
                        .map(|eight| f64::from_le_bytes(eight.try_into().unwrap()))
                        .collect::<Vec<_>>(),
                ),
            },
        }
    }

    /// An optimum written to a file and read again has the same displacement and passes its certificate.
    #[test]
    fn an_optimum_swims_what_it_promises_and_holds_its_conditions() {
        let mut lab = Lab::default();
        let swimmer = "purcell";
        let found = output_of(
            &mut lab,
            "optimize",
            &json!({ "swimmer": swimmer, "objective": "displacement" }),
        );
        let x = found["displacement_over_length"].as_f64().unwrap();
        assert!((x - 0.103_532_24).abs() < 1e-9, "{x}");
        let gait = &found["gait"];
        let swum = output_of(
            &mut lab,
            "simulate",
            &json!({ "swimmer": swimmer, "gait": gait }),
        );
        let again = swum["displacement_over_length"].as_f64().unwrap();
        assert!((x - again).abs() < 1e-8, "{x} {again}");
        let held = output_of(
            &mut lab,
            "certify",
            &json!({ "swimmer": swimmer, "gait": gait }),
        );
        assert_eq!(held["verdict"], "pass");
        let file = output_of(
            &mut lab,
            "gait-file",
            &json!({ "swimmer": swimmer, "gait": gait }),
        );
        assert_eq!(&file, gait);
    }

    #[test]
    fn bare_samples_swim_as_the_file_that_is_saved_of_them() {
        let mut lab = Lab::default();
        let phi: Vec<f64> = (0..64)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 64.0)
            .flat_map(|s| [1.2 * (s + 0.7).cos(), 1.1 * (s + 0.7).sin()])
            .collect();
        let samples = json!({ "swimmer": "robot", "gait": phi, "objective": "displacement" });
        let swum = output_of(&mut lab, "simulate", &samples);
        let file = output_of(&mut lab, "gait-file", &samples);
        let of_file = output_of(
            &mut lab,
            "simulate",
            &json!({ "swimmer": "robot", "gait": file }),
        );
        assert_eq!(swum, of_file);
    }

    #[test]
    fn a_grid_has_the_height_of_the_map_in_its_middle() {
        let mut lab = Lab::default();
        let question = json!({ "swimmer": "purcell", "row": "x", "max_angle": 2.8, "count": 5 });
        let map = output_of(&mut lab, "height-map", &question);
        let grid = output_of(&mut lab, "height-grid", &question);
        assert_eq!(grid.as_array().unwrap().len(), 25);
        assert_eq!(grid[12], map["at_origin_over_length"]);
    }

    #[test]
    fn a_motion_ends_where_the_cycle_does() {
        let mut lab = Lab::default();
        let question = json!({ "swimmer": "robot", "gait": "circle:70deg", "intervals": 40 });
        let swum = output_of(&mut lab, "simulate", &question);
        let motion = output_of(&mut lab, "motion", &question);
        assert_eq!(motion.as_array().unwrap().len(), 41 * 26);
        let net = output_of(&mut lab, "net", &question);
        assert_eq!(net["displacement_m"], swum["displacement_m"]);
        let end = motion[40 * 26 + 3].as_f64().unwrap();
        assert!((end - swum["displacement_m"].as_f64().unwrap()).abs() < 1e-12);
    }

    #[test]
    fn sliders_change_the_file_and_mistakes_are_told() {
        let mut lab = Lab::default();
        let slid = json!({ "swimmer": "robot", "with": { "chi": 2.5, "max_rate_rad_s": 4.0 } });
        let output = output_of(&mut lab, "swimmer", &slid);
        let again = output_of(&mut lab, "swimmer", &json!({ "swimmer": output["toml"] }));
        assert_eq!(again["chi"], 2.5);
        assert_eq!(again["max_rate_rad_s"], 4.0);
        assert_eq!(again["hash"], output["hash"]);
        for (name, question, part) in [
            (
                "swimmer",
                json!({ "swimmer": "robot", "with": { "chi": -1.0 } }),
                "chi",
            ),
            (
                "simulate",
                json!({ "swimmer": "robot", "gait": "circel:70deg" }),
                "circle",
            ),
            (
                "simulate",
                json!({ "swimmer": "robot", "gait": [0.1, 0.2] }),
                "gait",
            ),
            ("swimmer", json!({ "swimmer": "no file" }), "swimmer.toml"),
        ] {
            let reason = call(&mut lab, name.as_bytes(), question.to_string().as_bytes());
            let reason = reason.unwrap_err();
            assert!(reason.contains(part), "{reason}");
        }
    }
}
