//! Internal bridges: the lowest layer of skin over sparse infill.
//!
//! ```text
//!   ══╪════╪════╪══▌    lines run across those of the infill below (╪), so
//!   ══╪════╪════╪══▌    that no way from one to the next is longer than need
//!   ══╪════╪════╪══▌    be; they end on a line of infill or at a wall (▌)
//! ```
//!
//! In: a layer's skin, sparse area and walls, and the beads of the layer below.
//! Out: lines over the infill, the skin that is left, and what they take of the
//! sparse area where they go on to the next line of infill.
//!
//! The direction is the one in which the ways from one line of infill to the
//! next are shortest: the directions across the infill's lines are tried, and a
//! fan of angles. What three quarters of the lines' length stay below decides.
//!
//! Where the infill is so sparse that its bridges sag, more layers of bridges
//! follow (`internal_bridges`), each across the lines of the one below as
//! if these were infill.
//!
//! Guarantees: each line ends on a bead of the layer below, or at a wall of its
//! own layer. It goes on into the layer's sparse area for that, or, where the next
//! bead is far away, back to the last place that one holds. Lines on both sides of a
//! narrow strip of sparse area (under a rib, for instance) run through it. Beads count
//! where they are laid, and not where an area says that there should be some. Not
//! guaranteed: that lines fill all of the skin. One of which an end cannot be
//! held is left out, and the next layer lies over its place, with bridges unless
//! it is seen. A place over infill in which no line at all can be held stays skin,
//! whatever else the layer has. So does what hangs in the air, and what a bridge
//! beside it is anchored on. The layer below is what the caller says, which need not
//! be what is printed.

use super::SkinPlan;
use super::bridge::shared;
use super::direction::{across, best, common, fan, rows};
use super::plan::InternalBridgePlan;
use super::strips::{covered, strip};
use super::strokes::strokes;
use super::{Fill, Patch};
use crate::cover::{Covered, Islands};
use crate::view::LayerView;
use glam::DVec2;
use isoslice_base::units::{Degrees, Mm, Percent};
use isoslice_planar::bead::{Bead, Role, Stroke, spacing};
use isoslice_planar::clip::{difference, intersection, union, unite};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::{Lines, hatch};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::{closed, opened};
use isoslice_planar::{Area, Solid};

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
pub const CELL: Mm = 1.0;

/// What lines leave counts if a line fits in that reaches this share of the usual
/// width to both sides of its middle.
const LEFT: f64 = 0.4;

/// How far beyond a line's end the search asks what lies there, mm.
const BEYOND: Mm = 0.05;

/// Distance of the places along a line that are tried for a hold, mm.
const HOLD_STEP: Mm = 0.1;

/// A bead of walls or of skin holds the end of a line whose middle is within this
/// share of the line's width of the bead's own middle. Lines that lie side by side
/// leave no place between them that is farther away.
const ON_SOLID: f64 = 0.65;

/// Infill sparser than this has more than one layer of bridges, unless the
/// settings say how many there are, %.
const SPARSE: Percent = 10.0;

/// What the layer below has of infill, or of bridges that sag.
#[derive(Clone, Copy)]
pub struct Under<'a> {
    /// Where the layer below has what is to be bridged.
    pub area: &'a Solid<'a>,
    /// All lines of the layer below that may be bridged.
    pub lines: &'a EdgeGrid,
    /// The lines of its walls and of its skin.
    pub shell: &'a [Vec<DVec2>],
}

/// Bridges of a layer on which the next one is to lay more.
pub struct Level {
    /// What the bridges' lines cover.
    area: Area,
    lines: Vec<Vec<DVec2>>,
    /// Number of layers of bridges that are to follow.
    more: u32,
}

/// A [`Level`], with the infill beside it.
pub struct Below {
    area: Solid<'static>,
    lines: EdgeGrid,
    more: u32,
}

