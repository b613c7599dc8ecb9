//! The client's side, sans-IO: datagrams and times in, requests and frames out.

use natnet::command::{self, ConnectOptions};
use natnet::frame::decode_id;
use natnet::{
    FrameOfData, HEADER_LEN, MessageHeader, ModelDef, NAT_FRAMEOFDATA, NAT_MODELDEF,
    NAT_SERVERINFO, ServerInfo, Version,
};

use super::names::Names;
use super::{NatNetError, OCCLUDED, REQUESTED, UNLABELED, short};
use crate::{Frame, Mapping, Marker, RigidBody};

/// Requests without a reply are repeated so often \[s\].
const REPEAT_S: f64 = 1.0;
/// Keep-alives are sent so often \[s\]: without them a unicast stream ends.
const KEEP_ALIVE_S: f64 = 0.25;
/// Markers of a frame that are read; more is no laboratory.
const MOST_MARKERS: usize = 512;
/// Undecodable frames in a row that end the stream.
const MOST_UNDECODABLE: u32 = 20;
/// The frame parameter that says that models were added or removed.
const MODELS_CHANGED: u16 = 0x02;
/// A longer delay between exposure and transmission is two clocks \[s\].
const LONGEST_LATENCY_S: f64 = 10.0;

/// Reads one server's stream.
#[derive(Debug)]
pub struct Client {
    mapping: Mapping,
    server: Option<ServerInfo>,
    names: Option<Names>,
    requested_s: Option<f64>,
    kept_s: Option<f64>,
    undecodable: u32,
    malformed: u64,
}

impl Client {
    /// A client of a stream whose axes are those of `mapping`.
    pub fn new(mapping: Mapping) -> Self {
        Self {
            mapping,
            server: None,
            names: None,
            requested_s: None,
            kept_s: None,
            undecodable: 0,
            malformed: 0,
        }
    }

    /// The server, once it has replied.
    pub fn server(&self) -> Option<&ServerInfo> {
        self.server.as_ref()
    }

    /// Returns `true` once the server has described its models.
    pub fn has_names(&self) -> bool {
        self.names.is_some()
    }

    /// Datagrams that could not be decoded.
    pub fn malformed(&self) -> u64 {
        self.malformed
    }

    /// The datagram that is due to the server's command port: a connection request, a request for model definitions, a keep-alive.
    /// Call again until it returns `None`.
    pub fn due(&mut self, now_s: f64) -> Option<Vec<u8>> {
        let is_due = |last: Option<f64>, every| last.is_none_or(|last| now_s - last >= every);
        let request = match (&self.server, &self.names) {
            (None, _) => Some(command::connect_request_with(ConnectOptions::requesting(
                REQUESTED,
            ))),
            (Some(_), None) => Some(command::request_modeldef()),
            (Some(_), Some(_)) => None,
        };
        if let Some(request) = request.filter(|_| is_due(self.requested_s, REPEAT_S)) {
            self.requested_s = Some(now_s);
            // Requests of a fixed size do not fail.
            return Some(request.ok()?.as_bytes().to_vec());
        }
        if self.server.is_some() && is_due(self.kept_s, KEEP_ALIVE_S) {
            self.kept_s = Some(now_s);
            return Some(command::keepalive_datagram().to_vec());
        }
        None
    }

    /// Takes a datagram that came at `now_s` on the host clock.
    ///
    /// # Errors
    /// [`NatNetError`]: the stream cannot be read.
    pub fn receive(&mut self, datagram: &[u8], now_s: f64) -> Result<Option<Frame>, NatNetError> {
        let Ok(header) = MessageHeader::parse(datagram) else {
            self.malformed += 1;
            return Ok(None);
        };
        match header.message_id {
            NAT_SERVERINFO => self.server_info(datagram)?,
            NAT_MODELDEF => self.model(datagram),
            NAT_FRAMEOFDATA => return self.frame(datagram, now_s),
            _ => {}
        }
        Ok(None)
    }

    /// The version that is streamed: the requested one, unless the stream is multicast, which all clients share.
    fn stream_version(info: &ServerInfo) -> Version {
        if info.connection.multicast {
            info.protocol_version
        } else {
            ConnectOptions::requesting(REQUESTED).stream_version(info)
        }
    }

    fn server_info(&mut self, datagram: &[u8]) -> Result<(), NatNetError> {
        let Ok(info) = ServerInfo::parse(datagram) else {
            self.malformed += 1;
            return Ok(());
        };
        let stream = Self::stream_version(&info);
        if stream.validate().is_err() {
            return Err(NatNetError::RefusedVersion {
                server: short(info.server_version),
                stream: short(stream),
                multicast: info.connection.multicast,
                application: info.application_name,
            });
        }
        if self.server.is_none() {
            // The next request is due at once.
            self.requested_s = None;
        }
        self.server = Some(info);
        Ok(())
    }

