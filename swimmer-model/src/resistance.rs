//! Grand resistance matrix at θ = 0 as trigonometric polynomials.
//!
//! Seen from the middle link, a side link of length l at angle φ has the body/body block M, the body/joint block n and
//! the joint/joint block u, all linear in five functions of φ. With the link's tensor (k_t, k_n, k_r), h = l₀/2 and b = l/2:
//!
//! ```text
//! p = k_t cos² + k_n sin²    r = (k_t − k_n) cos sin    e = k_n b sin
//! q = k_t sin² + k_n cos²                               f = k_n b cos       u = k_r + k_n b²
//!
//!     ⎡ p   r   h r − e         ⎤        ⎡ −e      ⎤
//! M = ⎢ ·   q   h q + f         ⎥    n = ⎢ f       ⎥
//!     ⎣ ·   ·   h² q + 2h f + u ⎦        ⎣ h f + u ⎦
//! ```
//!
//! In a viscous fluid k_t = c_t l, k_n = c_n l and k_r = c_n l³/12, so u = k_n l²/3. Because p′ = −2r, q′ = 2r, r′ = p − q, e′ = f, f′ = −e and u′ = 0, a derivative of the block is the same block of
//! differentiated coefficients: exact derivatives of any order cost no new formula. The back link is the front link
//! seen in the mirror x → −x, that is with the body velocities (x, θ) negated.

use crate::{LinkTensor, Scalar};
use nalgebra::Vector3;

/// A symmetric 3×3 matrix by its upper triangle, rows and columns (x, y, θ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Symmetric3<T> {
    pub(crate) xx: T,
    pub(crate) xy: T,
    pub(crate) xz: T,
    pub(crate) yy: T,
    pub(crate) yz: T,
    pub(crate) zz: T,
}

impl<T: Scalar> Symmetric3<T> {
    pub(crate) fn diagonal(xx: T, yy: T, zz: T) -> Self {
        let zero = T::zero();
        Self {
            xx,
            xy: zero,
            xz: zero,
            yy,
            yz: zero,
            zz,
        }
    }

    #[inline(always)]
    pub(crate) fn plus(&self, o: &Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            yy: self.yy + o.yy,
            yz: self.yz + o.yz,
            zz: self.zz + o.zz,
        }
    }

    #[inline(always)]
    pub(crate) fn times(&self, v: &Vector3<T>) -> Vector3<T> {
        Vector3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    /// L D Lᵀ of a positive definite matrix: backward stable whatever the units of the rows.
    #[inline(always)]
    pub(crate) fn factorise(&self) -> Factors3<T> {
        let one = T::one();
        let inv_x = one / self.xx;
        let (yx, zx) = (self.xy * inv_x, self.xz * inv_x);
        let inv_y = one / (self.yy - yx * self.xy);
        let rest = self.yz - zx * self.xy;
        let zy = rest * inv_y;
        let inv_z = one / (self.zz - zx * self.xz - zy * rest);
        Factors3 {
            yx,
            zx,
            zy,
            inv_x,
            inv_y,
            inv_z,
        }
    }
}

/// L (unit lower triangular, three entries) and D⁻¹ of a symmetric matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors3<T> {
    yx: T,
    zx: T,
    zy: T,
    inv_x: T,
    inv_y: T,
    inv_z: T,
}

impl<T: Scalar> Factors3<T> {
    /// −M⁻¹ v, the body velocity that balances the generalised force v.
    #[inline(always)]
    pub(crate) fn balance(&self, v: &Vector3<T>) -> Vector3<T> {
        let y = v.y - self.yx * v.x;
        let z = v.z - self.zx * v.x - self.zy * y;
        let z = -z * self.inv_z;
        let y = -y * self.inv_y - self.zy * z;
        let x = -v.x * self.inv_x - self.yx * y - self.zx * z;
        Vector3::new(x, y, z)
    }

    /// The same of two forces.
    #[inline(always)]
    pub(crate) fn both(&self, [one, two]: &[Vector3<T>; 2]) -> [Vector3<T>; 2] {
        [self.balance(one), self.balance(two)]
    }
}

/// A side link's constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SideLink<T> {
    tangential: T,
    normal: T,
    /// k_n b
    lever: T,
    /// u = k_r + k_n b²
    hinge: T,
    /// h = l₀/2
    arm: T,
    /// b = l/2
    half: T,
    /// Roots of k_t, k_n and k_r.
    roots: Vector3<T>,
    /// −1 for the back link: the mirror x → −x.
    mirror: T,
}

/// The five functions p, q, r, e, f and the constant u of a side link at one angle, or a derivative of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms<T> {
    p: T,
    q: T,
    r: T,
    e: T,
    f: T,
    u: T,
}

