//! A curve cut into the elements that Newton's method starts from.

use nalgebra::{DVector, Vector2};

use super::super::arc::{self, Shape};
use super::super::chain::Layout;
use super::super::gauge::Facet;
use super::super::quadrature::cut;
use super::super::setting::Setting;
use super::{BENDS, Phase, begun, side};

/// A turn of the direction by 1 rad counts as much as this share of the period; it is looked at over so short a share.
const TURNS: f64 = 1.0 / 8.0;
const STEP: f64 = 1e-5;
/// A phase off the bounds is cut into this part of all elements at least.
const FREE: usize = 8;
/// Places on an element that a curve is fitted to.
const LOOKS: usize = 24;

/// A curve to start from: phases cut into elements.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub(super) phases: Vec<Phase>,
    pub(super) phase_of: Vec<usize>,
    /// Where in the period each element began, and its share; those of a phase keep their ratios.
    pub(super) spans: Vec<(f64, f64)>,
    pub(super) layout: Layout,
    pub(super) z: DVector<f64>,
}

impl Draft {
    /// Of about so many elements, or more where phases are many, the first bends of each fitted to a curve over the share of the period;
    /// where two limits leave no choice of the velocity, to what they leave.
    pub(super) fn new(
        setting: &Setting,
        (curve, period): (&dyn Fn(f64) -> Vector2<f64>, f64),
        phases: &[Phase],
        elements: usize,
        fitted: usize,
    ) -> Self {
        let mut phase_of = Vec::new();
        let mut spans = Vec::new();
        for (number, phase) in phases.iter().enumerate() {
            let way = |share: f64| curve(share + STEP) - curve(share - STEP);
            let rates = [elements as f64, elements as f64 * TURNS];
            let bound = phase.bound.is_some();
            let least = if bound { 1 } else { elements.div_ceil(FREE) };
            let parts = cut((phase.from, phase.to), way, (rates, least.max(phase.parts)));
            phase_of.extend(parts.iter().map(|_| number));
            spans.extend(parts.into_iter().map(|(from, to)| (from, to - from)));
        }
        let place = |&(from, length): &(f64, f64)| {
            let at = |k: usize| curve(from + length * k as f64 / LOOKS as f64);
            (0..=LOOKS).map(at).collect()
        };
        let mut places: Vec<Vec<Vector2<f64>>> = spans.iter().map(place).collect();
        let limits = |element: usize| {
            let phase: &Phase = &phases[phase_of[element]];
            (phase.limits.len() == 2 && phase.bound.is_none()).then_some(&phase.limits)
        };
        let elements: Vec<usize> = (0..spans.len()).collect();
        for run in elements.chunk_by(|one, other| limits(*one) == limits(*other)) {
            let way = |&element: &usize| (&phases[phase_of[element]], spans[element].1 * period);
            let way: Vec<(&Phase, f64)> = run.iter().map(way).collect();
            let places = &mut places[run[0]..run[0] + run.len()];
            if let Some(swept) = limits(run[0]).and_then(|_| swept(setting, &way, places)) {
                places.clone_from_slice(&swept);
            }
        }
        let corners: Vec<Vector2<f64>> = places.iter().map(|places| places[0]).collect();
        let time = |element: usize, _| spans[element].1 * period;
        let (layout, mut z) = Layout::of_corners(&corners, Shape::Free { bends: BENDS }, time);
        for (element, places) in places.iter().enumerate() {
            let [start, end] = layout.ends(&z, element);
            for joint in 0..2 {
                let off = |k: usize| {
                    let s = k as f64 / LOOKS as f64;
                    let straight = start + (end - start) * s;
                    (s, (places[k] - straight)[joint])
                };
                let off: Vec<(f64, f64)> = (1..LOOKS).map(off).collect();
                if let Some(bends) = arc::fitted(&off, fitted) {
                    let at = layout.bends_index(element) + BENDS * joint;
                    z.rows_mut(at, fitted).copy_from_slice(&bends);
                }
            }
        }
        Self {
            phases: phases.to_vec(),
            phase_of,
            spans,
            layout,
            z,
        }
    }

    pub(super) fn period(&self) -> f64 {
        self.layout.period(&self.z)
    }

    /// The elements of a phase.
    pub(super) fn elements_of(&self, number: usize) -> impl Iterator<Item = usize> {
        (0..self.layout.arcs()).filter(move |element| self.phase_of[*element] == number)
    }

    /// The time that a phase takes.
    pub(super) fn time_of(&self, number: usize) -> f64 {
        let elements = self.elements_of(number);
        elements.map(|k| self.z[self.layout.time_index(k)]).sum()
    }

