//! Internal bridges: the lowest layer of skin over sparse infill.
//!
//! ```text
//!   ══╪════╪════╪══▌    lines run across those of the infill below (╪), so
//!   ══╪════╪════╪══▌    that no way from one to the next is longer than need
//!   ══╪════╪════╪══▌    be; they end on a line of infill or at a wall (▌)
//! ```
//!
//! In: a layer's skin and sparse area, and what the layer below has of infill.
//! Out: lines over the infill, the skin that is left, and what they take of the
//! sparse area where they go on to the next line of infill.
//!
//! The direction is the one in which the ways from one line of infill to the
//! next are shortest: the directions across the infill's lines are tried, and a
//! fan of angles. What three quarters of the lines' length stay below decides.
//!
//! Where the infill is so sparse that its bridges sag, more layers of bridges
//! follow (`internal_bridge_layers`), each across the lines of the one below as
//! if these were infill.
//!
//! Guarantees: each line ends on a line of infill, on what is solid below, or
//! at a wall. It goes on into the layer's sparse area for that, or, where the
//! next line of infill is far away, back to the last one that it crosses. Not
//! guaranteed: that lines fill all of the skin. One of which an end cannot be
//! held is left out, and the next layer lies over its place.

use super::bridge::shared;
use super::direction::{across, best, common, fan, rows};
use super::strokes::strokes;
use super::{Face, Fill, Patch};
use crate::bead::{Bead, Role, Stroke, spacing};
use crate::plane::clip::{difference, intersection, union, unite};
use crate::plane::grid::EdgeGrid;
use crate::plane::hatch::{Lines, hatch};
use crate::plane::offset::offset;
use crate::plane::{Area, Solid, signed_area};
use crate::settings::Settings;
use crate::units::{Degrees, Mm, Percent};
use glam::DVec2;

/// Tolerance of the offsets inside a part; nobody sees them.
const TOLERANCE: Mm = 0.02;

/// How far a line goes on to the next line of infill, at most, in ways that are
/// common from one line of infill to the next.
const FARTHEST: f64 = 1.5;

/// Directions of the infill's lines that are tried.
const DIRECTIONS: usize = 4;

/// Number of lines looked at for each direction.
const ROWS: f64 = 64.0;

/// Size of the cells of a grid of lines, mm.
pub(crate) const CELL: Mm = 1.0;

/// What bridges on bridges leave stays skin if a line fits in that reaches this
/// share of the usual width to both sides of its middle.
const LEFT: f64 = 0.4;

/// How far beyond a line's end something is looked for that holds the line, mm.
const BEYOND: Mm = 0.05;

/// Infill sparser than this has more than one layer of bridges, unless the
/// settings say how many there are, %.
const SPARSE: Percent = 10.0;

/// What the layer below has of infill, or of bridges that sag.
#[derive(Clone, Copy)]
pub(crate) struct Under<'a> {
    /// Where the layer below has what is to be bridged.
    pub area: &'a Solid<'a>,
    /// Where only lines hold what lies on the layer below: all of its sparse
    /// area.
    pub sparse: &'a Solid<'a>,
    /// All lines of the layer below that may be bridged.
    pub lines: &'a EdgeGrid,
}

/// Bridges of a layer on which the next one is to lay more.
pub(crate) struct Level {
    /// What the bridges' lines cover.
    area: Area,
    /// What the lines were to cover. Nothing lies below the part that they do
    /// not cover.
    meant: Area,
    lines: Vec<Vec<DVec2>>,
    /// Number of layers of bridges that are to follow.
    more: u32,
}

/// A [`Level`], with the infill beside it.
pub(crate) struct Below {
    area: Solid<'static>,
    sparse: Solid<'static>,
    lines: EdgeGrid,
    more: u32,
}

impl Level {
    /// These bridges with the sparse area and the infill of their layer.
    pub(crate) fn beside(self, sparse: &Area, infill: &[Bead]) -> Below {
        let infill = infill.iter().map(|bead| bead.path().collect());
        let lines: Vec<Vec<DVec2>> =
            self.lines.into_iter().chain(infill).collect();
        let lines = lines.iter().map(|line| line.iter().copied());
        Below {
            sparse: Solid::new(union(&union(&self.area, &self.meant), sparse)),
            area: Solid::new(self.area),
            lines: EdgeGrid::of_lines(lines, CELL),
            more: self.more,
        }
    }
}

/// A layer that may lie on infill.
#[derive(Clone, Copy)]
pub(crate) struct Over<'a> {
    /// The layer's skin.
    pub skin: &'a Area,
    /// The layer's own sparse area.
    pub sparse: &'a Area,
    /// The layer above, which covers what is no top.
    pub above: Face<'a>,
    /// The layer's height, mm.
    pub height: Mm,
}

