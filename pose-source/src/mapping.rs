//! The source's axes and unit, and the tank's.

use swimmer_files::Axes;

/// Maps the source's axes and unit to the tank's: x, y and height in metres.
///
/// The height runs along the axis that x and y leave, so that x, y and height are right-handed: `z,x` (Y up, Motive's default) has
/// its height along Y.
///
/// ```
/// use pose_source::Mapping;
///
/// let mapping = Mapping::Y_UP;
/// assert_eq!(mapping.position([0.2, 0.05, 0.1]), [0.1, 0.2, 0.05]);
/// assert_eq!(mapping.to_source([0.1, 0.2, 0.05]), [0.2, 0.05, 0.1]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapping {
    /// Axes of the source that are the tank's x and y.
    pub axes: Axes,
    /// Metres per unit of the source.
    pub metres_per_unit: f64,
}

impl Mapping {
    /// Y points up, lengths in metres: Motive's default.
    pub const Y_UP: Self = Self {
        axes: Axes {
            x: (2, false),
            y: (0, false),
        },
        metres_per_unit: 1.0,
    };

    /// Z points up, lengths in metres.
    pub const Z_UP: Self = Self {
        axes: Axes {
            x: (0, false),
            y: (1, false),
        },
        metres_per_unit: 1.0,
    };

    /// The source's axis and sign for x, y and height.
    fn rows(&self) -> [(usize, f64); 3] {
        let sign = |down: bool| if down { -1.0 } else { 1.0 };
        let ((x, x_down), (y, y_down)) = (self.axes.x, self.axes.y);
        let up = 3_usize.saturating_sub(x + y);
        // ex × ey: positive along the third axis if (x, y) are in cyclic order.
        let cyclic = if (x + 1) % 3 == y { 1.0 } else { -1.0 };
        let (sx, sy) = (sign(x_down), sign(y_down));
        [(x, sx), (y, sy), (up, cyclic * sx * sy)]
    }

    fn turned(&self, vector: [f64; 3]) -> [f64; 3] {
        self.rows()
            .map(|(axis, sign)| sign * vector.get(axis).copied().unwrap_or(0.0))
    }

    /// A position of the source in the tank \[m\].
    pub fn position(&self, source: [f64; 3]) -> [f64; 3] {
        self.turned(source)
            .map(|value| value * self.metres_per_unit)
    }

    /// A quaternion (x, y, z, w) of the source in the tank's axes, normalised; `None` if it has no length.
    pub fn quaternion(&self, source: [f64; 4]) -> Option<[f64; 4]> {
        let [x, y, z, w] = source;
        let length = (x * x + y * y + z * z + w * w).sqrt();
        let [x, y, z] = self.turned([x, y, z]);
        (length.is_finite() && length > 1e-6).then(|| [x, y, z, w].map(|value| value / length))
    }

    /// A position in the tank \[m\] in the source's axes and unit.
    pub fn to_source(&self, tank: [f64; 3]) -> [f64; 3] {
        let mut source = [0.0; 3];
        for ((axis, sign), value) in self.rows().into_iter().zip(tank) {
            if let Some(place) = source.get_mut(axis) {
                *place = sign * value / self.metres_per_unit;
            }
        }
        source
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_stay_right_handed() {
        for text in ["x,y", "y,z", "z,x", "y,x", "x,-y", "-x,-y", "z,y", "-z,x"] {
            let mapping = Mapping {
                axes: text.parse().unwrap(),
                metres_per_unit: 2.0,
            };
            let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(|unit| mapping.position(unit));
            let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
                - b[0] * (a[1] * c[2] - a[2] * c[1])
                + c[0] * (a[1] * b[2] - a[2] * b[1]);
            assert!((determinant - 8.0).abs() < 1e-12, "{text}: {determinant}");
            let there = [0.3, -0.2, 0.1];
            let back = mapping.position(mapping.to_source(there));
            for (there, back) in there.iter().zip(back) {
                assert!((there - back).abs() < 1e-12, "{text}");
            }
        }
    }

    /// A turn about the source's vertical is a turn about the tank's height.
    #[test]
    fn a_turn_about_the_vertical_stays_one() {
        let half = 0.3_f64;
        let turned = Mapping::Y_UP.quaternion([0.0, half.sin(), 0.0, half.cos()]);
        assert_eq!(turned, Some([0.0, 0.0, half.sin(), half.cos()]));
        assert_eq!(Mapping::Z_UP.quaternion([0.0; 4]), None);
    }
}
