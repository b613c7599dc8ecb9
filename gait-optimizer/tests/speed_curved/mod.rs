//! An independent direct method for the fastest gait within any limits: a closed curve of cubic elements, run everywhere as fast as its
//! limits let it.
//!
//! ln T − ln |d| falls by Newton's method over all control points, with differences of each element; the largest of the limits is a
//! p-norm, ever sharper, and the rotation vanishes by an augmented Lagrangian. From the model it takes A(Φ) and W(Φ) alone; nothing
//! is known of phases, costates or symmetry. Elements may slide along the curve, and do, until they end where what binds changes: a slight
//! price on uneven ones is all that holds them.

mod element;

use gait_optimizer::LimitedProblem;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use swimmer_model::Model;

use crate::plane::Pose;
use element::{Element, Gauge, Limits, POINTS, Points, TOLD, Varied};

/// Gauss steps of an element: while it is climbed, and of what can be swum.
const STEPS: usize = 4;
const FINE_STEPS: usize = 64;
/// Of the rotation beside its multiplier.
const PRICE: f64 = 300.0;
/// The p of the norm, from stage to stage.
const FIRST: f64 = 8.0;
const SHARPER: f64 = 1.5;
const LAST: f64 = 5e5;
/// From this p on a curve that is slower than this share of a known one stays so.
const CLEAR: f64 = 60.0;
const HOPELESS: f64 = 0.95;
/// Of uneven elements in the first stage; the sharper the norm, the less, down to the last.
const UNEVEN: f64 = 1e-3;
const LEAST_UNEVEN: f64 = 1e-7;
/// Steps of the first stage, and of each other.
const STEPS_OF_FIRST: usize = 60;
const STEPS_OF_STAGE: usize = 40;
/// A stage ends with a step that gains less.
const SETTLED: f64 = 1e-10;
/// Longest step \[rad\].
const LONGEST: f64 = 0.5;
const LEAST_DAMPING: f64 = 1e-8;
const MOST_DAMPING: f64 = 1e6;

pub(crate) struct Curved {
    limits: Limits,
    max_angle: f64,
    elements: usize,
    /// Of each element the coordinates of the first three control points, kept within the bounds: then so is the curve.
    z: DVector<f64>,
    /// Multiplier of the rotation.
    lambda: f64,
    p: f64,
    uneven: f64,
}

impl Curved {
    /// From a closed curve of angles, drawn into the bounds.
    pub(crate) fn new(
        problem: &LimitedProblem,
        elements: usize,
        curve: impl Fn(f64) -> Vector2<f64>,
    ) -> Self {
        let max_angle = problem.bounds.max_angle.unwrap_or(f64::INFINITY);
        let points = (0..3 * elements).flat_map(|k| {
            let phi = curve(std::f64::consts::TAU * k as f64 / (3 * elements) as f64);
            <[f64; 2]>::from(phi.map(|angle| angle.clamp(-max_angle, max_angle)))
        });
        let model = Model::new(&problem.swimmer.of_unit_length()).unwrap();
        Self {
            limits: Limits {
                model,
                gauges: gauges(problem),
            },
            max_angle,
            elements,
            z: DVector::from_iterator(6 * elements, points),
            lambda: 0.0,
            p: FIRST,
            uneven: UNEVEN,
        }
    }

    fn at(&self, element: usize, point: usize) -> usize {
        (6 * element + point) % (6 * self.elements)
    }

