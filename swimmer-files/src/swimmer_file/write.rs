//! Swimmer to TOML: the commented form of the command's reference, numbers in the shortest digits that read back exactly.

use std::fmt::Write as _;

use swimmer_model::TangentialDrag;

use super::SwimmerFile;

pub(super) fn swimmer_toml(file: &SwimmerFile) -> String {
    let mut text = String::with_capacity(800);
    // Writing to a String cannot fail.
    let _ = write_tables(&mut text, file);
    text
}

fn write_tables(text: &mut String, file: &SwimmerFile) -> std::fmt::Result {
    let swimmer = &file.swimmer;
    let links = &swimmer.links;
    writeln!(text, "name = {}", toml::Value::String(file.name.clone()))?;
    writeln!(text, "\n[links]")?;
    writeln!(text, "middle = {:?}            # m", links.middle)?;
    if links.front.to_bits() == links.back.to_bits() {
        writeln!(
            text,
            "side = {:?}              # m, both side links",
            links.front
        )?;
    } else {
        writeln!(text, "front = {:?}             # m", links.front)?;
        writeln!(text, "back = {:?}              # m", links.back)?;
    }
    writeln!(text, "\n[drag]")?;
    writeln!(text, "chi = {:?}               # c_n / c_t", swimmer.chi)?;
    match swimmer.tangential_drag {
        TangentialDrag::LogAspect(value) => {
            writeln!(
                text,
                "c_t = {{ log_aspect = {value:?} }}      # common: c_t = 2 pi mu / log_aspect"
            )?;
        }
        TangentialDrag::HalfThickness(value) => {
            writeln!(
                text,
                "c_t = {{ half_thickness = {value:?} }}  # m, per link: c_t = 2 pi mu / ln(l/a)"
            )?;
        }
        TangentialDrag::OverViscosity(value) => {
            writeln!(
                text,
                "c_t = {{ over_viscosity = {value:?} }}  # common: c_t / mu"
            )?;
        }
    }
    if swimmer.sphere_radius > 0.0 {
        writeln!(text, "\n[sphere]")?;
        writeln!(text, "radius = {:?}            # m", swimmer.sphere_radius)?;
    }
    if let Some(fluid) = &file.fluid {
        writeln!(text, "\n[fluid]")?;
        writeln!(
            text,
            "kinematic_viscosity = {:?}  # m^2/s",
            fluid.kinematic_viscosity
        )?;
        writeln!(text, "density = {:?}              # kg/m^3", fluid.density)?;
    }
    if let Some(servo) = &file.servo {
        writeln!(text, "\n[servo]")?;
        writeln!(text, "max_angle = {:?}         # rad", servo.max_angle)?;
        writeln!(text, "max_rate = {:?}          # rad/s", servo.max_rate)?;
        writeln!(text, "dead_band = {:?}         # rad", servo.dead_band)?;
        writeln!(text, "slope_rad_per_us = {:?}", servo.slope_rad_per_us)?;
        writeln!(text, "centre_us = {:?}", servo.centre_us)?;
        if let Some(torque) = servo.torque {
            writeln!(text, "torque_n_m = {torque:?}")?;
        }
        if let Some(rate) = servo.no_load_rate {
            writeln!(text, "no_load_rate = {rate:?}      # rad/s")?;
        }
    }
    Ok(())
}
