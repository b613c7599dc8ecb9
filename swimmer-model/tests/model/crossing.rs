//! Crossing links against a plain test of segments in the plane.

use crate::near;
use crate::random::{cases, shape, swimmer};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::PI;
use swimmer_model::{Circle, Gait, Links, Model, Square, Swimmer, crossing_share};

/// Side links as segments in the body frame.
fn segments(links: &Links<f64>, phi: &Vector2<f64>) -> [[Vector2<f64>; 2]; 2] {
    let h = Vector2::new(links.middle / 2.0, 0.0);
    let end = |joint: Vector2<f64>, length: f64, angle: f64| {
        [
            joint,
            joint + Vector2::new(angle.cos(), angle.sin()) * length,
        ]
    };
    [end(h, links.front, phi.x), end(-h, links.back, PI - phi.y)]
}

/// `true` if the ends of each segment lie on different sides of the other.
fn intersect([a, b]: [Vector2<f64>; 2], [c, d]: [Vector2<f64>; 2]) -> bool {
    let side = |p: Vector2<f64>, q: Vector2<f64>, r: Vector2<f64>| (q - p).perp(&(r - p));
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn side_links_cross_as_segments_do(swimmer in swimmer(), phi in shape()) {
        let [front, back] = segments(&swimmer.links, &phi);
        prop_assert_eq!(Model::new(&swimmer).unwrap().links_cross(&phi), intersect(front, back));
    }
}

#[test]
fn equal_bends_cross_from_the_angle_where_the_tips_meet() {
    for (swimmer, expected) in [(Swimmer::robot(), 1.833), (Swimmer::purcell(), 2.095)] {
        let model = Model::<f64>::new(&swimmer).unwrap();
        let Links { middle, front, .. } = swimmer.links;
        let border = f64::acos(-middle / (2.0 * front));
        // The printed angles are rounded up.
        near("border", border, expected, 1e-3);
        for side in [1.0, -1.0] {
            let bent = |angle: f64| model.links_cross(&(Vector2::new(angle, angle) * side));
            assert!(!bent(border - 1e-9) && bent(border + 1e-9) && bent(3.1) && !bent(0.0));
        }
    }
}

#[test]
fn a_link_folded_flat_overlaps_the_middle_one() {
    let model = Model::<f64>::new(&Swimmer::purcell()).unwrap();
    for folded in [PI, -PI, 3.0 * PI] {
        assert!(
            model.links_cross(&Vector2::new(folded, 0.3))
                && model.links_cross(&Vector2::new(-0.3, folded))
        );
    }
    assert!(
        Model::<f32>::new(&Swimmer::purcell())
            .unwrap()
            .links_cross(&Vector2::new(std::f32::consts::PI, 0.3))
    );
    for free in [0.0, 0.5, -1.0, 3.1, std::f64::consts::TAU] {
        assert!(!model.links_cross(&Vector2::new(free, 0.0)), "{free}");
    }
}

#[test]
fn share_of_a_cycle() {
    let links = Swimmer::<f64>::robot().links;
    // The experiments' circles never cross.
    for amplitude in [0.5, 1.2, 110.0_f64.to_radians()] {
        assert_eq!(crossing_share(&links, &Circle { amplitude }).of_cycle, 0.0);
    }
    // A brute count over a large circle and square.
    let count = 100_000;
    for amplitude in [2.8, 3.0] {
        let (circle, square) = (Circle { amplitude }, Square { amplitude });
        let places = || (0..count).map(|i| (f64::from(i) + 0.5) / f64::from(count));
        let share = |phi: &dyn Fn(f64) -> Vector2<f64>| {
            places().filter(|&u| links.cross(&phi(u))).count() as f64 / f64::from(count)
        };
        for (found, counted) in [
            (
                crossing_share(&links, &circle),
                share(&|u| circle.at(u).phi),
            ),
            (
                crossing_share(&links, &square),
                share(&|u| square.at(u).phi),
            ),
        ] {
            println!("share {found:?}");
            assert!(counted > 0.1);
            near("of cycle", found.of_cycle, counted, 3e-5);
            near("of length", found.of_length, found.of_cycle, 1e-12);
        }
    }
}

/// A gait that runs along |φ| = π has links on each other there, one that sweeps through it for an instant.
#[test]
fn folded_links_cross() {
    let links = Swimmer::<f64>::purcell().links;
    let square = |amplitude| crossing_share(&links, &Square { amplitude });
    near("on the border", square(PI).of_cycle, 1.0, 1e-12);
    near("just inside", square(PI - 1e-3).of_cycle, 0.25, 1e-3);
    assert!(square(PI).folds && !square(PI - 1e-3).folds && square(PI + 1e-3).folds);
    // Side links too short to meet each other: only the middle one is in their way.
    let short = Links {
        middle: 1.0,
        front: 0.2,
        back: 0.2,
    };
    let circle = |amplitude| crossing_share(&short, &Circle { amplitude });
    assert!(circle(3.0).of_cycle == 0.0 && !circle(3.0).folds);
    assert!(circle(PI).folds && circle(3.5).folds);
}
