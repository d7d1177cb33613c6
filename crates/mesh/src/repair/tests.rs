//! Broken meshes, against the sound ones that they are made of.

use crate::mesh::Mesh;
use crate::sign::Sign;
use crate::tests::{
    Random, ball, bowl, cuboid, flipped, mesh, moved, scattered,
    sections_are_where_it_is_inside, torus,
};
use glam::{DAffine3, DVec3};
use isocontour::Data;

type Faces = Vec<[DVec3; 3]>;

/// A box whose sides have n² squares each.
fn tiled(n: usize) -> Faces {
    let (min, max) = (DVec3::splat(-8.0), DVec3::new(8.0, 6.0, 4.0));
    let mut faces = Vec::new();
    for [a, b, c] in cuboid(min, max) {
        let at = |u: usize, v: usize| {
            let (u, v) = (u as f64 / n as f64, v as f64 / n as f64);
            a + (b - a) * u + (c - b) * v
        };
        for u in 0..n {
            for v in 0..=u {
                faces.push([at(u, v), at(u + 1, v), at(u + 1, v + 1)]);
                if v < u {
                    faces.push([at(u, v), at(u + 1, v + 1), at(u, v + 1)]);
                }
            }
        }
    }
    // The two triangles of a side come to the same places by other sums.
    let grid = |x: f64| (x * 1e6).round() / 1e6;
    let grid = |p: DVec3| DVec3::from_array(p.to_array().map(grid));
    faces.iter().map(|f| f.map(grid)).collect()
}

fn shapes() -> [(&'static str, Faces); 3] {
    [
        ("ball", ball(10.0, 6)),
        ("box", tiled(32)),
        ("torus", torus(10.0, 4.0, 160)),
    ]
}

/// The faces whose middles are the nearest to a place are left out.
fn with_hole(faces: &[[DVec3; 3]], at: DVec3, count: usize) -> Faces {
    let far = |f: &[DVec3; 3]| (f[0] + f[1] + f[2]).distance(3.0 * at);
    let mut sorted = faces.to_vec();
    sorted.sort_by(|a, b| far(a).total_cmp(&far(b)));
    sorted.split_off(count)
}

/// Compares signs and distances at many places, those near the surface more
/// often; and sections with signs. `share` of the signs has to be right.
fn is_like(name: &str, broken: &Mesh, sound: &Mesh, share: f64, reach: f64) {
    let facts = broken.facts();
    assert!(broken.sign.is_closed(), "{name}: {facts}");
    assert_eq!(facts.open_edges, 0, "{name}");
    let mut random = Random::new(9);
    let count = 100_000;
    let (mut wrong, mut worst) = (0, 0.0f64);
    let size = 0.55 * sound.bounds.size();
    let centre = sound.bounds.centre();
    for _ in 0..count {
        let p = centre + random.within(1.0) * size;
        wrong += usize::from(broken.is_inside(p) != sound.is_inside(p));
    }
    for _ in 0..2000 {
        let p = centre + random.within(1.0) * size;
        let differs = broken.value(p).abs() - sound.value(p).abs();
        worst = worst.max(differs.abs());
    }
    let right = 1.0 - wrong as f64 / f64::from(count);
    assert!(right >= share, "{name}: {right} right, {facts}");
    assert!(worst <= reach, "{name}: {worst} off, {facts}");
    for i in 0..100 {
        let z = centre.z + sound.bounds.size().z * (f64::from(i) / 99.0 - 0.5);
        assert!(
            broken.section(&DAffine3::IDENTITY, z).is_some(),
            "{name} {z}"
        );
    }
    sections_are_where_it_is_inside(broken, 10);
}

#[test]
fn holes_are_closed() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        for count in [1, 5, 200] {
            let at = DVec3::new(9.0, 1.3, 0.4);
            let broken = mesh(&with_hole(&faces, at, count));
            assert!(broken.facts().closed > 0);
            is_like(name, &broken, &sound, 0.9999, 0.15);
        }
    }
}

#[test]
fn many_holes_that_touch_are_closed() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        for share in [1, 5] {
            let mut random = Random::new(11);
            let some: Faces = faces
                .iter()
                .copied()
                .filter(|_| random.below(100) >= share)
                .collect();
            is_like(name, &mesh(&some), &sound, 0.9995, 0.15);
        }
    }
}

