//! Answers that are found on all threads, and stand in the order of their questions.
//!
//! Rayon hands out the numbers of the questions, in a loop that is compiled once.
//! Each of its own iterators would be some 3,500 lines more for the compiler, in each of
//! the three dozen places that use these functions.

use rayon::ThreadPool;
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What `f` makes of the numbers below `count`, in their order.
pub fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let made = cells((0..count).map(|_| None));
    each(count, &|i| *open(&made[i]) = Some(f(i)));
    contents(made)
}

/// The same as [`map`], on the threads of a pool.
pub fn map_in<T: Send>(
    pool: &ThreadPool,
    count: usize,
    f: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let made = cells((0..count).map(|_| None));
    each_in(pool, count, &|i| *open(&made[i]) = Some(f(i)));
    contents(made)
}

/// What `f` makes of the numbers of some items and of the items, which it gets for
/// its own.
pub fn map_owned<U: Send, T: Send>(
    items: impl IntoIterator<Item = U>,
    f: impl Fn(usize, U) -> T + Sync,
) -> Vec<T> {
    let items = cells(items.into_iter().map(Some));
    let of_item = |i: usize| {
        let item = open(&items[i]).take();
        item.map(|item| f(i, item))
    };
    map(items.len(), of_item).into_iter().flatten().collect()
}

/// Changes each of some items by `f`, which also gets the item's number.
pub fn change<T: Send>(items: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    let items = cells(items);
    each(items.len(), &|i| f(i, &mut open(&items[i])));
}

fn each(count: usize, f: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(f);
}

fn each_in(pool: &ThreadPool, count: usize, f: &(dyn Fn(usize) + Sync)) {
    pool.install(|| each(count, f));
}

/// Places that only one thread has at a time.
fn cells<T>(all: impl IntoIterator<Item = T>) -> Vec<Mutex<T>> {
    all.into_iter().map(Mutex::new).collect()
}

fn open<T>(cell: &Mutex<T>) -> MutexGuard<'_, T> {
    cell.lock().unwrap_or_else(PoisonError::into_inner)
}

fn contents<T>(cells: Vec<Mutex<Option<T>>>) -> Vec<T> {
    let all = cells.into_iter();
    all.filter_map(|cell| {
        cell.into_inner().unwrap_or_else(PoisonError::into_inner)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_stand_in_order_on_any_threads() {
        let asked: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            assert_eq!(map_in(&pool, 1000, |i| i.to_string()), asked);
            let twice = pool.install(|| map(1000, |i| 2 * i));
            assert_eq!(twice, (0..1000).map(|i| 2 * i).collect::<Vec<_>>());
        }
        assert!(map(0, |i| i).is_empty());
    }

    #[test]
    fn items_are_given_away_or_changed_in_place() {
        let mut items = vec![String::from("a"), String::from("b")];
        change(&mut items, |i, item| item.push_str(&i.to_string()));
        let made = map_owned(items, |i, item| (item, i));
        assert_eq!(made, [(String::from("a0"), 0), (String::from("b1"), 1)]);
    }
}
