//! Short ways between strokes that nobody sees, printed instead of hopped.
//!
//! ```text
//!   ════════╗      The end of a stroke and the beginning of the next one are
//!           ║      a hop apart. Both are shortened, and a narrow way leads from
//!   ════════╝      one to the other: strokes and way lay what the strokes did.
//! ```
//!
//! In: a layer's beads in print order. Out: these beads, of which some go on in
//! the next one. What shows keeps its ends: outer walls and tops, and bridges,
//! whose lines have to hang straight. A way stays off the outer walls: it comes
//! no nearer to the outline than a wall beside them or than its ends do.

use super::jobs;
use crate::bead::{Bead, Role, Stroke, narrowest, spacing};
use crate::plane::grid::EdgeGrid;
use crate::settings::Settings;
use crate::units::Mm;
use glam::DVec2;

/// Longest way from a stroke to the next, in widths.
const REACH: f64 = 3.4;
/// How far a way may lead back along a stroke, in widths: it lies on what has
/// just been printed, or soon will be.
const BACK: f64 = 2.5;
/// Share of a stroke that may be taken from one of its ends.
const SHARE: f64 = 0.4;
/// Share of what a way between walls lays that has to be taken from the walls,
/// which fill their places.
const WALLS: f64 = 0.99;
/// Share of what a way between a skin's strokes lays that has to be taken from
/// the strokes, which leave corners open.
const SKINS: f64 = 0.5;
/// Slack in distances from the outline, mm.
const SLACK: Mm = 0.03;
/// Number of rounds in which the lengths are found. They depend on each other.
const ROUNDS: usize = 6;

/// Lets beads go on in the next one where a short way leads there. `solid` is
/// the layer's outline.
pub(crate) fn linked(
    beads: Vec<Bead>,
    solid: &EdgeGrid,
    settings: &Settings,
) -> Vec<Bead> {
    let outer = settings.outer_wall_width();
    let mut out: Vec<Bead> = Vec::with_capacity(beads.len());
    for mut bead in beads {
        crate::limits::check();
        if let Some(before) = out.last_mut()
            && hidden(before.role, settings)
            && hidden(bead.role, settings)
            && !(before.sunk || bead.sunk)
            && let Some(link) = Link::between(before, &bead)
            && link.is_free(solid, outer)
        {
            before.stroke = shortened(before, true, link.taken[0]);
            bead.stroke = shortened(&bead, false, link.taken[1]);
            let way = link.bead(before, &bead);
            out.extend(way);
        }
        out.push(bead);
    }
    out
}

/// A way from the end of one bead to the beginning of the next, once both have
/// been shortened.
struct Link {
    from: DVec2,
    to: DVec2,
    /// Width of the way between the two beads.
    width: Mm,
    /// Lengths that are taken from the end of the first bead and from the
    /// beginning of the second one.
    taken: [Mm; 2],
}

impl Link {
    /// The way between two beads, if it is short, and if they are long enough
    /// to make up for what it lays.
    fn between(before: &Bead, after: &Bead) -> Option<Link> {
        let (a, b) = (jobs::end(before)?, *after.points.first()?);
        let last = if before.closed {
            0
        } else {
            before.points.len() - 1
        };
        let mean = 0.5 * (before.width_at(last) + after.width_at(0));
        let mut way = a.distance(b);
        // Strokes may end in a point.
        let wide = mean.max(0.5 * (before.width + after.width));
        let short = way > 0.0 && way <= REACH * wide;
        if !short || back([before, after], [a, b])? > BACK * wide {
            return None;
        }
        let own = spacing(mean, mean, after.height);
        let share = narrowest(after.height).min(own);
        let most = [before, after].map(|bead| SHARE * bead.length());
        let (mut from, mut to) = (a, b);
        let mut taken = [0.0; 2];
        let mut all = 0.0;
        for _ in 0..ROUNDS {
            all = way * share / own;
            let half = most[0].min(0.5 * all);
            taken[1] = most[1].min(all - half);
            taken[0] = most[0].min(all - taken[1]);
            from = before.place(true, taken[0])?;
            to = after.place(false, taken[1])?;
            way = from.distance(to);
        }
        let enough = match before.role {
            Role::InnerWall | Role::GapFill => WALLS,
            _ => SKINS,
        };
        (taken[0] + taken[1] >= enough * all).then_some(Link {
            from,
            to,
            width: mean - (own - share),
            taken,
        })
    }

    /// True if the way stays off the outer walls.
    fn is_free(&self, solid: &EdgeGrid, outer: Mm) -> bool {
        let inside = outer + 0.5 * self.width;
        let depth = |p: DVec2| {
            let near = solid.nearest_edge(p, inside);
            near.map_or(inside, |(_, q)| p.distance(q))
        };
        let least = depth(self.from).min(depth(self.to)) - SLACK;
        let mut free = true;
        solid.visit_edges_near(self.from, self.to, least, |_| free = false);
        free
    }

