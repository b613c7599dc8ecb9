//! What outlives every reset but that of power: a section of RAM that no start-up code clears, and no reset either. After
//! power was off it holds anything, so all in it carries its own check.
//!
//! The watchdog's scratch registers, made for this, do not outlive the reset pin; this does.

// SAFETY of the sections: `.uninit` is cortex-m-rt's own for such variables, in RAM, and no initial value is asked for.
#![allow(unsafe_code)]

use core::mem::MaybeUninit;

use gait_player::{CrashNote, ShortStarts};

/// The last crash.
#[unsafe(link_section = ".uninit.crash")]
static mut NOTE: MaybeUninit<CrashNote> = MaybeUninit::uninit();

/// [`gait_player::Output::kept`] and its complement.
#[unsafe(link_section = ".uninit.kept")]
static mut KEPT: MaybeUninit<[u32; 2]> = MaybeUninit::uninit();

/// [`gait_player::Output::starts`], as its record.
#[unsafe(link_section = ".uninit.starts")]
static mut STARTS: MaybeUninit<[u8; ShortStarts::LEN]> = MaybeUninit::uninit();

/// Leaves a note for the next start. To be called with interrupts off, by what does not come back.
pub(crate) fn leave(note: CrashNote) {
    // SAFETY: a static's own address, and nothing else runs. Volatile, because the compiler sees nobody read it.
    unsafe { (&raw mut NOTE).cast::<CrashNote>().write_volatile(note) }
}

/// Takes the note, once. To be called before any task runs.
pub(crate) fn take_note() -> CrashNote {
    let place = (&raw mut NOTE).cast::<CrashNote>();
    // SAFETY: a static's own address, and any bits are a `CrashNote`; no task runs yet, and a crash does not come back.
    // Volatile, because the compiler cannot know what a reset left there.
    unsafe {
        let note = place.read_volatile();
        place.write_volatile(CrashNote::NONE);
        note
    }
}

/// Keeps a word. To be called by the control task alone.
pub(crate) fn keep(word: u32) {
    // SAFETY: a static's own address; once the tasks run, only the control task touches it.
    unsafe {
        (&raw mut KEPT)
            .cast::<[u32; 2]>()
            .write_volatile([word, !word]);
    }
}

/// The word that [`keep`] kept; 0 where there is none. To be called before any task runs.
pub(crate) fn kept() -> u32 {
    // SAFETY: as in `take_note`; any bits are two words.
    let [word, complement] = unsafe { (&raw const KEPT).cast::<[u32; 2]>().read_volatile() };
    if word == !complement { word } else { 0 }
}

/// Keeps the count of short starts. To be called by the control task alone.
pub(crate) fn keep_starts(starts: ShortStarts) {
    // SAFETY: as in `keep`.
    unsafe {
        (&raw mut STARTS)
            .cast::<[u8; ShortStarts::LEN]>()
            .write_volatile(starts.encode());
    }
}

/// The count that [`keep_starts`] kept; `None` where there is none. To be called before any task runs.
pub(crate) fn starts() -> Option<ShortStarts> {
    // SAFETY: as in `take_note`; any bits are bytes.
    let record = unsafe {
        (&raw const STARTS)
            .cast::<[u8; ShortStarts::LEN]>()
            .read_volatile()
    };
    ShortStarts::decode(&record)
}
