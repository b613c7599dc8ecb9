//! Adaptive campaigns against the fixed ladder of circles: tank time to χ ± 1 % and r_s ± 1 mm, and coverage of the final intervals, on
//! hidden robots under noisy cameras.

#![allow(clippy::doc_markdown)] // r_s, as in the paper

mod hidden_robot;

use std::sync::OnceLock;

use experiment::adaptive::{
    CampaignGoal, Candidate, Decision, DragEstimate, MeasuredTrial, Response, StartParameters,
    USUAL_ACCURACY_M, advise, estimate,
};
use forecast::{Played, Servos, forecast};
use hidden_robot::{CYCLES, HiddenRobot, PERIOD_S, SETTLE_S};
use swimmer_files::{AnyGait, GaitSpec, ServoFile, SwimmerFile};
use swimmer_model::Model;

const GOAL: CampaignGoal = CampaignGoal {
    chi_share: 0.01,
    sphere_radius_m: 1e-3,
    level: 0.95,
    budget_s: 1e6,
    accuracy_m: USUAL_ACCURACY_M,
};
/// Trials of the ladder after which a robot is given up.
const MOST: usize = 400;

fn file() -> SwimmerFile {
    SwimmerFile::preset("robot").unwrap()
}

fn start() -> StartParameters {
    let swimmer = file().swimmer;
    StartParameters {
        chi: swimmer.chi,
        sphere_radius_m: swimmer.sphere_radius,
    }
}

/// Gaits of the campaign: circles and squares of 30° to 110° that the robot plays; the circles come first.
fn gaits() -> &'static [(AnyGait, Candidate)] {
    static GAITS: OnceLock<Vec<(AnyGait, Candidate)>> = OnceLock::new();
    GAITS.get_or_init(|| {
        let file = file();
        let model = Model::new(&file.swimmer).unwrap();
        let played = Played {
            servos: Servos::on_the_robot(ServoFile::default()),
            period: PERIOD_S,
            knots: 512,
        };
        let sizes = (30..=110).step_by(10);
        let circles = sizes.clone().map(|degrees| format!("circle:{degrees}deg"));
        let squares = sizes.map(|degrees| format!("square:{degrees}deg"));
        let all = circles.chain(squares).filter_map(|name| {
            let gait = name.parse::<GaitSpec>().unwrap().load().unwrap();
            let predicted = forecast(&model, &gait, &played).unwrap();
            if predicted.refusal().is_some() || predicted.verdict.min_period > PERIOD_S {
                println!("{name} is not played");
                return None;
            }
            let response = Response::of(&file, &gait, PERIOD_S).unwrap();
            let candidate = Candidate {
                name,
                seconds: SETTLE_S + f64::from(CYCLES) * PERIOD_S,
                response,
            };
            Some((gait, candidate))
        });
        all.collect()
    })
}

fn candidates() -> Vec<Candidate> {
    gaits()
        .iter()
        .map(|(_, candidate)| candidate.clone())
        .collect()
}

/// Tank time and result of a campaign.
struct Campaign {
    trials: Vec<MeasuredTrial>,
    seconds: f64,
    estimate: DragEstimate,
}

/// The ladder of circles, 30° to 110°, over and over until the intervals are as narrow as requested.
fn ladder(robot: &mut HiddenRobot) -> Campaign {
    let candidates = candidates();
    let circles = candidates
        .iter()
        .filter(|candidate| candidate.name.starts_with("circle"));
    let rungs = circles.count();
    let mut trials = Vec::new();
    for number in 0..MOST {
        let index = number % rungs;
        trials.push(robot.trial(index, &gaits()[index].0));
        let fitted = estimate(&candidates, &trials, start(), &GOAL);
        if let Some(estimate) = fitted.filter(|fit| trials.len() >= 6 && is_reached(fit)) {
            let seconds = trials
                .iter()
                .map(|trial| candidates[trial.candidate].seconds)
                .sum();
            return Campaign {
                trials,
                seconds,
                estimate,
            };
        }
    }
    panic!("the ladder does not reach the goal in {MOST} trials");
}

fn is_reached(fit: &DragEstimate) -> bool {
    fit.chi_half_width <= GOAL.chi_share * fit.chi
        && fit.sphere_radius_half_width_m <= GOAL.sphere_radius_m
}

/// The campaign that [`advise`] leads. The trials played lie in the range that is forecast before the first one.
fn adaptive(robot: &mut HiddenRobot) -> Campaign {
    let candidates = candidates();
    let mut trials: Vec<MeasuredTrial> = Vec::new();
    let (mut forecast, mut measured) = (None, None);
    loop {
        let advice = advise(&candidates, &trials, start(), &GOAL).unwrap();
        match advice.decision {
            Decision::Play(next) => {
                let range = next.fewest_trials_left..=next.trials_left;
                assert!(next.is_goal_within_budget);
                if next.is_noise_measured {
                    measured.get_or_insert(trials.len() + next.trials_left);
                }
                forecast.get_or_insert(range);
                let index = next.candidate;
                trials.push(robot.trial(index, &gaits()[index].0));
            }
            Decision::Reached => {
                let estimate = advice.estimate.unwrap();
                assert!(is_reached(&estimate));
                let (played, range) = (trials.len(), forecast.unwrap());
                println!(
                    "forecast {range:?}, by the noise of three trials {measured:?}, played {played}"
                );
                assert!(range.contains(&played), "{played} of {range:?}");
                return Campaign {
                    trials,
                    seconds: advice.tank_time_s,
                    estimate,
                };
            }
            Decision::OutOfTime => panic!("out of time"),
        }
    }
}

