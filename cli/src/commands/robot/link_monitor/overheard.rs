//! Facts about the robot from the frames that others exchange with it: greeting, configuration, tables, requests to play.

use std::collections::VecDeque;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::session::{ClockFit, ClockSamples};
use link_protocol::{
    Configuration, Decoder, Header, HelloReply, Message, Play, Pong, Reply, Request, Telemetry,
};

/// Tables that are remembered; the robot holds one.
const MOST_TABLES: usize = 8;

/// Keep-alives without a reply that are remembered; most are answered within a few.
const MOST_BEATS: usize = 64;

/// Keep-alive on its way to the robot.
struct Beat {
    /// Time on the clock of its sender \[µs\].
    host_us: u64,
    /// Time on the port's clock.
    sent: Duration,
}

/// Upload under way.
struct Upload {
    bytes: Vec<u8>,
    crc32: u32,
}

/// Facts from the frames so far.
#[derive(Default)]
pub(super) struct Overheard {
    from_robot: Decoder,
    to_robot: Decoder,
    pub(super) hello: Option<HelloReply>,
    pub(super) configuration: Option<Configuration>,
    upload: Option<Upload>,
    /// The latest table is the first.
    tables: VecDeque<GaitTable>,
    /// Frame of the latest request to play: a session repeats it until the reply arrives.
    last_play: Option<Header>,
    beats: VecDeque<Beat>,
    clock: ClockSamples,
}

impl Overheard {
    /// Takes bytes of the robot that arrived now. Returns the telemetry in them.
    pub(super) fn take_reply(&mut self, now: Duration, bytes: &[u8]) -> Vec<Telemetry> {
        let mut telemetry = Vec::new();
        for byte in bytes {
            let Some(received) = self.from_robot.push(*byte) else {
                continue;
            };
            match received.message {
                Ok(Message::Telemetry(report)) => telemetry.push(report),
                Ok(Message::Pong(pong)) => self.pong(pong, now),
                Ok(Message::HelloReply(hello)) => self.hello = Some(hello),
                Ok(Message::Reply(Reply::Configuration(configuration))) => {
                    self.configuration = Some(configuration);
                }
                _ => {}
            }
        }
        telemetry
    }

    /// Takes frames that were sent to the robot now. Returns the last new request to play in them.
    pub(super) fn take_request(&mut self, now: Duration, frames: &[u8]) -> Option<Play> {
        let mut requested = None;
        for byte in frames {
            let Some(received) = self.to_robot.push(*byte) else {
                continue;
            };
            let request = match received.message {
                Ok(Message::Request(request)) => request,
                Ok(Message::Heartbeat(beat)) => {
                    self.beats.push_front(Beat {
                        host_us: beat.host_us,
                        sent: now,
                    });
                    self.beats.truncate(MOST_BEATS);
                    continue;
                }
                _ => continue,
            };
            match request {
                // An upload of the same table goes on where it was.
                Request::Begin(begin)
                    if self
                        .upload
                        .as_ref()
                        .is_none_or(|upload| upload.crc32 != begin.crc32) =>
                {
                    self.upload = Some(Upload {
                        bytes: vec![0; begin.len.into()],
                        crc32: begin.crc32,
                    });
                }
                Request::Chunk(chunk) => {
                    let from = usize::from(chunk.offset);
                    let place = self
                        .upload
                        .as_mut()
                        .and_then(|upload| upload.bytes.get_mut(from..from + chunk.data.len()));
                    if let Some(place) = place {
                        place.copy_from_slice(&chunk.data);
                    }
                }
                Request::Commit { .. } => self.commit(),
                Request::Play(play) if self.last_play != Some(received.header) => {
                    self.last_play = Some(received.header);
                    requested = Some(play);
                }
                _ => {}
            }
        }
        requested
    }

    /// Table with a checksum. Returns `None` if it did not pass over this link.
    pub(super) fn table(&self, crc32: u32) -> Option<&GaitTable> {
        self.tables.iter().find(|table| table.crc32() == crc32)
    }

    /// Fit of the robot's clock to the port's. Returns `None` before the first keep-alive with a reply.
    pub(super) fn clock(&self) -> Option<ClockFit> {
        self.clock.fit()
    }

