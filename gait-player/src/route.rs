//! Route to a gait's first knot, decided step by step: straight if the side links stay clear, otherwise through neutral,
//! otherwise refused.

use crate::clearance::{Way, WayCheck};
use crate::ramp::NEUTRAL;
use swimmer_model::Links;

/// Decision in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Route {
    from: [f32; 2],
    to: [f32; 2],
    leg: Leg,
    check: WayCheck,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Leg {
    Straight,
    ToNeutral,
    FromNeutral,
}

/// State of the decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decision {
    /// Not decided yet.
    Unknown,
    /// Straight path.
    Straight,
    /// Path through neutral.
    ViaNeutral,
    /// No path is clear; the last evaluation failed at this shape.
    Crosses([f32; 2]),
}

impl Route {
    pub(crate) fn new(from: [f32; 2], to: [f32; 2]) -> Self {
        Self {
            from,
            to,
            leg: Leg::Straight,
            check: WayCheck::new(from, to),
        }
    }

    /// Returns true if the route begins at exactly this shape.
    #[allow(clippy::float_cmp)]
    pub(crate) fn begins_at(&self, from: [f32; 2]) -> bool {
        self.from == from
    }

    /// Evaluates the clearance once.
    pub(crate) fn advance(&mut self, links: &Links<f32>) -> Decision {
        match (self.check.advance(links), self.leg) {
            (Way::Unknown, _) => {}
            (Way::Clear, Leg::Straight) => return Decision::Straight,
            (Way::Crosses(_), Leg::Straight) => self.go(Leg::ToNeutral, self.from, NEUTRAL),
            (Way::Clear, Leg::ToNeutral) => self.go(Leg::FromNeutral, NEUTRAL, self.to),
            (Way::Clear, Leg::FromNeutral) => return Decision::ViaNeutral,
            (Way::Crosses(shape), _) => return Decision::Crosses(shape),
        }
        Decision::Unknown
    }

    fn go(&mut self, leg: Leg, from: [f32; 2], to: [f32; 2]) {
        self.leg = leg;
        self.check = WayCheck::new(from, to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    fn decide(from: [f32; 2], to: [f32; 2]) -> Decision {
        let links = Swimmer::purcell().links;
        let mut route = Route::new(from, to);
        let looks = (0..200).map(|_| route.advance(&links));
        looks
            .into_iter()
            .find(|decision| *decision != Decision::Unknown)
            .unwrap_or(Decision::Unknown)
    }

    #[test]
    fn straight_where_clear_around_where_not_nowhere_where_neither() {
        assert_eq!(decide([0.0; 2], [1.2, 1.2]), Decision::Straight);
        // Both ends are clear, the midpoint (2.15, 2.15) is not; the same with opposite signs.
        assert_eq!(decide([2.8, 1.5], [1.5, 2.8]), Decision::ViaNeutral);
        assert_eq!(decide([-1.5, -2.8], [-2.8, -1.5]), Decision::ViaNeutral);
        assert!(matches!(
            decide([0.5, 0.0], [2.3, 2.3]),
            Decision::Crosses(_)
        ));
        assert!(matches!(
            decide([2.3, 2.3], [0.5, 0.0]),
            Decision::Crosses(_)
        ));
    }
}
