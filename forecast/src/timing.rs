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
//! and ∫ max(τ, k p) du = T fixes k, because the left side grows with k, from ∫ τ du, **the shortest possible period**, at k = 0.
//! (This is the water-filling solution of information theory, with lower bound τ.) Without a limit k = T/∫p and the energy is
//! (∫p)²/T, the constant-power value of the paper; Lighthill's ξ is proportional to 1/(E T), so the cap costs the share 1 −
//! (∫p)²/(T E) of ξ.

mod error;
mod table;

use nalgebra::Vector2;
use swimmer_files::{GaitArc, GaitFile};
use swimmer_model::{Gait, GaitPoint, GaussLegendre, Model};

pub use error::TimingError;
use error::{check_period, check_rate};
pub use table::{shortest_of_table, timing_of_table};

/// Cells of a cycle, at least; those of a sampled gait end at its samples.
const CELLS: f64 = 2048.0;
/// Quadrature in every cell. If the cap sets in within a cell, the integral is off by the square of the cell's width, 1e-7 of
/// the period.
type Rule = GaussLegendre<4>;
/// Newton's steps on a convex, piecewise linear function end by themselves; this only bounds them.
const STEPS: usize = 200;

/// The best timing of a gait under a rate limit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Timing {
    /// Duration of the cycle \[s\].
    #[serde(rename = "period_s")]
    pub period: f64,
    /// The shortest period that the rate limit leaves possible \[s\].
    #[serde(rename = "period_min_s")]
    pub shortest_period: f64,
    /// The rate limit \[rad/s\]; infinite for none.
    #[serde(rename = "max_rate_rad_s")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
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
    #[serde(skip)]
    cells: Vec<Cell>,
}

/// End of a cell of the curve, with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    u: f64,
    /// Seconds.
    time: f64,
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
/// An invalid rate, or a gait that stands still.
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
    let rates = Vector2::from(max_rates);
    let lasts =
        |(weight, point): (f64, GaitPoint<f64>)| weight * point.rate.component_div(&rates).amax();
    let period = points(gait, &cuts(gait)).flatten().map(lasts).sum();
    if period > 0.0 {
        Ok(period)
    } else {
        Err(TimingError::Still)
    }
}

/// A curve with what its timing depends on.
struct Curve {
    cuts: Vec<f64>,
    /// Samples of each cell.
    samples: Vec<[Sample; 4]>,
    /// ∫p: the power length.
    length: f64,
}

