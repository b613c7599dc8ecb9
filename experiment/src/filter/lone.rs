//! One reflector alone: the position that it has with the predicted heading.

use calibrate::Sighting;
use nalgebra::Vector2;

use super::PoseFilter;

/// A lone point within so many standard deviations of a reflector's predicted place is the reflector.
const LONE_SIGMAS: f64 = 4.0;

impl PoseFilter {
    /// Takes the points of a frame that does not show both reflectors.
    pub(super) fn take_lone(&mut self, time_s: f64, sightings: &[Sighting]) {
        let Some(estimate) = self.estimate.map(|estimate| estimate.after(time_s)) else {
            return;
        };
        let predicted = estimate.pose();
        let placed = predicted.placed();
        let [at_front, at_back] = [
            &self.options.reflectors.front,
            &self.options.reflectors.back,
        ]
        .map(|r| r.at);
        let mut near: Option<Vector2<f64>> = None;
        for at in [at_front, at_back] {
            let expected = placed.transform(&Vector2::from(at));
            let reach = at[0].hypot(at[1]);
            let sigma = (predicted.sigma_position_m.powi(2)
                + (reach * predicted.sigma_heading_rad).powi(2)
                + self.noise)
                .sqrt();
            let offs = sightings.iter().map(|s| s.place.xy() - expected);
            for off in offs.filter(|off| off.norm() < LONE_SIGMAS * sigma) {
                // Two that fit are ambiguous.
                if near.replace(off).is_some() {
                    return;
                }
            }
        }
        let Some(off) = near else {
            return;
        };
        self.counts.one += 1;
        let reach = at_front[0]
            .hypot(at_front[1])
            .max(at_back[0].hypot(at_back[1]));
        let variance = self.noise + (reach * predicted.sigma_heading_rad).powi(2);
        let mut estimate = estimate;
        estimate.x.measure(predicted.x_m + off.x, variance);
        estimate.y.measure(predicted.y_m + off.y, variance);
        self.seen_s = Some(time_s);
        self.estimate = Some(estimate);
    }
}
