//! The swimmer's equations of motion: local connection A(Φ) and power matrix W(Φ), with exact derivatives.
//!
//! The net force and torque on a body that moves with body velocity ξ = (v_x, v_y, θ̇) and joint rates Φ̇ are
//! −(M ξ + N Φ̇); they vanish, so ξ = A Φ̇ with A = −M⁻¹N, and the power is Φ̇ᵀ W Φ̇ with W = U + NᵀA. In another [`crate::Medium`]
//! the same balance is that of momenta, or of the wheels' constraints.

use crate::medium::sphere_turning;
use crate::resistance::{Blocks, Factors3, SideLink, Symmetric3, Terms};
use crate::{
    FirstDerivatives, InvalidSwimmer, Link, Scalar, SecondDerivatives, Swimmer, WeighedCurvature,
};
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
        let middle = swimmer.tensor(Link::Middle);
        let side = |link, mirror| {
            let (tensor, length) = (swimmer.tensor(link), swimmer.links.of(link));
            let is_rod = swimmer.is_viscous() && swimmer.sphere_radius_on(link) == T::zero();
            let new = if is_rod { SideLink::rod } else { SideLink::new };
            new(&tensor, length, swimmer.links.middle, mirror)
        };
        Ok(Self {
            swimmer: *swimmer,
            middle: Symmetric3::diagonal(middle.tangential, middle.normal, middle.rotational),
            sides: [side(Link::Front, T::one()), side(Link::Back, -T::one())],
        })
    }

    /// The same with the float's rotational drag multiplied: a float that is no sphere drags against turning otherwise than its
    /// drag against translation says.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let sphere = Model::new(&Swimmer::<f64>::robot())?;
    /// let phi = Vector2::new(0.5, -0.3);
    /// // What hardly turns hardly swings its front link.
    /// let heavy = sphere.with_turning_drag(1e6);
    /// assert!(heavy.local_connection(&phi)[(2, 0)].abs() < 1e-3);
    /// assert_eq!(sphere.with_turning_drag(1.0).local_connection(&phi), sphere.local_connection(&phi));
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    #[must_use]
    pub fn with_turning_drag(&self, factor: T) -> Self {
        let turning = sphere_turning(self.swimmer.sphere_radius) * (factor - T::one());
        let mut out = *self;
        match self.swimmer.sphere_on {
            Link::Middle => out.middle.zz += turning,
            Link::Front => out.sides[0].add_rotational(turning),
            Link::Back => out.sides[1].add_rotational(turning),
        }
        out
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
        self.balance(turns(phi)).connection()
    }

    /// W(Φ)/μ: the power is Φ̇ᵀ W Φ̇ (paper, equation for p(t)). Symmetric, positive definite, in m³. In a perfect fluid it is
    /// twice the kinetic energy per metre of depth \[kg m\]; on wheels it is zero to rounding.
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
        self.power(&self.balance(turns(phi)))
    }

    /// A(Φ) and W(Φ)/μ together, at hardly more than the price of one.
    pub fn connection_and_power(&self, phi: &Vector2<T>) -> (Matrix3x2<T>, Matrix2<T>) {
        self.connection_and_power_at(turns(phi))
    }

    /// A, W and their exact first derivatives ∂₁, ∂₂ with respect to φ₁, φ₂.
    pub fn first_derivatives(&self, phi: &Vector2<T>) -> FirstDerivatives<T> {
        self.first_derivatives_at(turns(phi))
    }

    /// A, W and their exact first and second derivatives.
    pub fn second_derivatives(&self, phi: &Vector2<T>) -> SecondDerivatives<T> {
        self.second_derivatives_at(turns(phi))
    }

    /// [`Self::connection_and_power`] from (sin φ₁, cos φ₁) and (sin φ₂, cos φ₂). This and the next two have no branch and are
    /// inlined: a compiler can vectorise a loop of them over many shapes.
    #[inline(always)]
    pub fn connection_and_power_at(&self, turns: [(T, T); 2]) -> (Matrix3x2<T>, Matrix2<T>) {
        let balance = self.balance(turns);
        (balance.connection(), self.power(&balance))
    }

    /// [`Self::first_derivatives`] from (sin φ₁, cos φ₁) and (sin φ₂, cos φ₂).
    #[inline(always)]
    pub fn first_derivatives_at(&self, turns: [(T, T); 2]) -> FirstDerivatives<T> {
        self.first(&self.balance(turns)).0
    }

    /// [`Self::second_derivatives`] from (sin φ₁, cos φ₁) and (sin φ₂, cos φ₂).
    #[inline(always)]
    pub fn second_derivatives_at(&self, turns: [(T, T); 2]) -> SecondDerivatives<T> {
        let balance = self.balance(turns);
        let (first, slopes) = self.first(&balance);
        let factors = &balance.factors;
        let connection = |force: [Vector3<T>; 2]| columns(&factors.both(&force));
        let (bent1, curved1) = second_order(&self.slope(&balance.terms, 0, 2), 0, &balance.a);
        let (bent2, curved2) = second_order(&self.slope(&balance.terms, 1, 2), 1, &balance.a);
        // M and N have no mixed second derivatives.
        let (force11, power11) = slopes.crossed(0, 0);
        let (force12, power12) = slopes.crossed(0, 1);
        let (force22, power22) = slopes.crossed(1, 1);
        SecondDerivatives {
            first,
            d2_connection: [
                connection([force11[0] + bent1[0], force11[1] + bent1[1]]),
                connection(force12),
                connection([force22[0] + bent2[0], force22[1] + bent2[1]]),
            ],
            d2_power: [power11 + curved1, power12, power22 + curved2],
        }
    }

    /// A, W, the connection's curvature F, and the derivatives of `covector` · F with the covector held.
    ///
    /// ```
    /// use nalgebra::{Vector2, Vector3};
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let model = Model::new(&Swimmer::<f64>::purcell())?;
    /// let (phi, along) = (Vector2::new(0.5, -0.3), Vector3::new(1.0, 0.2, -0.1));
    /// let weighed = model.weighed_curvature(&phi, &along);
    /// let d_curvature = model.second_derivatives(&phi).d_curvature();
    /// assert!((weighed.slope.x - along.dot(&d_curvature[0])).abs() < 1e-15);
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    pub fn weighed_curvature(
        &self,
        phi: &Vector2<T>,
        covector: &Vector3<T>,
    ) -> WeighedCurvature<T> {
        let balance = self.balance(turns(phi));
        let (first, slopes) = self.first(&balance);
        let (bent1, _) = second_order(&self.slope(&balance.terms, 0, 2), 0, &balance.a);
        let (bent2, _) = second_order(&self.slope(&balance.terms, 1, 2), 1, &balance.a);
        // M is symmetric: the covector may be balanced in place of the force of each second derivative.
        let by_force = balance.factors.balance(covector);
        let crossed = |i: usize, j: usize| slopes.crossed(i, j).0;
        let force12 = crossed(0, 1);
        let force1 = crossed(0, 0)[1] + bent1[1] - force12[0];
        let force2 = force12[1] - crossed(1, 1)[0] - bent2[0];
        WeighedCurvature {
            connection: first.connection,
            power: first.power,
            curvature: first.curvature(),
            slope: Vector2::new(
                by_force.dot(&force1) + covector.dot(&first.d_bracket(0)),
                by_force.dot(&force2) + covector.dot(&first.d_bracket(1)),
            ),
        }
    }

    #[inline(always)]
    fn balance(&self, turns: [(T, T); 2]) -> Balance<T> {
        let terms = [self.sides[0].terms(turns[0]), self.sides[1].terms(turns[1])];
        let [front, back] = [
            self.sides[0].blocks(&terms[0]),
            self.sides[1].blocks(&terms[1]),
        ];
        let factors = self.middle.plus(&front.body).plus(&back.body).factorise();
        let a = factors.both(&[front.joint, back.joint]);
        Balance {
            turns,
            terms,
            factors,
            a,
        }
    }

    /// W = U + NᵀA as what it stands for: the sum of every link's power. Sums of squares keep W positive, and keep its
    /// small direction exact to rounding where U + NᵀA would leave a difference of large numbers.
    #[inline(always)]
    fn power(&self, balance: &Balance<T>) -> Matrix2<T> {
        let Balance { turns, a, .. } = balance;
        let (zero, one) = (T::zero(), T::one());
        let slips = |i: usize, rates: [T; 2]| {
            let side = &self.sides[i];
            [
                side.slips(turns[i], &a[0], rates[0]),
                side.slips(turns[i], &a[1], rates[1]),
            ]
        };
        let slips = [slips(0, [one, zero]), slips(1, [zero, one])];
        symmetric(|k, l| {
            let middle = self.middle.xx * a[k].x * a[l].x
                + self.middle.yy * a[k].y * a[l].y
                + self.middle.zz * a[k].z * a[l].z;
            middle + slips[0][k].dot(&slips[0][l]) + slips[1][k].dot(&slips[1][l])
        })
    }

    #[inline(always)]
    fn first(&self, balance: &Balance<T>) -> (FirstDerivatives<T>, Slopes<T>) {
        let blocks = [
            self.slope(&balance.terms, 0, 1),
            self.slope(&balance.terms, 1, 1),
        ];
        // ∂ᵢA = −M⁻¹Yᵢ and ∂ᵢW = ∂ᵢNᵀA + Aᵀ∂ᵢN + Aᵀ∂ᵢM A, Yᵢ = ∂ᵢN + ∂ᵢM A.
        let [(force1, power1), (force2, power2)] = [
            second_order(&blocks[0], 0, &balance.a),
            second_order(&blocks[1], 1, &balance.a),
        ];
        let force = [force1, force2];
        let da = [balance.factors.both(&force1), balance.factors.both(&force2)];
        let first = FirstDerivatives {
            connection: balance.connection(),
            power: self.power(balance),
            d_connection: [columns(&da[0]), columns(&da[1])],
            d_power: [power1, power2],
        };
        (first, Slopes { blocks, force, da })
    }

    /// Blocks of side link `i`, differentiated once or twice by its angle.
    #[inline(always)]
    fn slope(&self, terms: &[Terms<T>; 2], i: usize, times: usize) -> Blocks<T> {
        let once = terms[i].derivative();
        self.sides[i].blocks(&if times == 1 { once } else { once.derivative() })
    }
}

