//! The bound that keeps the side links apart, with a clearance δ ≥ 0 between their centre lines.
//!
//! Two segments that do not cross are nearest at an end of one of them. The ends at the joints bound one angle alone, so
//! they are straight edges ([`Clearance::fold`]); the tips give the curved bound: the front tip above the back link, tip to
//! tip, and the back tip above the front link, in this order round each of the two forbidden zones (both angles positive,
//! both negative). At δ = 0 the middle piece shrinks to a corner of the zone, on φ₁ = φ₂ = arccos(−l₀/2l₁) for side links
//! that are alike; for δ > 0 the bound is smooth.

use nalgebra::{Matrix2, Vector2};
use swimmer_model::Links;

impl Level {
    /// Unit vector along the curve of equal margin, with the larger margin on the left.
    pub(crate) fn tangent(&self) -> Vector2<f64> {
        Vector2::new(self.gradient.y, -self.gradient.x) / self.gradient.norm()
    }
}

/// What is nearest to what, or crosses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Piece {
    /// The tip of the front link, to the inside of the back link.
    FrontTip,
    /// The tip of the back link, to the inside of the front link.
    BackTip,
    /// Tip to tip.
    Tips,
    /// The tip of the front link, to the joint of the back link: only φ₁ counts.
    FrontTipToJoint,
    /// The tip of the back link, to the joint of the front link: only φ₂ counts.
    BackTipToJoint,
}

/// The margin with its first and second derivatives in Φ.
#[derive(Debug, Clone, Copy)]
pub struct Level {
    /// The margin, in rad or over L; positive inside.
    pub value: f64,
    /// ∂/∂Φ.
    pub gradient: Vector2<f64>,
    /// ∂²/∂Φ².
    pub hessian: Matrix2<f64>,
}

/// The bound. Lengths are in the unit of the links that it was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    links: Links<f64>,
    distance: f64,
}

impl Clearance {
    /// The curved bound for a clearance `distance` ≥ 0 below l₀; none where the tips can never come that near.
    pub(crate) fn new(links: &Links<f64>, distance: f64) -> Option<Self> {
        (links.front + links.back > links.middle - distance).then_some(Self {
            links: *links,
            distance,
        })
    }

    /// The largest |φ| \[rad\] at which a link of length `side` stays `distance` away from the joint of the other side
    /// link, `middle` away, and a hair off the middle link: flat on it they cross.
    pub(crate) fn fold(side: f64, middle: f64, distance: f64) -> f64 {
        use std::f64::consts::PI;
        const HAIR: f64 = 1e-6;
        let free = if side * side >= middle * middle - distance * distance {
            PI - (distance / middle).clamp(0.0, 1.0).asin()
        } else if side > middle - distance {
            let cos = (distance * distance - middle * middle - side * side) / (2.0 * middle * side);
            cos.clamp(-1.0, 1.0).acos()
        } else {
            PI
        };
        free.min(PI - HAIR)
    }

    /// Which piece decides at a shape.
    pub(crate) fn piece(&self, phi: &Vector2<f64>) -> Piece {
        if self.links.overlap(phi) > 0.0 {
            // Crossing: out by the tip that has the shorter way.
            let (front, back) = (self.front_height(phi), self.back_height(phi));
            return if front > back {
                Piece::FrontTip
            } else {
                Piece::BackTip
            };
        }
        let (front, back) = (self.front_tip_piece(phi), self.back_tip_piece(phi));
        if self.reach(front, phi) <= self.reach(back, phi) {
            front
        } else {
            back
        }
    }

    /// Distance of the tips from the other side link, less the clearance: positive inside, negative where they are too near
    /// or cross. Continuous within |φᵢ| < π.
    pub(crate) fn margin(&self, phi: &Vector2<f64>) -> f64 {
        if self.links.overlap(phi) > 0.0 {
            return self.front_height(phi).max(self.back_height(phi)) - self.distance;
        }
        self.reach(self.front_tip_piece(phi), phi)
            .min(self.reach(self.back_tip_piece(phi), phi))
            - self.distance
    }

