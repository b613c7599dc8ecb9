//! Frames that no honest host sends: those of a real session with bytes broken, lost, added and mixed; whole frames with the
//! right checksum and anything in them; and, so that there is motion to disturb, honest ones.

use gait_player::GaitTable;
use link_protocol::Header;
use link_protocol::{
    Begin, Checked, Chunk, Heartbeat, Hello, Joint, Kind, MAX_ENCODED, Message, PROTOCOL_CURRENT,
    PROTOCOL_MIN, Play, Request, SCHEMA_KEY, ServoSettings, Status, crc32c, encode, encode_body,
};
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

use crate::rig;

/// Bytes of a chunk: small, so that an upload is many frames.
const CHUNK: usize = 40;

/// The first byte of these requests' bodies.
const PLAY: u8 = 11;
const STOP: u8 = 14;
const ESTOP: u8 = 15;
const SET_KEY: u8 = 19;

/// An endless source of frames.
pub(crate) struct Frames {
    rng: ChaCha8Rng,
    session: u16,
    sequence: u16,
    table: GaitTable,
    upload: u16,
    offset: usize,
    /// Last received time of the robot's clock, µs.
    heard_us: u64,
    /// Table and settings of the robot, and its e-stops, as a status reported them last.
    held: Checked,
    estops: u32,
    last: Vec<u8>,
}

/// A frame's bytes.
pub(crate) fn encoded(session: u16, sequence: u16, message: &Message) -> Vec<u8> {
    let mut frame = [0; MAX_ENCODED];
    let len = encode(Header::new(session, sequence), message, &mut frame).unwrap();
    frame[..len].to_vec()
}

impl Frames {
    pub(crate) fn new(rng: ChaCha8Rng) -> Self {
        Self {
            rng,
            session: 0,
            sequence: 0,
            table: GaitTable::from_fn(32, |u| {
                let angle = std::f64::consts::TAU * u;
                [angle.cos(), angle.sin()]
            })
            .unwrap(),
            upload: 0,
            offset: 0,
            heard_us: 0,
            held: Checked {
                table_crc32: 0,
                settings_crc32: 0,
            },
            estops: 0,
            last: Vec::new(),
        }
    }

    /// The robot opened this session.
    pub(crate) fn greeted(&mut self, session: u16) {
        if session != self.session {
            (self.session, self.sequence) = (session, 0);
        }
    }

    /// The robot said what time it is.
    pub(crate) fn heard(&mut self, robot_us: u64) {
        self.heard_us = robot_us;
    }

    /// The robot reported its status.
    pub(crate) fn reported(&mut self, status: &Status) {
        (self.held, self.estops) = (status.held(), status.estops);
    }

    /// The robot opened, or goes on with, this upload.
    pub(crate) fn upload(&mut self, upload: u16) {
        self.upload = upload;
    }

    /// A greeting.
    pub(crate) fn hello(&mut self) -> Vec<u8> {
        let hello = Hello {
            protocol_min: PROTOCOL_MIN,
            protocol_current: PROTOCOL_CURRENT,
            schema_key: SCHEMA_KEY,
            host_nonce: self.rng.random(),
        };
        encoded(0, self.rng.random(), &Message::Hello(hello))
    }

