//! The marker description of a rigid body's definition in NatNet 4.0 and 4.1: count, positions, active labels, names.

/// Bytes of one marker without its name: a position and a label.
const FIXED: usize = 16;

/// Names of the markers; empty if the bytes are no description with names.
pub(super) fn marker_names(tail: &[u8]) -> Vec<String> {
    let read = || {
        let count = i32::from_le_bytes(tail.get(..4)?.try_into().ok()?);
        let count = usize::try_from(count).ok()?;
        let mut rest = tail.get(4 + count.checked_mul(FIXED)?..)?;
        let mut names = Vec::new();
        for _ in 0..count {
            let end = rest.iter().position(|byte| *byte == 0)?;
            names.push(String::from_utf8_lossy(rest.get(..end)?).into_owned());
            rest = rest.get(end + 1..)?;
        }
        Some(names)
    };
    read().unwrap_or_default()
}

/// A marker of a body that is to be described.
pub(super) struct DescribedMarker<'a> {
    pub(super) name: &'a str,
    /// Position in the body's axes, the stream's axes and unit.
    pub(super) position: [f32; 3],
}

/// The description of these markers; without names for bitstreams before 4.0.
pub(super) fn description(markers: &[DescribedMarker<'_>], with_names: bool) -> Vec<u8> {
    let mut tail = Vec::new();
    let count = i32::try_from(markers.len()).unwrap_or(i32::MAX);
    tail.extend(count.to_le_bytes());
    let positions = markers.iter().flat_map(|marker| marker.position);
    tail.extend(positions.flat_map(f32::to_le_bytes));
    // No active labels.
    tail.extend(std::iter::repeat_n(0, 4 * markers.len()));
    if with_names {
        for marker in markers {
            tail.extend(marker.name.bytes().filter(|byte| *byte != 0));
            tail.push(0);
        }
    }
    tail
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_cut_descriptions_have_none() {
        let markers = ["Front", "Back"].map(|name| DescribedMarker {
            name,
            position: [1.0, 2.0, 3.0],
        });
        let tail = description(&markers, true);
        assert_eq!(marker_names(&tail), ["Front", "Back"]);
        for cut in 0..tail.len() {
            assert!(marker_names(&tail[..cut]).is_empty(), "{cut}");
        }
        assert!(marker_names(&description(&markers, false)).is_empty());
        assert!(marker_names(&[0xff; 40]).is_empty());
    }
}
