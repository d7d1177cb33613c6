//! What walls, and the split of what they leave, follow from.

use isoslice_base::units::{Mm, Mm2, Percent};
use isoslice_planar::bead::spacing;
use isoslice_settings::{Settings, SkinWhere};

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

    #[cfg(test)]
    pub(crate) fn usual() -> ThinPlan {
        ThinPlan::of(&Settings::default())
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

    #[cfg(test)]
    pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> WallPlan {
        let mut settings = Settings::default();
        change(&mut settings);
        WallPlan::of(&settings)
    }
}

/// How outlines are changed before anything is made of them.
#[derive(Clone, Copy, Debug)]
pub struct OutlinePlan {
    /// Slits narrower than this are filled, mm.
    pub slit: Mm,
    /// By how much outlines move outwards, mm; 0 if that differs from place to
    /// place.
    pub grow: Mm,
    /// By how much the first layer is drawn in, mm; 0 on a raft, since it is not
    /// squeezed there.
    pub foot: Mm,
    /// Number of layers that are drawn in, less and less.
    pub foot_layers: usize,
    /// Thickness of what may be left when an outline is drawn in, mm.
    pub keep: Mm,
    /// Greatest error, mm.
    pub tolerance: Mm,
}

impl OutlinePlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> OutlinePlan {
        let on_bed = settings.raft_layers() == 0;
        OutlinePlan {
            slit: 2.0 * settings.slit_closing(),
            grow: settings.xy_compensation.constant().unwrap_or(0.0),
            foot: if on_bed { settings.elephant_foot } else { 0.0 },
            foot_layers: settings.elephant_foot_layers as usize,
            keep: 2.0 * settings.outer_wall_width(),
            tolerance: 0.2 * settings.accuracy,
        }
    }

    #[cfg(test)]
    pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> OutlinePlan {
        let mut settings = Settings::default();
        change(&mut settings);
        OutlinePlan::of(&settings)
    }
}

/// Solid layers on one side of what is seen.
#[derive(Clone, Copy, Debug)]
pub struct ShellPlan {
    /// Their number, if that is given.
    pub layers: Option<usize>,
    /// Their thickness otherwise, mm.
    pub thickness: Mm,
}

/// Which part of the fill is skin.
#[derive(Clone, Copy, Debug)]
pub struct ExposurePlan {
    /// The walls around the fill.
    pub walls: WallPlan,
    /// What lies below faces that are seen from above.
    pub top: ShellPlan,
    /// What lies above faces that are seen from below.
    pub bottom: ShellPlan,
    /// True if the whole first and last layers are skin, and no others.
    pub ends_alone: bool,
    /// True if all layers above the first have one height.
    pub uniform: bool,
    /// Number of the raft's layers.
    pub raft_layers: usize,
    /// True if no place is sparse.
    pub solid: bool,
    /// Line width of sparse infill, mm.
    pub infill: Mm,
    /// Content below which an area is too small for sparse infill, mm².
    pub least: Mm2,
    /// How far skin reaches into the sparse infill beside it, mm.
    pub overlap: Mm,
    /// Width of the lines of bridges, mm.
    pub bridge: Mm,
    /// How far bridges reach onto what holds them, mm, if there are bridges.
    pub anchor: Option<Mm>,
}

impl ExposurePlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> ExposurePlan {
        let shell = |layers: Option<u32>, thickness| ShellPlan {
            layers: layers.map(|count| count as usize),
            thickness,
        };
        ExposurePlan {
            walls: WallPlan::of(settings),
            top: shell(settings.top_layers.layers(), settings.top_thickness()),
            bottom: shell(
                settings.bottom_layers.layers(),
                settings.bottom_thickness(),
            ),
            ends_alone: settings.skin_where == SkinWhere::Ends,
            uniform: settings.is_uniform(),
            raft_layers: settings.raft_layers(),
            solid: settings.is_solid(),
            infill: settings.infill_width(),
            least: settings.skin_min_area,
            overlap: settings.skin_overlap(),
            bridge: settings.skin_width(),
            anchor: settings.bridges.then_some(settings.bridge_anchor),
        }
    }

    #[cfg(test)]
    pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> ExposurePlan {
        let mut settings = Settings::default();
        change(&mut settings);
        ExposurePlan::of(&settings)
    }
}
