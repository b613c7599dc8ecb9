use super::check::{Checker, Facts};
use super::*;
use crate::Limits;
use link_protocol::{CrossingPlace, Refusal};
use proptest::prelude::*;
use std::f64::consts::TAU;
use swimmer_model::{Links, Swimmer};

fn circle(knots: usize, amplitude: f64) -> GaitTable {
    GaitTable::from_fn(knots, |u| {
        let angle = TAU * (u + 0.125);
        [amplitude * angle.cos(), amplitude * angle.sin()]
    })
    .unwrap()
}

fn robot() -> Links<f32> {
    Swimmer::robot().links
}

fn facts(table: &GaitTable, links: &Links<f32>) -> Facts {
    let mut checker = Checker::new();
    (0..10_000)
        .find_map(|_| checker.advance(table, links, 7))
        .unwrap()
}

fn place(u: f64, table: &GaitTable) -> Phase {
    let scaled = u * table.knots() as f64;
    Phase {
        interval: scaled as usize,
        fraction: scaled.fract() as f32,
    }
}

#[test]
fn a_circle_comes_back_to_the_rounding_of_its_knots() {
    let table = circle(512, 1.9);
    for step in 0..5000 {
        let u = f64::from(step) / 5000.0;
        let angle = TAU * (u + 0.125);
        let shape = table.at(place(u, &table));
        for (got, want) in shape.angles.into_iter().zip([angle.cos(), angle.sin()]) {
            // Half a unit of the knots, plus a small amount for the weights of the cubic.
            assert!((f64::from(got) - 1.9 * want).abs() < 0.7e-4, "{u}");
        }
    }
}

#[test]
fn interpolation_is_of_fourth_order() {
    let error = |knots: usize| {
        let table = circle(knots, 3.0);
        (0..1000).fold(0.0_f64, |worst, step| {
            let u = (f64::from(step) + 0.5) / 1000.0;
            let shape = table.at(place(u, &table));
            worst.max((f64::from(shape.angles[0]) - 3.0 * (TAU * (u + 0.125)).cos()).abs())
        })
    };
    // Twice the knots give a sixteenth of the error, while it is far above the rounding of the knots.
    let order = (error(12) / error(24)).log2();
    assert!((3.7..4.7).contains(&order), "{order}");
}

proptest! {
    #[test]
    fn value_and_slope_are_continuous_and_periodic(knots in prop::collection::vec(any::<[i16; 2]>(), 2..=40)) {
        let bytes: Vec<u8> = knots.iter().flatten().flat_map(|angle| angle.to_le_bytes()).collect();
        let table = GaitTable::from_bytes(&bytes).unwrap();
        prop_assert_eq!(table.bytes(), &bytes[..]);
        for interval in 0..table.knots() {
            let end = table.at(Phase { interval, fraction: 1.0 });
            let start = table.at(Phase { interval: interval + 1, fraction: 0.0 });
            for joint in 0..2 {
                prop_assert!((end.angles[joint] - start.angles[joint]).abs() < 1e-4);
                prop_assert!((end.slopes[joint] - start.slopes[joint]).abs() < 1e-4);
                prop_assert!((start.angles[joint] - table.knot_angles(interval + 1)[joint]).abs() < 1e-6);
            }
        }
    }

    /// The checker's largest angle and slope bound the interpolant between the knots.
    #[test]
    fn the_facts_bound_the_interpolant(knots in prop::collection::vec([-20_000_i16..20_000, -20_000_i16..20_000], 2..=12)) {
        let bytes: Vec<u8> = knots.iter().flatten().flat_map(|angle| angle.to_le_bytes()).collect();
        let table = GaitTable::from_bytes(&bytes).unwrap();
        let facts = facts(&table, &robot());
        let (mut angle, mut slope) = (0.0_f32, 0.0_f32);
        for interval in 0..table.knots() {
            for step in 0..=100_u8 {
                let shape = table.at(Phase { interval, fraction: f32::from(step) / 100.0 });
                angle = shape.angles.into_iter().fold(angle, |most, angle| most.max(angle.abs()));
                slope = shape.slopes.into_iter().fold(slope, |most, slope| most.max(slope.abs()));
            }
        }
        let limits = Limits { max_rate: 1.0, ..Limits::ROBOT };
        let found = facts.min_period_us(&limits) as f32 * 1e-6 * 1.005 / table.knots() as f32;
        prop_assert!(found >= slope - 1e-5 && found <= slope * 1.01 + 1e-4, "{} {}", found, slope);
        let refused = |max_angle: f32| matches!(facts.allow(&Limits { max_angle, ..limits }), Err(Refusal::AngleLimit { .. }));
        if !matches!(facts.allow(&limits), Err(Refusal::LinksCross { .. } | Refusal::NotClosed { .. })) {
            prop_assert!(refused(angle * 0.998 - 0.0055), "{}", angle);
            prop_assert!(!refused(angle * 1.01));
        }
    }
}

