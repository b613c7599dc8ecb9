//! The server's side, sans-IO: the digital twin streams as Motive does.

use std::net::SocketAddr;

use natnet::command::ConnectOptions;
use natnet::frame::encode_id;
use natnet::serverinfo::ConnectionInfo;
use natnet::{
    DataSet, FrameOfData, FrameTiming, HEADER_LEN, LabeledMarker, MarkerSet, MarkerSetDef,
    MessageHeader, ModelDef, NAT_CONNECT, NAT_DISCONNECT, NAT_KEEPALIVE, NAT_REQUEST,
    NAT_REQUEST_FRAMEOFDATA, NAT_REQUEST_MODELDEF, NAT_UNRECOGNIZED_REQUEST, RawSection,
    RigidBodyDef, ServerInfo, Version,
};

use super::description::{DescribedMarker, description};
use super::{DATA_PORT, GROUP, HAS_MODEL, OCCLUDED, POINT_CLOUD_SOLVED, REQUESTED, UNLABELED};
use crate::{Frame, Mapping};

/// Ticks of the camera clock per second.
const TICKS_PER_S: u64 = 1_000_000;
/// A unicast client that is silent for longer is dropped \[s\].
const SILENT_S: f64 = 10.0;
/// Unicast clients at a time.
const MOST_CLIENTS: usize = 16;
/// Number of the body on the wire.
const BODY: i32 = 1;

/// The markers and the body that a server describes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scene {
    /// Name of the marker set, and of the rigid body.
    pub body: String,
    /// Names of its markers, as frames have them.
    pub markers: Vec<String>,
}

/// A datagram to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Datagram {
    /// The client; `None` for the multicast group.
    pub to: Option<SocketAddr>,
    /// Header and payload.
    pub bytes: Vec<u8>,
}

#[derive(Debug)]
struct Subscriber {
    address: SocketAddr,
    version: Version,
    heard_s: f64,
}

/// Streams frames to unicast clients, or to a multicast group.
#[derive(Debug)]
pub struct Server {
    scene: Scene,
    multicast: bool,
    clients: Vec<Subscriber>,
    number: i32,
}

impl Server {
    /// A server of this scene; `multicast` streams to Motive's group, else each client gets frames of its own.
    pub fn new(scene: Scene, multicast: bool) -> Self {
        Self {
            scene,
            multicast,
            clients: Vec::new(),
            number: 0,
        }
    }

    /// Clients at the moment.
    pub fn clients(&self) -> usize {
        self.clients.len()
    }

    /// Name and versions that the server reports.
    pub fn info(&self) -> ServerInfo {
        ServerInfo {
            application_name: "swimmer twin".to_owned(),
            server_version: Version::new(
                env!("CARGO_PKG_VERSION_MAJOR").parse().unwrap_or(0),
                env!("CARGO_PKG_VERSION_MINOR").parse().unwrap_or(0),
                env!("CARGO_PKG_VERSION_PATCH").parse().unwrap_or(0),
                0,
            ),
            protocol_version: REQUESTED,
            high_res_clock_frequency: TICKS_PER_S,
            connection: ConnectionInfo {
                data_port: DATA_PORT,
                multicast: self.multicast,
                multicast_group: GROUP,
            },
        }
    }

    /// Takes a datagram that came to the command port; returns the reply.
    pub fn receive(&mut self, datagram: &[u8], from: SocketAddr, now_s: f64) -> Option<Vec<u8>> {
        let header = MessageHeader::parse(datagram).ok()?;
        match header.message_id {
            NAT_CONNECT => {
                let options =
                    ConnectOptions::parse(datagram.get(HEADER_LEN..)?).unwrap_or_default();
                let requested = options.bitstream_version.unwrap_or(REQUESTED);
                let known = requested.validate().is_ok();
                let version = if known { requested } else { REQUESTED };
                self.subscribe(from, version, now_s);
                self.info().to_datagram().ok()
            }
            NAT_REQUEST_MODELDEF => self.model_for(from).ok(),
            NAT_KEEPALIVE => {
                let client = self.clients.iter_mut().find(|c| c.address == from)?;
                client.heard_s = now_s;
                None
            }
            NAT_DISCONNECT => {
                self.clients.retain(|client| client.address != from);
                None
            }
            NAT_REQUEST | NAT_REQUEST_FRAMEOFDATA => {
                Some([NAT_UNRECOGNIZED_REQUEST.to_le_bytes(), [0; 2]].concat())
            }
            _ => None,
        }
    }

    fn subscribe(&mut self, address: SocketAddr, version: Version, heard_s: f64) {
        if self.multicast {
            return;
        }
        self.forget_silent(heard_s);
        self.clients.retain(|client| client.address != address);
        if self.clients.len() < MOST_CLIENTS {
            self.clients.push(Subscriber {
                address,
                version,
                heard_s,
            });
        }
    }

    fn forget_silent(&mut self, now_s: f64) {
        self.clients
            .retain(|client| now_s - client.heard_s < SILENT_S);
    }

