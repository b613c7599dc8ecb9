//! What the page sees of the module: one buffer to write into, one to read from, one function between them.
//!
//! The page asks [`lab_input`] for room, writes the call's name and behind it the call's bytes, and calls [`lab_call`] with both
//! lengths. The answer lies at [`lab_output`], as long as [`lab_call`] said; [`lab_kind`] tells what it is. Both buffers stay
//! where they are until the next call, and memory may have grown: the page takes its view of it anew each time.
//!
//! No pointer is ever read on this side. What is unsafe is only that names are exported unmangled.
#![allow(unsafe_code)]

use std::cell::RefCell;

use crate::calls::{Answer, Lab, call};

/// The module's one state. A page calls from one thread.
#[derive(Default)]
struct Door {
    input: Vec<u8>,
    output: Vec<u8>,
    kind: u32,
    lab: Lab,
}

thread_local! {
    static DOOR: RefCell<Door> = RefCell::default();
}

/// Room for `length` bytes to write a call into.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_input(length: usize) -> *mut u8 {
    DOOR.with_borrow_mut(|door| {
        door.input.clear();
        door.input.resize(length, 0);
        door.input.as_mut_ptr()
    })
}

/// Performs the call that was written: `name` bytes of its name, then `bytes` bytes of what it takes. Returns the length of the
/// answer.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_call(name: usize, bytes: usize) -> usize {
    DOOR.with_borrow_mut(|door| {
        let name_and_bytes = door.input.get(..name.saturating_add(bytes));
        let (name, bytes) = name_and_bytes.map_or((&[][..], &[][..]), |all| all.split_at(name));
        (door.kind, door.output) = match call(&mut door.lab, name, bytes) {
            Ok(Answer::Json(text)) => (0, text.into_bytes()),
            Ok(Answer::Bytes(bytes)) => (1, bytes),
            Err(reason) => (2, reason.into_bytes()),
        };
        door.output.len()
    })
}

/// What the last answer is: 0 JSON, 1 bytes, 2 the reason why there is none.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_kind() -> u32 {
    DOOR.with_borrow(|door| door.kind)
}

/// Where the last answer lies.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_output() -> *const u8 {
    DOOR.with_borrow(|door| door.output.as_ptr())
}
