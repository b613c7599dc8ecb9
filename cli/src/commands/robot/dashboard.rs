//! State of the robot on one screen: a pure function of the known state, drawn anew at each beat.
//!
//! Narrow terminals show all panes below each other, wide ones the body and the trail side by side.

mod overlay;
mod panes;

use std::collections::VecDeque;
use std::time::Duration;

use host_link::session::{ClockFit, LinkCounters};
use link_protocol::{StateName, Telemetry};
use nalgebra::Vector2;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;
use swimmer_model::{Links, Pose};

use self::overlay::Overlay;
use super::playing::Playing;

/// Everything that the screen shows.
#[derive(Debug)]
pub(super) struct Dashboard {
    /// Robot and port.
    pub(super) title: String,
    pub(super) links: Links<f64>,
    pub(super) sphere_radius: f64,
    pub(super) play: Playing,
    pub(super) telemetry: Option<Telemetry>,
    /// Time since the last telemetry.
    pub(super) silent: Duration,
    pub(super) link: LinkCounters,
    pub(super) clock: Option<ClockFit>,
    /// Path of the middle link, by the robot's own prediction \[m\].
    trail: VecDeque<Vector2<f64>>,
    /// Tracked path over it.
    overlay: Overlay,
    /// Last request sent from here.
    pub(super) note: &'static str,
    /// The first telemetry, with the frames that had been sent and the telemetry that had come by then: both of whoever has
    /// the link, which need not be this program.
    first: Option<(Telemetry, [u64; 2])>,
}

/// Points of the trail that are kept: ten minutes at 25 a second.
const TRAIL: usize = 15_000;
/// Interval of the robot's telemetry, µs.
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
            overlay: Overlay::default(),
            note: "",
            first: None,
        }
    }

    /// Shares of frames lost \[%\], to the robot and from it; `None` before there is enough to say.
    fn loss(&self) -> Option<[f64; 2]> {
        let (first, [sent_before, heard_before]) = self.first.as_ref()?;
        let last = self.telemetry.as_ref()?;
        let heard = f64::from(last.frames_ok.wrapping_sub(first.frames_ok));
        let sent = self.link.frames_sent.saturating_sub(*sent_before);
        let due = (last.robot_us.saturating_sub(first.robot_us) / TELEMETRY_US) as f64 + 1.0;
        if sent < ENOUGH || due < ENOUGH as f64 {
            return None;
        }
        // The robot's count wraps; after that many frames the share is that of the last round.
        let sent = (sent % 65_536) as f64;
        let frames = self.link.telemetry.saturating_sub(*heard_before) + 1;
        let percent = |arrived: f64, of: f64| (100.0 * (1.0 - arrived / of)).clamp(0.0, 100.0);
        Some([percent(heard, sent), percent(frames as f64, due)])
    }

    /// Takes new telemetry.
    pub(super) fn tell(&mut self, telemetry: &Telemetry) {
        let began = self.telemetry.is_some_and(|before| {
            telemetry.cycle < before.cycle || before.state == StateName::Starting
        });
        if began && telemetry.cycle == 0 && telemetry.state == StateName::Playing {
            // A new play starts at the origin of its own frame.
            self.trail.clear();
            self.overlay.clear();
        }
        let at = Vector2::new(telemetry.pose.x, telemetry.pose.y).cast();
        if self.trail.back() != Some(&at) {
            if self.trail.len() == TRAIL {
                self.trail.pop_front();
            }
            self.trail.push_back(at);
        }
        self.first
            .get_or_insert((*telemetry, [self.link.frames_sent, self.link.telemetry]));
        self.play = self.play.at(telemetry);
        self.telemetry = Some(*telemetry);
    }

    /// Takes a tracked pose in the tank's frame.
    pub(super) fn track(&mut self, tracked: &Pose<f64>) {
        if self.telemetry.is_some() {
            let predicted = self.predicted();
            self.overlay.push(tracked, &predicted);
        }
    }

    /// Pose by the robot's own prediction.
    fn predicted(&self) -> Pose<f64> {
        self.telemetry.map_or_else(Pose::identity, |telemetry| {
            Pose::new(
                f64::from(telemetry.pose.x),
                f64::from(telemetry.pose.y),
                f64::from(telemetry.pose.theta),
            )
        })
    }

    /// Draws it.
    pub(super) fn draw(&self, frame: &mut Frame<'_>) {
        if frame.area().height < 8 || frame.area().width < 30 {
            // Too small for panes: the state first, then as much of the rest as fits.
            frame.render_widget(Paragraph::new(self.state_lines()), frame.area());
            return;
        }
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
            // The state first, then the link, then the body: panes that do not fit are left out from below.
            let room = body.height;
            let state = room.min(10);
            let link = if room >= state + 5 {
                (room - state).min(9)
            } else {
                0
            };
            let pose = if room >= state + link + 6 {
                room - state - link
            } else {
                0
            };
            let [state, pose, link] =
                Layout::vertical([state, pose, link].map(Constraint::Length)).areas(body);
            self.state(frame, state);
            if pose.height > 0 {
                self.body(frame, pose);
            }
            if link.height > 0 {
                self.link(frame, link);
            }
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
}

#[cfg(test)]
mod tests;
