//! NatNet over UDP on the loopback interface.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use pose_source::natnet::{COMMAND_PORT, NatNetSocket, Scene, Server};
use pose_source::{Received, Settings, SourceName, Stream};

use crate::frames::{assert_same, next, seen};

/// A server that streams frames in a circle, each 5 ms, until it is dropped.
struct Streaming {
    address: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Streaming {
    fn start(port: u16, multicast: bool) -> Self {
        let scene = Scene {
            body: "robot".to_owned(),
            markers: vec!["Front".to_owned(), "Back".to_owned()],
        };
        let server = Server::new(scene, multicast);
        let mut socket =
            NatNetSocket::bind(SocketAddrV4::new(Ipv4Addr::LOCALHOST, port), server).unwrap();
        let address = socket.local_addr().unwrap().to_string();
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let thread = thread::spawn(move || {
            let (begun, frames) = (Instant::now(), seen(2000, 5));
            for frame in &frames {
                let now_s = begun.elapsed().as_secs_f64();
                socket.reply(now_s);
                socket.send(frame, frame.stamp_s + 0.002, now_s);
                if stopped.load(Ordering::SeqCst) {
                    return;
                }
                thread::sleep(Duration::from_millis(5));
            }
        });
        Self {
            address,
            stop,
            thread: Some(thread),
        }
    }
}

impl Drop for Streaming {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

/// Reads until frames are named, then compares with those that were sent.
fn reads(source: &str) {
    let name: SourceName = source.parse().unwrap();
    let stream = Stream::open(&name, &Settings::default()).unwrap();
    let sent = seen(2000, 5);
    let mut compared = 0;
    for _ in 0..400 {
        let frame = next(&stream);
        let original = sent
            .iter()
            .find(|sent| (sent.stamp_s - frame.stamp_s).abs() < 1e-5)
            .unwrap();
        if frame.markers.iter().any(|marker| marker.name.is_some()) {
            assert_same(original, &frame, 1e-6);
            compared += 1;
        }
        if compared == 100 {
            let tallies = stream.tallies();
            assert_eq!(tallies.malformed, 0);
            let description = tallies.description.unwrap();
            assert!(description.contains("swimmer twin") && description.contains("NatNet 4.1"));
            return;
        }
    }
    panic!("only {compared} frames have names");
}

#[test]
fn unicast() {
    let server = Streaming::start(0, false);
    reads(&format!("natnet:{}", server.address));
}

/// The group's port and the command port are Motive's own: one test has both, so that no other is in its way.
#[test]
fn multicast_named_and_discovered() {
    let server = Streaming::start(COMMAND_PORT, true);
    reads(&format!("natnet:{},127.0.0.1", server.address));
    drop(server);
    let server = Streaming::start(COMMAND_PORT, true);
    let name = SourceName::NatNet(pose_source::NatNetAddress {
        host: None,
        local: Some(Ipv4Addr::LOCALHOST),
    });
    let stream = Stream::open(&name, &Settings::default()).unwrap();
    assert!(next(&stream).stamp_s > 0.0);
    drop((stream, server));
}

/// Nobody at the command port: the reason names what to look at.
#[test]
fn a_silent_server_is_named() {
    let free = std::net::UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let address = free.local_addr().unwrap();
    let name: SourceName = format!("natnet:{address}").parse().unwrap();
    let stream = Stream::open(&name, &Settings::default()).unwrap();
    match stream.next(Duration::from_secs(20)) {
        Received::Ended(Err(error)) => {
            let text = error.to_string();
            assert!(
                text.contains(&address.to_string()) && text.contains("firewall"),
                "{text}"
            );
        }
        other => panic!("{other:?}"),
    }
}