    /// By how much of them the limits of a phase are missed between the nodes where they hold.
    pub(super) fn off_limits(&self, setting: &Setting, number: usize) -> f64 {
        let (layout, limits) = (&self.layout, setting.limits());
        let off = |(element, look): (usize, usize)| {
            let s = look as f64 / LOOKS as f64;
            let place = layout.place(&self.z, element, s);
            let power = setting.model.power_matrix(&place.phi);
            let time = self.z[layout.time_index(element)];
            let own = self.phases[number].limits.iter();
            own.map(|limit| (limits[*limit].value(&power, &place.rate) / time - 1.0).abs())
                .fold(0.0, f64::max)
        };
        self.elements_of(number)
            .flat_map(|element| (0..=LOOKS).map(move |look| (element, look)))
            .map(off)
            .fold(0.0, f64::max)
    }

    /// The same curve with other borders of its phases, told from this share of its period on.
    pub(super) fn cut(
        &self,
        setting: &Setting,
        (phases, from): (&[Phase], f64),
        elements: usize,
    ) -> Self {
        let curve = |share: f64| self.at(share + from);
        Self::new(setting, (&curve, self.period()), phases, elements, BENDS)
    }

    /// Its phases without one, from a border on that lies at this share of the period.
    pub(super) fn without(&self, phase: usize) -> Option<(Vec<Phase>, f64)> {
        let mut phases = self.phases.clone();
        let gone = phases.remove(phase);
        let count = phases.len();
        if count < 2 {
            return None;
        }
        match phases.get_mut(phase) {
            Some(next) => next.from = gone.from,
            None => phases[count - 1].to = gone.to,
        }
        let next = &mut phases[phase % count].touches;
        next.extend(gone.touches.into_iter().chain(gone.bound));
        next.sort_unstable();
        next.dedup();
        begun(phases)
    }

    /// The shape at a share of the period, modulo 1.
    pub(super) fn at(&self, share: f64) -> Vector2<f64> {
        self.layout.at(&self.z, share)
    }
}

/// Places on elements on which two limits leave no choice of the velocity, as it takes them from the first place on; what they miss
/// the last by is taken back evenly. None where the limits do not meet.
fn swept(
    setting: &Setting,
    way: &[(&Phase, f64)],
    places: &[Vec<Vector2<f64>>],
) -> Option<Vec<Vec<Vector2<f64>>>> {
    let mut phi = *places.first()?.first()?;
    let mut swept = Vec::new();
    for (phase, time) in way {
        let step = time / LOOKS as f64;
        let mut own = vec![phi];
        for _ in 0..LOOKS {
            let half = phi + velocity(setting, phase, &phi)? * (0.5 * step);
            phi += velocity(setting, phase, &half)? * step;
            own.push(phi);
        }
        swept.push(own);
    }
    let missed = phi - places.last()?.last()?;
    let whole: f64 = way.iter().map(|(_, time)| time).sum();
    let mut done = 0.0;
    for (own, (_, time)) in swept.iter_mut().zip(way) {
        for (k, place) in own.iter_mut().enumerate() {
            *place -= missed * ((done + time * k as f64 / LOOKS as f64) / whole);
        }
        done += time;
    }
    Some(swept)
}

/// The velocity that two limits leave at a shape, on a phase's side of where they touch.
fn velocity(setting: &Setting, phase: &Phase, phi: &Vector2<f64>) -> Option<Vector2<f64>> {
    let &[one, two] = phase.limits.as_slice() else {
        return None;
    };
    let limits = setting.limits();
    let power = setting.model.power_matrix(phi);
    let normal = |limit: usize| {
        let along = |joint: usize| limits[limit].value(&power, &Vector2::ith(joint, 1.0));
        Vector2::new(along(0), along(1))
    };
    let meets = match (limits[one], limits[two]) {
        (Facet::Flat { .. }, Facet::Flat { .. }) => {
            let [a, b] = [one, two].map(normal);
            vec![Vector2::new(b.y - a.y, a.x - b.x) / a.perp(&b)]
        }
        (Facet::Flat { .. }, Facet::Power { power: most })
        | (Facet::Power { power: most }, Facet::Flat { .. }) => {
            let round = matches!(limits[one], Facet::Power { .. });
            let flat = normal(if round { two } else { one });
            let from = flat / flat.norm_squared();
            let along = Vector2::new(-flat.y, flat.x);
            let square = along.dot(&(power * along));
            let mixed = from.dot(&(power * along));
            let rest = from.dot(&(power * from)) - most;
            let root = (mixed * mixed - square * rest).sqrt();
            let meet = |sign: f64| from + along * ((sign * root - mixed) / square);
            vec![meet(1.0), meet(-1.0)]
        }
        _ => return None,
    };
    meets.into_iter().find(|rate| {
        rate.norm().is_finite() && side(setting, &phase.limits, phi, rate) == phase.side
    })
}
