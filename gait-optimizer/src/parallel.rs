//! Many independent jobs on as many threads as asked for, with the same result on any number of them.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs `job` for 0 … count − 1; each thread has its own room, made by `room`. The results are in order.
pub(crate) fn in_parallel<R, T: Send>(
    count: usize,
    threads: usize,
    room: impl Fn() -> R + Sync,
    job: impl Fn(&mut R, usize) -> T + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut room = room();
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, job(&mut room, index)));
        }
    };
    let mut all: Vec<(usize, T)> = std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads.clamp(1, 64))
            .map(|_| scope.spawn(worker))
            .collect();
        let mut all = worker();
        for other in others {
            match other.join() {
                Ok(done) => all.extend(done),
                // A bug in the job: let it be seen as one.
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        all
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, one)| one).collect()
}
