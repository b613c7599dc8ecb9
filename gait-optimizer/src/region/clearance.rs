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

/// Pair of features that decides the clearance. A tip is 0 on the front link and 1 on the back link, as the angles φ₁ and φ₂.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Piece {
    /// The tip of one side link, to the inside of the other.
    Tip(usize),
    /// Tip to tip.
    Tips,
    /// The tip of one side link, to the joint of the other: only its own angle counts.
    TipToJoint(usize),
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
    /// The piece that it is held to, a smooth curve also where another one decides; none for all of them.
    pub(crate) held: Option<Piece>,
}

impl Clearance {
    /// The curved bound for a clearance `distance` ≥ 0 below l₀. Returns `None` if the tips cannot come that near.
    pub(crate) fn new(links: &Links<f64>, distance: f64) -> Option<Self> {
        (links.front + links.back > links.middle - distance).then_some(Self {
            links: *links,
            distance,
            held: None,
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

    /// Held to this piece.
    pub(crate) fn held_to(self, piece: Piece) -> Self {
        Self {
            held: Some(piece),
            ..self
        }
    }

    /// Deciding piece at a shape.
    pub(crate) fn piece(&self, phi: &Vector2<f64>) -> Piece {
        if let Some(held) = self.held {
            return held;
        }
        if self.links.overlap(phi) > 0.0 {
            // Crossing: out by the tip that has the shorter way.
            let [front, back] = [0, 1].map(|tip| self.height(phi, tip));
            return Piece::Tip(usize::from(front <= back));
        }
        let [front, back] = self.tip_pieces(phi);
        if self.reach(front, phi) <= self.reach(back, phi) {
            front
        } else {
            back
        }
    }

    /// Distance of the tips from the other side link, less the clearance: positive inside, negative where they are too near
    /// or cross. Continuous within |φᵢ| < π.
    pub(crate) fn margin(&self, phi: &Vector2<f64>) -> f64 {
        let apart = if self.links.overlap(phi) > 0.0 {
            let [front, back] = [0, 1].map(|tip| self.height(phi, tip));
            front.max(back)
        } else {
            let [front, back] = self.tip_pieces(phi).map(|piece| self.reach(piece, phi));
            front.min(back)
        };
        apart - self.distance
    }

    /// The margin with its derivatives, from the piece that decides.
    pub(crate) fn deciding_level(&self, phi: &Vector2<f64>) -> Level {
        let mut level = self.level(self.piece(phi), phi);
        let crosses = || self.links.overlap(phi) > 0.0;
        if self.held.is_none() && level.value + self.distance < 0.0 && !crosses() {
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
            Piece::Tip(tip) => self.height_level(phi, tip),
            Piece::TipToJoint(tip) => self.joint_level(phi, tip),
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
        };
        level.value -= self.distance;
        level
    }

    /// Margin to the end of a piece, where the next tip takes over, with its slope in Φ: positive on the piece. `None` for a tip
    /// at a joint, which ends elsewhere.
    pub(crate) fn piece_end(
        &self,
        piece: Piece,
        phi: &Vector2<f64>,
    ) -> Option<(f64, Vector2<f64>)> {
        // Where the foot of a tip passes the other tip.
        let over = |tip: usize| {
            let mut slope = Vector2::repeat(-self.side(tip) * phi.sum().sin());
            slope[1 - tip] -= self.links.middle * phi[1 - tip].sin();
            (self.side(1 - tip) - self.foot(phi, tip), slope)
        };
        match piece {
            Piece::Tip(tip) => Some(over(tip)),
            Piece::Tips => {
                let (front, back) = (over(0), over(1));
                let nearer = if front.0 > back.0 { front } else { back };
                Some((-nearer.0, -nearer.1))
            }
            Piece::TipToJoint(_) => None,
        }
    }

    /// The shape φ₁ = φ₂ > 0 on the bound \[rad\]. Returns `None` for unequal side links.
    pub(crate) fn on_diagonal(&self) -> Option<f64> {
        let cos = (self.distance - self.links.middle) / (self.links.front + self.links.back);
        (self.links.front.to_bits() == self.links.back.to_bits() && cos.abs() < 1.0)
            .then(|| cos.acos())
    }

    /// `true` if the bound has no extent between the tips: a corner instead of an arc.
    pub(crate) fn has_corner(&self) -> bool {
        self.distance <= 0.0
    }

    /// Piece that follows a tip towards the corner of the zone: the other tip, if they meet there.
    pub(crate) fn after_tip(&self, tip: usize) -> Piece {
        if self.has_corner() {
            Piece::Tip(1 - tip)
        } else {
            Piece::Tips
        }
    }

    /// The length of a side link.
    fn side(&self, link: usize) -> f64 {
        [self.links.front, self.links.back][link]
    }

    /// Height of a tip over the line of the other link; positive on the side of its own joint.
    fn height(&self, phi: &Vector2<f64>, tip: usize) -> f64 {
        let [both, alone] = [self.side(tip), self.links.middle].map(|length| zone(phi) * length);
        both * phi.sum().sin() + alone * phi[1 - tip].sin()
    }

    /// Distance of the foot of a tip on the line of the other link from that link's joint.
    fn foot(&self, phi: &Vector2<f64>, tip: usize) -> f64 {
        -self.links.middle * phi[1 - tip].cos() - self.side(tip) * phi.sum().cos()
    }

    /// Feature of the other link that is nearest to each tip.
    fn tip_pieces(&self, phi: &Vector2<f64>) -> [Piece; 2] {
        [0, 1].map(|tip| {
            let foot = self.foot(phi, tip);
            if foot < 0.0 {
                Piece::TipToJoint(tip)
            } else if foot > self.side(1 - tip) {
                Piece::Tips
            } else {
                Piece::Tip(tip)
            }
        })
    }

    /// The distance that a piece stands for.
    fn reach(&self, piece: Piece, phi: &Vector2<f64>) -> f64 {
        match piece {
            Piece::Tip(tip) => self.height(phi, tip).abs(),
            Piece::Tips => self.tips(phi),
            Piece::TipToJoint(tip) => self.tip_to_joint(phi, tip),
        }
    }

    fn tips(&self, phi: &Vector2<f64>) -> f64 {
        let along =
            self.links.middle + self.links.front * phi.x.cos() + self.links.back * phi.y.cos();
        along.hypot(self.links.front * phi.x.sin() - self.links.back * phi.y.sin())
    }

    fn tip_to_joint(&self, phi: &Vector2<f64>, tip: usize) -> f64 {
        let (sin, cos) = phi[tip].sin_cos();
        (self.links.middle + self.side(tip) * cos).hypot(self.side(tip) * sin)
    }

    /// The height of a tip with its derivatives.
    fn height_level(&self, phi: &Vector2<f64>, tip: usize) -> Level {
        let other = 1 - tip;
        let (sin12, cos12) = phi.sum().sin_cos();
        let (sin, cos) = phi[other].sin_cos();
        let [both, alone] = [self.side(tip), self.links.middle].map(|length| zone(phi) * length);
        let mut gradient = Vector2::repeat(both * cos12);
        gradient[other] += alone * cos;
        let mut hessian = Matrix2::repeat(-both * sin12);
        hessian[(other, other)] -= alone * sin;
        Level {
            value: self.height(phi, tip),
            gradient,
            hessian,
        }
    }

    fn joint_level(&self, phi: &Vector2<f64>, tip: usize) -> Level {
        let (sin, cos) = phi[tip].sin_cos();
        let product = self.links.middle * self.side(tip);
        let (mut gradient, mut hessian) = (Vector2::zeros(), Matrix2::zeros());
        gradient[tip] = -product * sin;
        hessian[(tip, tip)] = -product * cos;
        root_level(self.tip_to_joint(phi, tip), gradient, hessian)
    }
}

/// The corner of the forbidden shapes at φ₁, φ₂ > 0 where the tips of the side links meet: the three links are the sides
/// of a triangle.
pub(super) fn tips_meet(links: &Links<f64>) -> Option<Vector2<f64>> {
    let middle = links.middle;
    let outer = |own: f64, other: f64| {
        ((other * other - middle * middle - own * own) / (2.0 * middle * own)).acos()
    };
    let (front, back) = (links.front, links.back);
    let corner = Vector2::new(outer(front, back), outer(back, front));
    let is_one = corner.iter().all(|angle| angle.is_finite());
    is_one.then_some(corner)
}

/// The nearer of the two forbidden zones: 1 for positive angles.
fn zone(phi: &Vector2<f64>) -> f64 {
    if phi.sum() < 0.0 { -1.0 } else { 1.0 }
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
