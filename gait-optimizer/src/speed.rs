//! The fastest gait: most net displacement per unit of time with no net rotation, when servos turn no faster than they can.
//!
//! With a price on time the problem is well-posed over all closed curves. Extremals are chains of three kinds of arcs: *extreme*
//! (bang-bang: both servos at full rate, straight in the plane of joint angles), *singular* (h = 0, one servo at full rate), and
//! along a bound. The search is global and needs no guess: from many starts a primal–dual interior-point method finds a rough
//! polygon near each; those that may be the fastest are refined ([`interior`], [`selection`]). The active constraints of their
//! sides determine the arcs ([`structure`]), and Newton's method solves for them to rounding ([`polish`]). The certificate is
//! computed from the finished curve alone ([`certificate`]).

mod along_clearance;
mod arc;
mod candidate;
pub(crate) mod certificate;
mod chain;
mod curvature;
mod ensemble;
mod error;
mod expansion;
mod fastest;
mod front;
mod interior;
mod pairs;
mod period;
mod polish;
mod problem;
mod quadrature;
mod samples;
mod search;
pub(crate) mod selection;
pub(crate) mod setting;
pub(crate) mod starts;
mod steer;
mod structure;
#[cfg(test)]
mod tests;
mod widened;
mod within_rates;

pub(crate) use candidate::mended;
pub(crate) use certificate::{certify_speed, turned_per_period};
pub use error::SpeedError;
pub use fastest::Fastest;
pub(crate) use fastest::told;
pub use front::{Front, front};
pub(crate) use polish::{Polished, speed_of};
pub use problem::SpeedProblem;
pub use search::{SpeedAtlas, fastest};
pub use setting::HeadingRule;
pub(crate) use setting::Setting;
pub(crate) use steer::certify_joined;
pub use steer::{Joined, SteerProblem, Steering, steer};
