//! Equations of extremals of Lighthill's efficiency, reduced by position and heading, with their exact linearisation.
//!
//! Along the power length s (∫√P, so Φ runs at constant power), with e = (cos ψ, sin ψ), n = (−sin ψ, cos ψ), g = eᵀWe:
//!
//! ```text
//! Φ'  = e/√g
//! ψ'  = h g/det W + (J W e)·K/(√g det W),   K_i = ½ eᵀ∂ᵢW e − (∂_e W e)_i,   h = μ·F
//! μ'  = (μ_y ω, −μ_x ω, μ_x ξ_y − μ_y ξ_x),  (ξ_x, ξ_y, ω) = A Φ'
//! q'  = μ_x ξ_x + μ_y ξ_y
//! ```
//!
//! They are equivalent to `W ∇_t t = h J t`: the curve is a geodesic of the metric W in a magnetic field, the height h, which
//! follows from the curvature F of the connection and the body momentum μ. For a gait with displacement d and length S that
//! extremises ln |d| − ln S the momentum dual to the displacement is p = d S/|d|², so that ∮q' = p·d = S. The paper's costates are
//! λ₄ = `μ_θ` and `λ₁,₂ = WΦ' − Aᵀμ`, up to a common factor. The equations are regular on the symmetry lines.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use swimmer_model::Model;

use crate::region::Bound;

/// State: φ₁, φ₂, direction ψ, body momentum `μ_x`, `μ_y`, `μ_θ`.
pub(crate) type State = [f64; STATE];
/// Number of entries of a [`State`].
pub(crate) const STATE: usize = 6;
/// Number of rates: those of the state and of q.
pub(crate) const RATES: usize = STATE + 1;

/// Kind of an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// Free extremal.
    Free,
    /// Arc along a bound of the joint angles; the direction stays tangent to it.
    Along(Bound),
}

/// Rates of the state and of q with their derivatives with respect to the state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Linear {
    pub(crate) rate: [f64; RATES],
    pub(crate) by_state: [[f64; STATE]; RATES],
}

/// Joint angles of a state.
pub(crate) fn shape(z: &State) -> Vector2<f64> {
    Vector2::new(z[0], z[1])
}

/// Body momentum of a state.
pub(crate) fn momentum(z: &State) -> Vector3<f64> {
    Vector3::new(z[3], z[4], z[5])
}

/// J v: rotation by 90° counter-clockwise.
fn turned(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

fn det(w: &Matrix2<f64>) -> f64 {
    w.m11 * w.m22 - w.m12 * w.m12
}

/// Bilinear form μ × ξ of the coadjoint equation.
fn coadjoint(mu: &Vector3<f64>, body: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(mu.y * body.z, -mu.x * body.z, mu.x * body.y - mu.y * body.x)
}

/// Parts of the turning rate ψ' of a free extremal: `plain + gain·h`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turning {
    /// ψ' of a geodesic of W without the field.
    pub(crate) plain: f64,
    /// g/det W.
    pub(crate) gain: f64,
    /// F, so that h = μ·F.
    pub(crate) curvature: Vector3<f64>,
    /// √g.
    pub(crate) speed: f64,
    /// A.
    pub(crate) connection: Matrix3x2<f64>,
}

impl Turning {
    /// Evaluates the parts at a shape and direction.
    pub(crate) fn at(model: &Model<f64>, phi: &Vector2<f64>, psi: f64) -> Self {
        let d = model.first_derivatives(phi);
        let (sin, cos) = psi.sin_cos();
        let e = Vector2::new(cos, sin);
        let we = d.power * e;
        let g = e.dot(&we);
        let along = d.d_power.map(|w| w * e);
        let bend = along[0] * e.x + along[1] * e.y;
        let k = Vector2::new(0.5 * e.dot(&along[0]), 0.5 * e.dot(&along[1])) - bend;
        let area = det(&d.power);
        Self {
            plain: turned(&we).dot(&k) / (g.sqrt() * area),
            gain: g / area,
            curvature: d.curvature(),
            speed: g.sqrt(),
            connection: d.connection,
        }
    }
}

