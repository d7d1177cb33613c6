//! Bodies that are inside out.
//!
//! A body whose volume is below zero is a cavity if it lies in another one.
//! If it lies in none, its inside and outside were taken for one another, and it
//! is turned, with all that lies in it: what was solid in a body that is inside
//! out is a cavity of it.

use super::Work;
use crate::edges::each_edge;
use crate::error::MeshError;
use crate::ray::Direction;
use crate::shell::Shell;
use crate::sign::outwards;
use crate::tree::Tree;
use isocontour::Bounds;
use isoslice_base::limits::go_on;
use isoslice_base::sets::Sets;

/// Places of a body from which it is seen what is around it: what is around most
/// of them. Those on a face that both share may be on either side.
const PLACES: usize = 16;
/// A body that is thinner than this share of its size has no volume that
/// roundings leave.
const THINNEST: f64 = 1e-9;
/// Triangles that all rays together may meet: some seconds. Bodies that are left
/// count as lying in no other one.
const MEETINGS: usize = 1 << 28;

/// Triangles that bound something together.
struct Body {
    triangles: Vec<u32>,
    volume: f64,
    /// Bodies around it, by number.
    around: Vec<u32>,
}

pub(super) fn turn(work: &mut Work) -> Result<(), MeshError> {
    let mut bodies = bodies(work);
    if bodies.iter().all(|body| body.volume >= 0.0) {
        return Ok(());
    }
    find_around(work, &mut bodies)?;
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by_key(|i| bodies[*i].around.len());
    let mut is_turned = vec![false; bodies.len()];
    for i in order {
        let body = &bodies[i];
        let around = || body.around.iter().map(|k| *k as usize);
        let inner = around().max_by_key(|k| bodies[*k].around.len());
        let is_inward = |k: usize| (bodies[k].volume < 0.0) != is_turned[k];
        let depth: i64 =
            around().map(|k| if is_inward(k) { -1 } else { 1 }).sum();
        let like_outer = inner.is_some_and(|k| is_turned[k]);
        let mut turned = like_outer;
        if (body.volume < 0.0) != turned && depth <= 0 {
            turned = !turned;
        }
        is_turned[i] = turned;
        if turned {
            for triangle in &body.triangles {
                work.turn(*triangle as usize);
            }
        }
    }
    Ok(())
}

/// The bodies, without what is open.
fn bodies(work: &Work) -> Vec<Body> {
    let (mut sets, is_open) = closed(work);
    let mut number = vec![u32::MAX; work.corners.len()];
    let mut bodies: Vec<Body> = Vec::new();
    let mut areas: Vec<f64> = Vec::new();
    for (i, corners) in work.corners.iter().enumerate() {
        let set = sets.of(i);
        if is_open[set] {
            continue;
        }
        if number[set] == u32::MAX {
            number[set] = bodies.len() as u32;
            areas.push(0.0);
            bodies.push(Body {
                triangles: Vec::new(),
                volume: 0.0,
                around: Vec::new(),
            });
        }
        let k = number[set] as usize;
        let body = &mut bodies[k];
        body.triangles.push(i as u32);
        let first = work.triangle(body.triangles[0] as usize)[0];
        let [a, b, c] = corners.map(|v| work.vertices[v as usize] - first);
        body.volume += a.dot(b.cross(c)) / 6.0;
        areas[k] += work.area(i);
    }
    for (body, area) in bodies.iter_mut().zip(areas) {
        if body.volume.abs() <= THINNEST * area * area.sqrt() {
            body.volume = 0.0;
        }
    }
    bodies
}

/// Sets of triangles that hang together where two meet, and, as far as that
/// leaves them open, where more do. Also returned: those that stay open, by their
/// first triangle.
fn closed(work: &Work) -> (Sets, Vec<bool>) {
    let mut sets = Sets::new(work.corners.len());
    let count = work.vertices.len();
    each_edge(&work.corners, count, |edge| {
        let mut sides = edge.sides();
        if let (2, Some(a), Some(b)) =
            (edge.count(), sides.next(), sides.next())
        {
            sets.join(a.triangle as usize, b.triangle as usize);
        }
    });
    let mut joins: Vec<(usize, usize)> = Vec::new();
    let mut open = Vec::new();
    each_edge(&work.corners, count, |edge| {
        if edge.excess().is_some() {
            open.extend(edge.sides().map(|s| s.triangle));
        }
        if edge.count() == 2 {
            return;
        }
        let mut ways: Vec<(usize, i32)> = edge
            .sides()
            .map(|s| {
                let way = if s.is_down { -1 } else { 1 };
                (sets.of(s.triangle as usize), way)
            })
            .collect();
        ways.sort_unstable();
        let unclosed: Vec<usize> = ways
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|same| same.iter().map(|s| s.1).sum::<i32>() != 0)
            .map(|same| same[0].0)
            .collect();
        joins.extend(unclosed.windows(2).map(|w| (w[0], w[1])));
    });
    for (a, b) in joins {
        sets.join(a, b);
    }
    let mut is_open = vec![false; work.corners.len()];
    for triangle in open {
        is_open[sets.of(triangle as usize)] = true;
    }
    (sets, is_open)
}

/// Finds for each body those around it.
fn find_around(work: &Work, bodies: &mut [Body]) -> Result<(), MeshError> {
    let mut of_triangle = vec![u32::MAX; work.corners.len()];
    for (k, body) in bodies.iter().enumerate() {
        for triangle in &body.triangles {
            of_triangle[*triangle as usize] = k as u32;
        }
    }
    let (tree, order) = Tree::new(&work.vertices, &work.corners);
    let shell = Shell {
        vertices: work.vertices.clone(),
        corners: order.iter().map(|i| work.corners[*i as usize]).collect(),
        tree,
    };
    let bounds = Bounds::around(shell.vertices.iter().copied());
    let mut left = MEETINGS;
    for (k, body) in bodies.iter_mut().enumerate() {
        if k % 64 == 0 {
            go_on()?;
        }
        let count = body.triangles.len();
        let places = PLACES.min(count);
        let mut around = Vec::new();
        for i in 0..places {
            let triangle = body.triangles[i * count / places] as usize;
            let [a, b, c] = work.triangle(triangle);
            let p = (a + b + c) / 3.0;
            if left == 0 {
                return Ok(());
            }
            let direction: Direction = outwards(&bounds, p);
            let mut met = Vec::new();
            shell.each_crossing(p, direction, |i, leaves| {
                left = left.saturating_sub(1);
                let other = of_triangle[order[i] as usize];
                if leaves != 0 && other != k as u32 && other != u32::MAX {
                    met.push((other, leaves));
                }
            });
            met.sort_unstable();
            for same in met.chunk_by(|a, b| a.0 == b.0) {
                if same.iter().map(|m| m.1).sum::<i64>() != 0 {
                    around.push(same[0].0);
                }
            }
        }
        around.sort_unstable();
        body.around = around
            .chunk_by(|a, b| a == b)
            .filter(|same| 2 * same.len() > places)
            .map(|same| same[0])
            .collect();
    }
    Ok(())
}
