//! Promise R13, the brain's part: its size is a small share of 96 KiB.

#[test]
fn the_brain_is_small() {
    let bytes = size_of::<gait_player::Brain>();
    println!("R13: the brain takes {bytes} bytes (on a 64-bit host; less on the chip)");
    assert!(bytes <= 8 * 1024, "{bytes}");
}
