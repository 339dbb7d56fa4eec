//! Tests of `pipeline`.

use polder::pipeline::ordered::IN_FLIGHT_PER_WORKER;
use polder::pipeline::ordered::in_order;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;

/// Results come in order, each once, and never more than the bound exist.
#[test]
fn results_come_in_order_and_memory_is_bounded() {
    for workers in [1, 2, 5] {
        let alive = AtomicUsize::new(0);
        let most = AtomicUsize::new(0);
        let mut taken = Vec::new();
        let make = |n: u32| {
            let now = alive.fetch_add(1, Ordering::SeqCst) + 1;
            most.fetch_max(now, Ordering::SeqCst);
            // Uneven work: every 50th is slow.
            let spins = if n % 50 == 0 { 200_000 } else { 50 };
            (0..spins).fold(u64::from(n), |a, b| a.wrapping_mul(31).wrapping_add(b))
        };
        let done = in_order(2000, workers, make, |n, _| {
            alive.fetch_sub(1, Ordering::SeqCst);
            taken.push(n);
            Ok::<(), ()>(())
        });
        assert_eq!(done, Ok(()));
        assert!(taken.iter().copied().eq(0..2000));
        assert!(most.into_inner() <= workers * IN_FLIGHT_PER_WORKER);
    }
}

#[test]
fn the_first_error_of_the_writer_ends_the_work() {
    let made = AtomicUsize::new(0);
    let make = |n: u32| {
        made.fetch_add(1, Ordering::SeqCst);
        n
    };
    let done = in_order(
        100_000,
        2,
        make,
        |n, _| if n == 7 { Err(n) } else { Ok(()) },
    );
    assert_eq!(done, Err(7));
    assert!(made.into_inner() < 1000);
}

#[test]
fn no_work_is_done_at_once() {
    assert_eq!(in_order(0, 2, |n| n, |_, _| Err(())), Ok(()));
}
