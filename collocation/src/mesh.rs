//! Uniform mesh of a quarter gait: elements of equal length and degree over t = 0 … 1.

use nalgebra::{DVector, Matrix2xX, Vector2};

use super::radau::Rule;

/// Uniform mesh; neighbouring elements share a point.
#[derive(Debug, Clone)]
pub(crate) struct Mesh {
    pub(crate) rule: Rule,
    pub(crate) elements: usize,
    /// Times of all points, 0 to 1.
    pub(crate) times: DVector<f64>,
    /// Quadrature weights of all points. The first point is not a collocation node; it has the weight of the last.
    pub(crate) weights: DVector<f64>,
}

impl Mesh {
    pub(crate) fn new(elements: usize, degree: usize) -> Self {
        let rule = Rule::new(degree);
        let (degree, count) = (rule.degree(), elements as f64);
        let points = elements * degree + 1;
        let node = |point: usize| (point + degree - 1) % degree;
        let times = DVector::from_fn(points, |point, _| match point {
            0 => 0.0,
            _ => (((point - 1) / degree) as f64 + rule.points[node(point) + 1]) / count,
        });
        let weights = DVector::from_fn(points, |point, _| rule.weights()[node(point)] / count);
        Self {
            rule,
            elements,
            times,
            weights,
        }
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.times.len()
    }

    /// Index of the first point of each element.
    pub(crate) fn firsts(&self) -> impl DoubleEndedIterator<Item = usize> + use<> {
        (0..self.len() - 1).step_by(self.rule.degree())
    }

    /// Interpolates `values`, one column per point, at time `t`.
    pub(crate) fn shape(&self, values: &Matrix2xX<f64>, t: f64) -> Vector2<f64> {
        let degree = self.rule.degree();
        let place = t.clamp(0.0, 1.0) * self.elements as f64;
        let start = |first: &usize| (first / degree) as f64;
        let first = self.firsts().rfind(|first| start(first) <= place);
        let first = first.unwrap_or(0);
        values.columns(first, degree + 1) * self.rule.shares(place - start(&first))
    }
}
