//! The best timing of a curve that servos of a limited rate run.
//!
//! A gait's curve Φ(u) fixes its displacement; when each of its shapes is reached is free. With a period T let t(u) be the
//! time of the shape u, p(u) the root of the power at unit speed of u, `p² = Φ′ᵀWΦ′`, and τ(u) = maxᵢ|φᵢ′| / r the least
//! time for a unit of u at the servos' rate r.
//! The power is (p/t')², so the least energy of a cycle is
//!
//! ```text
//! minimise ∫ p²/t' du   over   t'(u) ≥ τ(u),  ∫ t' du = T.
//! ```
//!
//! The integrand is convex in t' (strictly where p > 0) and the constraints are linear, so the conditions of Karush, Kuhn
//! and Tucker are necessary and sufficient: −p²/t'² + λ − ν(u) = 0 with ν ≥ 0 and ν (t' − τ) = 0. Where the rate does not
//! bind, ν = 0 and t' = p/√λ: **constant power** P = λ. Where it binds, t' = τ and ν = λ − p²/τ² ≥ 0: the power is below λ.
//! Together
//!
//! ```text
//! t'(u) = max(τ(u), k p(u)),   k = 1/√λ,
//! ```
//!
//! and ∫ max(τ, k p) du = T fixes k, because the left side grows with k, from ∫ τ du, **the shortest possible period**, at
//! k = 0. (It is the water-filling of information theory: time is poured over the curve, onto a floor τ.) Without a limit
//! k = T/∫p and the energy is (∫p)²/T, the constant-power value of the paper; Lighthill's ξ goes with 1/(E T), so the cap
//! costs the share 1 − (∫p)²/(T E) of ξ.

mod error;
mod table;

use nalgebra::Vector2;
use swimmer_files::{GaitArc, GaitFile};
use swimmer_model::{Gait, Model};

pub use error::TimingError;
use error::{check_period, check_rate};
pub use table::{shortest_of_table, timing_of_table};

/// Cells of a cycle, at least; those of a sampled gait end at its samples.
const CELLS: f64 = 2048.0;
/// Gauss–Legendre rule of four points on \[0, 1\], used in every cell: where the cap sets in within a cell, the integral is
/// off by the square of the cell's width, 1e-7 of the period.
const RULE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
/// Newton's steps on a convex, piecewise linear function end by themselves; this only bounds them.
const STEPS: usize = 200;

/// The best timing of a gait under a rate limit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Timing {
    /// Duration of the cycle \[s\].
    #[serde(rename = "period_s")]
    pub period: f64,
    /// The shortest period that the rate limit leaves possible \[s\].
    #[serde(rename = "period_min_s")]
    pub shortest_period: f64,
    /// The rate limit \[rad/s\]; infinite for none.
    #[serde(rename = "max_rate_rad_s")]
    pub max_rate: f64,
    /// Fastest joint at constant power, without the limit \[rad/s\].
    #[serde(rename = "rate_at_constant_power_rad_s")]
    pub rate_at_constant_power: f64,
    /// Share of the period in which a servo runs at its limit, or within a hundredth of it.
    pub at_limit: f64,
    /// Share of Lighthill's ξ that the limit costs: 0 where constant power keeps within it.
    pub efficiency_loss: f64,
    /// Energy of the cycle over μ \[m³/s\].
    #[serde(skip)]
    pub energy: f64,
    /// Highest power over μ \[m³/s²\]: that of every stretch where no servo is at its limit.
    #[serde(skip)]
    pub power: f64,
    #[serde(skip)]
    cells: Vec<Cell>,
}

/// A stretch of the curve: where it ends, when, and the power there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    u: f64,
    /// Seconds.
    time: f64,
    /// P/μ \[m³/s²\] in the mean over the cell.
    power: f64,
}

/// p and τ·r at the points of the rule.
struct Sample {
    weight: f64,
    power_root: f64,
    turn: f64,
}

