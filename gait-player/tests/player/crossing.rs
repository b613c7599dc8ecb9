//! Promise R5 near crossings: a stop ramps straight to neutral at once, without a check of the path. Within the firmware's
//! largest angle no such path brings the side links closer than at its start.

use gait_player::Limits;
use gait_player::clearance::{clearance, margin};
use gait_player::ramp::Ramp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::Links;

/// Smallest clearance on stop ramps from random poses, in margins, and the number of poses. The poses have clearances of 0.5 to
/// 4 margins (ramps keep half a margin, gaits a whole one). Side links are 0.3 to 2.5 middle links long (the robot's are 1.93).
fn least_clearance(max_angle: f32) -> (f32, u32) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (mut least, mut poses) = (f32::INFINITY, 0);
    for _ in 0..2_000_000 {
        let [front, back] = [(); 2].map(|()| random.random_range(0.3..2.5_f32));
        let links = Links {
            middle: 1.0,
            front,
            back,
        };
        // Both links on one side and folded far: other poses have a large clearance.
        let pose = [(); 2].map(|()| random.random_range(1.2..max_angle));
        let at_start = clearance(&links, pose) / margin(&links);
        if !(0.5..4.0).contains(&at_start) {
            continue;
        }
        poses += 1;
        let ramp = Ramp::to_neutral(pose, &Limits::ROBOT);
        for step in 0..40_u64 {
            let shape = ramp.at(u64::from(ramp.duration_us()) * step / 80);
            least = least.min(clearance(&links, shape) / margin(&links));
        }
    }
    (least, poses)
}

#[test]
fn no_stop_brings_the_side_links_nearer() {
    let (least, poses) = least_clearance(Limits::ROBOT.max_angle);
    println!("R5: least clearance on {poses} stops that begin at 0.5 margins or more: {least:.3}");
    assert!(poses > 10_000 && least > 0.499, "{least} on {poses}");
    // The limit on the angle is essential: links folded further could meet on such a path.
    let (least, _) = least_clearance(3.1);
    assert!(least <= 0.0, "{least}");
}
