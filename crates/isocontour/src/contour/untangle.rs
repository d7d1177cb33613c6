//! Makes sure that a layer's thinned rings do not cross.
//!
//! Straight lines between vertices on the lattice's edges cannot cross. Lines
//! through the points that were put between the vertices can cross. So can
//! thinned lines, where outlines are closer to each other than the tolerance.
//! Lines that cross are taken back step by step. First they are not thinned at
//! all. If they still cross, the rings are cut at the crossings (`cut`), which
//! keeps tips in their places. What is left leads from lattice vertex to
//! lattice vertex. If that does not help, or has to be done in many places, the
//! whole ring is thinned less, then hardly at all, and last reduced to the
//! lattice's vertices.

use super::buckets::each_pair;
use super::cut;
use super::link::Joined;
use super::trace::cross;
use crate::Length;
use crate::cancel::{Cancel, Cancelled};
use crate::plane::nearest_on;
use crate::plane::simplify::{simplify, simplify_but};
use crate::plane::{Ring, edges};
use glam::DVec2;

/// How carefully a ring is thinned, and where.
#[derive(Default)]
struct Care {
    /// The ring's edges that crossed others, and how often they did.
    knots: Vec<Knot>,
    /// Number of steps back of the whole ring.
    whole: u8,
}

/// An edge that crossed another, and the points for which it stood.
struct Knot {
    edge: (DVec2, DVec2),
    /// Greatest distance of those points from the edge.
    reach: Length,
    step: u8,
}

/// Greatest number of a ring's knots. With more, the whole ring is taken back.
const KNOTS: usize = 64;
/// Greatest number of steps back of a knot, and of a whole ring.
const KNOT_STEPS: u8 = 2;
const WHOLE_STEPS: u8 = 3;

impl Knot {
    fn holds(&self, p: DVec2) -> bool {
        let (a, b) = self.edge;
        let off = nearest_on(p, a, b).distance_squared(p);
        off <= self.reach * self.reach
    }
}

impl Care {
    /// Takes a ring that is thinned within a tolerance a step back where some
    /// of its edges cross others. False if it was at the last step.
    fn more(
        &mut self,
        edges: impl ExactSizeIterator<Item = (DVec2, DVec2)>,
        tolerance: Length,
    ) -> bool {
        let before = self.knots.len();
        if self.whole == 0 && before + edges.len() <= KNOTS {
            for edge in edges {
                // An edge that is already a knot was not thinned, and crosses
                // all the same.
                let same = |k: &&Knot| k.holds(edge.0) && k.holds(edge.1);
                let old = self.knots[..before].iter().filter(same);
                self.knots.push(Knot {
                    edge,
                    reach: 1.5 * tolerance,
                    step: 1 + old.map(|k| k.step).max().unwrap_or(0),
                });
            }
            if self.knots.iter().all(|k| k.step <= KNOT_STEPS) {
                return true;
            }
        }
        let goes_on = self.whole < WHOLE_STEPS;
        self.whole = WHOLE_STEPS.min(self.whole + 1);
        goes_on
    }

    /// True if there are crossings whose cause may be other than thinning.
    fn tangled(&self) -> bool {
        self.whole > 0 || self.knots.iter().any(|k| k.step > 1)
    }

    /// The ring, thinned with this care.
    fn thin(&self, ring: &Joined, tolerance: Length) -> Ring {
        if self.whole > 0 {
            return back(ring, tolerance, self.whole);
        }
        let step = |p: DVec2| {
            let here = self.knots.iter().filter(|k| k.holds(p));
            here.map(|k| k.step).max().unwrap_or(0)
        };
        let all = ring.points.iter().zip(&ring.fixed);
        let kept = all.filter(|p| *p.1 || step(*p.0) < KNOT_STEPS);
        let points: Ring = kept.map(|p| *p.0).collect();
        simplify_but(&points, tolerance, |p| step(p) > 0)
    }
}

