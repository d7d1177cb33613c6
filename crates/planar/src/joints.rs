//! Pieces whose ends are joined in pairs, put together to chains.
//!
//! ```text
//!   0 ━━━ 1   3 ━━━ 2   4 ━━━ 5        two joints, 1 to 3 and 2 to 4:
//!   ━━━━━━━╌╌╌━━━━━━━╌╌╌━━━━━━━        one chain, whose second piece is reversed
//! ```
//!
//! In: for each end the end in which it goes on. Out: chains, each piece in one of
//! them once. The callers decide which ends go on in which: walls, skin, infill and
//! borders that were cut have rules of their own for that.

/// An end of a piece. Piece `i` has two, its first end `2 i` and its last one
/// `2 i + 1`.
pub type End = usize;

/// The ends that go on in one another.
#[derive(Clone, Debug)]
pub struct Joints(Vec<Option<End>>);

/// Pieces that go on in one another.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The numbers of the pieces, in order; true for those that are reversed.
    pub pieces: Vec<(usize, bool)>,
    /// True if the last piece goes on in the first one.
    pub closed: bool,
}

impl Joints {
    /// Pieces without joints.
    pub fn new(pieces: usize) -> Joints {
        Joints(vec![None; 2 * pieces])
    }

    /// True if an end goes on in no other.
    pub fn is_free(&self, end: End) -> bool {
        self.0[end].is_none()
    }

    /// Lets two ends go on in one another. Both have to be free.
    pub fn join(&mut self, a: End, b: End) {
        debug_assert!(self.is_free(a) && self.is_free(b), "{a} {b}");
        self.0[a] = Some(b);
        self.0[b] = Some(a);
    }

    /// The chains. Open ones come first, each at the number of the lowest piece with
    /// a free end, where it begins; rings begin at the last end of their lowest
    /// piece.
    pub fn chains(&self) -> Vec<Chain> {
        let pieces = 0..self.0.len() / 2;
        let mut taken = vec![false; pieces.len()];
        let free = |&i: &usize| self.is_free(2 * i) || self.is_free(2 * i + 1);
        let firsts = pieces.clone().filter(free).chain(pieces);
        let mut chains = Vec::new();
        for first in firsts {
            if !taken[first] {
                let last = usize::from(!self.is_free(2 * first));
                chains.push(self.chain(2 * first + last, &mut taken));
            }
        }
        chains
    }

    /// The chain that begins with an end.
    fn chain(&self, begin: End, taken: &mut [bool]) -> Chain {
        let mut pieces = Vec::new();
        let mut end = begin;
        loop {
            taken[end / 2] = true;
            pieces.push((end / 2, end % 2 == 1));
            match self.0[end ^ 1] {
                Some(next) if !taken[next / 2] => end = next,
                next => {
                    let closed = next.is_some();
                    return Chain { pieces, closed };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chains(pieces: usize, joints: &[(End, End)]) -> Vec<Chain> {
        let mut all = Joints::new(pieces);
        joints.iter().for_each(|&(a, b)| all.join(a, b));
        all.chains()
    }

    fn chain(pieces: &[(usize, bool)], closed: bool) -> Chain {
        let pieces = pieces.to_vec();
        Chain { pieces, closed }
    }

    #[test]
    fn pieces_are_turned_so_that_they_go_on() {
        let found = chains(4, &[(1, 7), (6, 4)]);
        let long = [(0, false), (3, true), (2, false)];
        assert_eq!(found, [chain(&long, false), chain(&[(1, false)], false)]);
        // The lowest free end is the last one of piece 1.
        let found = chains(3, &[(0, 5), (1, 2)]);
        let long = [(1, true), (0, true), (2, true)];
        assert_eq!(found, [chain(&long, false)]);
    }

    #[test]
    fn rings_come_last_and_have_each_piece_once() {
        let found = chains(4, &[(0, 3), (1, 2), (4, 5)]);
        let ring = chain(&[(0, true), (1, true)], true);
        let alone = chain(&[(3, false)], false);
        assert_eq!(found, [alone, ring, chain(&[(2, true)], true)]);
    }
}
