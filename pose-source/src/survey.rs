//! Counts over a stream: rate, latency, blanks, jumps. Memory is bounded for any length of it.

use std::collections::{BTreeMap, VecDeque};

use serde::Serialize;

use crate::{Frame, Marker};

/// Recent values that medians are taken of.
const RECENT: usize = 512;
/// Named points that are counted one by one.
const MOST_POINTS: usize = 256;
/// A point jumps if it moves farther than this between two sightings \[m\],
const JUMP_M: f64 = 0.02;
/// and than this distance per second \[m/s\]: robots that swim by their shape are much slower.
const JUMP_SPEED: f64 = 0.5;
/// Steps between stamps that are longer than the median by this factor have lost frames in them.
const LOST: f64 = 1.5;
/// Heights vary so little over a tank \[m\].
const FLAT_M: f64 = 0.005;

/// Counts of one named point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointCount {
    /// Its name.
    pub name: String,
    /// Frames that list it.
    pub present: u64,
    /// Frames since its first that do not.
    pub blanks: u64,
    /// Runs of such frames.
    pub gaps: u64,
    /// The longest of them \[s\].
    pub longest_gap_s: f64,
    /// Number of movements that are too large for a robot in the tank.
    pub jumps: u64,
}

/// Counts of one rigid body.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BodyCount {
    /// Its name.
    pub name: String,
    /// Frames that track it.
    pub present: u64,
}

/// Counts of a stream.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Frames.
    pub frames: u64,
    /// Time on the camera clock from the first to the last \[s\].
    pub duration_s: f64,
    /// Frames per second: from the median step of recent stamps; `None` before the second frame.
    pub rate_hz: Option<f64>,
    /// Frames that are missing between stamps.
    pub lost_frames: u64,
    /// Median delay between exposure and transmission, over recent frames \[s\]; `None` if the source does not state it.
    pub latency_s: Option<f64>,
    /// 95 % of recent frames arrived within this of the quickest \[s\].
    pub jitter_s: Option<f64>,
    /// Named points, by name.
    pub points: Vec<PointCount>,
    /// Frames in which a named point that was seen before is blank.
    pub blanks: u64,
    /// Jumps of all named points.
    pub jumps: u64,
    /// Mean number of unlabeled points.
    pub unlabeled: f64,
    /// Rigid bodies, by name.
    pub bodies: Vec<BodyCount>,
    /// The points move up and down more than in the plane: the axes are probably wrong.
    pub upright: bool,
}

#[derive(Debug, Clone)]
struct Point {
    count: PointCount,
    last: Marker,
    last_stamp_s: f64,
    last_frame: u64,
    first: [f64; 3],
    sum: [f64; 3],
    squares: [f64; 3],
}

/// Counts frames as they go by.
///
/// ```
/// use pose_source::{JsonLines, Mapping, Survey};
///
/// let mut survey = Survey::default();
/// let mut lines = JsonLines::new(Mapping::Z_UP);
/// let text = "{\"t\": 0, \"points\": {\"A\": [0, 0]}}\n{\"t\": 0.01}\n{\"t\": 0.02, \"points\": {\"A\": [0, 0.5]}}\n";
/// lines.receive(text.as_bytes(), 0.0, |frame| survey.push(&frame));
/// let summary = survey.summary();
/// assert_eq!((summary.frames, summary.blanks, summary.jumps), (3, 1, 1));
/// assert!((summary.rate_hz.unwrap() - 100.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Survey {
    frames: u64,
    duration_s: f64,
    last_stamp_s: Option<f64>,
    steps: VecDeque<f64>,
    latencies: VecDeque<f64>,
    delays: VecDeque<f64>,
    lost_frames: u64,
    points: BTreeMap<String, Point>,
    blanks: u64,
    unlabeled: u64,
    bodies: BTreeMap<String, u64>,
}

