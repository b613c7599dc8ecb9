//! Reply to a greeting: opens a session, or fails with a reason.

use std::time::Duration;

use link_protocol::{
    Binding, FirmwareVersion, HelloReply, HelloReplyStart, PROTOCOL_CURRENT, PROTOCOL_MIN,
    SCHEMA_KEY, Seal,
};

use super::beats::Beats;
use super::error::LinkError;
use super::{Event, Link, Owner, Session, describe};

impl Session {
    pub(super) fn greeted(&mut self, reply: HelloReply, now: Duration) {
        let Link::Greeting(greeting) = &self.link else {
            return;
        };
        if reply.host_nonce != greeting.nonce {
            self.counters.foreign += 1;
            return;
        }
        let ticket = greeting.ticket;
        let binding = Binding {
            boot_nonce: reply.boot_nonce,
            session: reply.session,
            host_nonce: greeting.nonce,
        };
        let since_first = now.saturating_sub(greeting.first_sent);
        if greeting.tries == 1 {
            self.trip.sample(since_first);
        } else {
            self.trip.bound(since_first);
        }
        self.last_heard = now;
        if let Err(error) = versions_meet(&HelloReplyStart::from(&reply)) {
            self.fail_greeting(error);
            return;
        }
        let restarted = self
            .boot_nonce
            .is_some_and(|nonce| nonce != reply.boot_nonce);
        if restarted {
            self.clock.clear();
        }
        self.boot_nonce = Some(reply.boot_nonce);
        if reply.session != self.number {
            self.disown_pending();
        }
        self.number = reply.session;
        self.seal = self.config.key.map(|key| Seal::new(&key, binding));
        (self.signed, self.proven) = (0, 0);
        (self.last_robot_us, self.latest_telemetry) = (None, None);
        self.beats = Beats::default();
        self.counters.sessions += 1;
        self.link = Link::Open(reply);
        if let Some(ticket) = ticket {
            self.events
                .push_back(Event::Connected { ticket, restarted });
        }
        if self.upload.is_some() {
            let doing = "uploading the gait";
            self.renew_upload(LinkError::NotConnected { doing });
        }
    }

    /// Handles a reply of which this program knows only the start. Number and nonce must both match, because less of it was
    /// checked.
    pub(super) fn greeted_by_unknown(
        &mut self,
        sequence: u16,
        start: &HelloReplyStart,
        now: Duration,
    ) {
        let Link::Greeting(greeting) = &self.link else {
            return;
        };
        if sequence != greeting.sequence || start.host_nonce != greeting.nonce {
            self.counters.foreign += 1;
            return;
        }
        self.last_heard = now;
        let firmware = firmware_name(&start.firmware);
        let newer = LinkError::UnknownGreeting { firmware };
        self.fail_greeting(versions_meet(start).err().unwrap_or(newer));
    }

    /// Fails the greeting for this reason, and the upload that needed the session.
    fn fail_greeting(&mut self, error: LinkError) {
        let Link::Greeting(greeting) = std::mem::replace(&mut self.link, Link::Closed) else {
            return;
        };
        match greeting.ticket {
            Some(ticket) => self.fail(ticket, error),
            None => self.end_upload(error),
        }
        self.fail_waiting();
    }

    /// Fails the pending request of an earlier session. It may have acted there and must not act again in this one. A stop may.
    fn disown_pending(&mut self) {
        if let Some(pending) = self.pending.take_if(|pending| !pending.request.is_stop())
            && let Owner::Ticket(ticket) = pending.owner
        {
            let doing = describe(&pending.request);
            self.fail(ticket, LinkError::SessionLost { doing });
        }
    }
}

fn versions_meet(reply: &HelloReplyStart) -> Result<(), LinkError> {
    let firmware = firmware_name(&reply.firmware);
    if reply.protocol_current < PROTOCOL_MIN || reply.protocol_min > PROTOCOL_CURRENT {
        return Err(LinkError::Version {
            robot_min: reply.protocol_min,
            robot_current: reply.protocol_current,
            host_min: PROTOCOL_MIN,
            host_current: PROTOCOL_CURRENT,
            firmware,
        });
    }
    if reply.protocol_current == PROTOCOL_CURRENT && reply.schema_key != SCHEMA_KEY {
        return Err(LinkError::Schema {
            version: PROTOCOL_CURRENT,
            robot_key: u64::from_be_bytes(reply.schema_key),
            host_key: u64::from_be_bytes(SCHEMA_KEY),
            firmware,
        });
    }
    Ok(())
}

/// Text of a firmware version, such as `1.2.3 (0123abcd)`.
pub(crate) fn firmware_name(firmware: &FirmwareVersion) -> String {
    let FirmwareVersion {
        major,
        minor,
        patch,
        commit,
    } = firmware;
    let commit: String = commit
        .iter()
        .map(|&byte| char::from(byte))
        .filter(char::is_ascii_hexdigit)
        .collect();
    if commit.is_empty() {
        format!("{major}.{minor}.{patch}")
    } else {
        format!("{major}.{minor}.{patch} ({commit})")
    }
}
