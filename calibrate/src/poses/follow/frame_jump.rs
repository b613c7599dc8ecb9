//! Reflectors that are seen again at once, but away from where they ought to be: the frame of the cameras jumped.

use super::Row;
use super::pairs::{Candidate, Pairs};
use super::walk::{Motion, State, next};

/// In more rows than this both labels must be elsewhere, one row after the other, before they are believed.
pub(super) const MOVED: usize = 5;

/// Rows in which both labels are together, away from where the reflectors ought to be.
#[derive(Debug)]
pub(super) struct FrameJump {
    pub(super) rows: Vec<Row>,
    /// After the last of them.
    pub(super) state: State,
}

impl FrameJump {
    /// With another row, if both labels are still there in it.
    pub(super) fn seen(
        before: Option<Self>,
        pairs: &Pairs,
        row: usize,
        time: f64,
        top_speed: f64,
        candidates: &[Candidate],
    ) -> Option<Self> {
        let pair = match &before {
            None => pairs.begin(candidates),
            Some(Self { state, .. }) => next(pairs, state, time, top_speed, candidates, &[]),
        };
        let (front, back) = pair.filter(|(front, back)| pairs.has_both_labels(front.0, back.0))?;
        let motion = |at: &Candidate| Motion::new(at.1);
        let mut rows = before.map_or_else(Vec::new, |before| before.rows);
        rows.push(Row {
            index: row,
            front: front.1,
            back: back.1,
            labels: pairs.labels(front.0, back.0),
            miss: None,
            begins: rows.is_empty(),
        });
        Some(Self {
            rows,
            state: State {
                time,
                front: motion(&front),
                back: motion(&back),
            },
        })
    }
}