    /// The way as a bead between two that have been shortened. Between walls
    /// the way is no wall.
    fn bead(&self, before: &Bead, after: &Bead) -> Option<Bead> {
        let ends = vec![*before.points.last()?, *after.points.first()?];
        let role = match before.role {
            Role::InnerWall => Role::GapFill,
            role => role,
        };
        let stroke = Stroke::new(ends, false, self.width);
        Some(Bead::new(role, stroke, after.height))
    }
}

/// Length by which the way from the end of one bead to the beginning of another
/// leads back along either of them.
fn back([before, after]: [&Bead; 2], [from, to]: [DVec2; 2]) -> Option<Mm> {
    let ahead = |bead: &Bead, last: bool, end: DVec2| {
        let far = bead.width.min(SHARE * bead.length());
        Some((end - bead.place(last, far)?).normalize_or_zero())
    };
    let way = to - from;
    let (out, into) = (ahead(before, true, from)?, ahead(after, false, to)?);
    Some(way.dot(into).max(-way.dot(out)))
}

/// True if nobody sees where a bead of this role ends. In a gap that is asked
/// for between skin and its ring there is no way either.
fn hidden(role: Role, settings: &Settings) -> bool {
    match role {
        Role::InnerWall | Role::GapFill => true,
        Role::InternalSkin | Role::BottomSkin => settings.skin_ring_gap <= 0.0,
        _ => false,
    }
}

