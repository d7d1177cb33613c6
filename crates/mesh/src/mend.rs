//! Which way triangles face.
//!
//! In: triangles as a file has them. Out: the same triangles, turned so that a
//! body's outside is outside, as far as that can be known.
//!
//! Three things are mended, each only where it makes the rim shorter or a volume
//! positive:
//! - triangles with the same corners become one;
//! - triangles that face the other way than their neighbours are turned round, so
//!   that most of each surface stays as it is;
//! - shells of negative volume are turned round, but for those inside a body:
//!   they are its cavities.
//!
//! Nothing else is: holes stay holes, and shells may cross.

use crate::facts::Facts;
use crate::rim::{RimEdge, rim};
use crate::shell::Shell;
use crate::sign::outwards;
use glam::DVec3;
use isocontour::Bounds;
use isoslice_base::sets::Sets;
use rayon::prelude::*;

/// A surface counts as a shell if what is missing in it, as seen from any side,
/// is no more than this share of it.
const MISSING: f64 = 0.2;

/// Triangles of a shell that are looked at to tell whether it is a cavity: all of
/// them have to be in the body.
const LOOKS: usize = 32;

/// No triangle.
const NONE: u32 = u32::MAX;

/// Turns triangles. Returned: the shell, and its rim.
pub(crate) fn mend(
    mut shell: Shell,
    bounds: &Bounds,
    facts: &mut Facts,
) -> (Shell, Vec<RimEdge>) {
    let mut open = open_edges(&shell);
    if !open.is_empty() {
        facts.turned = face_alike(&mut shell, &mut open);
        let single = without_doubles(&shell.corners);
        if single.len() < shell.corners.len() && !open.is_empty() {
            let mut other = Shell::new(shell.vertices.clone(), single);
            let mut rim = open_edges(&other);
            let turned = face_alike(&mut other, &mut rim);
            if length(&rim) < length(&open) {
                facts.doubled = shell.corners.len() - other.corners.len();
                facts.turned += turned;
                (shell, open) = (other, rim);
            }
        }
    }
    let count = turn_shells(&mut shell, bounds);
    if count > 0 {
        facts.turned += count;
        open = open_edges(&shell);
    }
    (shell, open)
}

/// Turns triangles that face the other way than their neighbours, if that makes
/// the rim shorter. Returned: their number.
fn face_alike(shell: &mut Shell, open: &mut Vec<RimEdge>) -> usize {
    let turned = against_neighbours(shell);
    let count = turned.iter().filter(|t| **t).count();
    if count == 0 {
        return 0;
    }
    turn(shell, |i| turned[i]);
    let rim = open_edges(shell);
    if length(&rim) >= length(open) {
        turn(shell, |i| turned[i]);
        return 0;
    }
    *open = rim;
    count
}

fn open_edges(shell: &Shell) -> Vec<RimEdge> {
    rim(&shell.corners, shell.vertices.len())
}

fn length(rim: &[RimEdge]) -> u64 {
    rim.iter().map(|e| u64::from(e.times)).sum()
}

fn turn(shell: &mut Shell, which: impl Fn(usize) -> bool) {
    for (i, corners) in shell.corners.iter_mut().enumerate() {
        if which(i) {
            corners.swap(1, 2);
        }
    }
}

/// The first of all triangles that have the same corners.
fn without_doubles(corners: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut sorted: Vec<([u32; 3], u32)> = corners
        .iter()
        .zip(0..)
        .map(|(corners, i)| {
            let mut corners = *corners;
            corners.sort_unstable();
            (corners, i)
        })
        .collect();
    sorted.par_sort_unstable();
    sorted.dedup_by_key(|(corners, _)| *corners);
    let mut kept: Vec<u32> = sorted.into_iter().map(|(_, i)| i).collect();
    kept.sort_unstable();
    kept.into_iter().map(|i| corners[i as usize]).collect()
}

/// For each triangle whether it is to be turned round to face the same way as
/// its neighbours.
fn against_neighbours(shell: &Shell) -> Vec<bool> {
    let neighbours = neighbours(&shell.corners);
    let count = shell.corners.len();
    let mut turned = vec![false; count];
    let mut seen = vec![false; count];
    let mut surface = Vec::new();
    for first in 0..count {
        if seen[first] {
            continue;
        }
        surface.clear();
        surface.push(first as u32);
        seen[first] = true;
        // Of what stays and of what is turned.
        let mut areas = [0.0; 2];
        let mut next = 0;
        while let Some(&i) = surface.get(next) {
            next += 1;
            let i = i as usize;
            areas[usize::from(turned[i])] += shell.normal(i).length();
            for link in neighbours[i] {
                let (other, faces_away) = ((link >> 1) as usize, link & 1 == 1);
                if link != NONE && !seen[other] {
                    seen[other] = true;
                    turned[other] = turned[i] != faces_away;
                    surface.push(other as u32);
                }
            }
        }
        if areas[1] > areas[0] {
            for &i in &surface {
                turned[i as usize] ^= true;
            }
        }
    }
    turned
}

