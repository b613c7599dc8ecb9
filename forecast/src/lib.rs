//! Prediction of a gait on a real robot: its shortest period with the servos, the angles that they reach, and the displacement
//! that remains after table, pulses, rate limit and dead band.
//!
//! All of it runs `gait-player`'s own table, playback, plant and table check, so that a forecast and the robot cannot disagree
//! on arithmetic.
//!
//! - [`timing_of_table`]: a gait is a curve; its timing is free. The best timing under a rate limit, of the table that the robot
//!   makes of it, and the shortest period.
//! - [`table()`]: the table that the robot is sent for a gait, with rounded corners.
//! - [`reach()`]: the largest angle of a gait, with its place, compared with the servos' limit.
//! - [`until_wall`]: number of cycles that fit into a tank; [`Forecast::displacement_error`]: uncertainty due to the calibration.
//! - [`plan()`]: a chain of joined gaits that leads to a target and keeps away from walls; [`Planner`]: the same repeatedly, from
//!   cycle to cycle.
//! - [`demand`]: torque, power and Reynolds number in a fluid of known viscosity.
//! - [`forecast()`]: the displacement as designed, as stored, as commanded and as turned, loss by loss, before a gait is sent;
//!   [`forecast_passive`]: the same with a spring in place of one servo.
//!
//! ```
//! use forecast::{Played, Servos, forecast};
//! use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
//! use swimmer_model::Model;
//!
//! let robot = SwimmerFile::preset("robot").unwrap();
//! let model = Model::new(&robot.swimmer).unwrap();
//! let played = Played { servos: Servos::on_the_robot(ServoFile::default()), period: 30.0, knots: 512 };
//! let forecast = forecast(&model, &AnyGait::circle(1.2), &played).unwrap();
//! assert!(forecast.verdict.refused.is_none());
//! // The dead band costs something, and less than a tenth.
//! assert!(forecast.total_loss() > 0.0);
//! assert!(forecast.share(forecast.total_loss()).unwrap() < 0.1);
//! ```

mod certainty;
pub mod fluid;
pub mod losses;
pub mod net_motion;
pub mod path;
pub mod plan;
pub mod playlist;
pub mod reach;
pub mod table;
pub mod tank;
pub mod timing;

pub use fluid::{Demand, demand};
pub use losses::{
    Forecast, ForecastError, Loss, Played, Servos, Stage, Verdict, forecast, forecast_passive,
    thickness,
};
pub use net_motion::NetMotion;
pub use plan::{
    Family, Kind, Member, Plan, PlanError, PlanRequest, Planner, Scaled, Step, Watch, check_ends,
    plan,
};
pub use playlist::{PlaylistTable, Repeated};
pub use reach::{Reach, reach};
pub use table::table;
pub use tank::{Meeting, Part, Tank, meets_wall, until_wall};
pub use timing::{Timing, TimingError, shortest_of_table, shortest_period, timing_of_table};
