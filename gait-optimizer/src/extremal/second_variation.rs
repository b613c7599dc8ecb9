//! The second-order test: along how many directions does an extremal's efficiency grow to second order?
//!
//! The curve is pushed sideways by ν(s), zero along bounds (where the multiplier is positive, staying there is of first
//! order) and at corners. With H(Φ, u, θ) = μ·A u − √(uᵀWu), μ turning with θ and `μ_θ` held, the second variation of
//! p·d + cΔθ − S is ∫ D²H over (δΦ, δu, δθ) with δθ carried along by `δθ' = δ(A_θ u)`; heights downstream change with the
//! heading, so it is no local form. Of ln |d| − ln S, times S, it lacks S (δd_⊥/|d|)², the gain from turning d aside, and on a
//! closed curve δθ must vanish at the end. On quarters both drop out. ν is piecewise linear, so the count is a bound from
//! below that settles as the mesh gets finer.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{DMatrix, DVector, Vector2, Vector3};
use swimmer_model::Model;

use super::equations::{Motion, State, Turning, momentum, shape};
use super::flow::flowed;
use super::shooting::{Chain, Class, Entry, Stretch};

/// Elements of the whole mesh, about.
const ELEMENTS: f64 = 160.0;

/// One element of the mesh: the state in its middle, its length, and its two nodes (none where the curve is held).
struct Element {
    state: State,
    length: f64,
    nodes: [Option<usize>; 2],
}

/// The elements of the free arcs and of the bounds, and the number of nodes.
struct Mesh {
    elements: Vec<Element>,
    nodes: usize,
}

/// Of a chain in about so many elements.
fn mesh(model: &Model<f64>, class: Class, chain: &Chain, most: f64) -> Option<Mesh> {
    let total = chain.length();
    let quarter = class == Class::Quarter;
    let last = chain.arcs.len().checked_sub(1)?;
    let smooth = |arc: &Stretch| matches!(arc.entry, Entry::Smooth);
    let whole_round = last == 0 && !quarter && chain.arcs.iter().all(smooth);
    let (mut elements, mut count) = (Vec::new(), 0);
    let mut new_node = || {
        count += 1;
        Some(count - 1)
    };
    let mut states = chain.states.iter();
    for (index, arc) in chain.arcs.iter().enumerate() {
        let free = matches!(arc.motion, Motion::Free);
        let share = arc.length / arc.pieces as f64;
        let parts = (1..400_usize)
            .find(|&n| n as f64 * total >= most * share)
            .unwrap_or(400);
        let length = share / parts as f64;
        // Nodes at ends are free at a symmetry line and on a closed curve without contact, held elsewhere.
        let opens = whole_round || quarter && index == 0 && smooth(arc);
        let mut previous = if free && opens { new_node() } else { None };
        for piece in 1..=arc.pieces {
            let mut middle = flowed(model, &arc.motion, states.next()?, 0.5 * length)?.0;
            for part in 1..=parts {
                if part > 1 {
                    middle = flowed(model, &arc.motion, &middle, length)?.0;
                }
                let ends = piece == arc.pieces && part == parts;
                let next = match ends {
                    _ if !free => None,
                    true if whole_round => Some(0),
                    true if !(quarter && index == last) => None,
                    _ => new_node(),
                };
                elements.push(Element {
                    state: middle,
                    length,
                    nodes: [previous, next],
                });
                previous = next;
            }
        }
    }
    Some(Mesh {
        elements,
        nodes: count,
    })
}

impl Mesh {
    /// The mesh of a quarter with its three images: every second one is run backwards.
    fn unfolded(&self) -> Self {
        let ends = [
            self.elements.first().and_then(|first| first.nodes[0]),
            self.elements.last().and_then(|last| last.nodes[1]),
        ];
        let (mut elements, mut nodes) = (Vec::with_capacity(4 * self.elements.len()), 0);
        // Nodes on the symmetry lines are shared: φ₁ = φ₂ > 0, φ₁ = −φ₂ < 0, and opposite.
        let mut on_lines = [None; 4];
        for quarter in 0..4 {
            let backwards = quarter % 2 == 1;
            let mut inside = vec![None; self.nodes];
            let mut image = |node: usize| {
                let known = match ends.iter().position(|end| *end == Some(node)) {
                    Some(end) => {
                        &mut on_lines[(quarter + usize::from((end == 1) != backwards)) % 4]
                    }
                    None => &mut inside[node],
                };
                *known.get_or_insert_with(|| {
                    nodes += 1;
                    nodes - 1
                })
            };
            for at in 0..self.elements.len() {
                let at = if backwards {
                    self.elements.len() - 1 - at
                } else {
                    at
                };
                let element = &self.elements[at];
                let mut own = element.nodes;
                if backwards {
                    own.reverse();
                }
                elements.push(Element {
                    state: reflected(&element.state, quarter),
                    length: element.length,
                    nodes: own.map(|node| node.map(&mut image)),
                });
            }
        }
        Self { elements, nodes }
    }
}

