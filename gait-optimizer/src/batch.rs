//! A, W and their derivatives at many shapes at once.
//!
//! The formulas are those of [`swimmer_model::Model`], inlined into a loop that the compiler vectorises. The instruction set is
//! detected when a batch is created. The results are equal to the model's to the last bit.

// A function that is not inlined would be compiled for the baseline target without vector instructions.
#![allow(clippy::inline_always)]

mod entries;
mod sine;

use std::array::from_fn;
use std::marker::PhantomData;

use nalgebra::Vector2;
use swimmer_model::{InvalidSwimmer, Model, Scalar, Swimmer};

pub(crate) use entries::{Blocks, Connection, First, Second, Values};
use entries::{ENTRIES, block, entries};
use sine::sines_and_cosines;

/// Model of a swimmer for many shapes at once.
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
/// assert_eq!(found.connection[0][1], one[(0, 0)]);
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Batch {
    model: Model<f64>,
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

/// Number of shapes per group, which fit into one or a few vector registers.
const WIDTH: usize = 8;
/// Number of groups per call.
const GROUPS: usize = 2;
const AT_ONCE: usize = GROUPS * WIDTH;

/// φ₁ and φ₂ of all shapes of each group.
type Shapes = [[[f64; WIDTH]; 2]; GROUPS];
/// Entries of each block at all shapes of each group.
type BlockEntries<const B: usize> = [[[[f64; WIDTH]; ENTRIES]; B]; GROUPS];

impl Batch {
    /// Creates a batch for a swimmer.
    ///
    /// # Errors
    /// As [`swimmer_model::Model::new`].
    pub fn new(swimmer: &Swimmer<f64>) -> Result<Self, InvalidSwimmer> {
        Ok(Self::of(&Model::new(swimmer)?))
    }

    /// Creates a batch for a model.
    pub fn of(model: &Model<f64>) -> Self {
        Self {
            model: *model,
            machine: pulp::Arch::new(),
        }
    }

    /// Evaluates A and W at the shapes (φ₁, φ₂) \[rad\], as many as the shorter list has. `found` is overwritten and its memory reused.
    pub fn connections_and_powers(
        &self,
        phi1: &[f64],
        phi2: &[f64],
        found: &mut ConnectionsAndPowers,
    ) {
        let count = phi1.len().min(phi2.len());
        let columns = found.connection.iter_mut().chain(&mut found.power);
        let mut columns: Vec<&mut Vec<f64>> = columns.collect();
        for column in &mut columns {
            column.resize(count, 0.0);
        }
        for from in (0..count).step_by(AT_ONCE) {
            let to = count.min(from + AT_ONCE);
            let mut shapes = Shapes::default();
            for (from, lanes) in (from..to).step_by(WIDTH).zip(&mut shapes) {
                let range = from..to.min(from + WIDTH);
                lanes[0][..range.len()].copy_from_slice(&phi1[range.clone()]);
                lanes[1][..range.len()].copy_from_slice(&phi2[range]);
            }
            let found = self.some::<Values, 1>(&shapes, to - from);
            for (from, lanes) in (from..to).step_by(WIDTH).zip(&found) {
                for (column, entry) in columns.iter_mut().zip(&lanes[0]) {
                    let rest = &mut column[from..];
                    match rest.first_chunk_mut() {
                        Some(whole) => *whole = *entry,
                        None => rest.copy_from_slice(&entry[..rest.len()]),
                    }
                }
            }
        }
    }

    /// Calls `then` with the index of each shape \[rad\] and the model's values there, in order.
    pub(crate) fn each<E: Blocks<B>, const B: usize>(
        &self,
        _: E,
        phi: impl Iterator<Item = Vector2<f64>>,
        mut then: impl FnMut(usize, E::One),
    ) {
        // On wasm the batch is no faster than the model, and code size matters.
        if cfg!(target_family = "wasm") {
            for (number, phi) in phi.enumerate() {
                let turns = [phi.x, phi.y].map(Scalar::sin_cos);
                then(number, E::one(E::at(&self.model, turns)));
            }
            return;
        }
        let mut phi = phi.peekable();
        let mut number = 0;
        while phi.peek().is_some() {
            let (mut shapes, mut count) = (Shapes::default(), 0);
            for phi in phi.by_ref().take(AT_ONCE) {
                let [phi1, phi2] = &mut shapes[count / WIDTH];
                (phi1[count % WIDTH], phi2[count % WIDTH]) = (phi.x, phi.y);
                count += 1;
            }
            let found = self.some::<E, B>(&shapes, count);
            for k in 0..count {
                let lanes = &found[k / WIDTH];
                let entries = |b: usize| from_fn(|entry| lanes[b][entry][k % WIDTH]);
                then(number, E::one(from_fn(|b| block(&entries(b)))));
                number += 1;
            }
        }
    }

    /// Evaluates the first `count` of these shapes.
    fn some<E: Blocks<B>, const B: usize>(&self, shapes: &Shapes, count: usize) -> BlockEntries<B> {
        let mut found = [[[[0.0; WIDTH]; ENTRIES]; B]; GROUPS];
        self.machine.dispatch(Groups::<E, B> {
            model: &self.model,
            shapes: &shapes[..count.div_ceil(WIDTH)],
            found: &mut found,
            blocks: PhantomData,
        });
        found
    }
}

/// Groups of shapes to be evaluated with any instruction set.
struct Groups<'a, E, const B: usize> {
    model: &'a Model<f64>,
    shapes: &'a [[[f64; WIDTH]; 2]],
    found: &'a mut BlockEntries<B>,
    blocks: PhantomData<E>,
}

