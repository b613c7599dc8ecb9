//! R9's other half: the power goes while a table arrives, and while flash is erased and programmed.

use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::Robot;
use link_protocol::StateName;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::promise::seen;
use crate::rig::{self, Port};

/// Bytes written by a store of one table: a sector erased and its pages programmed.
const STORE_BYTES: u32 = 4096 + 2304;
const MS: Duration = Duration::from_millis(1);

/// A robot with a gait in its flash.
fn robot_with(table: &GaitTable) -> Robot<Port> {
    let mut robot = rig::robot();
    rig::upload(&mut robot, table);
    rig::pass(&mut robot, 2000 * MS); // stored while stopped
    let stored = rig::events(&mut robot);
    assert!(stored.erased > 0 && stored.programmed > 0, "{stored:?}");
    robot
}

/// CRC of the table that a robot holds after it starts with this flash.
fn held(robot: &mut Robot<Port>) -> Option<u32> {
    rig::pass(robot, 100 * MS);
    robot.reconnect().unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    robot.table().unwrap().map(|table| table.crc32)
}

/// Ten cuts at random places of the erase and of the programming: the old or the new gait, never a mix, Stopped.
#[test]
fn a_power_cut_leaves_the_old_gait_or_the_new() {
    let mut old = rig::circle(30.0);
    let mut robot = robot_with(&old);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut kept, mut new_came, mut erasing) = (0, 0, 0);
    for cut in 0..10 {
        let new = rig::circle(31.0 + f64::from(cut));
        let after = rng.random_range(0..STORE_BYTES);
        rig::board_of(&mut robot).cut_power_after(after).unwrap();
        // The power may go before the robot has answered the last request.
        let _ = robot.upload(new.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        });
        rig::pass(&mut robot, 1000 * MS);
        assert_eq!(rig::events(&mut robot).power_cuts.len(), 1, "not reached");
        erasing += usize::from(after < 4096);
        rig::board_of(&mut robot).power_cycle().unwrap();
        let held = held(&mut robot);
        if held == Some(new.crc32()) {
            new_came += 1;
            old = new;
        } else {
            assert_eq!(held, Some(old.crc32()), "neither after {after} bytes");
            kept += 1;
        }
    }
    assert!(kept > 0, "no cut came in time to matter");
    seen(
        "R9, power cut at ten random places of storing a gait",
        &format!(
            "{erasing} while erasing, {} while programming: the old gait {kept} times, the new one {new_came} times, never \
             a mix, Stopped",
            10 - erasing
        ),
    );
}

/// Ten cuts while a table arrives: the old gait, and what is in flash boots on another board too.
#[test]
fn a_power_cut_during_an_upload_leaves_the_old_gait() {
    let old = rig::circle(30.0);
    let mut robot = robot_with(&old);
    let new = rig::circle(50.0);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..10 {
        let after = rng.random_range(0..new.bytes().len());
        let broken_off = robot.upload(new.bytes(), Duration::from_mins(1), |progress| {
            if progress.done >= after {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        assert!(broken_off.is_err());
        rig::board_of(&mut robot).power_cycle().unwrap();
        assert_eq!(held(&mut robot), Some(old.crc32()));
    }
    // The chip with this flash, in another board.
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("flash.bin");
    rig::board_of(&mut robot).save_flash(&image).unwrap();
    let mut other: Robot<Port> = rig::robot();
    assert_eq!(other.table().unwrap(), None);
    rig::board_of(&mut other).load_flash(&image).unwrap();
    assert_eq!(held(&mut other), Some(old.crc32()));
    seen(
        "R9, power cut at ten random places of an upload",
        "the old gait, Stopped; so does another board with that flash",
    );
}
