//! The model's answers where more than r_s and χ may differ from what the files say.

use std::borrow::Cow;

use nalgebra::{DMatrix, Vector2};
use swimmer_files::{ServoFile, SwimmerFile};
use swimmer_model::{Swimmer, TangentialDrag};

use super::Slot;
use crate::campaign::{CalibrateError, CampaignData, CampaignFit, RunResult};
use crate::cycles::{Harmonics, Projection};
use crate::prediction::JointPath;

/// Dead bands to start from \[rad\], beside the files'.
const DEAD_BANDS: [f64; 3] = [0.03, 0.09, 0.18];
/// Offsets of the reflectors' middle to start from, as shares of the largest: seen from the wrong side of the joints' middle a link
/// sways nearly as much, so that there are two minima.
const MARKERS: [f64; 2] = [-0.5, 0.5];

/// Runs, and the parameters that may differ.
pub(crate) struct Setting<'a> {
    start: &'a SwimmerFile,
    data: &'a CampaignData,
    runs: &'a [RunResult],
    /// Headings by which the measured cycles were cut.
    cut_by: Vec<Harmonics>,
    projection: Projection,
    pub(crate) scales: [f64; 3],
    pub(crate) slots: Vec<Slot>,
}

impl<'a> Setting<'a> {
    /// For a finished fit, whose model cut the cycles.
    pub(crate) fn new(
        start: &'a SwimmerFile,
        data: &'a CampaignData,
        found: &'a CampaignFit,
        slots: Vec<Slot>,
        scales: [f64; 3],
    ) -> Result<Self, CalibrateError> {
        let projection = Projection::new();
        let heading =
            |run: &RunResult| Ok(run.path.predict(&found.swimmer.swimmer, &projection)?.1);
        let cut_by = found
            .runs
            .iter()
            .map(heading)
            .collect::<Result<_, CalibrateError>>()?;
        Ok(Self {
            start,
            data,
            runs: &found.runs,
            cut_by,
            projection,
            scales,
            slots,
        })
    }

    /// The same with other parameters.
    pub(crate) fn with_slots(&self, slots: Vec<Slot>) -> Self {
        Self {
            start: self.start,
            data: self.data,
            runs: self.runs,
            cut_by: self.cut_by.clone(),
            projection: self.projection.clone(),
            scales: self.scales,
            slots,
        }
    }

    /// A slot's value, if it is one of the parameters.
    fn value(&self, z: &[f64], slot: Slot) -> Option<f64> {
        let place = self.slots.iter().position(|s| *s == slot)?;
        z.get(place).copied()
    }

    /// The swimmer file at these parameters.
    pub(crate) fn file(&self, z: &[f64]) -> SwimmerFile {
        let mut file = self.start.clone();
        let swimmer = &mut file.swimmer;
        if let Some(radius) = self.value(z, Slot::SphereRadius) {
            swimmer.sphere_radius = radius * self.length();
        }
        if let Some(chi) = self.value(z, Slot::Chi) {
            swimmer.chi = chi.exp();
        }
        if let Some(ratio) = self.value(z, Slot::TangentialDrag) {
            let value = over_viscosity(&self.start.swimmer) * ratio.exp();
            swimmer.tangential_drag = TangentialDrag::OverViscosity(value);
        }
        if let Some(dead_band) = self.value(z, Slot::DeadBand) {
            file.servo = Some(ServoFile {
                dead_band,
                ..file.servo.unwrap_or_default()
            });
        }
        file
    }

