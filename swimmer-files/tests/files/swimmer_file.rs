//! Swimmer files: the documented example, exact round trips, and a place for every mistake.

use std::path::Path;

use link_protocol::Joint;
use proptest::prelude::*;
use swimmer_files::{Fluid, JointName, PassiveFile, ServoFile, Spring, SwimmerFile};
use swimmer_model::{Link, Links, Medium, Swimmer, TangentialDrag};

const EXAMPLE: &str = r#"name = "our robot"
[links]
middle = 0.071            # m
side = 0.137              # m, both side links
[drag]
chi = 3.598               # c_n / c_t
c_t = { log_aspect = 4.543 }
[sphere]
radius = 0.0692           # m; leave the table out for none
[fluid]                   # optional, for watts and newtons
kinematic_viscosity = 0.06
density = 976.0
[servo]
max_angle = 2.8           # rad
max_rate = 3.5            # rad/s
dead_band = 0.017         # rad
slope_rad_per_us = 0.0274
centre_us = 1500.0
"#;

fn read(text: &str) -> Result<SwimmerFile, swimmer_files::FileError> {
    SwimmerFile::parse(text, Path::new("robot.toml"))
}

#[test]
fn the_documented_example() {
    let file = read(EXAMPLE).unwrap();
    assert_eq!(file.name, "our robot");
    assert_eq!(file.swimmer, Swimmer::robot());
    assert_eq!(
        file.fluid,
        Some(Fluid {
            kinematic_viscosity: 0.06,
            density: 976.0
        })
    );
    assert_eq!(file.servo, Some(ServoFile::default()));
    assert_eq!(file.hash(), SwimmerFile::preset("robot").unwrap().hash());
    assert!((file.fluid.unwrap().viscosity() - 58.56).abs() < 1e-12);
}

#[test]
fn the_smallest_file_is_named_after_itself() {
    let file =
        read("[links]\nmiddle = 1\nside = 1\n[drag]\nchi = 2\nc_t = { over_viscosity = 1 }\n")
            .unwrap();
    assert_eq!(
        file,
        SwimmerFile {
            name: "robot".to_owned(),
            ..SwimmerFile::preset("purcell").unwrap()
        }
    );
}

/// Each mistake is made by replacing a piece of the example; the error must stand where the mistake is.
#[test]
fn mistakes_have_a_place() {
    let cases = [
        ("chi = 3.598", "chi = -1.0", (6, 7), "positive"),
        ("chi = 3.598", "chi = nan", (6, 7), "positive"),
        ("chi = 3.598", "chi = \"two\"", (6, 7), "expected f64"),
        ("chi = 3.598", "xi = 3.598", (6, 1), "unknown field `xi`"),
        (
            "log_aspect = 4.543",
            "log_aspect = 0.0",
            (7, 22),
            "positive",
        ),
        (
            "log_aspect = 4.543",
            "thickness = 4.543",
            (7, 9),
            "unknown variant `thickness`",
        ),
        ("middle = 0.071", "middle = 0,071", (3, 11), ""),
        (
            "radius = 0.0692",
            "radius = -0.1",
            (9, 10),
            "zero or a positive",
        ),
        (
            "side = 0.137",
            "front = 0.137",
            (2, 1),
            "`front` and `back`",
        ),
        ("[fluid]", "[liquid]", (10, 2), "unknown field `liquid`"),
        ("density = 976.0", "density = inf", (12, 11), "positive"),
        (
            "dead_band = 0.017",
            "dead_band = -0.017",
            (16, 13),
            "zero or a positive",
        ),
        (
            "log_aspect = 4.543",
            "half_thickness = 0.071",
            (7, 26),
            "shortest link",
        ),
    ];
    for (good, bad, place, message) in cases {
        let text = EXAMPLE.replace(good, bad);
        assert_ne!(text, EXAMPLE, "{good}");
        let error = read(&text).expect_err(bad);
        assert_eq!(error.place(), Some(place), "{bad}: {error}");
        assert!(error.to_string().contains(message), "{bad}: {error}");
        assert!(error.to_string().starts_with("robot.toml:"), "{error}");
    }
}

#[test]
fn neither_preset_nor_file() {
    let error = SwimmerFile::find("robbot").unwrap_err().to_string();
    assert!(
        error.contains("robbot") && error.contains("purcell, robot, robot-slender"),
        "{error}"
    );
}

#[test]
fn a_fit_is_saved_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fit/fitted.toml");
    let fitted = read(EXAMPLE).unwrap().fitted(0.0689, 3.61);
    fitted.save(&path).unwrap();
    let back = SwimmerFile::load(&path).unwrap();
    assert_eq!(back, fitted);
    assert_eq!(back.name, "our robot, fitted");
    assert_ne!(back.hash(), read(EXAMPLE).unwrap().hash());
}

