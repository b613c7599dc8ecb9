//! Promise R9, second half: a power cut at any byte of a store leaves the old table or the new one, never a mix. Settings and
//! tables are restored after a restart.
use crate::bench;

use bench::*;
use gait_player::storage::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};
use gait_player::{Brain, GaitTable, ShortStarts};
use link_protocol::*;

/// NOR flash that loses power after a number of bytes: the current operation stops there.
#[derive(Clone)]
struct Flash {
    slots: [Vec<u8>; SLOTS],
    settings: Option<Vec<u8>>,
    starts: Option<[u8; ShortStarts::LEN]>,
    /// Writes of the settings fail.
    settings_broken: bool,
    /// Reads of the settings fail.
    settings_unreadable: bool,
    /// Slot whose reads fail.
    unreadable: Option<usize>,
    /// Bytes until the power is cut.
    left: usize,
    spent: usize,
}

#[derive(Debug, PartialEq)]
struct PowerCut;

impl Flash {
    fn new() -> Self {
        let slot = vec![0xFF; SLOT_PAGES * PAGE];
        Self {
            slots: [slot.clone(), slot],
            settings: None,
            starts: None,
            settings_broken: false,
            settings_unreadable: false,
            unreadable: None,
            left: usize::MAX,
            spent: 0,
        }
    }

    fn spend(&mut self) -> Result<(), PowerCut> {
        self.left = self.left.checked_sub(1).ok_or(PowerCut)?;
        self.spent += 1;
        Ok(())
    }
}

impl Storage for Flash {
    type Error = PowerCut;

    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), PowerCut> {
        if self.unreadable == Some(slot) {
            return Err(PowerCut);
        }
        bytes.copy_from_slice(&self.slots[slot][offset..offset + bytes.len()]);
        Ok(())
    }

    fn erase(&mut self, slot: usize) -> Result<(), PowerCut> {
        for at in 0..SLOT_PAGES * PAGE {
            self.spend()?;
            self.slots[slot][at] = 0xFF;
        }
        Ok(())
    }

    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), PowerCut> {
        for (at, byte) in bytes.iter().enumerate() {
            self.spend()?;
            let place = &mut self.slots[slot][page * PAGE + at];
            assert_eq!(*place, 0xFF, "programmed without an erase");
            *place = *byte;
        }
        Ok(())
    }

    fn load_settings(&mut self, bytes: &mut [u8; MAX_SETTINGS]) -> Result<Option<usize>, PowerCut> {
        if self.settings_unreadable {
            return Err(PowerCut);
        }
        Ok(self.settings.as_ref().map(|settings| {
            bytes[..settings.len()].copy_from_slice(settings);
            settings.len()
        }))
    }

    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, PowerCut> {
        if let Some(starts) = &self.starts {
            *bytes = *starts;
        }
        Ok(self.starts.is_some())
    }

    fn save_starts(&mut self, bytes: &[u8; ShortStarts::LEN]) -> Result<(), PowerCut> {
        // Atomic: a separate part of the flash.
        self.starts = Some(*bytes);
        Ok(())
    }

    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), PowerCut> {
        // Atomic: the settings have a store of their own.
        self.spend()?;
        if self.settings_broken {
            return Err(PowerCut);
        }
        self.settings = Some(bytes.to_vec());
        self.settings_unreadable = false;
        Ok(())
    }
}

/// Starts the robot after a run of full length.
fn boot(flash: &mut Flash) -> Bench {
    flash.starts = None;
    let mut brain = Brain::new(config());
    brain.load(flash).unwrap();
    let mut bench = Bench::around(brain);
    bench.greet(1);
    bench
}

/// Serves the storage until nothing is left to do, or the power is cut.
fn serve(bench: &mut Bench, flash: &mut Flash) -> Result<(), PowerCut> {
    // Settings, an erase, eight pages of table, the header; twice.
    for _ in 0..24 {
        if !bench.tick().storage_wanted {
            return Ok(());
        }
        bench.brain.serve_storage(bench.now_us, flash)?;
    }
    panic!("the brain wants to store without end");
}

