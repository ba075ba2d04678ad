//! Parallel work on the threads that the processor has.
//!
//! This is the only place where the core starts threads, and they end before it returns. Which thread processes an item is
//! arbitrary, but the results do not depend on it, nor on the number of threads.

use std::sync::{Mutex, PoisonError};

/// Number of threads that the processor runs at once.
#[must_use]
pub fn available() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Calls `work` once with each item, on at most `threads` threads; a single item needs none.
pub fn for_each<I: Send>(items: &mut [I], threads: usize, work: impl Fn(&mut I) + Sync) {
    let threads = threads.min(items.len());
    if threads <= 1 {
        return items.iter_mut().for_each(work);
    }
    let items = Mutex::new(items.iter_mut());
    // Nothing that holds the lock can panic, so a poisoned lock is consistent.
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work_on_rest = || {
        while let Some(item) = next() {
            work(item);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(work_on_rest);
        }
        work_on_rest();
    });
}

/// Results of `make` for each number below `count`, in order, computed on at most `threads` threads.
pub fn map<R: Send>(count: usize, threads: usize, make: impl Fn(usize) -> R + Sync) -> Vec<R> {
    if count <= 1 {
        return (0..count).map(make).collect();
    }
    let mut made: Vec<(usize, Option<R>)> = (0..count).map(|index| (index, None)).collect();
    for_each(&mut made, threads, |(index, place)| {
        *place = Some(make(*index));
    });
    made.into_iter().filter_map(|(_, made)| made).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once_and_keeps_its_place() {
        for threads in [0, 1, 3, 200] {
            let mut items: Vec<usize> = (0..100).collect();
            for_each(&mut items, threads, |item| *item += 1);
            assert_eq!(items, (1..=100).collect::<Vec<_>>());
            let squares = map(100, threads, |k| k * k);
            assert_eq!(squares, (0..100).map(|k| k * k).collect::<Vec<_>>());
        }
    }
}
