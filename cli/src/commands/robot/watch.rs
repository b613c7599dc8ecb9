//! `swimmer robot watch`: a screen on a terminal, a line each second elsewhere. It moves nothing unless a key says so.

mod source;

use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

use crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use experiment::Pose;
use link_protocol::Telemetry;
use pose_source::SourceName;
use ratatui::DefaultTerminal;

use super::Watch;
use super::access::{Access, BEAT, RobotConnection};
use super::dashboard::Dashboard;
use super::outputs::telemetry_line;
use super::playing::Playing;
use super::preflight::configured;
use super::tank_cameras::TankCameras;
use super::tracking::Tracking;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{Output, aside};
use source::{Beat, Source};

/// Robot time between two lines.
const LINE_EVERY: Duration = Duration::from_secs(1);
/// Time between two pictures.
const PICTURE_EVERY: Duration = Duration::from_millis(100);

/// Message at the end of the process that had the port.
const LET_GO: &str = "The program that had the port has let it go.";

/// `swimmer robot watch`; at the end, for scripts, the status.
pub(super) fn watch(access: &Access, arguments: &Watch, output: Output) -> Outcome {
    let interrupt = Interrupt::install_with_a_robot()?;
    if arguments.track == Some(SourceName::Twin) {
        return Err(Failure::BadInput(
            "a fresh virtual robot rests; `swimmer twin --pty LINK --natnet ADDR` makes one to watch by --track natnet:ADDR"
                .to_owned(),
        ));
    }
    let cameras = arguments
        .track
        .as_ref()
        .map(|source| arguments.visible.of(source));
    if let Some(cameras) = &cameras {
        cameras.check(access.is_fresh())?;
    }
    let mut source = Source::find(access)?;
    let mut tracking = match cameras {
        Some(cameras) => {
            let (introduction, _) = source.introduction()?;
            let (_, swimmer) = configured(&introduction.configuration);
            Some(cameras.open(TankCameras::default(), &swimmer.links)?)
        }
        None => None,
    };
    let end = arguments.seconds.map(Duration::from_secs_f64);
    if output.json || !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        lines(&mut source, &mut tracking, end, &interrupt, output)?;
        if output.json {
            return source.leave(output);
        }
        return source.close();
    }
    source.shows_silence();
    let dashboard = prepare(&mut source)?;
    let left = screen(&mut source, &mut tracking, dashboard, end, &interrupt)?;
    output.line(left);
    source.leave(output)
}

/// A line each second of the robot's time.
fn lines(
    source: &mut Source,
    tracking: &mut Option<Tracking>,
    end: Option<Duration>,
    interrupt: &Interrupt,
    output: Output,
) -> Outcome {
    let (begun, mut due) = (source.now(), 0);
    let mut pose = None;
    while !interrupt.requested() && end.is_none_or(|end| source.now().saturating_sub(begun) < end) {
        let beat = source.beat()?;
        pose = seen(tracking, source.now())?.pop().or(pose);
        match beat {
            Beat::Telemetry(telemetry) if telemetry.robot_us >= due => {
                due =
                    telemetry.robot_us + u64::try_from(LINE_EVERY.as_micros()).unwrap_or(u64::MAX);
                output
                    .line(&(telemetry_line(&telemetry) + &tracked(tracking.as_ref(), pose.take())));
            }
            Beat::Telemetry(_) | Beat::Nothing => {}
            Beat::OutOfReach(error) => return Err(error.into()),
            Beat::LetGo => {
                aside(LET_GO);
                break;
            }
        }
    }
    Ok(())
}

/// Poses of the middle link in the tank since the last call.
fn seen(tracking: &mut Option<Tracking>, now: Duration) -> Outcome<Vec<Pose>> {
    let Some(tracking) = tracking else {
        return Ok(Vec::new());
    };
    tracking.poses(now.as_secs_f64())
}

/// Tracked pose at the end of a line.
fn tracked(tracking: Option<&Tracking>, pose: Option<Pose>) -> String {
    match (tracking, pose) {
        (None, _) => String::new(),
        (Some(_), None) => "  not seen".to_owned(),
        (Some(_), Some(pose)) => format!(
            "  tracked x {:+8.2} mm  y {:+7.2} mm  θ {:+6.1}°",
            pose.x_m * 1e3,
            pose.y_m * 1e3,
            pose.heading_rad.to_degrees()
        ),
    }
}

/// Listens for this time on the port's clock, or until Ctrl-C.
pub(super) fn listen(
    line: &mut RobotConnection,
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

fn prepare(source: &mut Source) -> Outcome<Dashboard> {
    let (introduction, place) = source.introduction()?;
    let (name, swimmer) = configured(&introduction.configuration);
    let title = format!(
        "{} {place}, firmware {}, {name}",
        super::info::board(introduction.board),
        introduction.firmware,
    );
    Ok(Dashboard::new(
        title,
        swimmer.links,
        swimmer.sphere_radius,
        Playing::of(&introduction.status),
    ))
}

/// Action of a key.
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
    source: &mut Source,
    tracking: &mut Option<Tracking>,
    mut dashboard: Dashboard,
    end: Option<Duration>,
    interrupt: &Interrupt,
) -> Outcome<&'static str> {
    let mut terminal = ratatui::try_init().map_err(no_terminal)?;
    let shown = show(
        &mut terminal,
        source,
        tracking,
        &mut dashboard,
        end,
        interrupt,
    );
    ratatui::restore();
    shown
}

fn show(
    terminal: &mut DefaultTerminal,
    source: &mut Source,
    tracking: &mut Option<Tracking>,
    dashboard: &mut Dashboard,
    end: Option<Duration>,
    interrupt: &Interrupt,
) -> Outcome<&'static str> {
    let begun = source.now();
    let mut heard = begun;
    let mut drawn: Option<Instant> = None;
    let mut left = "Left the robot as it is.";
    loop {
        let beat = source.beat()?;
        // Before the telemetry is applied: the robot's counts are compared with the frames sent by then.
        (dashboard.link, dashboard.clock) = source.link();
        match beat {
            Beat::Telemetry(telemetry) => {
                heard = source.now();
                dashboard.tell(&telemetry);
            }
            Beat::Nothing => {}
            Beat::OutOfReach(_) => {
                // The screen stays, and says for how long.
                dashboard.note = "no answer: greeting again";
                if source.greet_again() {
                    dashboard.note = "";
                }
            }
            Beat::LetGo => return Ok(LET_GO),
        }
        let now = source.now();
        for pose in seen(tracking, now)? {
            dashboard.track(&pose.placed());
        }
        dashboard.silent = now.saturating_sub(heard);
        while event::poll(Duration::ZERO).map_err(no_terminal)? {
            let Event::Key(key) = event::read().map_err(no_terminal)? else {
                drawn = None;
                continue;
            };
            match wish(key) {
                Some(Wish::Leave) => return Ok(left),
                Some(Wish::Stop) => {
                    source.stop(false)?;
                    left = "The robot was stopped.";
                    dashboard.note = "stopped";
                }
                Some(Wish::EStop) => {
                    source.stop(true)?;
                    left = "The robot was e-stopped; `swimmer robot estop --clear` ends that.";
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
