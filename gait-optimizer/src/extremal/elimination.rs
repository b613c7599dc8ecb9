//! Gaussian elimination with row pivoting that passes over zeros.
//!
//! The conditions of a chain couple neighbouring pieces, with a few columns (lengths) and rows (ends of a closed curve) that
//! reach across. Kept in the order of the chain, few rows touch a column, so that the cost grows with the square of the number of
//! pieces and not with its cube.

/// A square system, row by row, with room for the right-hand side at the end of each.
#[derive(Debug, Clone)]
pub(crate) struct System {
    rows: Vec<Vec<f64>>,
}

/// A solved system.
#[derive(Debug, Clone)]
pub(crate) struct Eliminated {
    pub(crate) solution: Vec<f64>,
    /// Sign of the determinant.
    pub(crate) orientation: f64,
}

impl System {
    pub(crate) fn new(size: usize) -> Self {
        Self {
            rows: vec![vec![0.0; size + 1]; size],
        }
    }

    /// Adds to an entry; one that does not exist is left alone.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        if let Some(entry) = self.rows.get_mut(row).and_then(|row| row.get_mut(column)) {
            *entry += value;
        }
    }

    /// Solves for a right-hand side; none where a pivot vanishes or is not finite.
    pub(crate) fn solve(&self, right: &[f64]) -> Option<Eliminated> {
        let (mut rows, size) = (self.rows.clone(), self.rows.len());
        for (row, right) in rows.iter_mut().zip(right) {
            row[size] = *right;
        }
        let mut orientation = 1.0;
        for column in 0..size {
            let (pivot, largest) = (column..size)
                .map(|row| (row, rows[row][column].abs()))
                .max_by(|a, b| a.1.total_cmp(&b.1))?;
            if largest <= 0.0 || !largest.is_finite() {
                return None;
            }
            if pivot != column {
                rows.swap(pivot, column);
                orientation = -orientation;
            }
            let (done, left) = rows.split_at_mut(column + 1);
            let top = done.last()?;
            orientation *= top[column].signum();
            for row in left.iter_mut().filter(|row| row[column] != 0.0) {
                let factor = row[column] / top[column];
                for (entry, above) in row.iter_mut().zip(top).skip(column) {
                    *entry -= factor * above;
                }
            }
        }
        let mut solution = vec![0.0; size];
        for (index, row) in rows.iter().enumerate().rev() {
            let known = row.iter().zip(&solution).skip(index + 1);
            let known: f64 = known.map(|(entry, value)| entry * value).sum();
            solution[index] = (row[size] - known) / row[index];
        }
        let finite = solution.iter().all(|value| value.is_finite());
        finite.then_some(Eliminated {
            solution,
            orientation,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A chain of blocks with filled last columns and rows that reach across, against a dense factorisation.
    #[test]
    fn a_chain_is_solved_like_a_dense_matrix() {
        let (blocks, border) = (7, 2);
        let size = 3 * blocks + border;
        let mut seed = 1.0_f64;
        let mut next = || {
            seed = (seed * 16_807.0) % 2_147_483_647.0;
            seed / 2_147_483_647.0 - 0.5
        };
        let mut dense = DMatrix::zeros(size, size);
        for block in 0..blocks {
            for row in 3 * block..3 * block + 3 {
                for column in 3 * block..(3 * block + 6).min(3 * blocks) {
                    dense[(row, column)] = next();
                }
                dense[(row, size - 1)] = next();
                dense[(row, size - 2)] = next();
            }
        }
        // Rows that close the chain.
        for row in [size - 2, size - 1] {
            for column in [0, 1, size - 4, size - 3, size - 1] {
                dense[(row, column)] = next();
            }
        }
        let right = DVector::from_fn(size, |_, _| next());
        let mut system = System::new(size);
        for row in 0..size {
            for column in 0..size {
                system.add(row, column, dense[(row, column)]);
            }
        }
        let found = system.solve(right.as_slice()).unwrap();
        let expected = dense.clone().lu().solve(&right).unwrap();
        for (a, b) in found.solution.iter().zip(expected.iter()) {
            assert!((a - b).abs() < 1e-10 * (1.0 + b.abs()), "{a} {b}");
        }
        assert!(found.orientation * dense.determinant() > 0.0);
    }

    #[test]
    fn a_singular_system_is_refused() {
        let mut system = System::new(2);
        system.add(0, 0, 1.0);
        system.add(1, 0, 2.0);
        assert!(system.solve(&[1.0, 2.0]).is_none());
    }
}
