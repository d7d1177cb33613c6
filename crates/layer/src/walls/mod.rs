//! What a layer's solid is made of: walls, skin, sparse infill.
//!
//! ```text
//!   outline ┃←w₀/2→┊←──s──→┊←s/2→│  fill: sparse or skin
//!           ┃ outer wall    inner │
//! ```
//!
//! In: the outline of the layer and those of its neighbours. Out: the centre
//! lines of the walls, in-plane offsets of the outline in millimetres, and
//! the area inside them, the fill, which [`exposure`](crate::exposure) splits
//! into skin and sparse infill. The lines then become beads ([`mod@beads`]).
//!
//! Where the part, or what the walls leave of it, is too thin for two walls
//! side by side, one bead along its middle ([`medial_axis`]) takes their place, as
//! wide as the place is thick. What is too thin even for that widens the walls
//! beside it ([`mod@line`]), and so does what the last wall leaves that is too
//! thin for a whole line ([`shared`]). Extruded area per area of part stays the same. How
//! many beads lie side by side is decided along whole axes ([`beading`]), and
//! strokes go on in one another where they meet ([`stitching`]).

mod ball;
mod beading;
mod beads;
mod bend;
mod give;
mod interlock;
pub mod line;
mod loops;
pub mod medial_axis;
mod overhang;
pub mod patch;
mod plan;
mod pocket;
mod reach;
mod run;
mod shared;
mod stitching;
mod tip;
mod tops;
mod web;
mod widen;

use beading::Beadings;
pub(crate) use beading::NARROW;
pub use beads::{beads, interlocked, rounded, thin};
use bend::is_bend;
use give::give_way;
use glam::DVec2;
pub use interlock::Interlock;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::{Stroke, spacing};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::offset::{Room, offset, offset_within};
use isoslice_planar::simplify::simplify_area;
use isoslice_planar::{Area, Rect, Solid, path_length, signed_area};
use line::{Inside, absorb, cut, within};
use loops::lead_into_tips;
use medial_axis::{Axes, Axis, axes};
pub use overhang::{Support, hanging};
pub use plan::{ThinPlan, WallPlan};
use pocket::Left;
pub use reach::Reach;
pub(crate) use shared::{content_of, taken};
use std::collections::HashSet;
use stitching::Space;
pub use web::LEAST as THINNEST_PLACE;

/// Share of `accuracy` for the outline, and for an offset of it. A polygon's
/// corners lie as far outside of a curve as the middles of its edges lie
/// inside. Both shares together are more than one, as an offset is off only at
/// corners, to the inside (measured: of a gyroid ball's outer wall 99 % are
/// within 3.8 µm of where they should be if the accuracy is 5 µm).
pub const OUTLINE_SHARE: f64 = 0.8;
/// Share of `accuracy` for an offset of the outline.
pub const OFFSET_SHARE: f64 = 0.3;

/// Greatest radius of a ball in a ring that is but a dot where strips meet, as a share
/// of the wall's width. The walls around it take its place, and are up to 1.6 times
/// their width. With 0.25 a crossing of strips is left open by 0.08 mm² in its middle,
/// with 0.07 there are two dots more where strips cross at an angle.
const DOT: f64 = 0.16;

/// A layer's walls and the area inside them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walls {
    /// Centre lines by wall, the outermost first.
    pub lines: Vec<Vec<Stroke>>,
    /// Beads in the middle of places too thin for walls: of the part first,
    /// then of what each wall leaves.
    pub thin: Vec<Vec<Stroke>>,
    /// Depths of the walls' centre lines below the outline, where the part is
    /// not too thin for them.
    pub depths: Vec<Mm>,
    /// The area that the walls leave for infill and skin.
    pub fill: Area,
    /// True if some of the walls do not go around the whole part, but around
    /// what the next layer covers.
    pub divided: bool,
    /// Solid that is neither under a bead nor left for filling, because it
    /// is thinner than any bead: mm², good to a per cent of the walls' area.
    pub gap: Mm2,
}

