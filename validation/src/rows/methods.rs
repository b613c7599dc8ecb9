//! Rows of sections I, V and of Appendix C: each Lighthill gait by three methods, and by Fourier series of low order.

use super::computed::Computed;
use crate::study::{Lighthill, OtherMethods, Study};

/// ξ of each gait by shooting, and by the other methods: Purcell's small and large one, the robot's.
fn gaits(study: &Study) -> impl Iterator<Item = (f64, &OtherMethods)> {
    let of = |gaits: &'_ Lighthill| [gaits.small.efficiency, gaits.large.efficiency];
    let swimmers = [&study.purcell_lighthill, &study.robot_lighthill];
    swimmers
        .into_iter()
        .flat_map(move |gaits| of(gaits).into_iter().zip(&gaits.others))
}

/// Largest relative deviations of ξ by collocation and by Fourier series from ξ by shooting.
pub(super) fn three_methods(study: &Study) -> Vec<Computed> {
    let farthest = |value: fn(&OtherMethods) -> f64| {
        let deviations = gaits(study).map(|(shot, others)| (value(others) / shot - 1.0).abs());
        // NaN must not pass.
        deviations
            .reduce(|a, b| if a >= b || a.is_nan() { a } else { b })
            .unwrap_or(f64::NAN)
    };
    vec![
        ("methods.collocation", farthest(|others| others.collocation)),
        ("methods.fourier", farthest(|others| others.fourier)),
        ("methods.polished", farthest(|others| others.polished)),
    ]
}

/// ξ of series of orders 1, 2 and 3 over ξ of the optimal gait.
pub(super) fn orders_of_fourier_series(study: &Study) -> Vec<Computed> {
    const IDS: [[&str; 3]; 4] = [
        [
            "fourier.purcell.small.1",
            "fourier.purcell.small.2",
            "fourier.purcell.small.3",
        ],
        [
            "fourier.purcell.large.1",
            "fourier.purcell.large.2",
            "fourier.purcell.large.3",
        ],
        [
            "fourier.robot.small.1",
            "fourier.robot.small.2",
            "fourier.robot.small.3",
        ],
        [
            "fourier.robot.large.1",
            "fourier.robot.large.2",
            "fourier.robot.large.3",
        ],
    ];
    let of = |(ids, (best, others)): ([&'static str; 3], (f64, &OtherMethods))| {
        let shares = others
            .orders
            .iter()
            .map(move |efficiency| efficiency / best);
        ids.into_iter().zip(shares).collect::<Vec<_>>()
    };
    IDS.into_iter().zip(gaits(study)).flat_map(of).collect()
}
