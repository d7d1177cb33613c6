//! Numbers as firmware reads them: fixed-point, without exponents, negative
//! zeros and trailing zeros.
//!
//! In: numbers scaled to an integer count of their last decimal. Out: text at
//! the end of a buffer. Nearly all of a file is numbers, so this file writes
//! their digits itself; `format!` takes several times as long.

/// Greatest count of last decimals. It is far above any length on a machine,
/// and an f64 holds it exactly.
const MAX_COUNT: f64 = 1e15;

/// `value` as a count of units of its last decimal, rounded to nearest; nothing
/// if `value` is not finite or the count above [`MAX_COUNT`].
pub(super) fn scaled(value: f64, decimals: u32) -> Option<i64> {
    let count = (value * 10f64.powi(decimals as i32)).round();
    // The comparison is false for NaN.
    (count.abs() <= MAX_COUNT).then_some(count as i64)
}

/// Appends a number of `decimals` decimals (at most 17) that is `count` units
/// of the last one.
pub(super) fn push_scaled(buffer: &mut Vec<u8>, count: i64, decimals: u32) {
    if count == 0 {
        buffer.push(b'0');
        return;
    }
    if count < 0 {
        buffer.push(b'-');
    }
    let unit = 10u64.pow(decimals.min(17));
    let size = count.unsigned_abs();
    push_integer(buffer, size / unit);
    let mut rest = size % unit;
    if rest == 0 {
        return;
    }
    buffer.push(b'.');
    let mut place = unit / 10;
    while rest > 0 {
        buffer.push(b'0' + (rest / place) as u8);
        rest %= place;
        place /= 10;
    }
}

/// Appends a whole number.
pub(super) fn push_integer(buffer: &mut Vec<u8>, mut n: u64) {
    // u64::MAX has 20 digits.
    let mut digits = [0u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (n % 10) as u8;
        n /= 10;
        if n == 0 {
            break;
        }
    }
    buffer.extend_from_slice(&digits[at..]);
}

/// `value` with up to `decimals` decimals, as a string, for headers and
/// templates. A value that is not finite becomes `0`, which is never dangerous.
pub(super) fn text(value: f64, decimals: u32) -> String {
    let mut buffer = Vec::new();
    push_scaled(&mut buffer, scaled(value, decimals).unwrap_or(0), decimals);
    buffer.into_iter().map(char::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(count: i64, decimals: u32) -> String {
        let mut b = Vec::new();
        push_scaled(&mut b, count, decimals);
        String::from_utf8(b).expect("ASCII")
    }

    /// The text by `format!`, to compare with.
    fn oracle(count: i64, decimals: u32) -> String {
        let unit = 10i64.pow(decimals);
        let sign = if count < 0 { "-" } else { "" };
        let (a, b) = (count.abs() / unit, count.abs() % unit);
        let s = format!("{sign}{a}.{b:0w$}", w = decimals as usize);
        s.trim_end_matches('0').trim_end_matches('.').to_owned()
    }

    #[test]
    fn numbers_read_as_format_writes_them() {
        for count in -12_345..=12_345 {
            assert_eq!(fixed(count, 3), oracle(count, 3));
            let value = count as f64 * 1e-5;
            let slow = format!("{value:.5}");
            let slow = slow.trim_end_matches('0').trim_end_matches('.');
            let slow = if slow == "-0" { "0" } else { slow };
            assert_eq!(fixed(count, 5), slow);
        }
        for count in [i64::from(i32::MAX), 1_000_000_000_000_000] {
            assert_eq!(fixed(count, 5), oracle(count, 5));
            assert_eq!(fixed(-count, 5), oracle(-count, 5));
        }
        assert_eq!(fixed(1200, 0), "1200");
        assert_eq!(fixed(i64::MIN, 0), i64::MIN.to_string());
    }

    #[test]
    fn values_are_rounded_and_checked() {
        assert_eq!(scaled(0.0005, 3), Some(1));
        assert_eq!(scaled(-0.0004, 3), Some(0));
        assert_eq!(text(-0.0004, 3), "0");
        assert_eq!(text(219.9996, 3), "220");
        assert_eq!(scaled(f64::NAN, 3), None);
        assert_eq!(scaled(f64::NEG_INFINITY, 3), None);
        assert_eq!(scaled(1e300, 3), None);
    }
}
