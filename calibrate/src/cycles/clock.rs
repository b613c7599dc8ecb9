//! When did the robot swim, how long was its cycle, and where in the cycle was it? From the poses alone: the cameras' clock
//! and the robot's are not the same.

// Indices come from bounded, positive numbers.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use swimmer_model::Pose;

use super::curve::{HARMONICS, Harmonics};
use crate::golden::golden;
use crate::poses::{PoseSample, PoseTrack};

/// Averages over a hundredth of a cycle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bin {
    pub(super) time_s: f64,
    x: f64,
    y: f64,
    pub(super) theta: f64,
}

/// Bins of a cycle.
pub(super) const BINS: f64 = 100.0;
/// Twenty thousand cycles: what comes later is no recording, but a slip in the times.
const MOST_BINS: f64 = 2e6;
/// The largest search for the period, either way.
pub(super) const PERIOD_RANGE: f64 = 0.02;
/// Harmonics of θ by which the period is found.
pub(super) const PERIOD_HARMONICS: usize = 4;

/// Averages of what was seen; `None` where nothing was.
pub(super) fn bins(track: &PoseTrack, period_s: f64) -> Vec<Option<Bin>> {
    let Some(first) = track.seen().next() else {
        return Vec::new();
    };
    let width = period_s / BINS;
    let mut sums: Vec<(f64, Bin)> = Vec::new();
    // Where the frame jumped, the motion goes on from where it was.
    let mut jumps = track.jumps.iter().peekable();
    let (mut last, mut jumped) = (first.pose, [0.0; 3]);
    for PoseSample { time_s, pose, .. } in track.seen() {
        if jumps.next_if(|jump| jump.after_s <= *time_s).is_some() {
            for (sum, by) in jumped.iter_mut().zip(difference(pose, &last)) {
                *sum += by;
            }
        }
        last = *pose;
        let [x, y, theta] = difference(pose, &Pose::new(jumped[0], jumped[1], jumped[2]));
        let index = ((time_s - first.time_s) / width).min(MOST_BINS) as usize;
        if index >= sums.len() {
            sums.resize(
                index + 1,
                (
                    0.0,
                    Bin {
                        time_s: 0.0,
                        x: 0.0,
                        y: 0.0,
                        theta: 0.0,
                    },
                ),
            );
        }
        if let Some((count, bin)) = sums.get_mut(index) {
            *count += 1.0;
            let sum = |a: f64, b: f64| a + b;
            *bin = Bin {
                time_s: sum(bin.time_s, *time_s),
                x: sum(bin.x, x),
                y: sum(bin.y, y),
                theta: sum(bin.theta, theta),
            };
        }
    }
    let mean = |(n, b): (f64, Bin)| {
        (n > 0.0).then(|| Bin {
            time_s: b.time_s / n,
            x: b.x / n,
            y: b.y / n,
            theta: b.theta / n,
        })
    };
    sums.into_iter().map(mean).collect()
}

fn difference(a: &Pose<f64>, b: &Pose<f64>) -> [f64; 3] {
    [a.x - b.x, a.y - b.y, a.theta - b.theta]
}

/// Bins of rest that end a stretch of motion: a quarter of a cycle.
pub(super) const REST: usize = 25;

/// Interval in which the robot swam: the longest stretch of motion without this number of bins of rest. `lever` \[m\] weighs
/// rotation against translation.
pub(super) fn active(bins: &[Option<Bin>], lever: f64, rest: usize) -> Option<(f64, f64)> {
    let at = |i: usize| bins.get(i).copied().flatten();
    let motion = |i: usize| {
        let (a, b) = (at(i.saturating_sub(2))?, at(i + 2)?);
        Some((b.x - a.x).hypot(b.y - a.y) + lever * (b.theta - a.theta).abs())
    };
    let motions: Vec<Option<f64>> = (0..bins.len()).map(motion).collect();
    let mut sorted: Vec<f64> = motions.iter().copied().flatten().collect();
    sorted.sort_by(f64::total_cmp);
    let quick = *sorted.get(sorted.len() * 9 / 10)?;
    // A tenth of quick motion, or three times what noise feigns, where that is more.
    let threshold = (3.0 * feigned(bins, lever)).clamp(0.1 * quick, 0.4 * quick);
    let mut best: Option<(usize, usize)> = None;
    let mut run: Option<(usize, usize)> = None;
    for (i, _) in motions
        .iter()
        .enumerate()
        .filter(|(_, m)| m.is_some_and(|m| m > threshold))
    {
        run = Some(match run {
            Some((start, end)) if i - end <= rest => (start, i),
            _ => (i, i),
        });
        if let Some((start, end)) = run
            && best.is_none_or(|(a, b)| end - start > b - a)
        {
            best = run;
        }
    }
    let (start, end) = best?;
    // Motion up to the last bin that has neighbours on both sides goes on to the end of the recording.
    let end = if end + 3 >= bins.len() {
        bins.iter().rposition(Option::is_some)?
    } else {
        end
    };
    // Motion shows in a bin's neighbours: the bin itself may be one in which nothing was seen.
    let first = bins.iter().skip(start).flatten().next()?;
    let last = bins.iter().take(end + 1).rev().flatten().next()?;
    Some((first.time_s, last.time_s))
}

