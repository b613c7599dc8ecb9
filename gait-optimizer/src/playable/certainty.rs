//! How sure a forecast's displacement is, from what a calibration leaves open of `r_s` and χ.

use swimmer_model::{InvalidSwimmer, Model, Swimmer, swim};

use super::forecast::{Forecast, tolerance};
use crate::Uncertainty;

impl Forecast {
    /// Half width of the displacement's interval \[m\], along the designed displacement, at the level of the fit's intervals:
    /// the played way swum by the swimmers at the ends of both intervals, to first order, with their correlation where the
    /// fit tells it.
    ///
    /// # Errors
    /// An end of an interval at which there is no swimmer.
    pub fn displacement_error(
        &self,
        model: &Model<f64>,
        uncertainty: &Uncertainty,
    ) -> Result<f64, InvalidSwimmer> {
        let along = self
            .stages
            .first()
            .and_then(|designed| designed.displacement.try_normalize(0.0))
            .unwrap_or_else(nalgebra::Vector2::x);
        let swum = |sphere_radius, chi| -> Result<f64, InvalidSwimmer> {
            let swimmer = Swimmer {
                sphere_radius,
                chi,
                ..*model.swimmer()
            };
            let stroke = swim(&Model::new(&swimmer)?, &self.way, &tolerance());
            Ok(along.dot(&stroke.displacement))
        };
        let (radius, chi) = (uncertainty.sphere_radius, uncertainty.chi);
        let [radius_low, radius_high] = uncertainty.sphere_radius_interval;
        let [chi_low, chi_high] = uncertainty.chi_interval;
        let by_radius = 0.5 * (swum(radius_high, chi)? - swum(radius_low.max(0.0), chi)?);
        let by_chi = 0.5 * (swum(radius, chi_high)? - swum(radius, chi_low)?);
        let correlation = uncertainty.correlation.unwrap_or(0.0);
        let variance =
            by_radius * by_radius + by_chi * by_chi + 2.0 * correlation * by_radius * by_chi;
        Ok(variance.max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::playable::{Played, Servos, forecast};
    use swimmer_files::{AnyGait, ServoFile};

    #[test]
    fn the_error_follows_the_intervals() {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let played = Played {
            servos: Servos::on_the_robot(ServoFile::default()),
            period: 30.0,
            knots: 128,
        };
        let told = forecast(&model, &AnyGait::circle(1.2), &played).unwrap();
        let Swimmer {
            sphere_radius, chi, ..
        } = *model.swimmer();
        let error = |by_radius: f64, by_chi: f64, correlation| {
            let uncertainty = Uncertainty {
                sphere_radius_interval: [sphere_radius - by_radius, sphere_radius + by_radius],
                chi_interval: [chi - by_chi, chi + by_chi],
                correlation,
                ..Uncertainty::none(sphere_radius, chi)
            };
            told.displacement_error(&model, &uncertainty).unwrap()
        };
        assert!(error(0.0, 0.0, None) < 1e-15);
        let (radius, chi_alone) = (error(1e-4, 0.0, None), error(0.0, 0.01, None));
        assert!(radius > 1e-7 && chi_alone > 1e-7, "{radius} {chi_alone}");
        // Twice the interval, twice the error; two independent sources add as squares; correlated ones more or less.
        assert!((error(2e-4, 0.0, None) / radius - 2.0).abs() < 1e-3);
        let both = error(1e-4, 0.01, None);
        assert!((both - radius.hypot(chi_alone)).abs() < 1e-12);
        let (with, against) = (error(1e-4, 0.01, Some(0.9)), error(1e-4, 0.01, Some(-0.9)));
        assert!(with.min(against) < both && both < with.max(against));
    }
}
