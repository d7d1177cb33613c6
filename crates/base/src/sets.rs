//! Sets of numbers, joined one after another (union-find).

/// Each number has another one of its set, or itself.
#[derive(Clone, Debug)]
pub struct Sets(Vec<usize>);

impl Sets {
    /// The numbers below `count`, each in a set of its own.
    pub fn new(count: usize) -> Sets {
        Sets((0..count).collect())
    }

    /// The least number of the set that a number belongs to.
    pub fn of(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    /// Joins the sets of two numbers; false if they are one set already.
    pub fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b);
        a != b
    }
}