/// How one wall is laid below the border of an area.
#[derive(Clone, Copy, Debug)]
pub struct Lay {
    /// Depth of its centre line.
    pub centre: Mm,
    /// Depth at which the next wall's area begins.
    pub inner: Mm,
    /// Width of its bead.
    pub width: Mm,
    /// Thickness below which one bead takes the place of two.
    pub limit: Mm,
    /// Thickness below which there is no bead at all.
    pub least: Mm,
    /// By how much the bead of a thin place is wider than the place is thick.
    /// Between other beads it may overlap their round ends; at the part's
    /// surface it must not stick out.
    pub extra: Mm,
}

impl Lay {
    /// The outermost wall, of a bead's `width`.
    fn outer(width: Mm, height: Mm, thin: ThinPlan) -> Lay {
        // This is right for walls of equal width. A wall of another width
        // begins half of its own spacing farther in.
        let half = 0.5 * spacing(width, width, height);
        let share = |percent: f64| width * percent / 100.0;
        Lay {
            centre: 0.5 * width,
            inner: 0.5 * width + half,
            width,
            limit: share(thin.most).min(width + 2.0 * half),
            least: share(thin.least),
            extra: 0.0,
        }
    }

    /// Thickness down to which a bead, or a loop, goes on into a tip: it is short, so it
    /// may be narrower than lines are. A bead narrower than its height does not
    /// keep its width.
    fn tips(&self, height: Mm) -> Mm {
        /// Share of the least thickness of a line.
        const TIP: f64 = 0.7;
        (height - self.extra).max(TIP * self.least).min(self.least)
    }

    /// Thickness down to which a post has a bead: a dab that is thinner does
    /// not stick to what is below, unless lines are as thin.
    fn posts(&self, height: Mm) -> Mm {
        const DAB: Mm = 0.3;
        self.tips(height).max(DAB).min(self.least)
    }

    /// This wall in what other walls have left. The border of that area is off
    /// by up to `tolerance` on each side, and a place that was planned for a
    /// bead has to stay wide enough for it.
    fn after(self, tolerance: Mm) -> Lay {
        Lay {
            least: (self.least - 2.0 * tolerance).max(0.0),
            ..self
        }
    }

    /// A bead of `width` beside other beads.
    pub fn inside(width: Mm, height: Mm, thin: ThinPlan) -> Lay {
        let space = spacing(width, width, height);
        let extra = width - space;
        let share = |percent: f64| width * percent / 100.0 - extra;
        Lay {
            centre: 0.5 * space,
            inner: space,
            width,
            limit: share(thin.most).min(2.0 * space),
            least: share(thin.least).max(0.0),
            extra,
        }
    }
}

/// One wall's rings and the beads of places too thin for it.
pub struct Laid {
    /// The rings, cut where a bead runs in their middle.
    pub lines: Vec<Stroke>,
    /// The beads of places too thin for the wall.
    pub thin: Vec<Stroke>,
    /// The rings, whole.
    pub rings: Area,
}

/// Lays one wall along the border of an area.
pub fn lay(area: &Area, lay: Lay, tolerance: Mm) -> Laid {
    let beadings = Beadings::new(&[lay], None);
    let solid = Solid::of(area, cell(area));
    let skeleton = Skeleton::new(&solid, beadings.limit(), tolerance);
    let thin = skeleton.thin_places(&beadings);
    let rings = skeleton.shrunk(lay.centre, tolerance);
    let beads = thin.beads(1, 0.0);
    Laid {
        lines: cut(&rings, &beads, lay.centre, lay.width),
        thin: beads.iter().map(|r| r.stroke(lay.extra)).collect(),
        rings,
    }
}

/// Size of a grid's cells: three times the mean length of the edges, within
/// bounds (measured: smaller cells take longer to walk than they save edges,
/// larger ones have too many of them).
fn cell(area: &Area) -> Mm {
    let edges: usize = area.rings.iter().map(Vec::len).sum();
    (3.0 * area.perimeter() / edges.max(1) as f64).clamp(0.5, 1.0)
}

/// An area and its axes, as far as they matter to some walls.
///
/// An area that has shrunk by d keeps its axes where it was thicker than 2·d,
/// and is thinner there by 2·d. So the axes of the outline serve for all
/// walls.
struct Skeleton<'a> {
    solid: &'a Solid<'a>,
    axes: Vec<Axis>,
    /// Where axes go on although others meet them.
    nodes: Vec<DVec2>,
    /// Distances by which the area's edges can move inwards.
    room: Room,
}

