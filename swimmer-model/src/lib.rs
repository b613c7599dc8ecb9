//! The physics of the three-link swimmer and nothing else.
#![cfg_attr(not(test), no_std)]
// Formulas in the docs read like the paper's: c_t, r_s, l_i.
#![allow(clippy::doc_markdown)]

mod crossing;
mod derivatives;
mod drag;
pub mod gait;
mod heading;
mod model;
mod pose;
pub mod reference;
mod resistance;
mod scalar;
pub mod stroke;
mod swimmer;

pub use derivatives::{FirstDerivatives, SecondDerivatives};
pub use drag::TangentialDrag;
pub use gait::{
    Circle, Fourier, Gait, GaitPoint, Harmonic, InvalidSamples, Reversed, Sampled, Square,
    SymmetricFourier,
};
pub use heading::{FullFirstDerivatives, FullSecondDerivatives};
pub use model::Model;
pub use pose::Pose;
pub use scalar::Scalar;
pub use stroke::{
    CrossingShare, Panel, Panels, Stroke, Tolerance, TrajectoryPoint, crossing_share, swim,
    trajectory,
};
pub use swimmer::{InvalidSwimmer, Links, Swimmer};