/// Returns the rates of state and q.
pub(crate) fn rate(model: &Model<f64>, motion: &Motion, z: &State) -> [f64; RATES] {
    let (phi, mu) = (shape(z), momentum(z));
    let (sin, cos) = z[2].sin_cos();
    let e = Vector2::new(cos, sin);
    let (connection, turn, sigma) = match motion {
        Motion::Free => {
            let local = Turning::at(model, &phi, z[2]);
            let turn = local.plain + local.gain * mu.dot(&local.curvature);
            (local.connection, turn, local.speed.recip())
        }
        Motion::Along(wall) => {
            let (connection, power) = model.connection_and_power(&phi);
            let sigma = e.dot(&(power * e)).sqrt().recip();
            (connection, sigma * wall.turning(&phi, &e), sigma)
        }
    };
    assemble(&connection, &mu, &e, turn, sigma)
}

fn assemble(
    connection: &Matrix3x2<f64>,
    mu: &Vector3<f64>,
    e: &Vector2<f64>,
    turn: f64,
    sigma: f64,
) -> [f64; RATES] {
    let v = e * sigma;
    let body = connection * v;
    let push = coadjoint(mu, &body);
    let gain = mu.x * body.x + mu.y * body.y;
    [v.x, v.y, turn, push.x, push.y, push.z, gain]
}

/// Returns the rates with their derivatives, for the variational equations.
pub(crate) fn linear(model: &Model<f64>, motion: &Motion, z: &State) -> Linear {
    let (phi, mu) = (shape(z), momentum(z));
    let (sin, cos) = z[2].sin_cos();
    let (e, n) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
    let second = model.second_derivatives(&phi);
    let first = &second.first;
    let we = first.power * e;
    let g = e.dot(&we);
    let sigma = g.sqrt().recip();
    let along = first.d_power.map(|w| w * e);
    let g_by = [e.dot(&along[0]), e.dot(&along[1]), 2.0 * n.dot(&we)];
    let sigma_by = g_by.map(|slope| -0.5 * sigma * sigma * sigma * slope);

    let (turn, turn_by) = match motion {
        Motion::Free => free_turning(&second, &mu, &e, &n),
        Motion::Along(wall) => {
            let (bend, by) = wall.turning_and_slopes(&phi, &e);
            let mut slopes = [0.0; STATE];
            for (slope, (b, s)) in slopes.iter_mut().zip(by.iter().zip(&sigma_by)) {
                *slope = sigma * b + s * bend;
            }
            (sigma * bend, slopes)
        }
    };

    let v = e * sigma;
    let v_by = [
        e * sigma_by[0],
        e * sigma_by[1],
        e * sigma_by[2] + n * sigma,
    ];
    let a = &first.connection;
    let body = a * v;
    let body_by = [
        first.d_connection[0] * v + a * v_by[0],
        first.d_connection[1] * v + a * v_by[1],
        a * v_by[2],
    ];
    let mut by_state = [[0.0; STATE]; RATES];
    for column in 0..3 {
        let push = coadjoint(&mu, &body_by[column]);
        by_state[0][column] = v_by[column].x;
        by_state[1][column] = v_by[column].y;
        by_state[3][column] = push.x;
        by_state[4][column] = push.y;
        by_state[5][column] = push.z;
        by_state[6][column] = mu.x * body_by[column].x + mu.y * body_by[column].y;
    }
    by_state[2] = turn_by;
    by_state[3][4] = body.z;
    by_state[4][3] = -body.z;
    by_state[5][3] = body.y;
    by_state[5][4] = -body.x;
    by_state[6][3] = body.x;
    by_state[6][4] = body.y;
    Linear {
        rate: assemble(a, &mu, &e, turn, sigma),
        by_state,
    }
}

