//! What no step may do.

use super::event::Event;
use super::world::Seen;
use link_protocol::{Request, ResetReason, StateName};

const OFF: [StateName; 2] = [StateName::Stopped, StateName::EStopped];

/// What no step may do.
pub(super) fn judge(before: StateName, event: Event, requests: &[Request], seen: &Seen) {
    use StateName::{EStopped, Settling, Stopped, Stopping};
    let (all, after) = (&seen.states, *seen.states.last().unwrap());
    let asked = match event {
        Event::Ask(index)
        | Event::Late(index)
        | Event::Foreign(index)
        | Event::Unsigned(index)
        | Event::Elsewhere(index) => Some(&requests[index]),
        _ => None,
    };
    // Nobody talks himself past presence, nor feeds the lease with what is old.
    assert!(
        !seen.opened || seen.present,
        "{event:?} {asked:?}: opened by nobody at the robot"
    );
    assert!(
        !seen.fed
            || matches!(
                event,
                Event::KeepAlive
                    | Event::Pass {
                        kept_alive: true,
                        ..
                    }
            ),
        "{event:?} {asked:?} fed the lease"
    );
    let told = || std::format!("{before:?}, {event:?} {asked:?}: {all:?}");
    let only = |allowed: &[StateName]| all.iter().all(|state| allowed.contains(state));
    if let Some(Request::EStop) = asked {
        assert!(only(&[EStopped]), "{}", told());
    }
    if let Some(Request::Stop) = asked {
        assert!(only(&[Stopping, Settling, Stopped, EStopped]), "{}", told());
    }
    if let Event::Reset(reason) = event {
        let latched = before == EStopped && reason != ResetReason::PowerOn;
        let expected = if latched { EStopped } else { Stopped };
        assert!(only(&[expected]), "{}", told());
        return;
    }
    if seen.armed {
        // Whoever arms is there.
        assert!(seen.fresh, "{}", told());
        // An e-stop needs its flag.
        let cleared = matches!(asked, Some(Request::Arm(arm)) if arm.clear_estop);
        assert!(before != EStopped || cleared, "{}", told());
        return;
    }
    match before {
        // A host of the open session may clear it without arming.
        EStopped if matches!((event, asked), (Event::Ask(_), Some(Request::ClearEStop))) => {
            assert!(only(&OFF), "{}", told());
        }
        EStopped => assert!(only(&[EStopped]), "{}", told()),
        Stopped => assert!(only(&OFF), "{}", told()),
        Stopping | Settling => {
            assert!(only(&[Stopping, Settling, Stopped, EStopped]), "{}", told());
        }
        _ => {
            // Once a step has brought a powered robot to a stop, the same step does not take it out again.
            let stopped = all.iter().position(|state| OFF.contains(state));
            let rest = stopped.map_or(&[][..], |at| &all[at..]);
            assert!(
                rest.iter().all(|state| OFF.contains(state)),
                "{} {after:?}",
                told()
            );
        }
    }
}
