//! What is beyond the samples of an axis.

/// How samples go on beyond the first and the last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// As the outermost sample.
    #[default]
    Clamp,
    /// From the other side again.
    Repeat,
    /// Back, as in a mirror at the outer edge of the outermost sample.
    Mirror,
}

/// Greatest number of a sample that is distinguished, far beyond any lattice.
const FAR: f64 = (1_i64 << 40) as f64;

/// The number of the sample at or before a coordinate. Without `f64::floor`,
/// which is a call on processors that may lack the instruction.
#[inline]
pub(crate) fn floor(u: f64) -> i64 {
    let u = u.clamp(-FAR, FAR);
    let whole = u as i64;
    whole - i64::from(u < whole as f64)
}

impl Border {
    /// The sample that stands at `i`, of `n`.
    #[inline]
    pub(crate) fn sample(self, i: i64, n: usize) -> usize {
        let n = n as i64;
        if (0..n).contains(&i) {
            return i as usize;
        }
        let at = match self {
            Border::Clamp => i.clamp(0, n - 1),
            Border::Repeat => i.rem_euclid(n),
            Border::Mirror => {
                let at = i.rem_euclid(2 * n);
                at.min(2 * n - 1 - at)
            }
        };
        at as usize
    }

    /// A coordinate at which the same stands, and which is not too far away to
    /// be told from its neighbours.
    #[inline]
    pub(crate) fn near(self, u: f64, n: usize) -> f64 {
        let n = n as f64;
        match self {
            Border::Clamp => u.clamp(-4.0, n + 4.0),
            _ if u.abs() < 0.5 * FAR => u,
            Border::Repeat => u.rem_euclid(n),
            Border::Mirror => u.rem_euclid(2.0 * n),
        }
    }

    /// The least stretch of samples that holds all that stand from `from` to
    /// `to`.
    pub(crate) fn stretch(self, [from, to]: [i64; 2], n: usize) -> Stretch {
        let last = n as i64 - 1;
        let inside = from >= 0 && to <= last;
        let all = [0, n - 1];
        let samples = match self {
            _ if inside => [from as usize, to as usize],
            Border::Clamp => [self.sample(from, n), self.sample(to, n)],
            _ if to.saturating_sub(from) >= last => all,
            Border::Repeat => {
                match [self.sample(from, n), self.sample(to, n)] {
                    [a, b] if a <= b => [a, b],
                    _ => all,
                }
            }
            Border::Mirror => {
                let [a, b] = [self.sample(from, n), self.sample(to, n)];
                // Between two mirrors n apart only one can be met.
                let turns = |i: i64| i.div_euclid(n as i64);
                if turns(from) == turns(to) {
                    [a.min(b), a.max(b)]
                } else if turns(from).rem_euclid(2) == 0 {
                    [a.min(b), n - 1]
                } else {
                    [0, a.max(b)]
                }
            }
        };
        Stretch { samples, inside }
    }
}

/// Samples that follow one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// The first and the last.
    pub(crate) samples: [usize; 2],
    /// Whether nothing is beyond the border.
    pub(crate) inside: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Border; 3] = [Border::Clamp, Border::Repeat, Border::Mirror];

    #[test]
    fn samples_go_on() {
        let row = |border: Border| -> Vec<usize> {
            (-4..7).map(|i| border.sample(i, 3)).collect()
        };
        assert_eq!(row(Border::Clamp), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
        assert_eq!(row(Border::Repeat), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(row(Border::Mirror), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
    }

    #[test]
    fn samples_at_or_before_places() {
        for (u, i) in [
            (0.0, 0),
            (-0.0, 0),
            (0.99, 0),
            (1.0, 1),
            (-1.0, -1),
            (-1e-9, -1),
            (-1.5, -2),
            (1e300, FAR as i64),
            (f64::NEG_INFINITY, -FAR as i64),
            (f64::NAN, 0),
        ] {
            assert_eq!(floor(u), i, "{u}");
        }
    }

    #[test]
    fn stretches_hold_their_samples() {
        for border in ALL {
            for n in 1..6 {
                for from in -15..15 {
                    for to in from..15 {
                        let [a, b] = border.stretch([from, to], n).samples;
                        let all = (from..=to).map(|i| border.sample(i, n));
                        assert!(
                            all.clone().all(|s| (a..=b).contains(&s)),
                            "{border:?} {n} {from} {to}"
                        );
                    }
                }
            }
        }
    }
}
