//! Independent jobs on several threads, with the same result for any number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Callback for the completed fraction of the work, 0 to 1, called from any thread; it may start again from 0.
pub type Watch<'a> = &'a (dyn Fn(f64) + Sync);

/// Runs `job` for 0 … count − 1; each thread has its own workspace. The results are in order. `watch` receives the completed
/// fraction of the jobs.
pub(crate) fn in_parallel<R, T: Send>(
    count: usize,
    threads: usize,
    watch: Watch<'_>,
    room: impl Fn() -> R + Sync,
    job: impl Fn(&mut R, usize) -> T + Sync,
) -> Vec<T> {
    let (next, finished) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let worker = || {
        let mut room = room();
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, job(&mut room, index)));
            let finished = 1 + finished.fetch_add(1, Ordering::Relaxed);
            watch(finished as f64 / count as f64);
        }
    };
    let all: Vec<(usize, T)> = std::thread::scope(|scope| {
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
    let mut places: Vec<Option<T>> = (0..count).map(|_| None).collect();
    for (index, one) in all {
        places[index] = Some(one);
    }
    places.into_iter().flatten().collect()
}
