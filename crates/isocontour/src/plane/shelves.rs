//! Things sorted by the places that they are in, such as the cells of a grid.

use std::ops::RangeInclusive;

/// Things on numbered shelves, all in one list.
#[derive(Clone, Debug)]
pub struct Shelves<T> {
    /// Where each shelf begins in the list; one more than shelves.
    starts: Vec<u32>,
    list: Vec<T>,
}

impl<T: Copy + Default> Shelves<T> {
    /// So many shelves with things, each of which comes with the number of its
    /// shelf. They keep their order on a shelf.
    pub fn new(count: usize, things: &[(u32, T)]) -> Shelves<T> {
        let mut starts = vec![0_u32; count + 1];
        for (shelf, _) in things {
            starts[*shelf as usize + 1] += 1;
        }
        for shelf in 0..count {
            starts[shelf + 1] += starts[shelf];
        }
        let mut list = vec![T::default(); things.len()];
        let mut free = starts.clone();
        for &(shelf, thing) in things {
            let place = &mut free[shelf as usize];
            list[*place as usize] = thing;
            *place += 1;
        }
        Shelves { starts, list }
    }

    /// What is on a shelf.
    #[inline]
    pub fn at(&self, shelf: usize) -> &[T] {
        self.over(shelf..=shelf)
    }

    /// What is on some shelves beside each other.
    #[inline]
    pub fn over(&self, shelves: RangeInclusive<usize>) -> &[T] {
        let from = self.starts[*shelves.start()] as usize;
        &self.list[from..self.starts[*shelves.end() + 1] as usize]
    }

    /// Number of shelves.
    #[inline]
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// True if nothing is on any shelf.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}
