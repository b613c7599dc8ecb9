//! Closest approach of the side links along a path.

use gait_player::clearance::{clearance, margin as robot_margin};
use nalgebra::Vector2;
use swimmer_model::{Gait, Links};

use crate::path::Polyline;

/// Closest approach of the side links.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Distance between the centre lines of the side links \[m\] (or what a side link is from lying folded on the middle
    /// one); 0 where they cross.
    pub distance: f64,
    /// The shape there \[rad\].
    pub phi: Vector2<f64>,
}

/// Looks along a way are this close \[rad\], so that a tip moves less than a tenth of a millimetre between two.
const LOOK: f64 = 5e-4;
/// Most looks: a way of 500 rad.
const MOST_LOOKS: f64 = 1e6;
/// Pieces that a curved gait is looked at in.
const CHORDS: u32 = 4096;

impl Gap {
    /// Along a chain of straight pieces.
    pub(super) fn along(links: &Links<f64>, way: &Polyline) -> Self {
        let links = single(links);
        let sides = || way.vertices().array_windows();
        let length: f64 = sides().map(|[from, to]| (to - from).norm()).sum();
        let step = LOOK.max(length / MOST_LOOKS);
        let places = sides().flat_map(|[from, to]| {
            let looks = ((to - from).norm() / step).ceil().max(1.0);
            let looked = (0_u32..)
                .map(f64::from)
                .take_while(move |look| *look <= looks);
            looked.map(move |look| from + (to - from) * (look / looks))
        });
        let gaps = places.map(|phi| Self {
            distance: clearance(&links, [phi.x as f32, phi.y as f32]).into(),
            phi,
        });
        let least = gaps.min_by(|a, b| a.distance.total_cmp(&b.distance));
        least.unwrap_or(Self {
            distance: f64::INFINITY,
            phi: Vector2::zeros(),
        })
    }

    /// Along a curve.
    pub(super) fn of_gait<G: Gait<f64> + ?Sized>(links: &Links<f64>, gait: &G) -> Self {
        let places = (0..=CHORDS).map(|i| gait.at(f64::from(i) / f64::from(CHORDS)).phi);
        Self::along(links, &Polyline::new(places))
    }
}

/// The margin that the robot keeps between the side links \[m\].
pub(super) fn margin(links: &Links<f64>) -> f64 {
    f64::from(robot_margin(&single(links)))
}

pub(super) fn single(links: &Links<f64>) -> Links<f32> {
    Links {
        middle: links.middle as f32,
        front: links.front as f32,
        back: links.back as f32,
    }
}
