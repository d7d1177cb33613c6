//! Answers that are found on all threads, and stand in the order of their questions.
//!
//! Rayon hands out the numbers of the questions, in a loop that is compiled once.
//! Each of its own iterators would be some 3,500 lines more for the compiler, in each of
//! the three dozen places that use these functions.

use crate::limits::{self, Watch};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::iter;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

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

/// The same as [`map`], on as many threads of its own, for what a thread makes while
/// others wait for it, as in a cell that is filled once.
///
/// A thread of a pool that waits for its loop takes up other work of the pool
/// meanwhile. If that work asks for the same cell, the thread waits for itself.
/// These threads take up nothing else.
pub fn map_apart<T: Send>(
    count: usize,
    f: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let made = cells((0..count).map(|_| None));
    each_apart(count, &|i| *open(&made[i]) = Some(f(i)));
    contents(made)
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

fn each_apart(count: usize, f: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    let work = || {
        let numbers =
            iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        for i in numbers.take_while(|i| *i < count) {
            f(i);
        }
        // A thread's processor time counts from where it asks.
        let _ = limits::is_stopped();
    };
    let watch = Watch::current();
    let helper = || {
        Watch::adopt(watch.as_ref());
        work();
    };
    let helpers = rayon::current_num_threads().min(count).saturating_sub(1);
    thread::scope(|scope| {
        // Where there are no more threads, those that there are do the work.
        let spawn = |_| thread::Builder::new().spawn_scoped(scope, helper).ok();
        let running: Vec<_> = (0..helpers).map_while(spawn).collect();
        work();
        for thread in running {
            if let Err(panic) = thread.join() {
                resume_unwind(panic);
            }
        }
    });
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
    use std::sync::OnceLock;
    use std::sync::mpsc::channel;
    use std::time::{Duration, Instant};

    #[test]
    fn answers_stand_in_order_on_any_threads() {
        let asked: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            assert_eq!(map_in(&pool, 1000, |i| i.to_string()), asked);
            let twice = pool.install(|| map(1000, |i| 2 * i));
            assert_eq!(pool.install(|| map_apart(1000, |i| 2 * i)), twice);
            assert_eq!(twice, (0..1000).map(|i| 2 * i).collect::<Vec<_>>());
        }
        assert!(map(0, |i| i).is_empty());
    }

    #[test]
    fn a_cell_that_is_filled_apart_never_waits_for_itself() {
        /// Of 8 questions half need the cell. The first of the others takes as long
        /// as the cell is empty, so that its thread keeps questions to be taken up.
        fn ask(i: usize, cell: &OnceLock<Vec<usize>>) {
            let slow = |i: usize| {
                thread::sleep(Duration::from_micros(100));
                i
            };
            match i {
                1..4 => {}
                4 => {
                    let from = Instant::now();
                    let most = Duration::from_millis(20);
                    while cell.get().is_none() && from.elapsed() < most {
                        thread::yield_now();
                    }
                }
                _ => {
                    cell.get_or_init(|| map_apart(64, slow));
                }
            }
        }
        let (sender, done) = channel();
        // The loops are in a thread that can be left behind if it hangs.
        thread::spawn(move || {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(3);
            let pool = pool.build().unwrap();
            for _ in 0..50 {
                let cell = OnceLock::new();
                map_in(&pool, 8, |i| ask(i, &cell));
            }
            sender.send(()).unwrap();
        });
        done.recv_timeout(Duration::from_secs(30)).unwrap();
    }

    #[test]
    fn items_are_given_away_or_changed_in_place() {
        let mut items = vec![String::from("a"), String::from("b")];
        change(&mut items, |i, item| item.push_str(&i.to_string()));
        let made = map_owned(items, |i, item| (item, i));
        assert_eq!(made, [(String::from("a0"), 0), (String::from("b1"), 1)]);
    }
}
