//! Chains of legs that meet a target.

use nalgebra::{DVector, Matrix3xX, Vector3};
use swimmer_model::{Pose, wrapped_angle};

use super::Step;
use super::member::{Kind, Member, Nets, SMALLEST, repeated};

/// Legs of a chain: their scales meet the three coordinates of a target.
const MOST: usize = 3;
/// Rotations of a leg that Newton's method starts from, and amounts of the others.
const TURNS: usize = 8;
/// Amounts that are alike \[cycles\].
const ALIKE: f64 = 0.05;
const STEPS: usize = 30;
/// Scales of a chain that is to be aimed yet.
pub(super) const LARGEST: f64 = 0.985;
/// Cycles of a leg.
const MOST_CYCLES: f64 = 400.0;
/// A target is met so closely (m and rad).
const MET: f64 = 1e-10;

/// All chains with the wanted net pose that are found, from the common shape to the common shape.
pub(super) fn chains(nets: &Nets, wanted: &Pose<f64>) -> Vec<Vec<Step>> {
    let of = |word| Search {
        nets,
        wanted: *wanted,
        word,
    };
    let words = words().into_iter();
    words.flat_map(|word| of(word).chains()).collect()
}

/// All orders of three legs of which no two neighbours are alike.
fn words() -> Vec<[Kind; MOST]> {
    let mut words = Vec::new();
    for one in Kind::ALL {
        for two in Kind::ALL {
            for three in Kind::ALL {
                if one != two && two != three {
                    words.push([one, two, three]);
                }
            }
        }
    }
    words
}

struct Search<'a> {
    nets: &'a Nets,
    wanted: Pose<f64>,
    word: [Kind; MOST],
}

impl Search<'_> {
    fn chains(&self) -> Vec<Vec<Step>> {
        let mut amounts: Vec<DVector<f64>> = Vec::new();
        for start in self.starts() {
            let Some(found) = newton(start, |amounts| {
                off(&(self.wanted.inverse() * self.roughly(amounts)))
            }) else {
                continue;
            };
            let alike = |other: &DVector<f64>| (other - &found).amax() < ALIKE;
            if found.amax() < MOST_CYCLES && !amounts.iter().any(alike) {
                amounts.push(found);
            }
        }
        amounts
            .iter()
            .filter_map(|amounts| self.whole(amounts))
            .collect()
    }

    fn starts(&self) -> Vec<DVector<f64>> {
        let turn = self.full(Kind::Turn).theta;
        let rotation = wrapped_angle(self.wanted.theta);
        let tau = std::f64::consts::TAU;
        let mut starts = Vec::new();
        for whole in [0.0, 1.0, -1.0] {
            for k in 0..TURNS {
                let share = tau * (k as f64 / TURNS as f64 - 0.5);
                let mut left = rotation + whole * tau;
                let mut start = DVector::zeros(MOST);
                let turns = self.word.iter().filter(|kind| **kind == Kind::Turn).count();
                for (leg, kind) in self.word.iter().enumerate() {
                    if *kind == Kind::Turn {
                        let first = turns == 2 && leg == 0;
                        let part = if first { share } else { left };
                        start[leg] = part / turn;
                        left -= part;
                    } else {
                        // Either way.
                        start[leg] = if k % 2 == 0 { 3.0 } else { -3.0 };
                    }
                }
                starts.push(start);
                if turns < 2 && k > 0 {
                    break;
                }
            }
        }
        starts
    }

    fn full(&self, kind: Kind) -> Pose<f64> {
        self.nets.of(&kind.of_scale(1.0))
    }

    /// Net pose for real numbers of cycles.
    fn roughly(&self, amounts: &DVector<f64>) -> Pose<f64> {
        let legs = self.word.iter().zip(amounts.iter());
        legs.fold(Pose::identity(), |sum, (kind, amount)| {
            sum * power(&self.full(*kind), *amount)
        })
    }

    /// Legs of whole cycles with the same net pose. Returns `None` without a solution.
    fn whole(&self, amounts: &DVector<f64>) -> Option<Vec<Step>> {
        let legs = self.word.iter().zip(amounts.iter());
        let legs = legs.filter(|(_, amount)| amount.abs() > 1e-9);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole numbers from 1 to 400"
        )]
        let steps = legs.map(|(kind, amount)| {
            let cycles = (amount.abs() - 1e-9).ceil().max(1.0);
            let scale = self.nets.scale(*kind, amount.abs() / cycles);
            let member = Member {
                kind: *kind,
                backwards: *amount < 0.0,
                scale,
            };
            self.nets.step(member, cycles as u32)
        });
        let steps: Vec<Step> = steps.collect();
        settled(self.nets, &self.wanted, &steps, LARGEST)
    }
}

