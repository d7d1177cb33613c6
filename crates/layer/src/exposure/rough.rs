//! Outlines as exact as skin needs them.

use crate::cover::TOLERANCE;
use crate::walls::WallPlan;
use isoslice_base::units::Mm;
use isoslice_planar::offset::offset;
use isoslice_planar::simplify::simplify_area;
use isoslice_planar::{Area, Solid};

/// An outline as exact as skin needs it. A dozen layers ask what it covers of
/// them, and each question takes a time that grows with its points. It is a
/// little larger if there are no walls: the fill then ends at the outline
/// itself, and of two equal layers neither may leave a rim of the other open.
pub fn rough(outline: &Area, walls: &WallPlan) -> Solid<'static> {
    // Two outlines of one shape differ by twice their accuracy, and the offset
    // may be off by as much as its tolerance.
    let accuracy = walls.accuracy;
    Solid::new(match walls.count {
        0 => offset(outline, 3.0 * accuracy, accuracy),
        _ => simplify_area(outline, TOLERANCE),
    })
}

/// How far apart the borders of two rough outlines of one shape may be: twice
/// as far as either is off.
pub(super) fn apart(walls: &WallPlan) -> Mm {
    let accuracy = walls.accuracy;
    2.0 * match walls.count {
        0 => accuracy + accuracy,
        _ => accuracy + TOLERANCE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cover::open;
    use glam::DVec2;
    use isoslice_planar::shapes::disc;
    use isoslice_settings::testing::{plan_with, usual_plan};

    /// Places between the rough and the exact outline are where the rough one
    /// says, whoever is asked.
    #[test]
    fn rough_outlines_agree_with_themselves() {
        let exact = disc(10.0, 2000);
        let rough = rough(&exact, &usual_plan(WallPlan::of));
        assert!(rough.area().rings[0].len() < 200);
        let mut between = 0;
        for k in 0..4000 {
            let t = std::f64::consts::TAU * f64::from(k) / 4000.0;
            for off in [-0.005, 0.005] {
                let p = DVec2::from_angle(t) * (10.0 + off);
                let inside = rough.area().contains(p);
                assert_eq!(rough.grid().contains(p), inside, "{p}");
                between += usize::from(inside != exact.contains(p));
            }
        }
        assert!(between > 100, "{between}");
    }

    /// Without walls a layer covers all of an equal one, however far accuracy
    /// lets their outlines be apart.
    #[test]
    fn equal_layers_without_walls_cover_one_another() {
        let walls = plan_with(WallPlan::of, |s| s.walls = 0);
        let off = walls.accuracy;
        for [here, there] in [[off, -off], [-off, off]] {
            let fill = disc(10.0 + here, 300);
            // The chords take the other half of the accuracy.
            let cover = rough(&disc(10.0 + 0.5 * there, 140), &walls);
            assert!(open(&fill, cover.area()).is_empty());
        }
    }
}
