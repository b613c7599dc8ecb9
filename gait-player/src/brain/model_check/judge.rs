//! Safety invariants, checked after every transition.

use super::event::Event;
use super::world::StepObservations;
use link_protocol::{Request, ResetReason, StateName};

const OFF: [StateName; 2] = [StateName::Stopped, StateName::EStopped];

/// Panics if a step violates an invariant.
pub(super) fn judge(
    before: StateName,
    event: Event,
    requests: &[Request],
    seen: &StepObservations,
) {
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
    if let Some(acted) = &seen.acted {
        let refused = acted.needs.is_some_and(|needs| {
            needs.signature && !acted.ours
                || needs.freshness && !acted.attended
                || needs.presence && !seen.present
                || !needs.state.includes(acted.state)
        });
        assert!(
            !refused,
            "{event:?} {asked:?} acted against the table: {acted:?}"
        );
    }
    // No request bypasses presence, and no old keep-alive renews the lease.
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
    let context = || std::format!("{before:?}, {event:?} {asked:?}: {all:?}");
    let only = |allowed: &[StateName]| all.iter().all(|state| allowed.contains(state));
    if let Some(Request::EStop) = asked {
        assert!(only(&[EStopped]), "{}", context());
    }
    if let Some(Request::Stop) = asked {
        assert!(
            only(&[Stopping, Settling, Stopped, EStopped]),
            "{}",
            context()
        );
    }
    if let Event::Reset(reason) = event {
        let latched = before == EStopped && reason != ResetReason::PowerOn;
        let expected = if latched { EStopped } else { Stopped };
        assert!(only(&[expected]), "{}", context());
        return;
    }
    if seen.armed {
        // The host that arms is alive.
        assert!(seen.fresh, "{}", context());
        // Arming clears no e-stop.
        assert!(before != EStopped, "{}", context());
        return;
    }
    match before {
        // A live host of the open session may clear the e-stops that it counts.
        EStopped
            if matches!(
                (event, asked),
                (Event::Ask(_), Some(Request::ClearEStop { count: 0 }))
            ) && seen.fresh =>
        {
            assert!(only(&OFF), "{}", context());
        }
        EStopped => assert!(only(&[EStopped]), "{}", context()),
        Stopped => assert!(only(&OFF), "{}", context()),
        Stopping | Settling => {
            assert!(
                only(&[Stopping, Settling, Stopped, EStopped]),
                "{}",
                context()
            );
        }
        _ => {
            // A step that has stopped a powered robot does not start it again.
            let stopped = all.iter().position(|state| OFF.contains(state));
            let rest = stopped.map_or(&[][..], |at| &all[at..]);
            assert!(
                rest.iter().all(|state| OFF.contains(state)),
                "{} {after:?}",
                context()
            );
        }
    }
}