impl Curve {
    fn new<G: Gait<f64> + ?Sized>(model: &Model<f64>, gait: &G) -> Result<Self, TimingError> {
        let sample = |(weight, point): (f64, GaitPoint<f64>)| {
            let power = model.power_matrix(&point.phi) * point.rate;
            Sample {
                weight,
                power_root: point.rate.dot(&power).max(0.0).sqrt(),
                turn: point.rate.amax(),
            }
        };
        let cuts = cuts(gait);
        let samples: Vec<_> = points(gait, &cuts).map(|cell| cell.map(sample)).collect();
        let all = || samples.iter().flatten();
        let length: f64 = all().map(|s| s.weight * s.power_root).sum();
        if length > 0.0 && all().any(|s| s.turn > 0.0) {
            Ok(Self {
                cuts,
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

    /// The k with ∫ max(τ, k p) du = T. The left side is convex and grows with k, piecewise linear for a finite rule; from the
    /// right end Newton's method descends to the root and meets it exactly.
    fn poured(&self, period: f64, max_rate: f64) -> f64 {
        let mut k = period / self.length;
        for _ in 0..STEPS {
            let (mut time, mut slope) = (0.0, 0.0);
            for s in self.samples.iter().flatten() {
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

    /// The timing of least energy with a period \[s\] that is no shorter than the shortest, and joints of at most `max_rate`
    /// \[rad/s\] (infinite for no limit).
    fn timing(&self, period: f64, max_rate: f64) -> Timing {
        let (length, all) = (self.length, || self.samples.iter().flatten());
        let k = self.poured(period, max_rate);
        let floor = |s: &Sample| s.turn / max_rate;
        let slowness = |s: &Sample| floor(s).max(k * s.power_root);
        let moving = || all().filter(|s| s.power_root > 0.0);
        let energy = moving().map(|s| s.weight * s.power_root.powi(2) / slowness(s));
        let energy: f64 = energy.sum();
        let limited = all().filter(|s| floor(s) > k * s.power_root);
        let limited: f64 = limited.map(|s| s.weight * floor(s)).sum();
        let fastest = moving().map(|s| s.turn / s.power_root).fold(0.0, f64::max);
        let ends = self.samples.iter().scan(0.0, |time, cell| {
            *time += cell.iter().map(|s| s.weight * slowness(s)).sum::<f64>();
            Some(*time)
        });
        let times: Vec<f64> = std::iter::once(0.0).chain(ends).collect();
        // The last digits of the sum, so that the cycle ends at its period.
        let scale = period / times.last().copied().unwrap_or(period);
        let cells = self.cuts.iter().zip(times).map(|(&u, time)| Cell {
            u,
            time: if u >= 1.0 { period } else { time * scale },
        });
        Timing {
            period,
            shortest_period: self.shortest(max_rate),
            max_rate,
            at_limit: limited / period,
            rate_at_constant_power: fastest * length / period,
            energy,
            efficiency_loss: (1.0 - length * length / (period * energy)).max(0.0),
            cells: cells.collect(),
        }
    }

    /// The fastest timing of servos of this rate, slower by the same share everywhere so that it takes this period.
    fn stretched(&self, period: f64, max_rate: f64) -> Timing {
        let rate = self.shortest(1.0) / period;
        let timing = self.timing(period, rate);
        let close = max_rate <= 1.01 * rate;
        Timing {
            max_rate,
            at_limit: if close { timing.at_limit } else { 0.0 },
            ..timing
        }
    }
}

impl Timing {
    /// Time at which the shape `u` of the original parametrisation is reached, as a fraction of the period: exact at the ends of
    /// the gait's pieces, linear between cells.
    pub fn fraction_at(&self, u: f64) -> f64 {
        let i = self
            .cells
            .partition_point(|cell| cell.u <= u)
            .clamp(1, self.cells.len().saturating_sub(1).max(1));
        match (self.cells.get(i - 1), self.cells.get(i)) {
            (Some(a), Some(b)) => {
                let share = ((u - a.u) / (b.u - a.u)).clamp(0.0, 1.0);
                (a.time + share * (b.time - a.time)) / self.period
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

/// Subdivision of the cycle, from 0 to 1: the ends of the gait's pieces, and points between distant ends.
pub(crate) fn cuts<G: Gait<f64> + ?Sized>(gait: &G) -> Vec<f64> {
    let mut cuts = vec![0.0];
    let mut start = 0.0;
    let last = gait.pieces().max(1) - 1;
    for piece in 0..=last {
        let end = if piece == last {
            1.0
        } else {
            gait.piece_end(piece).clamp(start, 1.0)
        };
        let parts = ((end - start) * CELLS).ceil();
        let inner = (1_u32..).map(|part| f64::from(part) / parts);
        let inner = inner.take_while(|share| *share < 1.0);
        cuts.extend(inner.map(|share| start + (end - start) * share));
        cuts.extend((end > start).then_some(end));
        start = end;
    }
    cuts
}

/// The points of the rule in each cell between cuts, with their weights.
fn points<G: Gait<f64> + ?Sized>(
    gait: &G,
    cuts: &[f64],
) -> impl Iterator<Item = [(f64, GaitPoint<f64>); 4]> {
    cuts.array_windows().map(|[start, end]| {
        let half = 0.5 * (end - start);
        std::array::from_fn(|i| {
            let place = start + half * (1.0 + Rule::NODES[i]);
            (half * Rule::WEIGHTS[i], gait.at(place))
        })
    })
}

#[cfg(test)]
mod tests;
