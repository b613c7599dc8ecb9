//! Settings in flash that cannot be read any more.

use std::path::Path;
use std::time::Duration;

use host_link::Robot;
use link_protocol::{Flags, Joint};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::promise::seen;
use crate::rig::{self, Port};

/// Where `memory.x` puts the settings, from the start of the flash.
const SETTINGS: std::ops::Range<usize> = 0x1f_c000..0x20_0000;

fn told(robot: &mut Robot<Port>) -> (i16, bool) {
    let failed = robot
        .status()
        .unwrap()
        .flags
        .contains(Flags::STORAGE_FAILED);
    (robot.servo(Joint::Front).unwrap().trim, failed)
}

/// Whatever the flash came to hold there, the robot comes up, says that something is lost, and keeps what is set anew.
#[test]
fn settings_that_are_garbage_are_told_and_can_be_set_anew() {
    for fill in [Fill::Noise, Fill::Zeros] {
        let Some(mut robot) = rig::robot() else {
            return;
        };
        robot.trim(Joint::Front, 0.02).unwrap();
        rig::pass(&mut robot, Duration::from_secs(2)); // stored while stopped
        let folder = tempfile::tempdir().unwrap();
        let image = folder.path().join("flash.bin");
        rig::board_of(&mut robot).save_flash(&image).unwrap();
        spoil(&image, fill);
        rig::board_of(&mut robot).load_flash(&image).unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        assert_eq!(told(&mut robot), (0, true), "{fill:?}");
        robot.trim(Joint::Front, 0.03).unwrap();
        rig::pass(&mut robot, Duration::from_secs(3));
        robot.reconnect().unwrap();
        assert_eq!(told(&mut robot), (300, false), "{fill:?}");
        rig::board_of(&mut robot).power_cycle().unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        assert_eq!(told(&mut robot), (300, false), "{fill:?}");
    }
    seen(
        "settings in flash overwritten with noise, with zeros",
        "the robot comes up and tells that they are lost; what is set anew is stored and outlives a power cycle",
    );
}

#[derive(Debug, Clone, Copy)]
enum Fill {
    Noise,
    Zeros,
}

fn spoil(image: &Path, fill: Fill) {
    let mut flash = std::fs::read(image).unwrap();
    let settings = &mut flash[SETTINGS];
    match fill {
        Fill::Noise => ChaCha8Rng::seed_from_u64(7).fill_bytes(settings),
        Fill::Zeros => settings.fill(0),
    }
    std::fs::write(image, flash).unwrap();
}
