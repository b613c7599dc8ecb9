//! Gait table: up to 512 knots, uniform in the phase of the cycle, each two angles in 1e-4 rad. A periodic cubic with slopes of
//! fourth order connects them, so that the cycle closes and its rate is continuous.
//!
//! Bytes on the wire and in flash: for each knot φ₁ then φ₂, i16 little-endian. Knot `i` of `n` is at u = i/n; the first knot
//! follows the last one.

pub mod check;

use core::fmt;
pub use link_protocol::MAX_KNOTS;
use link_protocol::{ANGLE_UNIT_RAD, Joint, MAX_TABLE, crc32c};

/// Smallest number of knots.
pub const MIN_KNOTS: usize = 2;
/// Bytes of a knot.
pub const KNOT_BYTES: usize = 4;

/// Table of knots; empty until filled.
///
/// ```
/// use gait_player::GaitTable;
///
/// let circle = |u: f64| {
///     let angle = std::f64::consts::TAU * u;
///     [1.2 * angle.cos(), 1.2 * angle.sin()]
/// };
/// let table = GaitTable::from_fn(128, circle).unwrap();
/// assert_eq!(table.knot(0), [12_000, 0], "ten-thousandths of a radian");
/// assert_eq!(GaitTable::from_bytes(table.bytes()).unwrap().crc32(), table.crc32());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GaitTable {
    bytes: [u8; MAX_TABLE],
    len: u16,
}

/// Reason why samples form no valid table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableError {
    /// The number of knots is not in 2 to 512.
    Knots(usize),
    /// The number of bytes is not a multiple of four.
    Bytes(usize),
    /// An angle exceeds the range of the table (±3.2767 rad).
    Angle {
        /// Joint of the angle.
        joint: Joint,
        /// Index of the knot.
        knot: usize,
        /// Angle, rad.
        angle: f64,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Knots(knots) => write!(
                f,
                "a gait table of {knots} knots: give {MIN_KNOTS} to {MAX_KNOTS}"
            ),
            Self::Bytes(bytes) => write!(
                f,
                "a gait table of {bytes} bytes: it takes {KNOT_BYTES} a knot"
            ),
            Self::Angle { joint, knot, angle } => {
                write!(
                    f,
                    "{joint:?} joint at {angle} rad in knot {knot}: a gait table holds angles within 3.2767 rad"
                )
            }
        }
    }
}

impl core::error::Error for TableError {}

/// Exact position in the cycle: an interval between two knots, and a fraction of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Index of the knot before the position.
    pub interval: usize,
    /// 0 at that knot, towards 1 at the next.
    pub fraction: f32,
}

/// Angles and their slopes at a position in the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// φ₁, φ₂ in rad.
    pub angles: [f32; 2],
    /// Change of φ₁, φ₂ per interval, rad.
    pub slopes: [f32; 2],
}

impl GaitTable {
    /// Empty table: it has no knots and cannot play.
    pub const fn empty() -> Self {
        Self {
            bytes: [0; MAX_TABLE],
            len: 0,
        }
    }