#[test]
fn turned_faces_are_turned_back() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        let turn = |which: &mut dyn FnMut(usize) -> bool| -> Faces {
            let all = faces.iter().enumerate();
            all.map(
                |(i, &[a, b, c])| {
                    if which(i) { [a, c, b] } else { [a, b, c] }
                },
            )
            .collect()
        };
        let mut random = Random::new(12);
        let single = mesh(&turn(&mut |i| i == 77));
        assert_eq!(single.facts().turned, 1);
        is_like(name, &single, &sound, 1.0, 0.0);
        let some = mesh(&turn(&mut |_| random.below(10) < 3));
        is_like(name, &some, &sound, 1.0, 0.0);
        let all = mesh(&turn(&mut |_| true));
        assert_eq!(all.facts().turned, faces.len());
        is_like(name, &all, &sound, 1.0, 0.0);
        assert_eq!(
            all.facts().repairs(),
            Some(format!("turned {} triangles round", faces.len()))
        );
    }
}

#[test]
fn vertices_on_edges_part_them() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        let mut random = Random::new(13);
        // Some triangles are parted, and their neighbours are not.
        let parted: Faces = faces
            .iter()
            .flat_map(|&[a, b, c]| match random.below(20) {
                0 => {
                    let d = a.lerp(b, 0.3);
                    vec![[a, d, c], [d, b, c]]
                }
                1 => {
                    let d = a.lerp(b, 0.3).as_vec3().as_dvec3();
                    let e = a.lerp(b, 0.7).as_vec3().as_dvec3();
                    vec![[a, d, c], [d, e, c], [e, b, c]]
                }
                _ => vec![[a, b, c]],
            })
            .collect();
        let broken = mesh(&parted);
        assert!(broken.facts().joined > 0 && broken.facts().closed == 0);
        is_like(name, &broken, &sound, 1.0, 1e-5);
    }
}

/// Both halves of a body have vertices of their own along the seam.
#[test]
fn seams_with_other_vertices_on_both_sides_are_closed() {
    let cube = cuboid(DVec3::splat(-5.0), DVec3::splat(5.0));
    let top = |f: &&[DVec3; 3]| f.iter().all(|p| p.z > 0.0);
    let mut faces: Faces = cube.iter().filter(|f| !top(f)).copied().collect();
    let n = 37;
    let rim: Vec<DVec3> = [[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]]
        .windows(2)
        .chain([[[-1., 1.], [-1., -1.]].as_slice()])
        .flat_map(|w| {
            let corner = |c: [f64; 2]| DVec3::new(c[0], c[1], 1.0) * 5.0;
            let (a, b) = (corner(w[0]), corner(w[1]));
            (0..n).map(move |i| a.lerp(b, f64::from(i) / f64::from(n)))
        })
        .collect();
    let middle = DVec3::Z * 5.0;
    for (i, a) in rim.iter().enumerate() {
        faces.push([middle, *a, rim[(i + 1) % rim.len()]]);
    }
    is_like("lid", &mesh(&faces), &mesh(&cube), 1.0, 1e-12);
}

#[test]
fn cracks_of_roundings_are_welded() {
    // Those of f32, and those of programs that calculate with less.
    for (wide, off) in [(2e-6, 1e-5), (2e-4, 1e-3)] {
        for (name, faces) in shapes() {
            let sound = mesh(&faces);
            let mut random = Random::new(14);
            let cracked: Faces = faces
                .iter()
                .map(|f| f.map(|p| p + random.within(wide)))
                .collect();
            let broken = mesh(&cracked);
            let facts = broken.facts();
            assert!(facts.joined > 0 && facts.closed == 0, "{name} {wide}");
            assert_eq!(facts.open_edges, 0, "{name} {wide}");
            is_like(name, &broken, &sound, 0.9999, off);
        }
    }
}

