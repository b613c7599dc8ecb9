//! Settings in flash that cannot be read any more, and a chip that takes its time.

use std::path::Path;
use std::time::Duration;

use host_link::Robot;
use link_protocol::{Flags, Joint};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::promise::seen;
use crate::rig::{self, Port};

/// Location of the settings in `memory.x`, from the start of the flash.
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
        let mut robot = rig::robot();
        robot.trim(Joint::Front, 0.01).unwrap();
        rig::pass(&mut robot, Duration::from_secs(2)); // stored while stopped
        let folder = tempfile::tempdir().unwrap();
        let image = folder.path().join("flash.bin");
        rig::board_of(&mut robot).save_flash(&image).unwrap();
        spoil(&image, fill);
        rig::board_of(&mut robot).load_flash(&image).unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        assert_eq!(told(&mut robot), (0, true), "{fill:?}");
        robot.trim(Joint::Front, 0.015).unwrap(); // within the degree that needs no presence
        rig::pass(&mut robot, Duration::from_secs(3));
        robot.reconnect().unwrap();
        assert_eq!(told(&mut robot), (150, false), "{fill:?}");
        rig::board_of(&mut robot).power_cycle().unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        assert_eq!(told(&mut robot), (150, false), "{fill:?}");
    }
    seen(
        "settings in flash overwritten with noise, with zeros",
        "the robot comes up and tells that they are lost; what is set anew is stored and outlives a power cycle",
    );
}

/// Maximum in the data sheets of flash chips for one sector; 45 ms are usual.
const SLOWEST_ERASE: Duration = Duration::from_millis(400);
/// Bytes of a rotation, as counted for cuts: a sector erased, and some twenty times a page programmed for a few bytes.
const ROTATION_BYTES: u32 = 4096 + 20 * 256;

/// One call may erase several sectors, each of them nearly as long as the watchdog waits: where nothing can be read, and
/// where the power went while the oldest sector was cleared for new records.
#[test]
fn the_slowest_erase_brings_no_watchdog_reset() {
    let mut robot = rig::robot();
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("flash.bin");
    let mut trims = std::iter::successors(Some(0.0), |trim| Some((trim + 0.001) % 0.016)).skip(1);
    let mut save = |robot: &mut Robot<Port>, wait: Duration| {
        let stored = robot.trim(Joint::Front, trims.next().unwrap());
        rig::pass(robot, wait);
        stored
    };

    // Somebody at the robot may write as often as he likes.
    rig::come_near(&mut robot);
    // As it was before the record that made the first sector be erased.
    rig::events(&mut robot);
    let mut before = 0;
    loop {
        rig::board_of(&mut robot).save_flash(&image).unwrap();
        save(&mut robot, Duration::from_millis(60)).unwrap();
        let events = rig::events(&mut robot);
        if events.erased > 0 {
            break;
        }
        before += 1;
        assert!(before < 1000, "the settings' sectors never fill");
    }
    let board = rig::board_of(&mut robot);
    board.set_erase_time(SLOWEST_ERASE).unwrap();
    let (mut cuts, mut most) = (0, 0);
    for after in (100..ROTATION_BYTES).step_by(600) {
        rig::board_of(&mut robot).load_flash(&image).unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        rig::events(&mut robot);
        rig::board_of(&mut robot).cut_power_after(after).unwrap();
        let _ = save(&mut robot, Duration::from_secs(1)); // the power may go before it is answered
        let cut = rig::events(&mut robot);
        assert!(cut.resets.is_empty(), "{after}: {:?}", cut.resets);
        cuts += cut.power_cuts.len();
        rig::board_of(&mut robot).power_cycle().unwrap();
        rig::pass(&mut robot, Duration::from_secs(1));
        robot.reconnect().unwrap();
        save(&mut robot, Duration::from_millis(1500)).unwrap();
        robot.reconnect().unwrap();
        let events = rig::events(&mut robot);
        assert!(events.resets.is_empty(), "{after}: {:?}", events.resets);
        most = most.max(events.erased);
        assert!(!told(&mut robot).1, "{after}: settings lost");
    }
    assert!(
        cuts > 10 && most > 1,
        "{cuts} cuts were reached, {most} sectors erased"
    );

    rig::board_of(&mut robot).save_flash(&image).unwrap();
    spoil(&image, Fill::Zeros);
    rig::board_of(&mut robot).load_flash(&image).unwrap();
    rig::pass(&mut robot, Duration::from_secs(2));
    robot.reconnect().unwrap();
    save(&mut robot, Duration::from_secs(3)).unwrap();
    robot.reconnect().unwrap();
    let events = rig::events(&mut robot);
    assert!(events.resets.is_empty(), "{:?}", events.resets);
    assert!(!told(&mut robot).1);
    seen(
        "settings on a flash chip that takes 400 ms a sector: power cut at each 600th byte of a rotation; all overwritten with zeros",
        &format!(
            "no reset by the watchdog: {cuts} cuts with up to {most} sectors erased after them, {} in one go after the zeros",
            events.erased
        ),
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
