//! Work side by side, on threads that live as long as the call: a fork has none to wait for.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::{Builder, scope};
use std::time::Duration;

/// So often the caller is asked whether to go on.
const BETWEEN_CHECKS: Duration = Duration::from_millis(50);

/// Results of all work, in its order, worked out on so many threads; on the calling one where there is none to be had.
///
/// `work_out` is told when the work was given up, and then may return nothing.
///
/// # Errors
/// What `go_on` says, which is asked every now and then; work that has begun then is given up.
pub(crate) fn side_by_side<W: Sync, R: Send, E>(
    work: &[W],
    threads: usize,
    work_out: impl Fn(&W, &AtomicBool) -> Option<R> + Sync,
    mut go_on: impl FnMut() -> Result<(), E>,
) -> Result<Vec<R>, E> {
    let (next, over) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut all: Vec<Option<R>> = Vec::new();
    all.resize_with(work.len(), || None);
    scope(|threads_of_call| {
        let (sender, receiver) = channel();
        for _ in 0..threads.min(work.len()) {
            let sender = sender.clone();
            let (next, over, work_out) = (&next, &over, &work_out);
            let worker = move || {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    if place >= work.len() || over.load(Ordering::Relaxed) {
                        return;
                    }
                    let Some(result) = work_out(&work[place], over) else { return };
                    if sender.send((place, result)).is_err() {
                        return;
                    }
                }
            };
            if Builder::new().spawn_scoped(threads_of_call, worker).is_err() {
                break;
            }
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(BETWEEN_CHECKS) {
                Ok((place, result)) => all[place] = Some(result),
                // All are done, or one panicked, which goes on where the scope ends.
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Err(error) = go_on() {
                over.store(true, Ordering::Relaxed);
                return Err(error);
            }
        }
        // What no thread took, since there was none.
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(one) = work.get(place) else { return Ok(()) };
            go_on()?;
            all[place] = work_out(one, &over);
        }
    })?;
    Ok(all.into_iter().flatten().collect())
}
