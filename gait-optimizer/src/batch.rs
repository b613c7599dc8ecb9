//! A and W at many shapes at once: structure of arrays in, structure of arrays out.
//!
//! [`swimmer_model::Model`] is the truth; here its formulas stand once more without a branch, for a loop that the compiler turns
//! into vector instructions. Which of them the machine has is asked when a batch is made. A test holds each entry against the model.

// What is not inlined is compiled for the least of machines, without its vector instructions.
#![allow(clippy::inline_always)]

mod sine;

use sine::sin_cos;
use swimmer_model::{InvalidSwimmer, Swimmer};

/// A swimmer's model for many shapes at once.
///
/// ```
/// use gait_optimizer::{Batch, ConnectionsAndPowers};
/// use swimmer_model::{Model, Swimmer};
///
/// let batch = Batch::new(&Swimmer::purcell())?;
/// let (phi1, phi2) = ([0.1, 0.7, 1.3], [0.4, -0.2, 2.0]);
/// let mut found = ConnectionsAndPowers::default();
/// batch.connections_and_powers(&phi1, &phi2, &mut found);
/// let one = Model::new(&Swimmer::purcell())?.local_connection(&[0.7, -0.2].into());
/// assert!((found.connection[0][1] - one[(0, 0)]).abs() < 1e-15);
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Batch {
    middle: [f64; 3],
    sides: [Side; 2],
    machine: pulp::Arch,
}

/// A and W at many shapes, entry by entry.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConnectionsAndPowers {
    /// A row by row: x, y \[m\] and θ, each for φ̇₁ and φ̇₂.
    pub connection: [Vec<f64>; 6],
    /// W₁₁, W₁₂, W₂₂ over μ \[m³\].
    pub power: [Vec<f64>; 3],
}

/// A side link: `swimmer_model`'s resistance block in numbers.
#[derive(Debug, Clone, Copy)]
struct Side {
    tangential: f64,
    normal: f64,
    lever: f64,
    hinge: f64,
    arm: f64,
    half: f64,
    roots: [f64; 3],
    /// 1 in front, −1 at the back.
    mirror: f64,
}

impl Side {
    fn new(drag: f64, chi: f64, length: f64, middle: f64, mirror: f64) -> Self {
        let tangential = drag * length;
        let normal = chi * tangential;
        Self {
            tangential,
            normal,
            lever: 0.5 * normal * length,
            hinge: normal * length * length / 3.0,
            arm: 0.5 * middle,
            half: 0.5 * length,
            roots: [
                tangential.sqrt(),
                normal.sqrt(),
                length * (normal / 12.0).sqrt(),
            ],
            mirror,
        }
    }

    /// The body/body block (xx, xy, xz, yy, yz, zz) and the body/joint block.
    #[inline(always)]
    fn blocks(&self, (sin, cos): (f64, f64)) -> ([f64; 6], [f64; 3]) {
        let (h, m) = (self.arm, self.mirror);
        let (sin2, cos2) = (sin * sin, cos * cos);
        let p = self.tangential * cos2 + self.normal * sin2;
        let q = self.tangential * sin2 + self.normal * cos2;
        let r = (self.tangential - self.normal) * cos * sin;
        let (e, f, u) = (self.lever * sin, self.lever * cos, self.hinge);
        (
            [
                p,
                m * r,
                h * r - e,
                q,
                m * (h * q + f),
                h * h * q + 2.0 * h * f + u,
            ],
            [-m * e, f, m * (h * f + u)],
        )
    }

    /// Velocities across and along the link, and its turning, each times the root of its resistance.
    #[inline(always)]
    fn slips(&self, (sin, cos): (f64, f64), body: [f64; 3], rate: f64) -> [f64; 3] {
        let turn = self.mirror * body[2];
        let (x, y) = (self.mirror * body[0], body[1] + self.arm * turn);
        let turn = turn + rate;
        [
            self.roots[0] * (cos * x + sin * y),
            self.roots[1] * (cos * y - sin * x + self.half * turn),
            self.roots[2] * turn,
        ]
    }
}