    /// X, ΔY, Δθ of every run, in units of their scales; `None` where the swimmer cannot swim.
    pub(crate) fn predict(&self, z: &[f64]) -> Option<Vec<f64>> {
        let file = self.file(z);
        let dead_band = self.value(z, Slot::DeadBand);
        let offsets = [Slot::FrontOffset, Slot::BackOffset].map(|slot| self.value(z, slot));
        let marker = [Slot::MarkerAlong, Slot::MarkerAcross]
            .map(|slot| self.value(z, slot).unwrap_or(0.0) * self.length());
        let mut out = Vec::with_capacity(3 * self.runs.len());
        for ((played, run), cut_by) in self.runs.iter().zip(&self.data.runs).zip(&self.cut_by) {
            let mut path = match dead_band {
                None => Cow::Borrowed(&played.path),
                Some(_) => {
                    Cow::Owned(JointPath::new(&run.gait, file.servo.as_ref(), run.period_s).ok()?)
                }
            };
            if offsets.iter().any(Option::is_some) {
                let [front, back] = offsets.map(|offset| offset.unwrap_or(0.0));
                path = Cow::Owned(path.moved(Vector2::new(front, back)));
            }
            let cycle = path.predict_as_cut(&file.swimmer, &self.projection, marker.into(), cut_by);
            let cycle = cycle.ok()?;
            let values = [cycle.x_m, cycle.delta_y_m, cycle.delta_theta_rad];
            out.extend(values.iter().zip(self.scales).map(|(v, scale)| v / scale));
        }
        out.iter().all(|value| value.is_finite()).then_some(out)
    }

    /// Derivatives by differences, wide for what is not smooth, one-sided next to a bound.
    pub(crate) fn jacobian(&self, z: &[f64]) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(3 * self.runs.len(), z.len());
        for (column, slot) in self.slots.iter().enumerate() {
            let (low, high) = slot.bounds(self.length(), &self.start.swimmer);
            let at = |value: f64| {
                let mut z = z.to_vec();
                z[column] = value;
                self.predict(&z)
            };
            let behind = (z[column] - slot.step()).max(low);
            let ahead = (z[column] + slot.step()).min(high);
            for (row, (b, a)) in at(behind)?.iter().zip(at(ahead)?).enumerate() {
                jacobian[(row, column)] = (a - b) / (ahead - behind);
            }
        }
        Some(jacobian)
    }

    /// Where each parameter may lie.
    pub(crate) fn bounds(&self) -> Vec<(f64, f64)> {
        let of = |slot: &Slot| slot.bounds(self.length(), &self.start.swimmer);
        self.slots.iter().map(of).collect()
    }

    /// What the files say of each parameter, and the fit of r_s and χ.
    pub(crate) fn begin(&self, found: &CampaignFit) -> Vec<f64> {
        let of = |slot: &Slot| match slot {
            Slot::SphereRadius => found.fit.sphere_radius / self.length(),
            Slot::Chi => found.fit.chi.ln(),
            Slot::DeadBand => self.start.servo.map_or(0.0, |servo| servo.dead_band),
            _ => 0.0,
        };
        self.slots.iter().map(of).collect()
    }

    /// Where a search begins, more than once for what has more than one minimum.
    pub(crate) fn starts(&self, found: &CampaignFit) -> Vec<Vec<f64>> {
        let begun = self.begin(found);
        let mut starts = vec![begun.clone()];
        for (place, (slot, (_, high))) in self.slots.iter().zip(self.bounds()).enumerate() {
            let others: &[f64] = match slot {
                Slot::DeadBand => &DEAD_BANDS,
                Slot::MarkerAlong | Slot::MarkerAcross => &MARKERS.map(|share| share * high),
                _ => &[],
            };
            starts.extend(others.iter().map(|value| {
                let mut start = begun.clone();
                start[place] = *value;
                start
            }));
        }
        starts
    }

    /// A parameter in units of people: m, rad, or the plain number.
    pub(crate) fn natural(&self, slot: Slot, value: f64) -> f64 {
        match slot {
            Slot::SphereRadius | Slot::MarkerAlong | Slot::MarkerAcross => value * self.length(),
            Slot::Chi => value.exp(),
            Slot::TangentialDrag => over_viscosity(&self.start.swimmer) * value.exp(),
            Slot::FrontOffset | Slot::BackOffset | Slot::DeadBand => value,
        }
    }

    fn length(&self) -> f64 {
        self.start.swimmer.total_length()
    }
}

/// c_t/μ of the side links.
fn over_viscosity(swimmer: &Swimmer<f64>) -> f64 {
    swimmer.tangential_drag.over_viscosity(swimmer.links.front)
}