/// Internal bridges, and what they leave.
pub(crate) struct Bridged {
    /// The bridges.
    pub patches: Vec<Patch>,
    /// The rest of the skin.
    pub skin: Area,
    /// The rest of the sparse area.
    pub sparse: Area,
    /// The bridges on which the next layer is to lay more.
    pub levels: Vec<Level>,
}

/// The internal bridges of a layer over the infill `under` it and over the
/// bridges `levels` below it, if there are any.
pub(crate) fn bridged(
    over: Over<'_>,
    under: Under<'_>,
    levels: &[Below],
    settings: &Settings,
) -> Option<Bridged> {
    let way = |way: Mm| more_layers(way, settings);
    let mut all = on(over, under, None, way, settings);
    for level in levels {
        let under = Under {
            area: &level.area,
            sparse: &level.sparse,
            lines: &level.lines,
        };
        let left = all.as_ref();
        let left = left
            .map_or((over.skin, over.sparse), |all| (&all.skin, &all.sparse));
        let taken = union(
            &difference(over.skin, left.0),
            &difference(over.sparse, left.1),
        );
        let over = Over {
            skin: left.0,
            sparse: left.1,
            ..over
        };
        let next = on(over, under, Some(&taken), |_| level.more - 1, settings);
        all = match (all, next) {
            (Some(mut all), Some(mut next)) => {
                all.patches.append(&mut next.patches);
                all.levels.append(&mut next.levels);
                Some(Bridged {
                    patches: all.patches,
                    levels: all.levels,
                    ..next
                })
            }
            (all, next) => next.or(all),
        };
    }
    all
}

/// Number of layers of bridges that follow the lowest one over infill. `way` is
/// the common way from one line of the infill to the next.
fn more_layers(way: Mm, settings: &Settings) -> u32 {
    let sparse = || match settings.infill_density.constant() {
        Some(density) if settings.infill_is_pattern() => density < SPARSE,
        // As far apart as the lines of a pattern that is as sparse.
        _ => way > settings.infill_width() * (100.0 / SPARSE - 1.0),
    };
    match settings.internal_bridge_layers {
        Some(layers) => layers.saturating_sub(1),
        None => u32::from(sparse()),
    }
}

/// The internal bridges of a layer over infill or over bridges, if there are
/// any. Over bridges, `other` is where the layer has bridges already, and what
/// gets no line stays skin, since it does not sag far. `more` gives the number
/// of layers of bridges that are to follow, by the common way.
fn on(
    over: Over<'_>,
    under: Under<'_>,
    other: Option<&Area>,
    more: impl Fn(Mm) -> u32,
    settings: &Settings,
) -> Option<Bridged> {
    let width = settings.skin_width();
    let hanging = intersection(over.skin, under.area.area());
    let hanging = intersection(&hanging, over.above.rough.area());
    // What is narrower than two lines lies on what is beside it.
    let core = offset(&hanging, -width, TOLERANCE);
    if core.is_empty() {
        return None;
    }
    let gaps = intersection(&offset(&core, width, TOLERANCE), &hanging);
    let (way, angle) = direction(under, width)?;
    let anchor = settings.bridge_anchor.max(0.5 * width);
    let grown = gaps.islands().into_iter().map(|gap| {
        crate::limits::check();
        offset(&gap, anchor, TOLERANCE)
    });
    let grown: Vec<Area> = grown.collect();
    let (parts, skin) = shared(over.skin, &grown);
    let ground = Ground {
        under,
        skin: match other {
            Some(other) => EdgeGrid::new(&union(over.skin, other), 1.0),
            None => EdgeGrid::new(over.skin, 1.0),
        },
        sparse: EdgeGrid::new(over.sparse, 1.0),
        reach: 0.5 * settings.infill_width(),
        farthest: FARTHEST * way + width,
    };
    let space = spacing(width, width, over.height);
    let mut taken = Area::EMPTY;
    let mut patches = Vec::new();
    for part in &parts {
        crate::limits::check();
        let lines = Lines {
            angle,
            spacing: space,
            phase: 0.0,
        };
        let shortest = 0.5 * width;
        let mut beads = Vec::new();
        for (_, mut stroke) in strokes(part, lines, width, shortest) {
            let ends = [false, true].map(|last| ground.end(&stroke, last));
            let [Some(first), Some(last)] = ends else {
                continue;
            };
            for end in [&first, &last] {
                stroke.points[end.index] = end.to;
            }
            let ways = [first, last].into_iter().filter(|end| end.goes_on);
            let half = 0.5 * space + TOLERANCE;
            let strips = ways.filter_map(|end| strip(end.from, end.to, half));
            if stroke.length() >= shortest {
                taken.rings.extend(strips);
                beads.push(Bead::new(
                    Role::InternalBridge,
                    stroke,
                    over.height,
                ));
            }
        }
        if !beads.is_empty() {
            patches.push(Patch {
                rings: Vec::new(),
                fills: vec![Fill {
                    lines: beads,
                    after: Vec::new(),
                    one_way: Vec::new(),
                }],
            });
        }
    }
    if patches.is_empty() {
        return None;
    }
    // Lines beside one another end at one line of infill: the strips between
    // them, thinner than a line, are no place for infill.
    let taken = offset(&unite(&taken), 0.5 * space, TOLERANCE);
    let taken = offset(&taken, -0.5 * space, TOLERANCE);
    let more = more(way);
    let mut all = Bridged {
        patches,
        skin,
        sparse: difference(over.sparse, &taken),
        levels: Vec::new(),
    };
    if more == 0 && other.is_none() {
        return Some(all);
    }
    let lines = lines_of(&all.patches);
    let area = covered(&lines, 0.5 * space + TOLERANCE);
    // What the lines have taken of the sparse area has no infill, either.
    let meant = parts.into_iter().flat_map(|part| part.rings);
    let meant = unite(&meant.chain(taken.rings).collect());
    if other.is_some() {
        let rest = difference(&meant, &area);
        let rest = offset(&rest, -LEFT * width, TOLERANCE);
        let rest = offset(&rest, LEFT * width, TOLERANCE);
        all.skin = union(&all.skin, &rest);
    }
    if more > 0 {
        all.levels.push(Level {
            area,
            meant,
            lines,
            more,
        });
    }
    Some(all)
}

