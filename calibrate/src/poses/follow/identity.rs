//! Assignment of front and back, from segment to segment and in a whole run.
//!
//! Geometry comes first: over a gap in which the robot cannot have turned far, the heading continues, whatever names the points
//! have after it. Segments that it joins are one group. Names come second, and only if they agree: an exchange that is reversed
//! later is a swap, but names that change sides for good, or for more than a quarter of a group, may be wrong in most of its rows.
//! Then the direction of travel decides.

use std::f64::consts::FRAC_PI_3;

use nalgebra::Vector3;

use super::Row;
use super::search::Search;

/// Contradicting names are swaps up to this share of a group's rows, if the names at its ends are alike,
const SWAPS: f64 = 0.25;
/// otherwise up to this share, which is also the share of rows that counts as an end.
const END: f64 = 0.02;
/// Rows at the ends of a gap whose heading is taken.
const ENDS: usize = 5;
/// Interval over which the robot's rotation is observed \[s\].
const WATCHED_S: f64 = 0.5;

/// Rows whose front and back are settled.
pub(super) struct Settled {
    pub(super) rows: Vec<Row>,
    /// Groups that nothing joins to the others.
    pub(super) lost_segments: usize,
    pub(super) lost_rows: usize,
    /// The minority's share, where names contradict each other too often to be believed.
    pub(super) contested: Option<f64>,
}

/// Labels of a group.
enum Names {
    Silent,
    Agree,
    Exchanged,
    Contested(f64),
}

pub(super) fn settle(search: &Search<'_>, rows: Vec<Row>, starts: &[usize]) -> Settled {
    let groups = groups(search, rows, starts);
    let alone = groups.len() == 1;
    let mut settled = Settled {
        rows: Vec::new(),
        lost_segments: 0,
        lost_rows: 0,
        contested: None,
    };
    for mut group in groups {
        match names(&group) {
            Names::Agree => {}
            Names::Exchanged => group.iter_mut().for_each(exchange),
            // Of use only where there is no other that could contradict it.
            Names::Silent if alone => {}
            Names::Contested(share) if alone => {
                settled.contested = Some(share);
                // The names of most rows stand for the right ones in the report.
                if majority(&group) < 0 {
                    group.iter_mut().for_each(exchange);
                }
            }
            Names::Silent | Names::Contested(_) => {
                settled.lost_segments += 1;
                settled.lost_rows += group.len();
                continue;
            }
        }
        settled.rows.append(&mut group);
    }
    settled
}

fn exchange(row: &mut Row) {
    std::mem::swap(&mut row.front, &mut row.back);
    row.labels = row.labels.map(|agrees| !agrees);
}

/// Rows whose names agree less those whose names contradict.
fn majority(group: &[Row]) -> i64 {
    let votes = group.iter().filter_map(|row| row.labels);
    votes.map(|agrees| if agrees { 1 } else { -1 }).sum()
}

fn names(group: &[Row]) -> Names {
    let named = group.iter().filter(|row| row.labels.is_some()).count();
    let balance = majority(group);
    if named == 0 {
        return Names::Silent;
    }
    let minority = 0.5 * (1.0 - balance.unsigned_abs() as f64 / named as f64);
    let votes: Vec<bool> = group.iter().filter_map(|row| row.labels).collect();
    if minority > SWAPS || (minority > END && change_sides(&votes)) {
        Names::Contested(minority)
    } else if balance > 0 {
        Names::Agree
    } else {
        Names::Exchanged
    }
}

/// Returns `true` if the names at the end differ from those at the beginning.
fn change_sides(votes: &[bool]) -> bool {
    let rows = (votes.len() / 50).max(ENDS).min(votes.len());
    let agree = |end: &[bool]| 2 * end.iter().filter(|agrees| **agrees).count() > end.len();
    let (first, last) = (votes.get(..rows), votes.get(votes.len() - rows..));
    first.map(agree) != last.map(agree)
}

/// Segments, joined if the heading continues from one to the next.
fn groups(search: &Search<'_>, rows: Vec<Row>, starts: &[usize]) -> Vec<Vec<Row>> {
    let fastest = fastest_turn(search, &rows);
    let mut groups: Vec<Vec<Row>> = Vec::new();
    let ends = starts.iter().skip(1).copied().chain([rows.len()]);
    let mut rows = rows.into_iter();
    for (start, end) in starts.iter().copied().zip(ends) {
        let mut segment: Vec<Row> = rows.by_ref().take(end - start).collect();
        let goes_on = groups
            .last()
            .and_then(|before| goes_on(search, before, &segment, fastest));
        match (groups.last_mut(), goes_on) {
            (Some(group), Some(same)) => {
                if !same {
                    segment.iter_mut().for_each(exchange);
                }
                group.append(&mut segment);
            }
            _ => groups.push(segment),
        }
    }
    groups
}

/// Returns `true` if the heading continues and `false` if it is reversed; `None` if the gap is too long for that.
fn goes_on(
    search: &Search<'_>,
    before: &[Row],
    after: &[Row],
    fastest: Option<f64>,
) -> Option<bool> {
    let gap_s = search.time(after.first()?) - search.time(before.last()?);
    if gap_s * fastest? > FRAC_PI_3 {
        return None;
    }
    let along = |rows: &[Row]| -> Vector3<f64> { rows.iter().map(axis).sum() };
    let from = along(before.get(before.len().saturating_sub(ENDS)..)?);
    let to = along(after.get(..ENDS.min(after.len()))?);
    let cosine = from.dot(&to) / (from.norm() * to.norm());
    (cosine.abs() > 0.5).then_some(cosine > 0.0)
}

/// The unit vector from back to front.
fn axis(row: &Row) -> Vector3<f64> {
    (row.front - row.back).normalize()
}

/// The fastest turning that was seen \[rad/s\].
fn fastest_turn(search: &Search<'_>, rows: &[Row]) -> Option<f64> {
    let mut fastest: Option<f64> = None;
    let mut from = 0;
    for (until, row) in rows.iter().enumerate() {
        if row.begins {
            from = until;
        }
        let Some(first) = rows.get(from) else {
            continue;
        };
        let seconds = search.time(row) - search.time(first);
        if seconds >= WATCHED_S {
            let turn = axis(first).dot(&axis(row)).clamp(-1.0, 1.0).acos();
            fastest = Some(fastest.unwrap_or(0.0).max(turn / seconds));
            from += 1;
        }
    }
    fastest
}
