//! Two servos between pulses and joint angles: the inverse of a servo map, which may differ from the brain's, and the servo
//! model of all predictions.

use gait_player::servo::ServoMap;
use gait_player::servo::plant::{PlantParameters, ServoPlant};
use nalgebra::Vector2;

/// Both shafts, initially at rest and straight.
///
/// ```
/// use swimmer_files::SwimmerFile;
/// use twin::{Servos, TwinConfig};
///
/// let config = TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1).with_ideal_servos();
/// let mut servos = Servos::new(config.shafts, config.plant);
/// servos.set_pulses(Some([1_510_000; 2]));
/// servos.advance(2.0, |_, _| {});
/// // 10 µs of pulse at 0.0274 rad/µs, as near as the servos of this seed are made.
/// assert!((servos.angles()[0].abs() - 0.274).abs() < 0.15, "{:?}", servos.angles());
/// ```
#[derive(Debug, Clone)]
pub struct Servos {
    maps: [ServoMap; 2],
    plant: PlantParameters,
    shafts: [ServoPlant; 2],
    /// Angles commanded by the last pulses, rad. Without a pulse (`None`) a servo has no torque, and its gears hold.
    command: [Option<f64>; 2],
}

impl Servos {
    /// Returns servos at angle 0 without pulses.
    pub fn new(maps: [ServoMap; 2], plant: PlantParameters) -> Self {
        Self {
            maps,
            plant,
            shafts: [ServoPlant::new(0.0); 2],
            command: [None; 2],
        }
    }

    /// Shaft angles, rad.
    pub fn angles(&self) -> [f64; 2] {
        self.shafts.map(|shaft| shaft.angle)
    }

    /// Sets new pulses, ns, or switches them off. A pulse of 0 ns is none.
    pub fn set_pulses(&mut self, pulses_ns: Option<[u32; 2]>) {
        let pulses_ns = pulses_ns.unwrap_or_default();
        self.command = std::array::from_fn(|joint| {
            let pulse_ns = pulses_ns[joint];
            (pulse_ns > 0).then(|| self.plant.command(&self.maps[joint], pulse_ns))
        });
    }

    /// Advances by `seconds`. `visit` receives each vertex of the path and the time since the vertex before it \[s\]; between two of
    /// them both angles change at constant rates.
    pub fn advance(&mut self, seconds: f64, mut visit: impl FnMut(Vector2<f64>, f64)) {
        let command = self.command;
        if command == [None; 2] {
            visit(Vector2::from(self.angles()), seconds);
            return;
        }
        let rests: [f64; 2] = std::array::from_fn(|joint| {
            command[joint].map_or(0.0, |command| {
                self.shafts[joint].time_to_rest(&self.plant, command)
            })
        });
        let mut now = 0.0;
        for vertex in [rests[0].min(rests[1]), rests[0].max(rests[1]), seconds] {
            if vertex > now && vertex <= seconds {
                for (shaft, command) in self.shafts.iter_mut().zip(command) {
                    if let Some(command) = command {
                        shaft.advance(&self.plant, command, vertex - now);
                    }
                }
                visit(Vector2::from(self.angles()), vertex - now);
                now = vertex;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_has_a_vertex_where_a_shaft_comes_to_rest() {
        let plant = PlantParameters {
            max_rate: 2.0,
            dead_band: 0.0,
            pulse_step_ns: 0,
        };
        let map = ServoMap::ROBOT;
        let mut servos = Servos::new([map; 2], plant);
        servos.set_pulses(Some([map.pulse_ns(0.01), map.pulse_ns(-1.0)]));
        let mut path = Vec::new();
        servos.advance(0.02, |phi, _| path.push(phi));
        assert_eq!(path.len(), 2);
        assert!(
            (path[0] - Vector2::new(0.01, -0.01)).norm() < 2e-5,
            "{path:?}"
        );
        assert!(
            (path[1] - Vector2::new(0.01, -0.04)).norm() < 2e-5,
            "{path:?}"
        );
    }

    #[test]
    fn a_pulse_of_zero_is_none() {
        let map = ServoMap::ROBOT;
        let mut servos = Servos::new([map; 2], PlantParameters::IDEAL);
        servos.set_pulses(Some([map.pulse_ns(0.5), map.pulse_ns(-0.3)]));
        servos.advance(0.02, |_, _| {});
        servos.set_pulses(Some([map.pulse_ns(0.7), 0]));
        servos.advance(0.02, |_, _| {});
        let [front, back] = servos.angles();
        assert!((front - 0.7).abs() < 2e-5 && (back + 0.3).abs() < 2e-5);
    }

    #[test]
    fn without_pulses_the_gears_hold() {
        let map = ServoMap::ROBOT;
        let mut servos = Servos::new([map; 2], PlantParameters::IDEAL);
        servos.set_pulses(Some([map.pulse_ns(0.5); 2]));
        servos.advance(0.02, |_, _| {});
        let held = Vector2::from(servos.angles());
        servos.set_pulses(None);
        servos.advance(1.0, |phi, seconds| assert_eq!((phi, seconds), (held, 1.0)));
        assert!((servos.angles()[0] - 0.5).abs() < 2e-5);
    }
}
