//! All zero-level curves of a function on a square, by predictor–corrector continuation with its exact gradient.
//!
//! **Completeness**: every sign change between neighbours of a grid must be on a traced curve; one that is not starts the next
//! curve. A loop between nodes of equal sign surrounds a local minimum of the magnitude, so the neighbourhood of each such node
//! is searched on a grid four times finer. A component can only be missed if it is narrower than a fifth of a cell.

use nalgebra::{DMatrix, Vector2};

use super::level::{End, Level, OnCurve, Stride};
use crate::certificate::to_side;

/// One connected zero-level curve, possibly through points where it crosses another.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelCurve {
    /// `true` if the curve is closed; both ends of an open curve are on the edge of the square.
    pub closed: bool,
    /// Largest |H| at a vertex.
    pub residual: f64,
    /// Vertices Φ \[rad\] in order; the last repeats the first if the curve is closed.
    #[serde(rename = "vertices", serialize_with = "pairs")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<[f64; 2]>"))]
    pub points: Vec<Vector2<f64>>,
}

fn pairs<S: serde::Serializer>(points: &[Vector2<f64>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(points.iter().map(|phi| [phi.x, phi.y]))
}

/// Domain and resolution of a search for level curves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LevelSearch {
    pub(crate) half_width: f64,
    /// Number of cells along φ₁ and φ₂. Both are odd and coprime, so that the lines φ₁ = ±φ₂ pass between the nodes.
    cells: [usize; 2],
    stride: Stride,
}

impl LevelSearch {
    /// Search on \[−D, D\]² for functions with features of a tenth of a radian or larger.
    pub(crate) fn new(half_width: f64) -> Self {
        // Odd, about 0.06 rad per cell; a difference of 2 makes them coprime.
        let fewest = (half_width / 0.03).clamp(40.0, 400.0);
        let cells = (0..500)
            .map(|k| 2 * k + 1)
            .find(|&cells| cells as f64 >= fewest)
            .unwrap_or(401);
        Self {
            half_width,
            cells: [cells, cells + 2],
            stride: Stride {
                longest: half_width / 90.0,
                turn: 0.12,
            },
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

    /// Distance below which a seed is on a traced curve.
    pub(crate) fn close(&self) -> f64 {
        0.05 * self.cell()
    }

    fn holds(&self, phi: &Vector2<f64>) -> bool {
        phi.amax() <= self.half_width
    }
}

/// Returns all zero-level curves. `on_nodes` evaluates the function on a tensor grid, given over the half width.
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

/// Returns points on the zero-level curves, several on each component.
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

/// Returns `true` if a node has the smallest |value| among its neighbours and all have its sign.
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
    /// Zeros near a local minimum of the magnitude, if a finer grid shows a change of sign.
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

    /// Traces the whole curve through one of its points.
    fn curve_through(&self, search: &LevelSearch, seed: &Vector2<f64>) -> Option<LevelCurve> {
        let mut points = vec![self.corrected(seed, None, search.stride.longest)?];
        let closed = self.to_edge(search, &mut points);
        if !closed {
            points.reverse();
            *points.last_mut()? = points.last()?.back();
            self.to_edge(search, &mut points);
            points.reverse();
        }
        (points.len() > 1).then(|| LevelCurve {
            closed,
            residual: points.iter().map(|at| at.value.abs()).fold(0.0, f64::max),
            points: points.iter().map(|at| at.phi).collect(),
        })
    }

    /// Continues to the edge of the square or to the start. Returns `true` if the curve is closed.
    fn to_edge(&self, search: &LevelSearch, points: &mut Vec<OnCurve>) -> bool {
        let half_width = search.half_width;
        let end = self.walk(points, search.stride, |at| search.holds(&at.phi));
        if let (End::Met(step, beyond), Some(here)) = (end, points.last()) {
            // The edges that are crossed, and the first of them.
            let edges = (0..2).filter(|&axis| beyond.phi[axis].abs() > half_width);
            let met = edges.filter_map(|axis| {
                let side = beyond.phi[axis].signum();
                let left =
                    |at: &OnCurve| (half_width - side * at.phi[axis], -side * at.tangent[axis]);
                let (mut met, length) = self.cut(here, step, left)?;
                met.phi[axis] = side * half_width;
                Some((met, length))
            });
            let first = met.min_by(|a, b| a.1.total_cmp(&b.1));
            points.extend(first.filter(|first| first.1 > 1e-9).map(|first| first.0));
        }
        matches!(end, End::Closed)
    }
}

/// Returns `true` if a point is within `distance` of a polyline.
pub(crate) fn passes(points: &[Vector2<f64>], point: &Vector2<f64>, distance: f64) -> bool {
    let mut sides = points.array_windows();
    sides.any(|[a, b]| to_side(point, a, b) <= distance)
}

#[cfg(test)]
mod tests;
