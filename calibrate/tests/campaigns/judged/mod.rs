//! A campaign of the independent laboratory, calibrated and judged, with the truth.

use calibrate::assessment::{Assessment, Systematics};
use calibrate::{
    CampaignFit, EvidenceOptions, FitOptions, Intervals, JointEstimate, Verdict, assess,
    calibrate_campaign, weigh_evidence,
};

use crate::lab::{Faults, Lab, Run};

/// Level of all intervals here.
pub(crate) const LEVEL: f64 = 0.9;

/// Result of one campaign.
#[derive(Debug)]
pub(crate) struct Judged {
    pub(crate) truth: [f64; 2],
    pub(crate) found: CampaignFit,
    pub(crate) assessment: Assessment,
    pub(crate) likelihood: [f64; 2],
}

/// For r_s and χ, `true` if the truth lies within.
pub(crate) fn holds(intervals: &Intervals, truth: [f64; 2]) -> [bool; 2] {
    [intervals.sphere_radius, intervals.chi]
        .into_iter()
        .zip(truth)
        .map(|([low, high], truth)| (low..=high).contains(&truth))
        .collect::<Vec<_>>()
        .try_into()
        .expect("two")
}

impl Judged {
    pub(crate) fn of(lab: &Lab) -> Result<Self, calibrate::CalibrateError> {
        Self::at(lab, LEVEL)
    }

    /// With intervals of this level.
    pub(crate) fn at(lab: &Lab, level: f64) -> Result<Self, calibrate::CalibrateError> {
        let (campaign, data) = lab.campaign();
        let found = calibrate_campaign(&campaign, &data, FitOptions { level })?;
        let options = EvidenceOptions {
            draws: 200,
            seed: 1,
        };
        let evidence = weigh_evidence(&found, options)?;
        let likelihood = evidence.likelihood.estimate;
        Ok(Self {
            truth: [lab.body.sphere, lab.body.chi],
            assessment: assess(&found, &JointEstimate::of(&found)?, Some(&evidence)),
            likelihood: [likelihood.sphere_radius, likelihood.chi],
            found,
        })
    }

    pub(crate) fn systematics(&self) -> &Systematics {
        self.assessment.systematics.as_ref().expect("enough runs")
    }

    /// With systematics: r_s and χ.
    pub(crate) fn holds(&self) -> [bool; 2] {
        holds(&self.systematics().intervals, self.truth)
    }

    pub(crate) fn refused(&self) -> bool {
        self.assessment.verdict == Verdict::DoNotUse
    }

    pub(crate) fn names(&self, word: &str) -> bool {
        self.assessment
            .reasons
            .iter()
            .any(|reason| reason.contains(word))
    }

    /// Half widths with systematics, as shares of the truth.
    pub(crate) fn widths(&self) -> [f64; 2] {
        let Intervals {
            sphere_radius: r,
            chi,
            ..
        } = self.systematics().intervals;
        [
            (r[1] - r[0]) / 2.0 / self.truth[0],
            (chi[1] - chi[0]) / 2.0 / self.truth[1],
        ]
    }

    pub(crate) fn line(&self) -> String {
        let fit = &self.found.fit;
        let Systematics {
            estimate,
            intervals,
            reduced_chi2,
            ..
        } = self.systematics();
        let [r, chi] = self.truth;
        let off = |value: f64, truth: f64| 100.0 * (value / truth - 1.0);
        format!(
            "paper {:+.2} {:+.2} %; likelihood {:+.2} {:+.2} %; systematics {:+.2} {:+.2} % (±{:.2} ±{:.2} %) {}{} χ² {:.1} → {:.1}; {}: {}",
            off(fit.sphere_radius, r),
            off(fit.chi, chi),
            off(self.likelihood[0], r),
            off(self.likelihood[1], chi),
            off(estimate.sphere_radius, r),
            off(estimate.chi, chi),
            100.0 * self.widths()[0],
            100.0 * self.widths()[1],
            if holds(intervals, self.truth) == [true; 2] {
                "inside"
            } else {
                "OUTSIDE"
            },
            if self.assessment.headline.by == "paper" {
                ""
            } else {
                " (recommended)"
            },
            self.assessment.goodness.reduced_chi2.unwrap_or(f64::NAN),
            reduced_chi2.unwrap_or(f64::NAN),
            self.assessment.verdict,
            self.assessment.reasons.join(" | ")
        )
    }
}

/// Numbers by chance, the same for the same seed.
pub(crate) struct Chance(pub(crate) rand_chacha::ChaCha8Rng);

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        use rand::SeedableRng;
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(17);
        Self(rng)
    }

    pub(crate) fn normal(&mut self) -> f64 {
        use rand_distr::{Distribution, StandardNormal};
        StandardNormal.sample(&mut self.0)
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        use rand::RngExt;
        self.0.random_range(low..high)
    }
}

/// A campaign in which nothing is wrong but chance: 5 to 8 circles of 5 to 8 cycles, noise of 0.1 to 1 mm, fluid that drifts
/// anew in each run.
pub(crate) fn by_chance(seed: u64) -> Lab {
    let mut chance = Chance::new(seed);
    let mut lab = Lab::sparse(seed);
    lab.body.sphere = chance.within(0.03, 0.09);
    lab.body.chi = chance.within(2.0, 4.5);
    lab.cameras.noise = chance.within(1e-4_f64.ln(), 1e-3_f64.ln()).exp();
    lab.cameras.dropout = 0.002;
    let drift = chance.within(1e-6_f64.ln(), 2e-5_f64.ln()).exp();
    let runs = 5 + (seed % 4) as usize;
    lab.cycles = 5 + (seed / 4 % 4) as u32;
    let step = 85.0 / runs as f64;
    lab.runs = (0..runs)
        .map(|run| {
            let degrees = 25.0 + step * (run as f64 + chance.within(0.1, 0.9));
            Run {
                faults: Faults {
                    drift: [drift * chance.normal(), drift * chance.normal()],
                    ..Faults::default()
                },
                // Whole tenths: the campaign's text names them.
                ..Run::of((10.0 * degrees).round() / 10.0)
            }
        })
        .collect();
    lab
}

/// The same with what no laboratory knows exactly: gain 0.5 % rms, offsets 0.3°, reflectors 0.5 mm, scale 0.2 %.
pub(crate) fn with_systematics(seed: u64) -> Lab {
    let mut lab = by_chance(seed);
    let mut chance = Chance::new(seed + 1_000_000);
    let gain = 1.0 + 0.005 * chance.normal();
    for joint in &mut lab.joints {
        joint.gain = gain;
        joint.offset = 0.3_f64.to_radians() * chance.normal();
    }
    let (along, across) = (5e-4 * chance.normal(), 5e-4 * chance.normal());
    for place in [&mut lab.places.front, &mut lab.places.back] {
        place[0] += along;
        place[1] += across;
    }
    lab.cameras.scale = 1.0 + 0.002 * chance.normal();
    lab
}

/// The same with small errors that no campaign states: lengths 0.3 mm, cameras tilted by up to 1°, a lens that distorts by up to 1 %
/// at one metre, runs in all directions and at all places.
pub(crate) fn small_errors(seed: u64) -> Lab {
    let mut lab = with_systematics(seed).with_runs_all_over();
    let mut chance = Chance::new(seed + 2_000_000);
    lab.body.middle += 3e-4 * chance.normal();
    lab.body.front += 3e-4 * chance.normal();
    lab.body.back += 3e-4 * chance.normal();
    lab.cameras.tilt = chance.within(0.0, 1.0).to_radians();
    lab.cameras.distortion = chance.within(-0.01, 0.01);
    lab
}
