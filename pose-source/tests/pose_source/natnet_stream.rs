//! Client and server of NatNet face to face, without sockets.

use natnet::command::{self, ConnectOptions};
use natnet::frame::encode_id;
use natnet::serverinfo::ConnectionInfo;
use natnet::{
    Asset, AssetDef, DataSet, FrameOfData, LabeledMarker, MarkerDef, MarkerSet, MarkerSetDef,
    ModelDef, RawSection, ServerInfo, SyntheticServer, Version,
};
use pose_source::Mapping;
use pose_source::natnet::{Client, NatNetError, Scene, Server};
use proptest::prelude::*;

use crate::frames::{assert_same, seen};

fn scene() -> Scene {
    Scene {
        body: "robot".to_owned(),
        markers: vec!["Front".to_owned(), "Back".to_owned()],
    }
}

fn server_info(version: Version, multicast: bool) -> ServerInfo {
    ServerInfo {
        application_name: "Motive".to_owned(),
        server_version: Version::new(3, 4, 0, 2),
        protocol_version: version,
        high_res_clock_frequency: 10_000_000,
        connection: ConnectionInfo {
            data_port: 1511,
            multicast,
            multicast_group: [239, 255, 42, 99],
        },
    }
}

/// Every frame of the twin's cameras survives the wire, to single precision.
#[test]
fn frames_survive_the_wire() {
    let here = "127.0.0.1:9".parse().unwrap();
    let (mut server, mut client) = (Server::new(scene(), false), Client::new(Mapping::Y_UP));
    let mut now_s = 0.0;
    while !client.has_names() {
        while let Some(request) = client.due(now_s) {
            if let Some(reply) = server.receive(&request, here, now_s) {
                assert_eq!(client.receive(&reply, now_s), Ok(None));
            }
        }
        now_s += 0.01;
        assert!(now_s < 0.1, "a reply is answered at once");
    }
    assert_eq!(server.clients(), 1);
    for frame in seen(500, 3) {
        let sent = server.frame(&frame, frame.stamp_s + 0.004, now_s);
        let [datagram] = sent.as_slice() else {
            panic!("{sent:?}");
        };
        assert_eq!(datagram.to, Some(here));
        let read = client.receive(&datagram.bytes, 7.0).unwrap().unwrap();
        assert_same(&frame, &read, 1e-6);
        assert!((read.received_s - 7.0).abs() < 1e-12);
        assert!((read.latency_s.unwrap() - 0.004).abs() < 2e-6);
    }
    assert_eq!(client.malformed(), 0);
}

/// A client that requests an older bitstream gets it; a silent one is forgotten.
#[test]
fn each_client_has_its_version_and_silent_ones_go() {
    let mut server = Server::new(scene(), false);
    let versions = [(3, 0), (3, 1), (4, 0), (4, 1)];
    for (port, (major, minor)) in (1..).zip(versions) {
        let version = Version::new(major, minor, 0, 0);
        let request = command::connect_request_with(ConnectOptions::requesting(version)).unwrap();
        let from = ([127, 0, 0, 1], port).into();
        assert!(server.receive(request.as_bytes(), from, 0.0).is_some());
        let request = command::request_modeldef().unwrap();
        let model = server.receive(request.as_bytes(), from, 0.0).unwrap();
        assert_eq!(ModelDef::parse(&model, version).unwrap().datasets.len(), 2);
    }
    let frame = &seen(1, 1)[0];
    let sent = server.frame(frame, 0.0, 1.0);
    assert_eq!(sent.len(), 4);
    for (datagram, (major, minor)) in sent.iter().zip(versions) {
        let decoder = natnet::Decoder::new(Version::new(major, minor, 0, 0)).unwrap();
        decoder.parse(&datagram.bytes).unwrap();
    }
    let from = ([127, 0, 0, 1], 2).into();
    server.receive(&command::keepalive_datagram(), from, 9.0);
    assert_eq!(server.frame(frame, 0.0, 15.0).len(), 1);
    server.receive(&command::disconnect_datagram(), from, 15.0);
    assert!(server.frame(frame, 0.0, 15.0).is_empty());
}

/// A multicast stream has Motive's own version; one that is not read is refused by name, with what to do.
#[test]
fn a_version_that_is_not_read_is_refused_by_name() {
    for (version, multicast) in [((4, 4), true), ((2, 10), true), ((2, 9), false)] {
        let info = server_info(Version::new(version.0, version.1, 0, 0), multicast);
        let mut client = Client::new(Mapping::Y_UP);
        let refused = client
            .receive(&info.to_datagram().unwrap(), 0.0)
            .unwrap_err();
        let text = refused.to_string();
        let named = format!("Motive 3.4 streams NatNet {}.{}", version.0, version.1);
        assert!(text.contains(&named), "{text}");
        assert_eq!(text.contains("unicast"), multicast, "{text}");
    }
    // Unicast is requested in 4.1, whatever Motive's own version is.
    let mut client = Client::new(Mapping::Y_UP);
    let info = server_info(Version::new(4, 4, 0, 0), false);
    client.receive(&info.to_datagram().unwrap(), 0.0).unwrap();
    assert!(client.server().is_some());
}

