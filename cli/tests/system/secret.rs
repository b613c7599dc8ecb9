//! A robot's key stays in its file: no log, trace, error or answer of a command holds its bytes or its digits.

use std::fs;
use std::path::Path;

use link_protocol::{Direction, Key, Message, Request};
use swimmer_files::{parse_key, read_link_log};

use crate::binary::{Ran, TwinProcess, swimmer_in};

/// Forms in which the key could be read back from an artefact.
fn forms(key: Key) -> Vec<Vec<u8>> {
    let digits = |byte: &u8| format!("{byte:02x}");
    let hexadecimal: String = key.0.iter().map(digits).collect();
    let list = |separator: &str| key.0.map(|byte| byte.to_string()).join(separator);
    vec![
        key.0.to_vec(),
        key.0.iter().rev().copied().collect(),
        hexadecimal.to_uppercase().into_bytes(),
        list(",").into_bytes(),
        list(", ").into_bytes(),
        // COBS cuts a key at its zeros: the longest piece is enough to find it.
        key.0
            .split(|byte| *byte == 0)
            .max_by_key(|piece| piece.len())
            .unwrap()
            .to_vec(),
        hexadecimal.into_bytes(),
    ]
}

fn holds(bytes: &[u8], key: Key) -> bool {
    let tight: Vec<u8> = bytes
        .iter()
        .copied()
        .filter(|byte| !byte.is_ascii_whitespace())
        .collect();
    forms(key).iter().any(|form| {
        [bytes, &tight]
            .iter()
            .any(|bytes| bytes.windows(form.len()).any(|window| window == form))
    })
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    entries
        .flat_map(|entry| match entry.file_type().unwrap() {
            kind if kind.is_dir() => files(&entry.path()),
            kind if kind.is_file() => vec![entry.path()],
            _ => Vec::new(), // the twin's port
        })
        .collect()
}

#[test]
fn no_artefact_holds_the_key() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let mut said: Vec<Ran> = Vec::new();
    let mut run = |line: &str, status: i32| {
        let words: Vec<&str> = line.split(' ').collect();
        let ran = swimmer_in(folder.path(), &[&["robot"], &words[..]].concat()).with_status(status);
        said.push(ran);
    };
    // A new key; the same robot with it and without it; another key, unsigned and signed; a file that holds too much.
    run(
        "key make one.key --log make.mcap --port robot --verbose --json",
        0,
    );
    run(
        "status --key one.key --log status.mcap --port robot --verbose",
        0,
    );
    run("arm --log refused.mcap --port robot --verbose --json", 1);
    fs::write(
        folder.path().join("two.key"),
        "a1b2c3d4e5f60718293a4b5c6d7e8f91\n",
    )
    .unwrap();
    run(
        "key set two.key --log unsigned.mcap --port robot --verbose",
        1,
    );
    run(
        "key set two.key --key one.key --log set.mcap --port robot --verbose --json",
        0,
    );
    fs::write(
        folder.path().join("bad.key"),
        "a1b2c3d4e5f60718293a4b5c6d7e8f91a1b2c3d4e5f60718293a4b5c6d7e8f91\n",
    )
    .unwrap();
    run(
        "key set bad.key --key two.key --port robot --verbose --json",
        2,
    );
    run(
        "key clear --key two.key --log clear.mcap --port robot --verbose",
        0,
    );

    let keys = ["one.key", "two.key"].map(|name| {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        parse_key(&text).unwrap()
    });
    assert!(holds(
        &fs::read(folder.path().join("two.key")).unwrap(),
        keys[1]
    ));
    for key in keys {
        for ran in &said {
            assert!(!holds(format!("{ran}").as_bytes(), key), "{ran}");
        }
        let artefacts: Vec<_> = files(folder.path())
            .into_iter()
            .filter(|path| path.extension().is_none_or(|ending| ending != "key"))
            .collect();
        assert!(artefacts.len() >= 5, "{artefacts:?}");
        for path in artefacts {
            assert!(!holds(&fs::read(&path).unwrap(), key), "{}", path.display());
        }
    }
    // The frames that carried the keys are in their logs, whole, with zeros in place of them. Without a key the host gives up
    // before it sends one.
    for (name, carries_a_key) in [
        ("make.mcap", true),
        ("unsigned.mcap", false),
        ("set.mcap", true),
    ] {
        let log = read_link_log(&folder.path().join(name)).unwrap();
        let zeros = Message::Request(Request::SetKey(Some(Key([0; Key::LEN]))));
        let sent = log.frames.iter().filter(|frame| {
            frame.direction == Direction::ToRobot
                && frame
                    .received()
                    .is_some_and(|received| received.message.as_ref() == Ok(&zeros))
        });
        assert_eq!(sent.count() > 0, carries_a_key, "{name}");
        for frame in &log.frames {
            for key in keys {
                assert!(!holds(
                    format!("{frame:?} {:?}", frame.received()).as_bytes(),
                    key
                ));
                assert!(!holds(&frame.bytes, key));
            }
        }
    }
}