/// Returns ψ' of a free extremal and its derivatives with respect to the state.
fn free_turning(
    second: &swimmer_model::SecondDerivatives<f64>,
    mu: &Vector3<f64>,
    e: &Vector2<f64>,
    n: &Vector2<f64>,
) -> (f64, [f64; STATE]) {
    let first = &second.first;
    let w = &first.power;
    let [w1, w2] = &first.d_power;
    let (we, wn) = (w * e, w * n);
    let g = e.dot(&we);
    let (area, sigma) = (det(w), g.sqrt().recip());
    let along = [w1 * e, w2 * e];
    let across = [w1 * n, w2 * n];
    let k = Vector2::new(0.5 * e.dot(&along[0]), 0.5 * e.dot(&along[1]))
        - (along[0] * e.x + along[1] * e.y);
    let jwe = turned(&we);
    let bend = jwe.dot(&k);
    let curvature = first.curvature();
    let height = mu.dot(&curvature);
    let turn = (height * g + sigma * bend) / area;

    let [w11, w12, w22] = second.d2_power.map(|w| w * e);
    let curved = [[w11, w12], [w12, w22]];
    let d_curvature = second.d_curvature();
    let mut slopes = [0.0; STATE];
    for joint in 0..2 {
        let g_by = e.dot(&along[joint]);
        let dw = &first.d_power[joint];
        let area_by = w.m22 * dw.m11 + w.m11 * dw.m22 - 2.0 * w.m12 * dw.m12;
        let [one, two] = &curved[joint];
        let k_by = Vector2::new(0.5 * e.dot(one), 0.5 * e.dot(two)) - (one * e.x + two * e.y);
        let bend_by = turned(&along[joint]).dot(&k) + jwe.dot(&k_by);
        let sigma_by = -0.5 * sigma * sigma * sigma * g_by;
        slopes[joint] =
            (mu.dot(&d_curvature[joint]) * g + height * g_by + sigma_by * bend + sigma * bend_by
                - turn * area_by)
                / area;
    }
    let g_by = 2.0 * n.dot(&we);
    let k_by = Vector2::new(n.dot(&along[0]), n.dot(&along[1]))
        - (along[0] * n.x + along[1] * n.y)
        - (across[0] * e.x + across[1] * e.y);
    let bend_by = turned(&wn).dot(&k) + jwe.dot(&k_by);
    let sigma_by = -0.5 * sigma * sigma * sigma * g_by;
    slopes[2] = (height * g_by + sigma_by * bend + sigma * bend_by) / area;
    for (slope, part) in slopes.iter_mut().skip(3).zip(curvature.iter()) {
        *slope = part * g / area;
    }
    (turn, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::{Clearance, Edge, Piece};
    use swimmer_files::ArcKind;
    use swimmer_model::Swimmer;

    fn cases() -> Vec<(Model<f64>, State)> {
        vec![
            (
                Model::new(&Swimmer::<f64>::purcell()).unwrap(),
                [0.7, -1.3, 2.1, 3.0, -1.2, 0.4],
            ),
            (
                Model::new(&Swimmer::<f64>::robot()).unwrap(),
                [-2.4, 1.1, -0.6, -12.0, 5.0, 1.7],
            ),
        ]
    }

    #[test]
    fn the_linearisation_is_the_derivative_of_the_rates() {
        for (model, z) in cases() {
            let links = &model.swimmer().links;
            let straight = Bound::Straight(Edge {
                normal: Vector2::new(0.6, 0.8),
                offset: 1.0,
                kind: ArcKind::Upper,
            });
            let clearance = Clearance::new(links, 0.01).unwrap();
            let curved = Bound::Clearance(clearance.held_to(Piece::Tip(0)));
            for motion in [Motion::Free, Motion::Along(straight), Motion::Along(curved)] {
                let exact = linear(&model, &motion, &z);
                let plain = rate(&model, &motion, &z);
                for (a, b) in exact.rate.iter().zip(&plain) {
                    assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
                }
                for column in 0..STATE {
                    let h = 1e-5;
                    let shifted = |by: f64| {
                        let mut moved = z;
                        moved[column] += by;
                        rate(&model, &motion, &moved)
                    };
                    let (up, down) = (shifted(h), shifted(-h));
                    for row in 0..RATES {
                        let numeric = (up[row] - down[row]) / (2.0 * h);
                        let found = exact.by_state[row][column];
                        assert!(
                            (numeric - found).abs() < 1e-7 * (1.0 + found.abs()),
                            "{row} {column}: {numeric} {found}"
                        );
                    }
                }
            }
        }
    }
}
