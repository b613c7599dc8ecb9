//! Orientation of rigid bodies: quaternions, rotation matrices, rotation vectors, Euler angles and a lone yaw angle, as one
//! unit quaternion.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Tolerance of a quaternion's norm and of the columns of a rotation matrix: files have four digits at least.
const TOLERANCE: f64 = 0.02;

/// Columns that hold an orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rotation {
    /// x, y, z, w.
    Quaternion([usize; 4]),
    /// Columns of the matrix, one after the other: Rot\[0\], Rot\[1\], … of Qualisys.
    Matrix([usize; 9]),
    /// A vector along the axis, as long as the angle (Vicon); the factor makes radians.
    Vector([usize; 3], f64),
    /// Angles about the body's x, y and z, applied in this order of axes; the factor makes radians.
    Euler([usize; 3], [usize; 3], f64),
    /// The angle about z, with the factor that makes radians.
    Yaw(usize, f64),
}

impl Rotation {
    /// The orientation (x, y, z, w) by the cells of a row. `None` if a cell is missing, or if they are no rotation, such as the zeros
    /// that stand for a lost body.
    ///
    /// # Errors
    /// Those of `cell`.
    pub(super) fn read<E>(
        &self,
        mut cell: impl FnMut(usize) -> Result<Option<f64>, E>,
    ) -> Result<Option<[f64; 4]>, E> {
        let mut values = [0.0; 9];
        let columns = self.columns();
        for (value, column) in values.iter_mut().zip(columns) {
            let Some(found) = cell(*column)? else {
                return Ok(None);
            };
            *value = found;
        }
        Ok(self.turn(&values))
    }

    /// Its columns, in order.
    pub(super) fn columns(&self) -> &[usize] {
        match self {
            Self::Quaternion(columns) => columns,
            Self::Matrix(columns) => columns,
            Self::Vector(columns, _) | Self::Euler(columns, ..) => columns,
            Self::Yaw(column, _) => std::slice::from_ref(column),
        }
    }

    fn turn(&self, values: &[f64; 9]) -> Option<[f64; 4]> {
        let [a, b, c, d, ..] = *values;
        let turn = match self {
            Self::Quaternion(_) => return normalized([a, b, c, d]),
            Self::Matrix(_) => {
                let matrix = Matrix3::from_column_slice(values);
                let off = (matrix.transpose() * matrix - Matrix3::identity())
                    .abs()
                    .max();
                if off > TOLERANCE || matrix.determinant() < 0.0 {
                    return None;
                }
                UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix))
            }
            Self::Vector(_, radians) => {
                UnitQuaternion::from_scaled_axis(Vector3::new(a, b, c) * *radians)
            }
            Self::Euler(_, order, radians) => {
                order.iter().fold(UnitQuaternion::identity(), |turn, axis| {
                    let angle = values.get(*axis).copied().unwrap_or(0.0) * radians;
                    let mut vector = Vector3::zeros();
                    if let Some(slot) = vector.get_mut(*axis) {
                        *slot = angle;
                    }
                    turn * UnitQuaternion::from_scaled_axis(vector)
                })
            }
            Self::Yaw(_, radians) => UnitQuaternion::from_scaled_axis(Vector3::z() * (a * radians)),
        };
        let [x, y, z, w] = turn.coords.into();
        Some([x, y, z, w])
    }
}

/// A quaternion (x, y, z, w) of length 1; `None` if it is far from that.
pub(super) fn normalized(turn: [f64; 4]) -> Option<[f64; 4]> {
    let norm = turn.iter().map(|value| value * value).sum::<f64>().sqrt();
    ((norm - 1.0).abs() < TOLERANCE).then(|| turn.map(|value| value / norm))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn of 0.4 rad about z as every kind writes it.
    #[test]
    fn every_kind_says_the_same() {
        let (s, c) = 0.4_f64.sin_cos();
        let (hs, hc) = 0.2_f64.sin_cos();
        let degrees = 0.4_f64.to_degrees();
        let rad = 1_f64.to_radians();
        let columns = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        let cases: [(Rotation, Vec<f64>); 6] = [
            (Rotation::Quaternion([0, 1, 2, 3]), vec![0.0, 0.0, hs, hc]),
            (Rotation::Quaternion([0, 1, 2, 3]), vec![0.0, 0.0, -hs, -hc]),
            (
                Rotation::Matrix(columns),
                vec![c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0],
            ),
            (Rotation::Vector([0, 1, 2], rad), vec![0.0, 0.0, degrees]),
            (
                Rotation::Euler([0, 1, 2], [2, 1, 0], rad),
                vec![0.0, 0.0, degrees],
            ),
            (Rotation::Yaw(0, 1.0), vec![0.4]),
        ];
        for (rotation, cells) in cases {
            let read = rotation.read(|column| Ok::<_, ()>(cells.get(column).copied()));
            let [x, y, z, w] = read.unwrap().unwrap();
            let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            let along = turn * Vector3::x();
            assert!(
                (along - Vector3::new(c, s, 0.0)).norm() < 1e-12,
                "{rotation:?}: {along}"
            );
        }
    }

    #[test]
    fn zeros_are_no_rotation() {
        for rotation in [
            Rotation::Quaternion([0, 1, 2, 3]),
            Rotation::Matrix([0, 1, 2, 3, 4, 5, 6, 7, 8]),
        ] {
            assert_eq!(rotation.read(|_| Ok::<_, ()>(Some(0.0))), Ok(None));
        }
    }
}
