//! The mesh of a quarter gait: elements of any length and degree, end to end over t = 0 … 1.

use nalgebra::Vector2;

use super::radau::{NO_SHARES, Rule, rule};

/// One element.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Element {
    pub(crate) start: f64,
    pub(crate) length: f64,
    /// Its first point among all points; its last is `first + rule.degree`.
    pub(crate) first: usize,
    pub(crate) rule: &'static Rule,
}

/// Elements end to end; neighbours share a point.
#[derive(Debug, Clone)]
pub(crate) struct Mesh {
    pub(crate) elements: Vec<Element>,
    /// Times of all points, 0 to 1.
    pub(crate) times: Vec<f64>,
}

impl Mesh {
    /// Elements between these places, each with its degree; `ends` has one more place than `degrees`.
    pub(crate) fn new(ends: &[f64], degrees: &[usize]) -> Self {
        let mut elements = Vec::with_capacity(degrees.len());
        let mut times = vec![0.0];
        for (sides, &degree) in ends.windows(2).zip(degrees) {
            let (start, length) = (sides[0], sides[1] - sides[0]);
            let rule = rule(degree);
            elements.push(Element {
                start,
                length,
                first: times.len() - 1,
                rule,
            });
            times.extend(rule.points[1..].iter().map(|tau| start + length * tau));
        }
        Self { elements, times }
    }

    pub(crate) fn even(elements: usize, degree: usize) -> Self {
        let ends: Vec<f64> = (0..=elements).map(|k| k as f64 / elements as f64).collect();
        Self::new(&ends, &vec![degree; elements])
    }

    /// How many points.
    pub(crate) fn len(&self) -> usize {
        self.times.len()
    }

    /// The element that holds a time.
    pub(crate) fn holding(&self, t: f64) -> Option<&Element> {
        let after = self.elements.partition_point(|element| element.start <= t);
        self.elements.get(after.saturating_sub(1))
    }

    /// The points before and after a time, and how far it is from one to the other.
    pub(crate) fn between(&self, t: f64) -> (usize, usize, f64) {
        let last = self.times.len() - 1;
        let after = self.times.partition_point(|&time| time < t).clamp(1, last);
        let before = after - 1;
        let share = (t - self.times[before]) / (self.times[after] - self.times[before]);
        (before, after, share.clamp(0.0, 1.0))
    }

    /// The shape at a time on the polynomials through these points.
    pub(crate) fn shape(&self, phi: &[Vector2<f64>], t: f64) -> Vector2<f64> {
        self.holding(t)
            .map_or_else(Vector2::zeros, |element| element.shape(phi, t))
    }
}

impl Element {
    pub(crate) fn points(&self) -> std::ops::RangeInclusive<usize> {
        self.first..=self.first + self.rule.degree
    }

    pub(crate) fn end(&self) -> f64 {
        self.start + self.length
    }

    /// The shape at a time on this element's polynomial.
    pub(crate) fn shape(&self, phi: &[Vector2<f64>], t: f64) -> Vector2<f64> {
        let mut shares = NO_SHARES;
        self.rule
            .shares((t - self.start) / self.length, &mut shares);
        phi[self.points()]
            .iter()
            .zip(&shares)
            .map(|(value, &share)| value * share)
            .sum()
    }

    /// The joint rate at node j = 1, …, d.
    pub(crate) fn rate(&self, phi: &[Vector2<f64>], j: usize) -> Vector2<f64> {
        phi[self.points()]
            .iter()
            .zip(self.rule.slope(j))
            .map(|(value, &share)| value * (share / self.length))
            .sum()
    }
}
