//! Campaigns in a tank whose walls act on the swimmer: the laboratory computes the images of all forces by itself.

use crate::judged;
use crate::lab;

use calibrate::{FitOptions, NuisanceParameter, Verdict, fit_nuisance};
use judged::Judged;
use lab::{Body, Lab, walls};

/// Inner measures of the tank \[m\]: runs come within 0.2 m of its walls.
const SIZE: [f64; 2] = [1.3, 1.1];

/// Half widths between the recommended values and the truth.
fn off(judged: &Judged) -> f64 {
    let headline = &judged.assessment.headline;
    let of = |[low, high]: [f64; 2], value: f64, truth: f64| {
        (value - truth).abs() / ((high - low) / 2.0)
    };
    let [r, chi] = judged.truth;
    of(
        headline.intervals.sphere_radius,
        headline.estimate.sphere_radius,
        r,
    )
    .max(of(headline.intervals.chi, headline.estimate.chi, chi))
}

fn in_a_tank(seed: u64) -> Lab {
    let mut lab = Lab::sparse(seed).with_noise(3e-4).with_runs_all_over();
    lab.walls = Some(SIZE);
    lab
}

#[test]
fn walls_that_are_stated_are_fitted() {
    let mut lab = in_a_tank(3);
    lab.walls_stated = true;
    let judged = Judged::at(&lab, FitOptions::default().level).unwrap();
    println!("{:.2} half widths; {}", off(&judged), judged.line());
    let nuisances = &judged.systematics().nuisances;
    let wall = nuisances.iter().find(|one| one.name == "wall effect");
    let wall = wall.expect("the tank is stated");
    println!("{wall:?}");
    assert!(
        wall.pull.abs() < 2.5 && wall.found[1] < wall.known[1],
        "{wall:?}"
    );
    assert!(off(&judged) < 1.0, "{}", judged.line());
    let budget = &judged.assessment.budget;
    assert!(budget.iter().any(|line| line.name == "wall effect"));
    let explanations = &judged.assessment.explanations;
    let by_wall = explanations.iter().find(|one| one.name == "tank's walls");
    assert!(by_wall.expect("tried").gain > 3.0, "{explanations:?}");
    let fitted = fit_nuisance(&judged.found, &[NuisanceParameter::Walls]).unwrap();
    let [low, high] = fitted.parameter("wall effect").unwrap().interval;
    assert!(low < 1.0 && 1.0 < high && 0.0 < low, "{low} {high}");
}

#[test]
fn walls_that_nothing_states_are_named() {
    // With a caution from a misfit of .5 % only, seed 4 had `trust` 1.7 half widths from the truth.
    for seed in [3, 4] {
        let judged = Judged::at(&in_a_tank(seed), FitOptions::default().level).unwrap();
        println!("{:.2} half widths; {}", off(&judged), judged.line());
        assert!(judged.assessment.verdict != Verdict::Trust);
        assert!(judged.names("walls within 30 cm"), "{}", judged.line());
        // Without a tank there is nothing to fit.
        assert!(fit_nuisance(&judged.found, &[NuisanceParameter::Walls]).is_err());
    }
}

/// Ten campaigns next to walls that nothing states, of which none is trusted, and thirty each with declared errors and with small errors
/// that nothing states, of which few are called misfits.
#[test]
#[ignore = "seventy campaigns"]
fn misfits_are_next_to_walls() {
    let near = (1..=10).map(|seed| ("next to walls", in_a_tank(seed)));
    let declared = (1..=30).map(|seed| ("declared errors", judged::with_systematics(seed)));
    let small = (1..=30).map(|seed| ("small errors", judged::small_errors(seed)));
    let mut misfits = 0;
    for (kind, lab) in near.chain(declared).chain(small) {
        let judged = Judged::at(&lab, FitOptions::default().level).unwrap();
        let misfit = judged.assessment.goodness.misfit;
        println!(
            "{kind}: {:.2} half widths; {misfit:?}; {}",
            off(&judged),
            judged.line()
        );
        if kind == "next to walls" {
            assert!(
                judged.assessment.verdict != Verdict::Trust,
                "{}",
                judged.line()
            );
        } else {
            misfits += u32::from(judged.names("walls within 30 cm"));
        }
    }
    println!("{misfits} of 60 campaigns without walls are called misfits");
    assert!(misfits <= 3);
}

/// The laboratory's images: fluid rests at the wall, and a small sphere is slowed as Happel and Brenner have it.
#[test]
fn images_of_the_laboratory() {
    let (x, y) = ([0.2, 0.1, 0.0], [-0.1, 0.3, 0.4]);
    let apart: Vec<f64> = x.iter().zip(y).map(|(a, b)| a - b).collect();
    let distance = apart.iter().map(|value| value * value).sum::<f64>().sqrt();
    for (i, row) in walls::blake(x, y).iter().enumerate() {
        for (j, image) in row.iter().enumerate() {
            let free =
                f64::from(u8::from(i == j)) / distance + apart[i] * apart[j] / distance.powi(3);
            assert!((image + free).abs() < 1e-12);
        }
    }
    // One wall near, the others far away; drag over that in open fluid, in units of 2πμ.
    let ball = Body {
        sphere: 1e-3,
        c_t: 1e-12,
        ..Body::ROBOT
    };
    let change = walls::change(&ball, [0.0; 2], [1e6 - 0.2, 0.0, 0.0], [2e6; 2]);
    let ratio = ball.sphere / 0.2;
    assert!((change[0][0] / (3.0 * ball.sphere) - 9.0 / 8.0 * ratio).abs() < 1e-4 * ratio);
    assert!((change[1][1] / (3.0 * ball.sphere) - 9.0 / 16.0 * ratio).abs() < 1e-4 * ratio);
}
