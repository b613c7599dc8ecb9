//! Share of a cycle with crossing links, which a robot could not follow.

use super::extremes::zero;
use super::legendre::{N, Rule, Series};
use crate::crossing::flatness;
use crate::{Gait, Links, Scalar};
use nalgebra::Vector2;

/// Share of a gait with crossing links, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingShare<T> {
    /// Share of the cycle's u, the time as parametrised.
    pub of_cycle: T,
    /// Share of the curve's length in the plane of joint angles, independent of its timing.
    pub of_length: T,
    /// `true` if a side link lies on the middle link or passes through it at any time.
    pub folds: bool,
}

/// Least number of samples over a cycle.
const LOOKS: usize = 256;

/// Overlap, relative to the middle link, below which links only touch. Samples of a gait that runs along the boundary of the
/// crossing set lie on either side of it by rounding.
const TOUCH: f64 = 1e-8;

/// Returns the share of a gait with crossing links ([`Links::cross`]); links that touch do not cross. Starts and ends of
/// crossings are located exactly. A crossing that begins and ends between two of 256 samples may be missed.
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
    let mut crossing = T::zero();
    let folds = stretches(links, gait, |from, to, crosses| {
        if crosses {
            crossing += to - from;
        }
    });
    let (mut length, mut crossing_length) = (T::zero(), T::zero());
    // Lengths cost more than samples, and most gaits have no crossing.
    if crossing > T::zero() {
        stretches(links, gait, |from, to, crosses| {
            let stretch = arc_length(gait, from, to);
            length += stretch;
            if crosses {
                crossing_length += stretch;
            }
        });
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

/// Sample of a gait.
struct GaitSample<T> {
    phi: Vector2<T>,
    /// Overlap of the side links.
    overlap: T,
    /// Larger [`flatness`] of the two side links.
    flat: T,
}

/// Visits all intervals of a cycle with their ends u and whether links cross within. Returns `true` if a side link is ever
/// folded flat.
fn stretches<T: Scalar, G: Gait<T> + ?Sized>(
    links: &Links<T>,
    gait: &G,
    mut visit: impl FnMut(T, T, bool),
) -> bool {
    let touch = links.middle * T::from_f64(TOUCH);
    let look = |u: T| {
        let phi = gait.at(u).phi;
        GaitSample {
            overlap: links.overlap(&phi) - touch,
            flat: flatness(phi.x).max(flatness(phi.y)),
            phi,
        }
    };
    // A link that only passes through |φ| = π is not folded for a finite time: it must still be folded a little later.
    let lies = |at: &GaitSample<T>, from: T, towards: T| {
        at.flat >= T::zero() && look(from + (towards - from) * T::from_f64(0.01)).flat >= T::zero()
    };
    let mut folds = false;
    let mut u = T::zero();
    let mut here = look(u);
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
            let there = look(next);
            let folded = lies(&here, u, next) || lies(&there, next, u);
            let level = |at: &GaitSample<T>| {
                if folded {
                    at.overlap.max(links.middle * at.flat)
                } else {
                    at.overlap
                }
            };
            let crosses = [&here, &there].map(|at| level(at) > T::zero());
            folds |= there.folds_after(&here);
            if crosses[0] == crosses[1] {
                visit(u, next, crosses[0]);
            } else {
                let border = zero(u, next, |u| level(&look(u)));
                visit(u, border, crosses[0]);
                visit(border, next, crosses[1]);
            }
            (u, here) = (next, there);
        }
    }
    folds
}

impl<T: Scalar> GaitSample<T> {
    /// Returns `true` if a side link is folded flat at this sample, at the previous one, or on the short way between them.
    fn folds_after(&self, before: &Self) -> bool {
        // Value of the flatness if no side link points backwards.
        let forwards = -T::one();
        before.flat >= T::zero()
            || self.flat >= T::zero()
            || (before.flat > forwards
                && self.flat > forwards
                && fold_between(&before.phi, &self.phi))
    }
}

/// Returns `true` if a side link passes through |φ| = π on the short way between two shapes.
fn fold_between<T: Scalar>(from: &Vector2<T>, to: &Vector2<T>) -> bool {
    let through = |from: T, to: T| {
        let ((sin, cos), (next_sin, next_cos)) = (from.sin_cos(), to.sin_cos());
        cos < T::zero() && next_cos < T::zero() && sin * next_sin < T::zero()
    };
    through(from.x, to.x) || through(from.y, to.y)
}

/// ∫|Φ′| du.
fn arc_length<T: Scalar, G: Gait<T> + ?Sized>(gait: &G, from: T, to: T) -> T {
    let half = (to - from) * T::from_f64(0.5);
    let speeds: [T; N] = core::array::from_fn(|j| {
        let place = from + half * T::from_f64(1.0 + Rule::<N>::NODES[j]);
        gait.at(place).speed()
    });
    half * Series::through(&speeds).whole_integral()
}
