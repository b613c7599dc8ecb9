use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

type Segment = [Vector2<f64>; 2];

/// The side links with θ = 0, from joint to tip.
fn side_links(links: &Links<f64>, phi: &Vector2<f64>) -> [Segment; 2] {
    let front = Vector2::new(0.5 * links.middle, 0.0);
    let back = -front;
    let (sin1, cos1) = phi.x.sin_cos();
    let (sin2, cos2) = phi.y.sin_cos();
    [
        [front, front + Vector2::new(cos1, sin1) * links.front],
        [back, back + Vector2::new(-cos2, sin2) * links.back],
    ]
}

/// Distance of two segments by brute force: the squared distance is convex in both places, so nested ternary searches.
fn distance([a, b]: &Segment, [c, d]: &Segment) -> f64 {
    let least = |f: &dyn Fn(f64) -> f64| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..90 {
            let (left, right) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
            if f(left) < f(right) {
                high = right;
            } else {
                low = left;
            }
        }
        f(0.5 * (low + high))
    };
    let between = |s: f64, t: f64| (a + (b - a) * s - c - (d - c) * t).norm_squared();
    least(&|s| least(&|t| between(s, t))).sqrt()
}

fn bounds(clearance: f64) -> Bounds {
    Bounds {
        no_overlap: true,
        clearance,
        ..Bounds::default()
    }
}

fn curved(region: &Region) -> Bound {
    region.bounds().last().unwrap()
}

fn links() -> impl Strategy<Value = Links<f64>> {
    (0.3..3.0, 0.2..2.0, 0.2..2.0).prop_map(|(middle, front, back)| {
        let length: f64 = middle + front + back;
        Links {
            middle: middle / length,
            front: front / length,
            back: back / length,
        }
    })
}