/// The rings, thinned within a tolerance; empty where nothing is left.
///
/// # Errors
/// If `cancel` asks to stop.
pub(super) fn thin(
    mut rings: Vec<Joined>,
    tolerance: Length,
    cancel: &Cancel,
) -> Result<Vec<Ring>, Cancelled> {
    let plain = |r: &Joined| simplify(&r.points, tolerance);
    let mut out: Vec<Ring> = rings.iter().map(plain).collect();
    let mut cares: Vec<Care> = Vec::new();
    let mut was_cut = false;
    loop {
        cancel.check()?;
        let found = crossings(&out);
        if found.is_empty() {
            return Ok(out);
        }
        cares.resize_with(rings.len(), Care::default);
        let mut worse = false;
        let mut tangled = vec![false; rings.len()];
        let mut cut_now = false;
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let n = same[0].0;
            tangled[n] = true;
            if cares[n].more(same.iter().map(|k| k.1), tolerance) {
                worse = true;
                cut_now |= !was_cut && cares[n].tangled();
            }
        }
        if cut_now {
            was_cut = true;
            if let Some(cut) = cut::at_crossings(&rings, &tangled) {
                leave_out(&mut out, &tangled);
                leave_out(&mut cares, &tangled);
                leave_out(&mut rings, &tangled);
                out.extend(cut.iter().map(plain));
                rings.extend(cut);
                continue;
            }
        }
        if !worse {
            return Ok(out);
        }
        for n in (0..rings.len()).filter(|&n| tangled[n]) {
            out[n] = cares[n].thin(&rings[n], tolerance);
        }
    }
}

/// Takes the things out of a list that are marked.
fn leave_out<T>(list: &mut Vec<T>, marked: &[bool]) {
    let mut marks = marked.iter();
    list.retain(|_| marks.next() == Some(&false));
}

fn back(ring: &Joined, tolerance: Length, step: u8) -> Ring {
    match step {
        1 => simplify(&ring.points, 0.1 * tolerance),
        2 => simplify(&ring.points, 1e-3 * tolerance),
        _ => {
            let fixed = ring.points.iter().zip(&ring.fixed);
            let points: Ring = fixed.filter(|p| *p.1).map(|p| *p.0).collect();
            simplify(&points, 1e-3 * tolerance)
        }
    }
}

/// Edges that cross or touch others, with the numbers of their rings, ring by
/// ring.
fn crossings(rings: &[Ring]) -> Vec<(usize, (DVec2, DVec2))> {
    struct Edge {
        ring: usize,
        a: DVec2,
        b: DVec2,
        /// The edge's number within the ring, and the ring's number of edges.
        place: usize,
        count: usize,
    }
    let list: Vec<Edge> = rings
        .iter()
        .enumerate()
        .flat_map(|(ring, r)| {
            edges(r).enumerate().map(move |(place, (a, b))| Edge {
                ring,
                a,
                b,
                place,
                count: r.len(),
            })
        })
        .collect();
    let mut found: Vec<u32> = Vec::new();
    each_pair(list.iter().map(|e| (e.a, e.b)), |m, n| {
        let [e, f] = [m, n].map(|k| &list[k as usize]);
        let apart = f.a.min(f.b).cmpgt(e.a.max(e.b)).any()
            || f.a.max(f.b).cmplt(e.a.min(e.b)).any();
        if apart {
            return;
        }
        let meet = if e.ring == f.ring && e.place + 1 == f.place {
            folds(e.a, e.b, f.b)
        } else if e.ring == f.ring && e.place == 0 && f.place + 1 == f.count {
            folds(f.a, f.b, e.b)
        } else {
            cross(e.a, e.b, f.a, f.b)
        };
        if meet {
            found.extend([m, n]);
        }
    });
    found.sort_unstable();
    found.dedup();
    let edge = |n: u32| {
        let e = &list[n as usize];
        (e.ring, (e.a, e.b))
    };
    found.into_iter().map(edge).collect()
}