/// First-order quantities that second derivatives are made from; the first index is the angle differentiated by.
struct Slopes<T> {
    blocks: [Blocks<T>; 2],
    force: [[Vector3<T>; 2]; 2],
    da: [[Vector3<T>; 2]; 2],
}

impl<T: Scalar> Slopes<T> {
    /// Contribution of first derivatives to ∂ᵢⱼA = −M⁻¹(∂ᵢⱼN + ∂ᵢⱼM A + ∂ᵢM ∂ⱼA + ∂ⱼM ∂ᵢA) and to ∂ᵢⱼW = ∂ᵢⱼNᵀA + Aᵀ∂ᵢⱼN + Aᵀ∂ᵢⱼM
    /// A + Yᵢᵀ∂ⱼA + ∂ⱼAᵀYᵢ, Yᵢ = ∂ᵢN + ∂ᵢM A.
    #[inline(always)]
    fn crossed(&self, i: usize, j: usize) -> ([Vector3<T>; 2], Matrix2<T>) {
        let (di, dj, y) = (&self.da[i], &self.da[j], &self.force[i]);
        let (mi, mj) = (&self.blocks[i].body, &self.blocks[j].body);
        let force = [
            mi.times(&dj[0]) + mj.times(&di[0]),
            mi.times(&dj[1]) + mj.times(&di[1]),
        ];
        let power = symmetric(|k, l| y[k].dot(&dj[l]) + y[l].dot(&dj[k]));
        (force, power)
    }
}

