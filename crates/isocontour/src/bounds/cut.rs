//! Where to cut a box in two.

use crate::cell::Cell;

/// The axis across which to cut a box: the one along which f changes most.
/// `None` if no cut can tell more, because f is constant or the box is thinner
/// than `thinnest` along every axis that matters.
pub(super) fn split_axis(
    cell: &Cell,
    steepness: [f64; 3],
    depth: u32,
    thinnest: f64,
) -> Option<usize> {
    let jumps = |i: usize| !steepness[i].is_finite() && steepness[i] != 0.0;
    // A box in which f jumps is never decided. Once the box is as thin as what
    // may be left out, its neighbours tell whether there is anything.
    if (0..3).any(|i| jumps(i) && cell.width(i) <= thinnest) {
        return None;
    }
    let can = |&i: &usize| {
        let middle = cell.centre()[i];
        steepness[i] != 0.0
            && cell.width(i) > thinnest
            && cell.lo[i] < middle
            && middle < cell.hi[i]
    };
    let widest = |axes: &mut dyn Iterator<Item = usize>| {
        axes.filter(can)
            .max_by(|&a, &b| cell.width(a).total_cmp(&cell.width(b)))
    };
    // Steepness is an upper bound and can be far too high along one axis, so
    // the widest axis gets its turn now and then. Jumps are approached in turn
    // with the others.
    if depth % 4 != 3
        && let Some(i) = widest(&mut (0..3).filter(|&i| jumps(i)))
    {
        return Some(i);
    }
    if depth % 8 == 7 || (0..3).any(jumps) {
        return widest(&mut (0..3));
    }
    (0..3).filter(can).max_by(|&a, &b| {
        let gain = |i: usize| cell.width(i) * steepness[i];
        gain(a).total_cmp(&gain(b))
    })
}
