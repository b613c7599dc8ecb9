//! Names of markers and bodies, from the server's model definitions.

use std::collections::HashMap;

use natnet::{DataSet, ModelDef};

use super::description;

/// The set that repeats the markers of all others.
const ALL: &str = "all";

/// Names by number.
#[derive(Debug, Default)]
pub(super) struct Names {
    /// Markers by model and member.
    members: HashMap<(i32, i32), String>,
    bodies: HashMap<i32, String>,
    /// Members of marker sets, in order.
    sets: HashMap<String, Vec<String>>,
}

impl Names {
    pub(super) fn of(model: &ModelDef) -> Self {
        let mut names = Self::default();
        for dataset in &model.datasets {
            match dataset {
                DataSet::MarkerSet(set) if !set.name.eq_ignore_ascii_case(ALL) => {
                    names
                        .sets
                        .insert(set.name.clone(), set.marker_names.clone());
                }
                DataSet::RigidBody(body) => {
                    names.bodies.insert(body.id, body.name.clone());
                    for (member, name) in (1..).zip(description::marker_names(&body.tail)) {
                        if !name.is_empty() {
                            names.members.insert((body.id, member), name);
                        }
                    }
                }
                DataSet::Asset(asset) => {
                    for marker in &asset.markers {
                        let (_, member) = natnet::frame::decode_id(marker.id);
                        let name = marker.name.clone();
                        names.members.insert((asset.id, member), name);
                    }
                    for body in &asset.rigid_bodies {
                        names.bodies.insert(body.id, body.name.clone());
                    }
                }
                _ => {}
            }
        }
        names
    }

    pub(super) fn member(&self, model: i32, member: i32) -> Option<&String> {
        self.members.get(&(model, member))
    }

    pub(super) fn body(&self, id: i32) -> Option<&String> {
        self.bodies.get(&id)
    }

    /// Member names of a marker set; `None` if it is not described.
    pub(super) fn set(&self, name: &str) -> Option<&Vec<String>> {
        self.sets.get(name)
    }
}
