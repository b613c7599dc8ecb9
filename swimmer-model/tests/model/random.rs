//! Random swimmers and shapes: every form of c_t, with and without a sphere, links of any ratio and size.

use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use swimmer_model::{Harmonic, Link, Links, Medium, Swimmer, TangentialDrag};

/// A property is tried on this many random cases, the same in every run; `PROPTEST_RNG_SEED` chooses others.
pub(crate) fn cases(cases: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    let rng_seed = match given.rng_seed {
        RngSeed::Random => RngSeed::Fixed(1977),
        chosen @ RngSeed::Fixed(_) => chosen,
    };
    // Failures are printed with their inputs; no file is written next to the sources.
    ProptestConfig {
        cases,
        rng_seed,
        failure_persistence: None,
        ..given
    }
}

fn ratio() -> impl Strategy<Value = f64> {
    (-1.2..1.2).prop_map(f64::exp)
}

fn tangential_drag(shortest: f64) -> impl Strategy<Value = TangentialDrag<f64>> {
    prop_oneof![
        (1.0..8.0).prop_map(TangentialDrag::LogAspect),
        (0.002..0.4).prop_map(move |part| TangentialDrag::HalfThickness(part * shortest)),
        (0.2..8.0).prop_map(TangentialDrag::OverViscosity),
    ]
}

fn swimmer_with(links: impl Strategy<Value = Links<f64>>) -> impl Strategy<Value = Swimmer<f64>> {
    links.prop_flat_map(|links| {
        let drag = tangential_drag(links.middle.min(links.front).min(links.back));
        let sphere = prop_oneof![
            Just(0.0),
            (0.05..1.5).prop_map(move |part| part * links.middle)
        ];
        (0.7..5.0, drag, sphere).prop_map(move |(chi, tangential_drag, sphere_radius)| Swimmer {
            links,
            chi,
            tangential_drag,
            sphere_radius,
            ..Swimmer::purcell()
        })
    })
}

/// Any swimmer, from millimetres to tens of metres.
pub(crate) fn swimmer() -> impl Strategy<Value = Swimmer<f64>> {
    let links = (-5.0..3.0, ratio(), ratio()).prop_map(|(log_size, front, back)| {
        let middle = f64::exp(log_size);
        Links {
            middle,
            front: middle * front,
            back: middle * back,
        }
    });
    swimmer_with(links)
}

/// Any swimmer of any kind with a positive definite W: drag coefficients of its own for each link, the sphere on any link, or a
/// perfect fluid.
pub(crate) fn any_swimmer() -> impl Strategy<Value = Swimmer<f64>> {
    let own = || (0.4..8.0, 0.4..8.0, 0.4..8.0);
    let on = prop_oneof![Just(Link::Middle), Just(Link::Front), Just(Link::Back)];
    let aspect = prop_oneof![0.02..1.0, Just(1.0)];
    (swimmer(), 0..4, own(), own(), on, (aspect, 1e-2..1e4)).prop_map(
        |(swimmer, kind, (_, front, back), (c0, c1, c2), sphere_on, (aspect, density))| {
            let own_chi = Swimmer {
                side_chi: Some([front, back]),
                sphere_on,
                ..swimmer
            };
            let own_drag = TangentialDrag::PerLink(Links {
                middle: c0,
                front: c1,
                back: c2,
            });
            match kind {
                0 => swimmer,
                1 => own_chi,
                2 => Swimmer {
                    tangential_drag: own_drag,
                    ..own_chi
                },
                _ => Swimmer {
                    sphere_radius: 0.0,
                    medium: Medium::Perfect { aspect, density },
                    ..swimmer
                },
            }
        },
    )
}

/// A swimmer with equal side links.
pub(crate) fn symmetric_swimmer() -> impl Strategy<Value = Swimmer<f64>> {
    let links = (-5.0..3.0, ratio()).prop_map(|(log_size, side)| {
        let middle = f64::exp(log_size);
        Links {
            middle,
            front: middle * side,
            back: middle * side,
        }
    });
    swimmer_with(links)
}

/// Any shape, a little beyond one full turn of each joint.
pub(crate) fn shape() -> impl Strategy<Value = Vector2<f64>> {
    (-4.0..4.0, -4.0..4.0).prop_map(|(a, b)| Vector2::new(a, b))
}

/// Any two joint rates.
pub(crate) fn rate() -> impl Strategy<Value = Vector2<f64>> {
    (-3.0..3.0, -3.0..3.0).prop_map(|(a, b)| Vector2::new(a, b))
}

/// Three harmonics of a closed curve, smaller the higher.
pub(crate) fn harmonics() -> impl Strategy<Value = [Harmonic<f64>; 3]> {
    prop::array::uniform3((rate(), rate())).prop_map(|coefficients| {
        let mut order = 0.0;
        coefficients.map(|(cos, sin)| {
            order += 1.0;
            Harmonic {
                cos: cos / (2.0 * order * order),
                sin: sin / (2.0 * order * order),
            }
        })
    })
}