/// Blocks M (body/body) and n (body/joint) of one side link, in the body frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks<T> {
    pub(crate) body: Symmetric3<T>,
    pub(crate) joint: Vector3<T>,
}

impl<T: Scalar> Terms<T> {
    /// d/dφ of all terms.
    #[inline(always)]
    pub(crate) fn derivative(&self) -> Self {
        let twice_r = self.r + self.r;
        Self {
            p: -twice_r,
            q: twice_r,
            r: self.p - self.q,
            e: self.f,
            f: -self.e,
            u: T::zero(),
        }
    }
}

impl<T: Scalar> SideLink<T> {
    /// Side link with a tensor and a length on a middle link of length `middle`; `mirror` is −1 for the back link and 1 for the
    /// front one.
    pub(crate) fn new(tensor: &LinkTensor<T>, length: T, middle: T, mirror: T) -> Self {
        let LinkTensor {
            tangential,
            normal,
            rotational,
        } = *tensor;
        let half = T::from_f64(0.5);
        let lever = normal * length * half;
        Self {
            tangential,
            normal,
            lever,
            hinge: rotational + lever * (length * half),
            arm: middle * half,
            half: length * half,
            roots: Vector3::new(tangential.sqrt(), normal.sqrt(), rotational.sqrt()),
            mirror,
        }
    }

    /// The same for a slender rod in a viscous fluid, k_r = k_n l²/12, whose hinge and root need no sum.
    pub(crate) fn rod(tensor: &LinkTensor<T>, length: T, middle: T, mirror: T) -> Self {
        let mut rod = Self::new(tensor, length, middle, mirror);
        rod.hinge = rod.normal * length * length / T::from_f64(3.0);
        rod.roots.z = length * (rod.normal / T::from_f64(12.0)).sqrt();
        rod
    }

    /// Adds to k_r.
    pub(crate) fn add_rotational(&mut self, more: T) {
        self.hinge += more;
        self.roots.z = (self.roots.z * self.roots.z + more).sqrt();
    }

    /// Tangential, normal and angular velocity of the link's centre for the body velocity `body` and the joint rate `rate`, each
    /// times the root of its resistance. The sum of their squares is the power of the link.
    #[inline(always)]
    pub(crate) fn slips(&self, (sin, cos): (T, T), body: &Vector3<T>, rate: T) -> Vector3<T> {
        let (x, y, turn) = (self.mirror * body.x, body.y, self.mirror * body.z);
        // Velocity of the joint, in the frame mirrored for the back link.
        let (x, y, turn) = (x, y + self.arm * turn, turn + rate);
        Vector3::new(
            self.roots.x * (cos * x + sin * y),
            self.roots.y * (cos * y - sin * x + self.half * turn),
            self.roots.z * turn,
        )
    }

    /// u, the constant joint/joint block: tensor of the link about its joint.
    #[inline(always)]
    pub(crate) fn hinge(&self) -> T {
        self.hinge
    }

    #[inline(always)]
    pub(crate) fn terms(&self, (sin, cos): (T, T)) -> Terms<T> {
        let (sin2, cos2) = (sin * sin, cos * cos);
        Terms {
            p: self.tangential * cos2 + self.normal * sin2,
            q: self.tangential * sin2 + self.normal * cos2,
            r: (self.tangential - self.normal) * cos * sin,
            e: self.lever * sin,
            f: self.lever * cos,
            u: self.hinge,
        }
    }

    #[inline(always)]
    pub(crate) fn blocks(&self, t: &Terms<T>) -> Blocks<T> {
        let (h, s) = (self.arm, self.mirror);
        let hf = h * t.f;
        Blocks {
            body: Symmetric3 {
                xx: t.p,
                xy: s * t.r,
                xz: h * t.r - t.e,
                yy: t.q,
                yz: s * (h * t.q + t.f),
                zz: h * (h * t.q) + (hf + hf) + t.u,
            },
            joint: Vector3::new(-s * t.e, t.f, s * (hf + t.u)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Link, Swimmer};

    /// A rod's tensor in the general formula gives the rod's own numbers.
    #[test]
    fn the_general_side_link_is_the_rod() {
        for swimmer in [Swimmer::<f64>::purcell(), Swimmer::robot_slender()] {
            let (tensor, length) = (swimmer.tensor(Link::Front), swimmer.links.front);
            let general = SideLink::new(&tensor, length, swimmer.links.middle, 1.0);
            let rod = SideLink::rod(&tensor, length, swimmer.links.middle, 1.0);
            assert!((general.hinge / rod.hinge - 1.0).abs() < 1e-15);
            assert!((general.roots - rod.roots).amax() < 1e-15 * rod.roots.amax());
            let mut heavier = rod;
            heavier.add_rotational(rod.roots.z.powi(2));
            assert!((heavier.roots.z / rod.roots.z - 2.0_f64.sqrt()).abs() < 1e-15);
        }
    }
}
