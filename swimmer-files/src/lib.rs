//! Files of the user, with one reader and writer each: swimmer, gait and campaign files, the link log.
//!
//! Every reader reports a mistake as [`FileError`], which names file, line and column; every writer replaces a file atomically (a
//! temporary file next to it, then a rename), so that no reader sees a partial file. Numbers make the round trip exactly.
//!
//! | on disk | here |
//! |---|---|
//! | swimmer file (TOML) or preset | [`SwimmerFile`], [`Fluid`], [`ServoFile`], [`SwimmerHash`]; what it was fitted from: [`Provenance`] |
//! | gait on the command line or in a campaign | [`GaitSpec`], [`AnyGait`] |
//! | gait file (plain text) | [`GaitFile`], [`GaitArc`], [`ArcKind`], [`Bounds`], [`Objective`] |
//! | campaign file (TOML) | [`Campaign`], [`CampaignRun`], [`Reflectors`], [`TrackSettings`], [`RunTiming`], [`Axes`] |
//! | link log (MCAP) | [`LinkLogWriter`], [`LinkFrame`], [`read_link_log`], [`parse_link_log`], [`plays`] |
//!
//! ```
//! use swimmer_files::{AnyGait, GaitFile, GaitSpec, SwimmerFile};
//! use swimmer_model::{Gait, Model, Tolerance, swim};
//!
//! let robot = SwimmerFile::find("robot")?;
//! let again = SwimmerFile::parse(&robot.to_toml(), "robot.toml".as_ref())?;
//! assert_eq!(again, robot);
//!
//! let circle = "circle:70deg:cw".parse::<GaitSpec>().unwrap().load()?;
//! let file = GaitFile::sampled(&circle, 100);
//! let read = GaitFile::parse(&file.to_text(), "circle.gait".as_ref())?;
//! assert_eq!(read.phi, file.phi);
//!
//! let model = Model::new(&again.swimmer).unwrap();
//! let swum = swim(&model, &AnyGait::from_file(&read).unwrap(), &Tolerance::default());
//! assert!(swum.displacement.x < 0.0, "clockwise it swims backwards");
//! # Ok::<(), swimmer_files::FileError>(())
//! ```

mod any_gait;
mod atomic;
mod axes;
mod campaign;
mod file_error;
mod gait_file;
mod gait_spec;
mod hash;
mod key;
mod link_log;
mod period;
mod playlist;
mod provenance;
mod quantity;
mod spring;
mod swimmer_file;
mod toml_text;

pub use any_gait::AnyGait;
pub use atomic::{stream_atomically, write_atomically};
pub use axes::Axes;
pub use campaign::{
    Campaign, CampaignRun, Known, KnownValue, PointName, Reflector, Reflectors, ReportedResults,
    ReportedValue, RigidBody, RunTiming, TankWalls, TrackSettings, WallPlane,
};
pub use file_error::FileError;
pub use gait_file::{ArcKind, Bounds, GaitArc, GaitFile, Objective};
pub use gait_spec::{GaitSpec, GaitSpecError};
pub use hash::SwimmerHash;
pub use key::parse_key;
pub use link_log::{
    LinkFrame, LinkLog, LinkLogError, LinkLogWriter, Play, link_log_bytes, parse_link_log, plays,
    read_link_log,
};
pub use period::{UnplayablePeriod, check_playable_period};
pub use playlist::{Playlist, PlaylistStep};
pub use provenance::{InputHash, Provenance, hash_of};
pub use quantity::{AngleError, Quantity, Slip, parse_angle, parse_rate};
pub use spring::{GaitSpring, JointName, PassiveFile, Spring};
pub use swimmer_file::{Fluid, ServoFile, SwimmerFile};
