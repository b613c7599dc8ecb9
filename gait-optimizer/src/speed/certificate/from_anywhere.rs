//! Certificates of any gait: heading and period for which it is optimal are read from the gait.

use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::Model;

use super::legs::Legs;
use super::{GaitRequirements, certificate};
use crate::certificate::Certificate;
use crate::region::Region;
use crate::speed::setting::{Goal, HeadingRule};

/// Certifies a gait with the timing of its samples: as the farthest in its own period if its file states a period, otherwise as the
/// fastest of any period.
///
/// A gait that fails for any heading passes if it is optimal for the headings forward or sideways.
pub(crate) fn certify_speed(
    model: &Model<f64>,
    (file, gait): (&GaitFile, &AnyGait),
    region: &Region,
) -> Certificate {
    // Times are fractions of its own period.
    let period = file.optimal_period.map(|_| 1.0);
    let of = |heading| {
        let asked = GaitRequirements {
            heading,
            period,
            ..GaitRequirements::default()
        };
        certificate((model, &[]), region, asked, file, gait)
    };
    let any = of(HeadingRule::Any);
    if any.pass() {
        return any;
    }
    let headings = [HeadingRule::Forward, HeadingRule::Sideways];
    let mut prescribed = headings.into_iter().map(of);
    prescribed.find(Certificate::pass).unwrap_or(any)
}

/// Returns the angle \[rad\] by which the faster servo turns in one period at its full rate. Returns `None` if the gait does not swim.
pub(crate) fn turned_per_period(
    model: &Model<f64>,
    (file, gait): (&GaitFile, &AnyGait),
    region: &Region,
) -> Option<f64> {
    let legs = Legs::new((model, &[]), region, Goal::Distance, file, gait)?;
    Some(legs.rates[0].max(legs.rates[1]))
}