fn stored(bench: &mut Bench) -> Option<(u32, bool)> {
    bench
        .status()
        .table
        .map(|table| (table.crc32, table.stored))
}

#[test]
fn a_table_comes_back_after_a_restart_and_plays() {
    let mut flash = Flash::new();
    let mut bench = boot(&mut flash);
    assert_eq!(stored(&mut bench), None);
    for amplitude in [1.0, 1.1, 1.2, 0.9] {
        let table = circle(amplitude);
        bench.upload(&table);
        assert_eq!(stored(&mut bench), Some((table.crc32(), false)));
        assert!(bench.status().flags.contains(Flags::UNSAVED));
        serve(&mut bench, &mut flash).unwrap();
        assert_eq!(stored(&mut bench), Some((table.crc32(), true)));
        bench = boot(&mut flash);
        assert_eq!(stored(&mut bench), Some((table.crc32(), true)));
    }
    bench.done(ARM);
    bench.done(play(1, 5_000_000));
    bench.until(StateName::Playing, 2 * SECOND);
    // The knots are compared too, not only the checksum.
    let first = circle(0.9).knot_angles(0);
    assert!((0..2).all(|joint| (bench.output.setpoint[joint] - first[joint]).abs() < 1e-6));
}

#[test]
fn settings_come_back_after_a_restart() {
    let mut flash = Flash::new();
    let mut bench = boot(&mut flash);
    bench.done(Request::Trim {
        joint: Joint::Back,
        trim: -120,
    });
    let Reply::Configuration(mut configuration) = bench.ask(Request::Configuration) else {
        panic!()
    };
    configuration.max_angle = 2.0;
    configuration.chi = 2.5;
    bench.done(Request::Configure(configuration));
    serve(&mut bench, &mut flash).unwrap();
    let mut bench = boot(&mut flash);
    assert_eq!(
        bench.ask(Request::Configuration),
        Reply::Configuration(configuration)
    );
    let Reply::Servo(servo) = bench.ask(Request::Servo(Joint::Back)) else {
        panic!()
    };
    assert_eq!(servo.trim, -120);
    assert!((bench.greet(3).limits.max_angle - 2.0).abs() < 1e-6);
}

#[test]
fn r9_a_power_cut_at_any_byte_leaves_the_old_table_or_the_new_one() {
    let (old, new) = (
        circle(1.2),
        GaitTable::from_fn(100, |u| [0.3 * (std::f64::consts::TAU * u).sin(), 0.1]).unwrap(),
    );
    let mut flash = Flash::new();
    let mut bench = boot(&mut flash);
    // Both slots are in use, so an older table is overwritten.
    for table in [&new, &old] {
        bench.upload(table);
        serve(&mut bench, &mut flash).unwrap();
    }
    let before = flash.clone();
    let mut whole = before.clone();
    whole.spent = 0;
    let mut bench = boot(&mut whole);
    bench.upload(&circle(0.7));
    serve(&mut bench, &mut whole).unwrap();
    let bytes = whole.spent;
    let mut seen = [0; 2];
    for cut in 0..=bytes {
        let mut flash = Flash {
            left: cut,
            ..before.clone()
        };
        let mut bench = boot(&mut flash);
        bench.upload(&circle(0.7));
        assert_eq!(serve(&mut bench, &mut flash).is_ok(), cut == bytes);
        flash.left = usize::MAX;
        let mut after = boot(&mut flash);
        let (crc32, stored) = stored(&mut after).unwrap();
        assert!(stored);
        let is_new = crc32 == circle(0.7).crc32();
        assert!(is_new || crc32 == old.crc32(), "a mix after {cut} bytes");
        seen[usize::from(is_new)] += 1;
        assert_eq!(after.status().state, StateName::Stopped);
        // The next upload is stored normally.
        if cut % 512 == 0 {
            after.upload(&new);
            serve(&mut after, &mut flash).unwrap();
            assert_eq!(boot(&mut flash).status().table.unwrap().crc32, new.crc32());
        }
    }
    println!(
        "R9: power cut after each of {bytes} bytes: {} times the old table, {} times the new, no mix",
        seen[0], seen[1]
    );
    assert!(seen[0] > 2_000 && seen[1] >= 1);
}

