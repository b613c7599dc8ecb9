//! Branches with known events, and ends that are known from elsewhere.

use swimmer_model::Swimmer;

use super::*;
use crate::{DisplacementProblem, EfficiencyProblem, Heading, displacement, efficiency};

const FARTHEST: Start = Start::Displacement {
    heading: Heading::Forwards,
    rank: 0,
};

fn within(max_angle: f64) -> Bounds {
    Bounds::within(max_angle)
}

/// The only event for which a figure can be worked out.
fn only<'a, T>(found: &'a Continuation, of: impl Fn(&'a Event) -> Option<T>) -> T {
    let mut figures = found.events.iter().filter_map(of);
    match (figures.next(), figures.next()) {
        (Some(figure), None) => figure,
        _ => panic!("{:?}", found.events),
    }
}

fn fold(event: &Event) -> Option<(f64, &Fold)> {
    match &event.kind {
        EventKind::Fold(fold) => Some((event.value, fold)),
        _ => None,
    }
}

#[test]
fn folds_are_found_and_proven() {
    let large = || Start::Efficiency(Branch::Large);
    for (swimmer, parameter, range, place) in [
        // By `extremal::continuation`, which shares the corrector but not the steps.
        (
            Swimmer::robot(),
            Parameter::MaxAngle,
            [2.75, 2.7],
            2.730_041,
        ),
        (
            Swimmer::purcell(),
            Parameter::LinkRatio,
            [1.3, 1.4],
            1.350_916,
        ),
    ] {
        let problem = ContinuationProblem {
            steps: 5,
            ..ContinuationProblem::new(swimmer, parameter, range, large())
        };
        let found = continuation(&problem, &|_| ()).unwrap();
        let (value, fold) = only(&found, fold);
        assert!((value - place).abs() < 2e-6, "{value}");
        let other = fold.other.unwrap();
        assert_eq!(other.ascent_directions, Some(1));
        let power = fold.exponent.unwrap();
        assert!((power - 0.5).abs() < 0.1, "{power}");
        let reached = |event: &Event| event.kind == EventKind::Reached;
        assert!(!found.events.iter().any(reached));
        // All that is kept are optima up to the fold, at least among gaits with their symmetries; of the second swimmer curves without
        // them become better shortly before.
        let saddle = found.events.iter().find_map(|event| match event.kind {
            EventKind::Symmetry { alone: true } => Some(event.value),
            _ => None,
        });
        let mut points = found.points.iter();
        let before = |value: f64| saddle.is_none_or(|saddle| value < saddle);
        assert!(points.all(|p| p.gait.certificate.pass() == before(p.value)));
        match (parameter, saddle) {
            (Parameter::LinkRatio, Some(at)) => assert!((1.3495..1.3505).contains(&at), "{at}"),
            (_, saddle) => assert_eq!(saddle, None),
        }
        assert!((found.points.last().unwrap().value - value).abs() < 1e-6);
    }
}

#[test]
fn the_end_of_a_branch_is_the_gait_found_there_directly() {
    let small = |chi| {
        let swimmer = Swimmer {
            chi,
            ..Swimmer::purcell()
        };
        efficiency(&EfficiencyProblem::new(swimmer, Branch::Small)).unwrap()
    };
    let direct = small(1.5).efficiency;
    let mut closed = small(2.0);
    closed.symmetric = false;
    let problem = ContinuationProblem {
        starts: vec![
            Start::Efficiency(Branch::Small),
            Start::Gait(Box::new(closed)),
        ],
        ..ContinuationProblem::new(
            Swimmer::purcell(),
            Parameter::Chi,
            [2.0, 1.5],
            Start::Efficiency(Branch::Small),
        )
    };
    let found = continuation(&problem, &|_| ()).unwrap();
    for branch in [0, 1] {
        let last = found.points.iter().rfind(|p| p.branch == branch).unwrap();
        assert!((last.value - 1.5).abs() < 1e-15);
        assert_eq!(last.gait.symmetric, branch == 0);
        assert!((last.gait.efficiency / direct - 1.0).abs() < 1e-9);
    }
    // A quarter and a closed curve, but one gait from the beginning.
    let merged = only(&found, |event| match event.kind {
        EventKind::Merger { with } => Some((event.branch, with, event.value)),
        _ => None,
    });
    assert_eq!((merged.0, merged.1), (0, 1));
    assert!((merged.2 - 2.0).abs() < 1e-15);
}