    fn model(&mut self, datagram: &[u8]) {
        let Some(info) = &self.server else {
            return;
        };
        match ModelDef::parse(datagram, Self::stream_version(info)) {
            Ok(model) => self.names = Some(Names::of(&model)),
            Err(_) => self.malformed += 1,
        }
    }

    fn frame(&mut self, datagram: &[u8], now_s: f64) -> Result<Option<Frame>, NatNetError> {
        // Before the server's reply the layout is unknown.
        let Some(info) = &self.server else {
            return Ok(None);
        };
        let version = Self::stream_version(info);
        let payload = datagram.get(HEADER_LEN..).unwrap_or_default();
        let decoded = match FrameOfData::parse_payload(payload, version) {
            Ok(decoded) => decoded,
            Err(reason) => {
                self.malformed += 1;
                self.undecodable += 1;
                if self.undecodable < MOST_UNDECODABLE {
                    return Ok(None);
                }
                return Err(NatNetError::Undecodable {
                    count: self.undecodable,
                    stream: short(version),
                    own: short(info.protocol_version),
                    reason: reason.to_string(),
                });
            }
        };
        self.undecodable = 0;
        let frame = self.converted(&decoded, info, now_s);
        if decoded.params & MODELS_CHANGED != 0 {
            self.names = None;
        }
        Ok(Some(frame))
    }

    fn converted(&self, frame: &FrameOfData, info: &ServerInfo, now_s: f64) -> Frame {
        let timing = &frame.timing;
        let frequency = info.high_res_clock_frequency as f64;
        let exposure = timing.camera_mid_exposure;
        let has_exposure = frequency > 0.0 && exposure > 0;
        let latency_s = timing
            .transmit
            .checked_sub(exposure)
            .map(|ticks| ticks as f64 / frequency)
            .filter(|latency| has_exposure && *latency < LONGEST_LATENCY_S);
        Frame {
            stamp_s: if has_exposure {
                exposure as f64 / frequency
            } else {
                timing.timestamp
            },
            received_s: now_s,
            latency_s,
            markers: self.markers(frame),
            bodies: self.bodies(frame),
        }
    }

    fn bodies(&self, frame: &FrameOfData) -> Vec<RigidBody> {
        let tracked = frame.rigid_bodies.iter().filter(|b| b.tracking_valid());
        tracked
            .filter_map(|body| {
                let named = self.names.as_ref().and_then(|names| names.body(body.id));
                Some(RigidBody {
                    id: i64::from(body.id),
                    name: named.cloned(),
                    position: self.position(body.position)?,
                    quaternion: self.mapping.quaternion(body.orientation.map(f64::from))?,
                })
            })
            .collect()
    }

    fn position(&self, wire: [f32; 3]) -> Option<[f64; 3]> {
        let position = self.mapping.position(wire.map(f64::from));
        position
            .iter()
            .all(|value| value.is_finite())
            .then_some(position)
    }

    /// Labeled markers, named by their model; then members of marker sets, which carry names by their order; then the others.
    /// The three lists repeat each other, position by position.
    fn markers(&self, frame: &FrameOfData) -> Vec<Marker> {
        let mut list = Markers {
            client: self,
            wire: Vec::new(),
            listed: Vec::new(),
        };
        for marker in &frame.labeled_markers {
            // A hidden marker's position is the model's, not measured.
            if marker.params & OCCLUDED != 0 {
                continue;
            }
            let name = (marker.params & UNLABELED == 0)
                .then(|| {
                    let (model, member) = decode_id(marker.id);
                    self.names.as_ref()?.member(model, member)
                })
                .flatten();
            list.add(marker.position, name, Some(i64::from(marker.id)));
        }
        for set in &frame.marker_sets {
            let names = self.names.as_ref().and_then(|names| names.set(&set.name));
            let Some(names) = names else {
                continue;
            };
            for (position, name) in set.markers.iter().zip(names) {
                // A member that is not seen is at the origin, exactly.
                if position.iter().any(|value| *value != 0.0) {
                    list.add(*position, Some(name), None);
                }
            }
        }
        for position in &frame.other_markers {
            list.add(*position, None, None);
        }
        list.listed
    }
}

/// Markers of a frame, each once.
struct Markers<'a> {
    client: &'a Client,
    /// Positions as on the wire, bit by bit.
    wire: Vec<[u32; 3]>,
    listed: Vec<Marker>,
}

impl Markers<'_> {
    fn add(&mut self, wire: [f32; 3], name: Option<&String>, id: Option<i64>) {
        let bits = wire.map(f32::to_bits);
        let same = self.wire.iter().position(|known| *known == bits);
        if let Some(known) = same.and_then(|index| self.listed.get_mut(index)) {
            if known.name.is_none() {
                known.name = name.cloned();
            }
            return;
        }
        if self.listed.len() >= MOST_MARKERS {
            return;
        }
        if let Some([x_m, y_m, z_m]) = self.client.position(wire) {
            self.wire.push(bits);
            self.listed.push(Marker {
                name: name.cloned(),
                id,
                x_m,
                y_m,
                z_m,
            });
        }
    }
}
