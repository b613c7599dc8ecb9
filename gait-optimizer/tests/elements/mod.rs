//! Minimum-perturbation coordinates once more, by bilinear finite elements on a uniform grid: nothing in common with the
//! spectral solution but the definition.

use nalgebra::{Vector2, Vector3};
use swimmer_model::{Model, Swimmer};

/// Fields b₀ … on the nodes of a grid, that minimise Σ ∫|a_k + ∇b_k + Σ c_kl a^θ b_l|².
struct LeastSquares {
    cells: usize,
    width: f64,
    /// For each Gauss point of each cell: rows x, y, θ of the connection (both columns).
    connection: Vec<[Vector2<f64>; 3]>,
    /// Which rows are solved for; the pair (x, y) is coupled by θ.
    rows: Vec<usize>,
}

const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

impl LeastSquares {
    fn nodes(&self) -> usize {
        (self.cells + 1) * (self.cells + 1)
    }

    /// Adds, for every test function, ∫ r · (∇ψ + …) to `out`, where r belongs to `b`, with the connection's rows if `full`.
    fn gradient(&self, b: &[f64], full: bool, out: &mut [f64]) {
        out.fill(0.0);
        let (n, nodes) = (self.cells + 1, self.nodes());
        let coupled = self.rows.len() == 2;
        let mut point = 0;
        for j in 0..self.cells {
            for i in 0..self.cells {
                let corner = [
                    i + j * n,
                    i + 1 + j * n,
                    i + (j + 1) * n,
                    i + 1 + (j + 1) * n,
                ];
                for t in GAUSS {
                    for s in GAUSS {
                        let value = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
                        let slope = [
                            Vector2::new(t - 1.0, s - 1.0),
                            Vector2::new(1.0 - t, -s),
                            Vector2::new(-t, 1.0 - s),
                            Vector2::new(t, s),
                        ]
                        .map(|slope| slope / self.width);
                        let a = &self.connection[point];
                        point += 1;
                        let field = |k: usize| -> f64 {
                            (0..4).map(|c| value[c] * b[k * nodes + corner[c]]).sum()
                        };
                        let mut r = [Vector2::zeros(); 2];
                        for (k, row) in self.rows.iter().enumerate() {
                            r[k] = (0..4).map(|c| slope[c] * b[k * nodes + corner[c]]).sum();
                            if full {
                                r[k] += a[*row];
                            }
                        }
                        if coupled {
                            r[0] -= a[2] * field(1);
                            r[1] += a[2] * field(0);
                        }
                        for c in 0..4 {
                            for k in 0..self.rows.len() {
                                let mut test = r[k].dot(&slope[c]);
                                if coupled {
                                    let other = r[1 - k].dot(&a[2]) * value[c];
                                    test += if k == 0 { other } else { -other };
                                }
                                out[k * nodes + corner[c]] += test;
                            }
                        }
                    }
                }
            }
        }
    }

    /// Conjugate gradients from zero.
    fn solved(&self) -> Vec<f64> {
        let size = self.rows.len() * self.nodes();
        let (mut b, mut residual, mut image) = (vec![0.0; size], vec![0.0; size], vec![0.0; size]);
        self.gradient(&b, true, &mut residual);
        for r in &mut residual {
            *r = -*r;
        }
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let mut direction = residual.clone();
        let mut rho = dot(&residual, &residual);
        let goal = rho * 1e-22;
        for _ in 0..5000 {
            if rho <= goal {
                return b;
            }
            self.gradient(&direction, false, &mut image);
            let step = rho / dot(&direction, &image);
            for k in 0..size {
                b[k] += step * direction[k];
                residual[k] -= step * image[k];
            }
            let next = dot(&residual, &residual);
            for k in 0..size {
                direction[k] = residual[k] + next / rho * direction[k];
            }
            rho = next;
        }
        panic!("conjugate gradients did not converge");
    }
}

/// The frame (b_x, b_y, b_θ), over L and rad, at the nodes of a grid of `cells` × `cells` (an even number) on \[−D, D\]²;
/// φ₁ runs fastest.
pub(crate) fn frame(swimmer: &Swimmer<f64>, half_width: f64, cells: usize) -> Vec<Vector3<f64>> {
    let model = Model::new(swimmer).unwrap();
    let length = swimmer.total_length();
    let width = 2.0 * half_width / cells as f64;
    let mut connection = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            for t in GAUSS {
                for s in GAUSS {
                    let phi = Vector2::new(i as f64 + s, j as f64 + t) * width
                        - Vector2::new(half_width, half_width);
                    let a = model.local_connection(&phi);
                    let row = |k: usize, over: f64| Vector2::new(a[(k, 0)], a[(k, 1)]) / over;
                    connection.push([row(0, length), row(1, length), row(2, 1.0)]);
                }
            }
        }
    }
    let problem = |rows: Vec<usize>| LeastSquares {
        cells,
        width,
        connection: connection.clone(),
        rows,
    };
    let (place, angle) = (problem(vec![0, 1]).solved(), problem(vec![2]).solved());
    let nodes = (cells + 1) * (cells + 1);
    let origin = angle[nodes / 2];
    (0..nodes)
        .map(|k| Vector3::new(place[k], place[nodes + k], angle[k] - origin))
        .collect()
}
