//! Net poses of a straight side in the plane of joint angles, one for each swimmer.

use std::ops::Mul;

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::plane::Pose;

/// One for each swimmer, and of the first the heading's integral over the time that it takes.
#[derive(Debug, Clone)]
pub(super) struct Poses {
    each: Vec<Pose>,
    headed: f64,
    time: f64,
}

impl Poses {
    pub(super) fn still(count: usize) -> Self {
        Self {
            each: vec![Pose::default(); count],
            headed: 0.0,
            time: 0.0,
        }
    }

    /// Poses of each swimmer along a straight side, with the gain of its servos; in this time, if the heading is prescribed.
    pub(super) fn along(
        swimmers: &[(Model<f64>, f64)],
        ends: [Vector2<f64>; 2],
        time: Option<f64>,
    ) -> Self {
        let poses = swimmers
            .iter()
            .map(|(model, gain)| Pose::along(model, ends.map(|end| end * *gain)));
        Self {
            each: poses.collect(),
            headed: time.map_or(0.0, |time| time * mean_heading(&swimmers[0].0, ends)),
            time: time.unwrap_or(0.0),
        }
    }

    /// The same side in another time.
    pub(super) fn lasting(&self, time: f64) -> Self {
        let headed = self.headed / self.time * time;
        Self {
            headed,
            time,
            ..self.clone()
        }
    }

    pub(super) fn mean_heading(&self) -> f64 {
        self.headed / self.time
    }

    pub(super) fn first(&self) -> Pose {
        self.each[0]
    }

    pub(super) fn all(&self) -> &[Pose] {
        &self.each
    }
}

impl Mul for &Poses {
    type Output = Poses;

    fn mul(self, next: Self) -> Poses {
        let pairs = self.each.iter().zip(&next.each);
        Poses {
            each: pairs.map(|(one, next)| *one * *next).collect(),
            headed: self.headed + next.headed + self.first().theta * next.time,
            time: self.time + next.time,
        }
    }
}

/// Along a straight side, from heading 0: what is turned early counts for longer.
fn mean_heading(model: &Model<f64>, [from, to]: [Vector2<f64>; 2]) -> f64 {
    const PARTS: usize = 4;
    let way = to - from;
    let nodes = Pose::NODES.iter().zip(Pose::WEIGHTS);
    let part = |i: usize| {
        nodes.clone().map(move |(node, weight)| {
            let s = (i as f64 + node) / PARTS as f64;
            let rate = (model.connection_and_power(&(from + way * s)).0 * way).z;
            weight / PARTS as f64 * (1.0 - s) * rate
        })
    };
    (0..PARTS).flat_map(part).sum()
}
