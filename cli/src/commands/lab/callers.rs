//! Connections of the server, in two kinds: callers that have not shown the token, of which the oldest makes way for the newest, and
//! pages with an open link. Callers, however many and however slow, keep no page out.

use std::collections::VecDeque;
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex};

use super::hub::PageId;
use crate::interrupt::locked;

/// Most callers at a time.
const MOST_CALLERS: usize = 48;
/// Most open links; a page needs one.
const MOST_PAGES: usize = 64;

/// Connections of a server.
#[derive(Debug, Clone, Default)]
pub(super) struct Callers(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    callers: VecDeque<(PageId, TcpStream)>,
    pages: usize,
}

/// Admission of a caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CallerAdmission {
    /// A page.
    Page,
    /// There are too many pages.
    None,
}

/// One connection; its place is free again when it is dropped.
#[derive(Debug)]
pub(super) struct Caller {
    id: PageId,
    is_page: bool,
    known: Callers,
}

impl Callers {
    /// Adds a connection. With too many, the oldest caller is cut off.
    pub(super) fn add(&self, id: PageId, stream: &TcpStream) -> Caller {
        let mut known = locked(&self.0);
        if known.callers.len() >= MOST_CALLERS
            && let Some((_, oldest)) = known.callers.pop_front()
        {
            let _ = oldest.shutdown(Shutdown::Both);
        }
        // One that cannot be cut off later is bounded by its own time limits.
        if let Ok(stream) = stream.try_clone() {
            known.callers.push_back((id, stream));
        }
        Caller {
            id,
            is_page: false,
            known: self.clone(),
        }
    }
}

impl Caller {
    pub(super) fn id(&self) -> PageId {
        self.id
    }

    /// It has shown the token: from now on it makes way for nobody.
    pub(super) fn becomes_page(&mut self) -> CallerAdmission {
        let mut known = locked(&self.known.0);
        known.callers.retain(|(id, _)| *id != self.id);
        if known.pages >= MOST_PAGES {
            return CallerAdmission::None;
        }
        known.pages += 1;
        self.is_page = true;
        CallerAdmission::Page
    }
}

impl Drop for Caller {
    fn drop(&mut self) {
        let mut known = locked(&self.known.0);
        known.callers.retain(|(id, _)| *id != self.id);
        known.pages -= usize::from(self.is_page);
    }
}
