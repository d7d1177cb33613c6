//! Mixtures of two values: a·(1 - t) + b·t, as the smooth unions of shaders are
//! made of.
//!
//! Where t is within 0 and 1 a mixture lies between a and b. The range of the
//! sum does not tell, since t and 1 - t are taken to be any two numbers there:
//! its lower end is 0, however far from the part the box is.

use super::Step;
use super::slot::Slot;
use fidget::context::BinaryOpcode;

/// Narrows the slot of the sum of two steps, if it is a mixture.
pub(super) fn narrowed(
    mut slot: Slot,
    steps: &[Step],
    [p, q]: [u32; 2],
    s: &[Slot],
) -> Slot {
    let Some([a, b, share]) = mixture(steps, p, q) else {
        return slot;
    };
    let of = |step: u32| s[step as usize].range;
    let (a, b, share) = (of(a), of(b), of(share));
    let within = share.lo >= 0.0 && share.hi <= 1.0;
    if within && !a.is_empty() && !b.is_empty() {
        let all = a.hull(b);
        slot.range.lo = slot.range.lo.max(all.lo).min(slot.range.hi);
        slot.range.hi = slot.range.hi.min(all.hi).max(slot.range.lo);
    }
    slot
}

/// The two values that are mixed, and the share of one of them, if the steps
/// are two products whose shares add up to 1.
fn mixture(steps: &[Step], p: u32, q: u32) -> Option<[u32; 3]> {
    let factors = |n: u32| match steps[n as usize] {
        Step::Binary(BinaryOpcode::Mul, a, b) => Some([[a, b], [b, a]]),
        _ => None,
    };
    let is_one = |n: u32| matches!(steps[n as usize], Step::Const(1.0));
    let rest = |u: u32, v: u32| match steps[u as usize] {
        Step::Binary(BinaryOpcode::Sub, one, w) => w == v && is_one(one),
        _ => false,
    };
    let (first, second) = (factors(p)?, factors(q)?);
    let pairs = first.into_iter().flat_map(|f| second.map(|g| (f, g)));
    pairs
        .map(|([a, u], [b, v])| (a, b, u, v))
        .find(|&(_, _, u, v)| rest(u, v) || rest(v, u))
        .map(|(a, b, u, _)| [a, b, u])
}
