//! Zero-level curves of a function on a square, traced by predictor and corrector from its exact gradient.
//!
//! **That none is missed**: a grid marks every place where the sign changes between neighbours; each mark must lie on a
//! traced curve, and one that does not starts the next curve. Loops too small for the grid hide between nodes of one sign
//! around a node where the function is smallest; those neighbourhoods are searched on a grid four times finer. So a
//! component can only be missed where it is narrower than a fifth of a cell.

use nalgebra::{DMatrix, Vector2};

use crate::certificate::to_side;

/// A function of the joint angles with its gradient.
pub(crate) struct Level<F>(pub(crate) F);

/// One connected zero-level curve, possibly through points where it crosses another.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LevelCurve {
    /// Whether it is closed; an open one ends on the square's edge at both ends.
    pub closed: bool,
    /// The largest |H| at a vertex.
    pub residual: f64,
    /// Vertices Φ \[rad\] in order; where the curve is closed the last is the first again.
    #[serde(rename = "vertices", serialize_with = "pairs")]
    pub points: Vec<Vector2<f64>>,
}

fn pairs<S: serde::Serializer>(points: &[Vector2<f64>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(points.iter().map(|phi| [phi.x, phi.y]))
}

/// Where and how finely to look.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LevelSearch {
    pub(crate) half_width: f64,
    /// Cells along φ₁ and φ₂. Coprime and both odd, so that curves of symmetry, φ₁ = ±φ₂, pass between the nodes.
    cells: [usize; 2],
    /// Longest step along a curve \[rad\].
    step: f64,
}

/// Every vertex is polished to this.
const POLISHED: f64 = 1e-12;
/// And to this where rounding lets it be.
const ROUNDING: f64 = 1e-15;
/// A step is cut until the curve turns by less than this \[rad\].
const TURN: f64 = 0.12;
/// A curve cannot have come round in fewer steps than this.
const FEWEST_ROUND: usize = 10;
/// Steps shorter than this share of the longest are given up.
const SHORTEST: f64 = 1e-7;
/// A curve of more vertices than this is given up: nothing on these squares has a tenth.
const MOST_POINTS: usize = 100_000;

/// A point of a curve with the direction it was reached in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnCurve {
    pub(crate) phi: Vector2<f64>,
    pub(crate) tangent: Vector2<f64>,
    pub(crate) value: f64,
    /// The function's slope to the left of the tangent.
    pub(crate) slope_left: f64,
}

/// How a walk along a curve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Closed,
    Edge,
    Stuck,
}

impl LevelSearch {
    /// A search on \[−D, D\]² for functions that change over an angle of about a tenth of a radian or more.
    pub(crate) fn new(half_width: f64) -> Self {
        // Odd, about 0.06 rad to a cell; 2 apart, so coprime.
        let fewest = (half_width / 0.03).clamp(40.0, 400.0);
        let cells = (0..500)
            .map(|k| 2 * k + 1)
            .find(|&cells| cells as f64 >= fewest)
            .unwrap_or(401);
        Self {
            half_width,
            cells: [cells, cells + 2],
            step: half_width / 90.0,
        }
    }

    fn places(cells: usize) -> Vec<f64> {
        (0..=cells)
            .map(|i| (2.0 * i as f64 / cells as f64 - 1.0).min(1.0))
            .collect()
    }

    fn cell(&self) -> f64 {
        2.0 * self.half_width / self.cells[0] as f64
    }

    /// A seed this close to a traced curve lies on it.
    pub(crate) fn close(&self) -> f64 {
        0.05 * self.cell()
    }

    fn holds(&self, phi: &Vector2<f64>) -> bool {
        phi.amax() <= self.half_width
    }
}

/// All zero-level curves. `on_nodes` gives the values at the products of places, given over the half width.
pub(crate) fn level_curves<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)>(
    level: &Level<F>,
    search: &LevelSearch,
    on_nodes: impl Fn(&[f64], &[f64]) -> DMatrix<f64>,
) -> Vec<LevelCurve> {
    let mut seeds = level_seeds(level, search, on_nodes);
    let mut curves: Vec<LevelCurve> = Vec::new();
    while let Some(seed) = seeds.pop() {
        let Some(curve) = level.curve_through(search, &seed) else {
            continue;
        };
        seeds.retain(|seed| !passes(&curve.points, seed, search.close()));
        curves.push(curve);
    }
    curves
}