/// True if the way from a to b goes straight back to c.
fn folds(a: DVec2, b: DVec2, c: DVec2) -> bool {
    (b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::super::buckets::buckets;
    use super::*;

    /// Numbers of the rings that cross each other or themselves, in order.
    fn crossing(rings: &[Ring]) -> Vec<usize> {
        let mut found: Vec<usize> =
            crossings(rings).iter().map(|c| c.0).collect();
        found.dedup();
        found
    }

    fn ring(points: &[(f64, f64)]) -> Ring {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    #[test]
    fn crossings_are_found_and_nothing_else() {
        let square = ring(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
        let inner = ring(&[(1.0, 1.0), (1.0, 3.0), (3.0, 3.0), (3.0, 1.0)]);
        let other = ring(&[(3.5, 1.0), (5.0, 1.0), (5.0, 2.0)]);
        let bow = ring(&[(9.0, 0.0), (10.0, 1.0), (10.0, 0.0), (9.0, 1.0)]);
        let fold = ring(&[(20.0, 0.0), (22.0, 0.0), (21.0, 0.0), (21.0, 9.0)]);
        assert!(crossing(&[square.clone(), inner.clone()]).is_empty());
        let all = [inner, square, bow, other, fold];
        assert_eq!(crossing(&all), vec![1, 2, 3, 4]);
        assert!(crossing(&[]).is_empty());
    }

    /// Long slanting lines are in few squares, and meet the lines that cross
    /// them.
    #[test]
    fn long_edges_are_where_they_pass() {
        let teeth = |from: DVec2, along: DVec2| -> Ring {
            let out = (0..400).map(|k| {
                let side = if k % 2 == 0 { 0.0 } else { 0.2 };
                from + along * f64::from(k) * 0.1 + along.perp() * side
            });
            let back = from - along.perp();
            out.chain([back + along * 39.9, back]).collect()
        };
        let fin = |from: DVec2, along: DVec2| -> Ring {
            let wide = along.perp() * 0.01;
            vec![from, from + along, from + along + wide, from + wide]
        };
        for angle in [0.0_f64, 0.3, 0.8, 1.57, 2.2, 3.1, 4.0, 5.9] {
            let way = DVec2::from_angle(angle);
            let mut rings = vec![teeth(DVec2::ZERO, way)];
            // These lines are beside the long one.
            for k in 2..40 {
                let aside = way.perp() * f64::from(k);
                rings.push(fin(aside, way * 40.0));
            }
            let list: Vec<(DVec2, DVec2)> =
                rings.iter().flat_map(|r| edges(r)).collect();
            let grid = buckets(list.iter().copied());
            let held: usize = (0..grid.count()).map(|k| grid.at(k).len()).sum();
            assert!(held < 20 * list.len(), "{angle}: {held}");
            assert!(crossing(&rings).is_empty(), "{angle}");
            // This line crosses all of the others, but not the teeth.
            let start = way.perp() * 1.5 + way * 20.0;
            rings.push(fin(start, way.perp() * 100.0 + way * 0.3));
            let all: Vec<usize> = (1..rings.len()).collect();
            assert_eq!(crossing(&rings), all, "{angle}");
        }
    }

    /// A plate has a fin of a micrometre. Thinned, the fin's sides cross, but
    /// the rounded end far away from it is not concerned.
    #[test]
    fn rings_are_thinned_less_only_where_they_cross() {
        let mut points: Ring = (0..=400)
            .map(|k| std::f64::consts::PI * (f64::from(k) / 400.0 - 0.5))
            .map(|t| DVec2::new(10.0, 5.0) + DVec2::from_angle(t) * 5.0)
            .collect();
        points.push(DVec2::new(8.0, 10.0));
        // The fin's sides wave, and are cut into lines at different places.
        let side = |y: f64| 5.0 + 0.03 * (4.0 * y).sin();
        let up = (0..=200).map(|k| 10.0 + f64::from(k) * 0.02);
        let down = (0..173).rev().map(|k| 10.0 + f64::from(k) * 0.0231);
        points.extend(up.map(|y| DVec2::new(side(y) + 1e-3, y)));
        points.extend(down.map(|y| DVec2::new(side(y), y)));
        points.extend([DVec2::new(0.0, 10.0), DVec2::new(0.0, 0.0)]);
        // Every eighth point is on the lattice.
        let fixed = (0..points.len()).map(|k| k % 8 == 0).collect();
        let joined = Joined { points, fixed };
        assert!(!crossing(&[simplify(&joined.points, 0.01)]).is_empty());
        let thinned = thin(vec![joined], 0.01, &Cancel::NEVER).unwrap();
        assert!(crossing(&thinned).is_empty());
        let round = thinned[0].iter().filter(|p| p.x > 10.01);
        // The coarsest polygon within the tolerance has 17 points there.
        assert!((15..60).contains(&round.clone().count()));
        for p in round {
            let off = p.distance(DVec2::new(10.0, 5.0)) - 5.0;
            assert!(off.abs() < 0.0101, "{p}: {off}");
        }
    }

    /// Two long arcs are three micrometres apart. Thinned to ten, they would
    /// cross each other.
    #[test]
    fn close_rings_are_thinned_less() {
        let arc = |r: f64, n: usize| Joined {
            points: (0..n)
                .map(|k| {
                    let t = std::f64::consts::TAU * k as f64 / n as f64;
                    DVec2::from_angle(t) * r
                })
                .collect(),
            fixed: vec![true; n],
        };
        let rings = vec![arc(10.0, 2000), arc(9.997, 1733)];
        let thinned = thin(rings, 0.01, &Cancel::NEVER).unwrap();
        assert!(crossing(&thinned).is_empty());
        assert!(thinned.iter().all(|r| r.len() > 50));
    }
}