impl Survey {
    /// Adds a frame.
    pub fn push(&mut self, frame: &Frame) {
        if let Some(last_s) = self.last_stamp_s {
            let step_s = frame.stamp_s - last_s;
            // A clock that was set back is no step.
            if step_s > 0.0 {
                self.count_lost(step_s);
                self.duration_s += step_s;
                keep(&mut self.steps, step_s);
            }
        }
        self.last_stamp_s = Some(frame.stamp_s);
        if let Some(latency_s) = frame.latency_s {
            keep(&mut self.latencies, latency_s);
        }
        keep(&mut self.delays, frame.received_s - frame.stamp_s);
        let number = self.frames;
        self.frames += 1;
        for marker in &frame.markers {
            match &marker.name {
                None => self.unlabeled += 1,
                Some(name) => self.mark(name, marker, frame.stamp_s, number),
            }
        }
        let mut blank = false;
        for point in self.points.values_mut() {
            if point.last_frame != number {
                blank = true;
                point.count.blanks += 1;
                point.count.gaps += u64::from(point.last_frame + 1 == number);
                let gap_s = frame.stamp_s - point.last_stamp_s;
                point.count.longest_gap_s = point.count.longest_gap_s.max(gap_s);
            }
        }
        self.blanks += u64::from(blank);
        for body in &frame.bodies {
            let name = body
                .name
                .clone()
                .unwrap_or_else(|| format!("body {}", body.id));
            if self.bodies.contains_key(&name) || self.bodies.len() < MOST_POINTS {
                *self.bodies.entry(name).or_default() += 1;
            }
        }
    }

    fn count_lost(&mut self, step_s: f64) {
        let Some(usual_s) = median(&self.steps).filter(|usual| step_s > LOST * usual) else {
            return;
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive; saturates"
        )]
        let missing = (step_s / usual_s - 1.0).round() as u64;
        self.lost_frames = self.lost_frames.saturating_add(missing);
    }

    fn mark(&mut self, name: &str, marker: &Marker, stamp_s: f64, number: u64) {
        let position = marker.position();
        if let Some(point) = self.points.get_mut(name) {
            // Twice in one frame: the first counts.
            if point.last_frame == number {
                return;
            }
            let away = |(a, b): (f64, f64)| (a - b).powi(2);
            let moved = position.into_iter().zip(point.last.position());
            let moved_m = moved.map(away).sum::<f64>().sqrt();
            let passed_s = (stamp_s - point.last_stamp_s).max(0.0);
            point.count.jumps += u64::from(moved_m > JUMP_M + JUMP_SPEED * passed_s);
            point.count.present += 1;
            point.last = marker.clone();
            (point.last_stamp_s, point.last_frame) = (stamp_s, number);
            for (axis, value) in position.into_iter().enumerate() {
                let away = value - point.first.get(axis).copied().unwrap_or(0.0);
                point.sum[axis] += away;
                point.squares[axis] += away * away;
            }
        } else if self.points.len() < MOST_POINTS {
            let count = PointCount {
                name: name.to_owned(),
                present: 1,
                blanks: 0,
                gaps: 0,
                longest_gap_s: 0.0,
                jumps: 0,
            };
            let point = Point {
                count,
                last: marker.clone(),
                last_stamp_s: stamp_s,
                last_frame: number,
                first: position,
                sum: [0.0; 3],
                squares: [0.0; 3],
            };
            self.points.insert(name.to_owned(), point);
        }
    }

    /// Last position of each named point \[m\], by name.
    pub fn last_places(&self) -> impl Iterator<Item = (&str, [f64; 3])> {
        self.points
            .iter()
            .map(|(name, point)| (name.as_str(), point.last.position()))
    }

    /// Counts so far.
    pub fn summary(&self) -> Summary {
        let points: Vec<PointCount> = self.points.values().map(|p| p.count.clone()).collect();
        let mut delays: Vec<f64> = self.delays.iter().copied().collect();
        delays.sort_by(f64::total_cmp);
        let jitter_s = delays.first().and_then(|least| {
            let late = delays.get(delays.len() * 19 / 20)?;
            Some(late - least)
        });
        Summary {
            frames: self.frames,
            duration_s: self.duration_s,
            rate_hz: median(&self.steps).map(|step_s| 1.0 / step_s),
            lost_frames: self.lost_frames,
            latency_s: median(&self.latencies),
            jitter_s,
            blanks: self.blanks,
            jumps: points.iter().map(|point| point.jumps).sum(),
            points,
            unlabeled: self.unlabeled as f64 / self.frames.max(1) as f64,
            bodies: self
                .bodies
                .iter()
                .map(|(name, present)| BodyCount {
                    name: name.clone(),
                    present: *present,
                })
                .collect(),
            upright: self.points.values().any(Point::is_upright),
        }
    }
}

