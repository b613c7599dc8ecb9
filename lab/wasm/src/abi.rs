//! Binary interface between page and module: an input buffer, an output buffer, and a function that performs a call.
//!
//! The page gets a buffer from [`lab_input`], writes the name of the call followed by its bytes, and calls [`lab_call`] with both
//! lengths. The output is at [`lab_output`] and has the length that [`lab_call`] returned; [`lab_kind`] returns its kind. Both
//! buffers stay in place until the next call. Memory may have grown, so the page creates its view of it again each time.
//!
//! The module never reads a pointer. `unsafe` is needed only to export unmangled names.
#![allow(unsafe_code)]

use std::cell::RefCell;

use crate::calls::{CallOutput, Lab, call};

/// State of the module. A page calls from one thread.
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

/// Returns the input buffer, with `length` bytes.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_input(length: usize) -> *mut u8 {
    DOOR.with_borrow_mut(|door| {
        door.input.clear();
        door.input.resize(length, 0);
        door.input.as_mut_ptr()
    })
}

/// Performs the call in the input buffer: `name` bytes of its name, then `bytes` bytes of its arguments. Returns the length of
/// the output.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_call(name: usize, bytes: usize) -> usize {
    DOOR.with_borrow_mut(|door| {
        let name_and_bytes = door.input.get(..name.saturating_add(bytes));
        let (name, bytes) = name_and_bytes.map_or((&[][..], &[][..]), |all| all.split_at(name));
        (door.kind, door.output) = match call(&mut door.lab, name, bytes) {
            Ok(CallOutput::Json(text)) => (0, text.into_bytes()),
            Ok(CallOutput::Bytes(bytes)) => (1, bytes),
            Err(reason) => (2, reason.into_bytes()),
        };
        door.output.len()
    })
}

/// Kind of the last output: 0 JSON, 1 bytes, 2 an error message.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_kind() -> u32 {
    DOOR.with_borrow(|door| door.kind)
}

/// Address of the last output.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn lab_output() -> *const u8 {
    DOOR.with_borrow(|door| door.output.as_ptr())
}
