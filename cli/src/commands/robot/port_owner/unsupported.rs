//! Systems without local sockets: no announcement, no requests, and no second program bypasses the first.

use std::fmt;

use host_link::Robot;
use host_link::testing::MockPort;

use super::super::port::AnyPort;
use super::halt_signal::HaltSignal;
use super::relay::{PortRequest, Relayed, Unanswered};
use crate::failure::Outcome;

/// Holds the port without an announcement.
pub(in super::super) struct PortHolder;

impl PortHolder {
    /// Holds the port without an announcement.
    pub(in super::super) fn announce(_port: &str, _command: &str) -> Self {
        Self
    }

    /// Never set.
    pub(in super::super) fn halts(&self) -> HaltSignal {
        HaltSignal::default()
    }

    /// Always `false`.
    pub(in super::super) fn asked(&mut self) -> bool {
        false
    }

    /// Always empty.
    pub(in super::super) fn take_requests(&mut self) -> Vec<(PortRequest, Requester)> {
        Vec::new()
    }

    /// Does nothing.
    pub(in super::super) fn serve(&mut self, _robot: &mut Robot<AnyPort>) {}
}

/// Process with a request. Unreachable on this platform.
pub(in super::super) enum Requester {}

impl Requester {
    /// Cannot be.
    pub(in super::super) fn answer(self, _answer: &Relayed) {
        match self {}
    }
}

/// Another `swimmer`, which cannot be known here.
pub(in super::super) enum HeldBy {}

impl HeldBy {
    /// Nobody is known.
    pub(in super::super) fn of(_port: &str) -> Option<Self> {
        None
    }

    /// Cannot be.
    pub(in super::super) fn ask(&self, _ask: PortRequest) -> Outcome<Option<Relayed>> {
        match *self {}
    }

    /// Cannot be.
    pub(in super::super) fn try_request(
        &self,
        _ask: PortRequest,
    ) -> Result<Option<Relayed>, Unanswered> {
        match *self {}
    }

    /// Cannot be.
    pub(in super::super) fn occupied(&self) -> Option<MockPort> {
        match *self {}
    }

    /// Cannot be.
    pub(in super::super) fn end(&self) -> Outcome {
        match *self {}
    }

    /// Cannot be.
    pub(in super::super) fn hangs(&self) -> String {
        match *self {}
    }

    /// Cannot be.
    pub(in super::super) fn process(&self) -> &str {
        match *self {}
    }
}

impl fmt::Display for HeldBy {
    fn fmt(&self, _f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {}
    }
}
