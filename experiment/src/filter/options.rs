//! Options, events and counts of the pose filter.

use swimmer_files::Reflectors;

/// Options of the pose filter.
#[derive(Debug, Clone)]
pub struct FilterOptions {
    /// Names of the reflectors, and their places on the middle link.
    pub reflectors: Reflectors,
    /// Length of the middle link \[m\]: its ends are the joints.
    pub middle_m: f64,
    /// Period of the quickest gait that will be swum \[s\]: sets how fast the motion may change.
    pub period_s: f64,
    /// Delay between exposure and transmission \[s\], if the source does not state it.
    pub latency_s: f64,
    /// Standard deviation of a measured coordinate \[m\], at the beginning; later it is estimated.
    pub noise_m: f64,
    /// Longest time without a reflector before the robot is lost \[s\].
    pub longest_blank_s: f64,
}

impl FilterOptions {
    /// For these reflectors on a middle link of this length \[m\]: a period of 4 s, no latency, 0.3 mm, lost after 1 s.
    pub fn new(reflectors: Reflectors, middle_m: f64) -> Self {
        Self {
            reflectors,
            middle_m,
            period_s: 4.0,
            latency_s: 0.0,
            noise_m: 3e-4,
            longest_blank_s: 1.0,
        }
    }
}

/// Change of the tracking state that a caller must handle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilterEvent {
    /// The robot was found, for the first time or after it was lost.
    Found,
    /// No reflector was seen for too long.
    Lost,
    /// The pose jumped: the cameras were moved or set up anew, or the robot was lifted.
    Jumped {
        /// Distance \[m\].
        moved_m: f64,
        /// Angle \[rad\].
        turned_rad: f64,
    },
    /// Front and back were exchanged: the names had been wrong at first.
    TurnedRound,
    /// The camera clock was set back; everything begins anew.
    ClockSet,
}

/// Counts of frames.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FilterCounts {
    /// All frames.
    pub frames: u64,
    /// Frames with both reflectors.
    pub both: u64,
    /// Frames with one of them.
    pub one: u64,
    /// Frames whose names contradict the order: swaps that changed nothing.
    pub swapped: u64,
    /// Frames that came after a later one.
    pub out_of_order: u64,
}