/// Shapes that are looked at together.
const WIDTH: usize = 16;
/// Entries of A and of W.
const ENTRIES: usize = 9;

impl Batch {
    /// Of a swimmer.
    ///
    /// # Errors
    /// As [`swimmer_model::Model::new`].
    pub fn new(swimmer: &Swimmer<f64>) -> Result<Self, InvalidSwimmer> {
        use std::f64::consts::PI;
        swimmer.validate()?;
        let (links, chi, radius) = (swimmer.links, swimmer.chi, swimmer.sphere_radius);
        let drag = |length| swimmer.tangential_drag.over_viscosity(length);
        let l0 = links.middle;
        let tangential = drag(l0) * l0;
        let sphere = 6.0 * PI * radius;
        let side = |length, mirror| Side::new(drag(length), chi, length, l0, mirror);
        Ok(Self {
            middle: [
                tangential + sphere,
                chi * tangential + sphere,
                chi * tangential * l0 * l0 / 12.0 + 8.0 * PI * radius.powi(3),
            ],
            sides: [side(links.front, 1.0), side(links.back, -1.0)],
            machine: pulp::Arch::new(),
        })
    }

    /// A and W at the shapes (φ₁, φ₂) \[rad\], |φ| ≤ 10⁴: as many as the shorter list has. What `found` had is replaced, its memory
    /// kept.
    pub fn connections_and_powers(
        &self,
        phi1: &[f64],
        phi2: &[f64],
        found: &mut ConnectionsAndPowers,
    ) {
        let count = phi1.len().min(phi2.len());
        for entries in found.connection.iter_mut().chain(&mut found.power) {
            entries.clear();
            entries.resize(count, 0.0);
        }
        self.machine.dispatch(Shapes {
            batch: self,
            phi: [&phi1[..count], &phi2[..count]],
            found,
        });
    }

    #[inline(always)]
    fn some(&self, phi1: &[f64; WIDTH], phi2: &[f64; WIDTH]) -> [[f64; WIDTH]; ENTRIES] {
        let mut found = [[0.0; WIDTH]; ENTRIES];
        let [a0, a1, a2, a3, a4, a5, w0, w1, w2] = &mut found;
        for k in 0..WIDTH {
            let e = self.one(phi1[k], phi2[k]);
            a0[k] = e[0];
            a1[k] = e[1];
            a2[k] = e[2];
            a3[k] = e[3];
            a4[k] = e[4];
            a5[k] = e[5];
            w0[k] = e[6];
            w1[k] = e[7];
            w2[k] = e[8];
        }
        found
    }

    #[inline(always)]
    fn one(&self, phi1: f64, phi2: f64) -> [f64; ENTRIES] {
        let turns = [sin_cos(phi1), sin_cos(phi2)];
        let [front, back] = &self.sides;
        let ((m1, n1), (m2, n2)) = (front.blocks(turns[0]), back.blocks(turns[1]));
        let [xx, yy, zz] = self.middle;
        let xx = xx + m1[0] + m2[0];
        let xy = m1[1] + m2[1];
        let xz = m1[2] + m2[2];
        let yy = yy + m1[3] + m2[3];
        let yz = m1[4] + m2[4];
        let zz = zz + m1[5] + m2[5];
        let inv_x = 1.0 / xx;
        let (yx, zx) = (xy * inv_x, xz * inv_x);
        let inv_y = 1.0 / (yy - yx * xy);
        let rest = yz - zx * xy;
        let zy = rest * inv_y;
        let inv_z = 1.0 / (zz - zx * xz - zy * rest);
        let balance = |v: [f64; 3]| {
            let y = v[1] - yx * v[0];
            let z = -(v[2] - zx * v[0] - zy * y) * inv_z;
            let y = -y * inv_y - zy * z;
            [-v[0] * inv_x - yx * y - zx * z, y, z]
        };
        let (a, b) = (balance(n1), balance(n2));
        let [s11, s12] = [front.slips(turns[0], a, 1.0), front.slips(turns[0], b, 0.0)];
        let [s21, s22] = [back.slips(turns[1], a, 0.0), back.slips(turns[1], b, 1.0)];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let [mx, my, mz] = self.middle;
        let middle =
            |a: [f64; 3], b: [f64; 3]| mx * a[0] * b[0] + my * a[1] * b[1] + mz * a[2] * b[2];
        [
            a[0],
            b[0],
            a[1],
            b[1],
            a[2],
            b[2],
            middle(a, a) + dot(s11, s11) + dot(s21, s21),
            middle(a, b) + dot(s11, s12) + dot(s21, s22),
            middle(b, b) + dot(s12, s12) + dot(s22, s22),
        ]
    }
}

