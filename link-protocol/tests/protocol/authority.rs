//! Authority table: agreement of documentation and code, and the thresholds above which settings require presence.
#[allow(dead_code)] // only the requests are used
use crate::samples;

use link_protocol::*;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Rows of the table: class, requests, conditions.
fn table() -> String {
    let mut text = String::from(
        "| class | requests | signed, if a key is set | fresh keep-alive | presence | state | wear budget |\n|---|---|---|---|---|---|---|\n",
    );
    let mut listed = BTreeSet::new();
    for class in RequestClass::ALL {
        let mut names: Vec<String> = Vec::new();
        for (_, request) in samples::requests() {
            let name = format!("{request:?}");
            let name = name.split(['(', ' ']).next().unwrap().to_owned();
            let meant = [true, false].map(|widens| request.class(|| widens));
            if meant.contains(&class) && !names.contains(&name) {
                listed.insert(name.clone());
                names.push(name);
            }
        }
        let needs = class.needs();
        let mark = |needed: bool| if needed { "yes" } else { "–" };
        let title = match class {
            RequestClass::Read => "read",
            RequestClass::Stop => "stop",
            RequestClass::Narrowing => "setting, not wider",
            RequestClass::Widening => "setting, wider",
            RequestClass::Trim => "trim within 1°",
            RequestClass::WideTrim => "trim beyond 1°",
            RequestClass::Clearing => "latch clearing",
            RequestClass::Storing => "storing",
            RequestClass::Powering => "powering",
        };
        let state = match needs.state {
            StateNeeded::Any => "any",
            StateNeeded::Still => "at rest, or holding a pose",
            StateNeeded::Stopped => "Stopped",
        };
        let names: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
        let _ = writeln!(
            text,
            "| {title} | {} | {} | {} | {} | {state} | {} |",
            names.join(", "),
            mark(needs.signature),
            mark(needs.freshness),
            mark(needs.presence),
            mark(needs.wear)
        );
    }
    assert_eq!(listed.len(), 27, "a request is in no sample: {listed:?}");
    text
}

#[test]
fn the_documentation_shows_the_authority_table() {
    let table = table();
    for (path, page) in [
        (
            "docs/security.md",
            include_str!("../../../docs/security.md"),
        ),
        (
            "docs/reference/protocol.md",
            include_str!("../../../docs/reference/protocol.md"),
        ),
    ] {
        assert!(
            page.contains(&table),
            "{path} must hold this table:\n{table}"
        );
    }
}

/// Requests that every version supports.
#[test]
fn stops_need_nothing() {
    for request in [Request::Stop, Request::EStop] {
        let needs = request.class(|| true).needs();
        assert!(!(needs.signature || needs.freshness || needs.presence || needs.wear));
        assert_eq!(needs.state, StateNeeded::Any);
    }
    let others = samples::requests();
    let unsigned = others
        .iter()
        .filter(|(_, request)| !request.class(|| false).needs().signature);
    assert_eq!(unsigned.count(), 2);
}

fn held() -> SettingsHeld {
    let servo = ServoSettings {
        centre_ns: 1_500_000,
        slope_rad_per_us: 0.0274,
        reversed: false,
        trim: 0,
    };
    SettingsHeld {
        configuration: samples::CONFIGURATION,
        built: samples::CONFIGURATION,
        servos: [servo; 2],
        at_bench: [servo; 2],
        ranges: [PulseRange {
            shortest_ns: 1_400_000,
            longest_ns: 1_600_000,
        }; 2],
        passive: None,
        has_key: false,
    }
}

/// 1° is 174.5 units of trim, or 0.637 µs of this servo.
#[test]
fn centre_slope_and_trim_add_up() {
    let held = held();
    let wide = |centre_ns: i32, slope: f32, trim: i16| {
        held.is_widened_by(&Request::SetServo {
            joint: Joint::Back,
            settings: ServoSettings {
                centre_ns: 1_500_000_u32.saturating_add_signed(centre_ns),
                slope_rad_per_us: 0.0274 * slope,
                trim,
                reversed: false,
            },
        })
    };
    assert!(!wide(0, 1.0, 174) && wide(0, 1.0, 175) && wide(0, 1.0, -175));
    assert!(!wide(636, 1.0, 0) && wide(638, 1.0, 0) && wide(-638, 1.0, 0));
    assert!(!wide(310, 1.0, 85) && wide(330, 1.0, 90) && wide(330, 1.0, -90));
    assert!(!wide(0, 1.006, 0) && wide(0, 1.007, 0) && wide(0, 0.993, 0));
    assert!(wide(0, f32::NAN, 0));
}