/// A bead's stroke, open, without a length of its end or its beginning.
fn shortened(bead: &Bead, last: bool, length: Mm) -> Stroke {
    let open = bead.opened();
    open.shortened(last, length / open.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::{Area, rect};

    const WIDTH: f64 = 0.45;
    const HEIGHT: f64 = 0.2;

    fn line(role: Role, at: &[(f64, f64)]) -> Bead {
        let points = at.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        Bead::new(role, Stroke::new(points, false, WIDTH), HEIGHT)
    }

    fn ring(half: f64) -> Bead {
        let points = rect(-half, -half, half, half).rings.remove(0);
        let role = Role::InternalSkin;
        Bead::new(role, Stroke::new(points, true, WIDTH), HEIGHT)
    }

    fn far_away() -> EdgeGrid {
        EdgeGrid::new(&rect(-50.0, -50.0, 50.0, 50.0), 1.0)
    }

    fn linked_in(solid: &EdgeGrid, beads: &[Bead]) -> Vec<Bead> {
        linked(beads.to_vec(), solid, &Settings::default())
    }

    fn linked_inside(beads: &[Bead]) -> Vec<Bead> {
        linked_in(&far_away(), beads)
    }

    /// The plane that beads fill, mm².
    fn laid(beads: &[Bead]) -> f64 {
        let space = |w: f64| spacing(w, w, HEIGHT);
        let of = |b: &Bead| -> f64 {
            let each = b.segments().enumerate();
            each.map(|(i, (p, q))| {
                let w = 0.5 * (b.width_at(i) + b.width_at(i + 1));
                p.distance(q) * space(w)
            })
            .sum()
        };
        beads.iter().map(of).sum()
    }

    /// How many strokes there are: beads that begin where no other ends.
    fn strokes(beads: &[Bead]) -> usize {
        let meet = |pair: &&[Bead]| {
            !pair[0].closed && pair[0].points.last() == pair[1].points.first()
        };
        beads.len() - beads.windows(2).filter(meet).count()
    }

    fn apart() -> f64 {
        spacing(WIDTH, WIDTH, HEIGHT)
    }

    #[test]
    fn strokes_beside_each_other_become_one_and_lay_what_they_did() {
        let role = Role::InternalSkin;
        let y = apart();
        let there = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
        // Even, uneven either way, at an angle, in line.
        let next: [&[(f64, f64)]; 5] = [
            &[(5.0, y), (0.0, y)],
            &[(4.6, y), (0.0, y)],
            &[(5.4, y), (0.0, y)],
            &[(5.0, y), (5.0, 4.0)],
            &[(5.5, 0.0), (9.0, 0.0)],
        ];
        for next in next {
            let both = [there.clone(), line(role, next)];
            let found = linked_inside(&both);
            assert_eq!(strokes(&found), 1, "{next:?}");
            let share = laid(&found) / laid(&both);
            assert!((share - 1.0).abs() < 2e-3, "{next:?}: {share}");
            assert_eq!(found[0].points.first(), both[0].points.first());
            assert_eq!(found[2].points.last(), both[1].points.last());
            // The way is as narrow as it can be: as wide as high.
            assert!((found[1].width - HEIGHT).abs() < 1e-9, "{next:?}");
            assert!(found.iter().all(|b| b.role == role));
        }
    }

    #[test]
    fn rings_inside_one_another_become_a_spiral() {
        let rings = [0, 1, 2, 3].map(|k| ring(4.0 - apart() * f64::from(k)));
        let found = linked_inside(&rings);
        assert_eq!(strokes(&found), 1);
        let share = laid(&found) / laid(&rings);
        assert!((share - 1.0).abs() < 1e-3, "{share}");
    }

    #[test]
    fn what_shows_keeps_its_ends_and_long_ways_are_travels() {
        let pair = |a: Role, b: Role, gap: f64| {
            let (a, b) = (
                line(a, &[(0.0, 0.0), (5.0, 0.0)]),
                line(b, &[(5.0, gap), (0.0, gap)]),
            );
            let both = [a, b];
            let found = linked_inside(&both);
            found != both
        };
        let inner = Role::InnerWall;
        assert!(pair(inner, inner, 0.4));
        assert!(pair(Role::InternalSkin, Role::BottomSkin, 1.4));
        assert!(!pair(inner, inner, 1.6));
        let shows = [
            Role::OuterWall,
            Role::Overhang,
            Role::TopSkin,
            Role::Bridge,
            Role::Ironing,
            Role::Skirt,
        ];
        for role in shows {
            assert!(!pair(role, role, 0.4), "{role:?}");
            assert!(!pair(inner, role, 0.4), "{role:?}");
            assert!(!pair(role, inner, 0.4), "{role:?}");
        }
    }

    #[test]
    fn no_way_leads_far_back_along_a_stroke_or_takes_most_of_one() {
        let role = Role::InternalSkin;
        let there = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
        let count = |next: &[(f64, f64)]| {
            strokes(&linked_inside(&[there.clone(), line(role, next)]))
        };
        assert_eq!(count(&[(4.0, 0.4), (0.0, 0.4)]), 1);
        assert_eq!(count(&[(3.7, 0.4), (0.0, 0.4)]), 2);
        assert_eq!(count(&[(5.0, 0.4), (5.1, 0.4)]), 1);
        // Two short ones have nothing to make up for the way; walls have to
        // make up for all of it.
        let crumbs = |role, length: f64| {
            let crumb = |y| line(role, &[(5.0, y), (5.0 + length, y)]);
            let mut crumbs = [crumb(0.0), crumb(0.4)];
            crumbs[0].reverse();
            strokes(&linked_inside(&crumbs))
        };
        assert_eq!(crumbs(role, 0.08), 2);
        assert_eq!(crumbs(role, 0.12), 1);
        assert_eq!(crumbs(Role::InnerWall, 0.12), 2);
        assert_eq!(crumbs(Role::InnerWall, 0.25), 1);
    }

    #[test]
    fn a_way_between_walls_is_no_wall() {
        let role = Role::InnerWall;
        let walls = [
            line(role, &[(0.0, 0.0), (5.0, 0.0)]),
            line(role, &[(5.0, 1.0), (0.0, 1.0)]),
        ];
        let found = linked_inside(&walls);
        let roles: Vec<Role> = found.iter().map(|b| b.role).collect();
        assert_eq!(roles, [role, Role::GapFill, role]);
        assert_eq!(strokes(&found), 1);
        let share = laid(&found) / laid(&walls);
        assert!((share - 1.0).abs() < 2e-3, "{share}");
    }

    #[test]
    fn ways_stay_off_the_outer_walls() {
        // Two arms of a solid, and a notch between them.
        let notched = |notch: f64| {
            let ring = [
                (0.0, -3.0),
                (9.0, -3.0),
                (9.0, -0.5 * notch),
                (4.0, -0.5 * notch),
                (4.0, 0.5 * notch),
                (9.0, 0.5 * notch),
                (9.0, 3.0),
                (0.0, 3.0),
            ];
            let ring = ring.map(|(x, y)| DVec2::new(x, y)).to_vec();
            EdgeGrid::new(&Area::from(ring), 1.0)
        };
        let role = Role::InnerWall;
        let walls = [
            line(role, &[(1.0, -0.7), (8.0, -0.7)]),
            line(role, &[(8.0, 0.7), (1.0, 0.7)]),
        ];
        assert_eq!(linked_in(&notched(0.04), &walls), walls);
        assert!(linked_inside(&walls) != walls);
        // At the arms' foot there is solid between them, but not enough.
        let foot = |x: f64| {
            let at = |y: f64| line(role, &[(1.0, y), (x, y)]);
            let mut walls = [at(-0.7), at(0.7)];
            walls[1].reverse();
            linked_in(&notched(0.04), &walls) != walls
        };
        assert!(foot(3.2));
        assert!(!foot(3.9));
    }

    #[test]
    fn beads_without_length_stay_as_they_are() {
        let role = Role::GapFill;
        let odd = [
            line(role, &[]),
            line(role, &[(1.0, 1.0)]),
            line(role, &[(1.0, 1.0), (1.0, 1.0)]),
            line(role, &[(1.0, 1.0), (1.0, 1.3)]),
        ];
        assert_eq!(linked_inside(&odd), odd);
    }
}
