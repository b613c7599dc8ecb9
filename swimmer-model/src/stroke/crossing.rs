//! How much of a cycle a real swimmer could not follow because its links would cross.

use super::extremes::zero;
use super::legendre::{N, NODES, Series};
use crate::{Gait, Links, Scalar};

/// The part of a gait whose shapes have crossing links, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingShare<T> {
    /// Share of the cycle's u, the time as parametrised.
    pub of_cycle: T,
    /// Share of the curve's length in the plane of joint angles, whatever its timing.
    pub of_length: T,
}

/// Looks are at least this dense over a cycle.
const LOOKS: usize = 256;

/// An overlap below this share of the middle link is a touch: samples of a gait that runs along the border of a crossing
/// lie to either side of it by rounding.
const TOUCH: f64 = 1e-8;

/// Share of a gait with crossing links ([`Links::cross`]), where touching is not crossing. Beginnings and ends are located exactly; a crossing that
/// comes and goes between two of 256 looks may be missed.
pub fn crossing_share<T: Scalar, G: Gait<T> + ?Sized>(
    links: &Links<T>,
    gait: &G,
) -> CrossingShare<T> {
    let touch = links.middle * T::from_f64(TOUCH);
    let overlap = |u: T| links.overlap(&gait.at(u).phi) - touch;
    let (mut u, mut crossing, mut length, mut crossing_length) =
        (T::zero(), T::zero(), T::zero(), T::zero());
    let pieces = gait.pieces().max(1);
    for piece in 0..pieces {
        let end = if piece + 1 == pieces {
            T::one()
        } else {
            gait.piece_end(piece)
        };
        let cells = (T::from_f64(LOOKS as f64) * (end - u)).to_f64();
        let start = u;
        let mut cell = 0.0;
        while u < end {
            cell += 1.0;
            let next = if cell < cells {
                start + T::from_f64(cell / LOOKS as f64)
            } else {
                end
            };
            let (here, there) = (overlap(u) > T::zero(), overlap(next) > T::zero());
            let border = if here == there {
                next
            } else {
                zero(u, next, overlap)
            };
            for (from, to, crosses) in [(u, border, here), (border, next, there)] {
                let stretch = arc_length(gait, from, to);
                length += stretch;
                if crosses {
                    crossing += to - from;
                    crossing_length += stretch;
                }
            }
            u = next;
        }
    }
    let of_length = if length > T::zero() {
        crossing_length / length
    } else {
        T::zero()
    };
    CrossingShare {
        of_cycle: crossing,
        of_length,
    }
}

/// ∫|Φ′| du.
fn arc_length<T: Scalar, G: Gait<T> + ?Sized>(gait: &G, from: T, to: T) -> T {
    let half = (to - from) * T::from_f64(0.5);
    if half <= T::zero() {
        return T::zero();
    }
    let speeds: [T; N] =
        core::array::from_fn(|j| gait.at(from + half * T::from_f64(1.0 + NODES[j])).speed());
    half * Series::through(&speeds).whole_integral()
}
