//! The physics of the three-link swimmer and nothing else: from link lengths and drag to how far a gait swims and what
//! it costs. No standard library, no allocation; `f32` for the chip and `f64` for the host through one [`Scalar`].
//!
//! # The swimmer
//!
//! Three rigid links in a plane, in a fluid so viscous that inertia plays no part (Berkovich Lahav, Wiezel, Or, *Optimal
//! control of a swimming robot based on Purcell's microswimmer model*, Section II).
//!
//! - Link 0, the middle one, is centred at (x, y) with heading θ. Link 1 hangs on its front end and points along θ + φ₁,
//!   link 2 on its back end and points along θ + π − φ₂. **Φ = (φ₁, φ₂) = 0 is the straight swimmer**, φ₁ = φ₂ the
//!   mirror-symmetric shape, φ₁ = −φ₂ the point-symmetric one. Angles are in radians and never wrapped.
//! - A link of length l at velocity v feels the force −c_t l (v·t) t − c_n l (v·n) n and the torque −c_n l³ω/12 (the
//!   paper's equation 1), χ = c_n/c_t; a sphere of radius r_s at the middle link's centre adds 6πμ r_s and 8πμ r_s³.
//! - Another [`Medium`] (a perfect fluid, wheels) gives each link other numbers ([`LinkTensor`]); all formulas stay.
//! - **Everything is over the viscosity μ**: c_t stands for c_t/μ ([`TangentialDrag`]), power and energy are P/μ and E/μ.
//!   Lengths are in metres, or in any one unit.
//!
//! # What is computed
//!
//! - [`Model::local_connection`]: A(Φ), body velocity per joint rate; [`Model::power_matrix`]: W(Φ)/μ, power = Φ̇ᵀWΦ̇;
//!   both with exact first and second derivatives ([`Model::first_derivatives`], [`Model::second_derivatives`]), and at a
//!   heading, G(Φ, θ) = D(θ) A(Φ), derivatives with respect to θ included.
//! - [`gait`]: closed curves Φ(u), u from 0 to 1. A small loop run counter-clockwise in the (φ₁, φ₂) plane swims forwards.
//! - [`swim`]: one cycle. **x runs along the middle link's heading at the gait's first point**, which is φ₁ = φ₂ > 0 for
//!   [`Circle`], [`Square`] and [`SymmetricFourier`]. [`Panels`] is its dense output, [`Stroke`] its sum.
//!
//! ```
//! use swimmer_model::{Circle, Model, Swimmer, Tolerance, swim};
//!
//! let model = Model::new(&Swimmer::<f64>::purcell())?;
//! let stroke = swim(&model, &Circle { amplitude: 1.6331625 }, &Tolerance::default());
//! assert!((stroke.displacement_over_length().x - 0.0822853931).abs() < 1e-10);
//! assert!(stroke.efficiency_constant_power() >= stroke.efficiency());
//! # Ok::<(), swimmer_model::InvalidSwimmer>(())
//! ```
#![cfg_attr(not(test), no_std)]
// Formulas in the docs read like the paper's: c_t, r_s, l_i.
#![allow(clippy::doc_markdown)]
// A loop over many shapes becomes vector instructions only where all of the model is in it.
#![allow(clippy::inline_always)]

mod crossing;
mod derivatives;
mod drag;
mod force;
pub mod gait;
mod gauss_legendre;
mod heading;
mod medium;
mod model;
mod outline;
mod pose;
pub mod reference;
mod resistance;
mod scalar;
pub mod stroke;
mod swimmer;
mod wheels;

pub use derivatives::{FirstDerivatives, SecondDerivatives, WeighedCurvature};
pub use drag::TangentialDrag;
pub use force::LinkForce;
pub use gait::{
    Circle, Fourier, Gait, GaitPoint, Harmonic, InvalidSamples, Reversed, Sampled, Square,
    SymmetricFourier,
};
pub use gauss_legendre::GaussLegendre;
pub use heading::{FullFirstDerivatives, FullSecondDerivatives};
pub use medium::{Link, LinkTensor, Medium, UncommonDrag};
pub use model::Model;
pub use pose::{Pose, wrapped_angle};
pub use scalar::Scalar;
pub use stroke::{
    CrossingShare, Panel, Panels, Stroke, Tolerance, TrajectoryPoint, crossing_share, swim,
    trajectory,
};
pub use swimmer::{InvalidSwimmer, Links, Swimmer};
