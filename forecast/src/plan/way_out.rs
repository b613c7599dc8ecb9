//! Ways out: from a pose near a wall, at which only small cycles keep clear of it, to poses at which larger ones do.
//!
//! Every gait can be run backwards, so a way out of a target is a way into it. The tree of quickest ways (Dijkstra's algorithm)
//! is grown with the largest admissible cycles at each pose; the quickest way to every region of poses is returned.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use swimmer_model::Pose;

use super::Step;
use super::legs::LARGEST;
use super::member::{Kind, Member};
use super::walls::{Sweeps, sizes};

/// Poses within these distances count as equal \[m, rad\].
const ALIKE: [f64; 2] = [0.005, 0.05];
/// Largest number of poses that are expanded.
const MOST: usize = 4000;
/// Least distance between the ends of the returned ways \[m, rad\].
const APART: [f64; 2] = [0.04, 0.4];
/// Largest number of returned ways.
const WAYS: usize = 60;
/// Cycles of a step; more only if these have not led to another pose, since the smallest cycles hardly swim.
const CYCLES: u32 = 64;
const MOST_CYCLES: u32 = 1024;

/// A way out.
#[derive(Debug, Clone)]
pub(super) struct Way {
    pub(super) steps: Vec<Step>,
    pub(super) there: Pose<f64>,
    pub(super) duration: f64,
}

struct Node {
    pose: Pose<f64>,
    /// The node before, and the step from there.
    from: Option<(usize, Step)>,
    duration: f64,
}

/// The ways out from this pose at the common shape, the shortest first: the first stays. If the largest cycles are admissible it
/// is the only one, unless `everywhere` is set.
pub(super) fn ways_out(sweeps: &Sweeps<'_>, begun: &Pose<f64>, everywhere: bool) -> Vec<Way> {
    let mut nodes = vec![Node {
        pose: *begun,
        from: None,
        duration: 0.0,
    }];
    let mut open = BinaryHeap::from([Reverse((Time(0.0), 0))]);
    let mut visited = HashSet::new();
    let mut ways = Vec::new();
    let mut reached = HashSet::new();
    while let Some(Reverse((Time(time), at))) = open.pop() {
        let pose = nodes[at].pose;
        if !visited.insert(cell(&pose, ALIKE)) {
            continue;
        }
        let mut free_scales = 0.0;
        for kind in Kind::ALL {
            for backwards in [false, true] {
                let of = |scale| Member {
                    kind,
                    backwards,
                    scale,
                };
                let fitting = sizes().find_map(|size| {
                    let there = sweeps.after(&pose, &of(size), 1)?;
                    Some((of(size), there))
                });
                let Some((member, mut there)) = fitting else {
                    continue;
                };
                free_scales += member.scale;
                let mut cycles = 1;
                loop {
                    let step = sweeps.nets.step(member, cycles);
                    let duration = time + f64::from(cycles) * step.period;
                    if !visited.contains(&cell(&there, ALIKE)) {
                        open.push(Reverse((Time(duration), nodes.len())));
                        nodes.push(Node {
                            pose: there,
                            from: Some((at, step)),
                            duration,
                        });
                    }
                    if cycles >= CYCLES && cell(&there, ALIKE) != cell(&pose, ALIKE) {
                        break;
                    }
                    let Some(further) = sweeps.after(&there, &member, cycles) else {
                        break;
                    };
                    (there, cycles) = (further, 2 * cycles);
                    if cycles > MOST_CYCLES {
                        break;
                    }
                }
            }
        }
        if reached.insert(cell(&pose, APART)) {
            ways.push(way(&nodes, at));
        }
        let free = at == 0 && !everywhere && free_scales > 5.99 * LARGEST;
        if free || visited.len() > MOST || ways.len() == WAYS {
            break;
        }
    }
    ways
}

fn way(nodes: &[Node], to: usize) -> Way {
    let mut steps = Vec::new();
    let mut at = to;
    while let Some((before, step)) = nodes[at].from {
        steps.push(step);
        at = before;
    }
    steps.reverse();
    Way {
        steps,
        there: nodes[to].pose,
        duration: nodes[to].duration,
    }
}

#[allow(clippy::cast_possible_truncation, reason = "saturates")]
fn cell(pose: &Pose<f64>, size: [f64; 2]) -> [i64; 3] {
    let heading = swimmer_model::wrapped_angle(pose.theta);
    [pose.x / size[0], pose.y / size[0], heading / size[1]].map(|share| share.round() as i64)
}

/// A duration \[s\], in order.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Time(f64);

impl Eq for Time {}

impl PartialOrd for Time {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Time {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