/// A fine rim that is open, beside long edges that are.
#[test]
fn fine_rims_keep_their_shape_beside_long_ones() {
    let n = 700;
    let at = |i: usize, z: f64| {
        let turn = std::f64::consts::TAU * i as f64 / f64::from(n as u32);
        DVec3::new(turn.cos(), turn.sin(), z)
    };
    let wall = (0..n).flat_map(|i| {
        let next = (i + 1) % n;
        let [a, b] = [at(i, 10.0), at(next, 10.0)];
        let [c, d] = [at(i, 0.0), at(next, 0.0)];
        [[c, d, b], [c, b, a], [d, c, DVec3::ZERO]]
    });
    // Two faces of a box of 100 mm, far from the pin.
    let far = |x: f64, y: f64, z: f64| DVec3::new(x + 50.0, y, z);
    let wide = [
        [
            far(0.0, 0.0, 0.0),
            far(100.0, 0.0, 0.0),
            far(0.0, 100.0, 0.0),
        ],
        [
            far(0.0, 0.0, 5.0),
            far(0.0, 100.0, 5.0),
            far(100.0, 0.0, 5.0),
        ],
    ];
    let pin = mesh(&wall.chain(wide).collect::<Vec<_>>());
    assert_eq!(pin.facts().joined, 0);
    for z in [3.0, 9.0] {
        let off = pin.value(DVec3::new(0.97, 0.0, z)) + 0.03;
        assert!(off.abs() < 1e-3, "{off}");
    }
}

#[test]
fn doubled_faces_are_one() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        let some = [&faces[..], &faces[100..300], &flipped(&faces[500..700])];
        let broken = mesh(&some.concat());
        assert_eq!(broken.facts().doubled, 400);
        is_like(name, &broken, &sound, 1.0, 0.0);
        let both_sides = mesh(&[&faces[..], &flipped(&faces)].concat());
        is_like(name, &both_sides, &sound, 1.0, 0.0);
    }
}

#[test]
fn slivers_do_no_harm() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        let mut random = Random::new(15);
        let parted: Faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                if random.below(10) > 0 {
                    return vec![[a, b, c]];
                }
                let d = a.lerp(b, 0.5) + (c - a) * 1e-9;
                vec![[a, d, c], [d, b, c], [a, b, d]]
            })
            .collect();
        is_like(name, &mesh(&parted), &sound, 1.0, 1e-6);
        let holed = mesh(&with_hole(&parted, DVec3::X * 9.0, 5));
        is_like(name, &holed, &sound, 0.9999, 0.2);
    }
}

#[test]
fn faults_of_all_kinds_at_once() {
    for (name, faces) in shapes() {
        let sound = mesh(&faces);
        let mut random = Random::new(16);
        let mut broken = Faces::new();
        for &[a, b, c] in &faces {
            let face = match random.below(10) {
                0 => [a, c, b],
                _ => [a, b, c],
            };
            match random.below(100) {
                0 => {}
                1 => broken.extend([face, face]),
                2 => broken.extend([face, [face[0], face[2], face[1]]]),
                3 => {
                    let d = face[0].lerp(face[1], 0.4);
                    broken.push([face[0], d, face[2]]);
                    broken.push([d, face[1], face[2]]);
                }
                4 => broken.push(face.map(|p| p + random.within(2e-6))),
                _ => broken.push(face),
            }
        }
        is_like(name, &mesh(&broken), &sound, 0.999, 0.2);
    }
}

/// Bodies that touch along an edge, in a corner and in a face. The last ones
/// become one, so that it is not known which of them is inside out.
#[test]
fn bodies_that_touch_stay_bodies() {
    let cube = cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
    for way in [DVec3::new(2., 2., 0.), DVec3::splat(2.0), DVec3::X * 2.0] {
        let other = moved(&cube, way);
        for other in [other.clone(), flipped(&other)] {
            if way == DVec3::X * 2.0 && other[0] != moved(&cube, way)[0] {
                continue;
            }
            let mesh = mesh(&[cube.clone(), other].concat());
            assert!(mesh.sign.is_closed());
            for p in [DVec3::ZERO, way] {
                let p = p + DVec3::new(0.01, 0.02, 0.03);
                assert!((mesh.value(p) + 1.0).abs() < 0.04, "{way}");
            }
            assert!(mesh.value(DVec3::new(1.5, -1.5, 0.5)) > 0.0);
            sections_are_where_it_is_inside(&mesh, 17);
        }
    }
}

/// A wall inside a box has edges of three triangles.
#[test]
fn inner_walls_change_nothing() {
    let sides: Faces = [
        cuboid(DVec3::new(-2., -1., -1.), DVec3::new(0., 1., 1.)),
        cuboid(DVec3::new(0., -1., -1.), DVec3::new(2., 1., 1.)),
    ]
    .concat();
    let is_wall = |f: &[DVec3; 3]| f.iter().all(|p| p.x == 0.0);
    let mut walls = 0;
    let faces: Faces = sides
        .into_iter()
        .filter(|f| {
            walls += usize::from(is_wall(f));
            !is_wall(f) || walls <= 2
        })
        .collect();
    let mesh = mesh(&faces);
    assert!(mesh.sign.is_closed(), "{}", mesh.facts());
    assert!(mesh.value(DVec3::new(1.0, 0.1, 0.2)) < 0.0);
    assert!(mesh.value(DVec3::new(-1.0, 0.1, 0.2)) < 0.0);
    sections_are_where_it_is_inside(&mesh, 18);
}

