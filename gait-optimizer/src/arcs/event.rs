//! Events that end an arc, located on the cubic Hermite interpolant of a step, which can show two crossings in one step.

use crate::numerics::halved;

/// Event that can end an arc. Each has a value that falls through zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Event<E> {
    /// Margin to the bound with this index in the region.
    Bound(usize),
    /// Remaining length of the active bound's piece.
    PieceEnd,
    /// Height along a bound, which is the multiplier of the bound.
    HeightGone,
    /// End of the whole chain.
    End(E),
}

/// Largest number of event sources: eight bounds and five others.
pub(super) const MOST_EVENTS: usize = 13;
/// Monitored events with value and slope at one end of a step.
pub(super) type Watched<E> = [Option<(Event<E>, f64, f64)>; MOST_EVENTS];

/// Distance along a step \[rad\] below which events coincide; less than the accuracy of their first location.
const SAME_PLACE: f64 = 1e-6;

/// First counted event whose value falls through zero within a step, with its place.
pub(super) fn first_event<E: Copy>(
    (before, after): (&Watched<E>, &Watched<E>),
    length: f64,
    counts: impl Fn(&Event<E>) -> bool,
    precedes: impl Fn(&Event<E>) -> bool,
) -> Option<(Event<E>, f64)> {
    let crossings = before.iter().zip(after).filter_map(|pair| match pair {
        (Some((event, v0, s0)), Some((_, v1, s1))) => {
            let at = falls([*v0, *v1], [*s0, *s1], length)?;
            counts(event).then_some((*event, at))
        }
        _ => None,
    });
    let earliest = crossings.clone().min_by(|a, b| a.1.total_cmp(&b.1))?;
    // At a corner of the region on φ₁ = −φ₂ both bounds and the end coincide; the end has priority.
    let end = crossings.into_iter().find(|(event, _)| precedes(event));
    end.filter(|(_, at)| at - earliest.1 < SAME_PLACE)
        .or(Some(earliest))
}

/// First falling zero of the cubic with these values and slopes at both ends.
fn falls(value: [f64; 2], slope: [f64; 2], length: f64) -> Option<f64> {
    const SCAN_POINTS: u32 = 8;
    // The cubic is within the convex hull of its Bézier control values.
    let inner = [
        value[0] + length * slope[0] / 3.0,
        value[1] - length * slope[1] / 3.0,
    ];
    if value.iter().chain(&inner).all(|control| *control >= 0.0) {
        return None;
    }
    let cubic = |s: f64| {
        let rest = 1.0 - s;
        let (off0, off1) = (
            length * slope[0] - (value[1] - value[0]),
            length * slope[1] - (value[1] - value[0]),
        );
        value[0] * rest + value[1] * s + (off0 * rest - off1 * s) * (s * rest)
    };
    let mut low = 0.0;
    for look in 1..=SCAN_POINTS {
        let high = f64::from(look) / f64::from(SCAN_POINTS);
        if cubic(high) < 0.0 {
            let [_, fallen] = halved([low, high], 20, |s| cubic(s) >= 0.0);
            return Some(fallen * length);
        }
        low = high;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_double_crossing_within_a_step_is_seen() {
        // (s − 0.3)(s − 0.6), falling at 0.3 and rising at 0.6.
        let at = falls([0.18, 0.28], [-0.9, 1.1], 1.0).unwrap();
        assert!((at - 0.3).abs() < 1e-5, "{at}");
        assert!(
            falls([0.0, 1.0], [1.0, 1.0], 1.0).is_none(),
            "rising from zero is no exit"
        );
        assert!(
            falls([-1e-16, 1.0], [1.0, 1.0], 1.0).is_none(),
            "nor from a rounded zero"
        );
    }
}