#[test]
fn phases_are_exact() {
    let table = circle(512, 1.0);
    let period = 30_000_001;
    assert_eq!(
        table.phase(0, period),
        Phase {
            interval: 0,
            fraction: 0.0
        }
    );
    let last = table.phase(period - 1, period);
    assert_eq!(last.interval, 511);
    assert!(last.fraction > 0.999_98 && last.fraction <= 1.0);
    assert_eq!(table.phase(15_000_001, period).interval, 256);
    assert_eq!(GaitTable::empty().phase(5, 0).interval, 0);
}

#[test]
fn what_is_no_table_is_refused() {
    assert_eq!(GaitTable::from_bytes(&[0; 7]), Err(TableError::Bytes(7)));
    assert_eq!(GaitTable::from_bytes(&[0; 4]), Err(TableError::Knots(1)));
    assert_eq!(
        GaitTable::from_bytes(&[0; 2052]),
        Err(TableError::Knots(513))
    );
    assert_eq!(
        GaitTable::from_fn(0, |_| [0.0; 2]),
        Err(TableError::Knots(0))
    );
    let far = GaitTable::from_fn(4, |u| [0.0, if u > 0.4 { 3.3 } else { 0.0 }]);
    assert_eq!(
        far,
        Err(TableError::Angle {
            joint: Joint::Back,
            knot: 2,
            angle: 3.3
        })
    );
    assert!(GaitTable::from_fn(4, |_| [f64::NAN, 0.0]).is_err());
    assert!(far.unwrap_err().to_string().contains("knot 2"));
}

#[test]
fn the_papers_circles_pass_and_name_their_shortest_period() {
    for degrees in [30.0_f64, 70.0, 110.0] {
        let amplitude = degrees.to_radians();
        let facts = facts(&circle(512, amplitude), &robot());
        assert_eq!(facts.allow(&Limits::ROBOT), Ok(()), "{degrees}");
        let period = f64::from(facts.min_period_us(&Limits::ROBOT)) * 1e-6;
        let ideal = TAU * amplitude / 3.5;
        assert!((period / ideal - 1.0).abs() < 0.01, "{period} {ideal}");
        assert_eq!(facts.allow_period(&Limits::ROBOT, 30_000_000), Ok(()));
        let fast = (ideal * 0.98e6) as u32;
        assert!(matches!(
            facts.allow_period(&Limits::ROBOT, fast),
            Err(Refusal::RateLimit { .. })
        ));
    }
}

#[test]
fn crossing_links_are_found_and_named() {
    // Purcell's links cross on the diagonal beyond 2.095 rad, the robot's beyond 1.833 rad.
    let purcell: Links<f32> = Swimmer::purcell().links;
    let on_diagonal = |most: f64| {
        GaitTable::from_fn(64, |u| {
            let angle = most * (TAU * u).cos();
            [angle, angle]
        })
        .unwrap()
    };
    assert_eq!(
        facts(&on_diagonal(2.0), &purcell).allow(&Limits::ROBOT),
        Ok(())
    );
    assert_eq!(
        facts(&on_diagonal(1.79), &robot()).allow(&Limits::ROBOT),
        Ok(())
    );
    for (most, links) in [(2.1, purcell), (1.84, robot())] {
        let refused = facts(&on_diagonal(most), &links).allow(&Limits::ROBOT);
        let Err(Refusal::LinksCross {
            place: CrossingPlace::Gait(_),
            phi1,
            phi2,
        }) = refused
        else {
            panic!("{refused:?}")
        };
        assert!(
            (phi1 - phi2).abs() <= 1 && phi1.abs() > 17_500,
            "{phi1} {phi2}"
        );
    }
}