impl Level {
    /// These bridges with the infill of their layer.
    pub fn beside(self, infill: &[Bead]) -> Below {
        let infill = infill.iter().map(|bead| bead.stroke.path().collect());
        let lines: Vec<Vec<DVec2>> =
            self.lines.into_iter().chain(infill).collect();
        let lines = lines.iter().map(|line| line.iter().copied());
        Below {
            area: Solid::new(self.area),
            lines: EdgeGrid::of_lines(lines, CELL),
            more: self.more,
        }
    }
}

/// A layer that may lie on infill.
#[derive(Clone, Copy)]
pub struct Over<'a> {
    /// The layer's skin.
    pub skin: &'a Area,
    /// The layer's own sparse area.
    pub sparse: &'a Area,
    /// The layer's own walls.
    pub walls: &'a [Bead],
    /// The layer, and those around it.
    pub view: &'a LayerView<'a>,
}

/// Internal bridges, and what they leave.
pub struct Bridged {
    /// The bridges.
    pub patches: Vec<Patch>,
    /// The rest of the skin.
    pub skin: Area,
    /// The rest of the sparse area.
    pub sparse: Area,
    /// Where the layer has neither bridges, as no line of theirs would be held,
    /// nor anything else.
    pub left: Area,
    /// The bridges on which the next layer is to lay more.
    pub levels: Vec<Level>,
}

/// The internal bridges of a layer over the infill `under` it and over the
/// bridges `levels` below it, if there are any.
pub fn bridged(
    over: Over<'_>,
    under: Under<'_>,
    levels: &[Below],
    plan: &SkinPlan,
) -> Option<Bridged> {
    let way = |way: Mm| more_layers(way, &plan.internal_bridges);
    let mut all = on(over, under, false, way, plan);
    for level in levels {
        let under = Under {
            area: &level.area,
            lines: &level.lines,
            ..under
        };
        let left = all.as_ref();
        let left = left
            .map_or((over.skin, over.sparse), |all| (&all.skin, &all.sparse));
        let over = Over {
            skin: left.0,
            sparse: left.1,
            ..over
        };
        let next = on(over, under, true, |_| level.more - 1, plan);
        all = match (all, next) {
            (Some(mut all), Some(mut next)) => {
                all.patches.append(&mut next.patches);
                all.levels.append(&mut next.levels);
                Some(Bridged {
                    patches: all.patches,
                    levels: all.levels,
                    left: all.left,
                    ..next
                })
            }
            (all, next) => next.or(all),
        };
    }
    all
}

/// False if no bridge fits where skin lies over what is `open` in the layer below.
pub fn may_bridge(skin: &Area, open: &Area, plan: &SkinPlan) -> bool {
    let core = core(&intersection(skin, open), plan);
    !core.is_empty()
}

/// What of hanging skin is wide enough for bridges: what is narrower than two
/// lines lies on what is beside it.
fn core(hanging: &Area, plan: &SkinPlan) -> Area {
    offset(hanging, -plan.internal.width, TOLERANCE)
}

/// Number of layers of bridges that follow the lowest one over infill. `way` is
/// the common way from one line of the infill to the next.
fn more_layers(way: Mm, plan: &InternalBridgePlan) -> u32 {
    let sparse = || match plan.density {
        Some(density) => density < SPARSE,
        // As far apart as the lines of a pattern that is as sparse.
        None => way > plan.infill * (100.0 / SPARSE - 1.0),
    };
    match plan.layers {
        Some(layers) => layers.saturating_sub(1),
        None => u32::from(sparse()),
    }
}