/// A bowl's opening stays open, and what is inside of it is known all the same.
#[test]
fn openings_are_covered_for_the_sign_alone() {
    let mesh = mesh(&bowl());
    assert!(matches!(mesh.sign, Sign::Covered(_)));
    assert!(mesh.facts().open_edges > 0 && mesh.facts().closed == 0);
    let mut random = Random::new(19);
    for _ in 0..10_000 {
        let p = random.within(11.0);
        let whole = p.length() < 9.9 && p.z < 0.0;
        if p.length() < 9.9 || p.length() > 10.0 {
            assert_eq!(mesh.value(p) < 0.0, whole, "{p}");
        }
    }
    let deep = mesh.value(DVec3::Z * -0.01);
    assert!((deep + 9.95).abs() < 0.06, "{deep}");
    sections_are_where_it_is_inside(&mesh, 20);
}

/// Triangles that do not meet bound a body together. Covers over each would take
/// it away.
#[test]
fn what_only_winding_numbers_close_is_left_to_them() {
    let mesh = mesh(&scattered(&ball(10.0, 4), 0.05));
    assert!(!mesh.sign.is_closed() && mesh.sign.cover().is_none());
    assert!(mesh.section(&DAffine3::IDENTITY, 0.0).is_none());
    let mut random = Random::new(21);
    for _ in 0..2000 {
        let p = random.within(12.0);
        if (p.length() - 10.0).abs() > 0.5 {
            assert_eq!(mesh.value(p) < 0.0, p.length() < 10.0, "{p}");
        }
    }
}

#[test]
fn sheets_hold_nothing() {
    let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]
        .map(|[x, y]| DVec3::new(x, y, 0.0));
    let [a, b, c, d] = square;
    for faces in [vec![[a, b, c]], vec![[a, b, c], [a, c, d]]] {
        let mesh = mesh(&faces);
        assert!(mesh.facts().open_edges > 0);
        let mut random = Random::new(22);
        for _ in 0..1000 {
            assert!(mesh.value(random.within(2.0)) >= 0.0);
        }
    }
}

/// A strip with one side cannot be turned right.
#[test]
fn a_moebius_strip_is_taken() {
    let n = 60;
    let at = |i: usize, side: f64| {
        let turn = i as f64 / n as f64 * std::f64::consts::TAU;
        let r = 10.0 + side * (turn / 2.0).cos();
        let z = side * (turn / 2.0).sin();
        DVec3::new(r * turn.cos(), r * turn.sin(), z)
    };
    let mut faces = Faces::new();
    for i in 0..n {
        let (a, b) = (at(i, -2.0), at(i, 2.0));
        let (c, d) = if i + 1 < n {
            (at(i + 1, -2.0), at(i + 1, 2.0))
        } else {
            (at(0, 2.0), at(0, -2.0))
        };
        faces.extend([[a, c, d], [a, d, b]]);
    }
    let mesh = mesh(&faces);
    assert!(mesh.value(DVec3::ZERO).is_finite());
    assert!(
        mesh.section(&DAffine3::IDENTITY, 0.3)
            .is_none_or(|r| r.len() < 99)
    );
}

/// A pocket that is a shell turned inwards, flush with one side of its block.
#[test]
fn a_flush_pocket_is_a_pocket_whichever_way_it_opens() {
    for axis in 0..3 {
        for end in [0.0, 10.0] {
            let (mut lo, mut hi) = (DVec3::splat(95.0), DVec3::splat(105.0));
            lo[axis] = 90.0 + end;
            hi[axis] = 100.0 + end;
            let outer = cuboid(DVec3::splat(90.0), DVec3::splat(110.0));
            let pocket = flipped(&cuboid(lo, hi));
            let mesh = mesh(&[outer, pocket].concat());
            let middle = 0.5 * (lo + hi);
            assert!(mesh.value(middle) > 0.0, "{axis}, {end}");
            assert!(mesh.value(DVec3::splat(91.0)) < 0.0, "{axis}, {end}");
        }
    }
}
