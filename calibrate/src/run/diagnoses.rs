//! Short diagnoses of one run's track.

use super::RunResult;
use crate::poses::Stretch;

/// Reflectors whose distance differs by more from what `at` says are worth a word, as a share.
const FAR: f64 = 0.01;

/// Number of stretches whose times are printed; JSON lists all.
const LISTED: usize = 4;

/// Times of the stretches.
fn times(stretches: &[Stretch]) -> String {
    let time = |stretch: &Stretch| {
        if stretch.rows > 1 {
            format!("{:.2}–{:.2} s", stretch.from_s, stretch.until_s)
        } else {
            format!("{:.2} s", stretch.from_s)
        }
    };
    let mut listed: Vec<String> = stretches.iter().take(LISTED).map(time).collect();
    let more = stretches.len().saturating_sub(LISTED);
    if more > 0 {
        listed.push(format!("and {more} times more"));
    }
    listed.join(", ")
}

impl RunResult {
    /// Swaps, ghosts, the reflectors' distance and jumps of the frame, in words.
    pub fn diagnoses(&self) -> Vec<String> {
        let report = &self.poses.report;
        let mut out = Vec::new();
        if report.swaps_repaired > 0 {
            out.push(format!(
                "labels exchanged {} times, set right: {}",
                report.swaps_repaired,
                times(&report.swaps)
            ));
        }
        if report.ghosts_rejected > 0 {
            out.push(format!(
                "{} points that are no reflector (glints or other markers; left out of the poses): {}",
                report.ghosts_rejected,
                times(&report.ghosts)
            ));
        }
        let apart = report.distance_m / self.reflector_distance_m - 1.0;
        if apart.abs() > FAR {
            out.push(format!(
                "reflectors {:.2} mm apart, {:+.1} % from what `at` says",
                1e3 * report.distance_m,
                100.0 * apart
            ));
        }
        for jump in &self.poses.jumps {
            out.push(format!("the frame jumped at {:.2} s", jump.after_s));
        }
        out
    }
}
