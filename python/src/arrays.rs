//! Arrays of shapes in, arrays of numbers out, with the interpreter free to run other threads meanwhile.

use nalgebra::Vector2;
use numpy::{AllowTypeChange, PyArray1, PyArrayDyn, PyArrayLikeDyn, PyArrayMethods as _};
use pyo3::prelude::*;

use crate::errors::BadInput;

/// Numeric array from Python.
pub(crate) type Numbers<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;
/// Array for Python.
pub(crate) type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Numbers for each of many shapes.
pub(crate) struct Shapes {
    /// Joint angles \[rad\].
    pub(crate) phi: Vec<Vector2<f64>>,
    /// The array's dimensions without the last, which is 2.
    pub(crate) leading: Vec<usize>,
}

impl Shapes {
    /// A copy of an array of dimensions (…, 2): what another thread writes there meanwhile changes nothing.
    ///
    /// # Errors
    /// The last dimension is not 2.
    pub(crate) fn copied(phi: &Numbers<'_>) -> PyResult<Self> {
        let phi = phi.as_array();
        let Some((&2, leading)) = phi.shape().split_last() else {
            return Err(BadInput::new_err(format!(
                "joint angles have shape (2,) or (n, 2), a row for each shape of the swimmer; this array has shape {:?}",
                phi.shape()
            )));
        };
        let leading = leading.to_vec();
        let mut numbers = phi.iter().copied();
        let mut shapes = Vec::with_capacity(phi.len() / 2);
        while let (Some(one), Some(two)) = (numbers.next(), numbers.next()) {
            shapes.push(Vector2::new(one, two));
        }
        Ok(Self {
            phi: shapes,
            leading,
        })
    }

    /// `of_one` shape after the other, its `N` numbers row by row; the answer's dimensions are the leading ones and `trailing`.
    pub(crate) fn each<'py, const N: usize>(
        &self,
        py: Python<'py>,
        trailing: &[usize],
        of_one: impl Fn(&Vector2<f64>) -> [f64; N] + Send,
    ) -> PyResult<Array<'py>> {
        let numbers: Vec<f64> = py.detach(move || {
            let mut numbers = Vec::with_capacity(N * self.phi.len());
            for phi in &self.phi {
                numbers.extend_from_slice(&of_one(phi));
            }
            numbers
        });
        let dimensions = [self.leading.as_slice(), trailing].concat();
        PyArray1::from_vec(py, numbers).reshape(dimensions)
    }
}
