//! Joints and motion of the laboratory's swimmer: a classical Runge–Kutta step from one set of joint angles to the next.

use super::body::{Body, Connection};

/// Model of a joint: φ follows gain · command(t − lag) + offset, with a play of the dead band in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Joint {
    pub(crate) gain: f64,
    /// \[rad\].
    pub(crate) offset: f64,
    /// Half width \[rad\].
    pub(crate) dead_band: f64,
    /// \[s\].
    pub(crate) lag_s: f64,
    /// \[rad/s\].
    pub(crate) max_rate: f64,
}

impl Joint {
    pub(crate) const EXACT: Self = Self {
        gain: 1.0,
        offset: 0.0,
        dead_band: 0.0,
        lag_s: 0.0,
        max_rate: 3.5,
    };

    /// Position of the shaft after a step with the command `wanted`.
    fn follow(&self, shaft: f64, wanted: f64, dt: f64) -> f64 {
        let excess = (wanted - shaft).abs() - self.dead_band;
        let way = excess.max(0.0).min(self.max_rate * dt);
        shaft + way.copysign(wanted - shaft)
    }
}

/// A closed curve of joint angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Loop {
    /// `circle:A` \[rad\].
    Circle(f64),
    /// `square:A` \[rad\].
    Square(f64),
}

impl Loop {
    /// At a fraction of the cycle; counter-clockwise from φ₁ = φ₂ > 0.
    pub(crate) fn at(self, u: f64) -> [f64; 2] {
        match self {
            Self::Circle(radius) => {
                let (sin, cos) = (std::f64::consts::TAU * (u + 0.125)).sin_cos();
                [radius * cos, radius * sin]
            }
            Self::Square(half) => {
                let place = 4.0 * u.rem_euclid(1.0);
                let along = half * (1.0 - 2.0 * place.fract());
                match place {
                    p if p < 1.0 => [along, half],
                    p if p < 2.0 => [-half, along],
                    p if p < 3.0 => [-along, -half],
                    _ => [half, -along],
                }
            }
        }
    }
}

/// One play of a gait: rest at straight, a soft start to the first angles, cycles, rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Play {
    pub(crate) gait: Loop,
    pub(crate) clockwise: bool,
    pub(crate) period_s: f64,
    pub(crate) cycles: u32,
    pub(crate) rest_s: f64,
    pub(crate) soft_s: f64,
}

impl Play {
    pub(crate) fn first_cycle_s(&self) -> f64 {
        self.rest_s + self.soft_s
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.first_cycle_s() + self.period_s * f64::from(self.cycles) + self.rest_s
    }

    /// The commanded angles at a time.
    pub(crate) fn command(&self, t: f64) -> [f64; 2] {
        let u = (t - self.first_cycle_s()) / self.period_s;
        if t <= self.rest_s {
            [0.0; 2]
        } else if u < 0.0 {
            let share = (t - self.rest_s) / self.soft_s;
            self.gait.at(0.0).map(|angle| share * angle)
        } else {
            let u = u.min(f64::from(self.cycles));
            self.gait.at(if self.clockwise { -u } else { u })
        }
    }
}

/// Pose and joint angles at a frame: x, y \[m\], θ, φ₁, φ₂ \[rad\].
pub(crate) type State = [f64; 5];

/// Swims a play; `wall` multiplies every translation, and walls of a tank of the given size act by their images. States at `rate_hz`.
pub(crate) fn swim(
    body: &Body,
    joints: &[Joint; 2],
    play: &Play,
    (wall, tank): (f64, Option<[f64; 2]>),
    rate_hz: f64,
    start: [f64; 3],
) -> Vec<State> {
    let frame_s = 1.0 / rate_hz;
    // Five hundred straight pieces make a circle to 3e-5 of its area.
    let pieces = (frame_s * 500.0 / play.period_s).ceil().max(1.0);
    let dt = frame_s / pieces;
    let mut phi = wanted(joints, play, 0.0);
    let connection_at = |phi: [f64; 2], pose: [f64; 3]| match tank {
        Some(size) => body.connection_in(phi, pose, size),
        None => body.connection(phi),
    };
    let mut pose = start;
    let mut connection = connection_at(phi, pose);
    let state = |pose: [f64; 3], phi: [f64; 2]| [pose[0], pose[1], pose[2], phi[0], phi[1]];
    let mut states = vec![state(pose, phi)];
    let mut time = 0.0;
    while time + frame_s <= play.duration_s() {
        let mut piece = 1.0;
        while piece <= pieces {
            let target = wanted(joints, play, time + piece * dt);
            let next = [
                joints[0].follow(phi[0], target[0], dt),
                joints[1].follow(phi[1], target[1], dt),
            ];
            let change = [next[0] - phi[0], next[1] - phi[1]];
            if change.iter().any(|rate| rate.abs() > 0.0) {
                let between = [phi[0] + change[0] / 2.0, phi[1] + change[1] / 2.0];
                let middle = connection_at(between, pose);
                let end = connection_at(next, pose);
                pose = step(pose, [&connection, &middle, &end], change, wall);
                connection = end;
            }
            phi = next;
            piece += 1.0;
        }
        time = states.len() as f64 * frame_s;
        states.push(state(pose, phi));
    }
    states
}

fn wanted(joints: &[Joint; 2], play: &Play, t: f64) -> [f64; 2] {
    let of = |index: usize| {
        let joint = &joints[index];
        joint.gain * play.command(t - joint.lag_s)[index] + joint.offset
    };
    [of(0), of(1)]
}

/// Runge–Kutta over straight joint motion `change`, with the connections at its beginning, middle and end.
fn step(pose: [f64; 3], a: [&Connection; 3], change: [f64; 2], wall: f64) -> [f64; 3] {
    let slope = |theta: f64, a: &Connection| {
        let v = a.map(|row| row[0] * change[0] + row[1] * change[1]);
        let (sin, cos) = theta.sin_cos();
        [
            wall * (cos * v[0] - sin * v[1]),
            wall * (sin * v[0] + cos * v[1]),
            v[2],
        ]
    };
    let k1 = slope(pose[2], a[0]);
    let k2 = slope(pose[2] + k1[2] / 2.0, a[1]);
    let k3 = slope(pose[2] + k2[2] / 2.0, a[1]);
    let k4 = slope(pose[2] + k3[2], a[2]);
    std::array::from_fn(|i| pose[i] + (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0)
}