    /// The model definitions in the version that this client requested.
    fn model_for(&self, from: SocketAddr) -> natnet::Result<Vec<u8>> {
        let client = self.clients.iter().find(|client| client.address == from);
        let version = client.map_or(REQUESTED, |client| client.version);
        let described: Vec<DescribedMarker<'_>> = self
            .scene
            .markers
            .iter()
            .map(|name| DescribedMarker {
                name,
                position: [0.0; 3],
            })
            .collect();
        let model = ModelDef {
            datasets: vec![
                DataSet::MarkerSet(MarkerSetDef {
                    name: self.scene.body.clone(),
                    marker_names: self.scene.markers.clone(),
                }),
                DataSet::RigidBody(RigidBodyDef {
                    name: self.scene.body.clone(),
                    id: BODY,
                    parent_id: -1,
                    offset: [0.0; 3],
                    tail: description(&described, version.at_least(4, 0)),
                }),
            ],
        };
        model.to_datagram(version)
    }

    /// A frame for every client, sent at `sent_s` on the camera clock and `now_s` on the host clock.
    pub fn frame(&mut self, frame: &Frame, sent_s: f64, now_s: f64) -> Vec<Datagram> {
        let wire = self.encoded(frame, sent_s);
        self.number = self.number.wrapping_add(1);
        if self.multicast {
            let bytes = wire.to_datagram(REQUESTED).ok();
            return bytes
                .map(|bytes| Datagram { to: None, bytes })
                .into_iter()
                .collect();
        }
        self.forget_silent(now_s);
        let clients = self.clients.iter().filter_map(|client| {
            Some(Datagram {
                to: Some(client.address),
                bytes: wire.to_datagram(client.version).ok()?,
            })
        });
        clients.collect()
    }

    fn encoded(&self, frame: &Frame, sent_s: f64) -> FrameOfData {
        let none = || RawSection {
            count: 0,
            payload: Vec::new(),
        };
        let mut labeled = Vec::with_capacity(frame.markers.len());
        let mut members = Vec::with_capacity(self.scene.markers.len());
        for (member, name) in (1..).zip(&self.scene.markers) {
            let seen = frame.marker(name).map(|marker| wire_of(marker.position()));
            // A member that is not seen is at the origin, exactly.
            members.push(seen.unwrap_or_default());
            let hidden = if seen.is_some() { 0 } else { OCCLUDED };
            labeled.push(LabeledMarker {
                id: encode_id(BODY, member).unwrap_or(0),
                position: seen.unwrap_or_default(),
                size: 0.01,
                params: HAS_MODEL | POINT_CLOUD_SOLVED | hidden,
                residual: 0.0,
            });
        }
        let others = frame.markers.iter().filter(|marker| {
            let described = |name| self.scene.markers.contains(name);
            !marker.name.as_ref().is_some_and(described)
        });
        for (member, marker) in (1..).zip(others) {
            labeled.push(LabeledMarker {
                id: encode_id(0, member).unwrap_or(0),
                position: wire_of(marker.position()),
                size: 0.01,
                params: POINT_CLOUD_SOLVED | UNLABELED,
                residual: 0.0,
            });
        }
        FrameOfData {
            frame_number: self.number,
            marker_sets: vec![MarkerSet {
                name: self.scene.body.clone(),
                markers: members,
            }],
            other_markers: Vec::new(),
            rigid_bodies: vec![self.body_of(frame)],
            skeletons: none(),
            assets: none(),
            labeled_markers: labeled,
            force_plates: none(),
            devices: none(),
            timing: FrameTiming {
                timecode: 0,
                timecode_subframe: 0,
                timestamp: frame.stamp_s,
                camera_mid_exposure: ticks(frame.stamp_s),
                camera_data_received: ticks(frame.stamp_s),
                transmit: ticks(sent_s),
                precision_timestamp_secs: 0,
                precision_timestamp_fractional_secs: 0,
            },
            params: 0,
        }
    }

    /// The body, untracked if the frame does not have it.
    fn body_of(&self, frame: &Frame) -> natnet::RigidBody {
        let named = |body: &&crate::RigidBody| body.name.as_ref() == Some(&self.scene.body);
        let body = frame.bodies.iter().find(named);
        let [x, y, z, w] = body.map_or([0.0, 0.0, 0.0, 1.0], |body| body.quaternion);
        let [x, y, z] = Mapping::Y_UP.to_source([x, y, z]);
        natnet::RigidBody {
            id: BODY,
            position: wire_of(body.map_or([0.0; 3], |body| body.position)),
            orientation: [x, y, z, w].map(single),
            mean_marker_error: 0.0,
            params: u16::from(body.is_some()),
        }
    }
}

/// Motive's default axes, single precision.
fn wire_of(tank: [f64; 3]) -> [f32; 3] {
    Mapping::Y_UP.to_source(tank).map(single)
}

#[expect(clippy::cast_possible_truncation, reason = "the wire's precision")]
fn single(value: f64) -> f32 {
    value as f32
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn ticks(seconds: f64) -> u64 {
    (seconds * TICKS_PER_S as f64).round() as u64
}