#[test]
fn nothing_is_stored_unless_stopped_and_a_failure_is_retried_a_second_later() {
    let mut flash = Flash::new();
    let mut bench = boot(&mut flash);
    bench.upload(&circle(1.2));
    bench.done(ARM);
    assert!(!bench.tick().storage_wanted);
    bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    assert_eq!(flash.spent, 0);
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, SECOND);
    assert!(bench.tick().storage_wanted);
    // An arm interrupts the store; the table is stored afterwards.
    bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    assert!(flash.spent > 0);
    bench.done(ARM);
    bench.tick();
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, SECOND);
    flash.left = 10;
    assert_eq!(serve(&mut bench, &mut flash), Err(PowerCut));
    flash.left = usize::MAX;
    bench.tick();
    assert!(!bench.output.storage_wanted && bench.status().flags.contains(Flags::STORAGE_FAILED));
    bench.run(SECOND);
    serve(&mut bench, &mut flash).unwrap();
    assert!(!bench.status().flags.contains(Flags::STORAGE_FAILED));
    assert_eq!(
        boot(&mut flash).status().table.unwrap().crc32,
        circle(1.2).crc32()
    );
}

#[test]
fn settings_that_cannot_be_stored_do_not_keep_a_table_from_it() {
    let mut flash = Flash::new();
    flash.settings_broken = true;
    let mut bench = boot(&mut flash);
    bench.done(Request::Trim {
        joint: Joint::Back,
        trim: 100,
    });
    bench.upload(&circle(1.2));
    for _ in 0..5 {
        assert_eq!(serve(&mut bench, &mut flash), Err(PowerCut));
        bench.run(SECOND);
    }
    assert_eq!(stored(&mut bench), Some((circle(1.2).crc32(), true)));
    assert!(bench.status().flags.contains(Flags::UNSAVED));
    flash.settings_broken = false;
    serve(&mut bench, &mut flash).unwrap();
    assert!(!bench.status().flags.contains(Flags::UNSAVED));
    let mut bench = boot(&mut flash);
    assert_eq!(bench.status().table.unwrap().crc32, circle(1.2).crc32());
}

#[test]
fn a_table_committed_in_the_middle_of_a_store_is_the_one_that_is_stored() {
    let mut flash = Flash::new();
    let mut bench = boot(&mut flash);
    bench.upload(&circle(1.2));
    for _ in 0..4 {
        bench.tick();
        bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    }
    bench.upload(&circle(0.4));
    serve(&mut bench, &mut flash).unwrap();
    assert_eq!(
        boot(&mut flash).status().table.unwrap().crc32,
        circle(0.4).crc32()
    );
}

#[test]
fn a_slot_that_cannot_be_read_leaves_the_other_ones_table() {
    let mut flash = Flash::new();
    let mut bench = boot(&mut flash);
    let tables = [circle(1.0), circle(1.2)];
    for table in &tables {
        bench.upload(table);
        serve(&mut bench, &mut flash).unwrap();
    }
    for (slot, table) in tables.iter().enumerate() {
        flash.unreadable = Some(1 - slot);
        let mut brain = Brain::new(config());
        assert_eq!(brain.load(&mut flash), Err(PowerCut), "it is told");
        let mut bench = Bench::around(brain);
        bench.greet(1);
        assert_eq!(stored(&mut bench), Some((table.crc32(), true)));
        assert!(bench.status().flags.contains(Flags::STORAGE_FAILED));
    }
}