impl<'a> Skeleton<'a> {
    fn new(solid: &'a Solid<'a>, limit: Mm, tolerance: Mm) -> Skeleton<'a> {
        /// Distance of a node from the axes that meet there, mm.
        const BESIDE: Mm = 0.1;
        let empty = solid.area().is_empty() || limit <= 0.0;
        let found = if empty {
            Axes::default()
        } else {
            axes(solid, limit, tolerance)
        };
        let Axes {
            mut axes,
            mut nodes,
            room,
        } = found;
        // A post's axis is a point, or a few places around it.
        axes.retain(|r| {
            Rect::around(&r.points).size().length() > 0.25 * r.thickest()
        });
        let lines = axes.iter().map(|r| r.points.iter().copied());
        let lines = EdgeGrid::of_lines(lines, limit);
        nodes.retain(|p| !lines.clear(*p, *p, BESIDE));
        Skeleton {
            solid,
            axes,
            nodes,
            room,
        }
    }

    /// Where axes end but not because the area grows thicker than `limit`:
    /// where strips meet, and at their tips.
    fn ends(&self, limit: Mm) -> impl Iterator<Item = DVec2> + '_ {
        /// Share of the limit from which on an axis may end because the area grows
        /// thicker.
        const THICK: f64 = 0.95;
        let open = self.axes.iter().filter(|r| !r.closed);
        let ends = open.flat_map(|r| {
            let all = || r.points.iter().zip(&r.thickness);
            all().next().into_iter().chain(all().next_back())
        });
        let thin = ends.filter(move |(_, t)| **t < THICK * limit);
        thin.map(|(p, _)| *p)
    }

    /// The area shrunk by `distance` and thinned.
    fn shrunk(&self, distance: Mm, tolerance: Mm) -> Area {
        let room = Some(&self.room);
        let shrunk = offset_within(self.solid, room, -distance, tolerance);
        simplify_area(&shrunk, tolerance)
    }

    /// The axes where there are fewer beads than the walls have.
    fn thin_places(&self, beadings: &Beadings) -> ThinPlaces {
        let limit = beadings.limit();
        let ends = points(self.ends(limit), limit);
        let bends = |part: &Axis| is_bend(part, self.solid.grid(), &ends);
        let webs = beadings.of_webs();
        let at_webs = |axis: &Axis| {
            let web = web::led_on(axis, self.solid.grid(), webs?)?;
            beadings.split_at_webs(&web, &bends)
        };
        let parts = self.axes.iter().flat_map(|r| {
            at_webs(r).unwrap_or_else(|| beadings.split(r, &bends))
        });
        ThinPlaces(parts.collect())
    }

    /// Where strips meet, and their tips, to be looked up within `reach`.
    fn nodes(&self, limit: Mm, reach: Mm) -> EdgeGrid {
        points(self.ends(limit).chain(self.nodes.iter().copied()), reach)
    }
}

/// A grid of places, to be looked up within `reach`.
fn points(places: impl Iterator<Item = DVec2>, reach: Mm) -> EdgeGrid {
    EdgeGrid::of(places.map(|p| (p, p)).enumerate(), reach)
}

/// Parts of an area's axes, and how many beads lie side by side there.
struct ThinPlaces(Vec<(usize, Axis)>);

impl ThinPlaces {
    /// The parts of axes with this number of beads, and the thickness that
    /// walls up to `depth` on both sides leave there.
    fn beads(&self, number: usize, depth: Mm) -> Vec<Axis> {
        let parts = self.0.iter().filter(|part| part.0 == number);
        parts
            .map(|(_, axis)| {
                let mut left = axis.clone();
                left.thickness.iter_mut().for_each(|t| *t -= 2.0 * depth);
                left
            })
            .collect()
    }

    /// The `k`th wall's rings without what runs where fewer walls are: along a
    /// bead, or between walls that bulge, however thick the place is.
    fn cut(&self, rings: &Area, k: usize, depth: Mm, lay: &Lay) -> Vec<Stroke> {
        let mut full = self.beads(2 * k, depth);
        full.retain(|axis| axis.thickest() > 2.0 * lay.centre);
        full.extend(self.beads(2 * k + 1, depth));
        cut(rings, &full, lay.centre, lay.width)
    }

