//! Uncertainty of a forecast's displacement, from the intervals of `r_s` and χ of a calibration.

use swimmer_model::{InvalidSwimmer, Model, Swimmer, swim};

use crate::losses::{Forecast, tolerance};

impl Forecast {
    /// Half width of the displacement's interval \[m\], along the designed displacement, at the level of the fit's intervals: the
    /// played path integrated for the swimmers at the ends of the intervals of `r_s` \[m\] and χ, the other parameter at the
    /// fitted value, to first order, with the correlation of both estimates if the fit reports it. A negative sphere radius
    /// counts as 0.
    ///
    /// # Errors
    /// An end of an interval that is no valid swimmer.
    ///
    /// ```
    /// use forecast::{Played, Servos, forecast};
    /// use swimmer_files::{AnyGait, ServoFile};
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let robot = Swimmer::robot();
    /// let played = Played { servos: Servos::on_the_robot(ServoFile::default()), period: 30.0, knots: 512 };
    /// let forecast = forecast(&Model::new(&robot)?, &AnyGait::circle(1.2), &played).unwrap();
    /// let narrow = forecast.displacement_error(&robot, [0.0690, 0.0694], [3.58, 3.62], None)?;
    /// let wide = forecast.displacement_error(&robot, [0.0680, 0.0704], [3.50, 3.70], None)?;
    /// assert!(narrow < wide);
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    pub fn displacement_error(
        &self,
        fitted: &Swimmer<f64>,
        sphere_radius: [f64; 2],
        chi: [f64; 2],
        correlation: Option<f64>,
    ) -> Result<f64, InvalidSwimmer> {
        let designed = self.stages.first();
        let along = designed
            .and_then(|designed| designed.displacement.try_normalize(0.0))
            .unwrap_or_else(nalgebra::Vector2::x);
        let swum = |swimmer| {
            let model = Model::new(&swimmer)?;
            Ok(along.dot(&swim(&model, &self.way, &tolerance()).displacement))
        };
        let half = |[low, high]: [Swimmer<f64>; 2]| Ok(0.5 * (swum(high)? - swum(low)?));
        let by_radius = half(sphere_radius.map(|radius| Swimmer {
            sphere_radius: radius.max(0.0),
            ..*fitted
        }))?;
        let by_chi = half(chi.map(|chi| Swimmer { chi, ..*fitted }))?;
        let correlation = correlation.unwrap_or(0.0);
        let variance =
            by_radius * by_radius + by_chi * by_chi + 2.0 * correlation * by_radius * by_chi;
        Ok(variance.max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Played, Servos, forecast};
    use swimmer_files::{AnyGait, ServoFile};

    #[test]
    fn the_error_follows_the_intervals() {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let played = Played {
            servos: Servos::on_the_robot(ServoFile::default()),
            period: 30.0,
            knots: 128,
        };
        let predicted = forecast(&model, &AnyGait::circle(1.2), &played).unwrap();
        let Swimmer {
            sphere_radius, chi, ..
        } = *model.swimmer();
        let error = |by_radius: f64, by_chi: f64, correlation| {
            let around = |value: f64, by: f64| [value - by, value + by];
            let intervals = (around(sphere_radius, by_radius), around(chi, by_chi));
            predicted
                .displacement_error(model.swimmer(), intervals.0, intervals.1, correlation)
                .unwrap()
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