/// The state of a quarter's image in another quarter: shapes reflected in the lines φ₁ = ±φ₂, the momentum as its body is.
fn reflected([phi1, phi2, psi, x, y, theta]: &State, quarter: usize) -> State {
    match quarter {
        1 => [-phi2, -phi1, FRAC_PI_2 - psi, *x, *y, -theta],
        2 => [-phi1, -phi2, psi + PI, *x, -y, -theta],
        3 => [*phi2, *phi1, -FRAC_PI_2 - psi, *x, -y, *theta],
        _ => [*phi1, *phi2, *psi, *x, *y, *theta],
    }
}

/// How many directions raise the efficiency to second order; none where the arcs cannot be followed.
pub(crate) fn ascent_directions(model: &Model<f64>, class: Class, chain: &Chain) -> Option<usize> {
    let mesh = mesh(model, class, chain, ELEMENTS)?;
    let closed = matches!(class, Class::Closed { .. });
    ascents_of(model, &mesh, chain, closed)
}

/// The same of a quarter's whole cycle among closed curves of any symmetry.
pub(crate) fn ascents_without_symmetry(model: &Model<f64>, quarter: &Chain) -> Option<usize> {
    let mesh = mesh(model, Class::Quarter, quarter, 0.25 * ELEMENTS)?;
    ascents_of(model, &mesh.unfolded(), quarter, true)
}

fn ascents_of(model: &Model<f64>, mesh: &Mesh, chain: &Chain, closed: bool) -> Option<usize> {
    let Mesh { elements, nodes } = mesh;
    let count = *nodes;
    if count == 0 {
        return Some(0);
    }
    let mut form = DMatrix::zeros(count, count);
    // δθ and δ of the displacement, as functions of the nodes.
    let mut turned = DVector::zeros(count);
    let mut aside = DVector::zeros(count);
    let first = momentum(chain.states.first()?);
    let p = Vector2::new(first.x, first.y);
    let (mut theta, mut gone) = (0.0_f64, Vector2::zeros());
    let locals = elements.iter().map(|one| Local::new(model, &one.state));
    let locals: Vec<Local> = locals.collect();
    let gain = |local: &Local, length: f64| {
        0.5 * length * (local.momentum.x * local.body.x + local.momentum.y * local.body.y)
    };
    let gains = locals.iter().zip(elements);
    let mut ahead: f64 = gains.map(|(local, one)| gain(local, one.length)).sum();
    for (local, element) in locals.iter().zip(elements) {
        let length = element.length;
        let here = gain(local, length);
        ahead -= here;
        let nodes: Vec<(usize, Node)> = element
            .weights()
            .map(|(node, (value, slope))| (node, local.by_node(value, slope)))
            .collect();
        // δθ in the middle, from what came before and half of this element.
        let before = turned.clone();
        let mut middle = turned.clone();
        for (node, by) in &nodes {
            middle[*node] += 0.5 * length * by.heading;
            turned[*node] += length * by.heading;
        }
        for (i, a) in &nodes {
            // −½ μ_xy·ξ δθ², of here and of all that lies ahead.
            let turn = length * a.heading;
            for (j, b) in &nodes {
                let both = turn * length * b.heading * (ahead + 0.25 * here);
                form[(*i, *j)] += length * local.pair(a, b) - both;
            }
            // 2 δθ μ_xy·J δξ, made symmetric.
            let cross = 0.5 * length * local.turned_momentum(&a.body);
            let turn = turn * (ahead + 0.5 * here);
            for (node, (middle, before)) in middle.iter().zip(before.iter()).enumerate() {
                let part = cross * middle - turn * before;
                form[(*i, node)] += part;
                form[(node, *i)] += part;
            }
        }
        // The lateral displacement that follows: along p turned by a quarter.
        let body = Vector2::new(local.body.x, local.body.y);
        let heading = theta + 0.5 * length * local.body.z;
        let (sin, cos) = heading.sin_cos();
        let out = Vector2::new(cos * body.x - sin * body.y, sin * body.x + cos * body.y);
        let across = Vector2::new(-p.y, p.x) / p.norm();
        for (node, by) in &nodes {
            let moved = Vector2::new(
                cos * by.body.x - sin * by.body.y,
                sin * by.body.x + cos * by.body.y,
            );
            aside[*node] += length * across.dot(&moved);
        }
        aside.axpy(
            length * across.dot(&Vector2::new(-out.y, out.x)),
            &middle,
            1.0,
        );
        theta += length * local.body.z;
        gone += out * length;
    }
    if closed {
        // S (δd_⊥/|d|)²; the forms here are halves of second derivatives.
        let length: f64 = elements.iter().map(|element| element.length).sum();
        let weight = 0.5 * length / gone.norm_squared();
        form.ger(weight, &aside, &aside, 1.0);
        return Some(positive(&on_kernel(form, &turned)));
    }
    Some(positive(&form))
}