const UNEQUAL: &str = r#"name = "uneven"
[links]
middle = 0.071
front = 0.137
back = 0.120
[drag]
chi = { middle = 3.6, front = 2.8, back = 2.9 }
c_t = { over_viscosity = { middle = 1.4, front = 1.3, back = 1.2 } }
[sphere]
radius = 0.0692
on = "back"
"#;

const PERFECT: &str = r#"[links]
middle = 1.0
side = 1.0
[medium]
kind = "perfect"
aspect = 0.1
density = 1000.0
"#;

#[test]
fn links_of_their_own() {
    let swimmer = read(UNEQUAL).unwrap().swimmer;
    let links = Links {
        middle: 0.071,
        front: 0.137,
        back: 0.12,
    };
    let c_t = Links {
        middle: 1.4,
        front: 1.3,
        back: 1.2,
    };
    assert_eq!(
        swimmer,
        Swimmer {
            links,
            chi: 3.6,
            side_chi: Some([2.8, 2.9]),
            tangential_drag: TangentialDrag::PerLink(c_t),
            sphere_radius: 0.0692,
            sphere_on: Link::Back,
            medium: Medium::Viscous,
        }
    );
    let whole = UNEQUAL.replace("middle = 3.6, front = 2.8", "middle = 4, front = 3");
    let chi = read(&whole).unwrap().swimmer.chi;
    assert_eq!(chi.to_bits(), 4.0_f64.to_bits());
}

#[test]
fn other_media() {
    assert_eq!(read(PERFECT).unwrap().swimmer, Swimmer::perfect_fluid());
    let wheels = "[links]\nmiddle = 1\nside = 1\n[medium]\nkind = \"wheels\"\n";
    assert_eq!(read(wheels).unwrap().swimmer, Swimmer::kinematic_snake());
    let viscous = format!("{UNEQUAL}[medium]\nkind = \"viscous\"\n");
    assert_eq!(read(&viscous).unwrap(), read(UNEQUAL).unwrap());
}

#[test]
fn every_preset_is_its_file() {
    for name in SwimmerFile::PRESETS {
        let preset = SwimmerFile::preset(name).unwrap();
        assert_eq!(read(&preset.to_toml()).unwrap(), preset);
    }
}

#[test]
fn mistakes_in_links_and_media_have_a_place() {
    let cases = [
        (
            UNEQUAL,
            "middle = 3.6, ",
            "",
            (7, 7),
            "missing field `middle`",
        ),
        (
            UNEQUAL,
            "front = 2.8",
            "side = 2.8",
            (7, 23),
            "unknown field `side`",
        ),
        (UNEQUAL, "front = 2.8", "front = -2.8", (7, 31), "positive"),
        (UNEQUAL, "back = 1.2", "back = 0.0", (8, 62), "positive"),
        (
            UNEQUAL,
            "\"back\"",
            "\"tail\"",
            (11, 6),
            "expected one of `middle`, `front`, `back`",
        ),
        (
            PERFECT,
            "\"perfect\"",
            "\"ideal\"",
            (5, 8),
            "`viscous`, `perfect`, `wheels`",
        ),
        (PERFECT, "aspect = 0.1\n", "", (4, 1), "`aspect`"),
        (
            PERFECT,
            "aspect = 0.1",
            "aspect = 1.5",
            (6, 10),
            "wider than long",
        ),
        (
            PERFECT,
            "density = 1000.0",
            "density = 0",
            (7, 11),
            "positive",
        ),
        (
            PERFECT,
            "\"perfect\"",
            "\"wheels\"",
            (6, 10),
            "in a perfect fluid only",
        ),
        (
            PERFECT,
            "\"perfect\"\naspect = 0.1\ndensity = 1000.0",
            "\"viscous\"",
            (1, 1),
            "missing field `drag`",
        ),
        (
            PERFECT,
            "[medium]",
            "[drag]\nchi = 2\nc_t = { log_aspect = 4 }\n[medium]",
            (4, 1),
            "[drag] has an effect in a viscous fluid only",
        ),
        (
            PERFECT,
            "[medium]",
            "[sphere]\nradius = 0.1\n[medium]",
            (4, 1),
            "[sphere] has an effect",
        ),
        (
            PERFECT,
            "[medium]",
            "[fluid]\nkinematic_viscosity = 1\ndensity = 1\n[medium]",
            (4, 1),
            "[fluid] has an effect",
        ),
    ];
    for (text, good, bad, place, message) in cases {
        let broken = text.replacen(good, bad, 1);
        assert_ne!(text, broken, "{good}");
        let error = read(&broken).expect_err(bad);
        assert_eq!(error.place(), Some(place), "{bad}: {error}");
        assert!(error.to_string().contains(message), "{bad}: {error}");
    }
}

fn any_length() -> impl Strategy<Value = f64> {
    (1e-3..10.0).prop_map(|length: f64| length)
}