    /// What walls up to `depth` on both sides leave where there are so many
    /// beads. The thickness is negative where walls overlap and have to become
    /// narrower. Slight overlaps are left out.
    fn slivers(&self, number: usize, depth: Mm) -> Vec<Axis> {
        /// Walls may overlap by so much, mm.
        const OVERLAP: Mm = 0.03;
        let mut parts = self.beads(number, depth);
        self.make_way(&mut parts, number + 1);
        parts
            .into_iter()
            .flat_map(|axis| axis.split_at(0.0))
            .filter(|part| part.thickest() > 0.0 || part.thinnest() < -OVERLAP)
            .collect()
    }

    /// The tips that the loop of a wall leads into, each as an axis that begins
    /// there.
    fn tips(&self, lay: &Lay, tolerance: Mm) -> Vec<Axis> {
        let parts = self.0.iter().filter(|part| part.0 == 2);
        let tips = parts.flat_map(|(_, axis)| {
            let tip = |last| axis.tip(last, 2.0 * lay.inner);
            [false, true].map(|last| tip(last).thinned(tolerance))
        });
        let closes = 2.0 * lay.centre;
        tips.filter(|t| t.thinnest() < closes && t.thickest() > closes)
            .collect()
    }

    /// Cuts slivers back where a bead goes on in the middle: the round end of
    /// that bead already fills a part of the sliver.
    fn make_way(&self, slivers: &mut [Axis], number: usize) {
        /// Length beyond the round end, mm, over which walls become wider.
        const MORE: Mm = 0.05;
        let beads = self.0.iter().filter(|part| part.0 == number);
        let ends: HashSet<[u64; 2]> = beads
            .filter(|(_, axis)| !axis.closed)
            .flat_map(|(_, axis)| {
                axis.points.first().into_iter().chain(axis.points.last())
            })
            .map(|p| p.to_array().map(f64::to_bits))
            .collect();
        for sliver in slivers.iter_mut().filter(|s| !s.closed) {
            for _ in 0..2 {
                sliver.points.reverse();
                sliver.thickness.reverse();
                let Some(end) = sliver.points.last() else {
                    continue;
                };
                if ends.contains(&end.to_array().map(f64::to_bits)) {
                    let round = sliver.thickness.last().copied();
                    sliver.shorten(0.5 * round.unwrap_or(0.0) + MORE);
                }
            }
        }
    }
}

impl WallPlan {
    /// How the `k`th wall from the outside is laid.
    fn lay(&self, k: usize, height: Mm) -> Lay {
        let lay = if k == 0 { Lay::outer } else { Lay::inside };
        lay(self.width(k), height, self.thin)
    }
}

/// The walls of supports. Their tips are not led on, as pieces that nobody sees
/// are too long to become narrow there. Pockets where their strips meet stay
/// open: they hold nothing, and take a tenth of the time to find.
pub fn support_walls(outline: &Area, height: Mm, plan: &WallPlan) -> Walls {
    laid(outline, None, false, height, plan)
}

/// The walls of a part's outline, with fewer of them around what the outline
/// `above`, that of the next layer, leaves open, if it is given.
pub fn walls(
    outline: &Area,
    above: Option<&Area>,
    height: Mm,
    plan: &WallPlan,
) -> Walls {
    laid(outline, above, true, height, plan)
}

/// True if a part's outline in a layer of this height has room for any bead.
pub fn prints(outline: &Area, height: Mm, plan: &WallPlan) -> bool {
    let walls = walls(outline, None, height, plan);
    // Without walls, skin fills the outline.
    !walls.fill.is_empty()
        || walls.lines.iter().chain(&walls.thin).any(|l| !l.is_empty())
}

