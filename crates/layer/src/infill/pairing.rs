//! Pairing neighbours on a ring: as many pairs as can be, and of these the
//! shortest.
//!
//! In: the way from each place of a ring to the next one, where they may be a
//! pair. Out: pairs of neighbours, no place in two of them.
//!
//! The sum of the ways does not depend on where the ring begins, so the same
//! outline turned, or with its vertices elsewhere, is filled with as much. Which
//! of several equal choices is taken does depend on it.

/// A way, in micrometres: whole numbers, since sums of equal ways must be equal.
pub(super) type Way = u64;

/// The best pairs of some places so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Best {
    count: usize,
    sum: Way,
}

impl Best {
    /// These pairs and one more.
    fn and(self, way: Way) -> Best {
        Best {
            count: self.count + 1,
            sum: self.sum + way,
        }
    }

    fn is_better_than(self, other: Best) -> bool {
        self.count > other.count
            || (self.count == other.count && self.sum < other.sum)
    }
}

/// The places, counted from 0, that are a pair with the next one: `ways[i]` is
/// the way from the place `i` to the next one around the ring, or `None` if these
/// two cannot be a pair.
pub(super) fn pairs(ways: &[Option<Way>]) -> Vec<usize> {
    let n = ways.len();
    if n <= 2 {
        // Two places have two ways between them, of which one is enough.
        let all = (0..n).filter_map(|i| Some((ways[i]?, i)));
        return all
            .min()
            .filter(|_| n == 2)
            .map(|(_, i)| i)
            .into_iter()
            .collect();
    }
    // Either the last place and the first one are no pair, or they are one, and
    // the others are paired among themselves.
    let (apart, open) = along(&ways[..n - 1]);
    let Some(last) = ways[n - 1] else {
        return open;
    };
    let (between, mut closed) = along(&ways[1..n - 2]);
    if between.and(last).is_better_than(apart) {
        closed.iter_mut().for_each(|i| *i += 1);
        closed.push(n - 1);
        closed
    } else {
        open
    }
}

/// The best pairs of places along a line, one more than there are ways.
fn along(ways: &[Option<Way>]) -> (Best, Vec<usize>) {
    // The best pairs of the first `k` places.
    let mut best = vec![Best::default(); 2];
    for (k, way) in ways.iter().enumerate() {
        let without = best[k + 1];
        let with = way.map(|way| best[k].and(way));
        let with = with.filter(|with| with.is_better_than(without));
        best.push(with.unwrap_or(without));
    }
    let mut found = Vec::new();
    let mut k = ways.len();
    while k > 0 {
        if best[k + 1] == best[k] {
            k -= 1;
        } else {
            found.push(k - 1);
            k = k.saturating_sub(2);
        }
    }
    found.reverse();
    (best[ways.len() + 1], found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best that any choice of pairs gives.
    fn best_of_all(ways: &[Option<Way>]) -> Best {
        let n = ways.len();
        let mut best = Best::default();
        for chosen in 0..1_u32 << n {
            let has = |i: usize| chosen >> (i % n) & 1 == 1;
            let mut now = Best::default();
            let fits = (0..n).all(|i| match ways[i] {
                _ if !has(i) => true,
                Some(way) if !has(i + 1) => {
                    now = now.and(way);
                    true
                }
                _ => false,
            });
            if fits && now.is_better_than(best) {
                best = now;
            }
        }
        best
    }

    #[test]
    fn there_is_no_better_choice() {
        let mut random = 1_u64;
        for trial in 0..600 {
            let n = 2 + trial % 9;
            let ways: Vec<Option<Way>> = (0..n)
                .map(|_| {
                    random = random.wrapping_mul(6364136223846793005) + 1;
                    let way = random >> 60;
                    (way > 3).then_some(way)
                })
                .collect();
            let found = pairs(&ways);
            let mut is = Best::default();
            let mut taken = vec![false; n];
            for i in found {
                is = is.and(ways[i].unwrap());
                for end in [i, (i + 1) % n] {
                    assert!(!std::mem::replace(&mut taken[end], true));
                }
            }
            assert_eq!(is, best_of_all(&ways), "{ways:?}");
        }
    }

    #[test]
    fn a_ring_may_begin_anywhere() {
        let ways = [3, 1, 4, 1, 5, 9, 2, 6].map(Some);
        for turn in 0..ways.len() {
            let mut turned = ways;
            turned.rotate_left(turn);
            let found = pairs(&turned);
            let sum: Way = found.iter().filter_map(|&i| turned[i]).sum();
            assert_eq!((found.len(), sum), (4, 14));
        }
    }
}