#[test]
fn an_arc_is_no_gait() {
    let arc = GaitTable::from_fn(64, |u| [u, 0.5 * u]).unwrap();
    let refused = facts(&arc, &robot()).allow(&Limits::ROBOT);
    assert!(
        matches!(
            refused,
            Err(Refusal::NotClosed {
                joint: Joint::Front,
                step: -9844,
                ..
            })
        ),
        "{refused:?}"
    );
    let square = |u: f64| match (4.0 * u) as u8 {
        0 => [1.0 - 8.0 * u, 1.0],
        1 => [-1.0, 1.0 - 8.0 * (u - 0.25)],
        2 => [-1.0 + 8.0 * (u - 0.5), -1.0],
        _ => [1.0, -1.0 + 8.0 * (u - 0.75)],
    };
    let table = GaitTable::from_fn(512, square).unwrap();
    assert_eq!(
        facts(&table, &robot()).allow(&Limits {
            max_angle: 1.0,
            ..Limits::ROBOT
        }),
        Ok(())
    );
}

#[test]
fn too_large_a_gait_names_joint_and_angle() {
    let table =
        GaitTable::from_fn(512, |u| [0.1 * (TAU * u).cos(), 2.9 * (TAU * u).sin()]).unwrap();
    let refused = facts(&table, &Swimmer::purcell().links).allow(&Limits::ROBOT);
    let Err(Refusal::AngleLimit {
        joint: Joint::Back,
        angle,
        limit: 27_999..=28_000,
        ..
    }) = refused
    else {
        panic!("{refused:?}")
    };
    assert!((angle.abs() - 29_000).abs() < 3, "{angle}");
}

/// The corners of the paper's gait (b), robot, |φ| ≤ 2.8, joined by straight lines. At the start of its upper bound the side
/// links come within 4.4 mm of each other. This is no crossing and must be allowed; three degrees further is too close.
#[test]
fn the_papers_bounded_gait_passes_between_its_links() {
    let gait = |entry: f64| {
        let quarter = [
            [1.4018, 1.4018],
            [entry, 2.8],
            [-1.4377, 2.8],
            [-0.4323, 0.4323],
        ];
        let back = [quarter[2], quarter[1], quarter[0]].map(|[phi1, phi2]| [-phi2, -phi1]);
        let half: Vec<[f64; 2]> = quarter.into_iter().chain(back).collect();
        let corners: Vec<[f64; 2]> = half
            .iter()
            .copied()
            .chain(half[1..].iter().map(|[phi1, phi2]| [-phi1, -phi2]))
            .collect();
        let edges = (corners.len() - 1) as f64;
        GaitTable::from_fn(512, |u| {
            let edge = (u * edges) as usize;
            let share = u * edges - edge as f64;
            let (from, to) = (corners[edge], corners[edge + 1]);
            [0, 1].map(|joint| from[joint] + share * (to[joint] - from[joint]))
        })
        .unwrap()
    };
    assert_eq!(facts(&gait(0.6095), &robot()).allow(&Limits::ROBOT), Ok(()));
    let refused = facts(&gait(0.66), &robot()).allow(&Limits::ROBOT);
    assert!(
        matches!(refused, Err(Refusal::LinksCross { .. })),
        "{refused:?}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]
    /// No accepted table lets links touch on the densely sampled interpolant, with few knots or many.
    #[test]
    fn no_table_passes_whose_links_touch_anywhere(
        knots in prop::collection::vec([-28_000_i16..28_000, -28_000_i16..28_000], 2..=12), purcell in any::<bool>()
    ) {
        let bytes: Vec<u8> = knots.iter().flatten().flat_map(|angle| angle.to_le_bytes()).collect();
        let table = GaitTable::from_bytes(&bytes).unwrap();
        let links = if purcell { Swimmer::purcell().links } else { robot() };
        let refused = matches!(facts(&table, &links).allow(&Limits { max_angle: 100.0, ..Limits::ROBOT }), Err(Refusal::LinksCross { .. } | Refusal::NotClosed { .. }));
        if !refused {
            for step in 0..4000 {
                let angles = table.at(place(f64::from(step) / 4000.0, &table)).angles;
                let gap = crate::clearance::clearance(&links, angles);
                prop_assert!(gap > 0.0, "links touch at {angles:?}");
            }
        }
    }
}
