//! `swimmer robot watch`: a screen on a terminal, a line each second elsewhere. It moves nothing unless a key says so.

use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

use crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use host_link::{LinkError, Port as _};
use link_protocol::Telemetry;
use ratatui::DefaultTerminal;

use super::Watch;
use super::access::{Access, BEAT, Line};
use super::answers::{Doing, telemetry_line};
use super::dashboard::Dashboard;
use super::playing::Playing;
use super::port::Pace;
use super::preflight::configured;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Robot time between two lines.
const LINE_EVERY: Duration = Duration::from_secs(1);
/// Time between two pictures.
const PICTURE_EVERY: Duration = Duration::from_millis(100);

/// `swimmer robot watch`; at the end, for scripts, the status.
pub(super) fn watch(access: &Access, arguments: &Watch, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut line = access.connect("swimmer robot watch", Pace::RealTime)?;
    let end = arguments.seconds.map(Duration::from_secs_f64);
    if output.json || !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        lines(&mut line, end, &interrupt, output)?;
        let status = line.robot.status()?;
        if output.json {
            output.answer(&Doing::new(&status));
        }
        return line.close();
    }
    let dashboard = prepare(&mut line)?;
    let left = screen(&mut line, dashboard, end, &interrupt)?;
    let status = line.robot.status()?;
    output.line(&format!("{left}\n{}", Doing::new(&status)));
    line.close()
}

/// A line each second of the robot's time.
fn lines(line: &mut Line, end: Option<Duration>, interrupt: &Interrupt, output: Output) -> Outcome {
    let mut due = 0;
    listen(line, end, interrupt, |telemetry| {
        if telemetry.robot_us >= due {
            due = telemetry.robot_us + u64::try_from(LINE_EVERY.as_micros()).unwrap_or(u64::MAX);
            output.line(&telemetry_line(telemetry));
        }
    })
}

/// Listens for so long on the port's clock, or until Ctrl-C.
pub(super) fn listen(
    line: &mut Line,
    end: Option<Duration>,
    interrupt: &Interrupt,
    mut each: impl FnMut(&Telemetry),
) -> Outcome {
    let mut left = end;
    while !interrupt.requested() && left.is_none_or(|left| !left.is_zero()) {
        if let Some(telemetry) = line.beat()? {
            each(&telemetry);
        }
        left = left.map(|left| left.saturating_sub(BEAT));
    }
    Ok(())
}

fn prepare(line: &mut Line) -> Outcome<Dashboard> {
    let configuration = line.robot.configuration()?;
    let (name, swimmer) = configured(&configuration);
    let status = line.robot.status()?;
    let title = format!(
        "{} at {}, firmware {}, {name}",
        super::info::board(line.robot.info().board),
        line.name(),
        line.robot.firmware(),
    );
    Ok(Dashboard::new(
        title,
        swimmer.links,
        swimmer.sphere_radius,
        Playing::of(&status),
    ))
}

/// What a key asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    Leave,
    Stop,
    EStop,
}

fn wish(key: KeyEvent) -> Option<Wish> {
    if key.kind == KeyEventKind::Release {
        return None;
    }
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Wish::Leave),
        KeyCode::Char('q') | KeyCode::Esc => Some(Wish::Leave),
        KeyCode::Char('s') => Some(Wish::Stop),
        KeyCode::Char('e') => Some(Wish::EStop),
        _ => None,
    }
}

/// Draws until `q`; the terminal is as before afterwards, whatever happens. Returns what to say of the robot that is left.
fn screen(
    line: &mut Line,
    mut dashboard: Dashboard,
    end: Option<Duration>,
    interrupt: &Interrupt,
) -> Outcome<&'static str> {
    let mut terminal = ratatui::try_init().map_err(no_terminal)?;
    let shown = show(&mut terminal, line, &mut dashboard, end, interrupt);
    ratatui::restore();
    shown
}

fn show(
    terminal: &mut DefaultTerminal,
    line: &mut Line,
    dashboard: &mut Dashboard,
    end: Option<Duration>,
    interrupt: &Interrupt,
) -> Outcome<&'static str> {
    let begun = line.robot.port().now();
    let mut heard = begun;
    let mut drawn: Option<Instant> = None;
    let mut left = "Left the robot as it is.";
    loop {
        let beaten = line.beat();
        // Before the telemetry is told: what the robot has heard is held against what was sent by then.
        dashboard.link = line.robot.link_counters();
        dashboard.clock = line.robot.clock();
        match beaten {
            Ok(Some(telemetry)) => {
                heard = line.robot.port().now();
                dashboard.tell(&telemetry);
            }
            Ok(None) => {}
            Err(error @ LinkError::Port { .. }) => return Err(error.into()),
            Err(_) => {
                // Out of reach for now: the screen stays, and says for how long.
                dashboard.note = "no answer: greeting again";
                if line.robot.reconnect().is_ok() {
                    dashboard.note = "";
                }
            }
        }
        let now = line.robot.port().now();
        dashboard.silent = now.saturating_sub(heard);
        while event::poll(Duration::ZERO).map_err(no_terminal)? {
            let Event::Key(key) = event::read().map_err(no_terminal)? else {
                drawn = None;
                continue;
            };
            match wish(key) {
                Some(Wish::Leave) => return Ok(left),
                Some(Wish::Stop) => {
                    line.robot.stop()?;
                    left = "The robot was stopped.";
                    dashboard.note = "stopped";
                }
                Some(Wish::EStop) => {
                    line.robot.estop()?;
                    left =
                        "The robot was e-stopped; only `swimmer robot arm --clear-estop` ends it.";
                    dashboard.note = "e-stopped";
                }
                None => {}
            }
            drawn = None;
        }
        if interrupt.requested() || end.is_some_and(|end| now.saturating_sub(begun) >= end) {
            return Ok(left);
        }
        if drawn.is_none_or(|drawn| drawn.elapsed() >= PICTURE_EVERY) {
            terminal
                .draw(|frame| dashboard.draw(frame))
                .map_err(no_terminal)?;
            drawn = Some(Instant::now());
        }
    }
}

#[allow(clippy::needless_pass_by_value, reason = "as map_err hands it over")]
pub(super) fn no_terminal(error: io::Error) -> Failure {
    Failure::Tried(format!(
        "cannot draw on this terminal: {error}; pipe the output elsewhere for plain lines"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_mean_what_the_footer_says() {
        let press = |code| wish(KeyEvent::new(code, KeyModifiers::NONE));
        assert_eq!(press(KeyCode::Char('q')), Some(Wish::Leave));
        assert_eq!(press(KeyCode::Char('s')), Some(Wish::Stop));
        assert_eq!(press(KeyCode::Char('e')), Some(Wish::EStop));
        assert_eq!(press(KeyCode::Char('c')), None);
        let ctrl_c = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(wish(ctrl_c), Some(Wish::Leave));
    }
}
