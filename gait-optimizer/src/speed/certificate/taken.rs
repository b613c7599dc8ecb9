//! The limits that a gait keeps within, read off its curve.
//!
//! Who is the fastest within some limits is so too within those that it takes in full: the most of each rate and of the power that
//! it takes anywhere and, where it takes neither in full, the torque of its servos. All are per cycle: no file tells a period.

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Gait as _, Model};

use crate::speed::gauge::Facet;

/// A limit may be the one that binds where the gait takes this share of it.
const NEARLY: f64 = 1.0 - 1e-5;
/// Ratios of torque to rate that are looked at: powers of ten about the gait's own, and of each so many.
const DECADES: i32 = 3;
const LOOKS: i32 = 20;

/// Rates, the power, and the torque where it must be that.
pub(super) fn limits(
    model: &Model<f64>,
    gait: &AnyGait,
    places: impl Iterator<Item = f64>,
) -> Vec<Facet> {
    // Of each place rates and torques.
    let state = |u: f64| {
        let point = gait.at(u);
        (point.rate, model.power_matrix(&point.phi) * point.rate)
    };
    let states: Vec<(Vector2<f64>, Vector2<f64>)> = places.map(state).collect();
    let rates = states.iter().map(|(rate, _)| rate.abs());
    let rates = rates.fold(Vector2::zeros(), |most, rate| most.sup(&rate));
    let powers = states.iter().map(|(rate, torque)| rate.dot(torque));
    let power = powers.fold(0.0, f64::max);
    let mut all = Facet::of_rates(rates.into()).to_vec();
    all.push(Facet::Power { power });
    let bound = |(rate, torque): &&(Vector2<f64>, Vector2<f64>)| {
        rate.dot(torque) >= NEARLY * NEARLY * power
            || (0..2).any(|joint| rate[joint].abs() >= NEARLY * rates[joint])
    };
    let open: Vec<_> = states.iter().filter(|state| !bound(state)).collect();
    if open.is_empty() {
        return all;
    }
    // τ/stall + φ̇/no load = 1 at each of these for one of the joints.
    let taken = |(rate, torque): &(Vector2<f64>, Vector2<f64>), ratio: f64| {
        let of = |joint: usize| torque[joint].abs() + ratio * rate[joint].abs();
        of(0).max(of(1))
    };
    let most = |ratio: f64| {
        states
            .iter()
            .map(|one| taken(one, ratio))
            .fold(0.0, f64::max)
    };
    let spread = |ratio: f64| {
        let least = open.iter().map(|one| taken(one, ratio));
        1.0 - least.fold(f64::INFINITY, f64::min) / most(ratio)
    };
    let own = most(0.0) / rates.max();
    let ratio = |exponent: f64| own * 10.0_f64.powf(exponent);
    let look = |k: i32| f64::from(k) / f64::from(LOOKS);
    let looks = (-DECADES * LOOKS..=DECADES * LOOKS).map(look);
    let best = looks.min_by(|a, b| spread(ratio(*a)).total_cmp(&spread(ratio(*b))));
    let (mut from, mut to) = (best.unwrap_or(0.0) - look(1), best.unwrap_or(0.0) + look(1));
    for _ in 0..100 {
        let [one, two] = [1.0, 2.0].map(|third| from + (to - from) * third / 3.0);
        if spread(ratio(one)) < spread(ratio(two)) {
            to = two;
        } else {
            from = one;
        }
    }
    let ratio = ratio(0.5 * (from + to));
    let stall = most(ratio);
    all.extend(Facet::of_torque(stall, stall / ratio));
    all
}
