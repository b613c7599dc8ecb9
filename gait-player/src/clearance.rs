//! How far apart the side links are. What goes to a robot keeps a margin; and because a joint that turns by δ moves no
//! point of its link by more than l·δ, a clearance found at one shape vouches for a whole stretch around it. So a gait
//! is checked between its knots too, without gaps, in a few dozen evaluations.

use libm::{cosf, fabsf, sinf, sqrtf};
use swimmer_model::Links;

/// Margin kept between side links, as a share of the middle link.
pub const MARGIN_OVER_MIDDLE: f32 = 0.1;

type Point = [f32; 2];

/// Distance between the side links at shape Φ, m; and not more than the way a side link has left until it lies folded
/// on the middle one (|φ| = π).
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

/// The margin kept with these links, m.
pub fn margin(links: &Links<f32>) -> f32 {
    MARGIN_OVER_MIDDLE * links.middle
}

/// How far any point of a side link moves at most against the other when the joints turn by these angles, m.
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
    // Without a line that parts them, segments cross, or lie on one line: then their ends tell the distance.
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
