//! What rises from a layer's face, and has walls that stand on it.
//!
//! A part rises where the layer above recedes so far that its walls lie beside
//! those below them for the most part. On a slope that is steeper than that, walls
//! stand on walls.
//!
//! In: the outlines of a layer and of the layer above. Out: what lies under the
//! walls. Every layer whose skin the face reaches down to asks for it, so it is
//! found once and kept beside the lower layer.

use crate::cover::{TOLERANCE, open};
use crate::view::{LayerFace, Risen};
use crate::walls::WallPlan;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Solid};

/// What lies under the walls of a part that rises from the face of the `lower` of
/// two layers, as `seen` takes it. `None` if nothing rises.
pub(super) fn under<T>(
    lower: &LayerFace<'_>,
    upper: &LayerFace<'_>,
    walls: &WallPlan,
    seen: impl FnOnce(&Area) -> Option<T>,
) -> Option<T> {
    if upper.rough.is(lower.rough) {
        return None;
    }
    let (_, depth) = walls.depths(upper.span.height());
    let find = || found(lower.rough, upper.rough, 0.5 * walls.inner, depth);
    let all = match lower.risen {
        Some(Risen(kept)) => kept.get_or_init(find),
        None => &find(),
    };
    if all.is_empty() { None } else { seen(all) }
}

/// What lies within `depth` of the upper of two layers where it recedes by more
/// than `step`.
fn found(lower: &Solid<'_>, upper: &Solid<'_>, step: Mm, depth: Mm) -> Area {
    if depth <= 0.0 || !recedes(lower, upper, step) {
        return Area::EMPTY;
    }
    let open = open(lower.area(), upper.area());
    let wide = offset(&open, -0.5 * step, TOLERANCE);
    offset(&wide, 0.5 * step + depth, TOLERANCE)
}

/// True if some border of a layer is farther than `step` from the border of the
/// layer below, in which it lies.
fn recedes(lower: &Solid<'_>, upper: &Solid<'_>, step: Mm) -> bool {
    let grid = lower.grid();
    let away = |p: DVec2| grid.nearest_edge(p, step).is_none();
    let mut points = upper.area().rings.iter().flatten();
    points.any(|&p| away(p) && grid.contains(p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::LayerView;
    use isoslice_planar::shapes::rect;
    use isoslice_settings::testing::usual_plan;

    /// What is found once is what is found anew, and is not looked for again.
    #[test]
    fn what_rises_is_found_once() {
        let walls = usual_plan(WallPlan::of);
        let [plate, tower] = [(0.0, 20.0), (8.0, 12.0)]
            .map(|(low, high)| Solid::new(rect(low, low, high, high)));
        let view = LayerView::of(0, &plate, &[&tower], &[]);
        let all = |lower: &LayerFace<'_>, upper: &LayerFace<'_>| {
            under(lower, upper, &walls, |all| Some(all.content()))
        };
        let (here, above) = (view.here, view.above[0]);
        let anew = all(&here, &above);
        assert!(anew.is_some_and(|content| content > 0.0));
        let risen = Risen::default();
        let kept = LayerFace {
            risen: Some(&risen),
            ..here
        };
        assert_eq!(all(&kept, &above), anew);
        assert!(risen.0.get().is_some());
        // The layer above is not looked at again.
        let other = Solid::new(rect(2.0, 2.0, 4.0, 4.0));
        let other = LayerView::of(0, &plate, &[&other], &[]).above[0];
        assert_ne!(all(&here, &other), anew);
        assert_eq!(all(&kept, &other), anew);
        assert_eq!(all(&above, &above), None);
    }
}