    /// The margin with its derivatives, from the piece that decides.
    pub(crate) fn deciding_level(&self, phi: &Vector2<f64>) -> Level {
        let mut level = self.level(self.piece(phi), phi);
        if self.links.overlap(phi) <= 0.0 && level.value + self.distance < 0.0 {
            // Not crossing, and beyond the other link's line: the distance to it grows on the other side.
            level = Level {
                value: -level.value - 2.0 * self.distance,
                gradient: -level.gradient,
                hessian: -level.hessian,
            };
        }
        level
    }

    /// The margin that a piece alone gives, with derivatives, as a smooth function also where another piece decides.
    pub(crate) fn level(&self, piece: Piece, phi: &Vector2<f64>) -> Level {
        let Links {
            middle,
            front,
            back,
        } = self.links;
        let mut level = match piece {
            Piece::FrontTip => self.height_level(phi, front, [0, 1]),
            Piece::BackTip => self.height_level(phi, back, [1, 0]),
            Piece::Tips => {
                let (sin, cos) = (phi.map(f64::sin), phi.map(f64::cos));
                let (sin12, cos12) = (phi.x + phi.y).sin_cos();
                let (a, b, c) = (middle * front, middle * back, front * back);
                let gradient = -Vector2::new(a * sin.x + c * sin12, b * sin.y + c * sin12);
                let hessian = -Matrix2::new(
                    a * cos.x + c * cos12,
                    c * cos12,
                    c * cos12,
                    b * cos.y + c * cos12,
                );
                root_level(self.tips(phi), gradient, hessian)
            }
            Piece::FrontTipToJoint => self.joint_level(phi, front, 0),
            Piece::BackTipToJoint => self.joint_level(phi, back, 1),
        };
        level.value -= self.distance;
        level
    }

    /// What is left to the end of a piece where the next tip takes over, with its slope in Φ: positive on the piece. None
    /// for a tip at a joint, which ends elsewhere.
    pub(crate) fn piece_end(
        &self,
        piece: Piece,
        phi: &Vector2<f64>,
    ) -> Option<(f64, Vector2<f64>)> {
        let sum = phi.x + phi.y;
        // Where the foot of a tip passes the other tip.
        let over = |joint: usize, own: f64, other: f64| {
            let value = self.links.middle * phi[joint].cos() + own * sum.cos() + other;
            let mut slope = Vector2::repeat(-own * sum.sin());
            slope[joint] -= self.links.middle * phi[joint].sin();
            (value, slope)
        };
        match piece {
            Piece::FrontTip => Some(over(1, self.links.front, self.links.back)),
            Piece::BackTip => Some(over(0, self.links.back, self.links.front)),
            Piece::Tips => {
                let front = over(1, self.links.front, self.links.back);
                let back = over(0, self.links.back, self.links.front);
                let nearer = if front.0 > back.0 { front } else { back };
                Some((-nearer.0, -nearer.1))
            }
            Piece::FrontTipToJoint | Piece::BackTipToJoint => None,
        }
    }

    /// The shape φ₁ = φ₂ > 0 on the bound, where the side links are alike \[rad\].
    pub(crate) fn on_diagonal(&self) -> Option<f64> {
        let cos = (self.distance - self.links.middle) / (self.links.front + self.links.back);
        (self.links.front.to_bits() == self.links.back.to_bits() && cos.abs() < 1.0)
            .then(|| cos.acos())
    }

    /// Whether the bound has no extent between the tips: a corner instead of an arc.
    pub(crate) fn has_corner(&self) -> bool {
        self.distance <= 0.0
    }

    fn side(phi: &Vector2<f64>) -> f64 {
        if phi.x + phi.y < 0.0 { -1.0 } else { 1.0 }
    }

    /// The front tip's height over the line of the back link; positive on the side of the front joint.
    fn front_height(&self, phi: &Vector2<f64>) -> f64 {
        Self::side(phi)
            * (self.links.middle * phi.y.sin() + self.links.front * (phi.x + phi.y).sin())
    }

