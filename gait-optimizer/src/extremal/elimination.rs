//! Gaussian elimination with row pivoting that skips zeros.
//!
//! The conditions of a chain couple neighbouring pieces, with a few columns (lengths) and rows (ends of a closed curve) that
//! reach across. Kept in the order of the chain, few rows touch a column and their entries lie close together, so that the
//! cost grows with the number of pieces and not with its cube.

/// A square system, row by row.
#[derive(Debug, Clone)]
pub(crate) struct System {
    size: usize,
    /// Columns from here on are filled in every row (the lengths of the arcs).
    border: usize,
    entries: Vec<f64>,
}

/// A solved system.
#[derive(Debug, Clone)]
pub(crate) struct Eliminated {
    pub(crate) solution: Vec<f64>,
    /// Sign of the determinant.
    pub(crate) orientation: f64,
}

impl System {
    pub(crate) fn new(size: usize, border: usize) -> Self {
        Self {
            size,
            border: border.min(size),
            entries: vec![0.0; size * size],
        }
    }

    /// Adds to an entry; one that does not exist is left alone.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        if row < self.size
            && column < self.size
            && let Some(entry) = self.entries.get_mut(row * self.size + column)
        {
            *entry += value;
        }
    }

    /// Solves for a right-hand side; none where a pivot vanishes or is not finite.
    pub(crate) fn solve(&self, right: &[f64]) -> Option<Eliminated> {
        let (size, border) = (self.size, self.border);
        let mut rows: Vec<Row> = self
            .entries
            .chunks_exact(size.max(1))
            .zip(right)
            .map(|(entries, right)| Row::new(entries, border, *right))
            .collect();
        if rows.len() != size {
            return None;
        }
        let mut orientation = 1.0;
        for column in 0..size {
            let (pivot, largest) = rows
                .iter()
                .enumerate()
                .skip(column)
                .map(|(index, row)| (index, row.at(column).abs()))
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
            orientation *= top.at(column).signum();
            for row in left.iter_mut().filter(|row| row.at(column) != 0.0) {
                row.eliminate(top, column, border);
            }
        }
        let mut solution = vec![0.0; size];
        for (index, row) in rows.iter().enumerate().rev() {
            let known = row
                .entries
                .iter()
                .zip(&solution)
                .skip(index + 1)
                .map(|(entry, value)| entry * value);
            let value = (row.right - known.sum::<f64>()) / row.at(index);
            *solution.get_mut(index)? = value;
        }
        solution
            .iter()
            .all(|value| value.is_finite())
            .then_some(Eliminated {
                solution,
                orientation,
            })
    }
}

/// One row under elimination.
struct Row {
    entries: Vec<f64>,
    /// Before the border, entries from here on are zero.
    end: usize,
    right: f64,
}

impl Row {
    fn new(entries: &[f64], border: usize, right: f64) -> Self {
        let filled = entries.iter().take(border).rposition(|&entry| entry != 0.0);
        Self {
            entries: entries.to_vec(),
            end: filled.map_or(0, |last| last + 1),
            right,
        }
    }

    fn at(&self, column: usize) -> f64 {
        self.entries.get(column).copied().unwrap_or(f64::NAN)
    }

    /// Takes off the multiple of the pivot's row that clears a column.
    fn eliminate(&mut self, top: &Self, column: usize, border: usize) {
        let factor = self.at(column) / top.at(column);
        let mut clear = |from: usize, to: usize| {
            if let (Some(own), Some(pivot)) =
                (self.entries.get_mut(from..to), top.entries.get(from..to))
            {
                for (entry, other) in own.iter_mut().zip(pivot) {
                    *entry -= factor * other;
                }
            }
        };
        clear(column, top.end.max(column));
        clear(border.max(column), top.entries.len());
        if let Some(entry) = self.entries.get_mut(column) {
            *entry = 0.0;
        }
        self.end = self.end.max(top.end);
        self.right -= factor * top.right;
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
        let mut system = System::new(size, 3 * blocks);
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
        let mut system = System::new(2, 2);
        system.add(0, 0, 1.0);
        system.add(1, 0, 2.0);
        assert!(system.solve(&[1.0, 2.0]).is_none());
    }
}
