//! The plane that the reflectors move in, found from their positions: the exporter can permute axes, and the file does not
//! say so.

use nalgebra::{Matrix3, SymmetricEigen, Vector2, Vector3};
use swimmer_files::Axes;

/// A plane with its own x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Its normal, towards the positive side of the file's axis that it is nearest to.
    pub normal: Vector3<f64>,
    /// Direction of x in the file's axes.
    pub x: Vector3<f64>,
    /// Direction of y; x, y and the normal are right-handed.
    pub y: Vector3<f64>,
    /// Root mean square distance of the points from it \[m\].
    pub rms_m: f64,
    /// `true` if the points determine the plane; if not, it is the coordinate plane that they leave least.
    pub fitted: bool,
    /// The file's axes that are nearest to x, y and the normal: `(x, y) = (Z, X), normal Y`.
    pub map: String,
}

/// Spread along the plane's second direction over that across it, below which the points do not show the plane.
const DETERMINED: f64 = 3.0;

impl Plane {
    /// The plane of least squares. With Y up (Motive) x is nearest to Z and y to X, with Z up they are X and Y; `axes` say
    /// otherwise.
    pub fn fit(points: &[Vector3<f64>], axes: Option<Axes>) -> Self {
        let count = points.len().max(1) as f64;
        let centre = points.iter().sum::<Vector3<f64>>() / count;
        let mut covariance = Matrix3::zeros();
        for point in points {
            let d = point - centre;
            covariance += d * d.transpose();
        }
        covariance /= count;
        let eigen = SymmetricEigen::new(covariance);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let spread = order.map(|i| eigen.eigenvalues[i].max(0.0).sqrt());
        // Rounding leaves 1e-16 of the longest direction.
        let fitted = spread[1] > DETERMINED * spread[0] && spread[1] > 1e-9 * spread[2];
        let normal = if fitted {
            eigen.eigenvectors.column(order[0]).into_owned()
        } else {
            let flattest = (0..3)
                .min_by(|a, b| covariance[(*a, *a)].total_cmp(&covariance[(*b, *b)]))
                .unwrap_or(2);
            Vector3::ith(flattest, 1.0)
        };
        let rms_m = normal.dot(&(covariance * normal)).max(0.0).sqrt();
        let up = normal.iamax();
        // Right-handed: the third axis follows from the first two.
        let axes = axes.filter(|axes| axes.x.0 != up && axes.y.0 != up);
        let axes = axes.unwrap_or(Axes {
            x: ((up + 1) % 3, false),
            y: ((up + 2) % 3, false),
        });
        Self::new(normal, rms_m, fitted, axes)
    }

    fn new(normal: Vector3<f64>, rms_m: f64, fitted: bool, axes: Axes) -> Self {
        let [ex, ey] =
            [axes.x, axes.y].map(|(axis, down)| Vector3::ith(axis, if down { -1.0 } else { 1.0 }));
        let up = ex.cross(&ey);
        let normal = normal * normal.dot(&up).signum();
        let x = (ex - normal * normal.dot(&ex)).normalize();
        let letters = |v: Vector3<f64>| {
            let axis = v.iamax();
            let letter = ["X", "Y", "Z"].get(axis).copied().unwrap_or("?");
            format!("{}{letter}", if v[axis] < 0.0 { "-" } else { "" })
        };
        Self {
            normal,
            x,
            y: normal.cross(&x),
            rms_m,
            fitted,
            map: format!(
                "(x, y) = ({}, {}), normal {}",
                letters(ex),
                letters(ey),
                letters(up)
            ),
        }
    }

    /// A point's x and y in the plane \[m\].
    pub fn project(&self, point: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(self.x.dot(point), self.y.dot(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(place: impl Fn(f64, f64) -> Vector3<f64>) -> Vec<Vector3<f64>> {
        (0..50)
            .map(|i| f64::from(i) * 0.1)
            .map(|a| place(0.3 * a.cos() + 0.1 * a, 0.2 * a.sin()))
            .collect()
    }

    #[test]
    fn y_up_is_seen_from_above() {
        let plane = Plane::fit(&ring(|x, y| Vector3::new(y, 0.04, x)), None);
        assert!(plane.fitted && plane.rms_m < 1e-12);
        let p = plane.project(&Vector3::new(2.0, 0.04, 1.0));
        assert!((p - Vector2::new(1.0, 2.0)).norm() < 1e-12, "{p}");
        assert_eq!(plane.map, "(x, y) = (Z, X), normal Y");
    }

    #[test]
    fn z_up_and_x_up() {
        let plane = Plane::fit(&ring(|x, y| Vector3::new(x, y, 1.0)), None);
        assert!(
            (plane.project(&Vector3::new(1.0, 2.0, 1.0)) - Vector2::new(1.0, 2.0)).norm() < 1e-12
        );
        let plane = Plane::fit(&ring(|x, y| Vector3::new(-1.0, x, y)), None);
        assert!(
            (plane.project(&Vector3::new(-1.0, 1.0, 2.0)) - Vector2::new(1.0, 2.0)).norm() < 1e-12
        );
    }

    #[test]
    fn the_user_may_know_the_axes() {
        // An image: y runs down, and the robot is seen from above.
        let points = ring(|x, y| Vector3::new(x, -y, 0.0));
        let plane = Plane::fit(&points, Some(Axes::IMAGE));
        assert!(
            (plane.project(&Vector3::new(1.0, -2.0, 0.0)) - Vector2::new(1.0, 2.0)).norm() < 1e-12
        );
        assert_eq!(plane.map, "(x, y) = (X, -Y), normal -Z");
        // Axes that do not lie in the plane cannot be meant.
        let plane = Plane::fit(&points, "z,x".parse().ok());
        assert_eq!(plane.map, "(x, y) = (X, Y), normal Z");
    }

    #[test]
    fn a_tilted_plane_keeps_lengths() {
        let tilt = nalgebra::Rotation3::from_euler_angles(0.2, 0.0, 0.1);
        let points = ring(|x, y| tilt * Vector3::new(y, 0.5, x));
        let plane = Plane::fit(&points, None);
        let (a, b) = (points[3], points[40]);
        assert!(((plane.project(&a) - plane.project(&b)).norm() - (a - b).norm()).abs() < 1e-12);
    }

    #[test]
    fn a_line_shows_no_plane() {
        let points: Vec<_> = (0..9)
            .map(|i| {
                Vector3::new(
                    4e-4 * f64::from(i % 2),
                    1e-3 * f64::from(i / 2 % 2),
                    f64::from(i),
                )
            })
            .collect();
        let plane = Plane::fit(&points, None);
        assert!(!plane.fitted);
        assert_eq!(plane.map, "(x, y) = (Y, Z), normal X");
    }
}
