//! Where the value of a function's input is from.

/// The source of the value of a tape's input.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// A coordinate.
    Coordinate(usize),
    /// A part that depends on one coordinate: the axis, and the part's number
    /// there.
    Part(usize, usize),
    /// A call of data, by its number.
    Call(usize),
}