prop_compose! {
    fn any_file()(
        name in ".{0,20}",
        middle in any_length(), front in any_length(), back in any_length(), alike in any::<bool>(),
        chi in 1.0..10.0, form in 0..3, drag in 0.5..9.0, sphere in prop_oneof![Just(0.0), 1e-4..2.0],
        fluid in proptest::option::of((1e-6..1.0, 1.0..2000.0)),
        servo in proptest::option::of((0.1..3.0, 0.1..9.0, 0.0..0.3, 1e-3..0.1, 1000.0..2000.0)),
        side_chi in proptest::option::of((0.5..9.0, 0.5..9.0)), own in any::<bool>(), on in 0..3,
        medium in 0..6, (aspect, density) in (1e-3..1.0, 1e-3..1e4),
    ) -> SwimmerFile {
        let links = Links { middle, front, back: if alike { front } else { back } };
        let medium = match medium {
            0 => Medium::Perfect { aspect, density },
            1 => Medium::Wheels,
            _ => Medium::Viscous,
        };
        if medium != Medium::Viscous {
            return SwimmerFile {
                name,
                swimmer: Swimmer { links, medium, ..Swimmer::purcell() },
                fluid: None,
                servo: None,
                passive: None,
            };
        }
        SwimmerFile {
            name,
            swimmer: Swimmer {
                links,
                chi,
                side_chi: side_chi.map(Into::into),
                sphere_on: match on {
                    1 if sphere > 0.0 => Link::Front,
                    2 if sphere > 0.0 => Link::Back,
                    _ => Link::Middle,
                },
                tangential_drag: match form {
                    _ if own => TangentialDrag::PerLink(links),
                    0 => TangentialDrag::LogAspect(drag),
                    1 => TangentialDrag::HalfThickness(drag * 1e-5),
                    _ => TangentialDrag::OverViscosity(drag),
                },
                sphere_radius: sphere,
                ..Swimmer::purcell()
            },
            fluid: fluid.map(|(kinematic_viscosity, density)| Fluid { kinematic_viscosity, density }),
            servo: servo.map(|(max_angle, max_rate, dead_band, slope_rad_per_us, centre_us)| ServoFile {
                max_angle, max_rate, dead_band, slope_rad_per_us, centre_us,
                torque: (dead_band > 0.01).then_some(0.6),
                no_load_rate: (dead_band > 0.02).then_some(5.2),
            }),
            passive: alike.then_some(PassiveFile {
                joint: JointName(Joint::Back),
                spring: if fluid.is_some() { Spring::Stiffness(chi) } else { Spring::Relaxation(chi) },
            }),
        }
    }
}

proptest! {
    #[test]
    fn what_is_written_reads_back_exactly(file in any_file()) {
        prop_assert_eq!(read(&file.to_toml()).unwrap(), file);
    }

    #[test]
    fn no_text_panics(text in "(?s).{0,200}") {
        let _ = read(&text);
    }

    /// Cuts and single-character damage to a good file: an error or a file, never a panic.
    #[test]
    fn damaged_files(at in 0..EXAMPLE.len(), with in any::<char>(), cut in any::<bool>()) {
        let at = (0..=at).rev().find(|&at| EXAMPLE.is_char_boundary(at)).unwrap();
        let text = if cut { EXAMPLE[..at].to_owned() } else { format!("{}{with}{}", &EXAMPLE[..at], &EXAMPLE[at + 1..]) };
        let _ = read(&text);
    }
}

#[test]
fn a_passive_joint_has_a_spring() {
    let with = |table: &str| {
        read(&format!(
            "[links]\nmiddle = 1\nside = 1\n[drag]\nchi = 2\nc_t = {{ over_viscosity = 1 }}\n{table}"
        ))
    };
    let file = with("[passive]\njoint = \"back\"\nrelaxation_s = 0.5\n").unwrap();
    let passive = PassiveFile {
        joint: JointName(Joint::Back),
        spring: Spring::Relaxation(0.5),
    };
    assert_eq!(file.passive, Some(passive));
    let fluid = "[fluid]\nkinematic_viscosity = 0.06\ndensity = 976\n";
    let stiff = "[passive]\njoint = \"front\"\nstiffness_n_m = 0.25\n";
    let stiff = with(&format!("{fluid}{stiff}")).unwrap();
    for file in [file, stiff] {
        let again = SwimmerFile::parse(&file.to_toml(), "robot.toml".as_ref()).unwrap();
        assert_eq!(again, file);
    }
    for (table, problem) in [
        (
            "joint = \"middle\"\nrelaxation_s = 1",
            "a joint is front or back",
        ),
        ("joint = \"back\"", "one of them"),
        (
            "joint = \"back\"\nrelaxation_s = 1\nstiffness_n_m = 1",
            "one of them",
        ),
        ("joint = \"back\"\nrelaxation_s = 0", "positive"),
        ("joint = \"back\"\nstiffness_n_m = 1", "needs the viscosity"),
    ] {
        let error = with(&format!("[passive]\n{table}\n"))
            .unwrap_err()
            .to_string();
        assert!(error.contains(problem), "{error}");
    }
}