/// The walls of an outline, as offsets in the plane; if they are `seen`, with
/// narrow tips, and wider beside pockets.
///
/// Two walls at a time, and what they leave, are made from the same border: a
/// grid of its edges and its axes serve for all of them. For more of them
/// the search would have to look too far around.
fn laid(
    outline: &Area,
    above: Option<&Area>,
    seen: bool,
    height: Mm,
    plan: &WallPlan,
) -> Walls {
    let WallPlan {
        count, accuracy, ..
    } = *plan;
    let tolerance = OFFSET_SHARE * accuracy;
    let lays = (0..count).map(|k| plan.lay(k, height));
    let skin = Lay::inside(plan.skin, height, plan.thin);
    let lays: Vec<Lay> = lays.chain([skin]).collect();
    let whole = Solid::of(outline, cell(outline));
    let mut area = outline.clone();
    let mut lines: Vec<Vec<Stroke>> = Vec::new();
    let mut thin = Vec::new();
    let divide =
        |left: &Area, above| tops::divided(left, above, plan, tolerance);
    // Where there is nothing to divide, all walls go around the whole part.
    let above = above.filter(|above| {
        let tops = &lays[..plan.around_tops];
        let depth: Mm = tops.iter().map(|lay| lay.inner).sum();
        divide(&shrink(outline, depth, tolerance), above).is_some()
    });
    // After so many walls, what is left is divided.
    let around_tops = above.map_or(count, |_| plan.around_tops);
    let mut divided = None;
    let mut next = 0;
    while next < count {
        let first = next;
        let stop = if first < around_tops {
            around_tops
        } else {
            count
        };
        next = stop.min(first + 2);
        let mut pair = lays[first..next].to_vec();
        if let (1.., Some(begins)) = (first, pair.first_mut()) {
            *begins = begins.after(2.0 * tolerance);
        }
        // The outer wall is seen. Walls of supports are as thin as can be. Where
        // beads follow the surface, a wide closed wall would end up to 0.03 mm
        // higher or lower than it begins.
        let shared = next == count && count > 1 && seen && plan.level;
        let mut beadings = Beadings::new(&pair, Some(lays[next]));
        if shared {
            beadings = beadings.with_shared(&pair[pair.len() - 1], &lays[next]);
        }
        if first == 0 && seen {
            beadings = beadings.with_tips(pair[0].tips(height));
        }
        let own;
        let solid = if first == 0 {
            &whole
        } else {
            own = Solid::of(&area, cell(&area));
            &own
        };
        let skeleton = Skeleton::new(solid, beadings.limit(), accuracy);
        let places = skeleton.thin_places(&beadings);
        // The border of the filled area is not seen, so it may be coarser.
        let thinned = if next == count { accuracy } else { tolerance };
        let depth: Mm = pair.iter().map(|lay| lay.inner).sum();
        let around = 0.35 * (2.0 * depth + lays[next].least);
        let nodes = skeleton.nodes(beadings.limit(), around);
        let mut left = skeleton.shrunk(depth, thinned);
        let depths = pair.iter().scan(0.0, |next, lay| {
            let depth = std::mem::replace(next, *next + lay.inner);
            Some(depth + lay.centre)
        });
        let mut all_rings: Vec<Area> = depths
            .map(|depth| skeleton.shrunk(depth, tolerance))
            .collect();
        // Dots inside the outer wall, at nodes.
        let mut dots = Vec::new();
        for (k, rings) in all_rings.iter_mut().enumerate() {
            if first + k > 0 {
                rings.rings.retain(|ring| {
                    let dot = is_dot(ring, DOT * pair[k].width, &nodes);
                    dots.extend(ring.first().filter(|_| dot));
                    !dot
                });
            }
        }
        let dots = points(dots.into_iter(), pair[0].width);
        let mut depth = 0.0;
        for (k, lay) in pair.iter().enumerate() {
            // Only the outer wall is seen.
            let outer = lines.is_empty();
            let rings = std::mem::take(&mut all_rings[k]);
            let beads = places.beads(2 * k + 1, depth);
            let mut walls = places.cut(&rings, k, depth, lay);
            let [least, post] = if outer && seen {
                [lay.tips(height), lay.posts(height)]
            } else {
                [lay.least; 2]
            };
            let beads = tip::lead_to_ends(beads, solid.grid(), depth, least);
            let beads: Vec<Stroke> =
                beads.iter().map(|r| r.stroke(lay.extra)).collect();
            if outer {
                tip::fill_posts(
                    &mut walls, &beads, solid, *lay, post, tolerance,
                );
            }
            depth += lay.inner;
            let slivers = places.slivers(2 * k + 2, depth);
            let away = lay.inner - lay.centre;
            // The axes that the widths follow are found to a share of the
            // accuracy.
            let fine = 0.4 * accuracy;
            let shares = shared && k + 1 == pair.len();
            let mut walls = if shares {
                let grid = solid.grid();
                Inside { grid, depth, away }.absorb(walls, &slivers, fine)
            } else {
                absorb(walls, &slivers, away, fine)
            };
            if outer && seen {
                walls = lead_into_tips(walls, &places.tips(lay, fine), lay);
            }
            let [walls, beads] = match lines.last() {
                Some(outside) => {
                    let width = lays[lines.len() - 1].width;
                    [walls, beads]
                        .map(|own| give_way(own, outside, width, height, fine))
                }
                None => [within(walls, solid.grid()), beads],
            };
            // Inside the last wall, beads of skin fill what a whole line fits into, or
            // the thinnest if the wall does not share it.
            let radius = match pair.get(k + 1) {
                Some(wall) => wall.centre + DOT * wall.width,
                None if shares => lays[next].centre,
                None => 0.5 * lays[next].least,
            };
            let mut beside = places.beads(2 * k + 4, depth);
            beside.retain(|axis| {
                axis.segments()
                    .all(|((a, _), (b, _))| dots.clear(a, b, 0.5 * lay.width))
            });
            beside.extend(places.beads(2 * k + 3, depth));
            let pockets = Left {
                grid: solid.grid(),
                depth,
                away,
                width: lay.width,
                radius,
                beads: &beside,
                nodes: &nodes,
                around,
                shares,
            };
            let walls = if seen {
                pockets.shared(walls, fine)
            } else {
                walls
            };
            if shares {
                let lays = (lay, &lays[next]);
                left = shared::without(left, &walls, lays, accuracy);
            } else if k + 1 == pair.len() {
                let next = &lays[next];
                left = shared::without_slivers(left, &slivers, next, accuracy);
            }
            lines.push(walls);
            thin.push(beads);
        }
        area = left;
        if let Some(above) = above.filter(|_| next == around_tops) {
            divided = divide(&area, above);
            if let Some(divided) = &divided {
                area.clone_from(&divided.rest);
            }
        }
    }
    if let Some(divided) = &divided {
        area = divided.filled(&area);
    }
    let mut walls = Walls::of(outline, lines, thin, area, height, plan);
    walls.divided = divided.is_some();
    for (k, lay) in lays[..count].iter().enumerate() {
        let depth = walls.depths[k] - lay.centre;
        walls.join(k, &whole, depth, lay.extra);
    }
    walls
}

