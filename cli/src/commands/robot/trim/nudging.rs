//! Both trims, the keys that change them, and the picture of it.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use link_protocol::{Joint, StateName};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::Paragraph;

use super::super::outputs;

/// A fine nudge: a tenth of a degree, a sixtieth of what the dead band of these servos hides.
const FINE_DEG: f64 = 0.1;
/// A coarse one, with Shift.
const COARSE_DEG: f64 = 1.0;
/// Largest trim.
const LARGEST_DEG: f64 = 30.0;

/// Action of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wish {
    /// This joint's trim has changed.
    Turn(Joint),
    /// Pulses on, or off.
    Power,
    /// Keep the trims.
    Save,
    /// Put them back.
    Leave,
}

/// Both trims while they are nudged \[degrees\].
#[derive(Debug)]
pub(super) struct Nudging {
    before: [f64; 2],
    now: [f64; 2],
    joint: Joint,
    /// State of the robot.
    pub(super) state: Option<StateName>,
}

impl Nudging {
    pub(super) fn new(before: [f64; 2]) -> Self {
        Self {
            before,
            now: before,
            joint: Joint::Front,
            state: None,
        }
    }

    /// The trim of a joint \[degrees\].
    pub(super) fn angle(&self, joint: Joint) -> f64 {
        let [front, back] = self.now;
        match joint {
            Joint::Front => front,
            Joint::Back => back,
        }
    }

    /// Takes a key.
    pub(super) fn press(&mut self, key: KeyEvent) -> Option<Wish> {
        if key.kind == KeyEventKind::Release {
            return None;
        }
        let step = if key.modifiers.contains(KeyModifiers::SHIFT) {
            COARSE_DEG
        } else {
            FINE_DEG
        };
        match key.code {
            KeyCode::Left => Some(self.turn(-step)),
            KeyCode::Right => Some(self.turn(step)),
            KeyCode::Tab | KeyCode::Up | KeyCode::Down => {
                self.joint = match self.joint {
                    Joint::Front => Joint::Back,
                    Joint::Back => Joint::Front,
                };
                None
            }
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => {
                Some(Wish::Leave)
            }
            KeyCode::Char('p') => Some(Wish::Power),
            KeyCode::Char('s') => Some(Wish::Save),
            KeyCode::Char('q') | KeyCode::Esc => Some(Wish::Leave),
            _ => None,
        }
    }

    fn turn(&mut self, step: f64) -> Wish {
        let [front, back] = &mut self.now;
        let angle = match self.joint {
            Joint::Front => front,
            Joint::Back => back,
        };
        // On the grid of fine steps, so that forth and back meet.
        let steps = ((*angle + step) / FINE_DEG).round();
        *angle = (steps * FINE_DEG).clamp(-LARGEST_DEG, LARGEST_DEG);
        Wish::Turn(self.joint)
    }

    pub(super) fn draw(&self, frame: &mut Frame<'_>) {
        let [area] = Layout::vertical([Constraint::Length(9)]).areas(frame.area());
        let powered = match self.state {
            None => "no telemetry received".to_owned(),
            Some(state @ (StateName::Stopped | StateName::EStopped)) => {
                format!("{}: no pulses; p powers the servos", outputs::state(state))
            }
            Some(state) => format!("{}: the servos have power", outputs::state(state)),
        };
        let mut text = vec![
            Line::from("Trim: nudge each servo until its joint is straight")
                .style(Style::new().add_modifier(Modifier::BOLD)),
            Line::from(format!("robot    {powered}")),
            Line::from(""),
        ];
        for (joint, name, before) in [
            (Joint::Front, "front φ₁", self.before[0]),
            (Joint::Back, "back  φ₂", self.before[1]),
        ] {
            let chosen = joint == self.joint;
            let style = if chosen {
                Style::new().fg(Color::Cyan).add_modifier(Modifier::BOLD)
            } else {
                Style::new()
            };
            let mark = if chosen { "▶" } else { " " };
            text.push(
                Line::from(format!(
                    "{mark} {name}  {:+6.1}°   (was {before:+.1}°)",
                    self.angle(joint)
                ))
                .style(style),
            );
        }
        text.extend([
            Line::from(""),
            Line::from("←/→ 0.1°   Shift+←/→ 1°   Tab other servo   p power on/off"),
            Line::from("s save and leave   q leave, trims as before"),
        ]);
        frame.render_widget(Paragraph::new(text), area);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    fn press(nudging: &mut Nudging, code: KeyCode, modifiers: KeyModifiers) -> Option<Wish> {
        nudging.press(KeyEvent::new(code, modifiers))
    }

    #[test]
    fn keys_nudge_the_chosen_servo() {
        let mut nudging = Nudging::new([0.0, -0.5]);
        let none = KeyModifiers::NONE;
        for _ in 0..3 {
            let wish = press(&mut nudging, KeyCode::Right, none);
            assert_eq!(wish, Some(Wish::Turn(Joint::Front)));
        }
        assert_eq!(press(&mut nudging, KeyCode::Tab, none), None);
        let wish = press(&mut nudging, KeyCode::Left, KeyModifiers::SHIFT);
        assert_eq!(wish, Some(Wish::Turn(Joint::Back)));
        let [front, back] = nudging.now;
        assert!((front - 0.3).abs() < 1e-12 && (back + 1.5).abs() < 1e-12);
        assert_eq!(
            press(&mut nudging, KeyCode::Char('p'), none),
            Some(Wish::Power)
        );
        assert_eq!(
            press(&mut nudging, KeyCode::Char('s'), none),
            Some(Wish::Save)
        );
        for (code, modifiers) in [
            (KeyCode::Char('q'), none),
            (KeyCode::Esc, none),
            (KeyCode::Char('c'), KeyModifiers::CONTROL),
        ] {
            assert_eq!(press(&mut nudging, code, modifiers), Some(Wish::Leave));
        }
    }

    #[test]
    fn a_trim_ends_at_thirty_degrees() {
        let mut nudging = Nudging::new([29.8, 0.0]);
        for _ in 0..5 {
            press(&mut nudging, KeyCode::Right, KeyModifiers::SHIFT);
        }
        assert!((nudging.angle(Joint::Front) - 30.0).abs() < 1e-12);
    }

    #[test]
    fn the_bench_in_a_picture() {
        let mut nudging = Nudging::new([0.0, -0.5]);
        nudging.state = Some(StateName::Holding);
        press(&mut nudging, KeyCode::Right, KeyModifiers::SHIFT);
        let mut terminal = Terminal::new(TestBackend::new(72, 9)).unwrap();
        terminal.draw(|frame| nudging.draw(frame)).unwrap();
        insta::assert_snapshot!(terminal.backend().to_string());
    }
}
