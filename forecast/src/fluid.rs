//! Load of the servos in a fluid of known viscosity: torque and power, and the Reynolds number as a check that inertia is small.

use swimmer_files::Fluid;
use swimmer_model::{Gait, Model};

/// Looks at a cycle.
const SAMPLES: u32 = 2000;

/// Load of one cycle with ideal servos, in the time parametrisation of the gait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    /// Mean over the cycle \[W\].
    pub power: f64,
    /// The largest \[W\].
    pub peak_power: f64,
    /// The largest of each joint, front and back, against the fluid alone \[N m\].
    pub torque: [f64; 2],
    /// Reynolds number of the fastest side link: its tip's speed against its joint, its length and the kinematic viscosity.
    pub reynolds: f64,
}

/// Load of a cycle of `period` \[s\] in this fluid.
///
/// ```
/// use forecast::demand;
/// use swimmer_files::{AnyGait, Fluid};
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
/// let silicone = Fluid { kinematic_viscosity: 0.06, density: 976.0 };
/// let slow = demand(&model, &silicone, &AnyGait::circle(1.2), 30.0);
/// let fast = demand(&model, &silicone, &AnyGait::circle(1.2), 15.0);
/// assert!((fast.power / slow.power - 4.0).abs() < 1e-9, "power goes with the square of the speed");
/// assert!((fast.torque[0] / slow.torque[0] - 2.0).abs() < 1e-9);
/// ```
pub fn demand<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    fluid: &Fluid,
    gait: &G,
    period: f64,
) -> Demand {
    let links = &model.swimmer().links;
    let mut found = Demand {
        power: 0.0,
        peak_power: 0.0,
        torque: [0.0; 2],
        reynolds: 0.0,
    };
    for sample in 0..SAMPLES {
        let point = gait.at((f64::from(sample) + 0.5) / f64::from(SAMPLES));
        let rate = point.rate / period;
        // The power is that of the joints alone, so their torques are W times their rates.
        let torque = model.power_matrix(&point.phi) * rate * fluid.viscosity();
        let power = torque.dot(&rate);
        found.power += power / f64::from(SAMPLES);
        found.peak_power = found.peak_power.max(power);
        for (most, torque) in found.torque.iter_mut().zip(torque.iter()) {
            *most = most.max(torque.abs());
        }
        for (length, rate) in [links.front, links.back].iter().zip(rate.iter()) {
            let reynolds = rate.abs() * length * length / fluid.kinematic_viscosity;
            found.reynolds = found.reynolds.max(reynolds);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::AnyGait;
    use swimmer_model::{Swimmer, Tolerance, swim};

    /// The energy of a cycle at this timing by the swum stroke, and how all of it scales.
    #[test]
    fn power_is_the_strokes_and_scales_as_it_must() {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let gait = AnyGait::circle(1.2);
        let fluid = Fluid {
            kinematic_viscosity: 0.06,
            density: 976.0,
        };
        let of = |period| demand(&model, &fluid, &gait, period);
        let (slow, quick) = (of(30.0), of(15.0));
        let stroke = swim(&model, &gait, &Tolerance::default());
        // ∫ Φ̇ᵀWΦ̇ du at the gait's own parameter, of one cycle.
        let energy = stroke.energy * fluid.viscosity() / 30.0;
        assert!((slow.power * 30.0 / energy - 1.0).abs() < 1e-6, "{slow:?}");
        assert!((quick.power / slow.power - 4.0).abs() < 1e-12);
        assert!((quick.torque[0] / slow.torque[0] - 2.0).abs() < 1e-12);
        // |φ̇| of a circle is 2πε/T: with the longer side link's square over ν.
        let side = model.swimmer().links.front;
        let reynolds = std::f64::consts::TAU * 1.2 / 30.0 * side * side / 0.06;
        assert!((slow.reynolds / reynolds - 1.0).abs() < 1e-5, "{slow:?}");
    }
}
