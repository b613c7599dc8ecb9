//! Walls of the laboratory's tank: the image of every force on the fluid in each wall, by the three-dimensional tensor of Blake (1971)
//! in index notation. It shares no code with the calibration.

use super::body::Body;

/// Pieces of a link.
const PIECES: usize = 6;

/// Part of the body: place, and force on the fluid per (ẋ, ẏ, θ̇, φ̇₁, φ̇₂), in units of 2πμ.
struct Part {
    at: [f64; 2],
    force: [[f64; 5]; 2],
}

fn parts(body: &Body, phi: [f64; 2]) -> Vec<Part> {
    let mut out = vec![Part {
        at: [0.0; 2],
        force: [
            [3.0 * body.sphere, 0.0, 0.0, 0.0, 0.0],
            [0.0, 3.0 * body.sphere, 0.0, 0.0, 0.0],
        ],
    }];
    let half = body.middle / 2.0;
    let links = [
        (body.middle, 0.0, -half, [0.0, 0.0]),
        (body.front, phi[0], half, [1.0, 0.0]),
        (body.back, std::f64::consts::PI - phi[1], -half, [0.0, -1.0]),
    ];
    for (length, direction, hinge, share) in links {
        let (sin, cos) = direction.sin_cos();
        let piece = length / PIECES as f64;
        for index in 0..PIECES {
            let arm = (index as f64 + 0.5) * piece;
            let at = [hinge + arm * cos, arm * sin];
            // Along and across the link: the middle link's motion, then the joints'.
            let along = [cos, sin, at[0] * sin - at[1] * cos, 0.0, 0.0];
            let across = [
                -sin,
                cos,
                at[0] * cos + at[1] * sin,
                arm * share[0],
                arm * share[1],
            ];
            let (tangential, normal) = (body.c_t * piece, body.c_t * body.chi * piece);
            out.push(Part {
                at,
                force: [
                    std::array::from_fn(|k| tangential * along[k] * cos - normal * across[k] * sin),
                    std::array::from_fn(|k| tangential * along[k] * sin + normal * across[k] * cos),
                ],
            });
        }
    }
    out
}

/// Image of a Stokeslet above the plane z = 0, times 8πμ: velocity at `x` by a force at `y`.
pub(crate) fn blake(x: [f64; 3], y: [f64; 3]) -> [[f64; 3]; 3] {
    let h = y[2];
    let r = [x[0] - y[0], x[1] - y[1], x[2] + h];
    let square: f64 = r.iter().map(|value| value * value).sum();
    let (r1, r3, r5) = (square.powf(-0.5), square.powf(-1.5), square.powf(-2.5));
    let delta = |i: usize, j: usize| f64::from(u8::from(i == j));
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let source = h * (delta(i, j) * r3 - 3.0 * r[i] * r[j] * r5);
            let stokes = -delta(i, 2) * r[j] * r3 + (delta(i, j) * r[2] + r[i] * delta(j, 2)) * r3
                - 3.0 * r[i] * r[2] * r[j] * r5;
            let sign = if j == 2 { -1.0 } else { 1.0 };
            -(delta(i, j) * r1 + r[i] * r[j] * r3) + 2.0 * h * sign * (source - stokes)
        })
    })
}

/// By how much walls of a box about the origin change the resistance at a pose, in units of 2πμ.
pub(crate) fn change(body: &Body, phi: [f64; 2], pose: [f64; 3], size: [f64; 2]) -> [[f64; 5]; 5] {
    let parts = parts(body, phi);
    let (sin, cos) = pose[2].sin_cos();
    let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let mut sum = [[0.0; 5]; 5];
    for (axis, side) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        // Along the wall, vertical, and from the wall into the fluid.
        let placed: Vec<([f64; 3], [[f64; 5]; 2])> = parts
            .iter()
            .map(|part| {
                let offset = turned(part.at);
                let at = [pose[0] + offset[0], pose[1] + offset[1]];
                let height = size[axis] / 2.0 - side * at[axis];
                assert!(height > 0.0, "a part of the body is in the wall");
                let columns: Vec<[f64; 2]> = (0..5)
                    .map(|k| turned([part.force[0][k], part.force[1][k]]))
                    .collect();
                let force = [
                    std::array::from_fn(|k| columns[k][1 - axis]),
                    std::array::from_fn(|k| -side * columns[k][axis]),
                ];
                ([at[1 - axis], 0.0, height], force)
            })
            .collect();
        for (x, here) in &placed {
            for (y, there) in &placed {
                let image = blake(*x, *y);
                let image = [[image[0][0], image[0][2]], [image[2][0], image[2][2]]];
                for (m, row) in sum.iter_mut().enumerate() {
                    for (n, entry) in row.iter_mut().enumerate() {
                        for i in 0..2 {
                            for j in 0..2 {
                                *entry -= here[i][m] * image[i][j] * there[j][n] / 4.0;
                            }
                        }
                    }
                }
            }
        }
    }
    sum
}
