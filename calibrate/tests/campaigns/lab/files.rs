//! Tracking files as text: a plain table, and Motive's wide export with y up.

use std::fmt::Write;

use super::cameras::Frame;

/// Labels of the first reflectors; ghosts and reflections come as unlabeled markers.
pub(crate) const LABELS: [&str; 4] = ["Front", "Back", "FrontLink", "BackLink"];

/// A whole number of micrometres as metres: what six digits after the point are, but quick.
#[allow(clippy::cast_possible_truncation)]
fn push_micro(out: &mut String, value: f64) {
    let micro = (value * 1e6).round() as i64;
    if micro < 0 {
        out.push('-');
    }
    let micro = micro.unsigned_abs();
    let (whole, part) = (micro / 1_000_000, micro % 1_000_000);
    let mut digits = *b"0.000000";
    let mut rest = part;
    for digit in digits[2..].iter_mut().rev() {
        *digit = b'0' + u8::try_from(rest % 10).unwrap_or(0);
        rest /= 10;
    }
    if whole < 10 {
        digits[0] = b'0' + u8::try_from(whole).unwrap_or(0);
        out.push_str(std::str::from_utf8(&digits).unwrap_or("0"));
    } else {
        write!(out, "{whole}").expect("a String takes all");
        out.push_str(std::str::from_utf8(&digits[1..]).unwrap_or(".0"));
    }
}

fn label(index: usize, marked: usize) -> String {
    match LABELS.get(index) {
        Some(label) if index < marked => (*label).to_owned(),
        _ => format!("Unlabeled {}", 1200 + index),
    }
}

/// `t` and an x and y for each point, to a micrometre; `marked` of them have labels.
pub(crate) fn table(frames: &[Frame], rate_hz: f64, marked: usize) -> String {
    let count = frames.first().map_or(0, Vec::len);
    let mut out = String::with_capacity(frames.len() * (10 + 20 * count));
    out.push('t');
    for index in 0..count {
        let name = label(index, marked).replace(' ', "_");
        write!(out, ",{name}_x,{name}_y").expect("a String takes all");
    }
    out.push('\n');
    for (index, frame) in frames.iter().enumerate() {
        push_micro(&mut out, index as f64 / rate_hz);
        for point in frame {
            match point {
                Some([x, y, _]) => {
                    out.push(',');
                    push_micro(&mut out, *x);
                    out.push(',');
                    push_micro(&mut out, *y);
                }
                None => out.push_str(",,"),
            }
        }
        out.push('\n');
    }
    out
}

/// Format of Motive 2: metres, Y up, so that (x, y) = (Z, X).
pub(crate) fn motive(frames: &[Frame], rate_hz: f64, marked: usize) -> String {
    let count = frames.first().map_or(0, Vec::len);
    let total = frames.len();
    let mut out = format!(
        "Format Version,1.23,Take Name,lab,Take Notes,,Capture Frame Rate,{rate_hz:.6},Export Frame Rate,{rate_hz:.6},Total Frames in Take,{total},Total Exported Frames,{total},Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global\r\n\r\n"
    );
    let mut head = |first: &str, cell: &dyn Fn(usize, usize) -> String| {
        out.push_str(first);
        for (index, axis) in (0..count).flat_map(|i| (0..3).map(move |axis| (i, axis))) {
            out.push(',');
            out.push_str(&cell(index, axis));
        }
        out.push_str("\r\n");
    };
    head(",Type", &|_, _| "Marker".to_owned());
    head(",Name", &|index, _| label(index, marked));
    head(",ID", &|index, _| format!("\"A{index}\""));
    head(",", &|_, _| "Position".to_owned());
    head("Frame,Time (Seconds)", &|_, axis| {
        ["X", "Y", "Z"][axis].to_owned()
    });
    for (index, frame) in frames.iter().enumerate() {
        write!(out, "{index},").expect("a String takes all");
        push_micro(&mut out, index as f64 / rate_hz);
        for point in frame {
            match point {
                Some([x, y, height]) => {
                    for value in [y, height, x] {
                        out.push(',');
                        push_micro(&mut out, *value);
                    }
                }
                None => out.push_str(",,,"),
            }
        }
        out.push_str("\r\n");
    }
    out
}
