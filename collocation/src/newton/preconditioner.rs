//! Preconditioner of the Newton system: energy of linear steps between neighbouring points, plus the bounds. Linear finite
//! elements precondition polynomials of any degree (M. O. Deville, E. H. Mund, *Finite-element preconditioning for
//! pseudospectral solutions of elliptic problems*, SIAM J. Sci. Stat. Comput. 11 (1990)).

use nalgebra::{Matrix2, Matrix2xX, Vector2};

use crate::guess::bind_ends;
use crate::mesh::Mesh;
use crate::path::Path;

/// Stiffness that holds the ends on their symmetry lines, relative to that of the energy.
const HELD: f64 = 1e6;

/// Factorised block tridiagonal matrix. Neighbours are coupled by minus `links`; each block is the inverse of its Schur
/// complement after elimination of all blocks before it.
#[derive(Debug)]
pub(super) struct Preconditioner {
    blocks: Vec<Matrix2<f64>>,
    links: Vec<Matrix2<f64>>,
}

impl Preconditioner {
    /// Assembles and factorises the matrix; `walls` is the contribution of the bounds to the block of each point.
    pub(super) fn new(path: &Path, mesh: &Mesh, walls: &[Matrix2<f64>]) -> Self {
        let power = |point: usize| path.physics[point].power / path.final_energy;
        let last = mesh.len() - 1;
        let links: Vec<_> = (0..last)
            .map(|point| {
                let step = mesh.times[point + 1] - mesh.times[point];
                (power(point) + power(point + 1)) / step
            })
            .collect();
        let mut blocks: Vec<_> = (0..=last)
            .map(|point| power(point) * mesh.weights[point] + walls[point])
            .collect();
        for (point, link) in links.iter().enumerate() {
            blocks[point] += link;
            blocks[point + 1] += link;
        }
        for (point, across) in [(0, Vector2::new(1.0, -1.0)), (last, Vector2::new(1.0, 1.0))] {
            let held = HELD * blocks[point].trace();
            blocks[point] += across * across.transpose() * held;
        }
        for point in 0..=last {
            if point > 0 {
                let link = links[point - 1];
                let gone = link * blocks[point - 1] * link;
                blocks[point] -= gone;
            }
            blocks[point] = blocks[point].try_inverse().unwrap_or_else(Matrix2::zeros);
        }
        Self { blocks, links }
    }

    /// Solves the system for one right-hand side.
    pub(super) fn solve(&self, right: &Matrix2xX<f64>) -> Matrix2xX<f64> {
        let mut solution = right.clone();
        for (point, link) in self.links.iter().enumerate() {
            let carried = link * (self.blocks[point] * solution.column(point));
            let mut next = solution.column_mut(point + 1);
            next += carried;
        }
        let mut after = Vector2::zeros();
        for (point, block) in self.blocks.iter().enumerate().rev() {
            let known = self.links.get(point).map(|link| link * after);
            after = block * (solution.column(point) + known.unwrap_or_default());
            solution.set_column(point, &after);
        }
        bind_ends(&mut solution);
        solution
    }
}