impl<T: Scalar> Balance<T> {
    #[inline(always)]
    fn connection(&self) -> Matrix3x2<T> {
        columns(&self.a)
    }
}

/// For differentiated blocks of side link `i`: the columns of N′ + M′A, and N′ᵀA + AᵀN′ + AᵀM′A.
#[inline(always)]
fn second_order<T: Scalar>(
    blocks: &Blocks<T>,
    i: usize,
    a: &[Vector3<T>; 2],
) -> ([Vector3<T>; 2], Matrix2<T>) {
    let mut force = [blocks.body.times(&a[0]), blocks.body.times(&a[1])];
    force[i] += blocks.joint;
    let by_joint = [blocks.joint.dot(&a[0]), blocks.joint.dot(&a[1])];
    let power = symmetric(|k, l| {
        let direct = force[k].dot(&a[l]);
        if l == i { direct + by_joint[k] } else { direct }
    });
    (force, power)
}

#[inline(always)]
fn columns<T: Scalar>([one, two]: &[Vector3<T>; 2]) -> Matrix3x2<T> {
    Matrix3x2::new(one.x, two.x, one.y, two.y, one.z, two.z)
}

/// Sines and cosines of φ₁ and φ₂.
fn turns<T: Scalar>(phi: &Vector2<T>) -> [(T, T); 2] {
    [phi.x.sin_cos(), phi.y.sin_cos()]
}

#[inline(always)]
fn symmetric<T: Scalar>(entry: impl Fn(usize, usize) -> T) -> Matrix2<T> {
    let off = entry(0, 1);
    Matrix2::new(entry(0, 0), off, off, entry(1, 1))
}
