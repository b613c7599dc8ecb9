//! Frames out of any bytes: no panic, every run of bytes between zeros counted once, and the same whatever the split.
#![no_main]

use libfuzzer_sys::fuzz_target;
use link_protocol::{Decoder, Message};

fuzz_target!(|bytes: &[u8]| {
    let mut decoder = Decoder::new();
    let received: Vec<_> = bytes
        .iter()
        .filter_map(|&byte| decoder.push(byte))
        .collect();
    let counters = decoder.counters();
    let understood = received
        .iter()
        .filter(|received| received.message.is_ok())
        .count();
    assert_eq!(understood, counters.ok as usize);

    // A run that no zero has ended is counted only where it is too long already.
    let open_overflow = bytes
        .rsplit(|&byte| byte == 0)
        .next()
        .is_some_and(|run| run.len() > link_protocol::MAX_RAW + 1);
    let ended = bytes
        .split(|&byte| byte == 0)
        .filter(|run| !run.is_empty())
        .count()
        - usize::from(bytes.last().is_some_and(|&byte| byte != 0));
    let counted = (counters.ok + counters.bad()) as usize;
    assert_eq!(counted, ended + usize::from(open_overflow));

    // A decoded message can be encoded again, and is decoded the same.
    for message in received
        .into_iter()
        .filter_map(|received| received.message.ok())
    {
        again(&message);
    }
});

fn again(message: &Message) {
    let frame = swimmer_fuzz::wire::frame(link_protocol::Header::new(1, 2), message);
    let mut decoder = Decoder::new();
    let said: Vec<_> = frame
        .iter()
        .filter_map(|&byte| decoder.push(byte))
        .collect();
    assert_eq!(said.len(), 1);
    // NaN differs from itself.
    let same = format!("{:?}", said[0].message.as_ref().ok()) == format!("{:?}", Some(message));
    assert!(same, "{message:?} is said as {:?}", said[0].message);
}