/// Points on the zero-level curves, several on each component.
pub(crate) fn level_seeds<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)>(
    level: &Level<F>,
    search: &LevelSearch,
    on_nodes: impl Fn(&[f64], &[f64]) -> DMatrix<f64>,
) -> Vec<Vector2<f64>> {
    let [first, second] = search.cells.map(LevelSearch::places);
    let values = on_nodes(&first, &second);
    let node = |i: usize, j: usize| {
        let at = |places: &[f64], i: usize| places.get(i).copied().unwrap_or(1.0);
        Vector2::new(at(&first, i), at(&second, j)) * search.half_width
    };
    let mut seeds = Vec::new();
    for j in 0..values.ncols() {
        for i in 0..values.nrows() {
            for (k, l) in [(i + 1, j), (i, j + 1)] {
                if let Some(other) = values.get((k, l))
                    && (*other > 0.0) != (values[(i, j)] > 0.0)
                {
                    seeds.extend(level.between(&node(i, j), &node(k, l)));
                }
            }
            if is_dip(&values, i, j) {
                seeds.extend(level.hidden_near(search, &node(i, j), values[(i, j)]));
            }
        }
    }
    seeds
}

/// Whether a node has the smallest |value| among its neighbours, all of its sign.
fn is_dip(values: &DMatrix<f64>, i: usize, j: usize) -> bool {
    let here = values[(i, j)];
    let neighbours = (i.saturating_sub(1)..=i + 1)
        .flat_map(|k| (j.saturating_sub(1)..=j + 1).map(move |l| (k, l)))
        .filter(|&place| place != (i, j))
        .filter_map(|place| values.get(place));
    neighbours
        .into_iter()
        .all(|other| (*other > 0.0) == (here > 0.0) && other.abs() >= here.abs())
}

impl<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)> Level<F> {
    pub(crate) fn at(&self, phi: &Vector2<f64>) -> (f64, Vector2<f64>) {
        self.0(phi)
    }

    /// The zero on a segment whose ends differ in sign: Newton's method kept inside the bracket.
    pub(crate) fn between(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = b - a;
        let (mut low, mut high) = (0.0, 1.0);
        let rising = self.at(b).0 > self.at(a).0;
        let mut t = 0.5;
        for _ in 0..100 {
            let phi = a + along * t;
            let (value, gradient) = self.at(&phi);
            if value.abs() <= ROUNDING || high - low < 1e-15 {
                return Some(phi);
            }
            if (value > 0.0) == rising {
                high = t;
            } else {
                low = t;
            }
            let newton = t - value / gradient.dot(&along);
            t = if newton > low && newton < high {
                if (newton - t).abs() < 1e-16 {
                    return (value.abs() <= POLISHED).then_some(phi);
                }
                newton
            } else {
                0.5 * (low + high)
            };
        }
        let phi = a + along * t;
        (self.at(&phi).0.abs() <= POLISHED).then_some(phi)
    }

    /// Zeros around a node that has the smallest value of its neighbourhood, where a finer grid shows another sign.
    fn hidden_near(
        &self,
        search: &LevelSearch,
        node: &Vector2<f64>,
        value: f64,
    ) -> Option<Vector2<f64>> {
        let fine = search.cell() / 4.0;
        for i in -4..=4_i32 {
            for j in -4..=4_i32 {
                let phi = node + Vector2::new(f64::from(i), f64::from(j)) * fine;
                if search.holds(&phi) && (self.at(&phi).0 > 0.0) != (value > 0.0) {
                    return self.between(node, &phi);
                }
            }
        }
        None
    }

    /// The whole curve through one of its points.
    fn curve_through(&self, search: &LevelSearch, seed: &Vector2<f64>) -> Option<LevelCurve> {
        let start = self.corrected(seed, None, search.step)?;
        let (mut points, mut worst) = (vec![start.phi], start.value.abs());
        let end = self.walk(search, start, &mut points, &mut worst);
        if end != End::Closed {
            let mut back = Vec::new();
            let turned = OnCurve {
                tangent: -start.tangent,
                slope_left: -start.slope_left,
                ..start
            };
            self.walk(search, turned, &mut back, &mut worst);
            back.reverse();
            back.append(&mut points);
            points = back;
        }
        (points.len() > 1).then_some(LevelCurve {
            points,
            closed: end == End::Closed,
            residual: worst,
        })
    }

