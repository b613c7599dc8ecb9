//! Choice of an ordered pair of points by their distance, labels as hints, and limits from row to row and after a gap.

use nalgebra::Vector3;

use crate::median::median;

/// Tolerance of both reflectors about their predicted positions from one row to the next, over their distance; and after a gap,
/// or they could be exchanged.
pub(super) const REACH: (f64, f64) = (0.3, 0.45);
/// Limits after a gap over the medians of a first pass: six standard deviations of a distance, ten of a prediction.
const TIGHTER: (f64, f64) = (9.0, 8.0);
/// Largest noise of the reflectors' distance that is allowed for, as a share of it.
const MOST_NOISE: f64 = 0.3;

/// A candidate of a row: which point, and where.
pub(super) type Candidate = (usize, Vector3<f64>);

/// Parameters of the search for an ordered pair.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    pub(super) fronts: Vec<usize>,
    pub(super) backs: Vec<usize>,
    pub(super) distance: f64,
    pub(super) tolerance: f64,
    /// Limits after a gap, when a ghost may stand where a reflector is expected: of the distance, and of both together to
    /// their predicted places \[m\].
    pub(super) after_gap: (f64, f64),
    /// Time from row to row \[s\].
    pub(super) step_s: f64,
}

impl Pairs {
    /// For points at this distance, within a share of it; without labels.
    pub(super) fn new(distance: f64, share: f64) -> Self {
        Self {
            fronts: Vec::new(),
            backs: Vec::new(),
            distance,
            tolerance: share * distance,
            after_gap: (share * distance, 0.1 * distance),
            step_s: 0.0,
        }
    }

    pub(super) fn is_label(&self, point: usize) -> bool {
        self.fronts.contains(&point) || self.backs.contains(&point)
    }

    pub(super) fn fits(&self, a: &Vector3<f64>, b: &Vector3<f64>, tolerance: f64) -> bool {
        ((a - b).norm() - self.distance).abs() < tolerance
    }

    /// Number of labels of a chosen pair that agree with the choice, and that contradict it.
    fn votes(&self, front: usize, back: usize) -> (f64, f64) {
        let says = |which: &[usize], i| f64::from(u8::from(which.contains(&i)));
        (
            says(&self.fronts, front) + says(&self.backs, back),
            says(&self.fronts, back) + says(&self.backs, front),
        )
    }

    /// Returns `true` if the labels of a chosen pair agree with the choice.
    pub(super) fn labels(&self, front: usize, back: usize) -> Option<bool> {
        let (agrees, contradicts) = self.votes(front, back);
        let most = agrees.total_cmp(&contradicts);
        most.is_ne().then_some(most.is_gt())
    }

    pub(super) fn has_both_labels(&self, front: usize, back: usize) -> bool {
        self.fronts.contains(&front) && self.backs.contains(&back)
    }

    /// The best ordered pair by a cost that may refuse it.
    pub(super) fn best(
        &self,
        candidates: &[Candidate],
        tolerance: f64,
        cost: impl Fn(&Candidate, &Candidate) -> Option<f64>,
    ) -> Option<(Candidate, Candidate)> {
        let mut best: Option<(f64, Candidate, Candidate)> = None;
        for front in candidates {
            for back in candidates
                .iter()
                .filter(|back| back.0 != front.0 && self.fits(&front.1, &back.1, tolerance))
            {
                if let Some(cost) = cost(front, back)
                    .filter(|cost| best.as_ref().is_none_or(|(least, ..)| cost < least))
                {
                    best = Some((cost, *front, *back));
                }
            }
        }
        best.map(|(_, front, back)| (front, back))
    }

    /// The pair without a previous row: labels first, then the better distance.
    pub(super) fn begin(&self, candidates: &[Candidate]) -> Option<(Candidate, Candidate)> {
        self.best(candidates, self.tolerance, |front, back| {
            let misfit = ((front.1 - back.1).norm() - self.distance).abs() / self.tolerance;
            let (agrees, contradicts) = self.votes(front.0, back.0);
            Some(misfit + 2.0 - agrees + contradicts)
        })
    }

    /// Limits after a gap from the distances and the misses of predictions that were met: there a ghost must not pass for a
    /// lost reflector. From row to row such limits would lose real reflectors, whose distances have long tails.
    pub(super) fn learn(
        &mut self,
        distances: impl Iterator<Item = f64> + Clone,
        misses: impl Iterator<Item = f64>,
    ) {
        let Some(distance) = median(distances.clone()) else {
            return;
        };
        let deviation = median(distances.map(|d| (d - distance).abs())).unwrap_or(0.0);
        let miss = median(misses).unwrap_or(0.0);
        self.distance = distance;
        // Noise of the cameras may be wider than the usual tolerance.
        let noise = (TIGHTER.0 * deviation).min(MOST_NOISE * distance);
        self.tolerance = self.tolerance.max(noise);
        let widest = self.tolerance.max(2e-3 * distance);
        self.after_gap = (
            (TIGHTER.0 * deviation).clamp(2e-3 * distance, widest),
            (TIGHTER.1 * miss).clamp(5e-3 * distance, REACH.0 * distance),
        );
    }
}
