//! `swimmer`: reads a swimmer, applies the values of the page's sliders, and returns its values in the units of the file and the
//! text of its file.

use serde::{Deserialize, Serialize};
use swimmer_files::{ServoFile, SwimmerFile};
use swimmer_model::TangentialDrag;

use crate::calls::{Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct SwimmerRequest {
    swimmer: SwimmerText,
    /// Values of the sliders; missing ones are unchanged.
    #[serde(default)]
    with: ChangedValues,
}

/// Changed values, in the units of the swimmer file.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct ChangedValues {
    chi: Option<f64>,
    sphere_radius_m: Option<f64>,
    middle_m: Option<f64>,
    front_m: Option<f64>,
    back_m: Option<f64>,
    max_rate_rad_s: Option<f64>,
}

#[derive(Serialize)]
struct SwimmerOutput {
    name: String,
    toml: String,
    hash: String,
    total_length_m: f64,
    middle_m: f64,
    front_m: f64,
    back_m: f64,
    chi: f64,
    sphere_radius_m: f64,
    /// Form of the relation between drag and viscosity, and its number.
    c_t_form: &'static str,
    c_t: f64,
    max_angle_rad: f64,
    max_rate_rad_s: f64,
    doubts: Vec<String>,
}

/// Reads a swimmer, changes it, and returns its values.
pub(super) fn swimmer(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let SwimmerRequest { swimmer, with } = parsed(bytes)?;
    let mut file = swimmer.read()?;
    with.apply(&mut file);
    file.swimmer
        .validate()
        .map_err(|why| format!("the swimmer `{}` cannot swim: {why}", file.name))?;
    file.swimmer.common_drag().map_err(|why| {
        format!(
            "{why}, and this page shows viscous swimmers with one chi, one form of c_t and a sphere on the middle link; the \
             command `swimmer` takes the file"
        )
    })?;
    let links = &file.swimmer.links;
    let servo = file.servo.unwrap_or_default();
    let (c_t_form, c_t) = match file.swimmer.tangential_drag {
        TangentialDrag::LogAspect(value) => ("log_aspect", value),
        TangentialDrag::HalfThickness(value) => ("half_thickness", value),
        TangentialDrag::OverViscosity(value) => ("over_viscosity", value),
        // Refused above.
        TangentialDrag::PerLink(_) => ("over_viscosity", file.swimmer.side_drag()),
    };
    json(&SwimmerOutput {
        toml: file.to_toml(),
        hash: file.hash().to_string(),
        total_length_m: file.swimmer.total_length(),
        middle_m: links.middle,
        front_m: links.front,
        back_m: links.back,
        chi: file.swimmer.chi,
        sphere_radius_m: file.swimmer.sphere_radius,
        c_t_form,
        c_t,
        max_angle_rad: servo.max_angle,
        max_rate_rad_s: servo.max_rate,
        doubts: file.doubts(),
        name: file.name,
    })
}

impl ChangedValues {
    fn apply(&self, file: &mut SwimmerFile) {
        let swimmer = &mut file.swimmer;
        let links = &mut swimmer.links;
        for (place, value) in [
            (&mut links.middle, self.middle_m),
            (&mut links.front, self.front_m),
            (&mut links.back, self.back_m),
            (&mut swimmer.chi, self.chi),
            (&mut swimmer.sphere_radius, self.sphere_radius_m),
        ] {
            *place = value.unwrap_or(*place);
        }
        if let Some(max_rate) = self.max_rate_rad_s {
            file.servo = Some(ServoFile {
                max_rate,
                ..file.servo.unwrap_or_default()
            });
        }
    }
}
