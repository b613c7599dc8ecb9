//! Arcs of a polygon, from its active set: the limits that hold each side, and the bounds that corners rest on.

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use super::arc::{MOST_BENDS, Shape, fitted};
use super::interior::Polygon;
use super::setting::Setting;
use crate::region::{Bound, Piece, Region};

/// Motion of one arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// Both servos at full rate, this way.
    Extreme([f64; 2]),
    /// Servo `pace` at full rate, this way; the other free within its own.
    Singular { pace: usize, way: f64 },
    /// Along a straight bound, or a piece of the clearance, servo `pace` at full rate.
    Along { bound: Hold, pace: usize, way: f64 },
}

/// A corner and the arc that follows it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub(crate) corner: Vector2<f64>,
    /// Bounds that hold the corner, by their place in the region.
    pub(crate) held: Vec<Hold>,
    /// `true` if the corner is the shape at which gaits join.
    pub(crate) anchored: bool,
    pub(crate) motion: Motion,
    /// Seconds.
    pub(crate) time: f64,
    /// Bends of a singular arc.
    pub(crate) bends: Vec<f64>,
    /// Shapes that a polygon passed on the way.
    pub(crate) between: Vec<Vector2<f64>>,
}

impl Link {
    /// Without bends.
    pub(crate) fn new(corner: Vector2<f64>, held: Vec<Hold>, motion: Motion, time: f64) -> Self {
        Self {
            corner,
            held,
            anchored: false,
            motion,
            time,
            bends: Vec::new(),
            between: Vec::new(),
        }
    }
}

/// The bound that holds a corner, by its place in the region; of the clearance, a piece of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hold(pub(crate) usize, pub(crate) Option<Piece>);

/// Multipliers above this push, for shapes of the scale of 1 rad.
const PUSHES: f64 = 1e-4;
/// Corners closer than this to a bound rest on it, over the scale of the shapes.
const RESTS: f64 = 1e-4;
/// Arcs that take a smaller share of the period are left out.
const SHORTEST: f64 = 2e-3;
/// Bends that are read off a polygon.
const FITTED: usize = 3;

impl Motion {
    /// Servo at full rate, with its sign; on an extreme arc both are at full rate.
    pub(crate) fn pace(&self) -> (usize, f64) {
        match *self {
            Self::Extreme(ways) => (0, ways[0]),
            Self::Singular { pace, way } | Self::Along { pace, way, .. } => (pace, way),
        }
    }

    /// The bound that it runs along.
    pub(crate) fn bound(&self) -> Option<Hold> {
        match *self {
            Self::Along { bound, .. } => Some(bound),
            Self::Extreme(_) | Self::Singular { .. } => None,
        }
    }

    /// The word in files.
    pub(crate) fn kind(&self, region: &Region) -> ArcKind {
        match *self {
            Self::Extreme(_) => ArcKind::Extreme,
            Self::Singular { .. } => ArcKind::Singular,
            Self::Along { bound, .. } => {
                let bound = region.bound(bound.0);
                bound.map_or(ArcKind::Upper, |bound| bound.kind())
            }
        }
    }

    pub(crate) fn shape(&self, setting: &Setting, bends: usize) -> Shape {
        match *self {
            Self::Extreme(_) => Shape::Straight,
            Self::Singular { pace, .. } => Shape::Bent {
                joint: 1 - pace,
                bends: bends.min(MOST_BENDS),
            },
            Self::Along {
                bound: Hold(bound, piece),
                pace,
                ..
            } => match (setting.region.bound(bound), piece) {
                (Some(Bound::Clearance(clearance)), Some(piece)) => Shape::Along {
                    clearance,
                    piece,
                    pace,
                },
                _ => Shape::Straight,
            },
        }
    }
}

/// The arcs of a polygon. Returns `None` if they make no chain.
pub(crate) fn arcs(setting: &Setting, polygon: &Polygon) -> Option<Vec<Link>> {
    let layout = &polygon.layout;
    let period = layout.period(&polygon.z);
    let n = layout.arcs();
    let rests = RESTS * setting.region.scale();
    let held: Vec<Vec<Hold>> = (0..n)
        .map(|corner| holds(setting, &layout.corner(&polygon.z, corner), rests))
        .collect();
    let side = |k: usize| {
        let motion = motion(setting, polygon, k, &held[k], &held[(k + 1) % n]);
        let time = polygon.z[layout.time_index(k)];
        Link {
            anchored: k == 0 && setting.asked.anchor.is_some(),
            ..Link::new(layout.corner(&polygon.z, k), held[k].clone(), motion, time)
        }
    };
    let mut links: Vec<Link> = (0..n).map(side).collect();
    // Begin where the motion changes.
    let begins = |&k: &usize| links[k].anchored || links[k].motion != links[(k + n - 1) % n].motion;
    let first = (0..n).find(begins)?;
    links.rotate_left(first);
    merge(&mut links);
    for k in (0..links.len()).rev() {
        if links[k].time <= SHORTEST * period {
            remove(&mut links, k);
        }
    }
    merge(&mut links);
    cut_corners(&mut links);
    bend(&mut links, FITTED);
    Some(links)
}

