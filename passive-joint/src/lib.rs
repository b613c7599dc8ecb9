//! One servo and a spring: one joint follows a waveform, the other one turns passively against a torsion spring.
//!
//! The spring torque −k φ_p balances the drag torque of the passive joint, μ(W_pd φ̇_d + W_pp φ̇_p). Over one cycle of duration T,
//! with u = t/T and **κ = k T/μ** \[m³\],
//!
//! φ_p′ = −(κ φ_p + W_pd φ_d′) / W_pp.
//!
//! - [`PassiveJoint`]: the joint with its spring, made dimensionless for one cycle from a [`Spring`](swimmer_files::Spring) by [`over_viscosity`].
//! - [`LimitCycle`]: the periodic response to a waveform, a gait that the model swims.
//! - [`Waveform`] and [`CycleValues`]: Fourier waveforms, with the derivatives of displacement and motor work by the adjoint method.
//! - [`optimize`]: the best waveform and frequency under bounds on angle and rate, with its first-order conditions.
//!
//! ```
//! use link_protocol::Joint;
//! use passive_joint::{LimitCycle, PassiveJoint, Waveform};
//! use swimmer_model::{Model, Swimmer, Tolerance, swim};
//!
//! let model = Model::new(&Swimmer::<f64>::purcell())?;
//! let passive = PassiveJoint::new(Joint::Back, 1.0)?;
//! let drive = Waveform::sine(1.0).driving(Joint::Front);
//! let cycle = LimitCycle::new(&model, &drive, passive)?;
//! assert!((cycle.start() + 0.372_584).abs() < 1e-6);
//! let stroke = swim(&model, &cycle, &Tolerance::default());
//! assert!((stroke.displacement.norm() / 3.0 - 0.017_478_6).abs() < 1e-7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Formulas in the docs read like the theory: φ_p, W_pp.
#![allow(clippy::doc_markdown)]

mod adjoint;
mod error;
mod fixed_point;
mod gauss;
mod interior;
mod limit_cycle;
mod objective;
mod optimum;
mod problem;
mod spring;
mod waveform;

pub use adjoint::CycleValues;
pub use error::PassiveError;
pub use limit_cycle::LimitCycle;
pub use objective::Objective;
pub use optimum::{Conditions, Optima, Optimum, optimize};
pub use problem::{Problem, SpringChoice};
pub use spring::{PassiveJoint, over_viscosity};
pub use waveform::{OddHarmonic, Waveform};
