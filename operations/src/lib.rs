//! Application library: the operations that the command `swimmer`, the lab page and the Python package share.
//!
//! Each operation is a module with the function that computes and the `Output` that is its JSON document. Nothing here prints,
//! parses arguments or knows a terminal. Files are read only through [`Context::files`], and warnings are collected in
//! [`Context::warnings`], so a front end decides what becomes of both. Each front end renders an `Output` in its own way.
//!
//! ```
//! use operations::{Context, GaitSource, Subject, SwimmerSource, simulate};
//!
//! let mut context = Context::on_disk();
//! let gait = GaitSource::Text("circle:1.6331625".to_owned());
//! let subject = Subject::load(&SwimmerSource::from("purcell"), &gait, &mut context)?;
//! let output = simulate::run(&subject, &simulate::Options::default(), &mut context)?;
//! assert!((output.net.displacement_over_length - 0.082_285_39).abs() < 1e-8);
//! # Ok::<(), operations::Error>(())
//! ```

pub mod atlas;
pub mod best_waveform;
pub mod bounds;
pub mod calibrate;
mod cancel;
pub mod catalogue;
pub mod certify;
mod context;
mod error;
pub mod fit_file;
pub mod fluid;
pub mod height_map;
pub mod optimize;
pub mod passive;
pub mod plan;
pub mod played;
pub mod robot_limits;
pub mod simulate;
mod source;
#[cfg(feature = "sweeps")]
pub mod sweep;
pub mod text;
pub mod tracks;

pub use cancel::Cancel;
pub use context::{Context, Files, Progress, Stage, Watch};
pub use error::{Error, ErrorKind};
pub use source::{
    GaitSource, Subject, SwimmerSource, check_robots_drag, model, warn_if_doubtful,
    warn_if_for_another, warn_if_outdated,
};