/// The internal bridges of a layer over one kind of thing, if there are any.
/// `on_bridges` is true if that is bridges: what gets no line then stays skin,
/// since it does not sag far. `more` gives the number of layers of bridges that
/// are to follow, by the common way.
fn on(
    over: Over<'_>,
    under: Under<'_>,
    on_bridges: bool,
    more: impl Fn(Mm) -> u32,
    plan: &SkinPlan,
) -> Option<Bridged> {
    let width = plan.internal.width;
    let hanging = intersection(over.skin, under.area.area());
    // The layer above covers what is no top.
    let above = over.view.above.first()?;
    let hanging = intersection(&hanging, above.rough.area());
    let core = core(&hanging, plan);
    if core.is_empty() {
        return None;
    }
    let height = over.view.here.span.height();
    let kept = over.beside_gaps(plan)?;
    let core = without(&core, &kept);
    if core.is_empty() {
        return None;
    }
    let free = without(over.skin, &kept);
    let gaps = intersection(&offset(&core, width, TOLERANCE), &hanging);
    let (way, angle) = direction(under, width)?;
    let anchor = plan.anchor.max(0.5 * width);
    let grown = gaps.islands().into_iter();
    let grown = grown.map(|gap| offset(&gap, anchor, TOLERANCE));
    let grown: Vec<Area> = grown.collect();
    let (parts, skin) = shared(&free, &grown);
    let ground = Ground::new(over, under, FARTHEST * way + width, plan);
    let space = spacing(width, width, height);
    let along = DVec2::from_angle(angle.to_radians());
    let lines = Lines {
        angle,
        spacing: space,
        phase: 0.0,
    };
    let rows = rows_of(&parts, lines, width);
    let half = 0.5 * space + TOLERANCE;
    let mut taken = Area::EMPTY;
    let mut beads = vec![Vec::new(); parts.len()];
    let mut has_lines = vec![false; parts.len()];
    for row in ground.through_strips(rows, along) {
        if isoslice_base::limits::is_stopped() {
            return None;
        }
        let held = ground.held(row.stroke);
        let held = held.filter(|(line, _)| line.length() >= 0.5 * width);
        let Some((stroke, ways_on)) = held else {
            continue;
        };
        let Some((begin, end)) = stroke.ends() else {
            continue;
        };
        // The line may have been taken back out of some of its parts.
        let (begin, end) = (along.dot(begin), along.dot(end));
        let passed = |(from, to): Way| {
            let [a, b] = [from, to].map(|p| along.dot(p));
            let share = |at: Mm| ((at - a) / (b - a)).clamp(0.0, 1.0);
            let [first, last] = [share(begin), share(end)];
            (first < last).then(|| (from.lerp(to, first), from.lerp(to, last)))
        };
        let filled = row.parts.into_iter();
        let filled = filled.filter(|(_, own)| passed(*own).is_some());
        let filled: Vec<usize> = filled.map(|(part, _)| part).collect();
        let Some(&first) = filled.first() else {
            continue;
        };
        filled.iter().for_each(|&part| has_lines[part] = true);
        let ways = row.ways.into_iter().filter_map(passed);
        let ways = ways.chain(ways_on.into_iter().flatten());
        let strips = ways.filter_map(|(from, to)| strip(from, to, half));
        taken.rings.extend(strips);
        let bead = Bead::new(Role::InternalBridge, stroke, height);
        beads[first].push(bead);
    }
    let lines = beads.into_iter().filter(|lines| !lines.is_empty());
    let patches = lines.map(|lines| Patch {
        rings: Vec::new(),
        fills: vec![Fill {
            lines,
            after: Vec::new(),
            one_way: Vec::new(),
        }],
    });
    let patches: Vec<Patch> = patches.collect();
    // Places that stay skin, as if there were no other places.
    let (mut refused, mut filled) = (Area::EMPTY, Vec::new());
    for (part, has_lines) in parts.into_iter().zip(has_lines) {
        if has_lines {
            filled.push(part);
        } else {
            refused.rings.extend(part.rings);
        }
    }
    if patches.is_empty() {
        return None;
    }
    let skin = if refused.is_empty() {
        skin
    } else {
        union(&skin, &unite(&refused))
    };
    // Lines beside one another end at one line of infill: the strips between
    // them, thinner than a line, are no place for infill.
    let taken = closed(&unite(&taken), 0.5 * space, TOLERANCE);
    let more = more(way);
    let lines = lines_of(&patches);
    let area = covered(&lines, angle, 0.5 * space + TOLERANCE);
    // What the lines have taken of the sparse area has no infill, either.
    let sparse = difference(over.sparse, &taken);
    let meant = filled.into_iter().flat_map(|part| part.rings);
    let meant = unite(&meant.chain(taken.rings).collect());
    let left = difference(&meant, &area);
    let left = opened(&left, LEFT * width, TOLERANCE);
    let (held, left) = if on_bridges {
        (left, Area::EMPTY)
    } else {
        // What lies beside skin that stays goes with it.
        let beside = offset(&kept, width, TOLERANCE);
        let (held, left): (Vec<Area>, Vec<Area>) = left
            .islands()
            .into_iter()
            .partition(|left| !intersection(left, &beside).is_empty());
        (held.into_iter().collect(), left.into_iter().collect())
    };
    let skin = [kept, held].iter().fold(skin, |skin, more| {
        if more.is_empty() {
            skin
        } else {
            union(&skin, more)
        }
    });
    let level = Level { area, lines, more };
    Some(Bridged {
        patches,
        skin,
        sparse,
        left,
        levels: (more > 0).then_some(level).into_iter().collect(),
    })
}

