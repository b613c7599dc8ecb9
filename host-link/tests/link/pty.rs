//! Pseudo-terminal as used by other programs: opened by path, closed, opened again.

use std::fs::{self, OpenOptions};
use std::io::{Read, Write};
use std::path::Path;
use std::time::Duration;

use host_link::Port;
use host_link::port::{OpenError, PtyError, PtyPort, SerialPort};

const MOMENT: Duration = Duration::from_secs(2);

fn read_exactly(port: &mut impl Port, count: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut buf = [0; 64];
    while bytes.len() < count {
        let got = port.read(&mut buf, MOMENT).unwrap();
        assert!(got > 0, "waited in vain after {bytes:?}");
        bytes.extend_from_slice(&buf[..got]);
    }
    bytes
}

#[test]
fn plain_programs_open_close_and_reopen_the_link() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let mut robot = PtyPort::open(Some(&link)).unwrap();
    let mut buf = [0; 64];
    robot.write(b"for nobody").unwrap();
    assert_eq!(robot.read(&mut buf, Duration::from_millis(10)).unwrap(), 0);
    assert!(!robot.client_present());
    // All bytes that a line discipline could change: end of line, interrupt, end of file, flow control, erase.
    let every: Vec<u8> = (0..=255).collect();
    for _ in 0..3 {
        let mut client = OpenOptions::new()
            .read(true)
            .write(true)
            .open(&link)
            .unwrap();
        client.write_all(&every).unwrap();
        assert_eq!(read_exactly(&mut robot, 256), every);
        assert!(robot.client_present());
        robot.write(&every).unwrap();
        let mut got = vec![0; 256];
        client.read_exact(&mut got).unwrap();
        // Only the robot's bytes: no echo of the client.
        assert_eq!(got, every);
        drop(client);
        assert_eq!(robot.read(&mut buf, Duration::from_millis(10)).unwrap(), 0);
        assert!(!robot.client_present());
    }
    drop(robot);
    assert!(
        fs::symlink_metadata(&link).is_err(),
        "the link is removed at exit"
    );
}

#[test]
fn a_serial_port_opens_it_alone_and_again() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let mut robot = PtyPort::open(Some(&link)).unwrap();
    let path = link.to_str().unwrap();
    for round in 0..3u8 {
        let mut host = SerialPort::open(path, 115_200).unwrap();
        assert!(matches!(
            SerialPort::open(path, 115_200),
            Err(OpenError::Busy { .. })
        ));
        host.write(&[round, 3, 4, 13, 10]).unwrap();
        assert_eq!(read_exactly(&mut robot, 5), [round, 3, 4, 13, 10]);
        robot.write(&[9, 17, 19, round]).unwrap();
        assert_eq!(read_exactly(&mut host, 4), [9, 17, 19, round]);
        drop(host);
        assert_eq!(
            robot.read(&mut [0; 8], Duration::from_millis(10)).unwrap(),
            0
        );
    }
}

#[test]
fn a_host_sees_the_robot_leave() {
    let robot = PtyPort::open(None).unwrap();
    let mut host = SerialPort::open(robot.path().to_str().unwrap(), 115_200).unwrap();
    drop(robot);
    assert!(host.read(&mut [0; 8], MOMENT).is_err());
}

#[test]
fn stale_links_are_replaced_and_other_files_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    std::os::unix::fs::symlink("/dev/pts/no-such-terminal", &link).unwrap();
    let first = PtyPort::open(Some(&link)).unwrap();
    assert_eq!(fs::read_link(&link).unwrap(), first.path());
    assert!(matches!(
        PtyPort::open(Some(&link)),
        Err(PtyError::InUse { .. })
    ));
    drop(first);
    fs::write(&link, "precious").unwrap();
    assert!(matches!(
        PtyPort::open(Some(&link)),
        Err(PtyError::Occupied(_))
    ));
    assert_eq!(fs::read_to_string(&link).unwrap(), "precious");
    let nowhere = Path::new("/no/such/folder/robot");
    assert!(matches!(
        PtyPort::open(Some(nowhere)),
        Err(PtyError::Link { .. })
    ));
}

/// A client that locks the terminal and is killed leaves its lock. Only an unprivileged user is affected: root ignores locks.
#[test]
fn a_lock_left_behind_does_not_lock_out_the_next_client() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let mut robot = PtyPort::open(Some(&link)).unwrap();
    for round in 0..3u8 {
        let mut client = OpenOptions::new()
            .read(true)
            .write(true)
            .open(&link)
            .unwrap();
        rustix::termios::ioctl_tiocexcl(&client).unwrap();
        client.write_all(&[round]).unwrap();
        assert_eq!(read_exactly(&mut robot, 1), [round]);
        drop(client);
        assert_eq!(
            robot.read(&mut [0; 8], Duration::from_millis(10)).unwrap(),
            0
        );
        assert_eq!(fs::read_link(&link).unwrap(), robot.path());
    }
    drop(robot);
    assert!(fs::symlink_metadata(&link).is_err());
}

/// A killed twin leaves its link, and the system may assign the terminal's number to another program.
#[test]
fn a_link_older_than_its_terminal_is_stale() {
    use rustix::fs::{AtFlags, CWD, Timespec, Timestamps, utimensat};
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let other = PtyPort::open(None).unwrap();
    std::os::unix::fs::symlink(other.path(), &link).unwrap();
    assert!(matches!(
        PtyPort::open(Some(&link)),
        Err(PtyError::InUse { .. })
    ));
    let long_ago = Timespec {
        tv_sec: 1_000_000_000,
        tv_nsec: 0,
    };
    let times = Timestamps {
        last_access: long_ago,
        last_modification: long_ago,
    };
    utimensat(CWD, &link, &times, AtFlags::SYMLINK_NOFOLLOW).unwrap();
    let robot = PtyPort::open(Some(&link)).unwrap();
    assert_eq!(fs::read_link(&link).unwrap(), robot.path());
    assert_ne!(robot.path(), other.path());
}
