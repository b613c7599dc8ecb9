//! The bounds that a gait was optimised under.

use std::fmt;

/// Bounds on the shapes that a gait was optimised under.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// `|φᵢ| ≤ φ_max` \[rad\].
    pub max_angle: Option<f64>,
    /// `φ_min ≤ |φᵢ|` for the leading joint of each quarter \[rad\].
    pub min_angle: Option<f64>,
    /// Each quarter stays inside its sector, `φ₂ ≥ |φ₁|`.
    pub sector: bool,
    /// Links may not cross: `|φᵢ| ≤ π`, and the side links stay apart.
    pub no_overlap: bool,
    /// With `no_overlap`, the least distance between the centre lines of the side links \[m\]; 0 lets them touch.
    pub clearance: f64,
}

impl Bounds {
    /// Both joints within `max_angle` \[rad\], and nothing else.
    ///
    /// ```
    /// use swimmer_files::Bounds;
    ///
    /// assert_eq!(Bounds::within(2.8).apart(0.005).to_string(), "joints within 2.8 rad, side links 0.005 m apart");
    /// ```
    pub fn within(max_angle: f64) -> Self {
        Self {
            max_angle: Some(max_angle),
            ..Self::default()
        }
    }

    /// The same with side links that never cross, their centre lines at least `clearance` \[m\] apart; 0 lets them touch.
    #[must_use]
    pub fn apart(self, clearance: f64) -> Self {
        Self {
            no_overlap: true,
            clearance,
            ..self
        }
    }
}

impl fmt::Display for Bounds {
    /// For people: "joints within 2.8 rad, links 0.005 m apart"; "no bounds".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::default() {
            return f.write_str("no bounds");
        }
        let mut between = "";
        let mut item = |text: fmt::Arguments<'_>| {
            let result = write!(f, "{between}{text}");
            between = ", ";
            result
        };
        // Without the digits that a conversion from degrees leaves behind.
        let short = |radians: f64| (radians * 1e6).round() / 1e6;
        if let Some(max) = self.max_angle {
            item(format_args!("joints within {} rad", short(max)))?;
        }
        if let Some(min) = self.min_angle {
            item(format_args!("leading joint beyond {} rad", short(min)))?;
        }
        if self.sector {
            item(format_args!("each quarter in its sector"))?;
        }
        if self.no_overlap && self.clearance > 0.0 {
            item(format_args!("side links {} m apart", self.clearance))?;
        } else if self.no_overlap {
            item(format_args!("links never cross"))?;
        }
        Ok(())
    }
}