impl Over<'_> {
    /// The skin that hangs in the air, and what its lines reach onto: there,
    /// bridges have to be anchored.
    fn beside_gaps(&self, plan: &SkinPlan) -> Option<Area> {
        let half = 0.5 * plan.bottom.width;
        let islands = self.skin.islands();
        let below = self.view.below.first()?.rough;
        let covered = Islands::new(&islands).covered(below);
        let all = islands.iter().zip(covered);
        let some = all.filter(|(_, covered)| *covered != Covered::Wholly);
        let some: Area = some.map(|(island, _)| island.clone()).collect();
        if some.is_empty() {
            return Some(Area::EMPTY);
        }
        let hanging = difference(&some, below.area());
        // Any bead bridges a gap that is no wider than itself.
        let core = offset(&hanging, -half, TOLERANCE);
        let ring = 0.5 * plan.internal.width + plan.off_ring;
        let reach = plan.anchor.max(half) + ring;
        let reached = offset(&core, half + reach, TOLERANCE);
        Some(intersection(&reached, self.skin))
    }
}

/// An area without another one, which is often empty.
fn without(area: &Area, other: &Area) -> Area {
    if other.is_empty() {
        area.clone()
    } else {
        difference(area, other)
    }
}

/// The lines of some bridges.
fn lines_of(patches: &[Patch]) -> Vec<Vec<DVec2>> {
    let fills = patches.iter().flat_map(|patch| &patch.fills);
    let lines = fills.flat_map(|fill| &fill.lines);
    lines.map(|bead| bead.stroke.path().collect()).collect()
}

/// What lines may end on.
struct Ground<'a> {
    /// Lines of infill, or of bridges, of the layer below, and how far from its
    /// middle one holds what lies on it.
    lines: &'a EdgeGrid,
    reach: Mm,
    /// Walls and skin of the layer below, and how far one holds what lies on it.
    shell: EdgeGrid,
    on_shell: Mm,
    /// The layer's own walls, and how far away a line may be that touches one.
    walls: EdgeGrid,
    beside_wall: Mm,
    /// The layer's own sparse area.
    sparse: EdgeGrid,
    /// How far a line goes on to something that holds it.
    farthest: Mm,
}

/// A way that a line goes on, from where it ended to where it ends.
type Way = (DVec2, DVec2);

/// A line of bridges before its ends are held.
struct Row {
    /// The numbers of the parts that it fills, and its way in each.
    parts: Vec<(usize, Way)>,
    stroke: Stroke,
    /// Its ways through the sparse area between these parts.
    ways: Vec<Way>,
}

