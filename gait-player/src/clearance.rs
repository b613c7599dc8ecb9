//! Clearance between the side links, with a margin for robots. A joint that turns by δ moves no point of its link by more than
//! l·δ. So the clearance at one shape bounds that of a neighbourhood, and a gait is checked between its knots without gaps in a
//! few dozen evaluations.

use libm::{cosf, fabsf, sinf, sqrtf};
use swimmer_model::Links;

/// Safety margin between side links as an angle, rad: the tip of the longer link moves by the margin in this turn. With either
/// joint one degree off (a servo's dead band) the links still do not touch. The paper's gait (b) comes as close as 1.83
/// margins.
pub const MARGIN_TURN: f32 = 0.0175;

type Point = [f32; 2];

/// Distance between the side links at shape Φ, m. It is at most the distance that a side link can still move before it is
/// folded onto the middle one (|φ| = π).
pub fn clearance(links: &Links<f32>, phi: [f32; 2]) -> f32 {
    let half = 0.5 * links.middle;
    let front = [
        [half, 0.0],
        [
            half + links.front * cosf(phi[0]),
            links.front * sinf(phi[0]),
        ],
    ];
    let back = [
        [-half, 0.0],
        [-half - links.back * cosf(phi[1]), links.back * sinf(phi[1])],
    ];
    let folded = |length: f32, angle: f32| {
        let turn = core::f32::consts::TAU;
        let away = libm::remainderf(angle, turn);
        length * (core::f32::consts::PI - fabsf(away))
    };
    segment_distance(front, back)
        .min(folded(links.front, phi[0]))
        .min(folded(links.back, phi[1]))
}

/// Safety margin for these links, m.
pub fn margin(links: &Links<f32>) -> f32 {
    MARGIN_TURN * links.front.max(links.back)
}

/// Largest displacement of a point of a side link relative to the other for these joint rotations, m.
pub fn motion(links: &Links<f32>, turn: [f32; 2]) -> f32 {
    links.front * fabsf(turn[0]) + links.back * fabsf(turn[1])
}

fn segment_distance(a: [Point; 2], b: [Point; 2]) -> f32 {
    let side = |o: Point, p: Point, q: Point| {
        (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
    };
    let apart =
        |s: [Point; 2], t: [Point; 2]| side(s[0], s[1], t[0]) * side(s[0], s[1], t[1]) > 0.0;
    let ends = point_distance_squared(a[0], b)
        .min(point_distance_squared(a[1], b))
        .min(point_distance_squared(b[0], a))
        .min(point_distance_squared(b[1], a));
    // Disjoint segments are closest at an end. Segments without a separating line cross, unless they are collinear.
    if apart(a, b) || apart(b, a) || side(a[0], a[1], b[0]) == 0.0 {
        sqrtf(ends)
    } else {
        0.0
    }
}

fn point_distance_squared(p: Point, [a, b]: [Point; 2]) -> f32 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let t = ((along[0] * to[0] + along[1] * to[1]) / length_squared).clamp(0.0, 1.0);
    let away = [to[0] - t * along[0], to[1] - t * along[1]];
    away[0] * away[0] + away[1] * away[1]
}

/// Straight path in shape space, checked step by step: each clearance certifies the stretch that it bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayCheck {
    from: [f32; 2],
    to: [f32; 2],
    done: f32,
}

/// Progress of a [`WayCheck`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Not decided yet.
    Unknown,
    /// The path is clear.
    Clear,
    /// The side links come too close at this shape.
    Crosses([f32; 2]),
}

/// Margin on a path, as a share of the gaits' margin. A path starts and ends at shapes that gaits may have, so it keeps a
/// little less.
const WAY_MARGIN: f32 = 0.5;
/// Smallest step, as a share of the path.
const SMALLEST_SHARE: f32 = 0.02;

impl WayCheck {
    /// Check of the path between two shapes.
    pub fn new(from: [f32; 2], to: [f32; 2]) -> Self {
        Self {
            from,
            to,
            done: 0.0,
        }
    }

    /// Evaluates the clearance at one shape.
    pub fn advance(&mut self, links: &Links<f32>) -> Way {
        let at = self.done.min(1.0);
        let shape = [0, 1].map(|joint| self.from[joint] + at * (self.to[joint] - self.from[joint]));
        let reach = clearance(links, shape) - WAY_MARGIN * margin(links);
        if reach < 0.0 || reach.is_nan() {
            return Way::Crosses(shape);
        }
        if at >= 1.0 {
            return Way::Clear;
        }
        let whole = motion(
            links,
            [self.to[0] - self.from[0], self.to[1] - self.from[1]],
        );
        self.done = if whole > 0.0 {
            (at + (reach / whole).max(SMALLEST_SHARE)).min(1.0)
        } else {
            1.0
        };
        Way::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;
    use proptest::prelude::*;
    use swimmer_model::Swimmer;

    proptest! {
        /// Compares with the model's own crossing test: zero clearance if links cross, positive otherwise.
        #[test]
        fn it_agrees_with_the_models_crossing(a in -3.1_f32..3.1, b in -3.1_f32..3.1, robot in any::<bool>()) {
            let swimmer: Swimmer<f32> = if robot { Swimmer::robot() } else { Swimmer::purcell() };
            let gap = clearance(&swimmer.links, [a, b]);
            let overlap = swimmer.links.overlap(&Vector2::new(a, b));
            if overlap > 1e-5 {
                prop_assert!(gap == 0.0, "{}", gap);
            } else if overlap < -1e-5 {
                prop_assert!(gap > 0.0);
            }
        }

        #[test]
        fn no_turn_changes_it_by_more_than_the_motion(
            a in -3.1_f32..3.1, b in -3.1_f32..3.1, da in -0.3_f32..0.3, db in -0.3_f32..0.3
        ) {
            let links = Swimmer::robot().links;
            let change = clearance(&links, [a, b]) - clearance(&links, [a + da, b + db]);
            prop_assert!(change.abs() <= motion(&links, [da, db]) + 1e-6, "{}", change);
        }
    }

    fn check(from: [f32; 2], to: [f32; 2]) -> Way {
        let mut check = WayCheck::new(from, to);
        let links = Swimmer::purcell().links;
        let steps = (0..60).map(|_| check.advance(&links));
        steps
            .into_iter()
            .find(|way| *way != Way::Unknown)
            .unwrap_or(Way::Unknown)
    }

    #[test]
    fn ways_are_followed_to_their_end() {
        assert_eq!(check([0.0; 2], [1.3, 1.3]), Way::Clear);
        assert_eq!(check([0.7; 2], [0.7; 2]), Way::Clear);
        assert!(matches!(check([0.0; 2], [2.1, 2.1]), Way::Crosses(_)));
        // Around the corner of the crossing region: clear at both ends, not between.
        assert!(matches!(check([2.8, 1.6], [1.6, 2.8]), Way::Crosses(_)));
        assert!(matches!(check([f32::NAN, 0.0], [0.0; 2]), Way::Crosses(_)));
    }

    #[test]
    fn a_folded_link_is_no_clear_shape() {
        let links = Swimmer::robot().links;
        assert!(clearance(&links, [core::f32::consts::PI, 0.5]) < 1e-6);
        assert!((clearance(&links, [0.0, 0.0]) - 0.071).abs() < 1e-6);
    }
}
