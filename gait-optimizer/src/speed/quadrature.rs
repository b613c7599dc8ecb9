//! A Gauss–Legendre rule on \[0, 1\] that also integrates up to each of its nodes.

use crate::height_map::legendre::{gauss, legendre};

/// Nodes, weights, and the weights of the integrals from 0 to each node.
#[derive(Debug, Clone)]
pub(crate) struct Rule {
    pub(crate) nodes: Vec<f64>,
    pub(crate) weights: Vec<f64>,
    /// `cumulative[q][r]`: weight of node r in the integral from 0 to node q.
    pub(crate) cumulative: Vec<Vec<f64>>,
}

impl Rule {
    pub(crate) fn new(count: usize) -> Self {
        let (x, w) = gauss(count);
        // Through the values pass polynomials Σ_k (k + ½) P_k(x) Σ_r w_r P_k(x_r) f_r; each P_k has a known integral.
        let table: Vec<Vec<f64>> = x.iter().map(|&x| legendre(count + 1, x)).collect();
        let up_to = |q: usize, k: usize| {
            let p = table.get(q).map_or(&[][..], Vec::as_slice);
            let at = |k: usize| p.get(k).copied().unwrap_or(f64::NAN);
            match k {
                0 => at(1) + 1.0,
                _ => (at(k + 1) - at(k - 1)) / (2.0 * k as f64 + 1.0),
            }
        };
        let weight = |q: usize, r: usize| {
            let sum: f64 = (0..count)
                .map(|k| {
                    let value = table.get(r).and_then(|p| p.get(k)).copied();
                    (k as f64 + 0.5) * value.unwrap_or(f64::NAN) * up_to(q, k)
                })
                .sum();
            0.5 * sum * w.get(r).copied().unwrap_or(f64::NAN)
        };
        Self {
            cumulative: (0..count)
                .map(|q| (0..count).map(|r| weight(q, r)).collect())
                .collect(),
            nodes: x.iter().map(|x| 0.5 * (x + 1.0)).collect(),
            weights: w.iter().map(|w| 0.5 * w).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_to_each_node() {
        let rule = Rule::new(7);
        for power in 0..7 {
            let values: Vec<f64> = rule.nodes.iter().map(|s| s.powi(power)).collect();
            for (s, weights) in rule.nodes.iter().zip(&rule.cumulative) {
                let sum: f64 = weights.iter().zip(&values).map(|(w, v)| w * v).sum();
                let exact = s.powi(power + 1) / f64::from(power + 1);
                assert!((sum - exact).abs() < 1e-14, "{power} {s} {sum} {exact}");
            }
        }
    }
}