    fn points<'z>(&self, z: &'z DVector<f64>) -> impl Iterator<Item = Points> + use<'z, '_> {
        (0..self.elements).map(|k| Points::from_fn(|p, _| z[self.at(k, p)]))
    }

    fn elements(&self, z: &DVector<f64>, steps: usize) -> Vec<Element> {
        let points = self.points(z);
        points
            .map(|points| self.limits.element(&points, steps))
            .collect()
    }

    /// |d|/T of what was climbed to, with the largest of the limits itself and the little that it still turns at its price.
    pub(crate) fn swimmable(&self) -> f64 {
        let elements = self.elements(&self.z, FINE_STEPS);
        let whole = whole(&elements);
        let period: f64 = elements.iter().map(Element::time).sum();
        whole.x.hypot(whole.y) / period * (-self.lambda * whole.theta).exp()
    }

    /// Descends, ever sharper; |d|/(L T) of the curve. What is clearly slower than a known one is left.
    pub(crate) fn climb(&mut self, known: f64) -> f64 {
        while self.p < LAST && (self.p < CLEAR || self.swimmable() > HOPELESS * known) {
            self.uneven = (UNEVEN * FIRST / self.p).max(LEAST_UNEVEN);
            self.settle();
            self.lambda += PRICE * whole(&self.elements(&self.z, STEPS)).theta;
            self.p *= SHARPER;
        }
        self.swimmable()
    }

    /// What falls.
    fn worth(&self, z: &DVector<f64>) -> f64 {
        let elements = self.elements(z, STEPS);
        let Pose { x, y, theta } = whole(&elements);
        let period: f64 = elements.iter().map(|one| one.smooth_time(self.p)).sum();
        let squares: f64 = elements.iter().map(Element::squares).sum();
        period.ln() - x.hypot(y).ln()
            + self.lambda * theta
            + 0.5 * PRICE * theta.powi(2)
            + self.uneven * self.elements as f64 * squares
    }

    /// Its gradient and Hessian.
    fn slopes(&self) -> (DVector<f64>, DMatrix<f64>) {
        let all = self.points(&self.z);
        let all = all.map(|points| self.limits.slopes(&points, STEPS, self.p));
        let all: Vec<Varied> = all.collect();
        let (outer, outer_curved) = self.by_told(&all);
        let (count, size) = (TOLD * self.elements, self.z.len());
        let mut jacobian = DMatrix::<f64>::zeros(count, size);
        let mut curved = DMatrix::<f64>::zeros(size, size);
        for (k, one) in all.iter().enumerate() {
            for i in 0..POINTS {
                for m in 0..TOLD {
                    jacobian[(TOLD * k + m, self.at(k, i))] += one.slopes[(m, i)];
                    for j in 0..POINTS {
                        let by = outer[TOLD * k + m] * one.curved[m][(i, j)];
                        curved[(self.at(k, i), self.at(k, j))] += by;
                    }
                }
            }
        }
        curved += jacobian.transpose() * outer_curved * &jacobian;
        (jacobian.transpose() * outer, curved)
    }

    /// Gradient and Hessian by what the elements tell.
    fn by_told(&self, all: &[Varied]) -> (DVector<f64>, DMatrix<f64>) {
        let count = TOLD * self.elements;
        let mut begun = vec![Pose::default()];
        for one in all {
            begun.push(begun[begun.len() - 1] * one.pose);
        }
        let end = begun[self.elements];
        let d = Vector2::new(end.x, end.y);
        let period: f64 = all.iter().map(|one| one.told[3]).sum();
        let by_d = -d / d.norm_squared();
        let by_d_twice = by_d * by_d.transpose() * 2.0 - Matrix2::identity() / d.norm_squared();
        let quarter_turn = Matrix2::new(0.0, -1.0, 1.0, 0.0);
        // What follows an element turns with it.
        let after = |k: usize| d - Vector2::new(begun[k + 1].x, begun[k + 1].y);
        let mut d_slopes = DMatrix::<f64>::zeros(2, count);
        let mut rotation = DVector::<f64>::zeros(count);
        let mut time = DVector::<f64>::zeros(count);
        let mut curved = DMatrix::<f64>::zeros(count, count);
        for k in 0..self.elements {
            let (sin, cos) = begun[k].theta.sin_cos();
            let turned = Matrix2::new(cos, -sin, sin, cos);
            d_slopes
                .fixed_view_mut::<2, 2>(0, TOLD * k)
                .copy_from(&turned);
            d_slopes.set_column(TOLD * k + 2, &(quarter_turn * after(k)));
            rotation[TOLD * k + 2] = 1.0;
            time[TOLD * k + 3] = 1.0;
            let across = (quarter_turn * turned).transpose() * by_d;
            for l in 0..self.elements {
                curved[(TOLD * k + 2, TOLD * l + 2)] = -by_d.dot(&after(k.max(l)));
                for m in (0..2).filter(|_| l < k) {
                    curved[(TOLD * k + m, TOLD * l + 2)] = across[m];
                    curved[(TOLD * l + 2, TOLD * k + m)] = across[m];
                }
            }
        }
        curved += d_slopes.transpose() * by_d_twice * &d_slopes;
        curved += &rotation * rotation.transpose() * PRICE;
        curved -= &time * time.transpose() / period.powi(2);
        let mut slopes = d_slopes.transpose() * by_d;
        slopes += rotation * (self.lambda + PRICE * end.theta) + time / period;
        for k in 0..self.elements {
            slopes[TOLD * k + 4] = self.uneven * self.elements as f64;
        }
        (slopes, curved)
    }

    /// Damped Newton steps, with each curvature as if it were positive; control points that a bound holds stay on it.
    fn settle(&mut self) {
        let most = if self.p > FIRST {
            STEPS_OF_STAGE
        } else {
            STEPS_OF_FIRST
        };
        let mut damping = 1e-4;
        for _ in 0..most {
            let (gradient, curved) = self.slopes();
            let held =
                |at: usize| self.z[at].abs() >= self.max_angle && self.z[at] * gradient[at] < 0.0;
            let free: Vec<usize> = (0..self.z.len()).filter(|&at| !held(at)).collect();
            let eigen = curved
                .select_rows(&free)
                .select_columns(&free)
                .symmetric_eigen();
            let along = eigen.eigenvectors.transpose() * gradient.select_rows(&free);
            let here = self.worth(&self.z);
            let gained = loop {
                let values = eigen.eigenvalues.map(|value| value.abs() + damping);
                let step = &eigen.eigenvectors * along.component_div(&values);
                let mut there = self.z.clone();
                for (at, by) in free.iter().zip(&step) {
                    there[*at] = (there[*at] - by).clamp(-self.max_angle, self.max_angle);
                }
                let gained = here - self.worth(&there);
                if step.amax() < LONGEST && gained > 0.0 {
                    self.z = there;
                    damping = (0.2 * damping).max(LEAST_DAMPING);
                    break gained;
                }
                damping *= 4.0;
                if damping > MOST_DAMPING {
                    break 0.0;
                }
            };
            if gained < SETTLED {
                return;
            }
        }
    }
}

