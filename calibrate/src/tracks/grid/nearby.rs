//! Filter for positions: only those near the named reflectors are kept, so that memory does not grow with the markers of other
//! objects.

use crate::tracks::TrackPoint;
use crate::tracks::options::UsedPoints;

/// Positions are kept within this multiple of the reflectors' distance from a named point.
const REACH: f64 = 3.0;

/// Decides row by row which places are kept.
pub(super) struct Nearby {
    /// `true` if the point is named.
    named: Vec<bool>,
    /// Square of the reach in the file's unit.
    reach: f64,
    /// Places kept in the last row that had any.
    last: Vec<[f64; 3]>,
    /// Selection of this row, by point.
    keeps: Vec<bool>,
}

impl Nearby {
    /// `None` if all places are to be kept: what is used is not known by name.
    pub(super) fn new(
        used: Option<&UsedPoints>,
        points: &[TrackPoint],
        metres: f64,
    ) -> Option<Self> {
        let used = used.filter(|used| used.are_in(points))?;
        let reach = REACH * used.distance_m / metres;
        reach.is_finite().then(|| Self {
            named: points.iter().map(|point| used.names(point)).collect(),
            reach: reach * reach,
            last: Vec::new(),
            keeps: Vec::new(),
        })
    }

    /// Selects the places of a row to keep: those near named ones, and, as long as one of these is missing, those near places
    /// kept before. Without any, all: the reflectors may be anywhere.
    pub(super) fn keep(&mut self, places: &[Option<[f64; 3]>]) -> &[bool] {
        let named = || {
            let both = self.named.iter().zip(places);
            both.filter_map(|(named, place)| named.then_some(place.as_ref()))
        };
        let all_seen = named().all(|place| place.is_some());
        let mut centres: Vec<[f64; 3]> = named().flatten().copied().collect();
        if !all_seen {
            centres.extend(&self.last);
        }
        let is_near = |place: &[f64; 3]| {
            let square = |centre: &[f64; 3]| -> f64 {
                centre.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum()
            };
            centres.is_empty() || centres.iter().any(|centre| square(centre) < self.reach)
        };
        self.keeps.clear();
        let keeps = places
            .iter()
            .map(|place| place.as_ref().is_some_and(is_near));
        self.keeps.extend(keeps);
        let kept = places.iter().zip(&self.keeps).filter(|(_, keep)| **keep);
        self.last.clear();
        self.last.extend(kept.filter_map(|(place, _)| *place));
        &self.keeps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PointKind;
    use swimmer_files::PointName;

    #[test]
    fn places_far_from_the_reflectors_are_dropped() {
        let point = |name: &str| {
            TrackPoint::new(
                name.to_owned(),
                PointKind::Marker,
                String::new(),
                Vec::new(),
            )
        };
        let points = [
            point("front"),
            point("back"),
            point("Unlabeled 1"),
            point("head"),
        ];
        let used = UsedPoints {
            middle: vec![
                PointName::Named("front".into()),
                PointName::Named("back".into()),
            ],
            is_body: false,
            is_guess: false,
            sides: Vec::new(),
            distance_m: 0.1,
        };
        // In millimetres.
        let mut nearby = Nearby::new(Some(&used), &points, 1e-3).unwrap();
        let at = |x: f64| Some([x, 0.0, 0.0]);
        // Nothing known yet.
        assert_eq!(
            nearby.keep(&[None, None, at(0.0), at(900.0)]),
            [false, false, true, true]
        );
        assert_eq!(
            nearby.keep(&[at(0.0), at(100.0), at(150.0), at(900.0)]),
            [true, true, true, false]
        );
        // The back one is called otherwise for a while.
        assert_eq!(
            nearby.keep(&[at(10.0), None, at(110.0), at(900.0)]),
            [true, false, true, false]
        );
        assert_eq!(
            nearby.keep(&[None, None, at(120.0), at(900.0)]),
            [false, false, true, false]
        );
        let unnamed = UsedPoints {
            middle: vec![PointName::Auto, PointName::Auto],
            ..used
        };
        assert!(Nearby::new(Some(&unnamed), &points, 1.0).is_none());
    }
}
