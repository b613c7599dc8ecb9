//! Cameras of the laboratory: noise, scale, tilt, bumps, drift, exchanged labels, ghosts, gaps.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::body::Body;
use super::swim::State;

/// The cameras of a laboratory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cameras {
    pub(crate) rate_hz: f64,
    /// Deviation of each coordinate \[m\].
    pub(crate) noise: f64,
    /// Measured over true length.
    pub(crate) scale: f64,
    /// Turn of the camera's plane out of the tank's, about its x \[rad\]: a flat table loses the height.
    pub(crate) tilt: f64,
    /// Share by which a place one metre from the lens's axis, which meets the tank at its origin, is seen further out.
    pub(crate) distortion: f64,
    /// Chance that a reflector is missing in a frame.
    pub(crate) dropout: f64,
    /// Chance that a ghost appears in a frame; it stays 50 frames on average.
    pub(crate) ghosts: f64,
}

impl Cameras {
    pub(crate) const FULL: Self = Self {
        rate_hz: 100.0,
        noise: 3e-4,
        scale: 1.0,
        tilt: 0.0,
        distortion: 0.0,
        dropout: 0.0,
        ghosts: 0.0,
    };
    /// The number of rows that a cycle of ten seconds needs, for soaks of hundreds of campaigns.
    pub(crate) const SPARSE: Self = Self {
        rate_hz: 20.0,
        ..Self::FULL
    };
}

/// A camera that was knocked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bump {
    pub(crate) at_s: f64,
    /// \[m\].
    pub(crate) shift: [f64; 2],
    /// \[rad\].
    pub(crate) turn: f64,
}

/// Faults of one run.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Faults {
    /// Velocity of the fluid \[m/s\].
    pub(crate) drift: [f64; 2],
    /// Stretches (from, for \[s\]) in which the labels of front and back are exchanged.
    pub(crate) swaps: Vec<[f64; 2]>,
    /// The labels are exchanged from the first frame to the last, swaps apart.
    pub(crate) exchanged: bool,
    /// Stretches (from, for \[s\]) in which nothing is seen.
    pub(crate) gaps: Vec<[f64; 2]>,
    pub(crate) bumps: Vec<Bump>,
    /// A still reflection (x, y \[m\]) that is seen all the time.
    pub(crate) reflections: Vec<[f64; 2]>,
}

/// True positions of the reflectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Places {
    /// On the middle link from its centre: along it, to its left \[m\].
    pub(crate) front: [f64; 2],
    pub(crate) back: [f64; 2],
    /// On the side links from their joints: outwards, to the left of that \[m\]; `None` for no such reflectors.
    pub(crate) sides: Option<[[f64; 2]; 2]>,
}

/// Front, back, front link, back link, then ghosts and reflections; (x, y, height) \[m\].
pub(crate) type Frame = Vec<Option<[f64; 3]>>;

/// Ghosts that may be there at a time.
const GHOSTS: usize = 2;
/// Height of the reflectors \[m\].
const HEIGHT: f64 = 0.05;

pub(crate) fn see(
    states: &[State],
    body: &Body,
    places: &Places,
    cameras: &Cameras,
    faults: &Faults,
    seed: u64,
) -> Vec<Frame> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut ghosts = [None; GHOSTS];
    let mut frames = Vec::with_capacity(states.len());
    for (index, state) in states.iter().enumerate() {
        let t = index as f64 / cameras.rate_hz;
        let within = |stretches: &[[f64; 2]]| {
            stretches
                .iter()
                .any(|[from, long]| t >= *from && t < from + long)
        };
        let blind = within(&faults.gaps);
        let mut frame: Frame = Vec::with_capacity(8);
        let true_points = points(state, body, places);
        for point in &true_points {
            let lost = blind || rng.random::<f64>() < cameras.dropout;
            let seen = seen(*point, t, cameras, faults, &mut rng);
            frame.push((!lost).then_some(seen));
        }
        if within(&faults.swaps) != faults.exchanged {
            frame.swap(0, 1);
        }
        if cameras.ghosts > 0.0 {
            for ghost in &mut ghosts {
                let (x, y): (f64, f64) = (rng.random(), rng.random());
                let chance: f64 = rng.random();
                *ghost = match *ghost {
                    None if chance < cameras.ghosts => Some([
                        state[0] + 0.3 * (x - 0.5),
                        state[1] + 0.3 * (y - 0.5),
                        HEIGHT,
                    ]),
                    Some(_) if chance < 0.02 => None,
                    same => same,
                };
                frame.push(*ghost);
            }
        }
        for reflection in &faults.reflections {
            let place = [reflection[0], reflection[1], HEIGHT];
            frame.push(Some(place));
        }
        frames.push(frame);
    }
    frames
}

/// Positions of the reflectors in the tank.
fn points(state: &State, body: &Body, places: &Places) -> Vec<[f64; 2]> {
    let [x, y, theta, phi1, phi2] = *state;
    let from = |origin: [f64; 2], direction: f64, place: [f64; 2]| {
        let (sin, cos) = direction.sin_cos();
        [
            origin[0] + cos * place[0] - sin * place[1],
            origin[1] + sin * place[0] + cos * place[1],
        ]
    };
    let mut points = vec![
        from([x, y], theta, places.front),
        from([x, y], theta, places.back),
    ];
    if let Some([front, back]) = places.sides {
        let joint = |along: f64| from([x, y], theta, [along, 0.0]);
        let half = body.middle / 2.0;
        points.push(from(joint(half), theta + phi1, front));
        let backwards = theta + std::f64::consts::PI - phi2;
        points.push(from(joint(-half), backwards, back));
    }
    points
}

fn seen(
    point: [f64; 2],
    t: f64,
    cameras: &Cameras,
    faults: &Faults,
    rng: &mut ChaCha8Rng,
) -> [f64; 3] {
    let drifted = [
        point[0] + faults.drift[0] * t,
        point[1] + faults.drift[1] * t,
    ];
    let (sin, cos) = cameras.tilt.sin_cos();
    let mut place = [
        cameras.scale * drifted[0],
        cameras.scale * (drifted[1] * cos - HEIGHT * sin),
        cameras.scale * (drifted[1] * sin + HEIGHT * cos),
    ];
    let further = 1.0 + cameras.distortion * (place[0].powi(2) + place[1].powi(2));
    place[0] *= further;
    place[1] *= further;
    for bump in faults.bumps.iter().filter(|bump| t >= bump.at_s) {
        let (sin, cos) = bump.turn.sin_cos();
        let [x, y, _] = place;
        place[0] = cos * x - sin * y + bump.shift[0];
        place[1] = sin * x + cos * y + bump.shift[1];
    }
    if cameras.noise > 0.0 {
        for value in &mut place {
            let normal: f64 = StandardNormal.sample(rng);
            *value += cameras.noise * normal;
        }
    }
    place
}