impl Walls {
    /// The walls of an outline.
    fn of(
        outline: &Area,
        lines: Vec<Vec<Stroke>>,
        thin: Vec<Vec<Stroke>>,
        fill: Area,
        height: Mm,
        plan: &WallPlan,
    ) -> Walls {
        let mut walls = Walls {
            lines,
            thin,
            depths: plan.depths(height).0,
            fill,
            divided: false,
            gap: 0.0,
        };
        walls.gap = gap(outline, &walls, height, plan);
        walls
    }

    /// Joins the ends of the `k`th wall's strokes; see [`joined`].
    fn join(&mut self, k: usize, solid: &Solid<'_>, depth: Mm, extra: Mm) {
        let lines = std::mem::take(&mut self.lines[k]);
        let thin = std::mem::take(&mut self.thin[k]);
        (self.lines[k], self.thin[k]) =
            joined(lines, thin, solid, depth, extra, false);
    }
}

/// Joins the ends of rings and of beads in thin places, which lie deeper than
/// `depth` in a solid and reach `extra` beyond that together. If `dabs` is true,
/// dabs stay that lie nearly all on other beads, as skin that is seen needs them.
fn joined(
    lines: Vec<Stroke>,
    thin: Vec<Stroke>,
    solid: &Solid<'_>,
    depth: Mm,
    extra: Mm,
    dabs: bool,
) -> (Vec<Stroke>, Vec<Stroke>) {
    // A border farther away than any bead reaches leaves room for all of them.
    let widths = lines.iter().chain(&thin);
    let widest = widths.flat_map(|s| s.widths.iter().chain([&s.width]));
    let far = depth + widest.copied().fold(0.0, f64::max);
    let room = |p: DVec2| match solid.grid().nearest_edge(p, far) {
        Some((_, q)) => Space {
            width: 2.0 * (p.distance(q) - depth) + extra,
            out: (q - p).normalize_or_zero(),
        },
        None => Space {
            width: f64::INFINITY,
            out: DVec2::ZERO,
        },
    };
    // A bead of another wall reaches into this area by half of `extra`.
    let overlap = (!dabs).then_some(2.0 * extra);
    stitching::join(lines, thin, overlap, room)
}

