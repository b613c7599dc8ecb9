//! One type for every gait that a person can name, so that callers need not be generic.

mod owned_samples;

use nalgebra::Vector2;
use owned_samples::OwnedSamples;
use swimmer_model::{Circle, Gait, GaitPoint, InvalidSamples, Reversed, Square};

use crate::GaitFile;

/// A gait in closed form or from samples that it owns; runs forwards or backwards.
///
/// ```
/// use swimmer_files::AnyGait;
/// use swimmer_model::Gait;
///
/// let forwards = AnyGait::circle(1.2);
/// let backwards = forwards.clone().reversed_if(true);
/// assert!((forwards.at(0.25).phi - backwards.at(0.75).phi).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AnyGait {
    shape: Shape,
    reversed: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    Circle(Circle<f64>),
    Square(Square<f64>),
    Sampled(OwnedSamples),
}

impl AnyGait {
    /// A circle of radius `amplitude` \[rad\], counter-clockwise from φ₁ = φ₂ > 0.
    pub fn circle(amplitude: f64) -> Self {
        Self::forwards(Shape::Circle(Circle { amplitude }))
    }

    /// A square with corners (±`amplitude`, ±`amplitude`) \[rad\], counter-clockwise from φ₁ = φ₂ > 0.
    pub fn square(amplitude: f64) -> Self {
        Self::forwards(Shape::Square(Square { amplitude }))
    }

    /// The samples of a gait file, interpolated as [`swimmer_model::Sampled`] does.
    ///
    /// # Errors
    /// The samples make no closed curve; those of a file that was read do.
    pub fn from_file(file: &GaitFile) -> Result<Self, InvalidSamples> {
        let corners: Vec<usize> = file
            .corners
            .iter()
            .filter_map(|corner| file.u.iter().position(|u| u.to_bits() == corner.to_bits()))
            .collect();
        Self::from_samples(&file.u, &file.phi, &corners)
    }

    /// Samples Φ \[rad\] at `u`, smooth but at the knots that `corners` numbers; see [`swimmer_model::Sampled::new`].
    ///
    /// # Errors
    /// As [`swimmer_model::Sampled::new`].
    pub fn from_samples(
        u: &[f64],
        phi: &[Vector2<f64>],
        corners: &[usize],
    ) -> Result<Self, InvalidSamples> {
        OwnedSamples::new(u, phi, corners).map(|samples| Self::forwards(Shape::Sampled(samples)))
    }

    /// The same closed curve run the other way, from the same start, when `reverse` is true.
    #[must_use]
    pub fn reversed_if(mut self, reverse: bool) -> Self {
        self.reversed ^= reverse;
        self
    }

    fn forwards(shape: Shape) -> Self {
        Self {
            shape,
            reversed: false,
        }
    }
}

/// Asks the gait behind an [`AnyGait`], turned round where it is reversed.
macro_rules! ask {
    ($gait:expr, $inner:ident => $question:expr) => {
        match (&$gait.shape, $gait.reversed) {
            (Shape::Circle($inner), false) => $question,
            (Shape::Square($inner), false) => $question,
            (Shape::Sampled($inner), false) => $question,
            (Shape::Circle(forward), true) => {
                let $inner = &Reversed(forward);
                $question
            }
            (Shape::Square(forward), true) => {
                let $inner = &Reversed(forward);
                $question
            }
            (Shape::Sampled(forward), true) => {
                let $inner = &Reversed(forward);
                $question
            }
        }
    };
}

impl Gait<f64> for AnyGait {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        ask!(self, gait => gait.at(u))
    }

    fn pieces(&self) -> usize {
        ask!(self, gait => Gait::<f64>::pieces(gait))
    }

    fn piece_end(&self, i: usize) -> f64 {
        ask!(self, gait => gait.piece_end(i))
    }

    fn corner_at_end(&self, i: usize) -> bool {
        ask!(self, gait => Gait::<f64>::corner_at_end(gait, i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon() -> (Vec<f64>, Vec<Vector2<f64>>, Vec<usize>) {
        // A square with seven knots an edge, corners marked.
        let u: Vec<f64> = (0..28).map(|k| f64::from(k) / 28.0).collect();
        let phi = u
            .iter()
            .map(|&u| Square { amplitude: 1.0 }.at(u).phi)
            .collect();
        (u, phi, vec![0, 7, 14, 21])
    }

    #[test]
    fn samples_of_a_square_are_the_square() {
        let (u, phi, corners) = polygon();
        let gait = AnyGait::from_samples(&u, &phi, &corners).unwrap();
        for k in 0..1000 {
            let u = f64::from(k) / 1000.0 + 1e-4;
            let (have, want) = (gait.at(u), Square { amplitude: 1.0 }.at(u));
            assert!(
                (have.phi - want.phi).norm() < 1e-14 && (have.rate - want.rate).norm() < 1e-12,
                "{u}"
            );
        }
        assert_eq!(
            (0..28)
                .filter(|&piece| gait.corner_at_end(piece))
                .collect::<Vec<_>>(),
            [6, 13, 20, 27]
        );
    }

    #[test]
    fn interpolates_as_the_model_does() {
        let u: Vec<f64> = (0..40).map(|k| (f64::from(k) / 40.0).powf(1.2)).collect();
        let phi: Vec<_> = u
            .iter()
            .map(|&u| Circle { amplitude: 1.0 }.at(u).phi)
            .collect();
        let corners = [5, 20];
        let model = swimmer_model::Sampled::new(&u, &phi, &corners).unwrap();
        let gait = AnyGait::from_samples(&u, &phi, &corners).unwrap();
        for k in 0..2000 {
            let u = f64::from(k) / 2000.0;
            let (have, want) = (gait.at(u), model.at(u));
            assert!((have.phi - want.phi).norm() < 1e-14, "{u}");
            assert!((have.rate - want.rate).norm() < 1e-10, "{u}");
        }
    }

    #[test]
    fn a_reversed_gait_runs_back() {
        let (u, phi, corners) = polygon();
        for gait in [
            AnyGait::circle(1.2),
            AnyGait::square(1.2),
            AnyGait::from_samples(&u, &phi, &corners).unwrap(),
        ] {
            let back = gait.clone().reversed_if(true);
            assert!((gait.at(0.3).phi - back.at(0.7).phi).norm() < 1e-14);
            assert!((gait.at(0.3).rate + back.at(0.7).rate).norm() < 1e-12);
            assert_eq!(gait.pieces(), back.pieces());
            assert_eq!(back.reversed_if(true), gait);
        }
    }
}
