//! Tables of words and what they mean.

/// Makes a slice of pairs. Several words before one `=>` each make a pair with
/// what is behind it.
#[macro_export]
macro_rules! pairs {
    ($($($word:expr),+ => $meaning:expr;)+) => {
        &[$($(($word, $meaning)),+),+]
    };
}
