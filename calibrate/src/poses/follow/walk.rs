//! Two points followed from row to row by their distance and by constant velocity.

use nalgebra::Vector3;

use super::Row;
use super::frame_jump::{FrameJump, MOVED};
use super::pairs::{Candidate, Pairs, REACH};
use super::search::Search;

/// Smoothing time of the velocity \[s\].
const SMOOTHING_S: f64 = 0.2;
/// Longest gap before a speed is known \[s\].
const FIRST_GAP_S: f64 = 1.0;
/// Number of rows of a segment before its speeds count.
const OLD: usize = 50;
/// Least number of rows that a gap may last at any speed.
const LEAST_GAP: f64 = 2.5;

/// Place and velocity of a reflector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    place: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl Motion {
    pub(super) fn new(place: Vector3<f64>) -> Self {
        Self {
            place,
            velocity: Vector3::zeros(),
        }
    }

    fn moved(self, place: Vector3<f64>, dt: f64) -> Self {
        let weight = (dt / SMOOTHING_S).min(1.0);
        let velocity = self.velocity + ((place - self.place) / dt - self.velocity) * weight;
        Self { place, velocity }
    }

    fn after(self, dt: f64) -> Vector3<f64> {
        self.place + self.velocity * dt
    }
}

/// State of the previous row.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) time: f64,
    pub(super) front: Motion,
    pub(super) back: Motion,
}

/// Follows the pair through all rows. Returns the rows with both reflectors, and the index in them of each segment's first.
pub(super) fn walk(search: &Search<'_>) -> (Vec<Row>, Vec<usize>) {
    let (mut rows, mut starts): (Vec<Row>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut candidates = Vec::new();
    let mut walker = Walker::default();
    for (row, time) in search.track.times.iter().copied().enumerate() {
        search.candidates(row, &mut candidates);
        for found in walker.step(&search.pairs, row, time, &candidates) {
            if found.begins {
                starts.push(rows.len());
            }
            rows.push(found);
        }
    }
    (rows, starts)
}

/// The state of following, from row to row.
#[derive(Debug, Default)]
pub(super) struct Walker {
    state: Option<State>,
    top_speed: f64,
    /// Points of the row before that are no reflectors.
    others: Vec<Vector3<f64>>,
    jump: Option<FrameJump>,
    /// Rows since the segment began.
    rows: usize,
}

impl Walker {
    /// Expects reflectors that are at least so fast \[m/s\].
    pub(super) fn at_speed(top_speed: f64) -> Self {
        Self {
            top_speed,
            ..Self::default()
        }
    }

    /// Takes a row. Returns it if both reflectors are found, or the rows of a frame jump once they are believed.
    pub(super) fn step(
        &mut self,
        pairs: &Pairs,
        row: usize,
        time: f64,
        candidates: &[Candidate],
    ) -> Vec<Row> {
        let longest = if self.top_speed > 0.0 {
            pairs.distance / (2.0 * self.top_speed)
        } else {
            FIRST_GAP_S
        };
        let longest = longest.max(LEAST_GAP * pairs.step_s);
        self.state = self.state.filter(|s| time - s.time <= longest);
        let found = match &self.state {
            None => pairs.begin(candidates),
            Some(state) => next(pairs, state, time, self.top_speed, candidates, &self.others),
        };
        let before = self.jump.take();
        if let (Some(_), None) = (&self.state, &found) {
            self.jump = FrameJump::seen(before, pairs, row, time, self.top_speed, candidates);
        }
        if let Some(there) = self.jump.take_if(|there| there.rows.len() > MOVED) {
            // The frame jumped: a new segment, from the first of these rows on.
            self.rows = there.rows.len();
            self.state = Some(there.state);
            self.others.clear();
            return there.rows;
        }
        let Some((front, back)) = found else {
            self.keep_others(time, candidates);
            return Vec::new();
        };
        vec![self.go_on(pairs, row, time, candidates, front, back)]
    }

    /// Keeps the other points that are still there; a new point may yet be a reflector.
    fn keep_others(&mut self, time: f64, candidates: &[Candidate]) {
        let Some(state) = &self.state else {
            self.others.clear();
            return;
        };
        let (front, back) = state.predict(time);
        let still = |at: &Vector3<f64>| is_other(at, &front, &back, &self.others);
        self.others = candidates.iter().map(|c| c.1).filter(still).collect();
    }

    fn go_on(
        &mut self,
        pairs: &Pairs,
        row: usize,
        time: f64,
        candidates: &[Candidate],
        front: Candidate,
        back: Candidate,
    ) -> Row {
        self.others.clear();
        let is_chosen = |point: usize| point == front.0 || point == back.0;
        let others = candidates.iter().filter(|c| !is_chosen(c.0));
        self.others.extend(others.map(|c| c.1));
        let miss = self.state.as_ref().map(|state| {
            let (f, b) = state.predict(time);
            (front.1 - f).norm().hypot((back.1 - b).norm())
        });
        self.state = Some(if let Some(state) = self.state {
            let dt = time - state.time;
            let (f, b) = (state.front.moved(front.1, dt), state.back.moved(back.1, dt));
            // Noise alone is fast from one frame to the next; the smoothed velocity after some time is not.
            if self.rows > OLD {
                let fastest = f.velocity.norm().max(b.velocity.norm());
                self.top_speed = self.top_speed.max(fastest);
            }
            State {
                time,
                front: f,
                back: b,
            }
        } else {
            self.rows = 0;
            State {
                time,
                front: Motion::new(front.1),
                back: Motion::new(back.1),
            }
        });
        self.rows += 1;
        Row {
            index: row,
            front: front.1,
            back: back.1,
            labels: pairs.labels(front.0, back.0),
            begins: miss.is_none(),
            miss,
        }
    }
}

impl State {
    fn predict(&self, time: f64) -> (Vector3<f64>, Vector3<f64>) {
        let dt = time - self.time;
        (self.front.after(dt), self.back.after(dt))
    }
}

/// Returns `true` if a candidate is nearer to a point that was no reflector than to the reflectors' predicted positions.
fn is_other(
    at: &Vector3<f64>,
    front: &Vector3<f64>,
    back: &Vector3<f64>,
    others: &[Vector3<f64>],
) -> bool {
    let own = (at - front).norm_squared().min((at - back).norm_squared());
    others.iter().any(|other| (at - other).norm_squared() < own)
}

/// The pair that goes on from a known state.
pub(super) fn next(
    pairs: &Pairs,
    state: &State,
    time: f64,
    top_speed: f64,
    candidates: &[Candidate],
    others: &[Vector3<f64>],
) -> Option<(Candidate, Candidate)> {
    let (front, back) = state.predict(time);
    let blind = (time - state.time - 1.5 * pairs.step_s).max(0.0);
    let (tolerance, reach) = if blind > 0.0 {
        // Beyond the usual step from frame to frame, what a turn at top speed could add.
        let speed = if top_speed > 0.0 {
            top_speed
        } else {
            pairs.distance / FIRST_GAP_S
        };
        let reach = pairs.after_gap.1 + 2.0 * speed * blind;
        (pairs.after_gap.0, reach.min(REACH.1 * pairs.distance))
    } else {
        (pairs.tolerance, REACH.0 * pairs.distance)
    };
    let own: Vec<Candidate> = candidates
        .iter()
        .filter(|c| !is_other(&c.1, &front, &back, others))
        .copied()
        .collect();
    pairs.best(&own, tolerance, |f, b| {
        let miss = (f.1 - front).norm_squared() + (b.1 - back).norm_squared();
        (miss < reach * reach).then_some(miss)
    })
}
