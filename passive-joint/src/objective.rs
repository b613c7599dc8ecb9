//! Objectives of a passive joint's waveform.

/// Quantity that a waveform maximises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// Displacement per cycle.
    Displacement,
    /// Displacement per second.
    Speed,
    /// Lighthill's efficiency: displacement² per motor work and period. Displacement per work has no optimum: it is greatest for
    /// infinitesimal strokes, infinitely slow.
    Efficiency,
}

/// Exponents of displacement, energy and period in an objective.
pub(crate) struct Exponents {
    /// Exponent of the displacement.
    pub(crate) displacement: f64,
    /// Exponent of ∮ Φ′ᵀWΦ′ du.
    pub(crate) energy: f64,
    /// Exponent of the period.
    pub(crate) period: f64,
}

impl Objective {
    /// All objectives.
    pub const ALL: [Self; 3] = [Self::Displacement, Self::Speed, Self::Efficiency];

    /// Word on the command line and in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Speed => "speed",
            Self::Efficiency => "efficiency",
        }
    }

    /// The objective is the product of these powers. The work of the motor is energy × μ / period.
    pub(crate) fn exponents(self) -> Exponents {
        let [displacement, energy, period] = match self {
            Self::Displacement => [1.0, 0.0, 0.0],
            Self::Speed => [1.0, 0.0, -1.0],
            Self::Efficiency => [2.0, -1.0, 0.0],
        };
        Exponents {
            displacement,
            energy,
            period,
        }
    }
}
