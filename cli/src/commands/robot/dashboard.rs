//! What the robot is doing, on one screen: a pure picture of what is known, drawn anew at each beat.
//!
//! Narrow terminals get everything under each other, wide ones the body and the trail beside it.

use std::collections::VecDeque;
use std::time::Duration;

use host_link::session::{ClockFit, LinkCounters};
use link_protocol::{Flags, StateName, Telemetry};
use nalgebra::Vector2;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Circle, Line as Stroke, Points};
use ratatui::widgets::{Block, Gauge, Paragraph};
use swimmer_model::{Links, Pose};

use super::answers::{self, telemetry_angles};
use super::playing::Playing;

/// Everything that the screen shows.
#[derive(Debug)]
pub(super) struct Dashboard {
    /// Which robot, at which port.
    pub(super) title: String,
    pub(super) links: Links<f64>,
    pub(super) sphere_radius: f64,
    pub(super) play: Playing,
    pub(super) telemetry: Option<Telemetry>,
    /// Time since the last telemetry.
    pub(super) silent: Duration,
    pub(super) link: LinkCounters,
    pub(super) clock: Option<ClockFit>,
    /// Where the middle link was, by the robot's own prediction \[m\].
    trail: VecDeque<Vector2<f64>>,
    /// What was last asked of the robot from here.
    pub(super) note: &'static str,
    /// Telemetry so far, and the first of it with the frames that had been sent by then.
    told: u64,
    first: Option<(Telemetry, u64)>,
}

/// Points of the trail that are kept: ten minutes at 25 a second.
const TRAIL: usize = 15_000;
/// The robot tells so often, µs.
const TELEMETRY_US: u64 = 40_000;
/// Frames before a share of them means something.
const ENOUGH: u64 = 50;
/// Silence that is worth a warning.
const SILENT: Duration = Duration::from_millis(500);

impl Dashboard {
    pub(super) fn new(title: String, links: Links<f64>, sphere_radius: f64, play: Playing) -> Self {
        Self {
            title,
            links,
            sphere_radius,
            play,
            telemetry: None,
            silent: Duration::ZERO,
            link: LinkCounters::default(),
            clock: None,
            trail: VecDeque::new(),
            note: "",
            told: 0,
            first: None,
        }
    }

    /// Shares of frames lost \[%\], to the robot and from it; `None` before there is enough to say.
    fn loss(&self) -> Option<[f64; 2]> {
        let (first, sent_before) = self.first.as_ref()?;
        let last = self.telemetry.as_ref()?;
        let heard = f64::from(last.frames_ok.wrapping_sub(first.frames_ok));
        let sent = self.link.frames_sent.saturating_sub(*sent_before);
        let due = (last.robot_us.saturating_sub(first.robot_us) / TELEMETRY_US) as f64 + 1.0;
        if sent < ENOUGH || due < ENOUGH as f64 {
            return None;
        }
        // The robot's count wraps; after so many frames the share is of the last round.
        let sent = (sent % 65_536) as f64;
        let percent = |arrived: f64, of: f64| (100.0 * (1.0 - arrived / of)).clamp(0.0, 100.0);
        Some([percent(heard, sent), percent(self.told as f64, due)])
    }

    /// The robot has told more.
    pub(super) fn tell(&mut self, telemetry: &Telemetry) {
        let began = self.telemetry.is_some_and(|before| {
            telemetry.cycle < before.cycle || before.state == StateName::Starting
        });
        if began && telemetry.cycle == 0 && telemetry.state == StateName::Playing {
            // A new play starts at the origin of its own frame.
            self.trail.clear();
        }
        let at = Vector2::new(telemetry.pose.x, telemetry.pose.y).cast();
        if self.trail.back() != Some(&at) {
            if self.trail.len() == TRAIL {
                self.trail.pop_front();
            }
            self.trail.push_back(at);
        }
        self.told += 1;
        self.first
            .get_or_insert((*telemetry, self.link.frames_sent));
        self.play = self.play.at(telemetry);
        self.telemetry = Some(*telemetry);
    }

    /// Draws it.
    pub(super) fn draw(&self, frame: &mut Frame<'_>) {
        let [head, body, foot] = Layout::vertical([
            Constraint::Length(1),
            Constraint::Min(0),
            Constraint::Length(1),
        ])
        .areas(frame.area());
        frame.render_widget(
            Line::from(self.title.as_str()).style(Style::new().add_modifier(Modifier::BOLD)),
            head,
        );
        frame.render_widget(self.footer(foot.width), foot);
        let wide = body.width >= 76 && body.height >= 14;
        if wide {
            let [left, right] =
                Layout::horizontal([Constraint::Length(38), Constraint::Min(0)]).areas(body);
            let [state, link] =
                Layout::vertical([Constraint::Length(10), Constraint::Min(0)]).areas(left);
            self.state(frame, state);
            self.link(frame, link);
            let [pose, trail] =
                Layout::vertical([Constraint::Fill(1), Constraint::Fill(1)]).areas(right);
            self.body(frame, pose);
            self.trail(frame, trail);
        } else {
            let [state, pose, link] = Layout::vertical([
                Constraint::Length(10),
                Constraint::Min(6),
                Constraint::Length(9),
            ])
            .areas(body);
            self.state(frame, state);
            self.body(frame, pose);
            self.link(frame, link);
        }
    }

