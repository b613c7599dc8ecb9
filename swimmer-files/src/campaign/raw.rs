//! A campaign's text as it stands: every key that it may have, with its place.

use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::known::RawKnown;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawCampaign {
    pub(super) swimmer: Spanned<String>,
    pub(super) reflectors: Option<RawReflectors>,
    #[serde(default)]
    pub(super) tracks: RawTracks,
    #[serde(default)]
    pub(super) known: RawKnown,
    #[serde(default)]
    pub(super) run: Vec<RawRun>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTracks {
    pub(super) scale: Option<Spanned<f64>>,
    pub(super) rate_hz: Option<Spanned<f64>>,
    pub(super) axes: Option<Spanned<String>>,
    pub(super) likelihood: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawReflectors {
    pub(super) front: Option<Spanned<RawReflector>>,
    pub(super) back: Option<Spanned<RawReflector>>,
    pub(super) body: Option<Spanned<RawBody>>,
    pub(super) front_link: Option<Spanned<RawReflector>>,
    pub(super) back_link: Option<Spanned<RawReflector>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawReflector {
    pub(super) point: RawPoint,
    pub(super) at: Spanned<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a body is a name, or { name = \"robot\", at = [x, y], axis = \"z\", heading_deg = 0.0 }, of which only the name is needed"
)]
pub(super) enum RawBody {
    Name(String),
    Table(RawBodyTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawBodyTable {
    pub(super) name: String,
    #[serde(default)]
    pub(super) at: [f64; 2],
    pub(super) axis: Option<String>,
    #[serde(default)]
    pub(super) heading_deg: f64,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a point is a name, a pair of column names, { near = [x, y] }, or \"auto\""
)]
pub(super) enum RawPoint {
    Name(String),
    Columns([String; 2]),
    Near { near: [f64; 2] },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRun {
    pub(super) track: Option<Spanned<String>>,
    pub(super) results: Option<Spanned<String>>,
    pub(super) gait: Spanned<String>,
    pub(super) period_s: Spanned<f64>,
    pub(super) front: Option<Spanned<RawPoint>>,
    pub(super) cycle_start_s: Option<Spanned<f64>>,
    pub(super) log: Option<Spanned<String>>,
    pub(super) play: Option<Spanned<usize>>,
    pub(super) clock_offset_s: Option<Spanned<f64>>,
    pub(super) exclude: Option<Spanned<String>>,
    pub(super) x_mm: Option<Spanned<f64>>,
    pub(super) x_sd_mm: Option<Spanned<f64>>,
    pub(super) x_se_mm: Option<Spanned<f64>>,
    pub(super) y_mm: Option<Spanned<f64>>,
    pub(super) y_sd_mm: Option<Spanned<f64>>,
    pub(super) y_se_mm: Option<Spanned<f64>>,
    pub(super) turn_deg: Option<Spanned<f64>>,
    pub(super) turn_sd_deg: Option<Spanned<f64>>,
    pub(super) turn_se_deg: Option<Spanned<f64>>,
    pub(super) delta_y_mm: Option<Spanned<f64>>,
    pub(super) delta_y_sd_mm: Option<Spanned<f64>>,
    pub(super) delta_y_se_mm: Option<Spanned<f64>>,
    pub(super) delta_theta_deg: Option<Spanned<f64>>,
    pub(super) delta_theta_sd_deg: Option<Spanned<f64>>,
    pub(super) delta_theta_se_deg: Option<Spanned<f64>>,
    pub(super) cycles: Option<Spanned<f64>>,
}

/// Keys of a run, each with its place where it stands there.
macro_rules! keys {
    ($run:expr, $($key:ident)+) => {
        [$((stringify!($key), $run.$key.as_ref().map(Spanned::span))),+]
    };
}

/// List of the numbers that may report a run: keys of a `[[run]]`, and columns of a table.
macro_rules! numbers {
    ($($key:ident)+) => {
        /// Keys of the numbers that may report a run.
        pub(super) const NUMBERS: [&str; 16] = [$(stringify!($key)),+];

        impl RawRun {
            /// One of [`NUMBERS`], by its key.
            pub(super) fn number(&self, key: &str) -> Option<&Spanned<f64>> {
                $(if key == stringify!($key) {
                    return self.$key.as_ref();
                })+
                None
            }
        }
    };
}

numbers! {
    x_mm
    x_sd_mm
    x_se_mm
    y_mm
    y_sd_mm
    y_se_mm
    turn_deg
    turn_sd_deg
    turn_se_deg
    delta_y_mm
    delta_y_sd_mm
    delta_y_se_mm
    delta_theta_deg
    delta_theta_sd_deg
    delta_theta_se_deg
    cycles
}

impl RawRun {
    /// The first key that only a track has a use for, and its place.
    pub(super) fn of_track(&self) -> Option<(&'static str, usize)> {
        first(keys!(self, front cycle_start_s log play clock_offset_s))
    }

    /// The first key that says something about the log, and its place.
    pub(super) fn of_log(&self) -> Option<(&'static str, usize)> {
        first(keys!(self, play clock_offset_s))
    }

    /// The first of [`NUMBERS`], and its place.
    pub(super) fn first_number(&self) -> Option<(&'static str, usize)> {
        NUMBERS
            .iter()
            .find_map(|key| Some((*key, self.number(key)?.span().start)))
    }
}

fn first<const N: usize>(
    keys: [(&'static str, Option<Range<usize>>); N],
) -> Option<(&'static str, usize)> {
    keys.into_iter()
        .find_map(|(key, span)| Some((key, span?.start)))
}
