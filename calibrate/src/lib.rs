//! Tracking files to poses, cycles and fitted parameters.
//!
//! ```text
//! bytes ──read_tracks──► TrackFile ──follow──► PoseTrack ──cycles──► CycleStatistics ──fit──► r_s, χ, intervals
//!          (tracks)                 (reflectors)          (cycles)                     (fit)
//! ```
//! Lengths are metres, angles radians, times seconds. Nothing here opens a file, except [`CampaignData::load`], which reads
//! what the campaign names.

pub mod tracks;

pub use tracks::{
    PointKind, TableOptions, TrackError, TrackFile, TrackFormat, TrackPoint, TrackProblem,
    TrackWarning, Unit, read_tracks, read_tracks_with,
};
