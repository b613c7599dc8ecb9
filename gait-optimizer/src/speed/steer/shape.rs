//! At which shape gaits shall join: the one that costs the three of them least.

use nalgebra::Vector2;

use super::super::polish::Polished;
use super::super::selection::{self, Group};
use super::super::setting::Setting;
use super::super::starts::{self, IMAGES, Image};
use super::{certified, chains, finished, near};
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

/// The common shape stays this far within the bounds, over the scale of the shapes; so are the lengths below.
pub(super) const MARGIN: f64 = 0.02;
/// Shapes that are looked at along each joint, those of them that are tried by rough polygons, of those the ones whose polygons are
/// finished, and of those the ones that are moved.
const GRID: usize = 41;
const TRIED: usize = 12;
const FINISHED: usize = 6;
const MOVED: usize = 4;
/// Tried shapes are no nearer to each other.
const APART: f64 = 0.3;
/// The best of them are moved by these steps as long as that costs less.
const STEPS: [f64; 2] = [0.12, 0.04];
/// Largest number of moves with each step.
const MOVES: usize = 6;
/// Corners of a start, and of those that look again near a gait.
const CORNERS: usize = 14;
const CORNERS_AGAIN: [usize; 5] = [10, 14, 20, 28, 35];
/// Free gaits of a kind that a joined one is looked for near.
const MODELS: usize = 3;
/// Starts of any kind through the shape that is settled on.
const OTHERS: usize = 32;
/// Gaits of one kind with as many arcs are the same whose speeds differ by less than this share.
const SAME: f64 = 1e-9;
/// A gait that is slower than the fastest by more than this share is not certified.
const BEHIND: f64 = 1e-3;
/// Gaits of one kind are alike whose speeds differ by less than this share.
const ALIKE: f64 = 1e-6;

/// Inputs of the search for the common shape.
pub(super) struct Joining<'a, 'm> {
    pub(super) settings: &'a (dyn Fn(usize, Vector2<f64>) -> Setting<'m> + Sync),
    pub(super) region: &'a Region,
    /// Of each kind the gaits that need not join, fastest first.
    pub(super) free: &'a [Vec<Polished>],
    pub(super) seed: u64,
    pub(super) threads: usize,
}

type Three = [Polished; 3];

/// A shape with the rough polygons of each kind through it.
struct RoughlyJoined {
    shape: Vector2<f64>,
    /// Cost of joining there, from the fastest polygons.
    cost: f64,
    groups: [Vec<Group>; 3],
}

/// Outline of a free gait, from which the cost of joining it is estimated.
struct Outlined {
    /// Over that of the fastest.
    speed: f64,
    period: f64,
    points: Vec<Vector2<f64>>,
}

impl Joining<'_, '_> {
    /// Rough polygons of a kind through a shape, the fastest first.
    fn roughly_at(&self, kind: usize, anchor: Vector2<f64>) -> Vec<Group> {
        let setting = (self.settings)(kind, anchor);
        let starts = models(&self.free[kind]).flat_map(|model| self.starts(anchor, model, CORNERS));
        let starts: Vec<_> = starts.collect();
        selection::rough_groups(&setting, &starts, self.threads, &|_| ())
    }

    /// Gaits of a kind through a shape, the fastest first.
    fn gaits_at(&self, kind: usize, anchor: Vector2<f64>) -> Vec<Polished> {
        let groups = self.roughly_at(kind, anchor);
        finished(&(self.settings)(kind, anchor), &groups, self.threads)
    }

    /// Closed polygons through a shape near a gait and its images.
    fn starts(
        &self,
        anchor: Vector2<f64>,
        gait: &Polished,
        corners: usize,
    ) -> [Vec<Vector2<f64>>; 4] {
        let outline = outline(gait);
        let through = |image: Image| {
            let points: Vec<_> = outline.iter().map(image).collect();
            self.through(anchor, &points, corners)
        };
        let [along, across, both] = IMAGES;
        let itself: Image = |phi| *phi;
        [itself, along, across, both].map(through)
    }