    /// Walks along the curve to its end, adding vertices after the first.
    fn walk(
        &self,
        search: &LevelSearch,
        start: OnCurve,
        points: &mut Vec<Vector2<f64>>,
        worst: &mut f64,
    ) -> End {
        let mut here = start;
        let mut step = search.step;
        let mut steps = 0;
        while points.len() < MOST_POINTS {
            let to_start = start.phi - here.phi;
            let ahead = to_start.dot(&here.tangent);
            let back_home = steps > FEWEST_ROUND
                && ahead > 0.0
                && to_start.norm() <= step.max(0.5 * search.step)
                && (to_start - here.tangent * ahead).norm() <= 0.25 * ahead
                && here.tangent.dot(&start.tangent) > 0.9;
            if back_home {
                points.push(start.phi);
                return End::Closed;
            }
            let Some(next) = self.stepped(&here, step) else {
                step *= 0.5;
                if step < SHORTEST * search.step {
                    return End::Stuck;
                }
                continue;
            };
            if !search.holds(&next.phi) {
                return match self.on_edge(search, &here, &next) {
                    Some(edge) => {
                        *worst = worst.max(edge.value.abs());
                        if (edge.phi - here.phi).norm() > 1e-9 {
                            points.push(edge.phi);
                        }
                        End::Edge
                    }
                    None => End::Stuck,
                };
            }
            steps += 1;
            *worst = worst.max(next.value.abs());
            points.push(next.phi);
            here = next;
            step = (1.4 * step).min(search.step);
        }
        End::Stuck
    }

    /// One step along the curve; none where it would turn too much or leave the curve.
    pub(crate) fn stepped(&self, here: &OnCurve, step: f64) -> Option<OnCurve> {
        let guess = here.phi + here.tangent * step;
        let next = self.corrected(&guess, Some(&here.tangent), 0.2 * step)?;
        let turn = here
            .tangent
            .perp(&next.tangent)
            .atan2(here.tangent.dot(&next.tangent));
        // The chord must agree with both tangents, or the step has changed to another branch.
        let chord = (next.phi - here.phi).normalize();
        let kink = here
            .tangent
            .perp(&chord)
            .abs()
            .max(chord.perp(&next.tangent).abs());
        (turn.abs() <= TURN && kink <= 0.8 * TURN).then_some(next)
    }

    /// Newton's method along the gradient, no farther than `reach` from the guess; the tangent goes on along `onward`.
    pub(crate) fn corrected(
        &self,
        guess: &Vector2<f64>,
        onward: Option<&Vector2<f64>>,
        reach: f64,
    ) -> Option<OnCurve> {
        let mut phi = *guess;
        let mut best: Option<OnCurve> = None;
        for _ in 0..12 {
            let (value, gradient) = self.at(&phi);
            let slope = gradient.norm();
            if !(value.is_finite() && slope > 0.0 && (phi - guess).norm() <= reach) {
                break;
            }
            if best.is_some_and(|best| value.abs() >= best.value.abs()) {
                break;
            }
            let tangent = Vector2::new(gradient.y, -gradient.x) / slope;
            let along = onward.is_none_or(|onward| tangent.dot(onward) >= 0.0);
            best = Some(OnCurve {
                phi,
                tangent: if along { tangent } else { -tangent },
                value,
                slope_left: if along { slope } else { -slope },
            });
            if value.abs() <= ROUNDING {
                break;
            }
            phi -= gradient * (value / (slope * slope));
        }
        best.filter(|best| best.value.abs() <= POLISHED)
    }

    /// Where the curve leaves the square between two of its points, the second outside: a zero on the edge itself.
    fn on_edge(&self, search: &LevelSearch, from: &OnCurve, to: &OnCurve) -> Option<OnCurve> {
        let way = to.phi - from.phi;
        // The edge that is met first.
        let (axis, share) = (0..2)
            .filter(|&axis| to.phi[axis].abs() > search.half_width && way[axis] != 0.0)
            .map(|axis| {
                let edge = search.half_width.copysign(to.phi[axis]);
                (axis, (edge - from.phi[axis]) / way[axis])
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut phi = from.phi + way * share.clamp(0.0, 1.0);
        phi[axis] = search.half_width.copysign(to.phi[axis]);
        let other = 1 - axis;
        let met = phi[other];
        for _ in 0..30 {
            let (value, gradient) = self.at(&phi);
            let next = (phi[other] - value / gradient[other])
                .clamp(met - way.norm(), met + way.norm())
                .clamp(-search.half_width, search.half_width);
            if value.abs() <= ROUNDING || (next - phi[other]).abs() < 1e-16 || !next.is_finite() {
                return (value.abs() <= POLISHED).then_some(OnCurve {
                    phi,
                    value,
                    ..*from
                });
            }
            phi[other] = next;
        }
        let value = self.at(&phi).0;
        (value.abs() <= POLISHED).then_some(OnCurve {
            phi,
            value,
            ..*from
        })
    }
}

/// Whether a point lies within `distance` of a polyline.
pub(crate) fn passes(points: &[Vector2<f64>], point: &Vector2<f64>, distance: f64) -> bool {
    let mut sides = points.array_windows();
    sides.any(|[a, b]| to_side(point, a, b) <= distance)
}

#[cfg(test)]
mod tests;
