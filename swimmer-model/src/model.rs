//! The swimmer's equations of motion: local connection A(Φ) and power matrix W(Φ), with exact derivatives.
//!
//! The net force and torque on a body that moves with body velocity ξ = (v_x, v_y, θ̇) and joint rates Φ̇ are
//! −(M ξ + N Φ̇); they vanish, so ξ = A Φ̇ with A = −M⁻¹N, and the power is Φ̇ᵀ W Φ̇ with W = U + NᵀA.

use crate::resistance::{Blocks, Factors3, SideLink, Symmetric3, Terms};
use crate::{FirstDerivatives, InvalidSwimmer, Scalar, SecondDerivatives, Swimmer};
use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};

/// A swimmer made ready to compute with: resistance coefficients over μ, worked out once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model<T> {
    swimmer: Swimmer<T>,
    middle: Symmetric3<T>,
    sides: [SideLink<T>; 2],
}

/// Everything at one shape that A, W and their derivatives share.
struct Balance<T> {
    /// Sines and cosines of φ₁, φ₂.
    turns: [(T, T); 2],
    terms: [Terms<T>; 2],
    factors: Factors3<T>,
    /// Columns of A.
    a: [Vector3<T>; 2],
}

impl<T: Scalar> Model<T> {
    /// Prepares the resistance coefficients.
    ///
    /// # Errors
    /// The swimmer's parameters are out of range ([`Swimmer::validate`]).
    pub fn new(swimmer: &Swimmer<T>) -> Result<Self, InvalidSwimmer> {
        swimmer.validate()?;
        let links = swimmer.links;
        let (chi, l0, radius) = (swimmer.chi, links.middle, swimmer.sphere_radius);
        let drag = |length| swimmer.tangential_drag.over_viscosity(length);
        let tangential = drag(l0) * l0;
        let normal = chi * tangential;
        let sphere = T::from_f64(6.0 * core::f64::consts::PI) * radius;
        let sphere_turning = T::from_f64(8.0 * core::f64::consts::PI) * radius * radius * radius;
        let middle = Symmetric3::diagonal(
            tangential + sphere,
            normal + sphere,
            normal * l0 * l0 / T::from_f64(12.0) + sphere_turning,
        );
        let side = |length, mirror| SideLink::new(drag(length), chi, length, l0, mirror);
        Ok(Self {
            swimmer: *swimmer,
            middle,
            sides: [side(links.front, T::one()), side(links.back, -T::one())],
        })
    }

    /// The swimmer that this model was made from.
    pub fn swimmer(&self) -> &Swimmer<T> {
        &self.swimmer
    }

    /// c_t/μ of the side links, Lighthill's reference drag ([`Swimmer::side_drag`]).
    pub fn side_drag(&self) -> T {
        self.swimmer.side_drag()
    }

    /// An upper bound of the largest power per squared joint rate: the joint/joint blocks alone, body held fast.
    pub(crate) fn power_bound(&self) -> T {
        self.sides[0].hinge() + self.sides[1].hinge()
    }

    /// A(Φ): body velocity (v_x, v_y, θ̇) of the middle link, in its own frame, per joint rate. Rows x, y in metres,
    /// row θ dimensionless.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let model = Model::new(&Swimmer::<f64>::purcell())?;
    /// let a = model.local_connection(&Vector2::new(0.5, -0.3));
    /// assert!((a[(0, 0)] - 0.092985).abs() < 1e-6);
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    pub fn local_connection(&self, phi: &Vector2<T>) -> Matrix3x2<T> {
        self.balance(phi).connection()
    }

    /// W(Φ)/μ: the power is Φ̇ᵀ W Φ̇ (paper, equation for p(t)). Symmetric, positive definite, in m³.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let model = Model::new(&Swimmer::<f64>::purcell())?;
    /// let w = model.power_matrix(&Vector2::new(0.5, -0.3));
    /// assert!((w[(0, 0)] - 0.203711).abs() < 1e-6 && w.determinant() > 0.0);
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    pub fn power_matrix(&self, phi: &Vector2<T>) -> Matrix2<T> {
        self.power(&self.balance(phi))
    }

    /// A(Φ) and W(Φ)/μ together, at hardly more than the price of one.
    pub fn connection_and_power(&self, phi: &Vector2<T>) -> (Matrix3x2<T>, Matrix2<T>) {
        let balance = self.balance(phi);
        (balance.connection(), self.power(&balance))
    }

    /// A, W and their exact first derivatives ∂₁, ∂₂ with respect to φ₁, φ₂.
    pub fn first_derivatives(&self, phi: &Vector2<T>) -> FirstDerivatives<T> {
        let balance = self.balance(phi);
        self.first(&balance).0
    }