impl Row {
    /// Joins the line to the next one by a way.
    fn join(&mut self, next: Row, way: Way) {
        let stroke = &mut self.stroke;
        if !(stroke.widths.is_empty() && next.stroke.widths.is_empty()) {
            let widths = |of: &Stroke| -> Vec<Mm> {
                (0..of.points.len()).map(|i| of.width_at(i)).collect()
            };
            stroke.widths = widths(stroke);
            stroke.widths.extend(widths(&next.stroke));
        }
        stroke.points.extend(next.stroke.points);
        self.ways.push(way);
        self.ways.extend(next.ways);
        self.parts.extend(next.parts);
    }
}

/// The lines that fill parts, each with the number of its row.
fn rows_of(parts: &[Area], lines: Lines, width: Mm) -> Vec<(i64, Row)> {
    let mut rows: Vec<(i64, Row)> = Vec::new();
    for (part, area) in parts.iter().enumerate() {
        let all = strokes(area, lines, width, 0.5 * width).into_iter();
        rows.extend(all.map(|(row, stroke)| {
            let parts = stroke.ends().map(|way| (part, way));
            let own = Row {
                parts: parts.into_iter().collect(),
                stroke,
                ways: Vec::new(),
            };
            (row, own)
        }));
    }
    rows
}

impl<'a> Ground<'a> {
    fn new(
        over: Over<'_>,
        under: Under<'a>,
        farthest: Mm,
        plan: &SkinPlan,
    ) -> Ground<'a> {
        let shell = under.shell.iter().map(|line| line.iter().copied());
        let walls = over.walls.iter().map(|wall| wall.stroke.path());
        Ground {
            lines: under.lines,
            reach: 0.5 * plan.internal_bridges.infill,
            shell: EdgeGrid::of_lines(shell, CELL),
            on_shell: ON_SOLID * plan.internal.width,
            walls: EdgeGrid::of_lines(walls, CELL),
            beside_wall: plan.internal_bridges.beside_wall,
            sparse: EdgeGrid::new(over.sparse, CELL),
            farthest,
        }
    }

    /// Joins lines of one row with a strip of sparse area between them that is no
    /// wider than they may go on: from both sides they would meet in it, or both
    /// end before it.
    fn through_strips(&self, rows: Vec<(i64, Row)>, along: DVec2) -> Vec<Row> {
        let begin = |i: usize| rows[i].1.stroke.points.first();
        let place = |i: usize| begin(i).map_or(0.0, |p| along.dot(*p));
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by(|&i, &j| {
            let places = || place(i).total_cmp(&place(j));
            rows[i].0.cmp(&rows[j].0).then_with(places)
        });
        let mut rows: Vec<Option<(i64, Row)>> =
            rows.into_iter().map(Some).collect();
        let mut last = None;
        for i in order {
            let Some((number, row)) = rows[i].take() else {
                continue;
            };
            let before: Option<&mut (i64, Row)> =
                last.and_then(|i: usize| rows[i].as_mut());
            match before {
                Some((n, before)) if *n == number => {
                    if let Some(way) = self.strip_between(before, &row) {
                        before.join(row, way);
                        continue;
                    }
                }
                _ => {}
            }
            rows[i] = Some((number, row));
            last = Some(i);
        }
        rows.into_iter().flatten().map(|(_, row)| row).collect()
    }

    /// The way from the end of a line to the beginning of the next one, if it leads
    /// through a narrow strip of the layer's sparse area and nothing else.
    fn strip_between(&self, before: &Row, after: &Row) -> Option<Way> {
        let from = *before.stroke.points.last()?;
        let to = *after.stroke.points.first()?;
        let length = from.distance(to);
        // Where bridges are near each other, their areas end a little earlier.
        let slack = self.reach / length;
        let inside = slack..1.0 - slack;
        let is_strip = (2.0 * BEYOND..=self.farthest).contains(&length)
            && self.sparse.contains(from.midpoint(to))
            && !self
                .sparse
                .crossings(from, to)
                .iter()
                .any(|t| inside.contains(t));
        is_strip.then_some((from, to))
    }

    /// A line whose ends are where something holds them, with the ways that it
    /// goes on for that; nothing if there are no such places.
    fn held(&self, mut line: Stroke) -> Option<(Stroke, [Option<Way>; 2])> {
        let last = self.hold_last(&mut line)?;
        line.reverse();
        let first = self.hold_last(&mut line)?;
        line.reverse();
        Some((line, [first, last]))
    }

    /// Moves the last end of a line to where something holds it. Returns the way
    /// if the line becomes longer, and nothing if there is no such place.
    fn hold_last(&self, line: &mut Stroke) -> Option<Option<Way>> {
        loop {
            let p = *line.points.last()?;
            if self.holds(p) {
                return Some(None);
            }
            let inner = *line.points.iter().nth_back(1)?;
            let out = (p - inner).normalize_or_zero();
            if let Some(to) = self.next_hold(p, out) {
                *line.points.last_mut()? = to;
                return Some(Some((p, to)));
            }
            if let Some(to) = self.last_hold(p, inner) {
                *line.points.last_mut()? = to;
                return Some(None);
            }
            line.points.pop();
            line.widths.pop();
        }
    }

    /// True if something holds the end of a line.
    fn holds(&self, p: DVec2) -> bool {
        !self.lines.clear(p, p, self.reach + TOLERANCE)
            || !self.shell.clear(p, p, self.on_shell)
            || !self.walls.clear(p, p, self.beside_wall + TOLERANCE)
    }

    /// Where a way first crosses a bead of the layer below, as a share of the way.
    /// A bead that runs the same way as the way itself is not crossed, though
    /// rounding may find a place anywhere on it.
    fn crossed(&self, from: DVec2, to: DVec2) -> Option<f64> {
        let mut all = self.lines.crossings(from, to);
        all.extend(self.shell.crossings(from, to));
        all.sort_by(f64::total_cmp);
        all.into_iter().find(|t| self.holds(from.lerp(to, *t)))
    }

    /// Where a line may end that goes on from its end `p` in the direction `out`
    /// into the layer's sparse area; nothing if it cannot.
    fn next_hold(&self, p: DVec2, out: DVec2) -> Option<DVec2> {
        if !self.sparse.contains(p + BEYOND * out) {
            return None;
        }
        let to = p + self.farthest * out;
        let bead = self.crossed(p, to);
        // The sparse area ends at a wall, or at other skin of the layer. The
        // border at the line's end itself is passed already.
        let passed = BEYOND / self.farthest;
        let border = self.sparse.crossings(p, to).into_iter();
        let border = border.filter(|t| *t > passed).min_by(f64::total_cmp);
        match (bead, border) {
            // The line lies on the whole width of the bead.
            (Some(t), border) if border.is_none_or(|border| t < border) => {
                let at = p.lerp(to, t);
                let far = at + self.reach * out;
                Some(if self.holds(far) { far } else { at })
            }
            (_, Some(t)) => {
                let at = p.lerp(to, t);
                self.holds(at).then_some(at)
            }
            _ => None,
        }
    }

    /// Where a line may end that goes back from its end `p`, which nothing holds,
    /// and no farther back than `inner`; nothing if it cannot.
    fn last_hold(&self, p: DVec2, inner: DVec2) -> Option<DVec2> {
        let length = p.distance(inner);
        let out = (p - inner).normalize_or_zero();
        let cut = self.crossed(p, inner).map(|t| t * length);
        let end = cut.unwrap_or(length);
        let mut back = HOLD_STEP;
        while back < end {
            let at = p - back * out;
            if self.holds(at) {
                return Some(at);
            }
            back += HOLD_STEP;
        }
        cut.map(|cut| p - cut * out)
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
    const BIN: usize = 2;
    const BINS: usize = 180 / BIN;
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
        let angle = (angle + 0.5 * BIN as f64).rem_euclid(180.0);
        let bin = &mut bins[(angle as usize / BIN).min(BINS - 1)];
        let length = a.distance(b);
        bin.0 += length;
        bin.1 += length * (angle - 0.5 * BIN as f64);
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

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::rect;
    use isoslice_settings::testing::usual_plan;

    /// What is left of the skin of a layer with skin in some places, over infill
    /// whose lines are at these x; and how many patches of bridges the layer has.
    fn skin_left(places: &[Area], lines: &[f64]) -> (f64, usize) {
        let all = Area::from_iter([rect(-30.0, -30.0, 30.0, 30.0)]);
        let skin: Area = places.iter().cloned().collect();
        let sparse = difference(&all, &skin);
        let solid = Solid::new(all);
        let line = |x: &f64| [DVec2::new(*x, -30.0), DVec2::new(*x, 30.0)];
        let lines = EdgeGrid::of_lines(lines.iter().map(line), CELL);
        let over = Over {
            skin: &skin,
            sparse: &sparse,
            walls: &[],
            view: &LayerView::of(1, &solid, &[&solid], &[&solid]),
        };
        let under = Under {
            area: &solid,
            lines: &lines,
            shell: &[],
        };
        match bridged(over, under, &[], &usual_plan(SkinPlan::of)) {
            Some(found) => {
                assert!(found.left.is_empty());
                (found.skin.content(), found.patches.len())
            }
            None => (skin.content(), 0),
        }
    }

    /// Under a rib that stands on a face, for instance.
    #[test]
    fn lines_run_through_a_narrow_strip_between_two_bridges() {
        let places =
            [rect(-20.0, -8.0, 20.0, -0.7), rect(-20.0, 0.7, 20.0, 8.0)];
        let all = Area::from_iter([rect(-30.0, -30.0, 30.0, 30.0)]);
        let skin: Area = places.into_iter().collect();
        let sparse = difference(&all, &skin);
        let solid = Solid::new(all);
        // Infill at 45°, 3 mm apart: some lines cross it within the strip.
        let lines = (-20..20).map(|k| {
            let x = 3.0 * std::f64::consts::SQRT_2 * f64::from(k);
            [DVec2::new(x - 30.0, -30.0), DVec2::new(x + 30.0, 30.0)]
        });
        let lines = EdgeGrid::of_lines(lines, CELL);
        let over = Over {
            skin: &skin,
            sparse: &sparse,
            walls: &[],
            view: &LayerView::of(1, &solid, &[&solid], &[&solid]),
        };
        let under = Under {
            area: &solid,
            lines: &lines,
            shell: &[],
        };
        let found = bridged(over, under, &[], &usual_plan(SkinPlan::of));
        let found = found.unwrap();
        let lines: Vec<(DVec2, DVec2)> = lines_of(&found.patches)
            .iter()
            .flat_map(|line| {
                line.windows(2).map(|p| (p[0], p[1])).collect::<Vec<_>>()
            })
            .filter(|(a, b)| a.distance(*b) > 1.0)
            .collect();
        // No line ends in the strip.
        let ends = lines.iter().flat_map(|(a, b)| [a, b]);
        let inside = ends.filter(|p| p.y.abs() < 0.6 && p.x.abs() < 18.0);
        assert_eq!(inside.count(), 0);
        let through = lines.iter().filter(|(a, b)| a.y * b.y < 0.0);
        assert!(through.count() > 50);
        // At an end of the strip a line or two may find no hold.
        assert!(found.left.content() < 1.0, "{:?}", found.left);
    }

    #[test]
    fn skin_over_no_infill_stays_whatever_else_the_layer_bridges() {
        let held = rect(-20.0, -4.0, -12.0, 4.0);
        let alone = rect(12.0, -4.0, 20.0, 4.0);
        let lines = [-26.0, -24.0, -22.0, -20.0, -18.0, -16.0, -14.0, -12.0];
        let (left, patches) = skin_left(std::slice::from_ref(&held), &lines);
        assert_eq!(patches, 1);
        assert!(left < 0.01, "{left}");
        let (left, patches) = skin_left(std::slice::from_ref(&alone), &lines);
        assert_eq!((left, patches), (64.0, 0));
        let (left, patches) = skin_left(&[held, alone], &lines);
        assert_eq!(patches, 1);
        assert!((left - 64.0).abs() < 0.01, "{left}");
    }
}