fn whole(elements: &[Element]) -> Pose {
    let poses = elements.iter().map(|element| element.pose);
    poses.fold(Pose::default(), |pose, next| pose * next)
}

/// The least time for a turn of the joints at a shape, of the swimmer of length 1.
pub(crate) fn least_time(
    problem: &LimitedProblem,
    model: &Model<f64>,
    phi: &Vector2<f64>,
    turn: &Vector2<f64>,
) -> f64 {
    let power = model.connection_and_power(phi).1;
    let gauges = gauges(problem).into_iter();
    gauges.map(|gauge| gauge(&power, turn)).fold(0.0, f64::max)
}

/// One for each limit, over the swimmer of length 1.
fn gauges(problem: &LimitedProblem) -> Vec<Gauge> {
    let volume = problem.swimmer.total_length().powi(3);
    let mut gauges: Vec<Gauge> = Vec::new();
    if let Some(power) = problem.power_over_viscosity {
        gauges.push(Box::new(move |w, v| {
            (v.dot(&(w * v)) * volume / power).sqrt()
        }));
    }
    for joint in 0..2 {
        if let Some(rates) = problem.rates {
            gauges.push(Box::new(move |_, v| v[joint].abs() / rates[joint]));
        }
        if let Some(torque) = problem.torque {
            gauges.push(Box::new(move |w, v| {
                (w * v)[joint].abs() * volume / torque.stall_over_viscosity
                    + v[joint].abs() / torque.no_load_rate
            }));
        }
    }
    gauges
}
