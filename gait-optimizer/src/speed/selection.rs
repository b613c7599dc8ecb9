//! Selection of the rough polygons to refine.

use nalgebra::Vector2;

use super::interior::{Polygon, rough_polygon};
use super::setting::Setting;
use crate::parallel::{Watch, in_parallel};

/// Polygons as fast and as long as each other, but for this share, lie near one gait.
const ALIKE: f64 = 3e-3;
/// Number of polygons refined per group, since similar polygons may still lead to different gaits.
const OF_A_GROUP: usize = 2;

/// Polygons that lie near one gait.
#[derive(Debug)]
pub(crate) struct Group {
    /// Those to finish, fastest first.
    pub(crate) chosen: Vec<Polygon>,
    /// Number of polygons in the group.
    pub(crate) count: usize,
}

impl Group {
    pub(crate) fn speed(&self) -> f64 {
        self.chosen.first().map_or(0.0, |first| first.speed)
    }
}

/// The groups of the rough polygons that starts lead to, fastest first.
pub(super) fn rough_groups(
    setting: &Setting,
    starts: &[Vec<Vector2<f64>>],
    threads: usize,
    watch: Watch<'_>,
) -> Vec<Group> {
    let roughly = |(): &mut (), index: usize| rough_polygon(setting, &starts[index]);
    let rough = in_parallel(starts.len(), threads, watch, || (), roughly);
    groups(rough.into_iter().flatten().collect())
}

/// The groups of some polygons, fastest first.
pub(crate) fn groups(mut polygons: Vec<Polygon>) -> Vec<Group> {
    polygons.sort_by(|a, b| b.speed.total_cmp(&a.speed));
    let mut groups: Vec<Group> = Vec::new();
    for polygon in polygons {
        let alike = |group: &&mut Group| {
            group.chosen.first().is_some_and(|first| {
                let near = |a: f64, b: f64| (a - b).abs() < ALIKE * b;
                near(polygon.speed, first.speed) && near(polygon.period(), first.period())
            })
        };
        match groups.iter_mut().find(alike) {
            Some(group) => {
                group.count += 1;
                if group.chosen.len() < OF_A_GROUP {
                    group.chosen.push(polygon);
                }
            }
            None => groups.push(Group {
                chosen: vec![polygon],
                count: 1,
            }),
        }
    }
    groups
}
