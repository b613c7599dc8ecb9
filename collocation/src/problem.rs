//! Inputs of a direct collocation.

use gait_optimizer::region::{Bound, Region};
use gait_optimizer::{Branch, EfficiencyProblem};
use swimmer_files::Bounds;
use swimmer_model::Model;

use super::error::CollocationError;
use super::radau;

/// Inputs of a direct collocation: swimmer, bounds, branch and mesh.
#[derive(Debug, Clone, Copy)]
pub struct CollocationProblem<'a> {
    /// Swimmer with side links of equal length.
    pub model: &'a Model<f64>,
    /// Bounds of the shapes, of which `max_angle` and `no_overlap` are used.
    pub bounds: Bounds,
    /// Required sign of x: +1 or −1.
    pub sign: f64,
    /// Number of elements of the fine mesh. A mesh with a quarter of them is solved first and may suffice if there are no bounds.
    pub elements: usize,
    /// Degree of the elements.
    pub degree: usize,
}

impl<'a> CollocationProblem<'a> {
    /// Problem without bounds on 80 elements of degree 5.
    pub fn new(model: &'a Model<f64>, sign: f64) -> Self {
        Self {
            model,
            bounds: Bounds::default(),
            sign,
            elements: 80,
            degree: 5,
        }
    }

    /// Adds the bound |φᵢ| ≤ `max_angle` \[rad\].
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {
        self.bounds.max_angle = Some(max_angle);
        self
    }

    pub(crate) fn validate(&self) -> Result<Vec<Bound>, CollocationError> {
        let swimmer = *self.model.swimmer();
        EfficiencyProblem {
            bounds: self.bounds,
            ..EfficiencyProblem::new(swimmer, Branch::Small)
        }
        .validated()?;
        let refuse = |name, value, problem| {
            Err(CollocationError::Problem {
                name,
                value,
                problem,
            })
        };
        if self.sign.abs().to_bits() != 1.0_f64.to_bits() {
            return refuse("sign", self.sign, "it must be 1 or −1");
        }
        if self.elements == 0 || self.elements > 1000 {
            return refuse("elements", self.elements as f64, "use 1 to 1000");
        }
        if self.degree < 2 || self.degree > radau::HIGHEST_DEGREE {
            return refuse("degree", self.degree as f64, "use 2 to 16");
        }
        Ok(Region::new(&self.bounds, &swimmer.links).bounds().collect())
    }
}
