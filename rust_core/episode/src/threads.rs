//! Work shared between the calling thread and helpers.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::spin_loop;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Entries that are worth a thread of their own: some microseconds of work.
const WORTH_A_THREAD: usize = 16;

/// Entries that a thread takes at a time: this part of what is left of a share, so that no thread waits long for another
/// at the end, within these bounds.
const PART_OF_SHARE: usize = 4;
const FEWEST: usize = 4;
const MOST: usize = 64;

/// So long threads look for more work, or wait for the others' last parts, before they sleep: waking one takes tens of
/// microseconds, as long as a tight loop of steps spends between two of them.
const AWAKE: Duration = Duration::from_micros(100);

/// Consecutive entries that can be divided.
pub trait Stretch: Send + Sized {
    /// Number of entries.
    fn count(&self) -> usize;

    /// Cuts off the first entries; no more than there are.
    fn take(&mut self, count: usize) -> Self;
}

/// As many threads as allowed, the calling one included.
#[derive(Debug)]
pub struct Threads {
    count: usize,
    helpers: Option<Helpers>,
}

/// Threads of this process; a fork does not inherit them.
#[derive(Debug)]
struct Helpers {
    process: u32,
    pool: ThreadPool,
    /// How often there was work.
    rounds: Arc<AtomicU64>,
}

impl Helpers {
    /// Keeps helpers awake for a while, or until they were needed again.
    fn stay_awake(&self) {
        let round = self.rounds.fetch_add(1, Ordering::Relaxed) + 1;
        let rounds = Arc::clone(&self.rounds);
        self.pool.spawn_broadcast(move |_| {
            let began = Instant::now();
            while rounds.load(Ordering::Relaxed) == round && began.elapsed() < AWAKE {
                rayon::yield_now();
                spin_loop();
            }
        });
    }
}

impl Threads {
    /// At most `count` threads, started when there is work for them.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { count: count.max(1), helpers: None }
    }

    /// Number of threads.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Works through all entries, part by part, in no fixed order.
    ///
    /// Each thread begins with a share of its own, the same every time, so that what it works on stays in its
    /// core's cache. Then it takes what others have left: one that the machine holds up holds up nobody else.
    pub fn work<S: Stretch>(&mut self, mut all: S, work: impl Fn(S) + Sync) {
        let count = self.count.min(all.count().div_ceil(WORTH_A_THREAD));
        let Some(helpers) = self.helpers(count) else {
            work(all);
            return;
        };
        let length = all.count();
        let bound = |thread: usize| length * thread / count;
        let shares: Vec<Mutex<S>> =
            (0..count).map(|thread| Mutex::new(all.take(bound(thread + 1) - bound(thread)))).collect();
        let next = |share: &Mutex<S>| {
            let mut share = share.lock().unwrap_or_else(PoisonError::into_inner);
            let left = share.count();
            (left > 0).then(|| share.take((left / PART_OF_SHARE).clamp(FEWEST, MOST)))
        };
        let toil = |thread: usize| {
            for place in 0..count {
                let share = &shares[(thread + place) % count];
                while let Some(batch) = next(share) {
                    work(batch);
                }
            }
        };
        let (toil, at_work) = (&toil, &AtomicUsize::new(count - 1));
        helpers.pool.in_place_scope(|scope| {
            for thread in 1..count {
                scope.spawn(move |_| {
                    toil(thread);
                    at_work.fetch_sub(1, Ordering::Release);
                });
            }
            toil(0);
            let began = Instant::now();
            while at_work.load(Ordering::Acquire) > 0 && began.elapsed() < AWAKE {
                spin_loop();
            }
        });
        helpers.stay_awake();
    }

    /// Helpers for `count` threads; none where the calling one is enough or no more are to be had.
    fn helpers(&mut self, count: usize) -> Option<&Helpers> {
        if count < 2 {
            return None;
        }
        let process = std::process::id();
        if let Some(old) = self.helpers.take_if(|helpers| helpers.process != process) {
            // Its threads stayed in the parent process; waiting for them would never end.
            std::mem::forget(old);
        }
        if self.helpers.is_none() {
            let pool = ThreadPoolBuilder::new().num_threads(self.count - 1).build().ok();
            self.helpers = pool.map(|pool| Helpers { process, pool, rounds: Arc::default() });
        }
        self.helpers.as_ref()
    }
}