/// How many eigenvalues are positive, to rounding.
fn positive(form: &DMatrix<f64>) -> usize {
    // None at a maximum, which a factorisation shows sooner than the eigenvalues do.
    if (-form).cholesky().is_some() {
        return 0;
    }
    let eigenvalues = form.clone().symmetric_eigenvalues();
    let scale = eigenvalues.amax();
    eigenvalues
        .iter()
        .filter(|&&value| value > 1e-12 * scale)
        .count()
}

/// A form where a linear function vanishes: reflected so that the function is the last coordinate, which is dropped.
fn on_kernel(form: DMatrix<f64>, function: &DVector<f64>) -> DMatrix<f64> {
    let size = form.nrows();
    let norm = function.norm();
    if size < 2 || norm <= 0.0 {
        return form;
    }
    let last = size - 1;
    let mut axis = function / norm;
    axis[last] += if axis[last] < 0.0 { -1.0 } else { 1.0 };
    axis /= axis.norm();
    let reflect = |form: DMatrix<f64>| {
        let mut out = form;
        let row = axis.transpose() * &out;
        out.ger(-2.0, &axis, &row.transpose(), 1.0);
        out
    };
    let once = reflect(form);
    let twice = reflect(once.transpose());
    twice.view((0, 0), (last, last)).into_owned()
}

impl Element {
    /// Weight and slope of every free node in the middle of the element.
    fn weights(&self) -> impl Iterator<Item = (usize, (f64, f64))> {
        let slopes = [-1.0 / self.length, 1.0 / self.length];
        self.nodes
            .into_iter()
            .zip(slopes)
            .filter_map(|(node, slope)| Some((node?, (0.5, slope))))
    }
}

/// What one node's push does in the middle of an element.
struct Node {
    value: f64,
    shape: Vector2<f64>,
    speed: Vector2<f64>,
    body: Vector3<f64>,
    heading: f64,
    /// First variation of the power.
    power: f64,
}

/// Everything at the middle of an element.
struct Local {
    second: swimmer_model::SecondDerivatives<f64>,
    momentum: Vector3<f64>,
    control: Vector2<f64>,
    body: Vector3<f64>,
    normal: Vector2<f64>,
    /// dn/ds.
    normal_rate: Vector2<f64>,
}

impl Local {
    fn new(model: &Model<f64>, state: &State) -> Self {
        let second = model.second_derivatives(&shape(state));
        let momentum = momentum(state);
        let turning = Turning::of(&second.first, state[2]);
        let (sin, cos) = state[2].sin_cos();
        let control = Vector2::new(cos, sin) / turning.speed;
        let bend = turning.plain + turning.gain * momentum.dot(&turning.curvature);
        Self {
            body: second.first.connection * control,
            second,
            momentum,
            control,
            normal: Vector2::new(-sin, cos),
            normal_rate: Vector2::new(cos, sin) * -bend,
        }
    }

    fn by_node(&self, value: f64, slope: f64) -> Node {
        let first = &self.second.first;
        let shape = self.normal * value;
        let speed = self.normal * slope + self.normal_rate * value;
        let bent = first.d_connection[0] * shape.x + first.d_connection[1] * shape.y;
        let heavier = first.d_power[0] * shape.x + first.d_power[1] * shape.y;
        let body = bent * self.control + first.connection * speed;
        Node {
            value,
            shape,
            speed,
            heading: body.z,
            body,
            power: 2.0 * speed.dot(&(first.power * self.control))
                + self.control.dot(&(heavier * self.control)),
        }
    }

    /// `μ_xy·J ξ`.
    fn turned_momentum(&self, body: &Vector3<f64>) -> f64 {
        self.momentum.y * body.x - self.momentum.x * body.y
    }

    /// The local part of half the second variation, for two nodes.
    fn pair(&self, a: &Node, b: &Node) -> f64 {
        let (first, u) = (&self.second.first, &self.control);
        let [a11, a12, a22] = &self.second.d2_connection;
        let [w11, w12, w22] = &self.second.d2_power;
        let n = &self.normal;
        let both = a.value * b.value;
        let (xx, xy, yy) = (n.x * n.x, 2.0 * n.x * n.y, n.y * n.y);
        let bent = (a11 * u) * xx + (a12 * u) * xy + (a22 * u) * yy;
        let heavier = u.dot(&(w11 * u)) * xx + u.dot(&(w12 * u)) * xy + u.dot(&(w22 * u)) * yy;
        let moved = |a: &Node, b: &Node| {
            let connection = first.d_connection[0] * a.shape.x + first.d_connection[1] * a.shape.y;
            let power = first.d_power[0] * a.shape.x + first.d_power[1] * a.shape.y;
            0.5 * self.momentum.dot(&(connection * b.speed)) - 0.5 * b.speed.dot(&(power * u))
        };
        0.5 * both * self.momentum.dot(&bent) + moved(a, b) + moved(b, a)
            - 0.5 * (a.speed.dot(&(first.power * b.speed)) + 0.5 * both * heavier)
            + 0.125 * a.power * b.power
    }
}
