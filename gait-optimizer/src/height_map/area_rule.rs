//! The area rule: a gait's displacement read off the map, against the displacement it swims.
//!
//! The area under a height function inside the gait is the first term of a series (Baker, Campbell, Hausdorff) for the net
//! displacement; the following ones hold commutators of what happens at different times, and grow with how far the frame
//! still turns and sways in between. Minimum-perturbation coordinates make them small, not zero: the rule is good for
//! gaits up to about a radian, and only a guide for larger ones. The row θ is exact, because plane rotations commute.

use nalgebra::{DMatrix, Rotation2, Vector2, Vector3};
use swimmer_files::AnyGait;
use swimmer_model::{Gait as _, Tolerance, swim};

use super::legendre::{gauss, polynomials};
use super::space::{Field, table, weighed};
use super::{HIGHEST, HeightMap, HeightMapError, Row};

/// What the map says of a gait, and what it swims; (x, y, θ) over L and in rad, along and across the middle link at the
/// gait's first shape, as every other answer tells a displacement.
///
/// The map's own frame may be turned against the middle link there: what it says is carried over. With equal side links
/// and a gait that starts at φ₁ = φ₂ and has no net rotation, nothing changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaRule {
    /// ∬ H over the area enclosed, each part counted as often as the gait winds round it, counter-clockwise positive; carried
    /// from the map's frame to the middle link.
    pub area: Vector3<f64>,
    /// Net displacement of one cycle.
    pub swum: Vector3<f64>,
}

/// Polynomials for the heights themselves, beyond the frame's order: the curvature is less smooth than the connection.
const MORE: usize = 16;
/// Panels that a cycle is cut into at least.
const PANELS: f64 = 256.0;
const POINTS: usize = 6;

impl AreaRule {
    /// What the rule misses: area − swum.
    pub fn deviation(&self) -> Vector3<f64> {
        self.area - self.swum
    }
}

impl HeightMap {
    /// Holds the area rule against the swum displacement of a closed gait, which may cross itself.
    ///
    /// # Errors
    /// [`HeightMapError::GaitBeyondMap`].
    pub fn area_rule(&self, gait: &AnyGait) -> Result<AreaRule, HeightMapError> {
        let first = gait.at(0.0).phi;
        let area = self.enclosed(gait)?;
        let stroke = swim(self.model(), gait, &Tolerance::default());
        // The frame rides along: h a h⁻¹ for the frame h and its net motion a.
        let b = self.frame(&first).b;
        let place = Vector2::new(b.x, b.y);
        let carried = Rotation2::new(b.z) * area.xy() + place - Rotation2::new(area.z) * place;
        Ok(AreaRule {
            area: Vector3::new(carried.x, carried.y, area.z),
            swum: Vector3::new(
                stroke.displacement.x,
                stroke.displacement.y,
                stroke.rotation,
            ),
        })
    }

    /// ∬ H by Green's theorem: ∮ G dφ₂ with ∂G/∂φ₁ = H.
    fn enclosed(&self, gait: &AnyGait) -> Result<Vector3<f64>, HeightMapError> {
        let potential = self.potentials();
        let (nodes, weights) = gauss(POINTS);
        let (mut sum, mut reach) = (Vector3::zeros(), 0.0_f64);
        let mut from = 0.0;
        for piece in 0..gait.pieces() {
            let to = gait.piece_end(piece);
            let panels = ((to - from) * PANELS).ceil().max(1.0);
            let width = (to - from) / panels;
            let mut panel = 0.0;
            while panel < panels {
                let left = from + panel * width;
                for (s, w) in nodes.iter().zip(&weights) {
                    let point = gait.at(left + 0.5 * (s + 1.0) * width);
                    reach = reach.max(point.phi.amax());
                    sum += potential.at(&(point.phi / self.half_width))
                        * (0.5 * w * width * point.rate.y);
                }
                panel += 1.0;
            }
            from = to;
        }
        if reach <= self.half_width * (1.0 + 1e-9) && sum.iter().all(|part| part.is_finite()) {
            Ok(sum * self.half_width)
        } else {
            Err(HeightMapError::GaitBeyondMap {
                reach,
                half_width: self.half_width,
            })
        }
    }

    fn potentials(&self) -> Potentials {
        let order = (self.convergence.order + MORE).min(HIGHEST - 1);
        let (nodes, weights) = gauss(order + MORE);
        let (p, _) = table(&nodes, order);
        let weighted = weighed(&p, &weights);
        let rows = [Row::X, Row::Y, Row::Theta].map(|row| {
            let heights = self.on_nodes(row, &nodes, &nodes);
            let coefficients = &weighted * heights * weighted.transpose();
            integrated(&coefficients)
        });
        Potentials { rows }
    }
}

/// For each row of H a function G with ∂G/∂s₁ = H, in products of orthonormal Legendre polynomials.
struct Potentials {
    rows: [Field; 3],
}

impl Potentials {
    fn at(&self, s: &Vector2<f64>) -> Vector3<f64> {
        let ([mut p1, mut p2], mut d) = ([[0.0; HIGHEST]; 2], [0.0; HIGHEST]);
        let shape = self.rows[0].shape();
        let (n1, n2) = (shape.0.min(HIGHEST), shape.1.min(HIGHEST));
        polynomials(s.x, &mut p1[..n1], &mut d[..n1]);
        polynomials(s.y, &mut p2[..n2], &mut d[..n2]);
        let mut values = Vector3::zeros();
        for (value, row) in values.iter_mut().zip(&self.rows) {
            for (column, p2) in row.column_iter().zip(&p2) {
                let along: f64 = column.iter().zip(&p1).map(|(c, p1)| c * p1).sum();
                *value += along * p2;
            }
        }
        values
    }
}

/// Coefficients of an integral along s₁: ∫P_k = (P_{k+1} − P_{k−1}) / (2k + 1).
fn integrated(coefficients: &Field) -> Field {
    let mut integral = DMatrix::zeros(coefficients.nrows() + 1, coefficients.ncols());
    for (k, row) in coefficients.row_iter().enumerate() {
        let norm = |k: usize| (k as f64 + 0.5).sqrt();
        let share = norm(k) / (2 * k + 1) as f64;
        let mut above = integral.row_mut(k + 1);
        above += row * (share / norm(k + 1));
        if k > 0 {
            let mut below = integral.row_mut(k - 1);
            below -= row * (share / norm(k - 1));
        }
    }
    integral
}
