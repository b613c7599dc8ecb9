//! RAM that survives every reset except a power cut: a section that no start-up code clears. After power-on it is random, so
//! each record carries its own check.
//!
//! The watchdog's scratch registers, intended for this, do not survive the reset pin; this section does.

// SAFETY of the sections: `.uninit` is the section of cortex-m-rt for such variables, in RAM and without initial values.
#![allow(unsafe_code)]

use core::mem::MaybeUninit;

use gait_player::{CrashNote, ShortStarts};

/// Note of the last crash.
#[unsafe(link_section = ".uninit.crash")]
static mut NOTE: MaybeUninit<CrashNote> = MaybeUninit::uninit();

/// [`gait_player::Output::kept`] and its complement.
#[unsafe(link_section = ".uninit.kept")]
static mut KEPT: MaybeUninit<[u32; 2]> = MaybeUninit::uninit();

/// Encoded [`gait_player::Output::starts`].
#[unsafe(link_section = ".uninit.starts")]
static mut STARTS: MaybeUninit<[u8; ShortStarts::LEN]> = MaybeUninit::uninit();

/// Stores a note for the next start. Called with interrupts off, by code that does not return.
pub(crate) fn leave(note: CrashNote) {
    // SAFETY: the address of a static, and nothing else runs. Volatile, because no code of this run reads it.
    unsafe { (&raw mut NOTE).cast::<CrashNote>().write_volatile(note) }
}

/// Reads and clears the note. Called before any task runs.
pub(crate) fn take_note() -> CrashNote {
    let place = (&raw mut NOTE).cast::<CrashNote>();
    // SAFETY: the address of a static, and any bit pattern is a valid `CrashNote`. No task runs yet, and a crash does not
    // return. Volatile, because the content comes from before the reset.
    unsafe {
        let note = place.read_volatile();
        place.write_volatile(CrashNote::NONE);
        note
    }
}

/// Stores the word. Called only by the control task.
pub(crate) fn keep(word: u32) {
    // SAFETY: the address of a static; while tasks run, only the control task accesses it.
    unsafe {
        (&raw mut KEPT)
            .cast::<[u32; 2]>()
            .write_volatile([word, !word]);
    }
}

/// Word stored by [`keep`]; 0 if it is invalid. Called before any task runs.
pub(crate) fn kept() -> u32 {
    // SAFETY: as in `take_note`; any bit pattern is two words.
    let [word, complement] = unsafe { (&raw const KEPT).cast::<[u32; 2]>().read_volatile() };
    if word == !complement { word } else { 0 }
}

/// Stores the count of short starts. Called only by the control task.
pub(crate) fn keep_starts(starts: ShortStarts) {
    // SAFETY: as in `keep`.
    unsafe {
        (&raw mut STARTS)
            .cast::<[u8; ShortStarts::LEN]>()
            .write_volatile(starts.encode());
    }
}

/// Count stored by [`keep_starts`]. Returns `None` if it is invalid. Called before any task runs.
pub(crate) fn starts() -> Option<ShortStarts> {
    // SAFETY: as in `take_note`; any bit pattern is bytes.
    let record = unsafe {
        (&raw const STARTS)
            .cast::<[u8; ShortStarts::LEN]>()
            .read_volatile()
    };
    ShortStarts::decode(&record)
}
