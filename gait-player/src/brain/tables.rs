//! Gait tables in memory: the active table plays; an upload fills the staging table, and a swap makes it active.

use crate::GaitTable;
use crate::table::check::{Checker, Facts};
use crate::table::{KNOT_BYTES, MIN_KNOTS};
use link_protocol::{Begin, Chunk, MAX_TABLE, Play, Refusal, TableInfo};

/// Active table, staging table and upload.
#[derive(Clone)]
pub(crate) struct Tables {
    pair: [GaitTable; 2],
    active: Option<Active>,
    upload: Option<Upload>,
    swap: Option<Swap>,
}

/// State of the active table.
#[derive(Clone)]
struct Active {
    index: usize,
    crc32: u32,
    /// Check results; `None` until the table is checked for the present geometry.
    facts: Option<Facts>,
    checker: Checker,
}

#[derive(Clone, Copy)]
struct Upload {
    number: u16,
    len: u16,
    crc32: u32,
    /// Number of bytes received without a gap.
    wanted: u16,
}

/// Checked table that waits for the end of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Swap {
    pub(crate) facts: Facts,
    pub(crate) way: SwapWay,
}

/// Transition of the play to the swapped table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SwapWay {
    /// By a ramp at the end of the present cycle. The requested play continues.
    Ramp { via_neutral: bool },
    /// Immediately at the end of the last cycle, as the follower's own play.
    Follow(Play),
}

impl Tables {
    pub(crate) const fn new() -> Self {
        Self {
            pair: [const { GaitTable::empty() }; 2],
            active: None,
            upload: None,
            swap: None,
        }
    }

    /// Both buffers, to be loaded from storage.
    pub(crate) fn buffers(&mut self) -> &mut [GaitTable; 2] {
        &mut self.pair
    }

    /// Makes a loaded buffer the active table. It is checked before it plays.
    pub(crate) fn activate_loaded(&mut self, index: usize) {
        let crc32 = self.pair[index % 2].crc32();
        self.active = Some(Active {
            index: index % 2,
            crc32,
            facts: None,
            checker: Checker::new(),
        });
    }

    pub(crate) fn active(&self) -> Option<&GaitTable> {
        self.active.as_ref().map(|active| &self.pair[active.index])
    }

    /// CRC-32C of the active table.
    pub(crate) fn active_crc32(&self) -> Option<u32> {
        self.active.as_ref().map(|active| active.crc32)
    }

    /// Check results of the active table. Returns `None` until it is checked.
    pub(crate) fn facts(&self) -> Option<Facts> {
        self.active.as_ref().and_then(|active| active.facts)
    }

    /// Invalidates the check results after a change of geometry.
    pub(crate) fn forget_facts(&mut self) {
        if let Some(active) = &mut self.active {
            active.facts = None;
            active.checker = Checker::new();
        }
    }

    /// Does some of the pending check of the active table.
    pub(crate) fn check_active(&mut self, links: &swimmer_model::Links<f32>, work: u32) {
        if let Some(active) = &mut self.active
            && active.facts.is_none()
        {
            active.facts = active
                .checker
                .advance(&self.pair[active.index], links, work);
        }
    }

    fn staging_index(&self) -> usize {
        self.active.as_ref().map_or(0, |active| 1 - active.index)
    }

    /// Table that an upload fills.
    pub(crate) fn staging(&self) -> &GaitTable {
        &self.pair[self.staging_index()]
    }

    pub(crate) fn swap(&self) -> Option<Swap> {
        self.swap
    }

    /// Schedules the checked staging table for the end of a cycle.
    pub(crate) fn wait_for_swap(&mut self, swap: Swap) {
        self.swap = Some(swap);
        self.upload = None;
    }