/// Steps of half a degree, each within the limit from the previous one, do not accumulate.
#[test]
fn small_steps_are_measured_from_the_bench() {
    let mut held = held();
    let trim = |trim| Request::Trim {
        joint: Joint::Front,
        trim,
    };
    held.servos[0].trim = 87;
    assert!(!held.is_widened_by(&trim(174)));
    held.servos[0].trim = 174;
    assert!(held.is_widened_by(&trim(261)));
    // Repeating the present setting is no change, whatever its value.
    held.servos[0].trim = 400;
    assert!(!held.is_widened_by(&trim(400)));
}

#[test]
fn other_directions_wider_ranges_and_first_keys_are_wider() {
    let mut held = held();
    let reversed = Request::SetServo {
        joint: Joint::Front,
        settings: ServoSettings {
            reversed: true,
            ..held.servos[0]
        },
    };
    assert!(held.is_widened_by(&reversed));
    let range = |shortest_ns, longest_ns| Request::SetPulseRange {
        joint: Joint::Front,
        range: PulseRange {
            shortest_ns,
            longest_ns,
        },
    };
    assert!(!held.is_widened_by(&range(1_400_000, 1_600_000)));
    assert!(!held.is_widened_by(&range(1_400_001, 1_599_999)));
    assert!(held.is_widened_by(&range(1_399_999, 1_500_001)));
    assert!(held.is_widened_by(&range(1_499_999, 1_600_001)));
    let key = Request::SetKey(Some(samples::KEY));
    assert!(held.is_widened_by(&key) && !held.is_widened_by(&Request::SetKey(None)));
    held.has_key = true;
    assert!(!held.is_widened_by(&key));
}

/// Removing a servo is free, adding one is not.
#[test]
fn to_drive_a_passive_joint_again_is_wider() {
    let mut held = held();
    let set = Request::SetPassive;
    assert!(!held.is_widened_by(&set(None)) && !held.is_widened_by(&set(Some(Joint::Back))));
    held.passive = Some(Joint::Back);
    assert!(!held.is_widened_by(&set(Some(Joint::Back))));
    assert!(held.is_widened_by(&set(None)) && held.is_widened_by(&set(Some(Joint::Front))));
}

/// The hash of a robot with two servos, as computed by firmware that knows no passive joint.
#[test]
fn the_hash_without_a_passive_joint_is_that_of_earlier_firmware() {
    let held = held();
    let mut bytes = [0; 128];
    let settings = (held.configuration, held.servos, held.ranges);
    let bytes = postcard::to_slice(&settings, &mut bytes).unwrap();
    let hash = settings_crc32(&held.configuration, &held.servos, &held.ranges, None);
    assert_eq!(hash, crc32c(bytes));
}

/// Each value of the settings affects the hash.
#[test]
fn the_hash_of_the_settings_covers_each_of_them() {
    let held = held();
    let hash =
        |of: &SettingsHeld| settings_crc32(&of.configuration, &of.servos, &of.ranges, of.passive);
    let mut hashes = BTreeSet::from([hash(&held)]);
    let changes: [fn(&mut SettingsHeld); 16] = [
        |of| of.configuration.middle_m += 1e-3,
        |of| of.configuration.front_m += 1e-3,
        |of| of.configuration.back_m += 1e-3,
        |of| of.configuration.chi += 1e-3,
        |of| of.configuration.tangential_drag = TangentialDrag::LogAspect(4.0),
        |of| of.configuration.sphere_radius_m += 1e-3,
        |of| of.configuration.max_angle -= 1e-3,
        |of| of.configuration.max_rate -= 1e-3,
        |of| of.servos[0].centre_ns += 1,
        |of| of.servos[1].slope_rad_per_us += 1e-4,
        |of| of.servos[0].reversed = true,
        |of| of.servos[1].trim = 1,
        |of| of.ranges[0].shortest_ns += 1,
        |of| of.ranges[1].longest_ns += 1,
        |of| of.passive = Some(Joint::Front),
        |of| of.passive = Some(Joint::Back),
    ];
    for change in changes {
        let mut changed = held;
        change(&mut changed);
        hashes.insert(hash(&changed));
    }
    assert_eq!(hashes.len(), 17);
}