    /// Discards the clock: the robot has restarted, or the port is another.
    pub(super) fn clear_clock(&mut self) {
        self.beats.clear();
        self.clock.clear();
    }

    fn pong(&mut self, pong: Pong, now: Duration) {
        let of_it = |beat: &&Beat| beat.host_us == pong.host_us;
        if let Some(beat) = self.beats.iter().find(of_it) {
            let host_us = u64::try_from(beat.sent.as_micros()).unwrap_or(u64::MAX);
            self.clock.push(&Pong { host_us, ..pong }, now);
        }
    }

    /// Keeps the upload's table if its checksum is right: a repeated commit finds it kept.
    fn commit(&mut self) {
        let Some(upload) = &self.upload else { return };
        let table = GaitTable::from_bytes(&upload.bytes);
        if let Ok(table) = table
            && table.crc32() == upload.crc32
        {
            self.tables.retain(|known| known.crc32() != upload.crc32);
            self.tables.push_front(table);
            self.tables.truncate(MOST_TABLES);
        }
    }
}

#[cfg(test)]
mod tests {
    use link_protocol::{Begin, Checked, Chunk};

    use super::*;

    /// Frames of a session, one request after the other.
    fn frames(requests: &[Request]) -> Vec<Vec<u8>> {
        let frame = |(sequence, request): (u16, &Request)| {
            let mut out = [0; 300];
            let message = Message::Request(request.clone());
            let length =
                link_protocol::encode(Header::new(5, sequence), &message, &mut out).unwrap();
            out[..length].to_vec()
        };
        (1..).zip(requests).map(frame).collect()
    }

    fn upload(table: &GaitTable) -> Vec<Request> {
        let begin = Request::Begin(Begin {
            slot: 0,
            len: u16::try_from(table.bytes().len()).unwrap(),
            crc32: table.crc32(),
        });
        let chunks = table.bytes().chunks(64).enumerate().map(|(index, data)| {
            Request::Chunk(Chunk {
                upload: 1,
                offset: u16::try_from(index * 64).unwrap(),
                data: data.iter().copied().collect(),
            })
        });
        [begin]
            .into_iter()
            .chain(chunks)
            .chain([Request::Commit { upload: 1 }])
            .collect()
    }

    fn circle(amplitude: f64) -> GaitTable {
        GaitTable::from_fn(64, |u| {
            let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
            [amplitude * cos, amplitude * sin]
        })
        .unwrap()
    }

    #[test]
    fn a_table_is_known_after_its_upload_even_with_repeated_and_reordered_chunks() {
        let table = circle(0.7);
        let mut requests = frames(&upload(&table));
        let repeated = requests[1].clone();
        requests.insert(3, repeated);
        requests.swap(1, 2);
        let mut overheard = Overheard::default();
        for frame in &requests {
            assert!(overheard.table(table.crc32()).is_none());
            overheard.take_request(Duration::ZERO, frame);
        }
        assert_eq!(overheard.table(table.crc32()), Some(&table));
    }

    #[test]
    fn a_table_with_a_missing_chunk_is_unknown() {
        let table = circle(0.7);
        let mut overheard = Overheard::default();
        for (index, frame) in frames(&upload(&table)).iter().enumerate() {
            if index != 2 {
                overheard.take_request(Duration::ZERO, frame);
            }
        }
        assert!(overheard.table(table.crc32()).is_none());
    }

    #[test]
    fn a_repeated_request_to_play_counts_once() {
        let play = Request::Play(Play {
            cycles: 3,
            period_us: 6_000_000,
            detached: false,
            checked: Checked {
                table_crc32: 1,
                settings_crc32: 2,
            },
        });
        let frames = frames(&[play.clone(), play]);
        let mut overheard = Overheard::default();
        assert!(overheard.take_request(Duration::ZERO, &frames[0]).is_some());
        assert!(
            overheard.take_request(Duration::ZERO, &frames[0]).is_none(),
            "repeated"
        );
        assert!(
            overheard.take_request(Duration::ZERO, &frames[1]).is_some(),
            "another"
        );
    }
}