#[test]
fn arcs_change_where_a_bound_reaches_the_start() {
    let problem = ContinuationProblem {
        steps: 10,
        ..ContinuationProblem::new(Swimmer::robot(), Parameter::MaxAngle, [2.0, 1.0], FARTHEST)
    };
    let found = continuation(&problem, &|_| ()).unwrap();
    let (event, before, after) = only(&found, |event| match &event.kind {
        EventKind::Structure { before, after } => Some((event, before, after)),
        _ => None,
    });
    assert_eq!(
        before[..],
        [ArcKind::Singular, ArcKind::Upper, ArcKind::Singular]
    );
    assert_eq!(after[..], [ArcKind::Upper, ArcKind::Singular]);
    // There the bound has come down to where the gait of a hardly wider one starts.
    let wider = displacement(&DisplacementProblem {
        bounds: within(event.value + 1e-4),
        ..DisplacementProblem::new(Swimmer::robot())
    })
    .unwrap();
    assert!(
        (event.value - wider.start_angle).abs() < 1e-4 && event.within < 1e-5,
        "{event:?} {}",
        wider.start_angle
    );
    let last = found.points.last().unwrap();
    let direct = displacement(&DisplacementProblem {
        bounds: within(1.0),
        ..DisplacementProblem::new(Swimmer::robot())
    });
    let direct = direct.unwrap().displacement_over_length;
    assert!((last.value - 1.0).abs() < 1e-15);
    assert!((last.gait.displacement_over_length / direct - 1.0).abs() < 1e-9);
}

#[test]
fn the_better_of_two_gaits_changes() {
    let swimmer = Swimmer::purcell();
    let (small, large) = (Branch::Small, Branch::Large);
    let problem = ContinuationProblem {
        starts: vec![Start::Efficiency(small), Start::Efficiency(large)],
        steps: 4,
        ..ContinuationProblem::new(
            swimmer,
            Parameter::MaxAngle,
            [2.75, 2.6],
            Start::Efficiency(small),
        )
    };
    let found = continuation(&problem, &|_| ()).unwrap();
    let (branch, by, value) = only(&found, |event| match event.kind {
        EventKind::Overtaken { by } => Some((event.branch, by, event.value)),
        _ => None,
    });
    assert_eq!((branch, by), (1, 0));
    let [small, large] = [small, large].map(|branch| {
        let problem = EfficiencyProblem {
            bounds: within(value),
            ..EfficiencyProblem::new(swimmer, branch)
        };
        efficiency(&problem).unwrap().efficiency
    });
    assert!((small / large - 1.0).abs() < 1e-5, "{small} {large}");
}

#[test]
fn nonsense_is_refused() {
    let problem = |parameter, range| {
        let start = Start::Efficiency(Branch::Small);
        let problem = ContinuationProblem::new(Swimmer::purcell(), parameter, range, start);
        continuation(&problem, &|_| ())
    };
    for (parameter, range) in [
        (Parameter::Chi, [2.0, 2.0]),
        (Parameter::Chi, [2.0, 0.0]),
        (Parameter::LinkRatio, [1.0, f64::NAN]),
        (Parameter::SphereRadius, [0.0, -0.1]),
        (Parameter::MaxAngle, [2.0, 7.0]),
    ] {
        let error = problem(parameter, range).unwrap_err();
        assert!(error.is_bad_input(), "{error}");
    }
}

/// With a smaller sphere the zero-level curve that the gait runs along meets another one: the gait ends, and the next one is
/// another gait.
#[test]
fn a_jump_is_not_hidden() {
    let problem = ContinuationProblem {
        bounds: within(2.8),
        steps: 4,
        ..ContinuationProblem::new(
            Swimmer::robot(),
            Parameter::SphereRadius,
            [0.0395, 0.0375],
            FARTHEST,
        )
    };
    let found = continuation(&problem, &|_| ()).unwrap();
    let end = only(&found, |event| match event.kind {
        EventKind::Lost { .. } | EventKind::Ended { .. } => Some(event.value),
        _ => None,
    });
    assert!((end - 0.038_784).abs() < 2e-6, "{end}");
    let jump = found.events.iter().find_map(|event| match event.kind {
        EventKind::Jump { apart, .. } => Some((event, apart)),
        _ => None,
    });
    let (event, apart) = jump.unwrap();
    assert!(apart > 1.0 && event.value <= end, "{event:?}");
    let last = found.points.last().unwrap();
    assert_eq!(last.value.to_bits(), 0.0375_f64.to_bits());
    assert_eq!(last.gait.arcs.len(), 1);
}