/// The shortest period \[s\] in which joints of at most these rates \[rad/s\] can run a gait: ∫ maxᵢ(|φᵢ'|/rᵢ) du.
///
/// # Errors
/// A rate that is none, or a gait that stands still.
///
/// ```
/// use forecast::shortest_period;
/// use swimmer_files::AnyGait;
///
/// // Each servo turns through 4 × 1 rad there and back.
/// let shortest = shortest_period(&AnyGait::square(1.0), [2.0; 2]).unwrap();
/// assert!((shortest - 4.0).abs() < 1e-6, "{shortest}");
/// ```
pub fn shortest_period<G: Gait<f64> + ?Sized>(
    gait: &G,
    max_rates: [f64; 2],
) -> Result<f64, TimingError> {
    for rate in max_rates {
        check_rate(rate)?;
    }
    let mut period = 0.0;
    for (start, end) in cells(gait) {
        for (at, weight) in RULE {
            let point = gait.at(start + at * (end - start));
            let turning = point.rate.component_div(&Vector2::from(max_rates));
            period += weight * (end - start) * turning.amax();
        }
    }
    if period > 0.0 {
        Ok(period)
    } else {
        Err(TimingError::Still)
    }
}

/// The timing of least energy of a gait with this period \[s\] and joints of at most `max_rate` \[rad/s\] (infinite for no
/// limit).
///
/// # Errors
/// [`TimingError`]; a period that is too short comes with the shortest one.
///
/// ```
/// use forecast::timing;
/// use swimmer_files::AnyGait;
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
/// let relaxed = timing(&model, &AnyGait::circle(1.2), 30.0, 3.5).unwrap();
/// assert!(relaxed.efficiency_loss.abs() < 1e-9 && relaxed.at_limit == 0.0);
/// let hurried = timing(&model, &AnyGait::circle(1.2), 1.02 * relaxed.shortest_period, 3.5).unwrap();
/// assert!(hurried.efficiency_loss > 0.0);
/// assert!(timing(&model, &AnyGait::circle(1.2), 0.9 * relaxed.shortest_period, 3.5).is_err());
/// ```
pub fn timing<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    gait: &G,
    period: f64,
    max_rate: f64,
) -> Result<Timing, TimingError> {
    check_rate(max_rate)?;
    check_period(period)?;
    let curve = Curve::new(model, gait)?;
    let shortest = curve.shortest(max_rate);
    if period < shortest {
        return Err(TimingError::TooFast {
            period,
            rate: max_rate,
            shortest,
        });
    }
    Ok(curve.timing(period, max_rate))
}

/// A curve with what its timing depends on.
struct Curve {
    /// From and to.
    cells: Vec<(f64, f64)>,
    samples: Vec<[Sample; 4]>,
    /// ∫p: the power length.
    length: f64,
}

impl Curve {
    fn new<G: Gait<f64> + ?Sized>(model: &Model<f64>, gait: &G) -> Result<Self, TimingError> {
        let cells = cells(gait);
        let samples: Vec<[Sample; 4]> = cells
            .iter()
            .map(|&(start, end)| {
                RULE.map(|(at, weight)| {
                    let point = gait.at(start + at * (end - start));
                    let power = point
                        .rate
                        .dot(&(model.power_matrix(&point.phi) * point.rate));
                    Sample {
                        weight: weight * (end - start),
                        power_root: power.max(0.0).sqrt(),
                        turn: point.rate.amax(),
                    }
                })
            })
            .collect();
        let all = || samples.iter().flatten();
        let length: f64 = all().map(|s| s.weight * s.power_root).sum();
        if length > 0.0 && all().any(|s| s.turn > 0.0) {
            Ok(Self {
                cells,
                samples,
                length,
            })
        } else {
            Err(TimingError::Still)
        }
    }

    /// ∫τ.
    fn shortest(&self, max_rate: f64) -> f64 {
        let all = self.samples.iter().flatten();
        all.map(|s| s.weight * s.turn).sum::<f64>() / max_rate
    }

