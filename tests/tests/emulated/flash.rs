//! R9's other half: the power goes while flash is erased and programmed.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::StateName;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::rig;

/// What a store of one table costs: a sector erased and its pages programmed.
const STORE_BYTES: u32 = 4096 + 2304;

/// Ten cuts at random places of the erase and of the programming: the old or the new gait, never a mix, Stopped.
#[test]
fn a_power_cut_leaves_the_old_gait_or_the_new() {
    let Some(mut robot) = rig::robot() else {
        return;
    };
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut old = rig::circle(30.0);
    rig::upload(&mut robot, &old);
    rig::pass(&mut robot, Duration::from_secs(2)); // stored while stopped
    let stored = rig::events(&mut robot);
    assert!(stored.erased > 0 && stored.programmed > 0, "{stored:?}");
    let (mut kept, mut new_came) = (0, 0);
    for cut in 0..10 {
        let new = rig::circle(31.0 + f64::from(cut));
        let after = rng.random_range(0..STORE_BYTES);
        robot
            .port_mut()
            .device_mut()
            .board_mut()
            .cut_power_after(after)
            .unwrap();
        // The power may go before the robot has answered the last request.
        let _ = robot.upload(new.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        });
        rig::pass(&mut robot, Duration::from_secs(2));
        let events = rig::events(&mut robot);
        let was_cut = !events.power_cuts.is_empty();
        robot
            .port_mut()
            .device_mut()
            .board_mut()
            .power_cycle()
            .unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        assert_eq!(robot.status().unwrap().state, StateName::Stopped);
        let held = robot.table().unwrap().map(|table| table.crc32);
        println!(
            "cut after {after} bytes ({}): {held:08x?}",
            if was_cut { "cut" } else { "not reached" }
        );
        if held == Some(new.crc32()) {
            new_came += 1;
            old = new;
        } else {
            assert_eq!(
                held,
                Some(old.crc32()),
                "neither old nor new after {after} bytes"
            );
            kept += 1;
        }
    }
    println!("ten cuts: the old gait {kept} times, the new one {new_came} times");
    assert!(kept > 0, "no cut came in time to matter");
}
