//! Holds a gait from anywhere against the conditions of what it may have been made for.

use std::cell::Cell;

use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::Model;

use super::legs::Legs;
use super::{Asked, certificate, within_its_own};
use crate::certificate::{Certificate, Condition};
use crate::region::Region;
use crate::speed::setting::{Goal, HeadingRule};

/// Whose limits a gait was made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MadeFor {
    /// Those of its servos' rates.
    Rates,
    /// Others that it takes in full.
    Others,
}

/// The conditions of a gait from anywhere, timed as its samples are. One whose servos are slower than their rates somewhere may have
/// been made for other limits; where they clearly are, and nearly take others in full all along, it was. That is told of the samples
/// as they are, and kept for others of the same gait.
pub(crate) fn certify_speed(
    model: &Model<f64>,
    (file, gait): (&GaitFile, &AnyGait),
    region: &Region,
    made_for: &Cell<Option<MadeFor>>,
) -> Certificate {
    const CLEARLY: f64 = 1e-2;
    const NEARLY: f64 = 0.9;
    let others = || within_its_own((model, region), (file, gait));
    let rates = || certify_at_rates(model, file, gait, region);
    match made_for.get() {
        Some(MadeFor::Rates) => return rates(),
        Some(MadeFor::Others) => return others(),
        None => {}
    }
    let legs = Legs::new((model, &[]), region, Goal::Distance, file, gait);
    let off = legs.map_or(0.0, |legs| legs.off_full_rate());
    let takes = |within: &Certificate| within.value(Condition::TakesLimit) > Some(NEARLY);
    let meant = |within: &Certificate| within.pass() || off > CLEARLY && takes(within);
    let slower = off > Condition::FullRate.tolerance();
    let within = slower.then(others).filter(meant);
    made_for.set(Some(match within {
        Some(_) => MadeFor::Others,
        None => MadeFor::Rates,
    }));
    within.unwrap_or_else(rates)
}

/// The same of one that was made for its servos' rates. One that leads exactly along its mean heading, or across, may have been asked
/// to, and one that is slower than a longer or shorter one may have been given its period; it then passes as such.
fn certify_at_rates(
    model: &Model<f64>,
    file: &GaitFile,
    gait: &AnyGait,
    region: &Region,
) -> Certificate {
    let of = |(heading, period)| {
        let asked = Asked {
            heading,
            period,
            ..Asked::default()
        };
        certificate((model, &[]), region, asked, file, gait)
    };
    let free = of((HeadingRule::Any, None));
    if free.pass() {
        return free;
    }
    // Times are shares of its own period here.
    let own = Some(1.0);
    [
        (HeadingRule::Forward, None),
        (HeadingRule::Sideways, None),
        (HeadingRule::Any, own),
        (HeadingRule::Forward, own),
        (HeadingRule::Sideways, own),
    ]
    .into_iter()
    .map(of)
    .find(Certificate::pass)
    .unwrap_or(free)
}