    /// A, W and their exact first and second derivatives.
    pub fn second_derivatives(&self, phi: &Vector2<T>) -> SecondDerivatives<T> {
        let balance = self.balance(phi);
        let (first, slopes) = self.first(&balance);
        let curvatures: [Blocks<T>; 2] = core::array::from_fn(|i| {
            self.sides[i].blocks(&balance.terms[i].derivative().derivative())
        });
        let mut d2_connection = [Matrix3x2::zeros(); 3];
        let mut d2_power = [Matrix2::zeros(); 3];
        for (n, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            // ∂ᵢⱼA = −M⁻¹(∂ᵢⱼN + ∂ᵢⱼM A + ∂ᵢM ∂ⱼA + ∂ⱼM ∂ᵢA); M and N have no mixed second derivatives.
            let (di, dj) = (&slopes.da[i], &slopes.da[j]);
            let mut force: [Vector3<T>; 2] = core::array::from_fn(|k| {
                slopes.blocks[i].body.times(&dj[k]) + slopes.blocks[j].body.times(&di[k])
            });
            // ∂ᵢⱼW = ∂ᵢⱼNᵀA + Aᵀ∂ᵢⱼN + Aᵀ∂ᵢⱼM A + Yᵢᵀ∂ⱼA + ∂ⱼAᵀYᵢ with Yᵢ = ∂ᵢN + ∂ᵢM A.
            let y = &slopes.force[i];
            let mut w = symmetric(|k, l| y[k].dot(&dj[l]) + y[l].dot(&dj[k]));
            if i == j {
                let (extra, power) = second_order(&curvatures[i], i, &balance.a);
                force[0] += extra[0];
                force[1] += extra[1];
                w += power;
            }
            d2_connection[n] = Matrix3x2::from_columns(&force.map(|v| balance.factors.balance(&v)));
            d2_power[n] = w;
        }
        SecondDerivatives {
            first,
            d2_connection,
            d2_power,
        }
    }

    #[inline]
    fn balance(&self, phi: &Vector2<T>) -> Balance<T> {
        let turns = [phi.x.sin_cos(), phi.y.sin_cos()];
        let terms = [self.sides[0].terms(turns[0]), self.sides[1].terms(turns[1])];
        let [front, back] = [
            self.sides[0].blocks(&terms[0]),
            self.sides[1].blocks(&terms[1]),
        ];
        let factors = self.middle.plus(&front.body).plus(&back.body).factorise();
        let a = [front.joint, back.joint].map(|n| factors.balance(&n));
        Balance {
            turns,
            terms,
            factors,
            a,
        }
    }

    /// W = U + NᵀA as what it stands for: the sum of every link's power. Sums of squares keep W positive, and keep its
    /// small direction exact to rounding where U + NᵀA would leave a difference of large numbers.
    #[inline]
    fn power(&self, balance: &Balance<T>) -> Matrix2<T> {
        let Balance { turns, a, .. } = balance;
        let (zero, one) = (T::zero(), T::one());
        let slips: [[Vector3<T>; 2]; 2] = core::array::from_fn(|i| {
            core::array::from_fn(|k| {
                self.sides[i].slips(turns[i], &a[k], if i == k { one } else { zero })
            })
        });
        symmetric(|k, l| {
            let middle = self.middle.xx * a[k].x * a[l].x
                + self.middle.yy * a[k].y * a[l].y
                + self.middle.zz * a[k].z * a[l].z;
            middle + slips[0][k].dot(&slips[0][l]) + slips[1][k].dot(&slips[1][l])
        })
    }

    #[inline]
    fn first(&self, balance: &Balance<T>) -> (FirstDerivatives<T>, Slopes<T>) {
        let blocks: [Blocks<T>; 2] =
            core::array::from_fn(|i| self.sides[i].blocks(&balance.terms[i].derivative()));
        // ∂ᵢA = −M⁻¹Yᵢ and ∂ᵢW = ∂ᵢNᵀA + Aᵀ∂ᵢN + Aᵀ∂ᵢM A, Yᵢ = ∂ᵢN + ∂ᵢM A.
        let orders: [_; 2] = core::array::from_fn(|i| second_order(&blocks[i], i, &balance.a));
        let force = orders.map(|(force, _)| force);
        let da = force.map(|y| y.map(|v| balance.factors.balance(&v)));
        let first = FirstDerivatives {
            connection: balance.connection(),
            power: self.power(balance),
            d_connection: da.map(|columns| Matrix3x2::from_columns(&columns)),
            d_power: orders.map(|(_, power)| power),
        };
        (first, Slopes { blocks, force, da })
    }
}

/// First-order quantities that second derivatives are made from; the first index is the angle differentiated by.
struct Slopes<T> {
    blocks: [Blocks<T>; 2],
    force: [[Vector3<T>; 2]; 2],
    da: [[Vector3<T>; 2]; 2],
}

impl<T: Scalar> Balance<T> {
    #[inline]
    fn connection(&self) -> Matrix3x2<T> {
        Matrix3x2::from_columns(&self.a)
    }
}

/// For differentiated blocks of side link `i`: the columns of N′ + M′A, and N′ᵀA + AᵀN′ + AᵀM′A.
#[inline]
fn second_order<T: Scalar>(
    blocks: &Blocks<T>,
    i: usize,
    a: &[Vector3<T>; 2],
) -> ([Vector3<T>; 2], Matrix2<T>) {
    let mut force = a.map(|column| blocks.body.times(&column));
    force[i] += blocks.joint;
    let by_joint = a.map(|column| blocks.joint.dot(&column));
    let power = symmetric(|k, l| {
        let direct = force[k].dot(&a[l]);
        if l == i { direct + by_joint[k] } else { direct }
    });
    (force, power)
}

#[inline]
fn symmetric<T: Scalar>(entry: impl Fn(usize, usize) -> T) -> Matrix2<T> {
    let off = entry(0, 1);
    Matrix2::new(entry(0, 0), off, off, entry(1, 1))
}