    /// The fastest of each kind through a shape to which rough polygons lead, certified or not.
    fn at(&self, rough: &RoughlyJoined) -> Result<Three, usize> {
        let of = |kind: usize| {
            let setting = (self.settings)(kind, rough.shape);
            let gaits = finished(&setting, &rough.groups[kind], self.threads);
            gaits.into_iter().next().ok_or(kind)
        };
        Ok([of(0)?, of(1)?, of(2)?])
    }

    /// Rough polygons of each kind through a shape.
    fn roughly(&self, shape: Vector2<f64>) -> RoughlyJoined {
        let groups = [0, 1, 2].map(|kind| self.roughly_at(kind, shape));
        let speeds = groups
            .each_ref()
            .map(|groups| groups.first().map_or(0.0, Group::speed));
        RoughlyJoined {
            shape,
            cost: self.cost(speeds),
            groups,
        }
    }

    /// The fastest of each kind through a shape, of those known and those found: one that is certified, unless another is faster.
    /// Where another is, polygons of other numbers of corners near it may show arcs that it lacks.
    ///
    /// # Errors
    /// Index of a kind without a gait.
    pub(super) fn certified_at(
        &self,
        anchor: Vector2<f64>,
        known: Option<&Three>,
    ) -> Result<Three, usize> {
        let of = |kind: usize| {
            let setting = (self.settings)(kind, anchor);
            let mut all = self.gaits_at(kind, anchor);
            // Where the shape lies far from the fastest gaits, the best that passes it may be like none of them.
            let others = (0..OTHERS).map(|index| starts::start(self.region, self.seed, index));
            let others = others.map(|points| self.through(anchor, &points, points.len()));
            all.extend(chains(&setting, &others.collect::<Vec<_>>(), self.threads));
            all.extend(known.map(|three| three[kind].clone()));
            let (fastest, certified) = self.fastest(&setting, all)?;
            if certified {
                return Some(fastest);
            }
            let again = self.again(&setting, anchor, &fastest);
            // An uncertified one counts only where it is clearly faster.
            let clearly = |other: &Polished| other.speed > fastest.speed * (1.0 + ALIKE);
            let better = self.fastest(&setting, again);
            let better = better.filter(|(other, certified)| {
                clearly(other) || *certified && other.speed > fastest.speed * (1.0 - ALIKE)
            });
            Some(better.map_or(fastest, |(better, _)| better))
        };
        let of = |kind| of(kind).ok_or(kind);
        Ok([of(0)?, of(1)?, of(2)?])
    }

    /// Gaits near one, from polygons of other numbers of corners.
    fn again(&self, setting: &Setting, anchor: Vector2<f64>, gait: &Polished) -> Vec<Polished> {
        let starts = CORNERS_AGAIN.map(|corners| self.starts(anchor, gait, corners));
        chains(setting, starts.as_flattened(), self.threads)
    }

    /// The speed of the fastest gait that was met and need not join: where the joined one outdoes those that starts led to, it may
    /// lead to a faster one itself.
    pub(super) fn unjoined(&self, kind: usize, free: &Setting, joined: &Polished) -> f64 {
        let known = self.free[kind][0].speed;
        if joined.speed <= known {
            return known;
        }
        let corner = joined.links.iter().find(|link| link.anchored);
        let again = corner.map(|link| self.again(free, link.corner, joined));
        let fastest = again.into_iter().flatten().next();
        fastest.map_or(0.0, |chain| chain.speed).max(joined.speed)
    }

    /// The fastest of some gaits, and whether it is certified: one that is goes before another that is as fast.
    fn fastest(&self, setting: &Setting, mut all: Vec<Polished>) -> Option<(Polished, bool)> {
        all.sort_by(|a, b| b.speed.total_cmp(&a.speed));
        // Many starts lead to one gait, and the short arcs that a certificate may need gain little.
        all.dedup_by(|other, one| {
            other.links.len() == one.links.len() && one.speed - other.speed < SAME * one.speed
        });
        let least = all.first()?.speed * (1.0 - BEHIND);
        all.retain(|one| one.speed >= least);
        let certified = in_parallel(
            all.len(),
            self.threads,
            &|_| (),
            || (),
            |(), index| certified(setting, all[index].clone()),
        );
        let fastest = all.into_iter().reduce(faster)?;
        let certified = certified.into_iter().flatten().reduce(faster);
        Some(match certified {
            Some(chain) if chain.speed > fastest.speed * (1.0 - ALIKE) => (chain, true),
            _ => (fastest, false),
        })
    }

