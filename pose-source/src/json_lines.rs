//! JSON lines: one frame per line, from any script.
//!
//! ```json
//! {"t": 12.34, "points": {"Front": [0.10, 0.02], "Back": [0.03, 0.02, 0.05], "Tip": null}, "unlabeled": [[0.3, 0.1]],
//!  "bodies": {"robot": {"position": [0.06, 0.02], "heading_deg": 12.5}}, "latency_ms": 35}
//! ```
//!
//! (in one line). Only `t`, the time of exposure in seconds on any clock that does not stop, is required. Positions are `[x, y]` or
//! `[x, y, z]`; a point that is not seen is left out, or `null`. A body has a `quaternion` `[x, y, z, w]` or a `heading_deg`.
//! `latency_ms` is the delay from exposure to this line, if the script knows it. Other keys are ignored.
//!
//! A malformed line is counted and skipped, and so is a line that is longer than [`LONGEST_LINE`].

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{Frame, Mapping, Marker, RigidBody};

/// Bytes of a line that are read; a longer line is malformed.
pub const LONGEST_LINE: usize = 64 * 1024;

/// A line that is no frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Malformed {
    /// Its number, from 1.
    pub line: u64,
    /// Reason why it is refused.
    pub reason: String,
}

/// Splits bytes into lines and parses them.
///
/// ```
/// use pose_source::{JsonLines, Mapping};
///
/// let mut lines = JsonLines::new(Mapping::Z_UP);
/// let mut frames = Vec::new();
/// for bytes in [&b"{\"t\": 1, \"points\": {\"Fro"[..], b"nt\": [0.1, 0.2]}}\nnonsense\n"] {
///     lines.receive(bytes, 0.5, |frame| frames.push(frame));
/// }
/// assert_eq!(frames.len(), 1);
/// assert_eq!((frames[0].stamp_s, frames[0].marker("Front").unwrap().y_m), (1.0, 0.2));
/// assert_eq!((lines.malformed(), lines.last_malformed().unwrap().line), (1, 2));
/// ```
#[derive(Debug)]
pub struct JsonLines {
    mapping: Mapping,
    line: Vec<u8>,
    /// The rest of the line is skipped.
    overlong: bool,
    lines: u64,
    malformed: u64,
    last_malformed: Option<Malformed>,
}

#[derive(Debug, Default, Deserialize, Serialize)]
struct JsonFrame {
    t: f64,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    points: BTreeMap<String, Option<Vec<f64>>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    unlabeled: Vec<Vec<f64>>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    bodies: BTreeMap<String, Option<Body>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    latency_ms: Option<f64>,
}

#[derive(Debug, Deserialize, Serialize)]
struct Body {
    position: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    quaternion: Option<[f64; 4]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    heading_deg: Option<f64>,
}

impl JsonLines {
    /// A parser for positions in these axes and this unit.
    pub fn new(mapping: Mapping) -> Self {
        Self {
            mapping,
            line: Vec::new(),
            overlong: false,
            lines: 0,
            malformed: 0,
            last_malformed: None,
        }
    }

    /// Malformed lines so far.
    pub fn malformed(&self) -> u64 {
        self.malformed
    }

    /// The last malformed line.
    pub fn last_malformed(&self) -> Option<&Malformed> {
        self.last_malformed.as_ref()
    }

    /// Takes bytes that arrived at `now_s` on the host clock; each frame goes to `take`.
    pub fn receive(&mut self, bytes: &[u8], now_s: f64, mut take: impl FnMut(Frame)) {
        let mut rest = bytes;
        while let Some(end) = rest.iter().position(|byte| *byte == b'\n') {
            let (piece, after) = rest.split_at(end);
            self.append(piece);
            self.end_line(now_s, &mut take);
            rest = after.get(1..).unwrap_or_default();
        }
        self.append(rest);
    }

    /// Takes the last line, if it has no line feed.
    pub fn finish(&mut self, now_s: f64, mut take: impl FnMut(Frame)) {
        if self.overlong || !self.line.is_empty() {
            self.end_line(now_s, &mut take);
        }
    }

    fn append(&mut self, piece: &[u8]) {
        if self.overlong || self.line.len() + piece.len() > LONGEST_LINE {
            self.overlong = true;
            self.line.clear();
        } else {
            self.line.extend_from_slice(piece);
        }
    }

    fn end_line(&mut self, now_s: f64, take: &mut impl FnMut(Frame)) {
        self.lines += 1;
        let line = std::mem::take(&mut self.line);
        let parsed = if std::mem::take(&mut self.overlong) {
            Err(format!("longer than {LONGEST_LINE} bytes"))
        } else if line.iter().all(u8::is_ascii_whitespace) {
            return;
        } else {
            self.frame(&line, now_s)
        };
        match parsed {
            Ok(frame) => take(frame),
            Err(reason) => {
                self.malformed += 1;
                self.last_malformed = Some(Malformed {
                    line: self.lines,
                    reason,
                });
            }
        }
    }