/// The motion that noise feigns between two bins \[m\], from second differences, which smooth motion does not show in.
fn feigned(bins: &[Option<Bin>], lever: f64) -> f64 {
    let deviation = |value: fn(&Bin) -> f64| {
        let triples = bins.windows(3).filter_map(|w| match w {
            [Some(a), Some(b), Some(c)] => Some((value(a) - 2.0 * value(b) + value(c)).abs()),
            _ => None,
        });
        let mut differences: Vec<f64> = triples.collect();
        differences.sort_by(f64::total_cmp);
        // Median of a normal variable's size over its deviation, and six variances in a second difference.
        differences
            .get(differences.len() / 2)
            .map_or(0.0, |median| median / 0.6745 / 6f64.sqrt())
    };
    let (x, y, theta) = (
        deviation(|b| b.x),
        deviation(|b| b.y),
        deviation(|b| b.theta),
    );
    2f64.sqrt() * (x.hypot(y) + lever * theta)
}

/// The period \[s\], refined, and whether the search ended at its border.
pub(super) struct Period {
    pub(super) seconds: f64,
    pub(super) at_border: bool,
}

/// Refines the commanded period by the explained variance of mean, drift and harmonics of θ. The commanded one stands unless
/// another is better by more than chance.
pub(super) fn refine_period(bins: &[Bin], commanded_s: f64) -> Period {
    let keep = Period {
        seconds: commanded_s,
        at_border: false,
    };
    let span = bins.last().map_or(0.0, |b| b.time_s) - bins.first().map_or(0.0, |b| b.time_s);
    if span < 1.9 * commanded_s {
        return keep;
    }
    let unexplained = |scale: f64| {
        harmonic_fit(bins, commanded_s * scale, 0.0, PERIOD_HARMONICS)
            .map_or(f64::INFINITY, |(_, rest)| rest)
    };
    // The peak is 1/cycles wide; look several times within it.
    let cycles = span / commanded_s;
    let looks = ((8.0 * PERIOD_RANGE * cycles).ceil() as usize).clamp(8, 400);
    let scale = |i: usize| 1.0 + PERIOD_RANGE * (2.0 * i as f64 / looks as f64 - 1.0);
    let values: Vec<f64> = (0..=looks).map(|i| unexplained(scale(i))).collect();
    let best = (0..=looks)
        .min_by(|a, b| values[*a].total_cmp(&values[*b]))
        .unwrap_or(looks / 2);
    if best == 0 || best == looks {
        return Period {
            at_border: true,
            ..keep
        };
    }
    let (found, least) = golden(scale(best - 1), scale(best + 1), 40, unexplained);
    let noise = least / (bins.len().saturating_sub(2 + 2 * PERIOD_HARMONICS).max(1)) as f64;
    if unexplained(1.0) - least < 9.0 * noise {
        keep
    } else {
        Period {
            seconds: commanded_s * found,
            at_border: false,
        }
    }
}

/// θ's harmonics about `zero_s` by least squares, and the unexplained sum of squares.
pub(super) fn harmonic_fit(
    bins: &[Bin],
    period_s: f64,
    zero_s: f64,
    harmonics: usize,
) -> Option<(Vec<[f64; 2]>, f64)> {
    let terms = 2 + 2 * harmonics;
    let middle = bins.get(bins.len() / 2)?;
    let span = (bins.last()?.time_s - bins.first()?.time_s).max(period_s);
    let mut gram = DMatrix::<f64>::zeros(terms, terms);
    let mut right = DVector::<f64>::zeros(terms);
    let mut total = 0.0;
    let mut row = vec![0.0; terms];
    for bin in bins {
        let (sin, cos) = (TAU * (bin.time_s - zero_s) / period_s).sin_cos();
        let (mut c, mut s) = (1.0, 0.0);
        row[0] = 1.0;
        row[1] = (bin.time_s - middle.time_s) / span;
        for h in 0..harmonics {
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
            (row[2 + 2 * h], row[3 + 2 * h]) = (c, s);
        }
        let value = bin.theta - middle.theta;
        for i in 0..terms {
            for j in 0..=i {
                gram[(i, j)] += row[i] * row[j];
            }
            right[i] += row[i] * value;
        }
        total += value * value;
    }
    let solution = gram.cholesky()?.solve(&right);
    let rest = (total - solution.dot(&right)).max(0.0);
    Some((
        (0..harmonics)
            .map(|h| [solution[2 + 2 * h], solution[3 + 2 * h]])
            .collect(),
        rest,
    ))
}

