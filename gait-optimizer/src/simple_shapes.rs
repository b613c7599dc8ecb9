//! Circles and squares over their amplitude: the simply shaped gaits that the paper searches before it optimises
//! (its figures of X/L and ξ over ε), and their best amplitudes.

use swimmer_files::{AnyGait, Objective};
use swimmer_model::{Model, Stroke, Tolerance, swim};

/// A gait known by its amplitude alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SimpleShape {
    /// [`swimmer_model::Circle`].
    Circle,
    /// [`swimmer_model::Square`].
    Square,
}

/// A circle or square that is better than those a little smaller and a little larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BestAmplitude {
    /// ε \[rad\].
    pub amplitude: f64,
    /// X over L of a cycle run counter-clockwise, signed.
    pub displacement_over_length: f64,
    /// ξ at constant power.
    pub efficiency: f64,
}

impl SimpleShape {
    /// The gait of this amplitude \[rad\].
    pub fn gait(self, amplitude: f64) -> AnyGait {
        match self {
            Self::Circle => AnyGait::circle(amplitude),
            Self::Square => AnyGait::square(amplitude),
        }
    }

    /// One cycle of this amplitude \[rad\], swum.
    pub fn swum(self, model: &Model<f64>, amplitude: f64) -> Stroke<f64> {
        swim(model, &self.gait(amplitude), &Tolerance::default())
    }
}

/// Steps of the scan over the amplitudes.
const SCAN: u32 = 80;
/// The amplitude is found to this \[rad\]: where a smooth maximum is level to rounding.
const CLOSE: f64 = 1e-8;

/// All amplitudes up to `largest` \[rad\] that are locally best, smallest first: for |X| with [`Objective::Displacement`], else
/// for ξ at constant power.
///
/// ```
/// use gait_optimizer::{Objective, SimpleShape, best_amplitudes};
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::purcell()).unwrap();
/// let best = best_amplitudes(&model, SimpleShape::Circle, Objective::Displacement, 2.5);
/// assert!((best[0].amplitude - 1.6331625).abs() < 1e-6);
/// ```
pub fn best_amplitudes(
    model: &Model<f64>,
    shape: SimpleShape,
    objective: Objective,
    largest: f64,
) -> Vec<BestAmplitude> {
    let gain = |amplitude: f64| {
        let stroke = shape.swum(model, amplitude);
        match objective {
            Objective::Displacement => stroke.displacement.norm(),
            _ => stroke.efficiency_constant_power(),
        }
    };
    let place = |i: u32| largest * f64::from(i) / f64::from(SCAN);
    let gains: Vec<f64> = (1..=SCAN).map(|i| gain(place(i))).collect();
    let is_top = |[before, here, after]: [f64; 3]| here > before && here >= after;
    let places = gains.array_windows().zip(2..);
    let tops = places.filter_map(|(three, i)| is_top(*three).then_some(i));
    tops.map(|i| {
        let amplitude = top(&gain, (place(i - 1), place(i + 1)), CLOSE);
        let stroke = shape.swum(model, amplitude);
        BestAmplitude {
            amplitude,
            displacement_over_length: stroke.displacement_over_length().x,
            efficiency: stroke.efficiency_constant_power(),
        }
    })
    .collect()
}

/// The maximum between two places by golden sections, so close.
pub(crate) fn top(gain: &impl Fn(f64) -> f64, (mut low, mut high): (f64, f64), close: f64) -> f64 {
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - SECTION * (high - low), low + SECTION * (high - low));
    let (mut at_a, mut at_b) = (gain(a), gain(b));
    while high - low > close {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - SECTION * (high - low);
            at_a = gain(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + SECTION * (high - low);
            at_b = gain(b);
        }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    /// The reference values of Purcell's swimmer.
    #[test]
    fn purcells_best_amplitudes() {
        let model = Model::new(&Swimmer::purcell()).unwrap();
        for (shape, expected) in [
            (
                SimpleShape::Circle,
                vec![(1.633_162_5, 0.082_285_393_1), (3.647_415, -0.214_965_8)],
            ),
            (SimpleShape::Square, vec![(1.390_607_7, 0.078_260_826_4)]),
        ] {
            let found = best_amplitudes(&model, shape, Objective::Displacement, 4.5);
            for (found, (amplitude, displacement)) in found.iter().zip(expected) {
                assert!((found.amplitude - amplitude).abs() < 1e-6, "{found:?}");
                assert!(
                    (found.displacement_over_length - displacement).abs() < 1e-7,
                    "{found:?}"
                );
            }
            assert!(found.len() >= 2, "{found:?}");
        }
    }
}