    /// A request of the session, with the next number.
    pub(crate) fn request(&mut self, request: Request) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        encoded(self.session, self.sequence, &Message::Request(request))
    }

    /// The next frame.
    pub(crate) fn next(&mut self) -> Vec<u8> {
        let frame = match self.rng.random_range(0..100) {
            0..40 => {
                let frame = self.honest();
                self.mutated(frame)
            }
            40..75 => self.whole_but_random(),
            75..80 => {
                let len = self.rng.random_range(1..40);
                self.bytes(len)
            }
            _ => self.honest(),
        };
        self.last.clone_from(&frame);
        frame
    }

    fn bytes(&mut self, len: usize) -> Vec<u8> {
        let mut bytes = vec![0; len];
        self.rng.fill_bytes(&mut bytes);
        bytes
    }

    /// Next frame of a valid session; stops are rare, so that the robot is mostly in motion.
    fn honest(&mut self) -> Vec<u8> {
        let request = match self.rng.random_range(0..100) {
            0..20 => {
                let heartbeat = Heartbeat {
                    host_us: self.rng.random(),
                    heard_us: self.heard_us,
                };
                return encoded(self.session, 0, &Message::Heartbeat(heartbeat));
            }
            20..30 => Request::Arm,
            30..35 => Request::ClearEStop { count: self.estops },
            35..55 => Request::Play(Play {
                cycles: self.rng.random_range(0..4),
                period_us: self.rng.random_range(2_000_000..9_000_000),
                detached: self.rng.random_bool(0.2),
                checked: self.held,
            }),
            55..60 => self.begin(),
            60..80 => self.chunk(),
            80..84 => Request::Commit {
                upload: self.upload,
            },
            84..88 => Request::Pause {
                detached: self.rng.random_bool(0.3),
            },
            88..92 => Request::Resume,
            92..94 => Request::Trim {
                joint: Joint::Front,
                trim: self.rng.random_range(-500..500),
            },
            94 if self.rng.random_bool(0.1) => Request::Stop,
            95 => Request::SetServo {
                joint: Joint::Back,
                settings: ServoSettings {
                    centre_ns: self.rng.random_range(1_475_000..1_525_000),
                    slope_rad_per_us: self.rng.random_range(0.024..0.031),
                    reversed: self.rng.random_bool(0.5),
                    trim: 0,
                },
            },
            96 => Request::Counters,
            97 => Request::Table,
            _ => Request::Status,
        };
        self.request(request)
    }

    fn begin(&mut self) -> Request {
        self.offset = 0;
        Request::Begin(Begin {
            slot: 0,
            len: u16::try_from(self.table.bytes().len()).unwrap(),
            crc32: crc32c(self.table.bytes()),
        })
    }

    fn chunk(&mut self) -> Request {
        let from = self.offset;
        let piece = &self.table.bytes()[from..(from + CHUNK).min(self.table.bytes().len())];
        self.offset = (from + CHUNK) % self.table.bytes().len().next_multiple_of(CHUNK);
        Request::Chunk(Chunk {
            upload: self.upload,
            offset: u16::try_from(from).unwrap(),
            data: heapless::Vec::from_slice(piece).unwrap(),
        })
    }

    /// Bits flipped, bytes lost and added, the end cut off, or the end of the frame before grafted on.
    fn mutated(&mut self, mut frame: Vec<u8>) -> Vec<u8> {
        for _ in 0..self.rng.random_range(1..4) {
            if frame.is_empty() {
                break;
            }
            let at = self.rng.random_range(0..frame.len());
            match self.rng.random_range(0..5) {
                0 => frame[at] ^= 1 << self.rng.random_range(0..8),
                1 => frame.insert(at, self.rng.random()),
                2 => drop(frame.remove(at)),
                3 => frame.truncate(at),
                _ => {
                    let cut = at.min(self.last.len());
                    frame.truncate(at);
                    frame.extend_from_slice(&self.last[cut..]);
                }
            }
        }
        frame
    }

    /// A frame that the decoder takes: the right checksum, any kind, any body, the session's number or any.
    fn whole_but_random(&mut self) -> Vec<u8> {
        let session = if self.rng.random_bool(0.7) {
            self.session
        } else {
            self.rng.random()
        };
        // A number far ahead would make the honest ones stale: rare, until the next greeting.
        let sequence = if self.rng.random_bool(0.02) {
            self.rng.random()
        } else {
            self.sequence = self.sequence.wrapping_add(1);
            self.sequence
        };
        let kind = match self.rng.random_range(0..10) {
            0 => self.rng.random(),
            1 => Kind::Hello as u8,
            2 => Kind::Heartbeat as u8,
            _ => Kind::Request as u8,
        };
        let len = self.rng.random_range(0..24);
        let mut body = self.bytes(len);
        // The first byte of a request's body says which: mostly one that there is.
        if let Some(which) = body.first_mut()
            && self.rng.random_bool(0.8)
        {
            *which %= 24;
            // An effective stop in every hundredth frame would leave no motion to disturb.
            if (STOP..=ESTOP).contains(which) && self.rng.random_bool(0.95) {
                *which = PLAY;
            }
            // One in a million is a whole key, and locks this host out: as it should, but the noise would end there.
            if *which == SET_KEY {
                *which = PLAY;
            }
        }
        let mut frame = [0; MAX_ENCODED];
        let header = Header::new(session, sequence);
        let written = encode_body(header, kind, &body, None, &mut frame).unwrap();
        frame[..written].to_vec()
    }
}

#[test]
fn requests_begin_with_the_bytes_named_here() {
    let play = Play {
        cycles: 1,
        period_us: 1,
        detached: false,
        checked: Checked {
            table_crc32: 0,
            settings_crc32: 0,
        },
    };
    for (first, request) in [
        (PLAY, Request::Play(play)),
        (STOP, Request::Stop),
        (ESTOP, Request::EStop),
        (SET_KEY, Request::SetKey(None)),
    ] {
        let mut body = [0; 128];
        let body = Message::Request(request).encode_body(&mut body).unwrap();
        assert_eq!(body[0], first);
    }
}

#[test]
fn mutations_leave_few_frames_as_they_were() {
    use rand::SeedableRng;
    let mut frames = Frames::new(ChaCha8Rng::seed_from_u64(1));
    let same = (0..1000)
        .filter(|_| {
            let frame = frames.honest();
            frames.mutated(frame.clone()) == frame
        })
        .count();
    assert!(same < 50, "{same}");
    assert_ne!(rig::circle(60.0).bytes().len(), frames.table.bytes().len());
}