/// Median.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) {
        f64::midpoint(values[middle - 1], values[middle])
    } else {
        values[middle]
    }
}

/// Runs both campaigns for each robot. Returns the median ratio of tank times, the median trials of the ladder, and the robots whose
/// χ and r_s lie in the adaptive campaign's intervals.
fn compared(robots: std::ops::Range<u64>) -> (f64, f64, [u32; 2]) {
    let (mut ratios, mut rungs, mut covered, mut ladder_covered) =
        (Vec::new(), Vec::new(), [0; 2], [0; 2]);
    for seed in robots {
        let mut robot = HiddenRobot::new(seed);
        let fixed = ladder(&mut robot);
        let led = adaptive(&mut robot);
        let contains = |fit: &DragEstimate| {
            let [chi, radius] = robot.truth();
            [
                (fit.chi - chi).abs() <= fit.chi_half_width,
                (fit.sphere_radius_m - radius).abs() <= fit.sphere_radius_half_width_m,
            ]
        };
        for which in 0..2 {
            covered[which] += u32::from(contains(&led.estimate)[which]);
            ladder_covered[which] += u32::from(contains(&fixed.estimate)[which]);
        }
        let names: Vec<&str> = led
            .trials
            .iter()
            .map(|trial| gaits()[trial.candidate].1.name.as_str())
            .collect();
        println!(
            "robot {seed}: ladder {} trials, adaptive {} trials, {:.0} of {:.0} s; χ {:.3} ± {:.3} ({:.3}), r_s {:.2} ± {:.2} mm ({:.2}); noise {:.3?}; {names:?}",
            fixed.trials.len(),
            led.trials.len(),
            led.seconds,
            fixed.seconds,
            led.estimate.chi,
            led.estimate.chi_half_width,
            robot.truth()[0],
            led.estimate.sphere_radius_m * 1e3,
            led.estimate.sphere_radius_half_width_m * 1e3,
            robot.truth()[1] * 1e3,
            led.estimate.noise.map(|noise| noise * 1e3),
        );
        ratios.push(led.seconds / fixed.seconds);
        rungs.push(fixed.trials.len() as f64);
    }
    let count = ratios.len();
    let (ratio, rungs) = (median(ratios), median(rungs));
    println!(
        "{count} hidden robots: adaptive takes {:.0} % of the ladder's tank time (median; the ladder takes {rungs} trials); intervals \
         contain χ in {} and r_s in {}; the ladder's in {} and {}",
        100.0 * ratio,
        covered[0],
        covered[1],
        ladder_covered[0],
        ladder_covered[1]
    );
    (ratio, rungs, covered)
}

#[test]
fn a_campaign_saves_tank_time() {
    let (ratio, rungs, covered) = compared(0..4);
    assert!(ratio <= 0.6, "{ratio}");
    assert!(rungs >= 25.0, "{rungs}");
    assert!(covered.iter().all(|count| *count >= 3), "{covered:?}");
}

#[test]
#[ignore = "soak: minutes"]
fn forty_campaigns_save_tank_time() {
    let (ratio, rungs, covered) = compared(0..40);
    assert!(ratio <= 0.6, "{ratio}");
    assert!(rungs >= 25.0, "{rungs}");
    assert!(covered.iter().all(|count| *count >= 36), "{covered:?}");
}

/// The forecast is no longer than the tank time, and the fewest trials are six.
#[test]
fn a_forecast_keeps_to_the_budget() {
    let candidates = candidates();
    let next = |trials: &[MeasuredTrial], goal: &CampaignGoal| {
        let advice = advise(&candidates, trials, start(), goal).unwrap();
        let Decision::Play(next) = advice.decision else {
            panic!("{advice:?}");
        };
        next
    };
    let far = next(&[], &GOAL);
    assert!(far.is_goal_within_budget && !far.is_noise_measured);
    assert_eq!(far.fewest_trials_left, 6);
    assert!(far.trials_left > 6, "{far:?}");

    let tight = CampaignGoal {
        budget_s: 7.5 * candidates[0].seconds,
        ..GOAL
    };
    let near = next(&[], &tight);
    assert!(!near.is_goal_within_budget);
    assert_eq!((near.fewest_trials_left, near.trials_left), (6, 7));

    // A trial whose track cannot be used takes time, and brings the goal no nearer.
    let unusable = MeasuredTrial {
        candidate: 0,
        values: [f64::NAN; 3],
        standard_errors: [f64::NAN; 3],
    };
    let after = next(&[unusable], &tight);
    assert_eq!((after.fewest_trials_left, after.trials_left), (6, 6));
}