/// A time at which a cycle starts, by matching θ with the model's: the shift at which all harmonics of both agree best
/// (for one harmonic: the difference of phases).
pub(super) fn cycle_start(bins: &[Bin], period_s: f64, model: &Harmonics) -> Option<f64> {
    let zero_s = bins.first()?.time_s;
    let (measured, _) = harmonic_fit(bins, period_s, zero_s, HARMONICS)?;
    Some(zero_s + shift(&measured, model)? * period_s)
}

/// By how much of a period the model must be moved for its θ to match the measured one best.
pub(crate) fn shift(measured: &[[f64; 2]], model: &Harmonics) -> Option<f64> {
    /// Places tried, 36 in a period of the highest harmonic.
    const PLACES: u32 = 180;
    // θ(t) = Σ c cos hω(t − zero) + s sin …; the model runs from its start: shift ψ = ω (start − zero).
    // Overlap Σ Re(conj(M) C e^{ihψ}) with C = c − is.
    let products: [(f64, f64); HARMONICS] = std::array::from_fn(|h| {
        let (m, r) = (measured.get(h).copied().unwrap_or_default(), model[h]);
        (r[0] * m[0] + r[1] * m[1], r[1] * m[0] - r[0] * m[1])
    });
    let place = |i: u32| TAU * f64::from(i) / f64::from(PLACES);
    let overlaps = (0..PLACES).map(|i| (Overlap::at(place(i), &products).value, i));
    let (_, best) = overlaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut psi = place(best);
    for _ in 0..8 {
        let overlap = Overlap::at(psi, &products);
        if overlap.bend >= 0.0 {
            break;
        }
        psi -= (overlap.slope / overlap.bend).clamp(-TAU / 360.0, TAU / 360.0);
    }
    Some(psi / TAU)
}

/// Overlap of two headings whose cycles start ψ apart, with its derivatives by ψ.
struct Overlap {
    value: f64,
    slope: f64,
    bend: f64,
}

impl Overlap {
    /// Sum over the harmonics, given the products of their coefficients (real and imaginary part).
    fn at(psi: f64, products: &[(f64, f64); HARMONICS]) -> Self {
        let (sin, cos) = psi.sin_cos();
        let (mut c, mut s) = (1.0, 0.0);
        let mut sum = Self {
            value: 0.0,
            slope: 0.0,
            bend: 0.0,
        };
        for ((re, im), h) in products.iter().zip(1..) {
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
            let (h, value) = (f64::from(h), re * c - im * s);
            sum.value += value;
            sum.slope -= h * (re * s + im * c);
            sum.bend -= h * h * value;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_heading_is_found_where_it_was_moved_to() {
        let model: Harmonics = [
            [0.3, -0.1],
            [0.2, 0.4],
            [-0.3, 0.1],
            [0.05, 0.2],
            [0.1, -0.3],
        ];
        for i in 0..100 {
            let by = f64::from(i) / 100.0 + 0.003;
            let moved: Vec<[f64; 2]> = model
                .iter()
                .zip(1..)
                .map(|([c, s], h)| {
                    let (sin, cos) = (f64::from(h) * TAU * by).sin_cos();
                    [c * cos - s * sin, s * cos + c * sin]
                })
                .collect();
            let found = shift(&moved, &model).unwrap();
            let off = found - by - (found - by).round();
            assert!(off.abs() < 1e-12, "{by}: {found}");
        }
    }

    #[test]
    fn motion_that_begins_and_ends_unseen_is_found() {
        let bin = |i: usize| {
            let time_s = i as f64 / BINS;
            let along = (time_s - 0.5).clamp(0.0, 2.0);
            Some(Bin {
                time_s,
                x: along,
                y: 0.0,
                theta: 0.0,
            })
        };
        let mut bins: Vec<Option<Bin>> = (0..300).map(bin).collect();
        let whole = active(&bins, 0.07, REST).unwrap();
        // Motion about each of them, but nothing in it: among them the first and the last that moves.
        for unseen in 0..300 {
            let kept = bins[unseen].take();
            let (from, to) = active(&bins, 0.07, REST).unwrap();
            assert!(
                (from - whole.0).abs() < 0.03 && (to - whole.1).abs() < 0.03,
                "{unseen}"
            );
            bins[unseen] = kept;
        }
    }
}
