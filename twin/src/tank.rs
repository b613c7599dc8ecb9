//! Virtual tank: moves the swimmer along the joint path by the local connection of the model, ġ = g A(Φ) Φ̇.

use nalgebra::{Vector2, Vector3};
use passive_joint::PassiveJoint;
use swimmer_model::{InvalidSwimmer, Model, Pose, Swimmer};

/// Longest piece of a joint path per integration step, rad. The method has order four: at 0.02 rad a step's error is of the
/// order of 1e-9 of the swimmer's length.
const LONGEST_PIECE: f64 = 0.02;
/// Longest piece of a passive joint's path, in relaxation times.
const LONGEST_RELAXATION: f64 = 0.05;

/// Swimmer in a quiescent, very viscous fluid.
///
/// ```
/// use nalgebra::Vector2;
/// use swimmer_model::{Pose, Swimmer};
/// use twin::Tank;
///
/// let mut tank = Tank::new(&Swimmer::robot(), Pose::identity())?;
/// for (one, two) in [(0.1, 0.0), (0.1, 0.1), (0.0, 0.1), (0.0, 0.0)] {
///     tank.move_joints(Vector2::new(one, two));
/// }
/// let swum = tank.pose();
/// assert!(swum.position().norm() > 0.0 && swum.position().norm() < 1e-3, "a small loop, a small way");
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tank {
    model: Model<f64>,
    phi: Vector2<f64>,
    pose: Pose<f64>,
    /// A joint that a spring holds in place of a servo, with κ over one second: k/μ.
    passive: Option<PassiveJoint>,
    /// Velocity of the fluid \[m/s\].
    current: Vector2<f64>,
}

impl Tank {
    /// Places a swimmer with straight joints in the tank.
    ///
    /// # Errors
    /// Lengths and drags form no valid swimmer.
    pub fn new(swimmer: &Swimmer<f64>, pose: Pose<f64>) -> Result<Self, InvalidSwimmer> {
        Ok(Self {
            model: Model::new(swimmer)?,
            phi: Vector2::zeros(),
            pose,
            passive: None,
            current: Vector2::zeros(),
        })
    }

    /// Pose of the middle link in the tank's frame, m and rad.
    pub fn pose(&self) -> Pose<f64> {
        self.pose
    }

    /// Joint angles Φ, rad.
    pub fn phi(&self) -> Vector2<f64> {
        self.phi
    }

    /// The same with a spring in place of a servo. κ of the passive joint is that of one second.
    #[must_use]
    pub fn with_spring(self, passive: PassiveJoint) -> Self {
        Self {
            passive: Some(passive),
            ..self
        }
    }

    /// The same in a fluid that flows at this velocity \[m/s\], which carries the swimmer along.
    #[must_use]
    pub fn with_current(self, current: [f64; 2]) -> Self {
        Self {
            current: current.into(),
            ..self
        }
    }

    /// Follows the servos to `servos` \[rad\] in `seconds`. A passive joint turns by its spring and the drag; its servo is ignored.
    pub fn follow(&mut self, servos: Vector2<f64>, seconds: f64) {
        self.pose.x += self.current.x * seconds;
        self.pose.y += self.current.y * seconds;
        let Some(passive) = self.passive else {
            self.move_joints(servos);
            return;
        };
        let (driven, joint) = (passive.driven().index(), passive.joint.index());
        let start = self.phi[driven];
        let way = servos[driven] - start;
        let relaxations = seconds / passive.relaxation_share(&self.model);
        let pieces = (way.abs() / LONGEST_PIECE)
            .max(relaxations / LONGEST_RELAXATION)
            .ceil();
        if !(pieces >= 1.0 && pieces.is_finite()) {
            return;
        }
        let piece_spring = PassiveJoint {
            kappa: passive.kappa * seconds / pieces,
            ..passive
        };
        let mut piece = 0.0;
        while piece < pieces {
            let to = start + way * (piece + 1.0) / pieces;
            let angle = self.phi[joint];
            let angle = piece_spring
                .follow(&self.model, [self.phi[driven], to], angle)
                .unwrap_or(angle);
            self.move_joints(passive.shape(to, angle));
            piece += 1.0;
        }
    }

    /// Moves the joints on a straight line to `phi`. The rate does not matter without inertia.
    ///
    /// Magnus steps of order four with two Gauss points: exact in SE(2) up to the connection's curvature along the piece.
    pub fn move_joints(&mut self, phi: Vector2<f64>) {
        let way = phi - self.phi;
        let pieces = (way.norm() / LONGEST_PIECE).ceil();
        if !(pieces >= 1.0 && pieces.is_finite()) {
            return;
        }
        let step = way / pieces;
        let gauss = 3.0_f64.sqrt() / 6.0;
        let start = self.phi;
        let mut piece = 0.0;
        while piece < pieces {
            let middle = start + step * (piece + 0.5);
            let [first, second] =
                [-gauss, gauss].map(|at| self.model.local_connection(&(middle + step * at)) * step);
            self.pose = self.pose * Pose::exp(&magnus(&first, &second));
            piece += 1.0;
        }
        self.phi = phi;
    }
}