proptest! {
    /// Inside means: not crossing, and the brute-force distance is at least the clearance.
    #[test]
    fn the_region_is_where_the_side_links_are_apart(
        links in links(), share in 0.0..0.9, x in -PI..PI, y in -PI..PI,
    ) {
        let phi = Vector2::new(x, y);
        let clearance = share * links.middle;
        let region = Region::new(&bounds(clearance), &links);
        let inside = region.overstepped(&phi) <= 0.0;
        let [front, back] = side_links(&links, &phi);
        let apart = distance(&front, &back);
        prop_assume!((apart - clearance).abs() > 1e-6);
        let crosses = links.overlap(&phi) > 0.0;
        prop_assert_eq!(inside, !crosses && apart > clearance, "{} {}", apart, clearance);
    }

    /// Touching allowed: the region is where the model says that the links do not cross.
    #[test]
    fn without_clearance_it_is_the_models_overlap(links in links(), x in -PI..PI, y in -PI..PI) {
        let phi = Vector2::new(x, y);
        let overlap = links.overlap(&phi);
        prop_assume!(overlap.abs() > 1e-9);
        let region = Region::new(&bounds(0.0), &links);
        prop_assert_eq!(region.overstepped(&phi) <= 0.0, overlap < 0.0);
    }

    /// The margin is the distance of the tips from the other link, if the links do not cross.
    #[test]
    fn the_margin_is_a_distance(links in links(), x in -PI..PI, y in -PI..PI) {
        let phi = Vector2::new(x, y);
        prop_assume!(links.overlap(&phi) < 0.0);
        let Some(clearance) = Clearance::new(&links, 0.0) else { return Ok(()) };
        let [front, back] = side_links(&links, &phi);
        let tip = |[_, end]: &Segment, other: &Segment| distance(&[*end, *end], other);
        let expected = tip(&front, &back).min(tip(&back, &front));
        prop_assert!((clearance.margin(&phi) - expected).abs() < 1e-7);
    }

    /// Gradient and tangent against differences of the margin; far periods of the angles do no harm.
    #[test]
    fn the_gradient_is_the_margins(links in links(), share in 0.0..0.5, x in -9.0..9.0, y in -9.0..9.0) {
        let phi = Vector2::new(x, y);
        let Some(clearance) = Clearance::new(&links, share * links.middle) else { return Ok(()) };
        let bound = Bound::Clearance(clearance);
        let h = 1e-6;
        let piece = bound.piece(&phi);
        let gradient = bound.gradient(&phi);
        prop_assert!(gradient.iter().all(|slope| slope.is_finite()));
        for joint in 0..2 {
            let mut step = Vector2::zeros();
            step[joint] = h;
            let (plus, minus) = (phi + step, phi - step);
            let jumps = |shape: &Vector2<f64>| bound.piece(shape) != piece
                || (links.overlap(shape) > 0.0) != (links.overlap(&phi) > 0.0);
            if x.abs() < PI && y.abs() < PI && !jumps(&plus) && !jumps(&minus) && bound.margin(&phi).abs() < 0.1 {
                let numeric = (bound.margin(&plus) - bound.margin(&minus)) / (2.0 * h);
                prop_assert!((numeric - gradient[joint]).abs() < 1e-5, "{:?} {} {}", piece, numeric, gradient[joint]);
            }
        }
    }

    /// The projection lies on the bound, and walking along the tangent with the bound's curvature stays on it to third order.
    #[test]
    fn projection_tangent_and_curvature(links in links(), share in 0.01..0.5, x in 1.0..PI, y in 1.0..PI, mirror in any::<bool>()) {
        let phi = Vector2::new(x, y) * if mirror { -1.0 } else { 1.0 };
        let Some(clearance) = Clearance::new(&links, share * links.middle) else { return Ok(()) };
        let bound = Bound::Clearance(clearance);
        let on = bound.onto(&phi);
        if bound.margin(&phi).abs() > 0.1 * links.middle || on == phi || on.amax() >= PI {
            return Ok(());
        }
        prop_assert!(bound.margin(&on).abs() < 1e-13);
        let level = clearance.deciding_level(&on);
        let along = bound.tangent(&on);
        let curvature = -along.dot(&(level.hessian * along)) / level.gradient.norm();
        prop_assert!((along.norm() - 1.0).abs() < 1e-12);
        prop_assert!(along.perp(&bound.gradient(&on)) > 0.0, "the region is on the left");
        let left = Vector2::new(-along.y, along.x);
        let step = 1e-4;
        for step in [step, -step] {
            let there = on + along * step + left * (0.5 * curvature * step * step);
            if bound.piece(&there) == bound.piece(&on) && curvature.abs() < 10.0 {
                prop_assert!(bound.margin(&there).abs() < 1e-9, "{} {curvature}", bound.margin(&there));
            }
        }
    }
}

/// Robot and Purcell's swimmer touch tips on φ₁ = φ₂ = arccos(−l₀/2l₁).
#[test]
fn tip_touches_tip() {
    for (middle, side, expected) in [(0.071, 0.137, 1.833), (1.0, 1.0, 2.095)] {
        let links = Links {
            middle,
            front: side,
            back: side,
        };
        let clearance = Clearance::new(&links, 0.0).unwrap();
        let corner = clearance.on_diagonal().unwrap();
        assert!((corner - expected).abs() < 1e-3, "{corner}");
        assert!(clearance.margin(&Vector2::repeat(corner)).abs() < 1e-15);
        assert!(clearance.margin(&Vector2::repeat(corner + 0.01)) < 0.0);
        assert!(clearance.margin(&Vector2::repeat(corner - 0.01)) > 0.0);
    }
}

/// Links too short to reach each other leave no curved bound, and a fold only where the tip comes near the other joint, or a hair before
/// a link lies on the middle one.
#[test]
fn links_too_short_to_cross() {
    let links = Links {
        middle: 1.0,
        front: 0.4,
        back: 0.3,
    };
    let region = Region::new(&bounds(0.1), &links);
    assert_eq!(region.bounds().count(), 4);
    for edge in region.edges() {
        assert!((edge.offset - (PI - 1e-6)).abs() < 1e-15);
    }
    let near = Region::new(
        &bounds(0.2),
        &Links {
            front: 0.9,
            ..links
        },
    );
    assert!(near.edges().iter().any(|edge| edge.offset < PI - 1e-3));
    assert_eq!(near.bounds().count(), 5);
    assert!(matches!(curved(&near), Bound::Clearance(_)));
}