/// True if a ring has no room for a larger ball than of this radius, and lies at a
/// node. A triangle around a ball of radius r is 10.4·r long. What is much longer is
/// the middle of a strip.
fn is_dot(ring: &[DVec2], radius: Mm, nodes: &EdgeGrid) -> bool {
    /// Distance of a dot from its node, in radii.
    const NEAR: f64 = 4.0;
    let area = signed_area(ring);
    let near = |p: &DVec2| !nodes.clear(*p, *p, NEAR * radius);
    area > 0.0
        && path_length(ring, true) < 12.0 * radius
        && ring.first().is_some_and(near)
        && offset(&Area::from(ring.to_vec()), -radius, 0.1 * radius).is_empty()
}

/// Walls whose centre lines are outlines of the expression offset by their
/// depths: `areas`, outermost first, the fill's border last. The depths are
/// millimetres in the plane only where the field is an in-plane distance.
pub fn field_walls(
    outline: &Area,
    mut areas: Vec<Area>,
    height: Mm,
    plan: &WallPlan,
) -> Walls {
    let fill = areas.pop().unwrap_or_default();
    let lines = areas
        .into_iter()
        .enumerate()
        .map(|(k, area)| cut(&area, &[], 0.0, plan.width(k)))
        .collect();
    Walls::of(outline, lines, Vec::new(), fill, height, plan)
}

/// The area shrunk by `distance` and thinned.
pub fn shrink(area: &Area, distance: Mm, tolerance: Mm) -> Area {
    if distance == 0.0 || area.is_empty() {
        return area.clone();
    }
    simplify_area(&offset(area, -distance, tolerance), tolerance)
}