impl Point {
    fn is_upright(&self) -> bool {
        let count = self.count.present.max(1) as f64;
        let [x, y, z] = [0, 1, 2].map(|axis: usize| {
            (self.squares[axis] / count - (self.sum[axis] / count).powi(2)).max(0.0)
        });
        z > FLAT_M.powi(2) && z > 4.0 * x.min(y)
    }
}

fn keep(recent: &mut VecDeque<f64>, value: f64) {
    if recent.len() >= RECENT {
        recent.pop_front();
    }
    recent.push_back(value);
}

fn median(values: &VecDeque<f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.iter().copied().collect();
    let middle = values.len() / 2;
    (middle < values.len()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(stamp_s: f64, points: &[(&str, [f64; 3])]) -> Frame {
        Frame {
            stamp_s,
            received_s: stamp_s + 0.5,
            latency_s: Some(0.02),
            markers: points
                .iter()
                .map(|(name, [x_m, y_m, z_m])| Marker {
                    name: (!name.is_empty()).then(|| (*name).to_owned()),
                    id: None,
                    x_m: *x_m,
                    y_m: *y_m,
                    z_m: *z_m,
                })
                .collect(),
            bodies: Vec::new(),
        }
    }

    #[test]
    fn blanks_gaps_jumps_and_lost_frames_are_counted() {
        let mut survey = Survey::default();
        for step in 0..100_u32 {
            // Three frames are lost in transit.
            if (50..53).contains(&step) {
                continue;
            }
            let (t, x) = (f64::from(step) * 0.01, f64::from(step) * 1e-4);
            let jump = if step == 80 { 0.3 } else { 0.0 };
            let mut points = vec![("", [x, 1.0, 0.05]), ("Back", [x, 0.0, 0.05])];
            if !(20..30).contains(&step) && step != 40 {
                points.push(("Front", [x + jump, 0.1, 0.05]));
            }
            survey.push(&frame(t, &points));
        }
        let summary = survey.summary();
        assert_eq!((summary.frames, summary.lost_frames), (97, 3));
        assert!((summary.rate_hz.unwrap() - 100.0).abs() < 1e-6);
        assert!((summary.duration_s - 0.99).abs() < 1e-9);
        assert_eq!((summary.blanks, summary.jumps), (11, 2), "there and back");
        let [back, front] = summary.points.as_slice() else {
            panic!("{summary:?}");
        };
        assert_eq!((back.present, back.blanks), (97, 0));
        assert_eq!((front.present, front.blanks, front.gaps), (86, 11, 2));
        assert!((front.longest_gap_s - 0.1).abs() < 1e-9, "{front:?}");
        assert!((summary.unlabeled - 1.0).abs() < 1e-12 && !summary.upright);
        assert!((summary.latency_s.unwrap() - 0.02).abs() < 1e-12);
        assert!(summary.jitter_s.unwrap().abs() < 1e-9);
    }

    #[test]
    fn wrong_axes_show() {
        let mut survey = Survey::default();
        for step in 0..100 {
            let t = f64::from(step) * 0.01;
            survey.push(&frame(t, &[("A", [0.1 * t, 0.05, 0.1 * (6.0 * t).sin()])]));
        }
        assert!(survey.summary().upright);
    }

    #[test]
    fn memory_is_bounded() {
        let mut survey = Survey::default();
        for step in 0..2000 {
            let name = format!("P{step}");
            survey.push(&frame(f64::from(step), &[(&name, [0.0; 3])]));
        }
        assert!(survey.steps.len() <= RECENT && survey.points.len() <= MOST_POINTS);
        assert_eq!(survey.summary().frames, 2000);
    }
}