    fn footer(&self, width: u16) -> Paragraph<'_> {
        let keys = if width >= 60 {
            "q leave the robot as it is   s stop   e e-stop"
        } else {
            "q quit  s stop  e e-stop"
        };
        let mut spans = vec![Span::raw(keys)];
        if !self.note.is_empty() {
            spans.push(Span::styled(
                format!("   {}", self.note),
                Style::new().add_modifier(Modifier::BOLD),
            ));
        }
        Paragraph::new(Line::from(spans))
    }

    fn state(&self, frame: &mut Frame<'_>, area: Rect) {
        let block = Block::bordered().title(" Robot ");
        let inner = block.inner(area);
        frame.render_widget(block, area);
        let [lines, bar] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(1)]).areas(inner);
        let Some(telemetry) = &self.telemetry else {
            frame.render_widget(Paragraph::new("no telemetry yet"), lines);
            return;
        };
        let [front, back] = telemetry_angles(telemetry).map(f64::to_degrees);
        let flags = answers::flags(telemetry.flags);
        let moving = matches!(
            telemetry.state,
            StateName::Starting | StateName::Playing | StateName::Paused
        );
        let text = vec![
            Line::from(vec![
                Span::styled(
                    answers::state(telemetry.state),
                    Style::new()
                        .fg(colour(telemetry.state))
                        .add_modifier(Modifier::BOLD),
                ),
                Span::raw(if moving {
                    String::new()
                } else {
                    format!("  ({})", answers::cause(telemetry.cause))
                }),
            ]),
            Line::from(if moving {
                self.play.to_string()
            } else {
                self.play.so_far()
            }),
            Line::from(format!(
                "phase    {:>5.1} % of the cycle",
                100.0 * f64::from(telemetry.phase) / 65_536.0
            )),
            Line::from(format!("angles   φ₁ {front:+7.2}°  φ₂ {back:+7.2}°")),
            Line::from(format!("pulses   {}", pulses(telemetry.pulse_ns))),
            Line::from(format!(
                "battery  {}",
                answers::battery(telemetry.battery_mv.map(|mv| f64::from(mv) * 1e-3))
            ))
            .style(warning(telemetry.flags.contains(Flags::BATTERY_LOW))),
            Line::from(if flags.is_empty() {
                String::new()
            } else {
                format!("flags    {}", flags.join(", "))
            }),
        ];
        frame.render_widget(Paragraph::new(text), lines);
        let share = self
            .play
            .share()
            .unwrap_or_else(|| f64::from(telemetry.phase) / 65_536.0);
        frame.render_widget(
            Gauge::default()
                .ratio(share.clamp(0.0, 1.0))
                .label(format!("{:.0} %", 100.0 * share))
                .gauge_style(Style::new().fg(Color::Cyan)),
            bar,
        );
    }

    fn link(&self, frame: &mut Frame<'_>, area: Rect) {
        let silent = self.silent > SILENT;
        let title = if silent {
            format!(" Link: silent for {:.1} s ", self.silent.as_secs_f64())
        } else {
            " Link ".to_owned()
        };
        let block = Block::bordered().title(title).style(warning(silent));
        let inner = block.inner(area);
        frame.render_widget(block, area);
        let link = &self.link;
        let trip = link.round_trip.map_or_else(
            || "not known".to_owned(),
            |trip| format!("{} ms", trip.as_millis()),
        );
        let clock = self.clock.map_or_else(
            || "not known".to_owned(),
            |clock| {
                format!(
                    "±{:.1} ms, {:+.0} ppm, {} pings",
                    clock.uncertainty * 1e3,
                    (clock.rate - 1.0) * 1e6,
                    clock.pings
                )
            },
        );
        let robot = self
            .telemetry
            .map_or((0, 0), |t| (t.frames_ok, t.frames_bad));
        let text = vec![
            Line::from(format!("trip     {trip}")),
            Line::from(self.loss().map_or_else(
                || "loss     not known yet".to_owned(),
                |[there, back]| format!("loss     {there:.1} % there, {back:.1} % back"),
            )),
            Line::from(format!("clock    {clock}")),
            Line::from(format!(
                "sent     {} frames, {} again",
                link.frames_sent, link.retransmissions
            )),
            Line::from(format!(
                "here     {} good, {} broken, {} late",
                link.received.ok,
                link.received.bad(),
                link.late_telemetry
            )),
            Line::from(format!("robot    {} good, {} broken", robot.0, robot.1)),
        ];
        frame.render_widget(Paragraph::new(text), inner);
    }

    /// The three links at their set-points, the middle one level.
    fn body(&self, frame: &mut Frame<'_>, area: Rect) {
        let phi = Vector2::from(self.telemetry.as_ref().map_or([0.0; 2], telemetry_angles));
        let corners = self.links.outline(&phi);
        let half = 0.5 * self.links.middle + self.links.front.max(self.links.back);
        let block = Block::bordered().title(" Body ");
        let (x, y) = equal_axes(block.inner(area), [-half, half], [-half, half]);
        let canvas = Canvas::default()
            .block(block)
            .marker(Marker::Braille)
            .x_bounds(x)
            .y_bounds(y)
            .paint(|context| {
                if self.sphere_radius > 0.0 {
                    context.draw(&Circle {
                        x: 0.0,
                        y: 0.0,
                        radius: self.sphere_radius,
                        color: Color::DarkGray,
                    });
                }
                for pair in corners.windows(2) {
                    if let [from, to] = pair {
                        context.draw(&Stroke::new(from.x, from.y, to.x, to.y, Color::Cyan));
                    }
                }
                let [_, _, _, front] = corners;
                context.print(front.x, front.y, "F");
            });
        frame.render_widget(canvas, area);
    }

    /// Where the robot believes to have swum since the play began.
    fn trail(&self, frame: &mut Frame<'_>, area: Rect) {
        let pose = self.telemetry.map_or_else(Pose::identity, |telemetry| {
            Pose::new(
                f64::from(telemetry.pose.x),
                f64::from(telemetry.pose.y),
                f64::from(telemetry.pose.theta),
            )
        });
        let block = Block::bordered().title(format!(
            " Predicted x {:+.1} y {:+.1} mm θ {:+.1}° ",
            pose.x * 1e3,
            pose.y * 1e3,
            pose.theta.to_degrees()
        ));
        let nose = pose.transform(&Vector2::new(0.5 * self.links.middle, 0.0));
        let tail = pose.transform(&Vector2::new(-0.5 * self.links.middle, 0.0));
        let all = || self.trail.iter().copied().chain([nose, tail]);
        let range = |of: fn(&Vector2<f64>) -> f64| {
            let low = all().map(|p| of(&p)).fold(f64::INFINITY, f64::min);
            let high = all().map(|p| of(&p)).fold(f64::NEG_INFINITY, f64::max);
            let margin = 0.05 * (high - low).max(1e-3);
            [low - margin, high + margin]
        };
        let (x, y) = equal_axes(block.inner(area), range(|p| p.x), range(|p| p.y));
        let points: Vec<(f64, f64)> = self.trail.iter().map(|p| (p.x, p.y)).collect();
        let canvas = Canvas::default()
            .block(block)
            .marker(Marker::Braille)
            .x_bounds(x)
            .y_bounds(y)
            .paint(|context| {
                context.draw(&Points {
                    coords: &points,
                    color: Color::Yellow,
                });
                context.draw(&Stroke::new(tail.x, tail.y, nose.x, nose.y, Color::Cyan));
            });
        frame.render_widget(canvas, area);
    }
}