/// These steps with scales for the wanted net pose, and with more cycles for scales above 1. The scales nearest to those of the
/// steps are taken, none larger than `largest`. Returns `None` without a solution.
pub(super) fn settled(
    nets: &Nets,
    wanted: &Pose<f64>,
    steps: &[Step],
    largest: f64,
) -> Option<Vec<Step>> {
    let mut steps = steps.to_vec();
    let inverse = wanted.inverse();
    for _ in 0..8 {
        let start = DVector::from_iterator(steps.len(), steps.iter().map(|step| step.member.scale));
        let found = newton(start, |scales| {
            let legs = steps.iter().zip(scales.iter());
            let pose = legs.fold(Pose::identity(), |sum, (step, scale)| {
                let member = Member {
                    scale: scale.clamp(SMALLEST, 1.5),
                    ..step.member
                };
                sum * repeated(&nets.of(&member), step.cycles)
            });
            off(&(inverse * pose))
        })?;
        let mut beyond = false;
        for (step, &scale) in steps.iter_mut().zip(found.iter()) {
            if scale < SMALLEST {
                return None;
            }
            let member = Member {
                scale: scale.min(1.0),
                ..step.member
            };
            *step = nets.step(member, step.cycles);
            if scale > largest {
                beyond = true;
                *step = with_cycles(nets, step, step.cycles + 1);
            }
        }
        if !beyond {
            return Some(steps);
        }
    }
    None
}

/// A leg with this number of cycles and about the same net pose.
pub(super) fn with_cycles(nets: &Nets, leg: &Step, cycles: u32) -> Step {
    let share = nets.share(&leg.member) * f64::from(leg.cycles) / f64::from(cycles);
    let member = Member {
        scale: nets.scale(leg.member.kind, share),
        ..leg.member
    };
    nets.step(member, cycles)
}

/// A pose near the identity as three numbers.
fn off(pose: &Pose<f64>) -> Vector3<f64> {
    Vector3::new(pose.x, pose.y, wrapped_angle(pose.theta))
}

/// A pose to a real power: along its screw.
pub(super) fn power(pose: &Pose<f64>, amount: f64) -> Pose<f64> {
    if (amount - 1.0).abs() < f64::EPSILON {
        return *pose;
    }
    let half = 0.5 * pose.theta;
    // Of the twist whose exponential is the pose.
    let stretch = if half.abs() < 1e-9 {
        1.0
    } else {
        half / half.tan()
    };
    let twist = Vector3::new(
        stretch * pose.x + half * pose.y,
        -half * pose.x + stretch * pose.y,
        pose.theta,
    );
    Pose::exp(&(twist * amount))
}

/// A zero of three functions near `start`, by a damped Newton method with finite differences. Each step is the shortest solution
/// of the linearised equations. Returns `None` if it does not converge.
fn newton(start: DVector<f64>, of: impl Fn(&DVector<f64>) -> Vector3<f64>) -> Option<DVector<f64>> {
    const DIFFERENCE: f64 = 1e-6;
    let mut here = start;
    let mut off = of(&here);
    for _ in 0..STEPS {
        if off.amax() < MET {
            return Some(here);
        }
        let mut slopes = Matrix3xX::zeros(here.len());
        for k in 0..here.len() {
            let (mut up, mut down) = (here.clone(), here.clone());
            up[k] += DIFFERENCE;
            down[k] -= DIFFERENCE;
            slopes.set_column(k, &((of(&up) - of(&down)) / (2.0 * DIFFERENCE)));
        }
        let step = -(slopes.pseudo_inverse(1e-9).ok()? * off);
        let mut length = 1.0;
        loop {
            let there = &here + &step * length;
            let after = of(&there);
            if after.norm() < off.norm() {
                (here, off) = (there, after);
                break;
            }
            length *= 0.5;
            if length < 1e-3 {
                return None;
            }
        }
    }
    (off.amax() < MET).then_some(here)
}
