//! Joint angles that a table produces: the brain's set-points and pulses at 50 Hz, through the servo model. The digital twin
//! uses the same parts, so predictions and fits along this path match the tank.

use crate::ramp::{NEUTRAL, Ramp};
use crate::servo::{ServoMap, plant::PlantParameters, plant::ServoPlant};
use crate::{GaitTable, Limits, TICK_US};

/// Table with period, maps, limits and servo model.
#[derive(Clone, Copy, Debug)]
pub struct Playback<'a> {
    /// The table.
    pub table: &'a GaitTable,
    /// Duration of a cycle, µs.
    pub period_us: u32,
    /// Maps of the servos.
    pub maps: [ServoMap; 2],
    /// Limits in force. They shape the soft start.
    pub limits: Limits,
    /// Servo model.
    pub plant: PlantParameters,
}

/// Vertex of the path. Between two vertices both angles change at a constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlayedPoint {
    /// Time since the reported cycle's start, s.
    pub time_s: f64,
    /// Joint angles, rad.
    pub angles: [f64; 2],
    /// Commanded joint angles, rad (held for a tick).
    pub command: [f64; 2],
}

impl Playback<'_> {
    /// Visits the path of one cycle (0 is the first), both ends included. The motion before it is simulated too: soft start
    /// from neutral and earlier cycles. From cycle 1 on the servos are in steady state if the gait exceeds their dead band.
    pub fn cycle(&self, cycle: u32, mut visit: impl FnMut(PlayedPoint)) {
        let tick = u64::from(TICK_US);
        let mut servos = [ServoPlant::new(0.0); 2];
        let ramp = Ramp::soft(NEUTRAL, self.table.knot_angles(0), false, &self.limits);
        for at in (0..u64::from(ramp.duration_us())).step_by(TICK_US as usize) {
            let command = self.command(ramp.at(at));
            self.advance(&mut servos, command, tick as f64 * 1e-6);
        }
        let period = u64::from(self.period_us.max(1));
        let (start, end) = (period * u64::from(cycle), period * (u64::from(cycle) + 1));
        let mut now = 0;
        while now < end {
            let tick_start = now / tick * tick;
            let phase = self
                .table
                .phase((tick_start % period) as u32, self.period_us);
            let command = self.command(self.table.at(phase).angles);
            // Ends at the tick, or at the start or end of the reported cycle within it.
            let border = if now < start { start } else { end };
            let until = (tick_start + tick).min(border);
            if now < start {
                self.advance(&mut servos, command, (until - now) as f64 * 1e-6);
            } else {
                self.visit_tick(
                    &mut servos,
                    command,
                    (now - start, until - start),
                    &mut visit,
                );
            }
            now = until;
        }
    }

    /// Commanded angles of a set-point, after rounding to pulses and timer steps, rad.
    pub fn command(&self, setpoint: [f32; 2]) -> [f64; 2] {
        core::array::from_fn(|joint| {
            let map = &self.maps[joint];
            self.plant.command(map, map.pulse_ns(setpoint[joint]))
        })
    }

    fn advance(&self, servos: &mut [ServoPlant; 2], command: [f64; 2], seconds: f64) {
        for (servo, command) in servos.iter_mut().zip(command) {
            servo.advance(&self.plant, command, seconds);
        }
    }

    /// Visits the start of a piece of a tick, each joint's stop within it, and its end.
    fn visit_tick(
        &self,
        servos: &mut [ServoPlant; 2],
        command: [f64; 2],
        (from_us, until_us): (u64, u64),
        visit: &mut impl FnMut(PlayedPoint),
    ) {
        let (from, until) = (from_us as f64 * 1e-6, until_us as f64 * 1e-6);
        let mut point = |servos: &[ServoPlant; 2], time_s: f64| {
            visit(PlayedPoint {
                time_s,
                angles: [servos[0].angle, servos[1].angle],
                command,
            });
        };
        point(servos, from);
        let stops = [0, 1].map(|joint| servos[joint].time_to_rest(&self.plant, command[joint]));
        let mut now = from;
        for stop in [stops[0].min(stops[1]), stops[0].max(stops[1])] {
            let at = from + stop;
            if at > now && at < until {
                self.advance(servos, command, at - now);
                point(servos, at);
                now = at;
            }
        }
        self.advance(servos, command, until - now);
        point(servos, until);
    }
}

/// One table in a sequence of plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlayedLeg<'a> {
    /// The robot's table.
    pub table: &'a GaitTable,
    /// Number of cycles.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
}

/// Visits the set-points of tables that follow each other without a pause ([`link_protocol::Request::Follow`]), one per tick,
/// from the first of the soft start until the joints are straight again.
pub fn setpoints(legs: &[PlayedLeg<'_>], limits: &Limits, mut visit: impl FnMut([f32; 2])) {
    let (Some(first), Some(last)) = (legs.first(), legs.last()) else {
        return;
    };
    let tick = u64::from(TICK_US);
    let ramp = Ramp::soft(NEUTRAL, first.table.knot_angles(0), false, limits);
    for at in (0..u64::from(ramp.duration_us())).step_by(TICK_US as usize) {
        visit(ramp.at(at));
    }
    // The rest of a tick at the end of a leg belongs to the next one.
    let mut over = 0;
    for leg in legs {
        let period = u64::from(leg.period_us.max(1));
        let end = period * u64::from(leg.cycles);
        while over < end {
            let phase = leg.table.phase((over % period) as u32, leg.period_us);
            visit(leg.table.at(phase).angles);
            over += tick;
        }
        over -= end;
    }
    let ramp = Ramp::to_neutral(last.table.knot_angles(0), limits);
    for at in (0..=u64::from(ramp.duration_us())).step_by(TICK_US as usize) {
        visit(ramp.at(at));
    }
}

impl Playback<'_> {
    /// Visits the path of servos that start at rest at these angles \[rad\] and follow these set-points, one per tick, both ends
    /// included.
    pub fn through(
        &self,
        rest: [f64; 2],
        setpoints: impl IntoIterator<Item = [f32; 2]>,
        mut visit: impl FnMut(PlayedPoint),
    ) {
        let tick = u64::from(TICK_US);
        let mut servos = rest.map(ServoPlant::new);
        let mut now = 0;
        for setpoint in setpoints {
            self.visit_tick(
                &mut servos,
                self.command(setpoint),
                (now, now + tick),
                &mut visit,
            );
            now += tick;
        }
    }
}
