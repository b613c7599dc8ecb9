//! JSON lines over TCP.

use std::io::Write as _;
use std::net::TcpListener;
use std::thread;

use pose_source::{Settings, SourceName, Stream};

use crate::frames::all;

#[test]
fn lines_of_a_script_are_frames() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let script = thread::spawn(move || {
        let (mut client, _) = listener.accept().unwrap();
        for number in 0..50 {
            let line = format!(
                "{{\"t\": {number}e-2, \"points\": {{\"Front\": [0.{number:02}, 0.5]}}}}\n"
            );
            let (one, other) = line.split_at(line.len() / 2);
            client.write_all(one.as_bytes()).unwrap();
            client.write_all(other.as_bytes()).unwrap();
            if number == 30 {
                client
                    .write_all(b"Traceback (most recent call last):\n")
                    .unwrap();
            }
        }
    });
    let name: SourceName = format!("tcp:{address}").parse().unwrap();
    let stream = Stream::open(&name, &Settings::default()).unwrap();
    let frames = all(&stream);
    script.join().unwrap();
    assert_eq!(frames.len(), 50);
    assert!((frames[42].marker("Front").unwrap().x_m - 0.42).abs() < 1e-12);
    let tallies = stream.tallies();
    assert_eq!(tallies.malformed, 1);
    assert!(tallies.last_malformed.unwrap().contains("line 32"));
}

#[test]
fn a_refused_connection_says_what_to_do() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let name: SourceName = format!("tcp:{address}").parse().unwrap();
    let error = Stream::open(&name, &Settings::default()).unwrap_err();
    assert!(error.to_string().contains("start the script"), "{error}");
}