/// The neighbours of each triangle at edges that two triangles share: their
/// numbers, doubled, and one more if they face the other way.
fn neighbours(corners: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(3 * corners.len());
    for (corners, i) in corners.iter().zip(0u32..) {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let key = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
            edges.push((key, 2 * i + u32::from(a > b)));
        }
    }
    edges.par_sort_unstable();
    let mut neighbours = vec![[NONE; 3]; corners.len()];
    let mut add = |to: u32, link: u32| {
        let links = &mut neighbours[to as usize];
        if let Some(free) = links.iter_mut().find(|l| **l == NONE) {
            *free = link;
        }
    };
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, a), (_, b)] = same {
            let faces_away = u32::from(a & 1 == b & 1);
            add(a >> 1, b & !1 | faces_away);
            add(b >> 1, a & !1 | faces_away);
        }
    }
    neighbours
}

/// Triangles that hang together.
#[derive(Clone, Copy, Debug, Default)]
struct Surface {
    triangles: usize,
    /// Twice the area.
    area: f64,
    /// The sum of the areas as vectors, twice.
    facing: DVec3,
    middle: DVec3,
    /// Six times the volume.
    volume: f64,
}

impl Surface {
    /// True if it bounds a body, as far as it can be seen.
    fn is_shell(&self) -> bool {
        self.facing.length() <= MISSING * self.area
    }
}

/// Turns shells of negative volume. Returned: the number of triangles turned.
fn turn_shells(shell: &mut Shell, bounds: &Bounds) -> usize {
    let (numbers, mut surfaces) = surfaces(shell);
    let shells: Vec<Surface> =
        surfaces.iter().copied().filter(Surface::is_shell).collect();
    let whole: f64 = if shells.is_empty() {
        whole_volume(shell)
    } else {
        shells.iter().map(|s| s.volume).sum()
    };
    let is_inside_out = whole < 0.0;
    if is_inside_out {
        turn(shell, |_| true);
        surfaces.iter_mut().for_each(|s| s.volume = -s.volume);
    }
    if surfaces.iter().all(|s| s.volume >= 0.0) {
        return if is_inside_out {
            shell.corners.len()
        } else {
            0
        };
    }
    let members = members(&numbers, surfaces.len());
    let mut order: Vec<usize> = (0..surfaces.len()).collect();
    order.sort_by(|a, b| {
        let size = |i: usize| surfaces[i].volume.abs();
        size(*b).total_cmp(&size(*a)).then(a.cmp(b))
    });
    let mut ranks = vec![0; surfaces.len()];
    for (rank, i) in order.iter().enumerate() {
        ranks[*i] = rank;
    }
    let mut count = 0;
    for &i in &order {
        if surfaces[i].volume >= 0.0 || !surfaces[i].is_shell() {
            continue;
        }
        // The larger ones have been turned, and may have it as a cavity.
        let is_outside = |triangle: u32| {
            let [a, b, c] = shell.triangle(triangle as usize);
            let p = (a + b + c) / 3.0;
            let larger = |t: usize| ranks[numbers[t] as usize] < ranks[i];
            shell.crossings(p, outwards(bounds, p), larger) < 1
        };
        let all = &members[i];
        let mut some = all.iter().step_by(all.len().div_ceil(LOOKS));
        if some.any(|t| is_outside(*t)) {
            count += all.len();
            for &t in all {
                shell.corners[t as usize].swap(1, 2);
            }
        }
    }
    if is_inside_out {
        shell.corners.len() - count
    } else {
        count
    }
}

/// The triangles of each surface.
fn members(numbers: &[u32], count: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); count];
    for (number, i) in numbers.iter().zip(0u32..) {
        members[*number as usize].push(i);
    }
    members
}

/// Six times the volume of triangles, or 0 if they bound none.
fn whole_volume(shell: &Shell) -> f64 {
    let all = vec![0; shell.corners.len()];
    let surface = measured(shell, &all, 1)[0];
    if surface.is_shell() {
        surface.volume
    } else {
        0.0
    }
}

/// The surfaces, and the number of the one that each triangle belongs to.
fn surfaces(shell: &Shell) -> (Vec<u32>, Vec<Surface>) {
    let mut sets = Sets::new(shell.vertices.len());
    for &[a, b, c] in &shell.corners {
        sets.join(a as usize, b as usize);
        sets.join(b as usize, c as usize);
    }
    let mut numbers = vec![NONE; shell.vertices.len()];
    let mut count = 0;
    let of: Vec<u32> = shell
        .corners
        .iter()
        .map(|corners| {
            let number = &mut numbers[sets.of(corners[0] as usize)];
            if *number == NONE {
                *number = count;
                count += 1;
            }
            *number
        })
        .collect();
    let surfaces = measured(shell, &of, count as usize);
    (of, surfaces)
}

fn measured(shell: &Shell, of: &[u32], count: usize) -> Vec<Surface> {
    let mut surfaces = vec![Surface::default(); count];
    for (i, number) in of.iter().enumerate() {
        let surface = &mut surfaces[*number as usize];
        let [a, b, c] = shell.triangle(i);
        let normal = (b - a).cross(c - a);
        surface.triangles += 1;
        surface.area += normal.length();
        surface.facing += normal;
        surface.middle += (a + b + c) * (normal.length() / 3.0);
    }
    for surface in &mut surfaces {
        surface.middle /= surface.area.max(f64::MIN_POSITIVE);
    }
    for (i, number) in of.iter().enumerate() {
        let surface = &mut surfaces[*number as usize];
        let [a, b, c] = shell.triangle(i).map(|v| v - surface.middle);
        surface.volume += a.dot(b.cross(c));
    }
    surfaces
}
