//! Model check of promise R6: breadth-first search over all events until no new state is reached. It runs the real brain; two
//! worlds are equal if their [`shape::Shape`] is. Every step must satisfy the invariants: only a granted arm leaves a stop, and
//! with a key nothing acts without its signature.

mod event;
mod judge;
mod shape;
mod world;

use event::{events, requests};
use judge::judge;
use shape::Finer;
use std::collections::{BTreeMap, BTreeSet, HashSet, VecDeque};
use world::World;

fn enumerate(finer: Finer) {
    let requests = requests();
    let events = events(&requests);
    let first = World::new();
    let mut known = HashSet::from([first.shape(finer)]);
    let mut frontier = VecDeque::from([first]);
    let mut transitions = 0_u64;
    let mut reached: BTreeMap<u8, BTreeSet<u8>> = BTreeMap::new();
    let mut causes = BTreeSet::new();
    let mut guarded = BTreeSet::new();
    while let Some(world) = frontier.pop_front() {
        let before = world.brain.output.state;
        for &event in events.iter().filter(|event| world.can_meet(**event)) {
            let mut next = world.clone();
            let seen = next.step(event, &requests);
            judge(before, event, &requests, &seen);
            transitions += 1;
            causes.insert(next.brain.cause as u8);
            let after = next.brain.output.state as u8;
            reached.entry(before as u8).or_default().insert(after);
            if next.seal.is_some() {
                guarded.insert(after);
            }
            if known.insert(next.shape(finer)) {
                frontier.push_back(next);
            }
        }
    }
    assert_eq!(reached.len(), 8, "not every state was reached");
    assert_eq!(guarded.len(), 8, "not every state was reached with a key");
    // Without the battery, its stop cause does not occur.
    let met = if finer == Finer::Presence { 6 } else { 7 };
    assert_eq!(causes.len(), met, "not every cause of stopping was met");
    println!(
        "R6, finer in {finer:?}: {} states of the brain, {transitions} transitions, to a fixed point: nothing but an arm leads out of a stop",
        known.len()
    );
}

#[test]
fn no_path_leads_from_a_latched_stop_to_motion_without_an_arm() {
    enumerate(Finer::Nothing);
}

#[test]
#[ignore = "minutes: part of the soak"]
fn nobody_talks_himself_past_presence_and_nothing_old_feeds_the_lease() {
    enumerate(Finer::Presence);
}

#[test]
#[ignore = "minutes: part of the soak"]
fn no_path_leads_from_a_latched_stop_to_motion_without_an_arm_in_finer_steps() {
    use Finer::{Ages, Causes, Keys, Progress, Resets, Saving};
    for finer in [Causes, Progress, Ages, Resets, Saving, Keys] {
        enumerate(finer);
    }
}