/// A server that announces 4.1 and streams something else ends the stream with a reason, after a while.
#[test]
fn frames_of_another_layout_end_the_stream() {
    let mut client = Client::new(Mapping::Y_UP);
    let info = server_info(Version::new(4, 4, 0, 0), false);
    client.receive(&info.to_datagram().unwrap(), 0.0).unwrap();
    let garbage = [&7_u16.to_le_bytes()[..], &[9; 60]].concat();
    let mut outcomes = (0..100).map(|_| client.receive(&garbage, 0.0));
    let refused = outcomes.find_map(Result::err).unwrap();
    assert!(matches!(refused, NatNetError::Undecodable { .. }));
    let text = refused.to_string();
    assert!(text.contains("4.1") && text.contains("4.4"), "{text}");
}

/// Names of a trained marker set and of a plain one; occluded and unlabeled markers; points that lists repeat.
#[test]
fn markers_are_named_by_asset_and_by_set() {
    let set = |name: &str, names: &[&str]| {
        DataSet::MarkerSet(MarkerSetDef {
            name: name.to_owned(),
            marker_names: names.iter().map(ToString::to_string).collect(),
        })
    };
    let model = ModelDef {
        datasets: vec![
            set("all", &["wrong", "wrong too"]),
            set("links", &["Tip", "Tail"]),
            DataSet::Asset(AssetDef {
                name: "swimmer".to_owned(),
                asset_type: 1,
                id: 5,
                rigid_bodies: Vec::new(),
                markers: ["Front", "Back"]
                    .iter()
                    .zip(1..)
                    .map(|(name, id)| MarkerDef {
                        name: (*name).to_owned(),
                        id,
                        position: [0.0; 3],
                        size: 0.01,
                        params: 0,
                    })
                    .collect(),
            }),
        ],
    };
    let labeled = |id, x: f32, params| LabeledMarker {
        id,
        position: [x, 0.5, 0.25],
        size: 0.01,
        params,
        residual: 0.0,
    };
    let mut frame: FrameOfData = SyntheticServer::new(Version::V4_1, 10_000_000).frame(1, 2.5, &[]);
    frame.labeled_markers = vec![
        labeled(encode_id(5, 1).unwrap(), 1.0, 0x0a),
        labeled(encode_id(5, 2).unwrap(), 2.0, 0x0b),
        labeled(encode_id(0, 1).unwrap(), 3.0, 0x12),
        labeled(encode_id(0, 2).unwrap(), f32::NAN, 0x12),
    ];
    frame.marker_sets = vec![
        MarkerSet {
            name: "all".to_owned(),
            markers: vec![[1.0, 0.5, 0.25], [3.0, 0.5, 0.25]],
        },
        MarkerSet {
            name: "links".to_owned(),
            markers: vec![[4.0, 0.5, 0.25], [0.0; 3]],
        },
    ];
    frame.other_markers = vec![[3.0, 0.5, 0.25], [6.0, 0.5, 0.25]];
    frame.assets = RawSection::from_assets(&[Asset {
        id: 5,
        rigid_bodies: Vec::new(),
        markers: Vec::new(),
    }])
    .unwrap();
    let mut client = Client::new(Mapping::Y_UP);
    let info = server_info(Version::V4_1, true);
    client.receive(&info.to_datagram().unwrap(), 0.0).unwrap();
    client
        .receive(&model.to_datagram(Version::V4_1).unwrap(), 0.0)
        .unwrap();
    let datagram = frame.to_datagram(Version::V4_1).unwrap();
    let read = client.receive(&datagram, 0.0).unwrap().unwrap();
    let listed: Vec<(Option<&str>, f64)> = read
        .markers
        .iter()
        .map(|marker| (marker.name.as_deref(), marker.y_m))
        .collect();
    assert_eq!(
        listed,
        [
            (Some("Front"), 1.0),
            (None, 3.0),
            (Some("Tip"), 4.0),
            (None, 6.0)
        ]
    );
    assert!((read.markers[0].x_m - 0.25).abs() < 1e-9 && (read.markers[0].z_m - 0.5).abs() < 1e-9);
    assert!((read.stamp_s - 2.5).abs() < 1e-12);
}

proptest! {
    /// Any bytes, and any frame that was cut or changed: no panic, and no number that is not finite.
    #[test]
    fn any_datagram(bytes in prop::collection::vec(any::<u8>(), 0..300), cut in 0_usize..400, flip in 0_usize..400, id in 0_u16..12) {
        let mut client = Client::new(Mapping::Y_UP);
        let _ = client.receive(&bytes, 0.0);
        client.receive(&server_info(Version::V4_1, false).to_datagram().unwrap(), 0.0).unwrap();
        let _ = client.receive(&[&id.to_le_bytes()[..], &[0, 0], &bytes].concat(), 0.0);
        let mut server = Server::new(scene(), true);
        let mut datagram = server.frame(&seen(1, 1)[0], 0.0, 0.0).remove(0).bytes;
        if let Some(byte) = datagram.get_mut(4 + flip) {
            *byte = byte.wrapping_add(101);
        }
        datagram.truncate(datagram.len().saturating_sub(cut));
        if let Ok(Some(frame)) = client.receive(&datagram, 0.0) {
            for marker in &frame.markers {
                prop_assert!(marker.position().iter().all(|value| value.is_finite()));
            }
        }
        let from = "127.0.0.1:1".parse().unwrap();
        let _ = server.receive(&bytes, from, 0.0);
    }
}
