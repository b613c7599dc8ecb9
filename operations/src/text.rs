//! Numbers as text for people.

/// An angle in radians, printed in degrees with three decimals.
pub fn degrees(radians: f64) -> String {
    // Adding zero turns a rounded -0.000 into 0.000.
    format!("{:.3}°", (radians.to_degrees() * 1e3).round() / 1e3 + 0.0)
}

/// A number that may be very small, without a unit.
pub fn small(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value.abs() >= 0.001 {
        format!("{value:.4}")
    } else {
        format!("{value:.1e}")
    }
}

/// A length in metres, printed in millimetres below one metre.
pub fn length(metres: f64) -> String {
    if metres.abs() < 1.0 {
        format!("{:.3} mm", metres * 1e3)
    } else {
        format!("{metres:.6} m")
    }
}
