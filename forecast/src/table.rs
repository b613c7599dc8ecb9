//! Table that the robot is sent for a gait: samples, with rounded corners.
//!
//! At a corner of a gait a joint's rate jumps, and a cubic through knots on both sides overshoots both rates by up to a third: a
//! gait within its servos' rate would make a table that is refused. A weighted mean of neighbours with positive weights is never
//! faster than the neighbours. So the knots near a corner are such means, with binomial weights over eight intervals: the cubic
//! then exceeds the rates by 0.13 % at most, and the corner is cut over a sixtieth of the cycle.

use std::ops::RangeInclusive;

use gait_player::GaitTable;
use gait_player::table::TableError;
use nalgebra::Vector2;
use swimmer_model::Gait;

/// Binomial weights of a knot's neighbours, from four before to four after it.
const WEIGHTS: [f64; 9] = [1.0, 8.0, 28.0, 56.0, 70.0, 56.0, 28.0, 8.0, 1.0];
/// Intervals on either side of a corner in which knots are means.
const BESIDE: RangeInclusive<i32> = -4..=4;
/// Tables of fewer knots are too coarse to round anything: eight intervals would be too large a part of the cycle.
const FEWEST: usize = 128;

/// The table of a gait that a robot is given.
///
/// # Errors
/// [`TableError`]: the number of knots, or an angle that does not fit.
///
/// ```
/// use forecast::table;
/// use swimmer_files::AnyGait;
///
/// let sent = table(&AnyGait::circle(1.2), 256).unwrap();
/// assert_eq!(sent.knots(), 256);
/// assert!(sent.knot_angles(100)[0].hypot(sent.knot_angles(100)[1]) - 1.2 < 1e-4);
/// ```
pub fn table<G: Gait<f64> + ?Sized>(gait: &G, knots: usize) -> Result<GaitTable, TableError> {
    let knot = knot(gait, knots);
    GaitTable::from_fn(knots, |u| knot(u).into())
}

/// The angles of a table's knot at u \[rad\], before they are rounded to the table's units.
pub(crate) fn knot<G: Gait<f64> + ?Sized>(
    gait: &G,
    knots: usize,
) -> impl Fn(f64) -> Vector2<f64> + use<'_, G> {
    let interval = 1.0 / knots as f64;
    let reach = f64::from(*BESIDE.end()) * interval;
    let pieces = (0..gait.pieces()).filter(|&piece| gait.corner_at_end(piece));
    let corners: Vec<f64> = pieces.map(|piece| gait.piece_end(piece)).collect();
    move |u| {
        let beside = |corner: &f64| {
            let off = (u - corner).abs();
            off.min(1.0 - off) < reach
        };
        if knots < FEWEST || !corners.iter().any(beside) {
            return gait.at(u).phi;
        }
        let weighed = BESIDE.zip(WEIGHTS).map(|(k, weight)| {
            let there = u + f64::from(k) * interval;
            gait.at(there.rem_euclid(1.0)).phi * weight
        });
        weighed.sum::<Vector2<f64>>() / WEIGHTS.iter().sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gait_player::Limits;
    use swimmer_files::AnyGait;

    /// Shortest period of a table for servos of 1 rad/s \[s\].
    fn shortest(table: &GaitTable) -> f64 {
        let limits = Limits {
            max_rate: 1.0,
            ..Limits::ROBOT
        };
        (0..table.knots())
            .map(|interval| f64::from(table.interval_period(interval, &limits)))
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_square_keeps_its_rate() {
        // Corners fall on knots in one table and between them in the others.
        for knots in [512, 510, 509] {
            let square = AnyGait::square(1.6);
            let sampled = GaitTable::from_fn(knots, |u| square.at(u).phi.into()).unwrap();
            // Four sides of 3.2 rad at 1 rad/s.
            assert!(shortest(&sampled) > 1.14 * 12.8, "{knots}");
            // The robot tolerates a rate slightly above its limit; rounding to 1e-4 rad is small against 0.025 rad between knots.
            let rounded = shortest(&table(&square, knots).unwrap());
            assert!(
                (0.99..1.005).contains(&(rounded / 12.8)),
                "{knots}: {rounded}"
            );
        }
    }

    #[test]
    fn what_has_no_corner_is_sampled() {
        for (gait, knots) in [(AnyGait::circle(1.2), 512), (AnyGait::square(1.0), 64)] {
            let sampled = GaitTable::from_fn(knots, |u| gait.at(u).phi.into());
            assert_eq!(table(&gait, knots), sampled);
        }
    }
}
