//! Numbers that are linear in unknowns.

/// A number that is linear in the unknowns: their weights, and the rest.
#[derive(Debug, Clone)]
pub(super) struct Affine {
    pub(super) weights: Vec<(usize, f64)>,
    pub(super) rest: f64,
}

impl Affine {
    pub(super) fn times(&self, factor: f64) -> Self {
        Self {
            weights: self
                .weights
                .iter()
                .map(|(at, weight)| (*at, weight * factor))
                .collect(),
            rest: self.rest * factor,
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut weights = self.weights.clone();
        for (at, weight) in &other.weights {
            match weights.iter_mut().find(|(there, _)| there == at) {
                Some((_, sum)) => *sum += weight,
                None => weights.push((*at, *weight)),
            }
        }
        Self {
            weights,
            rest: self.rest + other.rest,
        }
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times(-1.0))
    }
}
