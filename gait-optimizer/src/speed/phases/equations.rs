//! What holds on each element and between them.

use nalgebra::{Matrix4, Vector2, Vector4};

use super::super::arc::{MOST_PARAMETERS, Place};
use super::super::gauge::{Facet, Level};
use super::super::quadrature::Rule;
use super::super::setting::Setting;
use super::{BENDS, Draft, Phase};

/// One equation.
#[derive(Debug, Clone, Copy)]
pub(super) enum Equation {
    /// A limit binds at a node: time − G.
    Limit {
        element: usize,
        node: usize,
        limit: usize,
    },
    /// A bound holds at an inner node.
    Along {
        element: usize,
        node: usize,
        bound: usize,
    },
    /// A bound holds a corner.
    Corner { element: usize, bound: usize },
    /// An element takes as long as the next, but for the ratio that both were cut with.
    Even { element: usize },
    /// Where the power alone limits, the velocity is continuous: a limit that begins or ends to bind there is met at this end of
    /// an element, and a bound touched. The speed depends on where by third order only, so this stands in for stationarity along
    /// the curve there, and its multiplier, a force on that corner, vanishes.
    Meets {
        element: usize,
        s: f64,
        limit: usize,
    },
    /// The same of a bound.
    Tangent {
        element: usize,
        s: f64,
        bound: usize,
    },
}

impl Equation {
    /// The end of an element at which it stands in for stationarity.
    pub(super) fn stands_in_at(&self) -> Option<(usize, f64)> {
        match *self {
            Self::Meets { element, s, .. } | Self::Tangent { element, s, .. } => Some((element, s)),
            _ => None,
        }
    }
}

pub(super) fn equations(setting: &Setting, draft: &Draft) -> Vec<Equation> {
    let mut all = Vec::new();
    let limits = setting.limits();
    let elements = draft.phase_of.len();
    for (element, &number) in draft.phase_of.iter().enumerate() {
        let phase = &draft.phases[number];
        let before = draft.phase_of[(element + elements - 1) % elements];
        for node in 0..=BENDS {
            let of = |&limit| Equation::Limit {
                element,
                node,
                limit,
            };
            all.extend(phase.limits.iter().map(of));
        }
        let mut held: Vec<usize> = phase.bound.into_iter().collect();
        held.extend(draft.phases[before].bound);
        if before != number {
            held.extend(&phase.touches);
            let earlier = ((element + elements - 1) % elements, 1.0);
            let before = &draft.phases[before];
            all.extend(smoothly(&limits, (before, phase), earlier));
            all.extend(smoothly(&limits, (phase, before), (element, 0.0)));
        }
        held.sort_unstable();
        held.dedup();
        let corner = |bound| Equation::Corner { element, bound };
        all.extend(held.into_iter().map(corner));
        if let Some(bound) = phase.bound {
            let along = |node| Equation::Along {
                element,
                node,
                bound,
            };
            all.extend((0..BENDS).map(along));
        }
        if draft.phase_of.get(element + 1) == Some(&number) {
            all.push(Equation::Even { element });
        }
    }
    all
}

/// What holds at the end of an element whose phase the power alone limits, where another phase borders on it.
fn smoothly(
    limits: &[Facet],
    (phase, other): (&Phase, &Phase),
    (element, s): (usize, f64),
) -> Vec<Equation> {
    let &[own] = phase.limits.as_slice() else {
        return Vec::new();
    };
    let round = matches!(limits[own], Facet::Power { .. });
    if !round || phase.bound.is_some() || !other.limits.contains(&own) {
        return Vec::new();
    }
    if let Some(bound) = other.bound {
        return vec![Equation::Tangent { element, s, bound }];
    }
    let more = other.limits.iter().filter(|limit| **limit != own);
    let meets = |&limit| Equation::Meets { element, s, limit };
    more.map(meets).collect()
}

/// A draft with all that is asked of it.
pub(super) struct Method<'a> {
    pub(super) setting: &'a Setting<'a>,
    pub(super) draft: Draft,
    pub(super) limits: Vec<Facet>,
    /// Where limits bind, and where bounds do.
    pub(super) nodes: Rule,
    pub(super) inner: Rule,
    pub(super) path: Rule,
    pub(super) equations: Vec<Equation>,
}

impl Method<'_> {
    /// Where an equation is looked at, and what it says there of shape and rate; none for what is of times alone.
    pub(super) fn level(
        &self,
        equation: &Equation,
    ) -> Option<(usize, Place<MOST_PARAMETERS>, Level)> {
        let (element, s) = match *equation {
            Equation::Limit { element, node, .. } => (element, self.nodes.nodes[node]),
            Equation::Along { element, node, .. } => (element, self.inner.nodes[node]),
            Equation::Corner { element, .. } | Equation::Even { element } => (element, 0.0),
            Equation::Meets { element, s, .. } | Equation::Tangent { element, s, .. } => {
                (element, s)
            }
        };
        let place = self.place(element, s);
        let level = match *equation {
            Equation::Limit { limit, .. } | Equation::Meets { limit, .. } => {
                let time = self.draft.z[self.draft.layout.time_index(element)];
                self.limit_level(limit, &place, time)
            }
            Equation::Along { bound, .. } | Equation::Corner { bound, .. } => {
                self.bound_level(bound, &place.phi)
            }
            Equation::Tangent { bound, .. } => {
                let margin = self.bound_level(bound, &place.phi);
                let rate = Vector4::new(place.rate.x, place.rate.y, 0.0, 0.0);
                let mut slope = margin.curved * rate;
                slope[2] = margin.slope[0];
                slope[3] = margin.slope[1];
                Level {
                    value: margin.slope.dot(&rate),
                    slope,
                    curved: Matrix4::zeros(),
                }
            }
            Equation::Even { .. } => return None,
        };
        Some((element, place, level))
    }

    /// Time less what a limit takes.
    fn limit_level(&self, limit: usize, place: &Place<MOST_PARAMETERS>, time: f64) -> Level {
        let second = self.setting.model.second_derivatives(&place.phi);
        let of = self.limits[limit].level(&second, &place.rate);
        Level {
            value: time - of.value,
            slope: -of.slope,
            curved: -of.curved,
        }
    }

    fn bound_level(&self, bound: usize, phi: &Vector2<f64>) -> Level {
        let Some(bound) = self.setting.region.bound(bound) else {
            return Level::default();
        };
        let level = bound.level(phi);
        let mut curved = Matrix4::zeros();
        curved
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&level.hessian);
        Level {
            value: level.value,
            slope: Vector4::new(level.gradient.x, level.gradient.y, 0.0, 0.0),
            curved,
        }
    }
}