/// Cuts corners of the polygon. Where two straight bounds meet, a gait gains by cutting the corner with both servos at full rate:
/// it saves time of first order for area of second order. A polygon with long sides may miss it.
fn cut_corners(links: &mut Vec<Link>) {
    let mut at = 0;
    while at < links.len() {
        let next = (at + 1) % links.len();
        let (before, after) = (&links[at], &links[next]);
        if let (
            Motion::Along {
                bound: first_bound @ Hold(_, None),
                pace: one,
                way: first,
            },
            Motion::Along {
                bound: second_bound @ Hold(_, None),
                pace: two,
                way: second,
            },
        ) = (before.motion, after.motion)
            && one != two
            && !after.anchored
        {
            let cut = 0.2 * before.time.min(after.time);
            let mut ways = [first; 2];
            ways[two] = second;
            let corner = after.corner;
            let (mut from, mut to) = (corner, corner);
            from[one] -= first * cut;
            to[two] += second * cut;
            // Before the cut only the first bound holds, after it only the second.
            links[at].time -= cut;
            links[next].time -= cut;
            links[next].corner = to;
            links[next].held = vec![second_bound];
            let extreme = Link::new(from, vec![first_bound], Motion::Extreme(ways), cut);
            links.insert(at + 1, extreme);
        }
        at += 1;
    }
}

/// Bends of singular arcs from the shapes on their way, at most so many.
pub(crate) fn bend(links: &mut [Link], most: usize) {
    let corners: Vec<Vector2<f64>> = links.iter().map(|link| link.corner).collect();
    for (k, link) in links.iter_mut().enumerate() {
        let Motion::Singular { pace, .. } = link.motion else {
            continue;
        };
        let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
        let way = to - from;
        let count = link.between.len().min(most);
        let places: Vec<(f64, f64)> = link
            .between
            .iter()
            .map(|phi| {
                let s = (phi[pace] - from[pace]) / way[pace];
                (s, phi[1 - pace] - from[1 - pace] - s * way[1 - pace])
            })
            .filter(|(s, _)| *s > 0.0 && *s < 1.0)
            .collect();
        if count == 0 || places.len() < count {
            continue;
        }
        if let Some(bends) = fitted(&places, count) {
            link.bends = bends;
        }
    }
}

/// Takes an arc out; where gaits join is then the next corner.
pub(crate) fn remove(links: &mut Vec<Link>, at: usize) {
    let gone = links.remove(at);
    let count = links.len();
    if let Some(next) = links.get_mut(at % count.max(1)) {
        next.anchored |= gone.anchored;
    }
}

/// Joins neighbours of one motion.
pub(crate) fn merge(links: &mut Vec<Link>) {
    let mut at = 0;
    while links.len() > 2 && at < links.len() {
        let next = (at + 1) % links.len();
        if links[at].motion == links[next].motion && !links[next].anchored {
            let joined = links.remove(next);
            let last = if next == 0 { links.len() - 1 } else { at };
            links[last].time += joined.time;
            links[last].between.push(joined.corner);
            links[last].between.extend(joined.between);
            at = 0;
        } else {
            at += 1;
        }
    }
}

/// Bounds that a corner rests on, to within `within`.
pub(crate) fn holds(setting: &Setting, phi: &Vector2<f64>, within: f64) -> Vec<Hold> {
    setting
        .region
        .bounds()
        .enumerate()
        .filter(|(_, bound)| bound.margin(phi) < within)
        .map(|(index, bound)| Hold(index, bound.piece(phi)))
        .collect()
}

fn motion(setting: &Setting, polygon: &Polygon, side: usize, from: &[Hold], to: &[Hold]) -> Motion {
    let layout = &polygon.layout;
    let [start, end] = layout.ends(&polygon.z, side);
    let way = end - start;
    let pushes = &polygon.pushes[side];
    let full = [0, 1].map(|joint| {
        let [up, down] = [pushes[2 * joint], pushes[2 * joint + 1]];
        (up.max(down) * setting.region.scale() > PUSHES).then_some(if up > down {
            1.0
        } else {
            -1.0
        })
    });
    let both = from
        .iter()
        .find(|hold| to.iter().any(|other| other.0 == hold.0));
    // A side whose ends rest on the clearance may cut off what lies beyond: the gait runs along it.
    let cuts = both.is_some_and(|hold| {
        let bound = setting.region.bound(hold.0);
        hold.1.is_some() && bound.is_some_and(|bound| bound.margin(&(0.5 * (start + end))) < 0.0)
    });
    if let [Some(one), Some(two)] = full
        && !cuts
    {
        return Motion::Extreme([one, two]);
    }
    let share = [0, 1].map(|joint| way[joint].abs() / setting.rates[joint]);
    let pace = match full {
        [Some(_), None] => 0,
        [None, Some(_)] => 1,
        _ => usize::from(share[1] > share[0]),
    };
    let way = way[pace].signum();
    if let Some(&bound) = both {
        return Motion::Along { bound, pace, way };
    }
    Motion::Singular { pace, way }
}