/// The lines of some bridges.
fn lines_of(patches: &[Patch]) -> Vec<Vec<DVec2>> {
    let fills = patches.iter().flat_map(|patch| &patch.fills);
    let lines = fills.flat_map(|fill| &fill.lines);
    lines.map(|bead| bead.path().collect()).collect()
}

/// What straight lines cover that reach `half` to both sides.
fn covered(lines: &[Vec<DVec2>], half: Mm) -> Area {
    let ways = lines.iter().flat_map(|line| line.windows(2));
    let strips = ways.filter_map(|way| strip(way[0], way[1], half));
    unite(&strips.collect())
}

/// The rectangle on both sides of a way; nothing if it has no length.
fn strip(from: DVec2, to: DVec2, half: Mm) -> Option<Vec<DVec2>> {
    let along = (to - from).try_normalize()?;
    let side = half * along.perp();
    let back = TOLERANCE * along;
    let mut ring =
        vec![from - back - side, to - side, to + side, from - back + side];
    if signed_area(&ring) < 0.0 {
        ring.reverse();
    }
    Some(ring)
}

/// What lines may end on.
struct Ground<'a> {
    under: Under<'a>,
    /// The layer's own areas: its skin, including what other bridges cover, and
    /// the rest.
    skin: EdgeGrid,
    sparse: EdgeGrid,
    /// How far from its middle a line of infill holds what lies on it.
    reach: Mm,
    /// How far a line goes on to something that holds it.
    farthest: Mm,
}

/// An end of a line that has to move.
struct End {
    /// The point's index in the line.
    index: usize,
    /// Where the end is, and where it has to be.
    from: DVec2,
    to: DVec2,
    /// True if the line has to become longer.
    goes_on: bool,
}