    /// The shape at which joining costs least of those that are tried, with the gaits, and how many were tried.
    ///
    /// # Errors
    /// A kind of which no gait passes some shape that all before it pass.
    pub(super) fn cheapest(&self, watch: Watch<'_>) -> Result<(Vector2<f64>, Three, usize), usize> {
        let mut without = 0;
        let mut found = Vec::new();
        let shapes = self.promising();
        let mut rough = Vec::with_capacity(shapes.len());
        for (number, shape) in shapes.iter().enumerate() {
            rough.push(self.roughly(*shape));
            watch(0.3 * (number + 1) as f64 / shapes.len() as f64);
        }
        rough.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        for (number, rough) in rough.iter().enumerate() {
            if found.len() >= FINISHED {
                break;
            }
            match self.at(rough) {
                Ok(three) => found.push((rough.shape, three)),
                Err(kind) => without = without.max(kind),
            }
            watch(0.3 + 0.3 * ((number + 1) as f64 / FINISHED as f64).min(1.0));
        }
        let cheaper =
            |(_, a): &(_, Three), (_, b): &(_, Three)| self.cost_of(a).total_cmp(&self.cost_of(b));
        found.sort_by(cheaper);
        found.truncate(MOVED);
        let moved = in_parallel(
            found.len(),
            self.threads,
            &|_| (),
            || (),
            |(), index| self.descended(found[index].clone()),
        );
        let tried = shapes.len() + moved.iter().map(|(.., tried)| tried).sum::<usize>();
        watch(0.9);
        let places = moved.into_iter().map(|(shape, three, _)| (shape, three));
        let (shape, three) = places.min_by(cheaper).ok_or(without)?;
        let three = self.certified_at(shape, Some(&three))?;
        watch(1.0);
        Ok((shape, three, tried))
    }

    /// The common shape moved as long as that costs less, and how many were tried.
    fn descended(
        &self,
        (mut shape, mut three): (Vector2<f64>, Three),
    ) -> (Vector2<f64>, Three, usize) {
        let mut tried = 0;
        for step in STEPS {
            for _ in 0..MOVES {
                let ways = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
                let better = ways.into_iter().find_map(|way| {
                    let there = shape + Vector2::from(way) * (step * self.region.scale());
                    tried += 1;
                    let moved = self.moved(there, &three)?;
                    (self.cost_of(&moved) < self.cost_of(&three) - 1e-4).then_some((there, moved))
                });
                let Some(better) = better else { break };
                (shape, three) = better;
            }
        }
        (shape, three, tried)
    }

    /// Cost of joining for gaits of these speeds, one of each kind, as shares of the speeds of those that need not join.
    fn cost(&self, speeds: [f64; 3]) -> f64 {
        let costs = speeds.iter().zip(self.free);
        costs.map(|(speed, free)| 1.0 - speed / free[0].speed).sum()
    }

    fn cost_of(&self, three: &Three) -> f64 {
        self.cost(three.each_ref().map(|joined| joined.speed))
    }

    /// The three near others whose common shape is close by.
    fn moved(&self, anchor: Vector2<f64>, three: &Three) -> Option<Three> {
        if self.region.overstepped(&anchor) > -MARGIN * self.region.scale() {
            return None;
        }
        let of = |kind: usize| near(&(self.settings)(kind, anchor), &three[kind]);
        Some([of(0)?, of(1)?, of(2)?])
    }