    /// Makes the staging table active.
    pub(crate) fn activate_staging(&mut self, facts: Facts) {
        let index = self.staging_index();
        let crc32 = self.pair[index].crc32();
        self.active = Some(Active {
            index,
            crc32,
            facts: Some(facts),
            checker: Checker::new(),
        });
        self.upload = None;
        self.swap = None;
    }

    /// Identity of a table.
    pub(crate) fn info(
        &self,
        stored: bool,
        min_period_us: impl Fn(&Facts) -> u32,
    ) -> Option<TableInfo> {
        self.active.as_ref().map(|active| TableInfo {
            knots: self.pair[active.index].knots() as u16,
            crc32: active.crc32,
            stored,
            min_period_us: active.facts.as_ref().map_or(0, min_period_us),
        })
    }

    /// Number of bytes received by the open upload.
    pub(crate) fn uploaded(&self) -> Option<u16> {
        self.upload.map(|upload| upload.wanted)
    }

    /// Opens an upload under a number, or resumes the one with the same content. Returns the next expected offset.
    pub(crate) fn begin(&mut self, number: u16, begin: Begin) -> Result<u16, Refusal> {
        let Begin { slot, len, crc32 } = begin;
        if slot != 0 {
            return Err(Refusal::NoSuchSlot(slot));
        }
        let bytes = usize::from(len);
        if !bytes.is_multiple_of(KNOT_BYTES)
            || !(MIN_KNOTS * KNOT_BYTES..=MAX_TABLE).contains(&bytes)
        {
            return Err(Refusal::BadLength(len));
        }
        if self.swap.is_some() {
            return Err(Refusal::SwapPending);
        }
        let mut wanted = match self.upload {
            Some(open) if (open.len, open.crc32) == (len, crc32) => open.wanted,
            _ => 0,
        };
        let staging = self.staging_index();
        if wanted == 0 {
            self.pair[staging].clear(len / KNOT_BYTES as u16);
            // The active table again, perhaps because the reply to its commit was lost: all bytes are present.
            if let Some(active) = &self.active
                && active.crc32 == crc32
                && self.pair[active.index].bytes().len() == bytes
            {
                self.pair[staging] = self.pair[active.index].clone();
                wanted = len;
            }
        }
        self.upload = Some(Upload {
            number,
            len,
            crc32,
            wanted,
        });
        Ok(wanted)
    }

    /// Stores a chunk; returns the next expected offset.
    pub(crate) fn chunk(&mut self, chunk: &Chunk) -> Result<u16, Refusal> {
        let staging = self.staging_index();
        let upload = self
            .upload
            .as_mut()
            .filter(|upload| upload.number == chunk.upload)
            .ok_or(Refusal::NoUpload)?;
        let wanted = upload.wanted;
        let end = usize::from(chunk.offset) + chunk.data.len();
        if end > usize::from(upload.len) {
            return Err(Refusal::ChunkOutOfRange { wanted });
        }
        // Received bytes stay. A chunk after a gap must be sent again.
        if let Some(held) = wanted.checked_sub(chunk.offset)
            && let Some(new) = chunk.data.get(usize::from(held)..)
        {
            self.pair[staging].put(usize::from(wanted), new);
            upload.wanted = end as u16;
        }
        Ok(upload.wanted)
    }

    /// Checks that all bytes have arrived and match the announced checksum.
    pub(crate) fn complete(&self, number: u16) -> Result<(), Refusal> {
        let upload = self
            .upload
            .filter(|upload| upload.number == number)
            .ok_or(Refusal::NoUpload)?;
        if upload.wanted < upload.len {
            return Err(Refusal::Incomplete {
                wanted: upload.wanted,
            });
        }
        let received = self.staging().crc32();
        if received != upload.crc32 {
            return Err(Refusal::CrcMismatch {
                expected: upload.crc32,
                received,
            });
        }
        Ok(())
    }

    /// Drops the upload, and a table that waits for the end of a cycle.
    pub(crate) fn abandon(&mut self) {
        self.upload = None;
        self.swap = None;
    }
}
