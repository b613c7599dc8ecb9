//! Where no gait carries farthest: the members are gaits, they grow, and an independent direct method climbs towards the same limit
//! and not beyond it.

mod plane;

use gait_optimizer::{
    Bounds, DisplacementProblem, Heading, Member, Suprema, Supremum, displacement,
};
use nalgebra::Vector2;
use plane::Pose;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Swimmer, Tolerance, swim};

type Shape = Vector2<f64>;

fn backwards(max_angle: f64, min_angle: Option<f64>, no_overlap: bool) -> DisplacementProblem {
    DisplacementProblem {
        bounds: Bounds {
            max_angle: Some(max_angle),
            min_angle,
            no_overlap,
            ..Bounds::default()
        },
        heading: Some(Heading::Backwards),
        ..DisplacementProblem::new(Swimmer::purcell())
    }
}

/// With |X| over L of the local optimum that is outdone.
fn limit(problem: &DisplacementProblem) -> (f64, Supremum) {
    let found = displacement(problem).ok();
    let local = found
        .as_ref()
        .map_or(0.0, |gait| gait.displacement_over_length.abs());
    (local, Suprema::new(2).of(problem, found.as_ref()).unwrap())
}

/// Three problems whose best gaits need slits: beside a bound, between two bounds, along one that keeps links apart.
fn problems() -> [DisplacementProblem; 3] {
    [
        backwards(2.0, None, false),
        backwards(2.0, Some(0.8), false),
        backwards(2.6, Some(0.8), true),
    ]
}

fn cross([a, b]: [Shape; 2], [c, d]: [Shape; 2]) -> bool {
    let side = |p: Shape, q: Shape, r: Shape| (q - p).perp(&(r - p));
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

fn is_simple(corners: &[Shape]) -> bool {
    let sides: Vec<[Shape; 2]> = corners.array_windows().copied().collect();
    (0..sides.len()).all(|i| (i + 2..sides.len()).all(|j| !cross(sides[i], sides[j])))
}

/// By brute force, along every side.
fn is_within(problem: &DisplacementProblem, corners: &[Shape]) -> bool {
    const SLACK: f64 = 1e-8;
    let Bounds {
        max_angle,
        min_angle,
        no_overlap,
        ..
    } = problem.bounds;
    let links = problem.swimmer.links;
    corners.array_windows().all(|[from, to]| {
        (0..=4).all(|k| {
            let phi = from + (to - from) * (f64::from(k) / 4.0);
            phi.amax() <= max_angle.unwrap() + SLACK
                && phi.y >= min_angle.unwrap_or(0.0) - SLACK
                && phi.y >= phi.x.abs() - SLACK
                && (!no_overlap || links.overlap(&phi) <= 1e-6)
        })
    })
}

#[test]
fn members_are_gaits_that_grow() {
    for problem in problems() {
        let (local, supremum) = limit(&problem);
        let model = Model::new(&problem.swimmer).unwrap();
        let mut before = local;
        for member in &supremum.members {
            let gait = AnyGait::from_file(&member.gait_file("purcell")).unwrap();
            let stroke = swim(&model, &gait, &Tolerance::new(1e-11));
            let carried = stroke.displacement.x / problem.swimmer.total_length();
            assert!((carried - member.displacement_over_length).abs() < 1e-9);
            assert!(stroke.rotation.abs() < 1e-9);
            assert!(-carried > before, "{carried} after {before}");
            assert!(is_simple(&member.quarter));
            assert!(is_within(&problem, &member.quarter));
            before = -carried;
        }
        assert!(-supremum.over_length >= before);
        assert!(supremum.uncertainty < 2e-3 * before, "{supremum:?}");
    }
}

/// Moves one corner at a time across the polygon, where that carries farther and the polygon stays a gait's quarter: nothing is
/// known of heights, gaps or slits.
struct PatternSearch<'a> {
    problem: &'a DisplacementProblem,
    model: Model<f64>,
    corners: Vec<Shape>,
}

impl PatternSearch<'_> {
    fn sides(&self) -> Vec<Pose> {
        let sides = self.corners.array_windows();
        sides.map(|side| Pose::along(&self.model, *side)).collect()
    }

    fn carried(&self) -> f64 {
        let whole = self.sides().into_iter().fold(Pose::default(), |a, b| a * b);
        -4.0 * whole.x
    }

    fn sweep(&mut self, step: f64) {
        let mut sides = self.sides();
        let last = self.corners.len() - 1;
        let mut after = vec![Pose::default(); last + 1];
        for k in (0..last).rev() {
            after[k] = sides[k] * after[k + 1];
        }
        let mut before = Pose::default();
        for k in 1..last {
            let chord = self.corners[k + 1] - self.corners[k - 1];
            let across = Shape::new(chord.y, -chord.x) / chord.norm();
            for t in [step, -step] {
                let [a, b, c] = [
                    self.corners[k - 1],
                    self.corners[k] + across * t,
                    self.corners[k + 1],
                ];
                let fresh = [[a, b], [b, c]].map(|side| Pose::along(&self.model, side));
                let here = before * sides[k - 1] * sides[k] * after[k + 1];
                let there = before * fresh[0] * fresh[1] * after[k + 1];
                let free = || {
                    let others = (0..last).filter(|i| i + 2 < k || *i > k + 1);
                    let mut others = others.map(|i| [self.corners[i], self.corners[i + 1]]);
                    others.all(|other| !cross(other, [a, b]) && !cross(other, [b, c]))
                };
                if there.x < here.x - 1e-12 && is_within(self.problem, &[a, b, c]) && free() {
                    self.corners[k] = b;
                    [sides[k - 1], sides[k]] = fresh;
                    break;
                }
            }
            before = before * sides[k - 1];
        }
    }
}

#[test]
fn an_independent_direct_method_grows_towards_the_same_limit() {
    for problem in problems() {
        let (local, supremum) = limit(&problem);
        let Member { quarter, .. } = &supremum.members[0];
        // Spoilt: every corner half way between its neighbours.
        let mut corners = quarter.clone();
        for k in 1..corners.len() - 1 {
            let smooth = (quarter[k - 1] + quarter[k + 1]) * 0.5;
            if is_within(&problem, &[quarter[k - 1], smooth, quarter[k + 1]]) {
                corners[k] = smooth;
            }
        }
        assert!(is_simple(&corners));
        let mut search = PatternSearch {
            problem: &problem,
            model: Model::new(&problem.swimmer.of_unit_length()).unwrap(),
            corners,
        };
        let supremum_above = -supremum.over_length + supremum.uncertainty + 1e-6;
        let mut before = search.carried();
        for step in [4e-3, 2e-3, 1e-3, 5e-4] {
            for _ in 0..40 {
                search.sweep(step);
            }
            let carried = search.carried();
            println!(
                "{}: step {step}: {carried:.7} of {:.7}",
                problem.bounds, -supremum.over_length
            );
            assert!(carried > before, "{carried} after {before}");
            before = carried;
        }
        assert!(is_simple(&search.corners));
        assert!(before > local * 1.01 && before < supremum_above, "{before}");
        assert!(
            before > -supremum.over_length * (1.0 - 2e-3),
            "{before} {supremum:?}"
        );
    }
}