    fn frame(&self, line: &[u8], now_s: f64) -> Result<Frame, String> {
        // serde reads an array as the fields of a struct in their order.
        if !line.trim_ascii_start().starts_with(b"{") {
            return Err("not a JSON object; write {\"t\": …, \"points\": …}".to_owned());
        }
        let line: JsonFrame = serde_json::from_slice(line).map_err(|error| error.to_string())?;
        if !line.t.is_finite() {
            return Err("`t` is not finite".to_owned());
        }
        let mut markers = Vec::with_capacity(line.points.len() + line.unlabeled.len());
        for (name, place) in line.points {
            if let Some(place) = place {
                let position = self.position(&place, || format!("point `{name}`"))?;
                markers.push(marker(Some(name), position));
            }
        }
        for (index, place) in line.unlabeled.iter().enumerate() {
            let position = self.position(place, || format!("unlabeled point {}", index + 1))?;
            markers.push(marker(None, position));
        }
        let mut bodies = Vec::with_capacity(line.bodies.len());
        for ((name, body), id) in line.bodies.into_iter().zip(1_i64..) {
            if let Some(body) = body {
                bodies.push(self.body(name, id, &body)?);
            }
        }
        Ok(Frame {
            stamp_s: line.t,
            received_s: now_s,
            latency_s: line
                .latency_ms
                .filter(|latency| *latency >= 0.0)
                .map(|latency| latency / 1e3),
            markers,
            bodies,
        })
    }

    fn position(&self, place: &[f64], what: impl Fn() -> String) -> Result<[f64; 3], String> {
        let source = match *place {
            [x, y] => [x, y, 0.0],
            [x, y, z] => [x, y, z],
            _ => {
                let count = place.len();
                return Err(format!(
                    "{} has {count} numbers; write [x, y] or [x, y, z]",
                    what()
                ));
            }
        };
        let position = self.mapping.position(source);
        if position.iter().all(|value| value.is_finite()) {
            Ok(position)
        } else {
            Err(format!("the position of {} is not finite", what()))
        }
    }

    fn body(&self, name: String, id: i64, body: &Body) -> Result<RigidBody, String> {
        let position = self.position(&body.position, || format!("body `{name}`"))?;
        let quaternion = match (body.quaternion, body.heading_deg) {
            (Some(quaternion), _) => self.mapping.quaternion(quaternion),
            (None, Some(heading_deg)) => {
                // A heading is an angle from x towards y of the source; an image's y runs down.
                let (sin, cos) = heading_deg.to_radians().sin_cos();
                let [x, y, _] = self.mapping.position([cos, sin, 0.0]);
                let half = y.atan2(x) / 2.0;
                Some([0.0, 0.0, half.sin(), half.cos()])
            }
            (None, None) => None,
        };
        let quaternion = quaternion
            .filter(|quaternion| quaternion.iter().all(|value| value.is_finite()))
            .ok_or_else(|| {
                format!("body `{name}` has no orientation; write `quaternion` or `heading_deg`")
            })?;
        Ok(RigidBody {
            id,
            name: Some(name),
            position,
            quaternion,
        })
    }
}

fn marker(name: Option<String>, [x_m, y_m, z_m]: [f64; 3]) -> Marker {
    Marker {
        name,
        id: None,
        x_m,
        y_m,
        z_m,
    }
}

