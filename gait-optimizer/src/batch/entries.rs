//! What a batch can be asked for: the model's numbers at a shape as a list of entries, and back.

use nalgebra::{Matrix2, Matrix3x2, Vector2};
use swimmer_model::{FirstDerivatives, Model, SecondDerivatives};

/// Sine and cosine of φ₁ and of φ₂.
type Turns = [(f64, f64); 2];

/// N numbers at a shape.
pub(crate) trait Entries<const N: usize> {
    /// What they stand for.
    type One;
    /// They.
    fn at(model: &Model<f64>, turns: Turns) -> [f64; N];
    /// Put together.
    fn one(entries: &[f64; N]) -> Self::One;
    /// At one shape \[rad\], without a batch.
    fn alone(model: &Model<f64>, phi: &Vector2<f64>) -> Self::One;
}

/// A.
pub(crate) struct Connection;
/// A and W.
pub(crate) struct Values;
/// A, W and their first derivatives.
pub(crate) struct First;
/// A, W and their first and second derivatives.
pub(crate) struct Second;

/// A row by row, then W's upper triangle.
const BLOCK: usize = 9;

#[inline(always)]
fn put<const N: usize>(entries: &mut [f64; N], block: usize, a: &Matrix3x2<f64>, w: &Matrix2<f64>) {
    let at = BLOCK * block;
    entries[at] = a.m11;
    entries[at + 1] = a.m12;
    entries[at + 2] = a.m21;
    entries[at + 3] = a.m22;
    entries[at + 4] = a.m31;
    entries[at + 5] = a.m32;
    entries[at + 6] = w.m11;
    entries[at + 7] = w.m12;
    entries[at + 8] = w.m22;
}

#[inline]
fn taken<const N: usize>(entries: &[f64; N], block: usize) -> (Matrix3x2<f64>, Matrix2<f64>) {
    let e = |k: usize| entries[BLOCK * block + k];
    (
        Matrix3x2::new(e(0), e(1), e(2), e(3), e(4), e(5)),
        Matrix2::new(e(6), e(7), e(7), e(8)),
    )
}

impl Entries<6> for Connection {
    type One = Matrix3x2<f64>;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: Turns) -> [f64; 6] {
        let a = model.connection_and_power_at(turns).0;
        [a.m11, a.m12, a.m21, a.m22, a.m31, a.m32]
    }

    #[inline]
    fn one(e: &[f64; 6]) -> Self::One {
        Matrix3x2::new(e[0], e[1], e[2], e[3], e[4], e[5])
    }

    fn alone(model: &Model<f64>, phi: &Vector2<f64>) -> Self::One {
        model.local_connection(phi)
    }
}

impl Entries<BLOCK> for Values {
    type One = (Matrix3x2<f64>, Matrix2<f64>);

    #[inline(always)]
    fn at(model: &Model<f64>, turns: Turns) -> [f64; BLOCK] {
        let (a, w) = model.connection_and_power_at(turns);
        let mut entries = [0.0; BLOCK];
        put(&mut entries, 0, &a, &w);
        entries
    }

    #[inline]
    fn one(entries: &[f64; BLOCK]) -> Self::One {
        taken(entries, 0)
    }

    fn alone(model: &Model<f64>, phi: &Vector2<f64>) -> Self::One {
        model.connection_and_power(phi)
    }
}

#[inline(always)]
fn put_first<const N: usize>(entries: &mut [f64; N], d: &FirstDerivatives<f64>) {
    put(entries, 0, &d.connection, &d.power);
    put(entries, 1, &d.d_connection[0], &d.d_power[0]);
    put(entries, 2, &d.d_connection[1], &d.d_power[1]);
}

#[inline]
fn first<const N: usize>(entries: &[f64; N]) -> FirstDerivatives<f64> {
    let (connection, power) = taken(entries, 0);
    let ((a1, w1), (a2, w2)) = (taken(entries, 1), taken(entries, 2));
    FirstDerivatives {
        connection,
        power,
        d_connection: [a1, a2],
        d_power: [w1, w2],
    }
}

impl Entries<{ 3 * BLOCK }> for First {
    type One = FirstDerivatives<f64>;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: Turns) -> [f64; 3 * BLOCK] {
        let mut entries = [0.0; 3 * BLOCK];
        put_first(&mut entries, &model.first_derivatives_at(turns));
        entries
    }

    #[inline]
    fn one(entries: &[f64; 3 * BLOCK]) -> Self::One {
        first(entries)
    }

    fn alone(model: &Model<f64>, phi: &Vector2<f64>) -> Self::One {
        model.first_derivatives(phi)
    }
}

impl Entries<{ 6 * BLOCK }> for Second {
    type One = SecondDerivatives<f64>;

    #[inline(always)]
    fn at(model: &Model<f64>, turns: Turns) -> [f64; 6 * BLOCK] {
        let d = model.second_derivatives_at(turns);
        let mut entries = [0.0; 6 * BLOCK];
        put_first(&mut entries, &d.first);
        put(&mut entries, 3, &d.d2_connection[0], &d.d2_power[0]);
        put(&mut entries, 4, &d.d2_connection[1], &d.d2_power[1]);
        put(&mut entries, 5, &d.d2_connection[2], &d.d2_power[2]);
        entries
    }

    #[inline]
    fn one(entries: &[f64; 6 * BLOCK]) -> Self::One {
        let [(a11, w11), (a12, w12), (a22, w22)] = [3, 4, 5].map(|block| taken(entries, block));
        SecondDerivatives {
            first: first(entries),
            d2_connection: [a11, a12, a22],
            d2_power: [w11, w12, w22],
        }
    }

    fn alone(model: &Model<f64>, phi: &Vector2<f64>) -> Self::One {
        model.second_derivatives(phi)
    }
}
