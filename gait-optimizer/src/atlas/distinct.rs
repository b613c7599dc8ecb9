//! Equivalence of curves that are the same gait.
//!
//! Curves are equivalent under a shift of time, reversal (the swimmer swims the same way back) and the symmetries of the swimmer:
//! left–right, Φ → −Φ, and with equal side links front–back, (φ₁, φ₂) → (φ₂, φ₁). Without bounds, full turns of a joint are
//! equivalent too.

use nalgebra::Vector2;

use crate::certificate::to_side;
use crate::numerics::between;

/// Number of points at which curves are compared.
const POINTS: usize = 96;

/// Closed curve as evenly spaced points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Outline(Vec<Vector2<f64>>);

/// Symmetries of the swimmer in the plane of shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Symmetries {
    /// The side links are equal.
    pub(crate) swap: bool,
    /// Full turns of a joint are equivalent.
    pub(crate) turns: bool,
}

impl Outline {
    /// Resamples a closed polygon, last point = first.
    pub(crate) fn new(polygon: &[Vector2<f64>]) -> Self {
        let mut lengths = vec![0.0];
        let mut total = 0.0;
        for [a, b] in polygon.array_windows() {
            total += (b - a).norm();
            lengths.push(total);
        }
        let at = |length: f64| {
            let (before, share) = between(&lengths, length);
            let point = |i: usize| polygon.get(i).copied().unwrap_or_default();
            point(before).lerp(&point(before + 1), share)
        };
        Self(
            (0..POINTS)
                .map(|k| at(total * k as f64 / POINTS as f64))
                .collect(),
        )
    }

    fn mapped(&self, map: impl Fn(&Vector2<f64>) -> Vector2<f64>) -> Self {
        Self(self.0.iter().map(map).collect())
    }

    fn centre(&self) -> Vector2<f64> {
        self.0.iter().sum::<Vector2<f64>>() / POINTS as f64
    }

    /// Largest distance of a point of either curve from the other curve \[rad\].
    fn distance(&self, other: &Self) -> f64 {
        self.one_way(other).max(other.one_way(self))
    }

    fn one_way(&self, other: &Self) -> f64 {
        let sides = other.0.iter().zip(other.0.iter().cycle().skip(1));
        self.0
            .iter()
            .map(|point| {
                sides
                    .clone()
                    .map(|(a, b)| to_side(point, a, b))
                    .fold(f64::INFINITY, f64::min)
            })
            .fold(0.0, f64::max)
    }

    /// Distance to the nearest image of another curve.
    pub(crate) fn apart(&self, other: &Self, symmetries: Symmetries) -> f64 {
        let turn = |image: Self| {
            if !symmetries.turns {
                return image;
            }
            let turns = ((self.centre() - image.centre()) / std::f64::consts::TAU).map(f64::round);
            image.mapped(|phi| phi + turns * std::f64::consts::TAU)
        };
        let swapped = |phi: &Vector2<f64>| Vector2::new(phi.y, phi.x);
        let mut least = self.distance(&turn(other.clone()));
        least = least.min(self.distance(&turn(other.mapped(|phi| -phi))));
        if symmetries.swap {
            least = least.min(self.distance(&turn(other.mapped(swapped))));
            least = least.min(self.distance(&turn(other.mapped(|phi| -swapped(phi)))));
        }
        least
    }

    /// Returns `true` if the curve has both symmetries of the paper, within the accuracy of the outline.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.asymmetry() < 0.01
    }

    /// Largest distance of the curve from its images in φ₁ = φ₂ and in φ₁ = −φ₂.
    fn asymmetry(&self) -> f64 {
        let mirrored = self.mapped(|phi| Vector2::new(phi.y, phi.x));
        let turned = self.mapped(|phi| -Vector2::new(phi.y, phi.x));
        self.distance(&mirrored).max(self.distance(&turned))
    }
}

/// Groups entries with (nearly) the same outline in the order of their first occurrence: the first entry of every class, and the
/// entries that belong to it.
pub(crate) fn classes(
    outlines: &[(f64, Outline)],
    symmetries: Symmetries,
    same_value: f64,
    same_place: f64,
) -> Vec<Vec<usize>> {
    let mut classes: Vec<Vec<usize>> = Vec::new();
    for (index, (value, outline)) in outlines.iter().enumerate() {
        let home = classes.iter_mut().find(|class| {
            class
                .first()
                .and_then(|&first| outlines.get(first))
                .is_some_and(|(other, first)| {
                    (value - other).abs() <= same_value * value.abs().max(other.abs())
                        && outline.apart(first, symmetries) < same_place
                })
        });
        match home {
            Some(class) => class.push(index),
            None => classes.push(vec![index]),
        }
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn egg(map: impl Fn(Vector2<f64>) -> Vector2<f64>) -> Outline {
        let points: Vec<_> = (0..=300)
            .map(|k| f64::from(k) / 300.0 * std::f64::consts::TAU)
            .map(|t| {
                map(Vector2::new(
                    0.4 + t.cos() + 0.2 * (2.0 * t).cos(),
                    0.8 * t.sin(),
                ))
            })
            .collect();
        Outline::new(&points)
    }

    #[test]
    fn images_are_the_same_gait() {
        let both = Symmetries {
            swap: true,
            turns: true,
        };
        let one = egg(|phi| phi);
        for image in [
            egg(|phi| -phi),
            egg(|phi| Vector2::new(phi.y, phi.x)),
            egg(|phi| Vector2::new(phi.y + std::f64::consts::TAU, phi.x)),
        ] {
            assert!(one.apart(&image, both) < 1e-2);
        }
        let none = Symmetries {
            swap: false,
            turns: false,
        };
        assert!(one.apart(&egg(|phi| Vector2::new(phi.y, phi.x)), none) > 0.1);
        assert!(one.apart(&egg(|phi| phi * 1.1), both) > 0.05);
        assert!(one.asymmetry() > 0.1);
        let outlines = [
            (1.0, one.clone()),
            (2.0, one.clone()),
            (1.0, egg(|phi| -phi)),
        ];
        assert_eq!(classes(&outlines, both, 1e-6, 2e-2), [vec![0, 2], vec![1]]);
    }
}
