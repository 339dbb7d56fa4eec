//! Work on many cores, results in order, bounded memory: the shape of phase C.
//!
//! Workers take the next number, make its result and send it through a bounded queue; one writer
//! puts results in order and takes them. A worker needs a *permit* before it takes a number, and the
//! writer gives the permit back when that result has been taken: so no more than
//! [`IN_FLIGHT_PER_WORKER`] x workers results exist at any time, however slow the disk and however
//! uneven the work. It cannot lock up: numbers are given out in order, so the one that the writer
//! waits for is always held by a worker or in the queue.

use crossbeam::channel::Receiver;
use crossbeam::channel::Sender;
use crossbeam::channel::bounded;
use std::collections::BTreeMap;
use std::panic::AssertUnwindSafe;
use std::panic::catch_unwind;
use std::panic::resume_unwind;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering;

/// Results that may wait for an earlier, slower one, a worker. 16 keeps workers busy while one
/// meshes a patch of the full seam budget (some 16 average patches), and holds about 16 x 2 MB.
pub const IN_FLIGHT_PER_WORKER: usize = 16;

/// Calls `make(n)` for `n` in `0..count` on `workers` threads of the current rayon pool and
/// `take(n, result)` on one thread, in order of `n`. Stops at the first error of `take`.
pub fn in_order<T: Send, E: Send>(
    count: u32,
    workers: usize,
    make: impl Fn(u32) -> T + Sync,
    mut take: impl FnMut(u32, T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let permits = workers.max(1) * IN_FLIGHT_PER_WORKER;
    let (give_permit, get_permit) = bounded::<()>(permits);
    for _ in 0..permits {
        give_permit.send(()).expect("the queue holds all permits");
    }
    let (send, receive) = bounded::<(u32, std::thread::Result<T>)>(permits);
    let next = AtomicU32::new(0);
    let stopped = AtomicBool::new(false);
    let work = || {
        while get_permit.recv().is_ok() && !stopped.load(Ordering::Relaxed) {
            let n = next.fetch_add(1, Ordering::Relaxed);
            if n >= count {
                break;
            }
            // A panic goes to the writer too: it must not wait for a result that never comes.
            let result = catch_unwind(AssertUnwindSafe(|| make(n)));
            if send.send((n, result)).is_err() {
                break;
            }
        }
    };
    // The writer mostly waits, so it has a thread of its own instead of a worker's.
    std::thread::scope(|threads| {
        let (give_permit, stopped) = (&give_permit, &stopped);
        let writer = threads.spawn(move || {
            let writing = || take_in_order(count, &receive, give_permit, &mut take);
            let outcome = catch_unwind(AssertUnwindSafe(writing));
            stopped.store(true, Ordering::Relaxed);
            for _ in 0..permits {
                let _ = give_permit.try_send(());
            }
            outcome.unwrap_or_else(|panic| resume_unwind(panic))
        });
        rayon::scope(|scope| {
            for _ in 0..workers.max(1) {
                scope.spawn(|_| work());
            }
        });
        writer.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

fn take_in_order<T, E>(
    count: u32,
    receive: &Receiver<(u32, std::thread::Result<T>)>,
    give_permit: &Sender<()>,
    take: &mut impl FnMut(u32, T) -> Result<(), E>,
) -> Result<(), E> {
    let mut early: BTreeMap<u32, T> = BTreeMap::new();
    let mut wanted = 0;
    while wanted < count {
        let (n, result) = (receive.recv()).expect("a worker holds the wanted number");
        early.insert(n, result.unwrap_or_else(|panic| resume_unwind(panic)));
        while let Some(result) = early.remove(&wanted) {
            take(wanted, result)?;
            wanted += 1;
            // Workers may be gone already: then nobody needs the permit.
            let _ = give_permit.try_send(());
        }
    }
    Ok(())
}