    /// Parses the bytes of the wire.
    ///
    /// # Errors
    /// The number of bytes does not match a valid number of knots.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableError> {
        if !bytes.len().is_multiple_of(KNOT_BYTES) {
            return Err(TableError::Bytes(bytes.len()));
        }
        let knots = bytes.len() / KNOT_BYTES;
        if !(MIN_KNOTS..=MAX_KNOTS).contains(&knots) {
            return Err(TableError::Knots(knots));
        }
        let mut table = Self::empty();
        table.bytes[..bytes.len()].copy_from_slice(bytes);
        table.len = knots as u16;
        Ok(table)
    }

    /// Samples a closed curve `u -> (φ₁, φ₂)`, u in [0, 1), rad.
    ///
    /// # Errors
    /// The number of knots is invalid, or an angle exceeds the range.
    pub fn from_fn(
        knots: usize,
        mut curve: impl FnMut(f64) -> [f64; 2],
    ) -> Result<Self, TableError> {
        if !(MIN_KNOTS..=MAX_KNOTS).contains(&knots) {
            return Err(TableError::Knots(knots));
        }
        let mut table = Self::empty();
        table.len = knots as u16;
        for knot in 0..knots {
            let angles = curve(knot as f64 / knots as f64);
            for (joint, angle) in [Joint::Front, Joint::Back].into_iter().zip(angles) {
                let units = libm::round(angle * 1e4);
                if !(f64::from(-i16::MAX)..=f64::from(i16::MAX)).contains(&units) {
                    return Err(TableError::Angle { joint, knot, angle });
                }
                let at = knot * KNOT_BYTES + 2 * joint.index();
                table.bytes[at..at + 2].copy_from_slice(&(units as i16).to_le_bytes());
            }
        }
        Ok(table)
    }

    /// Resets to this number of knots, all zero, to be filled by [`Self::put`].
    pub(crate) fn clear(&mut self, knots: u16) {
        self.bytes = [0; MAX_TABLE];
        self.len = knots.min(MAX_KNOTS as u16);
    }

    /// Overwrites bytes; bytes past the end are ignored.
    pub(crate) fn put(&mut self, offset: usize, bytes: &[u8]) {
        let len = self.knots() * KNOT_BYTES;
        for (place, byte) in self.bytes[..len].iter_mut().skip(offset).zip(bytes) {
            *place = *byte;
        }
    }

    /// Buffer for the bytes of this number of knots, to be filled from storage.
    pub(crate) fn buffer(&mut self, knots: u16) -> &mut [u8] {
        self.clear(knots);
        let len = self.knots() * KNOT_BYTES;
        &mut self.bytes[..len]
    }

    /// Bytes of the table, as on the wire.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.knots() * KNOT_BYTES]
    }

    /// CRC-32C of [`Self::bytes`].
    pub fn crc32(&self) -> u32 {
        crc32c(self.bytes())
    }

    /// Number of knots; 0 for the empty table.
    pub fn knots(&self) -> usize {
        usize::from(self.len)
    }

    /// Angles of a knot in 1e-4 rad; the index is periodic.
    pub fn knot(&self, index: usize) -> [i16; 2] {
        let at = index % self.knots().max(1) * KNOT_BYTES;
        match self.bytes.get(at..at + KNOT_BYTES) {
            Some(&[a, b, c, d]) => [i16::from_le_bytes([a, b]), i16::from_le_bytes([c, d])],
            _ => [0; 2],
        }
    }

    /// Angles of a knot in rad.
    pub fn knot_angles(&self, index: usize) -> [f32; 2] {
        self.knot(index)
            .map(|angle| f32::from(angle) * ANGLE_UNIT_RAD)
    }

    /// Position of a time within the cycle, by integer arithmetic, so nothing drifts.
    pub fn phase(&self, in_cycle_us: u32, period_us: u32) -> Phase {
        let period = u64::from(period_us.max(1));
        let scaled = u64::from(in_cycle_us) * self.knots() as u64;
        let fraction = (scaled % period) as f32 / period as f32;
        Phase {
            interval: (scaled / period) as usize,
            fraction,
        }
    }

    /// Cubics of an interval, one per joint.
    pub(crate) fn interval(&self, interval: usize) -> [Cubic; 2] {
        // Six knots determine the slopes at both ends of the interval.
        let knots = self.knots().max(1);
        let start = interval % knots + 2 * knots;
        let near: [[i16; 2]; 6] = core::array::from_fn(|i| self.knot(start + i - 2));
        [0, 1].map(|joint| Cubic::new(near.map(|knot| f32::from(knot[joint]))))
    }

    /// Angles and slopes at a position.
    pub fn at(&self, phase: Phase) -> Shape {
        let cubics = self.interval(phase.interval);
        Shape {
            angles: [0, 1].map(|joint| cubics[joint].value(phase.fraction) * ANGLE_UNIT_RAD),
            slopes: [0, 1].map(|joint| cubics[joint].slope(phase.fraction) * ANGLE_UNIT_RAD),
        }
    }
}

/// Cubic of one joint between two knots: `a + b t + c t² + d t³` in 1e-4 rad, t from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cubic {
    pub(crate) a: f32,
    pub(crate) b: f32,
    pub(crate) c: f32,
    pub(crate) d: f32,
}

impl Cubic {
    /// Cubic of the interval from knot 0 to knot 1, given the knots −2 … 3.
    fn new([k0, k1, k2, k3, k4, k5]: [f32; 6]) -> Self {
        // Central differences of fourth order, exact for quartics.
        let slope0 = (8.0 * (k3 - k1) - (k4 - k0)) / 12.0;
        let slope1 = (8.0 * (k4 - k2) - (k5 - k1)) / 12.0;
        let rise = k3 - k2;
        Self {
            a: k2,
            b: slope0,
            c: 3.0 * rise - 2.0 * slope0 - slope1,
            d: slope0 + slope1 - 2.0 * rise,
        }
    }

    pub(crate) fn value(&self, t: f32) -> f32 {
        self.a + t * (self.b + t * (self.c + t * self.d))
    }

    pub(crate) fn slope(&self, t: f32) -> f32 {
        self.b + t * (2.0 * self.c + t * 3.0 * self.d)
    }
}

#[cfg(test)]
mod tests;