/// Twist whose exponential solves ġ = g X(s) over one step, from X at the two Gauss points.
fn magnus(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector3<f64> {
    let mean = (first + second) * 0.5;
    // Lie bracket of se(2): [X, Y] = (ω_X J v_Y − ω_Y J v_X, 0), J a quarter turn.
    let bracket = Vector3::new(
        -first.z * second.y + second.z * first.y,
        first.z * second.x - second.z * first.x,
        0.0,
    );
    mean + bracket * (3.0_f64.sqrt() / 12.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::{Circle, Gait, Tolerance, swim};

    /// A polygon with many corners, compared with the model's own integration of the circle: the chords cut off (2π/n)²/6 of
    /// the area.
    #[test]
    fn a_fine_polygon_swims_like_the_circle() {
        for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
            let circle = Circle { amplitude: 1.2 };
            let stroke = swim(
                &Model::new(&swimmer).unwrap(),
                &circle,
                &Tolerance::default(),
            );
            let mut tank = Tank::new(&swimmer, Pose::identity()).unwrap();
            tank.move_joints(circle.at(0.0).phi);
            let start = tank.pose();
            let corners = 20_000_u32;
            for corner in 1..=corners {
                tank.move_joints(circle.at(f64::from(corner) / f64::from(corners)).phi);
            }
            let moved = start.inverse() * tank.pose();
            let error =
                (moved.position() - stroke.displacement).norm() / stroke.displacement.norm();
            assert!(error < 5e-8, "relative error {error:e}");
            assert!((moved.theta - stroke.rotation).abs() < 1e-8);
        }
    }

    #[test]
    fn the_step_is_of_fourth_order_and_ours_is_fine_enough() {
        let swimmer = Swimmer::robot();
        let end = Vector2::new(1.4, -0.9);
        let run = |pieces: u32| {
            let mut tank = Tank::new(&swimmer, Pose::identity()).unwrap();
            for piece in 1..=pieces {
                tank.move_joints(end * f64::from(piece) / f64::from(pieces));
            }
            tank.pose()
        };
        let (whole, fine) = (run(1), run(2000));
        let error = (whole.position() - fine.position())
            .norm()
            .max((whole.theta - fine.theta).abs());
        assert!(error < 1e-9, "{error:e}");
    }

    #[test]
    fn there_and_back_is_nowhere() {
        let mut tank = Tank::new(&Swimmer::purcell(), Pose::new(0.3, 0.2, 1.0)).unwrap();
        tank.move_joints(Vector2::new(1.0, 0.4));
        tank.move_joints(Vector2::zeros());
        let pose = tank.pose();
        assert!(
            (pose.x - 0.3).abs() < 1e-12
                && (pose.y - 0.2).abs() < 1e-12
                && (pose.theta - 1.0).abs() < 1e-12
        );
    }

    /// exp(−t/τ) of a small angle, the driven joint at rest.
    #[test]
    fn a_passive_joint_relaxes_in_its_time() {
        let swimmer = Swimmer::robot();
        let model = Model::new(&swimmer).unwrap();
        let spring = PassiveJoint::relaxing_in(&model, link_protocol::Joint::Back, 2.0).unwrap();
        let mut tank = Tank::new(&swimmer, Pose::identity())
            .unwrap()
            .with_spring(spring);
        tank.move_joints(Vector2::new(0.0, 1e-3));
        tank.follow(Vector2::new(0.0, 0.7), 3.0);
        let share = tank.phi().y / 1e-3;
        assert!((share - (-1.5_f64).exp()).abs() < 1e-6, "{share}");
        assert!(tank.phi().x.abs() < 1e-15);
    }

    /// A current adds its displacement, whatever the joints do.
    #[test]
    fn a_current_carries_the_swimmer() {
        let start = Pose::new(0.1, 0.0, 0.5);
        let still = Tank::new(&Swimmer::robot(), start).unwrap();
        let (mut flowing, mut still) = (still.clone().with_current([1e-3, -2e-3]), still);
        for (one, two) in [(0.4, 0.0), (0.4, 0.4), (0.0, 0.4), (0.0, 0.0), (0.0, 0.0)] {
            let servos = Vector2::new(one, two);
            flowing.follow(servos, 2.0);
            still.follow(servos, 2.0);
        }
        let off = flowing.pose().position() - still.pose().position();
        assert!((off - Vector2::new(0.01, -0.02)).norm() < 1e-12, "{off}");
        assert!((flowing.pose().theta - still.pose().theta).abs() < 1e-12);
    }

    #[test]
    fn nonsense_does_not_move_it() {
        let mut tank = Tank::new(&Swimmer::purcell(), Pose::identity()).unwrap();
        tank.move_joints(Vector2::new(f64::NAN, 0.0));
        assert!(tank.pose().x.abs() < 1e-300);
    }
}