    /// The best timing with a period that is no shorter than the shortest.
    fn timing(&self, period: f64, max_rate: f64) -> Timing {
        let (length, all) = (self.length, || self.samples.iter().flatten());
        let k = pour(all, period, max_rate, period / length);
        let (mut time, mut energy, mut limited, mut fastest) = (0.0, 0.0, 0.0, 0.0_f64);
        let mut timed = Vec::with_capacity(self.cells.len() + 1);
        timed.push((0.0, 0.0, 0.0));
        for (&(_, end), samples) in self.cells.iter().zip(&self.samples) {
            let (mut lasts, mut spends) = (0.0, 0.0);
            for s in samples {
                let (floor, poured) = (s.turn / max_rate, k * s.power_root);
                let slowness = floor.max(poured);
                lasts += s.weight * slowness;
                if slowness > 0.0 {
                    spends += s.weight * s.power_root * s.power_root / slowness;
                }
                if floor > poured {
                    limited += s.weight * floor;
                }
                if s.power_root > 0.0 {
                    fastest = fastest.max(s.turn / s.power_root);
                }
            }
            time += lasts;
            energy += spends;
            timed.push((end, time, if lasts > 0.0 { spends / lasts } else { 0.0 }));
        }
        // The last digits of the sum, so that the cycle ends at its period.
        let scale = period / time;
        let cells: Vec<Cell> = timed
            .into_iter()
            .map(|(u, time, power)| Cell {
                u,
                time: if u >= 1.0 { period } else { time * scale },
                power,
            })
            .collect();
        Timing {
            period,
            shortest_period: self.shortest(max_rate),
            max_rate,
            at_limit: limited / period,
            rate_at_constant_power: fastest * length / period,
            energy,
            efficiency_loss: (1.0 - length * length / (period * energy)).max(0.0),
            power: cells.iter().map(|cell| cell.power).fold(0.0, f64::max),
            cells,
        }
    }
}

/// The k with ∫ max(τ, k p) du = T. The left side is convex and grows with k, piecewise linear for a finite rule; from the
/// right end Newton's method descends to the root and meets it exactly.
fn pour<'a, I: Iterator<Item = &'a Sample>>(
    samples: impl Fn() -> I,
    period: f64,
    max_rate: f64,
    start: f64,
) -> f64 {
    let mut k = start;
    for _ in 0..STEPS {
        let (mut time, mut slope) = (0.0, 0.0);
        for s in samples() {
            let (floor, poured) = (s.turn / max_rate, k * s.power_root);
            time += s.weight * floor.max(poured);
            if poured > floor {
                slope += s.weight * s.power_root;
            }
        }
        let excess = time - period;
        if excess <= 0.0 || slope <= 0.0 {
            break;
        }
        let next = k - excess / slope;
        if next >= k {
            break;
        }
        k = next;
    }
    k
}

impl Timing {
    /// When the shape `u` of the original parametrisation is reached, as a fraction of the period: exact at the ends of
    /// the gait's pieces, linear between cells.
    pub fn fraction_at(&self, u: f64) -> f64 {
        let i = self
            .cells
            .partition_point(|cell| cell.u <= u)
            .clamp(1, self.cells.len().saturating_sub(1).max(1));
        match (self.cells.get(i - 1), self.cells.get(i)) {
            (Some(a), Some(b)) => {
                let share = ((u - a.u) / (b.u - a.u)).clamp(0.0, 1.0);
                // At a cell's end the very number, so that equal u have equal images.
                let time = if share <= 0.0 {
                    a.time
                } else {
                    a.time + share * (b.time - a.time)
                };
                time / self.period
            }
            _ => u,
        }
    }

    /// A gait file with this timing: the same shapes, arcs and corners, each at its new time. The file must hold the gait
    /// that was timed.
    #[must_use]
    pub fn retime_file(&self, file: &GaitFile) -> GaitFile {
        let at = |u: &f64| self.fraction_at(*u);
        GaitFile {
            arcs: file
                .arcs
                .iter()
                .map(|arc| GaitArc {
                    kind: arc.kind,
                    from: at(&arc.from),
                    to: at(&arc.to),
                })
                .collect(),
            corners: file.corners.iter().map(at).collect(),
            u: file.u.iter().map(at).collect(),
            ..file.clone()
        }
    }
}

/// The cycle cut at the ends of the gait's pieces, and finer where those are far apart.
fn cells<G: Gait<f64> + ?Sized>(gait: &G) -> Vec<(f64, f64)> {
    let mut cells = Vec::new();
    let mut start = 0.0;
    let pieces = gait.pieces().max(1);
    for piece in 0..pieces {
        let end = if piece + 1 == pieces {
            1.0
        } else {
            gait.piece_end(piece).min(1.0)
        };
        if end <= start {
            continue;
        }
        let parts = ((end - start) * CELLS).ceil().max(1.0);
        let mut from = start;
        let mut part = 1.0;
        while part <= parts {
            let to = if part < parts {
                start + (end - start) * (part / parts)
            } else {
                end
            };
            cells.push((from, to));
            from = to;
            part += 1.0;
        }
        start = end;
    }
    cells
}

#[cfg(test)]
mod tests;
