//! Swimmer to TOML: the commented form of the command's reference, numbers in the shortest digits that read back exactly.

use std::fmt::Write as _;

use swimmer_model::{Link, Links, Medium, Swimmer, TangentialDrag};

use super::SwimmerFile;
use crate::Spring;

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
    match swimmer.medium {
        Medium::Viscous => write_drag(text, swimmer)?,
        Medium::Perfect { aspect, density } => {
            writeln!(text, "\n[medium]")?;
            writeln!(text, "kind = \"perfect\"")?;
            writeln!(
                text,
                "aspect = {aspect:?}              # half width over half length"
            )?;
            writeln!(
                text,
                "density = {density:?}          # kg/m^3, of fluid and body"
            )?;
        }
        Medium::Wheels => writeln!(text, "\n[medium]\nkind = \"wheels\"")?,
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
    if let Some(passive) = &file.passive {
        writeln!(text, "\n[passive]")?;
        writeln!(text, "joint = \"{}\"", passive.joint)?;
        match passive.spring {
            Spring::Relaxation(time) => writeln!(text, "relaxation_s = {time:?}      # s")?,
            Spring::Stiffness(stiffness) => {
                writeln!(text, "stiffness_n_m = {stiffness:?}     # N m/rad")?;
            }
        }
    }
    Ok(())
}

/// Inline table of one number for each link.
fn per_link(values: &Links<f64>) -> String {
    let Links {
        middle,
        front,
        back,
    } = values;
    format!("{{ middle = {middle:?}, front = {front:?}, back = {back:?} }}")
}

/// The `[drag]` table, and `[sphere]` if there is one.
fn write_drag(text: &mut String, swimmer: &Swimmer<f64>) -> std::fmt::Result {
    writeln!(text, "\n[drag]")?;
    let chi = swimmer.chi;
    match swimmer.side_chi {
        None => writeln!(text, "chi = {chi:?}               # c_n / c_t")?,
        Some([front, back]) => {
            let middle = chi;
            let values = per_link(&Links {
                middle,
                front,
                back,
            });
            writeln!(text, "chi = {values}  # c_n / c_t of each link")?;
        }
    }
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
        TangentialDrag::PerLink(values) => {
            let values = per_link(&values);
            writeln!(
                text,
                "c_t = {{ over_viscosity = {values} }}  # c_t / mu of each link"
            )?;
        }
    }
    if swimmer.sphere_radius > 0.0 {
        writeln!(text, "\n[sphere]")?;
        writeln!(text, "radius = {:?}            # m", swimmer.sphere_radius)?;
        let on = match swimmer.sphere_on {
            Link::Middle => return Ok(()),
            Link::Front => "front",
            Link::Back => "back",
        };
        writeln!(
            text,
            "on = \"{on}\"              # the link at whose centre it sits"
        )?;
    }
    Ok(())
}
