//! Automatic differentiation, the cross-check of the closed forms: numbers a + b ε₁ + c ε₂ + d ε₁ε₂ with ε₁² = ε₂² = 0.
//! A function of such numbers carries its value, two first derivatives and their mixed second one, exact to rounding.

use num_traits::{Num, One, Zero};
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};
use swimmer_model::Scalar;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HyperDual {
    pub(crate) value: f64,
    pub(crate) d1: f64,
    pub(crate) d2: f64,
    pub(crate) d12: f64,
}

impl HyperDual {
    pub(crate) fn new(value: f64, d1: f64, d2: f64) -> Self {
        Self {
            value,
            d1,
            d2,
            d12: 0.0,
        }
    }

    /// f(self), given f, f′ and f″ at the value.
    fn chain(self, f: f64, df: f64, ddf: f64) -> Self {
        Self {
            value: f,
            d1: df * self.d1,
            d2: df * self.d2,
            d12: df * self.d12 + ddf * self.d1 * self.d2,
        }
    }
}

impl Add for HyperDual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            value: self.value + o.value,
            d1: self.d1 + o.d1,
            d2: self.d2 + o.d2,
            d12: self.d12 + o.d12,
        }
    }
}

impl Neg for HyperDual {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            d1: -self.d1,
            d2: -self.d2,
            d12: -self.d12,
        }
    }
}

impl Sub for HyperDual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + (-o)
    }
}

impl Mul for HyperDual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self {
            value: self.value * o.value,
            d1: self.d1 * o.value + self.value * o.d1,
            d2: self.d2 * o.value + self.value * o.d2,
            d12: self.d12 * o.value + self.d1 * o.d2 + self.d2 * o.d1 + self.value * o.d12,
        }
    }
}

impl Div for HyperDual {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl)] // by the reciprocal
    fn div(self, o: Self) -> Self {
        let r = 1.0 / o.value;
        self * o.chain(r, -r * r, 2.0 * r * r * r)
    }
}

impl Rem for HyperDual {
    type Output = Self;
    fn rem(self, o: Self) -> Self {
        self - o * Scalar::floor(self / o)
    }
}

macro_rules! assigning {
    ($($name:ident $method:ident $op:tt)*) => {$(
        impl $name for HyperDual {
            fn $method(&mut self, o: Self) {
                *self = *self $op o;
            }
        }
    )*};
}
assigning!(AddAssign add_assign + SubAssign sub_assign - MulAssign mul_assign * DivAssign div_assign / RemAssign rem_assign %);

impl PartialOrd for HyperDual {
    fn partial_cmp(&self, o: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&o.value)
    }
}

impl Zero for HyperDual {
    fn zero() -> Self {
        Self::new(0.0, 0.0, 0.0)
    }
    fn is_zero(&self) -> bool {
        self.value == 0.0
    }
}

impl One for HyperDual {
    fn one() -> Self {
        Self::new(1.0, 0.0, 0.0)
    }
}

impl Num for HyperDual {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        <f64 as Num>::from_str_radix(text, radix).map(Self::from_f64)
    }
}

impl Scalar for HyperDual {
    const EPSILON: Self = Self {
        value: f64::EPSILON,
        d1: 0.0,
        d2: 0.0,
        d12: 0.0,
    };

    fn from_f64(value: f64) -> Self {
        Self::new(value, 0.0, 0.0)
    }
    fn to_f64(self) -> f64 {
        self.value
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos, -sin), self.chain(cos, -sin, -cos))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.value))
    }
    fn ln(self) -> Self {
        let r = 1.0 / self.value;
        self.chain(self.value.ln(), r, -r * r)
    }
    fn atan2(self, x: Self) -> Self {
        // d atan2(y, x) = (x dy − y dx) / (x² + y²), differentiated once more by the quotient's own arithmetic.
        let first = |y: Self, x: Self, dy: f64, dx: f64| {
            (x * Self::from_f64(dy) - y * Self::from_f64(dx)) / (x * x + y * y)
        };
        let along1 = first(self, x, self.d1, x.d1);
        let mixed = first(self, x, self.d12, x.d12).value;
        let by2 = Self {
            d1: 0.0,
            d12: 0.0,
            ..self
        };
        let x2 = Self {
            d1: 0.0,
            d12: 0.0,
            ..x
        };
        Self {
            value: self.value.atan2(x.value),
            d1: along1.value,
            d2: first(self, x, self.d2, x.d2).value,
            d12: mixed + first(by2, x2, self.d1, x.d1).d2,
        }
    }
    fn floor(self) -> Self {
        Self::from_f64(self.value.floor())
    }
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
}