    /// Shapes where joining may cost little, best first: a detour to a shape and back costs its time.
    fn promising(&self) -> Vec<Vector2<f64>> {
        let outlines: Vec<Vec<Outlined>> = self
            .free
            .iter()
            .map(|chains| {
                let best = chains[0].speed;
                let model = |chain: &Polished| {
                    let period = chain.layout.period(&chain.z);
                    Outlined {
                        speed: chain.speed / best,
                        period,
                        points: outline(chain),
                    }
                };
                models(chains).map(model).collect()
            })
            .collect();
        let farthest = outlines
            .iter()
            .flatten()
            .flat_map(|outlined| &outlined.points);
        let reach = farthest.fold(0.0, |most: f64, phi| most.max(phi.amax()));
        let setting = (self.settings)(0, Vector2::zeros());
        let mut shapes: Vec<(f64, Vector2<f64>)> = Vec::new();
        for k in 0..GRID * GRID {
            let place = |k: usize| reach * (2.0 * k as f64 / (GRID - 1) as f64 - 1.0);
            let phi = Vector2::new(place(k / GRID), place(k % GRID));
            if self.region.overstepped(&phi) > -MARGIN * self.region.scale() {
                continue;
            }
            let cost = |models: &Vec<Outlined>| {
                let of = |outlined: &Outlined| {
                    let way = outlined
                        .points
                        .iter()
                        .map(|point| setting.time(&(point - phi)));
                    let detour = 2.0 * way.fold(f64::INFINITY, f64::min);
                    1.0 - outlined.speed * outlined.period / (outlined.period + detour)
                };
                models.iter().map(of).fold(f64::INFINITY, f64::min)
            };
            shapes.push((outlines.iter().map(cost).sum(), phi));
        }
        shapes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let apart_by = APART * self.region.scale();
        let mut apart: Vec<Vector2<f64>> = Vec::new();
        for (_, phi) in shapes {
            if apart.len() < TRIED && apart.iter().all(|other| (other - phi).amax() > apart_by) {
                apart.push(phi);
            }
        }
        apart
    }

    /// A closed polygon that passes the shape first, well within the bounds.
    fn through(
        &self,
        anchor: Vector2<f64>,
        points: &[Vector2<f64>],
        corners: usize,
    ) -> Vec<Vector2<f64>> {
        let every = points.len() / corners;
        let mut corners: Vec<Vector2<f64>> = points
            .iter()
            .step_by(every.max(1))
            .take(corners)
            .copied()
            .collect();
        let off = |corner: &Vector2<f64>| (corner - anchor).norm();
        let nearest = (0..corners.len())
            .min_by(|&a, &b| off(&corners[a]).total_cmp(&off(&corners[b])))
            .unwrap_or(0);
        corners.rotate_left(nearest);
        let mut corners = starts::within(self.region, corners);
        if let Some(first) = corners.first_mut() {
            *first = anchor;
        }
        corners
    }
}

fn faster(one: Polished, other: Polished) -> Polished {
    if other.speed > one.speed { other } else { one }
}

/// The fastest gaits that a joined one is looked for near: many starts lead to one gait.
fn models(chains: &[Polished]) -> impl Iterator<Item = &Polished> {
    let alike = chains.chunk_by(|a, b| a.speed - b.speed < ALIKE * a.speed);
    alike.filter_map(<[Polished]>::first).take(MODELS)
}

/// Shapes along a chain, evenly in time.
fn outline(chain: &Polished) -> Vec<Vector2<f64>> {
    const POINTS: usize = 10 * CORNERS;
    let period = chain.layout.period(&chain.z);
    let mut points = Vec::with_capacity(POINTS);
    let mut arc = 0;
    let mut before = 0.0;
    for k in 0..POINTS {
        let time = period * k as f64 / POINTS as f64;
        while arc + 1 < chain.links.len() && time > before + chain.links[arc].time {
            before += chain.links[arc].time;
            arc += 1;
        }
        let s = ((time - before) / chain.links[arc].time).clamp(0.0, 1.0);
        points.push(chain.layout.place(&chain.z, arc, s).phi);
    }
    points
}
