//! The panes of the screen: the robot, the link, the body, the trail.

use link_protocol::{Flags, StateName};
use nalgebra::Vector2;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Circle, Line as Stroke, Points};
use ratatui::widgets::{Block, Gauge, Paragraph};
use swimmer_model::Pose;

use super::super::outputs::{self, telemetry_angles};
use super::{Dashboard, SILENT};

impl Dashboard {
    pub(super) fn state(&self, frame: &mut Frame<'_>, area: Rect) {
        let block = Block::bordered().title(" Robot ");
        let inner = block.inner(area);
        frame.render_widget(block, area);
        let [lines, bar] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(1)]).areas(inner);
        frame.render_widget(Paragraph::new(self.state_lines()), lines);
        let Some(telemetry) = &self.telemetry else {
            return;
        };
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

    /// Lines about the robot's state, the most important first.
    pub(super) fn state_lines(&self) -> Vec<Line<'_>> {
        let Some(telemetry) = &self.telemetry else {
            return vec![Line::from("no telemetry yet")];
        };
        let [front, back] = telemetry_angles(telemetry).map(f64::to_degrees);
        let flags = outputs::flags(telemetry.flags);
        let moving = outputs::is_under_way(telemetry.state);
        vec![
            Line::from(vec![
                Span::styled(
                    outputs::state(telemetry.state),
                    Style::new()
                        .fg(colour(telemetry.state))
                        .add_modifier(Modifier::BOLD),
                ),
                Span::raw(if outputs::is_explained(telemetry.state) {
                    format!("  ({})", outputs::cause(telemetry.cause))
                } else {
                    String::new()
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
                outputs::battery(telemetry.battery_mv.map(|mv| f64::from(mv) / 1e3))
            ))
            .style(warning(telemetry.flags.contains(Flags::BATTERY_LOW))),
            Line::from(if flags.is_empty() {
                String::new()
            } else {
                format!("flags    {}", flags.join(", "))
            }),
        ]
    }

    pub(super) fn link(&self, frame: &mut Frame<'_>, area: Rect) {
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
    pub(super) fn body(&self, frame: &mut Frame<'_>, area: Rect) {
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

    /// Path since the play began, by the robot's own prediction.
    pub(super) fn trail(&self, frame: &mut Frame<'_>, area: Rect) {
        let pose = self.predicted();
        let title = |what: &str, pose: &Pose<f64>| {
            format!(
                " {what} x {:+.1} y {:+.1} mm θ {:+.1}° ",
                pose.x * 1e3,
                pose.y * 1e3,
                pose.theta.to_degrees()
            )
        };
        let mut block = Block::bordered().title(title("Predicted", &pose));
        let middle = |pose: &Pose<f64>| {
            [0.5, -0.5].map(|share| pose.transform(&Vector2::new(share * self.links.middle, 0.0)))
        };
        let [nose, tail] = middle(&pose);
        let tracked = self.overlay.latest();
        if let Some(tracked) = &tracked {
            block = block.title_bottom(title("Tracked", tracked));
        }
        let tracked = tracked.map(|pose| middle(&pose));
        let all = || {
            let ends = tracked.into_iter().flatten().chain([nose, tail]);
            self.trail
                .iter()
                .copied()
                .chain(self.overlay.trail())
                .chain(ends)
        };
        let range = |of: fn(&Vector2<f64>) -> f64| {
            let low = all().map(|p| of(&p)).fold(f64::INFINITY, f64::min);
            let high = all().map(|p| of(&p)).fold(f64::NEG_INFINITY, f64::max);
            let margin = 0.05 * (high - low).max(1e-3);
            [low - margin, high + margin]
        };
        let (x, y) = equal_axes(block.inner(area), range(|p| p.x), range(|p| p.y));
        let points: Vec<(f64, f64)> = self.trail.iter().map(|p| (p.x, p.y)).collect();
        let seen: Vec<(f64, f64)> = self.overlay.trail().map(|p| (p.x, p.y)).collect();
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
                // Over the prediction.
                context.draw(&Points {
                    coords: &seen,
                    color: Color::Magenta,
                });
                if let Some([nose, tail]) = tracked {
                    let stroke = Stroke::new(tail.x, tail.y, nose.x, nose.y, Color::Magenta);
                    context.draw(&stroke);
                }
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
        f64::from(front) / 1e3,
        f64::from(back) / 1e3
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