/// Settings that are unreadable, or invalid under the limits, are reported until they are set and stored again.
#[test]
fn settings_that_are_lost_are_told_and_set_anew() {
    for unreadable in [true, false] {
        let mut flash = Flash::new();
        flash.settings = Some(vec![0xA5; 40]);
        flash.settings_unreadable = unreadable;
        let mut brain = Brain::new(config());
        assert_eq!(brain.load(&mut flash).is_err(), unreadable);
        let mut bench = Bench::around(brain);
        bench.greet(1);
        assert!(bench.status().flags.contains(Flags::STORAGE_FAILED));
        bench.run(5 * SECOND);
        assert!(
            !bench.output.storage_wanted && bench.status().flags.contains(Flags::STORAGE_FAILED)
        );
        bench.done(Request::Trim {
            joint: Joint::Back,
            trim: 77,
        });
        serve(&mut bench, &mut flash).unwrap();
        assert!(!bench.status().flags.contains(Flags::STORAGE_FAILED));
        let mut bench = boot(&mut flash);
        let Reply::Servo(servo) = bench.ask(Request::Servo(Joint::Back)) else {
            panic!()
        };
        assert_eq!(servo.trim, 77);
        assert!(!bench.status().flags.contains(Flags::STORAGE_FAILED));
    }
}

/// Header of a slot: magic, format, generation, length, CRC of the table, CRC of these.
fn header(words: [u32; 5]) -> Vec<u8> {
    let mut bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
    bytes.extend(crc32c(&bytes).to_le_bytes());
    bytes
}

#[test]
fn a_slot_counts_only_where_every_word_of_its_header_is_right() {
    let table = circle(1.2);
    let good = [
        u32::from_le_bytes(*b"GAIT"),
        1,
        7,
        u32::try_from(table.bytes().len()).unwrap(),
        table.crc32(),
    ];
    let loaded = |header: &[u8], table: &[u8]| {
        let mut flash = Flash::new();
        flash.slots[0][..header.len()].copy_from_slice(header);
        flash.slots[0][PAGE..PAGE + table.len()].copy_from_slice(table);
        let mut bench = boot(&mut flash);
        bench.run(SECOND);
        stored(&mut bench)
    };
    let whole = Some((table.crc32(), true));
    assert_eq!(loaded(&header(good), table.bytes()), whole);
    // Another magic, a later format, and invalid lengths, each with a correct checksum.
    for (word, value) in [
        (0, good[0] ^ 1),
        (1, 2),
        (3, 2_044),
        (3, 2_050),
        (3, 2_052),
        (3, u32::MAX),
        (4, good[4] ^ 1),
    ] {
        let mut words = good;
        words[word] = value;
        assert_eq!(loaded(&header(words), table.bytes()), None, "{words:?}");
    }
    // Zero knots or one knot form no table, whatever the checksum.
    for len in [0, 4] {
        let (mut words, bytes) = (good, &table.bytes()[..len]);
        (words[3], words[4]) = (u32::try_from(len).unwrap(), crc32c(bytes));
        assert_eq!(loaded(&header(words), bytes), None, "{len} bytes");
    }
    let mut broken = header(good);
    broken[23] ^= 1;
    assert_eq!(loaded(&broken, table.bytes()), None);
}

#[test]
fn settings_are_stored_before_a_table_and_after_it_where_they_fail() {
    for broken in [false, true] {
        let mut flash = Flash::new();
        let mut bench = boot(&mut flash);
        flash.settings_broken = broken;
        bench.upload(&circle(1.2));
        bench.done(Request::Trim {
            joint: Joint::Front,
            trim: 7,
        });
        bench.tick();
        let first = bench.brain.serve_storage(bench.now_us, &mut flash);
        assert_eq!(
            (first.is_ok(), flash.settings.is_some()),
            (!broken, !broken)
        );
        assert!(flash.slots.iter().flatten().all(|byte| *byte == 0xFF));
        bench.run(2 * SECOND);
        for _ in 0..20 {
            let _ = bench.brain.serve_storage(bench.now_us, &mut flash);
        }
        assert_eq!(stored(&mut bench), Some((circle(1.2).crc32(), true)));
    }
}
