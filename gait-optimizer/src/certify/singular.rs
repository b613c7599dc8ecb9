//! Necessary conditions for objectives without effort: displacement, turning, sideways (paper, section IV).
//!
//! Free arcs are singular arcs: they lie on the zero of the height h = μ · F, with the gain on their left (generalised
//! Legendre–Clebsch condition). On an active bound the height pushes against it (sign of the KKT multiplier). H is linear in the
//! control, so with λ₁, λ₂ from `H_u = 0` at one point the costate equations give `H_u = ∫ h (Φ̇₂, −Φ̇₁) dt` along a singular arc.

use nalgebra::Vector2;
use swimmer_files::Objective;

use super::grid::Along;
use super::path::CurveNode;
use super::variation::Gain;
use super::{Degree, Openness, Subject};
use crate::certificate::{Check, Condition};
use crate::momentum::{Height, Momentum};
use crate::numerics::{lesser, worse};

impl Subject<'_> {
    /// All conditions of a weak optimum. A sideways gait is stationary in its start, or it is a loop of greatest displacement for any
    /// start; in both cases no other start may be better.
    pub(super) fn of_weak_optimum(&self, objective: Objective, open: Openness) -> Vec<Check> {
        let first = match objective {
            Objective::Turning => Gain::Turning,
            Objective::Sideways => Gain::Sideways,
            _ => Gain::Displacement,
        };
        let mut checks = self.of_gain(first, open);
        if objective == Objective::Sideways {
            if !checks.iter().all(|check| check.pass) {
                let of_loop = self.of_gain(Gain::Displacement, open);
                if of_loop.iter().all(|check| check.pass) {
                    checks = of_loop;
                }
            }
            checks.push(Condition::NoBetterStart.open(self.better_start(), 4.0 * open.pose));
        }
        if objective == Objective::Displacement && self.symmetric {
            let y = self.path.displacement().y;
            checks.push(Condition::NoLateral.open(y.abs(), open.pose));
        }
        checks
    }

    /// All conditions for one gain.
    fn of_gain(&self, gain: Gain, open: Openness) -> Vec<Check> {
        let Some(momentum) = self.weak_momentum(gain) else {
            // Without a gain the gait is not optimal.
            return vec![Condition::Gains.within(self.gained(gain), self.least_gain())];
        };
        let places = self.path.places.iter();
        let heights = places.map(|place| momentum.evaluate(self.model, &place.phi, &place.pose).0);
        let heights: Vec<Height> = heights.collect();
        let mut checks = self.on_free_arcs(&heights, open);
        checks.extend(self.on_bounds(&heights, open));
        checks.extend(self.ascents(gain, momentum));
        checks
    }

    /// Value of a gain for this gait.
    fn gained(&self, gain: Gain) -> f64 {
        match gain {
            Gain::Turning => self.path.rotation().abs(),
            Gain::Sideways => self.path.displacement().y.abs(),
            Gain::Displacement | Gain::Efficiency => self.path.displacement().norm(),
        }
    }

    /// Greatest increase of the displacement across the heading by another start, over L.
    fn better_start(&self) -> f64 {
        let d = self.path.displacement();
        let across = |theta: f64| {
            let (sin, cos) = theta.sin_cos();
            (d.y * cos - d.x * sin).abs()
        };
        let starts = self.path.places.iter().map(|place| across(place.pose[2]));
        starts.fold(0.0, worse) - d.y.abs()
    }

    fn on_free_arcs(&self, heights: &[Height], open: Openness) -> Vec<Check> {
        let free = || {
            let nodes = heights.iter().zip(&self.path.places).enumerate();
            nodes.filter(|(node, _)| self.along(*node) == Along::Free)
        };
        if free().next().is_none() {
            return Vec::new();
        }
        let largest = |value: &dyn Fn(&Height, &CurveNode) -> f64| {
            let values = free().map(|(_, (height, place))| value(height, place));
            values.fold(0.0, worse)
        };
        // Zero-level curves may cross at a corner of the gait. The slope vanishes there, and the distance is undefined.
        let steepest = largest(&|height, _| height.gradient.norm());
        let slope_at = |height: &Height| height.gradient.norm().max(1e-3 * steepest);
        // Shift of the zero per unit of pose error.
        let leverage = |height: &Height, place: &CurveNode| {
            2.0 * place.first.curvature().norm() / slope_at(height)
        };
        let open = largest(&leverage) * open.pose;
        let off_zero = |height: &Height| height.value.abs() / slope_at(height);
        let off = largest(&|height, _| off_zero(height));
        let mut checks = vec![Condition::OnZeroHeight.open(off, open)];
        let exits = self
            .grid
            .pieces
            .iter()
            .filter(|piece| piece.along == Along::Bound)
            .flat_map(|piece| [*piece.nodes.start(), *piece.nodes.end()])
            .filter(|&node| self.meets_free(node))
            .filter_map(|node| heights.get(node).map(off_zero))
            .reduce(worse);
        checks.extend(exits.map(|off| Condition::LeavesAtZero.open(off, open)));
        // Not at the end of a piece, where two zero-level curves may cross.
        let inner =
            |node: usize| self.grid.before(node).is_some() && self.grid.before(node + 1).is_some();
        let least = free()
            .filter(|(node, _)| inner(*node))
            .map(|(_, (height, place))| -height.gradient.dot(&place.right()))
            .fold(f64::INFINITY, lesser);
        checks.push(Condition::GrowsInwards.check(least));
        let (h_u, hamiltonian) = self.drift_of_h_u(heights);
        let tolerance = (Condition::Stationary.tolerance() + open) * steepest.max(1.0);
        checks.push(Condition::Stationary.within(h_u, tolerance));
        let rate = self
            .path
            .places
            .iter()
            .map(|place| place.rate.norm())
            .fold(0.0, worse);
        checks.push(Condition::HamiltonianZero.within(hamiltonian, tolerance * rate));
        checks
    }

    fn on_bounds(&self, heights: &[Height], open: Openness) -> Option<Check> {
        let multiplier =
            |(node, height): (usize, &Height)| Some(height.value * self.bound_side(node)?);
        let least = heights
            .iter()
            .enumerate()
            .filter(|(node, _)| self.along(*node) == Along::Bound)
            .map(|at| multiplier(at).unwrap_or(f64::NAN))
            .reduce(lesser);
        least.map(|least| Condition::HeightOnBound.open(least, 4.0 * open.pose))
    }

    /// Returns `true` if a free piece begins or ends at this node of a bound arc.
    fn meets_free(&self, node: usize) -> bool {
        let Some(shape) = self.shapes.get(node) else {
            return false;
        };
        self.grid
            .pieces
            .iter()
            .filter(|piece| piece.along == Along::Free)
            .flat_map(|piece| [*piece.nodes.start(), *piece.nodes.end()])
            .any(|other| {
                self.shapes
                    .get(other)
                    .is_some_and(|other| (other - shape).norm() < 1e-9)
            })
    }

    /// Largest `|H_u|` and largest |H| along a free piece, from the costate equations with `H_u = 0` at its start.
    fn drift_of_h_u(&self, heights: &[Height]) -> (f64, f64) {
        let forces: Vec<Vector2<f64>> = heights
            .iter()
            .zip(&self.path.places)
            .map(|(height, place)| Vector2::new(place.rate.y, -place.rate.x) * height.value)
            .collect();
        let integrals = self.grid.integrals(&forces, Vector2::zeros(), Degree::Fine);
        let mut worst = (0.0_f64, 0.0_f64);
        for piece in &self.grid.pieces {
            if piece.along == Along::Bound {
                continue;
            }
            let Some(start) = integrals.get(*piece.nodes.start()) else {
                continue;
            };
            for node in piece.nodes.clone() {
                if let (Some(here), Some(place)) = (integrals.get(node), self.path.places.get(node))
                {
                    let h_u = here - start;
                    worst.0 = worse(worst.0, h_u.norm());
                    worst.1 = worse(worst.1, h_u.dot(&place.rate).abs());
                }
            }
        }
        worst
    }

    /// Multipliers: p along the displacement (across the heading at the start for a sideways gait), c from what must vanish on the free
    /// arcs. Returns `None` if the gain is too small.
    pub(super) fn weak_momentum(&self, gain: Gain) -> Option<Momentum> {
        let gained = self.gained(gain);
        if gained.is_nan() || gained <= self.least_gain() {
            return None;
        }
        let d = self.path.displacement();
        let p = match gain {
            Gain::Turning => {
                return Some(Momentum {
                    p: Vector2::zeros(),
                    c: self.path.rotation().signum(),
                });
            }
            Gain::Sideways => Vector2::new(0.0, d.y.signum()),
            Gain::Displacement | Gain::Efficiency => d / d.norm(),
        };
        if self.symmetric {
            let c = -p.x * self.y_at_the_quarter();
            return Some(Momentum { p, c });
        }
        let without = Momentum { p, c: 0.0 };
        let pairs = |along: Along| {
            self.path
                .places
                .iter()
                .enumerate()
                .filter(move |(node, _)| self.along(*node) == along)
                .map(move |(node, place)| (node, place.height(&without), place.first.curvature().z))
        };
        let (mut across, mut square) = (0.0, 0.0);
        for (_, height, turning) in pairs(Along::Free) {
            across += height * turning;
            square += turning * turning;
        }
        let c = if square > 0.0 {
            -across / square
        } else {
            // A gait on bounds only: the midpoint of the values of c for which every multiplier has the right sign.
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            for (node, height, turning) in pairs(Along::Bound) {
                let Some(side) = self.bound_side(node) else {
                    continue;
                };
                let (height, turning) = (side * height, side * turning);
                if turning > 0.0 {
                    low = low.max(-height / turning);
                } else if turning < 0.0 {
                    high = high.min(-height / turning);
                }
            }
            match (low.is_finite(), high.is_finite()) {
                (true, true) => f64::midpoint(low, high),
                (true, false) => low,
                (false, true) => high,
                (false, false) => 0.0,
            }
        };
        Some(Momentum { p, c })
    }
}
