//! Errors of limit cycles and of the search for the best waveform.

/// Reason why a passive joint has no usable motion.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PassiveError {
    /// κ is not positive and finite.
    #[error(
        "a spring of {kappa:e} m³ (stiffness × period / viscosity) is not positive and finite; check stiffness, viscosity and period"
    )]
    Spring {
        /// κ \[m³\].
        kappa: f64,
    },
    /// The swimmer is not in a viscous fluid.
    #[error(
        "a spring balances the drag of a viscous fluid, and this swimmer is in another medium: there the motion of a passive joint depends \
         on inertia or on the wheels, which the model leaves out"
    )]
    NotViscous,
    /// A stiffness in N m/rad, and no viscosity.
    #[error(
        "a stiffness in N m/rad needs the viscosity: add [fluid] to the swimmer file, or give the relaxation time of the joint"
    )]
    NeedsFluid,
    /// Newton's method found no periodic motion.
    #[error(
        "no limit cycle found: after {iterations} Newton steps the passive joint still misses its start by {residual:.1e} rad; use a \
         smaller stroke or another period"
    )]
    NotConverged {
        /// Newton steps.
        iterations: u32,
        /// Difference of the passive angle after one cycle \[rad\].
        residual: f64,
    },
    /// A periodic motion that a disturbance leaves.
    #[error(
        "the limit cycle is unstable: a disturbance grows by {multiplier:.3} a cycle; use a smaller stroke or a stiffer spring"
    )]
    Unstable {
        /// Factor of a small disturbance after one cycle.
        multiplier: f64,
    },
    /// The objective has no optimum at a free frequency.
    #[error(
        "most displacement per second grows with the frequency: limit the rate of the servo, or give the period"
    )]
    NeedsRate,
    /// Only the ratio of spring and period matters.
    #[error("with a free spring only its relaxation time over the period matters: give the period")]
    NeedsPeriod,
    /// A bound is not positive and finite.
    #[error("the {name} is {value}; give a number above 0")]
    Bound {
        /// Name of the bound.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// More harmonics than the quadrature resolves.
    #[error("{harmonics} harmonics: give 1 to {most}")]
    Harmonics {
        /// Requested number.
        harmonics: usize,
        /// Largest number.
        most: usize,
    },
    /// The interior-point method did not converge.
    #[error(
        "no optimum found: after {iterations} steps the first-order conditions are violated by {residual:.1e}; use fewer harmonics or \
         other bounds"
    )]
    NoOptimum {
        /// Newton steps.
        iterations: u32,
        /// Largest violation of the KKT conditions.
        residual: f64,
    },
}
