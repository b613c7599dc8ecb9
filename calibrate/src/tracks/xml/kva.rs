//! Kinovea's KVA: the trajectories of its analysis, in the user's unit, y up.

use roxmltree::Node;

use super::{Xml, child, children};
use crate::tracks::merged::{TimedPose, merged};
use crate::tracks::stamp::Stamp;
use crate::tracks::timeline::Timeline;
use crate::tracks::{Draft, Reading, TrackError, TrackFormat, TrackProblem, Unit};

pub(super) fn read(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    reading: &Reading<'_>,
) -> Result<Draft, TrackError> {
    let clock = Clock::of(root);
    let mut timeline = Timeline::new(reading.keeps_places);
    let mut tracks: Vec<(String, Vec<TimedPose>)> = Vec::new();
    let mut own = None;
    for track in children(child(root, "Tracks").unwrap_or(root), "Track") {
        // Older versions call them positions.
        let lists = ["TrackPointList", "TrackPositionList"];
        let Some(list) = lists.iter().find_map(|name| child(track, name)) else {
            continue;
        };
        let unit = list.attribute("UserUnitLength").and_then(Unit::from_name);
        let unit = unit.unwrap_or(Unit::Unknown);
        if *own.get_or_insert(unit) != unit {
            let text = format!("{unit} next to another unit");
            return Err(xml.error(list, TrackProblem::UnknownUnit { text }));
        }
        let points = list.children().filter(Node::is_element);
        let mut seen = points
            .map(|point| clock.seen(xml, point, &mut timeline))
            .collect::<Result<Vec<TimedPose>, TrackError>>()?;
        seen.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        tracks.push((name(track, tracks.len()), seen));
    }
    if tracks.iter().all(|(_, seen)| seen.is_empty()) {
        return Err(xml.error(root, TrackProblem::NoPoints));
    }
    let (unit, metres, overridden) = reading.options.unit(own.unwrap_or(Unit::Unknown));
    Ok(Draft {
        format: TrackFormat::Kinovea,
        rate_hz: None,
        unit,
        image: false,
        body: merged(timeline, tracks, metres),
        warnings: overridden.into_iter().collect(),
    })
}

/// A track's name, where each version keeps it.
fn name(track: Node<'_, '_>, index: usize) -> String {
    let label = child(track, "Label").and_then(|label| child(label, "Text"));
    let main = child(track, "MainLabel").and_then(|label| label.attribute("Text"));
    let names = [
        track.attribute("name"),
        label.and_then(|text| text.text()),
        main,
    ];
    let name = names
        .into_iter()
        .flatten()
        .map(str::trim)
        .find(|name| !name.is_empty());
    name.map_or_else(|| format!("track {}", index + 1), str::to_owned)
}

/// Format of times.
struct Clock {
    /// Seconds of a time stamp of the video, by the user's frame rate.
    stamp_s: Option<f64>,
}

impl Clock {
    fn of(root: Node<'_, '_>) -> Self {
        let value = |name: &str| {
            let text = child(root, name)?.text()?.trim().replacen(',', ".", 1);
            text.parse::<f64>().ok().filter(|value| *value > 0.0)
        };
        let rate = value("CaptureFramerate").or_else(|| value("UserFramerate"));
        let frame_s = rate
            .map(|rate| 1.0 / rate)
            .or_else(|| Some(1e-3 * value("UserInterval")?));
        Self {
            stamp_s: value("AverageTimeStampsPerFrame")
                .zip(frame_s)
                .map(|(stamps, seconds)| seconds / stamps),
        }
    }

    /// A point: `x;y;t` in pixels and time stamps, with the user's values as attributes.
    fn seen(
        &self,
        xml: &Xml<'_>,
        point: Node<'_, '_>,
        timeline: &mut Timeline,
    ) -> Result<TimedPose, TrackError> {
        let axis = |invariant: &str, plain: &str| {
            let name = if point.has_attribute(invariant) {
                invariant
            } else {
                plain
            };
            xml.number(point, name)
        };
        let place = [
            axis("UserXInvariant", "UserX")?,
            axis("UserYInvariant", "UserY")?,
            0.0,
        ];
        let native = point
            .text()
            .and_then(|text| text.split(';').nth(2)?.trim().parse::<f64>().ok());
        let stamps = native
            .zip(self.stamp_s)
            .map(|(stamp, seconds)| stamp * seconds);
        let text = point.attribute("UserTime").unwrap_or("");
        // Hundredths of a second, or thousandths.
        let shown = || {
            let (rest, fraction) = text
                .rsplit_once(':')
                .filter(|(rest, _)| rest.matches(':').count() == 2)?;
            Stamp::parse(&format!("{rest}.{fraction}")).map(|stamp| stamp.seconds)
        };
        if stamps.is_none() {
            timeline.written("0.00", 1.0);
        }
        let time_s = match stamps
            .or_else(shown)
            .or_else(|| Stamp::parse(text).map(|stamp| stamp.seconds))
        {
            Some(time_s) => time_s,
            None => xml.number(point, "UserTime")?,
        };
        Ok(TimedPose {
            time_s,
            place,
            turn: None,
        })
    }
}
