//! hp refinement: elements whose error is too large get a higher degree where the solution is smooth, and are split where it
//! is not, as where a bound begins or ends.
//!
//! After M. A. Patterson, W. W. Hager, A. V. Rao, *A ph mesh refinement method for optimal control*, Optim. Control Appl.
//! Meth. 36 (2015): the degree is raised by what an error of order d^−d promises, up to a limit.

use super::again::Again;
use super::mesh::Mesh;

/// What to do with a mesh.
#[derive(Debug)]
pub(crate) enum Verdict {
    Good,
    Finer(Mesh),
}

/// Above this degree an element is split instead.
const SMOOTH_DEGREE: usize = 10;
/// Degree of the parts of an element that was split.
const SPLIT_DEGREE: usize = 5;

/// Compares each element's error with the tolerance.
pub(crate) fn judge(mesh: &Mesh, again: &Again, tolerance: f64) -> Verdict {
    let mut ends = vec![0.0];
    let mut degrees = Vec::new();
    let mut good = true;
    for ((element, &error), &power) in mesh.elements.iter().zip(&again.errors).zip(&again.power) {
        let degree = element.rule.degree;
        // Efficiency is lost as the square of the unevenness of the power.
        let off = error.max(power * power);
        if off <= tolerance {
            ends.push(element.end());
            degrees.push(degree);
            continue;
        }
        good = false;
        let more = ((off / tolerance).ln() / (degree as f64).ln())
            .ceil()
            .min(20.0);
        // Between 1 and 20.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let raised = degree + (more.max(1.0) as usize);
        if raised <= SMOOTH_DEGREE {
            ends.push(element.end());
            degrees.push(raised);
        } else {
            ends.push(element.start + 0.5 * element.length);
            ends.push(element.end());
            let part = degree.min(SPLIT_DEGREE);
            degrees.extend([part, part]);
        }
    }
    if let Some(last) = ends.last_mut() {
        *last = 1.0;
    }
    if good {
        Verdict::Good
    } else {
        Verdict::Finer(Mesh::new(&ends, &degrees))
    }
}
