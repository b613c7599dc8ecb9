//! TrackMate: its own file (spots, and edges between them), and the tracks that it exports.

use std::collections::HashMap;

use roxmltree::Node;

use super::{Xml, child, children};
use crate::tracks::merged::{TimedPose, merged};
use crate::tracks::timeline::Timeline;
use crate::tracks::{Draft, Reading, TrackError, TrackFormat, TrackProblem, Unit};

/// `<Tracks spaceUnits frameInterval timeUnits><particle><detection t x y z/>…`; t counts frames.
pub(super) fn exported(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    reading: &Reading<'_>,
) -> Result<Draft, TrackError> {
    let seconds = root.attribute("timeUnits").and_then(seconds);
    let interval = root
        .attribute("frameInterval")
        .and_then(|text| text.parse::<f64>().ok());
    let frame_s = frame_s(
        xml,
        root,
        reading,
        seconds.zip(interval).map(|(s, i)| s * i),
    )?;
    let particles = children(root, "particle").zip(0..);
    let tracks = particles.map(|(particle, index)| {
        let detections = children(particle, "detection")
            .map(|detection| seen(xml, detection, ["t", "x", "y"], frame_s));
        let seen: Vec<TimedPose> = detections.collect::<Result<_, TrackError>>()?;
        Ok((format!("{index}"), seen))
    });
    let tracks = tracks.collect::<Result<Vec<_>, TrackError>>()?;
    draft(
        xml,
        root,
        reading,
        (tracks, root.attribute("spaceUnits"), frame_s),
    )
}

/// `<TrackMate><Model spatialunits timeunits><AllSpots>…<AllTracks>…`
pub(super) fn whole(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    reading: &Reading<'_>,
) -> Result<Draft, TrackError> {
    let model = child(root, "Model").unwrap_or(root);
    let image = child(root, "Settings").and_then(|settings| child(settings, "ImageData"));
    let interval = image.and_then(|image| image.attribute("timeinterval")?.parse::<f64>().ok());
    let seconds = model.attribute("timeunits").and_then(seconds);
    let frame_s = frame_s(
        xml,
        root,
        reading,
        seconds.zip(interval).map(|(s, i)| s * i),
    )?;
    let mut spots: HashMap<&str, TimedPose> = HashMap::new();
    for frame in child(model, "AllSpots")
        .into_iter()
        .flat_map(|all| children(all, "SpotsInFrame"))
    {
        for spot in children(frame, "Spot") {
            let seen = seen(xml, spot, ["FRAME", "POSITION_X", "POSITION_Y"], frame_s)?;
            spots.extend(spot.attribute("ID").map(|id| (id, seen)));
        }
    }
    let mut tracks = Vec::new();
    for track in child(model, "AllTracks")
        .into_iter()
        .flat_map(|all| children(all, "Track"))
    {
        let ends = |edge: Node<'_, '_>| {
            ["SPOT_SOURCE_ID", "SPOT_TARGET_ID"]
                .map(|end| edge.attribute(end).and_then(|id| spots.get(id)).copied())
        };
        let edges = children(track, "Edge").flat_map(ends).flatten();
        let name = track
            .attribute("name")
            .or_else(|| track.attribute("TRACK_ID"));
        tracks.push((
            name.unwrap_or("track").to_owned(),
            edges.collect::<Vec<TimedPose>>(),
        ));
    }
    draft(
        xml,
        root,
        reading,
        (tracks, model.attribute("spatialunits"), frame_s),
    )
}

/// Seconds of a frame: by the user, else by the file.
fn frame_s(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    reading: &Reading<'_>,
    own: Option<f64>,
) -> Result<f64, TrackError> {
    let own = own.filter(|seconds| seconds.is_finite() && *seconds > 0.0);
    match (reading.options.rate(), own) {
        (Some(rate), _) => Ok(1.0 / rate),
        (None, Some(seconds)) => Ok(seconds),
        (None, None) => Ok(1.0 / xml.need_rate(root, reading)?),
    }
}

/// Detection of an element; the attributes are those of its frame number, x and y.
fn seen(
    xml: &Xml<'_>,
    node: Node<'_, '_>,
    [frame, x, y]: [&str; 3],
    frame_s: f64,
) -> Result<TimedPose, TrackError> {
    Ok(TimedPose {
        time_s: xml.number(node, frame)? * frame_s,
        place: [xml.number(node, x)?, xml.number(node, y)?, 0.0],
        turn: None,
    })
}

fn seconds(unit: &str) -> Option<f64> {
    Some(match unit.to_lowercase().as_str() {
        "s" | "sec" | "second" | "seconds" => 1.0,
        "ms" | "msec" | "millisecond" | "milliseconds" => 1e-3,
        "min" | "minute" | "minutes" => 60.0,
        _ => return None,
    })
}

type Parts<'a> = (Vec<(String, Vec<TimedPose>)>, Option<&'a str>, f64);

fn draft(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    reading: &Reading<'_>,
    (mut tracks, unit, frame_s): Parts<'_>,
) -> Result<Draft, TrackError> {
    for (_, seen) in &mut tracks {
        seen.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        seen.dedup_by(|a, b| a.time_s.total_cmp(&b.time_s).is_eq());
    }
    if tracks.iter().all(|(_, seen)| seen.is_empty()) {
        return Err(xml.error(root, TrackProblem::NoPoints));
    }
    let own = match unit.map(str::to_lowercase).as_deref() {
        Some("micron" | "microns" | "µm" | "um") => Unit::Scaled(1e-6),
        unit => unit.and_then(Unit::from_name).unwrap_or(Unit::Unknown),
    };
    let (unit, metres, overridden) = reading.options.unit(own);
    Ok(Draft {
        format: TrackFormat::TrackMate,
        rate_hz: Some(1.0 / frame_s),
        unit,
        image: true,
        body: merged(Timeline::new(reading.keeps_places), tracks, metres),
        warnings: overridden.into_iter().collect(),
    })
}
