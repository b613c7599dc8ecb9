//! Values that a batch can compute: A and W with their derivatives, as blocks of entries.

use nalgebra::{Matrix2, Matrix3x2};
use swimmer_model::{FirstDerivatives, Model, SecondDerivatives};

/// A and W at a shape, or one of their derivatives.
pub(crate) type Block = (Matrix3x2<f64>, Matrix2<f64>);

/// Number of entries of a block: A by rows, then the upper triangle of W.
pub(super) const ENTRIES: usize = 9;

/// B blocks at a shape.
pub(crate) trait Blocks<const B: usize> {
    /// Type of the assembled value.
    type One;
    /// Computes the blocks from sine and cosine of φ₁ and of φ₂.
    fn at(model: &Model<f64>, turns: [(f64, f64); 2]) -> [Block; B];
    /// Assembles the blocks.
    fn one(blocks: [Block; B]) -> Self::One;
}

/// A.
pub(crate) struct Connection;
/// A and W.
pub(crate) struct Values;
/// A, W and their first derivatives.
pub(crate) struct First;
/// A, W and their first and second derivatives.
pub(crate) struct Second;

#[inline(always)]
pub(super) fn entries((a, w): &Block) -> [f64; ENTRIES] {
    [
        a.m11, a.m12, a.m21, a.m22, a.m31, a.m32, w.m11, w.m12, w.m22,
    ]
}

#[inline]
pub(super) fn block(e: &[f64; ENTRIES]) -> Block {
    (
        Matrix3x2::new(e[0], e[1], e[2], e[3], e[4], e[5]),
        Matrix2::new(e[6], e[7], e[7], e[8]),
    )
}

impl Blocks<1> for Connection {
    type One = Matrix3x2<f64>;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: [(f64, f64); 2]) -> [Block; 1] {
        [(model.connection_and_power_at(turns).0, Matrix2::zeros())]
    }

    #[inline]
    fn one([(connection, _)]: [Block; 1]) -> Self::One {
        connection
    }
}

impl Blocks<1> for Values {
    type One = Block;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: [(f64, f64); 2]) -> [Block; 1] {
        [model.connection_and_power_at(turns)]
    }

    #[inline]
    fn one([values]: [Block; 1]) -> Self::One {
        values
    }
}

impl Blocks<3> for First {
    type One = FirstDerivatives<f64>;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: [(f64, f64); 2]) -> [Block; 3] {
        let d = model.first_derivatives_at(turns);
        let ([a1, a2], [w1, w2]) = (d.d_connection, d.d_power);
        [(d.connection, d.power), (a1, w1), (a2, w2)]
    }

    #[inline]
    fn one([(connection, power), (a1, w1), (a2, w2)]: [Block; 3]) -> Self::One {
        FirstDerivatives {
            connection,
            power,
            d_connection: [a1, a2],
            d_power: [w1, w2],
        }
    }
}

impl Blocks<6> for Second {
    type One = SecondDerivatives<f64>;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: [(f64, f64); 2]) -> [Block; 6] {
        let d = model.second_derivatives_at(turns);
        let ([a1, a2], [w1, w2]) = (d.first.d_connection, d.first.d_power);
        let ([a11, a12, a22], [w11, w12, w22]) = (d.d2_connection, d.d2_power);
        let values = (d.first.connection, d.first.power);
        [
            values,
            (a1, w1),
            (a2, w2),
            (a11, w11),
            (a12, w12),
            (a22, w22),
        ]
    }

    #[inline]
    fn one([values, d1, d2, (a11, w11), (a12, w12), (a22, w22)]: [Block; 6]) -> Self::One {
        SecondDerivatives {
            first: First::one([values, d1, d2]),
            d2_connection: [a11, a12, a22],
            d2_power: [w11, w12, w22],
        }
    }
}