/// Ranges that show both directions at one scale: a braille dot is about as wide as high.
fn equal_axes(area: Rect, x: [f64; 2], y: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let dots = |cells: u16, of_one: f64| f64::from(cells.max(1)) * of_one;
    let (columns, rows) = (dots(area.width, 2.0), dots(area.height, 4.0));
    let scale = ((x[1] - x[0]) / columns)
        .max((y[1] - y[0]) / rows)
        .max(1e-9);
    let around = |[low, high]: [f64; 2], dots: f64| {
        let (middle, half) = (f64::midpoint(low, high), 0.5 * scale * dots);
        [middle - half, middle + half]
    };
    (around(x, columns), around(y, rows))
}

fn pulses([front, back]: [u32; 2]) -> String {
    if front == 0 && back == 0 {
        return "off".to_owned();
    }
    format!(
        "{:.1} µs, {:.1} µs",
        f64::from(front) * 1e-3,
        f64::from(back) * 1e-3
    )
}

fn warning(holds: bool) -> Style {
    if holds {
        Style::new().fg(Color::Red).add_modifier(Modifier::BOLD)
    } else {
        Style::new()
    }
}

fn colour(state: StateName) -> Color {
    match state {
        StateName::Stopped => Color::Gray,
        StateName::EStopped => Color::Red,
        StateName::Holding | StateName::Paused => Color::Yellow,
        StateName::Starting | StateName::Playing => Color::Green,
        StateName::Stopping | StateName::Settling => Color::Magenta,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use link_protocol::StopCause;
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
}