    fn back_height(&self, phi: &Vector2<f64>) -> f64 {
        Self::side(phi)
            * (self.links.middle * phi.x.sin() + self.links.back * (phi.x + phi.y).sin())
    }

    /// Where the front tip's foot on the line of the back link lies, from the back joint.
    fn front_foot(&self, phi: &Vector2<f64>) -> f64 {
        -self.links.middle * phi.y.cos() - self.links.front * (phi.x + phi.y).cos()
    }

    fn back_foot(&self, phi: &Vector2<f64>) -> f64 {
        -self.links.middle * phi.x.cos() - self.links.back * (phi.x + phi.y).cos()
    }

    fn front_tip_piece(&self, phi: &Vector2<f64>) -> Piece {
        let foot = self.front_foot(phi);
        if foot < 0.0 {
            Piece::FrontTipToJoint
        } else if foot > self.links.back {
            Piece::Tips
        } else {
            Piece::FrontTip
        }
    }

    fn back_tip_piece(&self, phi: &Vector2<f64>) -> Piece {
        let foot = self.back_foot(phi);
        if foot < 0.0 {
            Piece::BackTipToJoint
        } else if foot > self.links.front {
            Piece::Tips
        } else {
            Piece::BackTip
        }
    }

    /// The distance that a piece stands for.
    fn reach(&self, piece: Piece, phi: &Vector2<f64>) -> f64 {
        match piece {
            Piece::FrontTip => self.front_height(phi).abs(),
            Piece::BackTip => self.back_height(phi).abs(),
            Piece::Tips => self.tips(phi),
            Piece::FrontTipToJoint => self.tip_to_joint(self.links.front, phi.x),
            Piece::BackTipToJoint => self.tip_to_joint(self.links.back, phi.y),
        }
    }

    fn tips(&self, phi: &Vector2<f64>) -> f64 {
        let along =
            self.links.middle + self.links.front * phi.x.cos() + self.links.back * phi.y.cos();
        along.hypot(self.links.front * phi.x.sin() - self.links.back * phi.y.sin())
    }

    fn tip_to_joint(&self, side: f64, angle: f64) -> f64 {
        (self.links.middle + side * angle.cos()).hypot(side * angle.sin())
    }

    /// l₀ sin φ + l sin(φ₁ + φ₂) with φ of the other joint, positive on the inside.
    fn height_level(&self, phi: &Vector2<f64>, side: f64, [own, other]: [usize; 2]) -> Level {
        let sign = Self::side(phi);
        let (sin12, cos12) = (phi.x + phi.y).sin_cos();
        let (sin, cos) = phi[other].sin_cos();
        let (both, alone) = (sign * side, sign * self.links.middle);
        let mut gradient = Vector2::zeros();
        gradient[own] = both * cos12;
        gradient[other] = both * cos12 + alone * cos;
        let mut hessian = Matrix2::repeat(-both * sin12);
        hessian[(other, other)] -= alone * sin;
        Level {
            value: both * sin12 + alone * sin,
            gradient,
            hessian,
        }
    }

    fn joint_level(&self, phi: &Vector2<f64>, side: f64, joint: usize) -> Level {
        let (sin, cos) = phi[joint].sin_cos();
        let product = self.links.middle * side;
        let (mut gradient, mut hessian) = (Vector2::zeros(), Matrix2::zeros());
        gradient[joint] = -product * sin;
        hessian[(joint, joint)] = -product * cos;
        root_level(self.tip_to_joint(side, phi[joint]), gradient, hessian)
    }
}

/// A distance whose square over two has these derivatives.
fn root_level(value: f64, gradient: Vector2<f64>, hessian: Matrix2<f64>) -> Level {
    // Where the ends meet the distance is a cone: no direction, no curvature.
    let away = value.max(1e-12);
    let gradient = gradient / away;
    Level {
        value,
        gradient,
        hessian: hessian / away - gradient * gradient.transpose() / away,
    }
}
