//! The swimmer's own force balance, from the paper: resistive force theory for three links and Stokes' drag for the sphere.
//!
//! Written from the printed formulas (Section II) and not from `swimmer-model`: each link adds the squares of its tangential,
//! normal and angular velocity, which are linear in (ẋ, ẏ, θ̇, φ̇₁, φ̇₂), to one resistance of five by five. Its first three rows
//! say that force and torque vanish. Resistances are in units of 2πμ.

use super::walls;

/// Three links and a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Body {
    /// l₀ \[m\].
    pub(crate) middle: f64,
    /// l₁ \[m\].
    pub(crate) front: f64,
    /// l₂ \[m\].
    pub(crate) back: f64,
    /// c_n over c_t.
    pub(crate) chi: f64,
    /// c_t over 2πμ, one for all links.
    pub(crate) c_t: f64,
    /// r_s \[m\].
    pub(crate) sphere: f64,
    /// Rotational drag of the float over that of the sphere.
    pub(crate) turning: f64,
}

/// The connection: velocities (ẋ, ẏ, θ̇) in the middle link's frame for each joint's unit rate.
pub(crate) type Connection = [[f64; 2]; 3];

impl Body {
    /// The paper's robot with another drag than the paper's.
    pub(crate) const ROBOT: Self = Self {
        middle: 0.071,
        front: 0.137,
        back: 0.137,
        chi: 2.93,
        c_t: 1.0 / 4.543,
        sphere: 0.0545,
        turning: 1.0,
    };

    pub(crate) const PURCELL: Self = Self {
        middle: 1.0,
        front: 1.0,
        back: 1.0,
        chi: 2.0,
        c_t: 1.0,
        sphere: 0.0,
        turning: 1.0,
    };

    pub(crate) fn length(&self) -> f64 {
        self.middle + self.front + self.back
    }

    /// The resistance to (ẋ, ẏ, θ̇, φ̇₁, φ̇₂) at θ = 0.
    fn resistance(&self, phi: [f64; 2]) -> [[f64; 5]; 5] {
        let half = self.middle / 2.0;
        let mut sum = [[0.0; 5]; 5];
        // Sphere: 6πμr and 8πμr³.
        let r = self.sphere;
        (sum[0][0], sum[1][1], sum[2][2]) = (3.0 * r, 3.0 * r, 4.0 * r * r * r * self.turning);
        let mut add = |weight: f64, velocity: [f64; 5]| {
            for (row, v) in sum.iter_mut().zip(velocity) {
                for (entry, w) in row.iter_mut().zip(velocity) {
                    *entry += weight * v * w;
                }
            }
        };
        // Length, direction, hinge on the middle link, and the joint rates' share in the turn.
        let links = [
            (self.middle, 0.0, None),
            (self.front, phi[0], Some((half, [1.0, 0.0]))),
            (
                self.back,
                std::f64::consts::PI - phi[1],
                Some((-half, [0.0, -1.0])),
            ),
        ];
        for (length, direction, hinge) in links {
            let (sin, cos) = direction.sin_cos();
            let (hinge_x, share) = hinge.unwrap_or((0.0, [0.0; 2]));
            let arm = if hinge.is_some() { length / 2.0 } else { 0.0 };
            // The hinge moves with (ẋ, ẏ + θ̇ hinge_x); the link's turn adds arm·ω across the link.
            let along = [cos, sin, sin * hinge_x, 0.0, 0.0];
            let across = [
                -sin,
                cos,
                cos * hinge_x + arm,
                arm * share[0],
                arm * share[1],
            ];
            let turn = [0.0, 0.0, 1.0, share[0], share[1]];
            let (tangential, normal) = (self.c_t * length, self.c_t * self.chi * length);
            add(tangential, along);
            add(normal, across);
            add(normal * length * length / 12.0, turn);
        }
        sum
    }

    pub(crate) fn connection(&self, phi: [f64; 2]) -> Connection {
        balanced(&self.resistance(phi))
    }

    /// At a pose in a tank of this size about the origin.
    pub(crate) fn connection_in(
        &self,
        phi: [f64; 2],
        pose: [f64; 3],
        size: [f64; 2],
    ) -> Connection {
        let mut k = self.resistance(phi);
        let change = walls::change(self, phi, pose, size);
        for (entry, more) in k.iter_mut().flatten().zip(change.into_iter().flatten()) {
            *entry += more;
        }
        balanced(&k)
    }

    /// The power of two sets of joint rates, which makes W.
    pub(crate) fn power(&self, phi: [f64; 2], rates: [f64; 2], other: [f64; 2]) -> f64 {
        let a = self.connection(phi);
        let full = |rates: [f64; 2]| {
            let body = a.map(|row| row[0] * rates[0] + row[1] * rates[1]);
            [body[0], body[1], body[2], rates[0], rates[1]]
        };
        let (v, w) = (full(rates), full(other));
        let k = self.resistance(phi);
        (0..5)
            .flat_map(|i| (0..5).map(move |j| (i, j)))
            .map(|(i, j)| v[i] * k[i][j] * w[j])
            .sum()
    }
}

/// Motion without force and torque.
fn balanced(k: &[[f64; 5]; 5]) -> Connection {
    // Gauss' elimination of a symmetric positive matrix needs no pivots.
    let mut rows: [[f64; 5]; 3] = [k[0], k[1], k[2]];
    for pivot in 0..3 {
        for below in pivot + 1..3 {
            let factor = rows[below][pivot] / rows[pivot][pivot];
            let from = rows[pivot];
            for (entry, value) in rows[below].iter_mut().zip(from) {
                *entry -= factor * value;
            }
        }
    }
    let mut a = [[0.0; 2]; 3];
    for joint in 0..2 {
        for row in (0..3).rev() {
            let mut rest = -rows[row][3 + joint];
            for known in row + 1..3 {
                rest -= rows[row][known] * a[known][joint];
            }
            a[row][joint] = rest / rows[row][row];
        }
    }
    a
}
