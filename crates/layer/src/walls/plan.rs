//! What walls follow from.

use isoslice_base::units::{Mm, Percent};
use isoslice_planar::bead::spacing;
use isoslice_settings::Settings;

/// Which places get one line: their thicknesses as shares of the line's width.
#[derive(Clone, Copy, Debug)]
pub struct ThinPlan {
    /// Thickness below which there is no line, %.
    pub least: Percent,
    /// Thickness from which on there are two lines, %.
    pub most: Percent,
}

impl ThinPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> ThinPlan {
        ThinPlan {
            least: settings.thin_min,
            most: settings.thin_max,
        }
    }
}

/// How many walls there are, and how wide they are.
#[derive(Clone, Copy, Debug)]
pub struct WallPlan {
    /// Number of walls.
    pub count: usize,
    /// Number of walls around tops, at most `count`.
    pub around_tops: usize,
    /// Line width of the outer wall, mm.
    pub outer: Mm,
    /// Line width of the walls behind it, mm.
    pub inner: Mm,
    /// Line width of the skin that the walls enclose, mm.
    pub skin: Mm,
    /// Line width of the skin that is seen from above, mm.
    pub top_skin: Mm,
    /// Which places get one line.
    pub thin: ThinPlan,
    /// Share of an outer wall's width from which on it hangs that lies beyond the
    /// layer below, %.
    pub overhang_share: Percent,
    /// Greatest error of what shows, mm.
    pub accuracy: Mm,
    /// True if beads stay level, and do not follow the surface.
    pub level: bool,
}

impl WallPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> WallPlan {
        WallPlan {
            count: settings.walls as usize,
            around_tops: settings.top_walls() as usize,
            outer: settings.outer_wall_width(),
            inner: settings.inner_wall_width(),
            skin: settings.skin_width(),
            top_skin: settings.top_skin_width(),
            thin: ThinPlan::of(settings),
            overhang_share: settings.overhang_share,
            accuracy: settings.accuracy,
            level: settings.contour_z.is(0.0),
        }
    }

    /// Line width of the `k`th wall, from the outside.
    pub fn width(&self, k: usize) -> Mm {
        if k == 0 { self.outer } else { self.inner }
    }

    /// Depths of the walls' centre lines below the outline, outermost first, and
    /// that of the border of the fill, in a layer of a height.
    pub fn depths(&self, height: Mm) -> (Vec<Mm>, Mm) {
        let mut depths = Vec::new();
        let mut depth = 0.5 * self.outer;
        for k in 0..self.count {
            depths.push(depth);
            // The filled area begins half of the last wall's own spacing farther
            // in.
            let next = if k + 1 < self.count { k + 1 } else { k };
            depth += spacing(self.width(k), self.width(next), height);
        }
        let border = match depths.last() {
            Some(last) => last + 0.5 * (depth - last),
            None => 0.0,
        };
        (depths, border)
    }
}
