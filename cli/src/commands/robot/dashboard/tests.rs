//! The screen at the sizes of terminals, as pictures of text.

use super::*;
use link_protocol::{Flags, StopCause};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use swimmer_model::Swimmer;

fn playing() -> Telemetry {
    Telemetry {
        robot_us: 12_340_000,
        state: StateName::Playing,
        cause: StopCause::Boot,
        flags: Flags::default(),
        cycle: 2,
        cycles: 10,
        phase: 16_384,
        setpoint: [12_217, -6_109],
        pulse_ns: [1_544_567, 1_477_700],
        battery_mv: Some(5180),
        pose: link_protocol::Pose {
            x: 0.042,
            y: -0.004,
            theta: 0.21,
        },
        frames_ok: 412,
        frames_bad: 3,
    }
}

fn dashboard() -> Dashboard {
    let robot = Swimmer::robot();
    let play = Playing {
        done: 0.0,
        cycles: Some(10),
        period_s: 30.0,
    };
    let mut dashboard = Dashboard::new(
        "twin at /tmp/robot".to_owned(),
        robot.links,
        robot.sphere_radius,
        play,
    );
    for step in 0..100u8 {
        let along = f32::from(step) / 99.0;
        let telemetry = Telemetry {
            robot_us: 8_340_000 + u64::from(step) * 40_000,
            frames_ok: 20 + 4 * u16::from(step),
            pose: link_protocol::Pose {
                x: 0.042 * along,
                y: -0.01 * (9.0 * along).sin(),
                theta: 0.21 * along,
            },
            ..playing()
        };
        dashboard.tell(&telemetry);
    }
    dashboard.tell(&playing());
    dashboard.link = LinkCounters {
        frames_sent: 400,
        bytes_sent: 9000,
        bytes_received: 30_000,
        retransmissions: 8,
        telemetry: 100,
        late_telemetry: 2,
        round_trip: Some(Duration::from_millis(42)),
        ..LinkCounters::default()
    };
    dashboard.link.received.ok = 640;
    dashboard.link.received.bad_crc = 5;
    dashboard.clock = Some(ClockFit {
        origin: 6.0,
        robot_at_origin: 8.0,
        rate: 1.000_012_3,
        uncertainty: 0.004_2,
        pings: 17,
    });
    dashboard
}

fn drawn(dashboard: &Dashboard, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| dashboard.draw(frame)).unwrap();
    terminal.backend().to_string()
}

#[test]
fn at_80_by_24() {
    insta::assert_snapshot!(drawn(&dashboard(), 80, 24));
}

#[test]
fn on_a_wide_terminal() {
    insta::assert_snapshot!(drawn(&dashboard(), 132, 40));
}

#[test]
fn on_a_narrow_terminal() {
    insta::assert_snapshot!(drawn(&dashboard(), 44, 34));
}

#[test]
fn before_the_first_telemetry() {
    let robot = Swimmer::robot();
    let play = Playing {
        done: 0.0,
        cycles: None,
        period_s: 0.0,
    };
    let dashboard = Dashboard::new("twin".to_owned(), robot.links, 0.0, play);
    insta::assert_snapshot!(drawn(&dashboard, 80, 24));
}

#[test]
fn a_silent_link_and_a_low_battery_are_shouted() {
    let mut dashboard = dashboard();
    dashboard.silent = Duration::from_millis(1700);
    dashboard.tell(&Telemetry {
        state: StateName::EStopped,
        cause: StopCause::EStop,
        flags: Flags::BATTERY_LOW,
        pulse_ns: [0; 2],
        battery_mv: Some(4300),
        ..playing()
    });
    dashboard.note = "e-stopped";
    insta::assert_snapshot!(drawn(&dashboard, 80, 24));
}

/// Whatever the terminal's size, drawing does not panic.
#[test]
fn any_size_is_drawn() {
    let dashboard = dashboard();
    for width in (1..140).step_by(7) {
        for height in 1..45 {
            drawn(&dashboard, width, height);
        }
    }
}

/// Through the process that has the port one telemetry in five is seen here, and none of the others is lost.
#[test]
fn beside_a_holder_the_loss_is_the_links() {
    let mut dashboard = dashboard();
    dashboard.first = None;
    for step in 0..40 {
        dashboard.link.telemetry = 100 + 5 * step;
        dashboard.link.frames_sent = 400 + 4 * step;
        dashboard.tell(&Telemetry {
            robot_us: 20_000_000 + step * 200_000,
            frames_ok: 412 + 4 * u16::try_from(step).unwrap(),
            ..playing()
        });
    }
    assert_eq!(dashboard.loss(), Some([0.0, 0.0]));
    dashboard.link.telemetry -= 98;
    let [_, back] = dashboard.loss().unwrap();
    assert!((back - 50.0).abs() < 1.0, "{back}");
}

/// On a screen too small for anything else the state stands there, and first.
#[test]
fn a_tiny_terminal_shows_the_state_first() {
    let dashboard = dashboard();
    for (width, height) in [
        (20, 1),
        (12, 3),
        (29, 40),
        (200, 7),
        (30, 8),
        (44, 12),
        (75, 15),
    ] {
        let drawn = drawn(&dashboard, width, height);
        assert!(drawn.contains("playing"), "{width}x{height}\n{drawn}");
    }
    assert!(drawn(&dashboard, 20, 1).contains("playing"));
}

#[test]
fn a_new_play_starts_a_new_trail() {
    let mut dashboard = dashboard();
    assert!(dashboard.trail.len() > 50);
    dashboard.tell(&Telemetry {
        state: StateName::Starting,
        cycle: 0,
        ..playing()
    });
    dashboard.tell(&Telemetry {
        cycle: 0,
        ..playing()
    });
    assert!(dashboard.trail.len() <= 1);
}