/// Content of the outline less that of the beads' bands and the fill.
///
/// A band between the depths a and b around a closed line of length L at
/// depth m has the content L·(b − a) + π·χ·((m − a)² − (b − m)²) (Steiner's
/// formula, χ the number of outer rings less that of holes): exact for round
/// corners, off by a fraction of a square width at sharp ones.
fn gap(outline: &Area, walls: &Walls, height: Mm, plan: &WallPlan) -> Mm2 {
    let mut covered = walls.fill.content();
    for (k, wall) in walls.lines.iter().enumerate() {
        let lay = plan.lay(k, height);
        let (out, inn) = (lay.centre, lay.inner - lay.centre);
        for line in wall {
            let wider = line.width - lay.width;
            covered += line.length() * (out + inn + wider);
            if line.closed {
                let turn = signed_area(&line.points).signum();
                covered +=
                    std::f64::consts::PI * turn * (out.powi(2) - inn.powi(2));
            }
        }
    }
    for (k, beads) in walls.thin.iter().enumerate() {
        let extra = plan.lay(k, height).extra;
        // Round ends reach half a width beyond the line.
        covered += beads
            .iter()
            .map(|b| (b.length() + 0.8 * b.width) * (b.width - extra))
            .sum::<f64>();
    }
    // Sharp corners and thinning leave a remainder even where walls fit.
    let noise = 0.02 * (outline.content() - walls.fill.content()).max(0.0);
    let gap = outline.content() - covered;
    if gap > noise { gap } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::shapes;
    use isoslice_settings::testing::{plan_with, usual_plan};
    use std::f64::consts::PI;

    fn disc(r: f64) -> Area {
        shapes::disc(r, 2000)
    }

    #[test]
    fn walls_of_a_disc_are_concentric() {
        let plan = plan_with(WallPlan::of, |s| s.walls = 3);
        let w = walls(&disc(10.0), None, 0.2, &plan);
        let s = spacing(0.45, 0.45, 0.2);
        for (k, lines) in w.lines.iter().enumerate() {
            let r = 10.0 - 0.225 - s * k as f64;
            assert_eq!(lines.len(), 1);
            assert!(lines[0].closed && lines[0].widths.is_empty());
            for p in &lines[0].points {
                assert!((p.length() - r).abs() < 0.0016, "{k}: {p}");
            }
        }
        assert!(w.thin.iter().all(Vec::is_empty));
        let inner = 10.0 - 0.225 - 2.5 * s;
        assert!((w.fill.content() - PI * inner * inner).abs() < 0.1);
        assert_eq!(w.gap, 0.0);
    }

    /// Content of the part under a wall's beads: their cross-section over
    /// the layer's height, times their length with its round ends.
    fn extruded(w: &Walls, height: f64) -> f64 {
        let lines = w.lines.iter().chain(&w.thin).flatten();
        lines
            .map(|l| {
                let area =
                    isoslice_planar::bead::cross_section(l.width, height);
                let ends = if l.closed { 0.0 } else { 0.8 * l.width };
                area * (l.length() + ends) / height
            })
            .sum()
    }

    #[test]
    fn strips_of_any_thickness_are_filled_evenly() {
        let strip = |width: f64| {
            let ring = [(0.0, 0.0), (50.0, 0.0), (50.0, width), (0.0, width)]
                .map(|(x, y)| DVec2::new(x, y))
                .to_vec();
            walls(&Area::from(ring), None, 0.2, &usual_plan(WallPlan::of))
        };
        for i in 0..40 {
            let width = 0.3 + 0.04 * f64::from(i);
            let w = strip(width);
            let content = 50.0 * width;
            let share = extruded(&w, 0.2) / content;
            // The surface's round edges, h·(1 − π/4) in all, stay open; two
            // whole walls may be a twentieth too wide where they just fit.
            let open = 0.043 / width;
            assert!(
                share > 0.98 - open && share < 1.06 - 0.5 * open,
                "{width:.2} mm: {share:.3}"
            );
            assert!(w.gap < 0.03 * content, "{width:.2}: {}", w.gap);
        }
        // A fin gets the narrowest bead. Below that nothing can be done but say so.
        let w = strip(0.2);
        let share = extruded(&w, 0.2) / (50.0 * (0.27 - 0.043));
        assert!((share - 1.0).abs() < 0.03, "{share}");
        let w = strip(0.1);
        assert_eq!(extruded(&w, 0.2), 0.0);
        assert!((w.gap - 5.0).abs() < 1e-6);
    }

    #[test]
    fn walls_make_way_for_the_bead_that_begins_between_them() {
        let plan = usual_plan(WallPlan::of);
        let [outer, inner] = [0, 1].map(|k| plan.lay(k, 0.2));
        let beadings = Beadings::new(&[outer, inner], Some(inner));
        // A wedge from 0.9 to 1.5 mm: two walls, then a bead between them.
        let x = |i: usize| 0.5 * i as f64;
        let axis = Axis {
            points: (0..=60).map(|i| DVec2::X * x(i)).collect(),
            thickness: (0..=60).map(|i| 0.9 + 0.02 * x(i)).collect(),
            closed: false,
        };
        let places = ThinPlaces(beadings.split(&axis, &|_| false));
        let depth = outer.inner;
        let begins = places.beads(3, depth)[0].points[0].x;
        let bead = places.beads(3, depth)[0].thickness[0];
        let slivers = places.slivers(2, depth);
        let ends = slivers.iter().filter_map(|s| s.points.last());
        let ends = ends.map(|p| p.x).fold(0.0, f64::max);
        let between = begins - ends;
        assert!((0.5 * bead..0.3).contains(&between), "{between}");
    }

    #[test]
    fn an_outline_is_printed_if_a_bead_or_skin_has_room() {
        let printed = |width: f64, walls: u32| {
            let strip = isoslice_planar::rect(0.0, 0.0, 5.0, width);
            prints(&strip, 0.2, &plan_with(WallPlan::of, |s| s.walls = walls))
        };
        assert_eq!([0.1, 0.3, 2.0].map(|w| printed(w, 2)), [false, true, true]);
        assert!(printed(0.3, 0));
    }

    #[test]
    fn no_walls_leave_everything_to_the_fill() {
        let plan = plan_with(WallPlan::of, |s| s.walls = 0);
        let w = walls(&disc(3.0), None, 0.2, &plan);
        assert!(w.lines.is_empty());
        assert_eq!(w.fill, disc(3.0));
        assert_eq!(w.gap, 0.0);
    }
}
