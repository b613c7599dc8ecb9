//! The swimmer for Foxglove's 3D panel: its links and its sphere as `foxglove.SceneUpdate`, from configuration and telemetry.

use link_protocol::{Configuration, Message, Reply, Request, Telemetry};
use nalgebra::Vector2;
use serde_json::{Value, json};
use swimmer_model::{Links, Pose};

use super::frame::set_point;

/// Name of the schema, by which Foxglove knows the message.
pub(super) const SCHEMA_NAME: &str = "foxglove.SceneUpdate";
pub(super) const SCHEMA: &str = include_str!("scene.json");
pub(super) const TOPIC: &str = "/robot/scene";

/// Least time between two scenes, ns: telemetry comes five times as often, and the log shall stay short.
const EVERY_NS: u64 = 200_000_000;
/// Breadth of a link over the swimmer's length.
const BREADTH: f64 = 0.026;
const LINE_STRIP: u8 = 0;

/// Scenes of a log. None begins before the log has shown the lengths of the links.
#[derive(Debug, Default)]
pub(super) struct Scenes {
    body: Option<Body>,
    last_ns: Option<u64>,
}

#[derive(Debug, Clone, Copy)]
struct Body {
    links: Links<f64>,
    sphere_radius: f64,
}

impl Scenes {
    /// Follows the traffic; returns the message of the scene if one is due.
    pub(super) fn after(&mut self, message: &Message, now_ns: u64) -> Option<Value> {
        match message {
            Message::Request(Request::Configure(configuration))
            | Message::Reply(Reply::Configuration(configuration)) => {
                self.body = Some(Body::of(configuration));
                None
            }
            Message::Telemetry(telemetry) => {
                let is_due = self
                    .last_ns
                    .is_none_or(|last| now_ns.saturating_sub(last) >= EVERY_NS);
                let body = self.body.filter(|_| is_due)?;
                self.last_ns = Some(now_ns);
                Some(body.scene(telemetry, now_ns))
            }
            _ => None,
        }
    }
}

impl Body {
    fn of(configuration: &Configuration) -> Self {
        Self {
            links: Links {
                middle: f64::from(configuration.middle_m),
                front: f64::from(configuration.front_m),
                back: f64::from(configuration.back_m),
            },
            sphere_radius: f64::from(configuration.sphere_radius_m),
        }
    }

    fn scene(&self, telemetry: &Telemetry, now_ns: u64) -> Value {
        let pose = telemetry.pose;
        let [x, y, theta] = [pose.x, pose.y, pose.theta].map(f64::from);
        let pose = Pose::new(x, y, theta);
        let outline = self
            .links
            .outline(&Vector2::from(set_point(telemetry)))
            .map(|place| point(&pose.transform(&place)));
        let length = self.links.middle + self.links.front + self.links.back;
        let standing = json!({"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0});
        let line = json!({
            "type": LINE_STRIP,
            "pose": {"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": standing},
            "thickness": BREADTH * length,
            "scale_invariant": false,
            "points": outline,
            "color": {"r": 0.12, "g": 0.44, "b": 0.7, "a": 1.0},
            "colors": [],
            "indices": [],
        });
        let diameter = 2.0 * self.sphere_radius;
        let sphere = (diameter > 0.0).then(|| {
            json!({
                "pose": {"position": point(&pose.position()), "orientation": standing},
                "size": {"x": diameter, "y": diameter, "z": diameter},
                "color": {"r": 0.12, "g": 0.44, "b": 0.7, "a": 0.2},
            })
        });
        json!({
            "deletions": [],
            "entities": [{
                "timestamp": time(now_ns),
                "frame_id": "tank",
                "id": "swimmer",
                "lifetime": time(0),
                "frame_locked": false,
                "metadata": [],
                "arrows": [],
                "cubes": [],
                "spheres": sphere.into_iter().collect::<Vec<_>>(),
                "cylinders": [],
                "lines": [line],
                "triangles": [],
                "texts": [],
                "models": [],
            }],
        })
    }
}

/// A place in the tank's plane, to a hundredth of a millimetre.
fn point(place: &Vector2<f64>) -> Value {
    let [x, y] = [place.x, place.y].map(|metres| (metres * 1e5).round() / 1e5);
    json!({"x": x, "y": y, "z": 0.0})
}

fn time(ns: u64) -> Value {
    json!({"sec": ns / 1_000_000_000, "nsec": ns % 1_000_000_000})
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Front joint at a right angle, the middle link along y: the front link points against x.
    #[test]
    fn links_are_where_the_joints_put_them() {
        let body = Body {
            links: Links {
                middle: 2.0,
                front: 1.0,
                back: 1.5,
            },
            sphere_radius: 0.25,
        };
        let pose = Pose::new(10.0, 20.0, PI / 2.0);
        let places = body
            .links
            .outline(&Vector2::new(PI / 2.0, 0.0))
            .map(|place| point(&pose.transform(&place)));
        let expected = [(10.0, 17.5), (10.0, 19.0), (10.0, 21.0), (9.0, 21.0)];
        for (place, (x, y)) in places.iter().zip(expected) {
            assert_eq!(place, &json!({"x": x, "y": y, "z": 0.0}));
        }
    }
}
