//! What must hold of any outline, judged by the function itself.

use glam::DVec2;
use isocontour::plane::{Area, edges, ring_contains, signed_area};
use std::f64::consts::TAU;

/// Everything wrong with an outline's rings as such.
pub fn topology(area: &Area) -> Result<(), String> {
    for (n, ring) in area.rings.iter().enumerate() {
        if ring.len() < 3 {
            return Err(format!("ring {n} has {} points", ring.len()));
        }
        if let Some(p) = ring.iter().find(|p| !p.is_finite()) {
            return Err(format!("ring {n} has the point {p}"));
        }
        for k in 0..ring.len() {
            let [a, b, c] = [0, 1, 2].map(|d| ring[(k + d) % ring.len()]);
            if a == b {
                return Err(format!("ring {n} has {a} twice"));
            }
            let off = (b - a).perp_dot(c - b).abs() / (c - a).length();
            if off < 1e-9 {
                return Err(format!("ring {n} goes on straight at {b}"));
            }
        }
        let depth = area
            .rings
            .iter()
            .enumerate()
            .filter(|&(m, r)| m != n && ring_contains(r, ring[0]))
            .count();
        if (signed_area(ring) > 0.0) != (depth % 2 == 0) {
            return Err(format!("ring {n} runs the wrong way"));
        }
    }
    let all: Vec<(usize, usize, DVec2, DVec2)> = area
        .rings
        .iter()
        .enumerate()
        .flat_map(|(n, r)| {
            edges(r).enumerate().map(move |(k, (a, b))| (n, k, a, b))
        })
        .collect();
    for (i, &(n, k, a, b)) in all.iter().enumerate() {
        for &(m, l, c, d) in &all[i + 1..] {
            let count = area.rings[n].len();
            let next = n == m && (l == k + 1 || (k == 0 && l + 1 == count));
            if !next && meet(a, b, c, d) {
                return Err(format!("{a} to {b} crosses {c} to {d}"));
            }
        }
    }
    Ok(())
}

fn meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) > 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// True if points within `radius` of one are not all on the same side.
pub fn border_within(
    p: DVec2,
    radius: f64,
    inside: &impl Fn(DVec2) -> bool,
) -> bool {
    let own = inside(p);
    [1.0, 0.5].into_iter().any(|share| {
        (0..32).any(|k| {
            let way = DVec2::from_angle(TAU * f64::from(k) / 32.0);
            inside(p + way * (share * radius)) != own
        })
    })
}

/// True if the part on whose side a point lies is no wider than `width` there.
fn narrow(p: DVec2, width: f64, inside: &impl Fn(DVec2) -> bool) -> bool {
    let own = inside(p);
    let reach = |way: DVec2| {
        (1..=20)
            .map(|k| width * f64::from(k) / 20.0)
            .find(|&d| inside(p + way * d) != own)
            .unwrap_or(f64::INFINITY)
    };
    (0..16).any(|k| {
        let way = DVec2::from_angle(TAU * f64::from(k) / 32.0);
        reach(way) + reach(-way) <= width
    })
}

/// Points of the outline that are farther than `accuracy` from the border.
/// Points in slivers thinner than `sliver` are passed over.
pub fn accuracy(
    area: &Area,
    accuracy: f64,
    sliver: f64,
    inside: &impl Fn(DVec2) -> bool,
) -> Result<(), String> {
    for (n, ring) in area.rings.iter().enumerate() {
        for (a, b) in edges(ring) {
            for t in [0.0, 0.12, 0.37, 0.5, 0.63, 0.88] {
                let p = a.lerp(b, t);
                if border_within(p, accuracy, inside)
                    || narrow(p, sliver, inside)
                {
                    continue;
                }
                let mut off = accuracy;
                while off < 1.0 && !border_within(p, off, inside) {
                    off *= 1.03;
                }
                return Err(format!(
                    "ring {n} at {p}, {t} from {a} to {b}, is {:.1} µm off",
                    1000.0 * off
                ));
            }
        }
    }
    Ok(())
}

/// Points on a grid over ±`half` that the outline has on the wrong side,
/// though they lie in the middle of a disc as wide as the `smallest` feature
/// on which nothing changes.
pub fn complete(
    area: &Area,
    half: f64,
    smallest: f64,
    inside: &impl Fn(DVec2) -> bool,
) -> Result<(), String> {
    const SIDE: u32 = 150;
    for k in 0..SIDE * SIDE {
        let at = |k: u32| {
            half * (2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0)
        };
        let p = DVec2::new(at(k % SIDE), at(k / SIDE));
        if area.contains(p) != inside(p)
            && !border_within(p, 0.5 * smallest, inside)
        {
            return Err(format!("{p} is on the wrong side"));
        }
    }
    Ok(())
}
