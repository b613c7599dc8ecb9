//! A gait file of any curve, and the same cycle run the other way.

use swimmer_model::Gait;

use super::{GaitArc, GaitFile};

impl GaitFile {
    /// The samples of a gait, at least `samples` of them, evenly spaced in each smooth piece; nothing is known of it.
    pub fn sampled(gait: &impl Gait<f64>, samples: usize) -> Self {
        let pieces = gait.pieces().max(1);
        let each = samples.div_ceil(pieces).max(Self::FEWEST_SAMPLES);
        let mut file = Self::default();
        let mut from = 0.0;
        for piece in 0..pieces {
            let to = if piece + 1 == pieces {
                1.0
            } else {
                gait.piece_end(piece)
            };
            for k in 0..each {
                file.u.push(from + (to - from) * k as f64 / each as f64);
            }
            if gait.corner_at_end(piece) {
                file.corners.push(if to < 1.0 { to } else { 0.0 });
            }
            from = to;
        }
        file.phi = file.u.iter().map(|&u| gait.at(u).phi).collect();
        file.u.push(1.0);
        file.phi.extend(file.phi.first().copied());
        file.corners.sort_by(f64::total_cmp);
        file
    }

    /// The same cycle run backwards from the same start; what it was optimised for stays.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let back = |u: f64| 1.0 - u;
        let mut corners: Vec<f64> = self
            .corners
            .iter()
            .map(|&u| if u == 0.0 { 0.0 } else { back(u) })
            .collect();
        corners.sort_by(f64::total_cmp);
        let arcs = self.arcs.iter().rev().map(|arc| GaitArc {
            kind: arc.kind,
            from: back(arc.to),
            to: back(arc.from),
        });
        Self {
            arcs: arcs.collect(),
            corners,
            u: self.u.iter().rev().map(|&u| back(u)).collect(),
            phi: self.phi.iter().rev().copied().collect(),
            ..self.clone()
        }
    }

    /// The same cycle begun at another of its samples. An arc that goes past the new beginning is cut there; one that was cut
    /// at the old one, smoothly, is whole again.
    #[must_use]
    pub fn begun_at(&self, sample: usize) -> Self {
        let last = self.u.len().min(self.phi.len()).saturating_sub(1);
        let Some(&by) = self.u.get(sample).filter(|_| 0 < sample && sample < last) else {
            return self.clone();
        };
        let from = |u: f64| if u < by { u - by + 1.0 } else { u - by };
        let to = |u: f64| if u <= by { u - by + 1.0 } else { u - by };
        let mut begun = self.clone();
        begun.u.truncate(last);
        begun.u.rotate_left(sample);
        begun.u.iter_mut().for_each(|u| *u = from(*u));
        begun.u.push(1.0);
        begun.phi.truncate(last);
        begun.phi.rotate_left(sample);
        begun.phi.extend(begun.phi.first().copied());
        begun.corners.iter_mut().for_each(|u| *u = from(*u));
        begun.corners.sort_by(f64::total_cmp);
        begun.corners.dedup();
        let mut arcs: Vec<GaitArc> = Vec::new();
        for arc in &self.arcs {
            let moved = GaitArc {
                from: from(arc.from),
                to: to(arc.to),
                ..*arc
            };
            if moved.from < moved.to {
                arcs.push(moved);
            } else {
                arcs.push(GaitArc { from: 0.0, ..moved });
                arcs.push(GaitArc { to: 1.0, ..moved });
            }
        }
        arcs.sort_by(|a, b| a.from.total_cmp(&b.from));
        let at_seam = |u: f64| (u - (1.0 - by)).abs() <= 1e-12;
        let smooth = !begun.corners.iter().any(|&u| at_seam(u));
        arcs.dedup_by(|next, arc| {
            let whole = smooth && arc.kind == next.kind && at_seam(arc.to) && at_seam(next.from);
            if whole {
                arc.to = next.to;
            }
            whole
        });
        begun.arcs = arcs;
        begun
    }
}

#[cfg(test)]
mod tests {
    use swimmer_model::Gait as _;

    use crate::{AnyGait, GaitFile};

    #[test]
    fn a_square_keeps_its_corners_both_ways() {
        let square = AnyGait::square(1.2);
        let file = GaitFile::sampled(&square, 100);
        assert_eq!(file.corners, [0.0, 0.25, 0.5, 0.75]);
        let back = AnyGait::from_file(&file.reversed()).unwrap();
        for k in 0..100 {
            let u = f64::from(k) / 100.0;
            assert!((back.at(u).phi - square.at(1.0 - u).phi).norm() < 1e-13);
        }
        let circle = GaitFile::sampled(&AnyGait::circle(1.0), 3);
        assert_eq!((circle.u.len(), circle.corners.len()), (10, 0));
    }
}