/// The line of a frame, without its line feed, as [`JsonLines`] reads it with [`Mapping::Z_UP`]. Bodies without a name are left out.
pub(crate) fn line_of(frame: &Frame) -> String {
    let mut line = JsonFrame {
        t: frame.stamp_s,
        latency_ms: frame.latency_s.map(|latency| latency * 1e3),
        ..JsonFrame::default()
    };
    for marker in &frame.markers {
        let position = marker.position().to_vec();
        match &marker.name {
            Some(name) if !line.points.contains_key(name) => {
                line.points.insert(name.clone(), Some(position));
            }
            _ => line.unlabeled.push(position),
        }
    }
    for body in &frame.bodies {
        if let Some(name) = &body.name {
            let solved = Body {
                position: body.position.to_vec(),
                quaternion: Some(body.quaternion),
                heading_deg: None,
            };
            line.bodies.insert(name.clone(), Some(solved));
        }
    }
    // Text keys and finite numbers always have a JSON form.
    serde_json::to_string(&line).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (Vec<Frame>, JsonLines) {
        let mut lines = JsonLines::new(Mapping::Z_UP);
        let mut frames = Vec::new();
        lines.receive(text.as_bytes(), 3.0, |frame| frames.push(frame));
        lines.finish(3.0, |frame| frames.push(frame));
        (frames, lines)
    }

    #[test]
    fn a_whole_line_is_read() {
        let (frames, lines) = parsed(
            r#"{"t": 12.5, "points": {"Front": [0.1, 0.2], "Back": null, "Tip": [1, 2, 3]}, "unlabeled": [[4, 5]],
               "bodies": {"robot": {"position": [0.5, 0.25], "heading_deg": 90}, "lost": null}, "latency_ms": 35, "mine": 1}"#
                .replace('\n', "")
                .as_str(),
        );
        assert_eq!(lines.malformed(), 0, "{:?}", lines.last_malformed());
        let frame = &frames[0];
        assert_eq!((frame.stamp_s, frame.received_s), (12.5, 3.0));
        assert_eq!(frame.latency_s, Some(0.035));
        assert_eq!(frame.markers.len(), 3);
        let [x, y, z] = frame.marker("Tip").unwrap().position();
        assert_eq!((x, y, z), (1.0, 2.0, 3.0));
        assert!(frame.marker("Back").is_none());
        assert_eq!(frame.markers[2].name, None);
        let [robot] = frame.bodies.as_slice() else {
            panic!("{:?}", frame.bodies);
        };
        assert!((robot.heading_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn malformed_lines_are_counted_and_named() {
        for (text, reason) in [
            ("{", "EOF"),
            ("{}", "missing field `t`"),
            ("[1]", "not a JSON object"),
            (r#"{"t": "now"}"#, "invalid type"),
            (
                r#"{"t": 1, "points": {"Front": [1]}}"#,
                "point `Front` has 1 numbers",
            ),
            (
                r#"{"t": 1, "unlabeled": [[1, 2, 3, 4]]}"#,
                "unlabeled point 1 has 4",
            ),
            (
                r#"{"t": 1, "bodies": {"b": {"position": [1, 2]}}}"#,
                "no orientation",
            ),
            (r#"{"t": NaN}"#, "expected"),
        ] {
            let (frames, lines) = parsed(&format!("{{\"t\": 0}}\n\n{text}\n{{\"t\": 2}}\n"));
            assert_eq!(frames.len(), 2, "{text}");
            let malformed = lines.last_malformed().unwrap();
            assert_eq!((lines.malformed(), malformed.line), (1, 3), "{text}");
            assert!(malformed.reason.contains(reason), "{text}: {malformed:?}");
        }
    }

    #[test]
    fn an_overlong_line_takes_no_memory_and_the_next_is_read() {
        let mut lines = JsonLines::new(Mapping::Z_UP);
        let mut frames = 0;
        for _ in 0..100 {
            lines.receive(&[b'x'; 10_000], 0.0, |_| frames += 1);
            assert!(lines.line.capacity() <= 2 * LONGEST_LINE);
        }
        lines.receive(b"\n{\"t\": 1}\n", 0.0, |_| frames += 1);
        assert_eq!((frames, lines.malformed()), (1, 1));
        assert!(lines.last_malformed().unwrap().reason.contains("longer"));
    }

    #[test]
    fn an_image_has_its_y_down() {
        let mut lines = JsonLines::new(Mapping {
            axes: swimmer_files::Axes::IMAGE,
            metres_per_unit: 0.001,
        });
        let mut frames = Vec::new();
        let text =
            "{\"t\": 0, \"bodies\": {\"tag\": {\"position\": [100, 200], \"heading_deg\": 30}}}\n";
        lines.receive(text.as_bytes(), 0.0, |frame| frames.push(frame));
        let body = &frames[0].bodies[0];
        assert!((body.position[0] - 0.1).abs() < 1e-12 && (body.position[1] + 0.2).abs() < 1e-12);
        assert!((body.heading_rad().to_degrees() + 30.0).abs() < 1e-9);
    }

    #[test]
    fn a_frame_survives_its_line() {
        let text = r#"{"t": 1.25, "points": {"A": [1, 2, 3]}, "unlabeled": [[4, 5, 6]], "bodies": {"r": {"position": [1, 2, 3], "quaternion": [0, 0, 0, 1]}}, "latency_ms": 12}"#;
        let (frames, _) = parsed(text);
        let (again, _) = parsed(&line_of(&frames[0]));
        assert_eq!(again, frames);
    }

    proptest::proptest! {
        /// Any bytes in any pieces: no panic, and whole lines do not depend on the pieces.
        #[test]
        fn any_bytes_in_any_pieces(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400), cut in 0_usize..400) {
            let text = [b"{\"t\": 1}\n", bytes.as_slice(), b"\n{\"t\": 2}\n"].concat();
            let read = |pieces: &[&[u8]]| {
                let mut lines = JsonLines::new(Mapping::Z_UP);
                let mut stamps = Vec::new();
                for piece in pieces {
                    lines.receive(piece, 0.0, |frame| stamps.push(frame.stamp_s));
                }
                (stamps, lines.malformed())
            };
            let (a, b) = text.split_at(cut.min(text.len()));
            let whole = read(&[&text]);
            proptest::prop_assert_eq!(&whole, &read(&[a, b]));
            proptest::prop_assert!(whole.0.len() >= 2);
        }
    }
}
