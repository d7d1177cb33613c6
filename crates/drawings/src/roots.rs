//! Where polynomials are zero between 0 and 1, of degree 5 at most.
//!
//! A polynomial by its Bernstein coefficients has at most as many zeros as its
//! coefficients change signs, and as many modulo two. It is halved until each
//! part has none or one.

/// A polynomial on 0..1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bernstein {
    values: [f64; 6],
    /// How many coefficients it has.
    n: usize,
}

impl Bernstein {
    /// Of at most six coefficients.
    pub(crate) fn new(coefficients: &[f64]) -> Bernstein {
        let mut values = [0.0; 6];
        let n = coefficients.len().min(6);
        values[..n].copy_from_slice(&coefficients[..n]);
        Bernstein { values, n }
    }

    fn coefficients(&self) -> &[f64] {
        &self.values[..self.n]
    }

    /// How often the coefficients change signs.
    fn changes(&self) -> usize {
        let mut last = 0.0;
        let mut changes = 0;
        for v in self.coefficients() {
            if *v != 0.0 {
                changes += usize::from(last * v < 0.0);
                last = v.signum();
            }
        }
        changes
    }

    /// Whether it rises at its one zero. It may be zero at 0 and 1 as well.
    fn rises(&self) -> bool {
        let first = self.coefficients().iter().find(|v| **v != 0.0);
        first.is_some_and(|v| *v < 0.0)
    }

    /// Its value and its derivative.
    fn at(&self, t: f64) -> (f64, f64) {
        let u = 1.0 - t;
        let mut row = self.values;
        let mut slope = 0.0;
        for k in (1..self.n).rev() {
            if k == 1 {
                slope = (row[1] - row[0]) * (self.n - 1) as f64;
            }
            for i in 0..k {
                row[i] = row[i] * u + row[i + 1] * t;
            }
        }
        (row[0], slope)
    }

    fn halves(&self) -> [Bernstein; 2] {
        let mut left = *self;
        let mut right = *self;
        let mut row = self.values;
        let last = self.n - 1;
        for k in 1..=last {
            for i in 0..=last - k {
                row[i] = 0.5 * (row[i] + row[i + 1]);
            }
            left.values[k] = row[0];
            right.values[last - k] = row[last - k];
        }
        [left, right]
    }

    /// Its one zero, if its coefficients change signs once.
    fn zero(&self) -> f64 {
        let rises = self.rises();
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = 0.5;
        for _ in 0..60 {
            let (value, slope) = self.at(t);
            if value == 0.0 {
                break;
            }
            if (value < 0.0) == rises {
                low = t;
            } else {
                high = t;
            }
            let next = t - value / slope;
            let next = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            let moved = (next - t).abs();
            t = next;
            if moved < 1e-15 {
                break;
            }
        }
        t
    }
}

/// Parts of a polynomial that wait: none is halved more often than this.
const DEEPEST: u32 = 40;

/// Where a polynomial changes its sign, in no order.
pub(crate) fn crossings(of: &Bernstein) -> Vec<f64> {
    let mut found = Vec::new();
    each_crossing(of, |t, _| found.push(t));
    found
}

/// Calls a function with each place where a polynomial changes its sign, and
/// whether it rises there.
pub(crate) fn each_crossing(of: &Bernstein, mut f: impl FnMut(f64, bool)) {
    match of.changes() {
        0 => return,
        1 => {
            f(of.zero(), of.rises());
            return;
        }
        _ => {}
    }
    let mut todo = vec![(*of, 0.0, 0)];
    while let Some((part, from, depth)) = todo.pop() {
        let size = 0.5_f64.powi(depth as i32);
        match part.changes() {
            0 => {}
            1 => {
                f(from + size * part.zero(), part.rises());
            }
            _ if depth == DEEPEST => f(from, true),
            _ => {
                let [left, right] = part.halves();
                // A zero exactly between the halves changes no sign in either.
                let (l, r) = (left.values[0], right.values[part.n - 1]);
                if right.values[0] == 0.0 {
                    f(from + 0.5 * size, l < r);
                }
                todo.push((right, from + 0.5 * size, depth + 1));
                todo.push((left, from, depth + 1));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_zeros_are_found() {
        // (t - 0.1) (t - 0.3) (t - 0.5) (t - 0.7) (t - 0.9), from its values.
        let zeros = [0.1, 0.3, 0.5, 0.7, 0.9];
        let mut values = vec![1.0];
        for zero in zeros {
            // Times (t - zero), whose coefficients are -zero and 1 - zero.
            let n = values.len();
            let mut next = vec![0.0; n + 1];
            for (i, v) in values.iter().enumerate() {
                let share = |k: usize, of: usize| k as f64 / of as f64;
                next[i] += v * -zero * share(n - i, n);
                next[i + 1] += v * (1.0 - zero) * share(i + 1, n);
            }
            values = next;
        }
        let mut found = crossings(&Bernstein::new(&values));
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        assert_eq!(found.len(), 5, "{found:?}");
        for (a, b) in found.iter().zip(zeros) {
            assert!((a - b).abs() < 1e-12);
        }
        assert!(crossings(&Bernstein::new(&[1.0, 0.1, 1.0])).is_empty());
    }
}
