//! Area rule: displacement of a gait estimated by the area integral of the height functions, against its exact displacement.
//!
//! The area integral is the first term of the Baker–Campbell–Hausdorff series of the net displacement. The following terms are
//! commutators of motions at different times, and grow with the rotation and sway of the frame. Minimum-perturbation coordinates
//! make them small but not zero: the rule is accurate for gaits up to about a radian, and a rough estimate for larger ones. The
//! row θ is exact, because rotations in the plane commute.

use nalgebra::{DMatrix, Rotation2, Vector2, Vector3};
use swimmer_files::AnyGait;
use swimmer_model::{Gait as _, Tolerance, swim};

use super::legendre::{gauss, polynomials};
use super::space::{Field, table, weighed};
use super::{HIGHEST, HeightMap, HeightMapError, Row};

/// Estimated and exact displacement of a gait: (x, y, θ) over L and in rad, along and across the middle link at the gait's first
/// shape.
///
/// The frame of the map may be rotated against the middle link there, so the estimate is transformed. The transformation is the
/// identity for equal side links and a gait that starts at φ₁ = φ₂ and has no net rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaRule {
    /// ∬ H over the enclosed area, weighted by the winding number (counter-clockwise positive) and transformed from the map's frame to
    /// the middle link.
    pub area: Vector3<f64>,
    /// Net displacement of one cycle.
    pub swum: Vector3<f64>,
}

/// Number of polynomials for the heights beyond the order of the frame, since the curvature is less smooth than the connection.
const MORE: usize = 16;
/// Least number of panels per cycle.
const PANELS: f64 = 256.0;
const POINTS: usize = 6;

impl AreaRule {
    /// Error of the rule: estimated minus exact displacement.
    pub fn deviation(&self) -> Vector3<f64> {
        self.area - self.swum
    }
}

impl HeightMap {
    /// Compares the area rule with the exact displacement of a closed gait, which may cross itself.
    ///
    /// # Errors
    /// [`HeightMapError::GaitBeyondMap`].
    pub fn area_rule(&self, gait: &AnyGait) -> Result<AreaRule, HeightMapError> {
        let first = gait.at(0.0).phi;
        let area = self.enclosed(gait)?;
        let stroke = swim(self.model(), gait, &Tolerance::default());
        // Conjugation h a h⁻¹ of the net motion a by the frame h.
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

/// Functions G with ∂G/∂s₁ = H for each row of H, in products of orthonormal Legendre polynomials.
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