/// Shapes to be looked at, for whatever instructions there are.
struct Shapes<'a> {
    batch: &'a Batch,
    /// As many of each.
    phi: [&'a [f64]; 2],
    found: &'a mut ConnectionsAndPowers,
}

impl pulp::WithSimd for Shapes<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let [phi1, phi2] = self.phi;
        for from in (0..phi1.len()).step_by(WIDTH) {
            let range = from..phi1.len().min(from + WIDTH);
            let load = |phi: &[f64]| {
                let mut shapes = [0.0; WIDTH];
                shapes[..range.len()].copy_from_slice(&phi[range.clone()]);
                shapes
            };
            let entries = self.batch.some(&load(phi1), &load(phi2));
            let all = self
                .found
                .connection
                .iter_mut()
                .chain(&mut self.found.power);
            for (kept, entry) in all.zip(&entries) {
                kept[range.clone()].copy_from_slice(&entry[..range.len()]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use proptest::prelude::*;
    use swimmer_model::Model;

    use super::*;

    proptest! {
        #[test]
        fn many_are_as_one(
            shapes in prop::collection::vec((-7.0..7.0_f64, -7.0..7.0_f64), 0..40),
            robot in any::<bool>(),
        ) {
            let swimmer = if robot { Swimmer::robot() } else { Swimmer::purcell() };
            let (phi1, phi2): (Vec<f64>, Vec<f64>) = shapes.iter().copied().unzip();
            let mut found = ConnectionsAndPowers::default();
            Batch::new(&swimmer).unwrap().connections_and_powers(&phi1, &phi2, &mut found);
            let model = Model::new(&swimmer).unwrap();
            for (at, (phi1, phi2)) in shapes.into_iter().enumerate() {
                let (a, w) = model.connection_and_power(&Vector2::new(phi1, phi2));
                let one = [a.m11, a.m12, a.m21, a.m22, a.m31, a.m32, w.m11, w.m12, w.m22];
                let all = found.connection.iter().chain(&found.power);
                let scales = [[a.amax(); 6].as_slice(), &[w.amax(); 3]].concat();
                for ((many, one), scale) in all.zip(one).zip(scales) {
                    prop_assert!((many[at] - one).abs() <= 1e-14 * scale, "{} {one}", many[at]);
                }
            }
        }

        #[test]
        fn sine_and_cosine_are_libms(angle in -100.0..100.0_f64) {
            let (sin, cos) = sin_cos(angle);
            let (s, c) = swimmer_model::Scalar::sin_cos(angle);
            prop_assert!((sin - s).abs() <= 2e-16 && (cos - c).abs() <= 2e-16);
        }
    }

    #[test]
    fn the_shorter_list_counts_and_what_is_no_angle_gives_no_number() {
        let mut found = ConnectionsAndPowers::default();
        let batch = Batch::new(&Swimmer::purcell()).unwrap();
        batch.connections_and_powers(&[0.3, f64::NAN], &[0.5, 0.5, 0.5], &mut found);
        assert_eq!(found.connection[0].len(), 2);
        assert!(found.power[0][0] > 0.0 && found.connection[0][1].is_nan());
    }
}