impl<E: Blocks<B>, const B: usize> pulp::WithSimd for Groups<'_, E, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        // A local copy lets the compiler assume that the model does not change.
        let model = *self.model;
        for (phi, found) in self.shapes.iter().zip(self.found) {
            let (sin1, cos1) = sines_and_cosines(&phi[0]);
            let (sin2, cos2) = sines_and_cosines(&phi[1]);
            for k in 0..WIDTH {
                let blocks = E::at(&model, [(sin1[k], cos1[k]), (sin2[k], cos2[k])]);
                for b in 0..B {
                    let entries = entries(&blocks[b]);
                    for i in 0..ENTRIES {
                        found[b][i][k] = entries[i];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn swimmers() -> impl Strategy<Value = Swimmer<f64>> {
        let thin = Swimmer {
            sphere_radius: 0.3,
            chi: 3.598,
            ..Swimmer::purcell()
        };
        prop::sample::select(vec![Swimmer::purcell(), Swimmer::robot(), thin])
    }

    proptest! {
        #[test]
        fn many_are_as_one_to_the_last_bit(
            shapes in prop::collection::vec((-7.0..7.0_f64, -7.0..7.0_f64), 0..40),
            swimmer in swimmers(),
        ) {
            let model = Model::new(&swimmer).unwrap();
            let batch = Batch::of(&model);
            let phi: Vec<Vector2<f64>> = shapes.iter().map(|&(a, b)| Vector2::new(a, b)).collect();
            let mut reported = 0;
            batch.each(Second, phi.iter().copied(), |at, many| {
                assert_eq!((at, many), (reported, model.second_derivatives(&phi[at])));
                reported += 1;
            });
            assert_eq!(reported, phi.len());
            batch.each(First, phi.iter().copied(), |at, many| {
                assert_eq!(many, model.first_derivatives(&phi[at]));
            });
            batch.each(Values, phi.iter().copied(), |at, many| {
                assert_eq!(many, model.connection_and_power(&phi[at]));
            });
            batch.each(Connection, phi.iter().copied(), |at, many| {
                assert_eq!(many, model.local_connection(&phi[at]));
            });
        }

        #[test]
        fn columns_hold_entries(
            shapes in prop::collection::vec((-7.0..7.0_f64, -7.0..7.0_f64), 0..40),
            swimmer in swimmers(),
        ) {
            let (phi1, phi2): (Vec<f64>, Vec<f64>) = shapes.iter().copied().unzip();
            let batch = Batch::new(&swimmer).unwrap();
            let mut found = ConnectionsAndPowers::default();
            batch.connections_and_powers(&phi1, &phi2, &mut found);
            let model = Model::new(&swimmer).unwrap();
            for (at, (phi1, phi2)) in shapes.into_iter().enumerate() {
                let (a, w) = model.connection_and_power(&Vector2::new(phi1, phi2));
                let a = [a.m11, a.m12, a.m21, a.m22, a.m31, a.m32];
                let columns = found.connection.iter().chain(&found.power);
                let here: Vec<f64> = columns.map(|column| column[at]).collect();
                prop_assert_eq!(here, [&a[..], &[w.m11, w.m12, w.m22]].concat());
            }
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