impl Ground<'_> {
    /// Where an end of a line has to be so that something holds it; nothing if
    /// there is no such place.
    fn end(&self, line: &Stroke, last: bool) -> Option<End> {
        let n = line.points.len();
        let (index, next) = if last {
            (n.checked_sub(1)?, n.checked_sub(2)?)
        } else {
            (0, 1)
        };
        let (p, inner) = (line.points[index], *line.points.get(next)?);
        let out = (p - inner).try_normalize()?;
        let at = |to: DVec2| End {
            index,
            from: p,
            to,
            goes_on: (to - p).dot(out) > 0.0,
        };
        if self.is_held(p, out) {
            return Some(at(p));
        }
        // The line goes on from where a line of infill would hold its end as it
        // is, unless other skin is in the way.
        let from = p - self.reach * out;
        let free = self.sparse.contains(p + BEYOND * out);
        if free && let Some(to) = self.next_hold(from, out) {
            return Some(at(if (to - p).dot(out) > 0.0 { to } else { p }));
        }
        // Otherwise the line goes back to the last line of infill that it
        // crosses.
        let cuts = self.under.lines.crossings(p, inner);
        let near = cuts.into_iter().fold(f64::INFINITY, f64::min);
        let to = p.lerp(inner, near) + self.reach * out;
        near.is_finite()
            .then(|| at(if (to - p).dot(out) > 0.0 { p } else { to }))
    }

    /// True if a line in the direction `out` that ends at `p` ends at a wall or
    /// over what is solid.
    fn is_held(&self, p: DVec2, out: DVec2) -> bool {
        let beyond = p + BEYOND * out;
        let wall = !self.sparse.contains(beyond) && !self.skin.contains(beyond);
        wall || !self.under.sparse.grid().contains(beyond)
    }

    /// Where a line may end that goes on from a place in the direction `out`:
    /// on the next line of infill, on what is solid below, or at a wall.
    fn next_hold(&self, from: DVec2, out: DVec2) -> Option<DVec2> {
        let to = from + self.farthest * out;
        let first = |cuts: Vec<f64>, least: f64| {
            let ahead = cuts.into_iter().filter(|t| *t > least);
            ahead.fold(f64::INFINITY, f64::min)
        };
        // Borders behind the end are passed already.
        let end = (self.reach + BEYOND) / self.farthest;
        let line = first(self.under.lines.crossings(from, to), 0.0);
        let solid = first(self.under.sparse.grid().crossings(from, to), end);
        // The sparse area ends at a wall, or at other skin of the layer.
        let wall = first(self.sparse.crossings(from, to), end);
        let near = line.min(solid).min(wall);
        let at = near.is_finite().then(|| from.lerp(to, near))?;
        if near < wall {
            // The bridge's line lies on the whole width of the line of infill.
            return Some(at + self.reach * out);
        }
        // Other skin that hangs itself holds nothing.
        let beyond = at + BEYOND * out;
        let skin = self.skin.contains(beyond);
        let hangs = self.under.sparse.grid().contains(beyond);
        (!(skin && hangs)).then_some(at)
    }
}

/// The direction in which the ways over a layer's infill from one of its lines
/// to the next are shortest, and the way that is common there. All of a layer
/// has one direction, so that its lines do not get in one another's way.
fn direction(under: Under<'_>, width: Mm) -> Option<(Mm, Degrees)> {
    let along = infill_directions(under.lines, under.area.area());
    let tried = along.into_iter().map(across).chain(fan());
    best(tried.filter_map(|a| Some((common_way(under, a, width)?, a))))
}

/// The directions in which most of some infill's lines run.
fn infill_directions(lines: &EdgeGrid, area: &Area) -> Vec<Degrees> {
    /// Directions that count as one, degrees.
    const STEP: usize = 2;
    const BINS: usize = 180 / STEP;
    let bounds = area.bounds();
    let mut edges = Vec::new();
    lines.visit_box(bounds.min, bounds.max, |edge| edges.push(edge));
    edges.sort_unstable();
    edges.dedup();
    // Length, and length times angle, by direction.
    let mut bins = [(0.0, 0.0); BINS];
    for edge in edges {
        let (a, b) = lines.edge(edge);
        let angle = (b - a).to_angle().to_degrees();
        // Whole degrees lie in the middle of a bin.
        let angle = (angle + 0.5 * STEP as f64).rem_euclid(180.0);
        let bin = &mut bins[(angle as usize / STEP).min(BINS - 1)];
        let length = a.distance(b);
        bin.0 += length;
        bin.1 += length * (angle - 0.5 * STEP as f64);
    }
    let mut order: Vec<usize> =
        (0..BINS).filter(|&i| bins[i].0 > 0.0).collect();
    order.sort_by(|&a, &b| bins[b].0.total_cmp(&bins[a].0));
    order.truncate(DIRECTIONS);
    order.into_iter().map(|i| bins[i].1 / bins[i].0).collect()
}

/// The way from one line of infill to the next that most of the length of lines
/// in a direction stays below; nothing if no line fits in.
fn common_way(under: Under<'_>, angle: Degrees, width: Mm) -> Option<Mm> {
    let gap = under.area.area();
    let lines = rows(gap, angle, ROWS, width);
    let mut ways: Vec<(Mm, Mm)> = Vec::new();
    for line in hatch(gap, lines, 0.5 * width) {
        let length = line.from.distance(line.to);
        let mut stops = under.lines.crossings(line.from, line.to);
        stops.extend([0.0, 1.0]);
        stops.sort_by(f64::total_cmp);
        let all = stops.windows(2);
        let all = all.map(|pair| (pair[1] - pair[0]) * length);
        ways.extend(all.map(|way| (way, way)));
    }
    common(ways)
}
