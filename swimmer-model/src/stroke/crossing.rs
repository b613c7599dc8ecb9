//! How much of a cycle a real swimmer could not follow because its links would cross.

use super::extremes::zero;
use super::legendre::{N, NODES, Series};
use crate::crossing::flatness;
use crate::{Gait, Links, Scalar};
use nalgebra::Vector2;

/// The part of a gait whose shapes have crossing links, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingShare<T> {
    /// Share of the cycle's u, the time as parametrised.
    pub of_cycle: T,
    /// Share of the curve's length in the plane of joint angles, whatever its timing.
    pub of_length: T,
    /// Whether a side link lies on the middle one or sweeps through it, be it for an instant.
    pub folds: bool,
}

/// Looks are at least this dense over a cycle.
const LOOKS: usize = 256;

/// An overlap below this share of the middle link is a touch: samples of a gait that runs along the border of a crossing
/// lie to either side of it by rounding.
const TOUCH: f64 = 1e-8;

/// Share of a gait with crossing links ([`Links::cross`]), where side links that touch do not cross. Beginnings and ends are
/// located exactly; a crossing that comes and goes between two of 256 looks may be missed.
///
/// ```
/// use swimmer_model::{Circle, Swimmer, crossing_share};
///
/// let links = Swimmer::<f64>::purcell().links;
/// assert_eq!(crossing_share(&links, &Circle { amplitude: 1.0 }).of_cycle, 0.0);
/// assert!(crossing_share(&links, &Circle { amplitude: 3.1 }).of_cycle > 0.0);
/// ```
pub fn crossing_share<T: Scalar, G: Gait<T> + ?Sized>(
    links: &Links<T>,
    gait: &G,
) -> CrossingShare<T> {
    let touch = links.middle * T::from_f64(TOUCH);
    let overlap = |u: T| links.overlap(&gait.at(u).phi) - touch;
    let flat = |u: T| {
        let phi = gait.at(u).phi;
        flatness(phi.x).max(flatness(phi.y))
    };
    // A link that only sweeps through |φ| = π lies there for no time: it must lie there still a little further on.
    let lies = |from: T, towards: T| {
        flat(from) >= T::zero() && flat(from + (towards - from) * T::from_f64(0.01)) >= T::zero()
    };
    let mut folds = false;
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
            let folded = lies(u, next) || lies(next, u);
            let level = |u: T| {
                if folded {
                    overlap(u).max(links.middle * flat(u))
                } else {
                    overlap(u)
                }
            };
            let (here, there) = (level(u) > T::zero(), level(next) > T::zero());
            folds |= fold_between(&gait.at(u).phi, &gait.at(next).phi);
            let border = if here == there {
                next
            } else {
                zero(u, next, level)
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
        folds,
    }
}

/// Whether a side link is folded flat at one of two shapes, or on the short way between them.
fn fold_between<T: Scalar>(from: &Vector2<T>, to: &Vector2<T>) -> bool {
    let through = |from: T, to: T| {
        let ((sin, cos), (next_sin, next_cos)) = (from.sin_cos(), to.sin_cos());
        let behind = cos < T::zero() && next_cos < T::zero();
        behind && sin * next_sin < T::zero()
            || flatness(from) >= T::zero()
            || flatness(to) >= T::zero()
    };
    through(from.x, to.x) || through(from.y, to.y)
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
