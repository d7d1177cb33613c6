//! Whole meshes, against what is known of their shapes.

use crate::mesh::Mesh;
use crate::rim::rim;
use crate::shell::Shell;
use crate::sign::Sign;
use crate::triangles::{Collector, Triangles};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use isocontour::{Bounds, Data, Ring};

/// Triangles of faces, given by places.
pub(crate) fn triangles(faces: &[[DVec3; 3]]) -> Triangles {
    let mut all = Collector::default();
    for face in faces {
        let corners = face.map(|p| all.vertex(p, String::new).unwrap());
        all.triangle(corners).unwrap();
    }
    all.finish().unwrap()
}

pub(crate) fn mesh(faces: &[[DVec3; 3]]) -> Mesh {
    Mesh::new("mesh", triangles(faces)).unwrap()
}

/// Twelve triangles around a box.
pub(crate) fn cuboid(min: DVec3, max: DVec3) -> Vec<[DVec3; 3]> {
    let corner = |i: usize| {
        let end = |k: usize| if i >> k & 1 == 0 { min[k] } else { max[k] };
        DVec3::new(end(0), end(1), end(2))
    };
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    sides
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|face| face.map(corner))
        .collect()
}

/// A surface over a grid of angles that closes on itself both ways.
pub(crate) fn torus(large: f64, small: f64, n: usize) -> Vec<[DVec3; 3]> {
    let at = |i: usize, j: usize| {
        let turn =
            |i: usize| (i % n) as f64 / n as f64 * 2.0 * std::f64::consts::PI;
        let (u, v) = (turn(i), turn(j));
        let r = large + small * v.cos();
        DVec3::new(r * u.cos(), r * u.sin(), small * v.sin())
    };
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] =
                [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.push([a, b, c]);
            faces.push([a, c, d]);
        }
    }
    faces
}

/// A ball of an octahedron whose triangles are parted in four, `times` times.
pub(crate) fn ball(radius: f64, times: usize) -> Vec<[DVec3; 3]> {
    let mut faces = Vec::new();
    for x in [1.0, -1.0] {
        for y in [1.0, -1.0] {
            for z in [1.0, -1.0] {
                let face = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z];
                let [a, b, c] = face;
                faces.push(if x * y * z > 0.0 { face } else { [a, c, b] });
            }
        }
    }
    for _ in 0..times {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [d, e, f] =
                    [(a + b), (b + c), (c + a)].map(DVec3::normalize);
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    faces.iter().map(|f| f.map(|p| p * radius)).collect()
}

pub(crate) fn flipped(faces: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
    faces.iter().map(|&[a, b, c]| [a, c, b]).collect()
}

pub(crate) fn moved(faces: &[[DVec3; 3]], by: DVec3) -> Vec<[DVec3; 3]> {
    faces.iter().map(|f| f.map(|p| p + by)).collect()
}

/// The lower half of a ball, without a thickness.
pub(crate) fn bowl() -> Vec<[DVec3; 3]> {
    let is_low = |face: &[DVec3; 3]| face.iter().all(|p| p.z <= 0.0);
    ball(10.0, 4).into_iter().filter(is_low).collect()
}

/// Faces, each moved by up to `by`, so that no two meet.
pub(crate) fn scattered(faces: &[[DVec3; 3]], by: f64) -> Vec<[DVec3; 3]> {
    let mut random = Random::new(4);
    let moved = |face: &[DVec3; 3]| {
        let way = random.within(by);
        face.map(|p| p + way)
    };
    faces.iter().map(moved).collect()
}

pub(crate) struct Random(fastrand::Rng);

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        Random(fastrand::Rng::with_seed(seed))
    }

    pub(crate) fn within(&mut self, half: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| (self.0.f64() - 0.5) * 2.0 * half))
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        self.0.usize(..count)
    }
}

/// The signed distance to a box around the origin.
fn to_box(p: DVec3, half: DVec3) -> f64 {
    let q = p.abs() - half;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

/// How often rings go round a place.
pub(crate) fn turns(rings: &[Ring], p: DVec2) -> i32 {
    let mut turns = 0;
    for ring in rings {
        for (i, a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            let left = (b - *a).perp_dot(p - *a);
            if a.y <= p.y && b.y > p.y && left > 0.0 {
                turns += 1;
            } else if a.y > p.y && b.y <= p.y && left < 0.0 {
                turns -= 1;
            }
        }
    }
    turns
}

fn area(rings: &[Ring]) -> f64 {
    let doubled = |ring: &Ring| -> f64 {
        (0..ring.len())
            .map(|i| ring[i].perp_dot(ring[(i + 1) % ring.len()]))
            .sum()
    };
    rings.iter().map(|ring| 0.5 * doubled(ring)).sum()
}

#[test]
fn a_box_has_the_distances_of_a_box() {
    let half = DVec3::new(1.0, 2.0, 3.0);
    let mesh = mesh(&cuboid(-half, half));
    assert!(mesh.facts().is_sound());
    let mut random = Random::new(1);
    for _ in 0..20_000 {
        let p = random.within(5.0);
        let (d, gradient) = mesh.at(p);
        assert!((d - to_box(p, half)).abs() < 1e-12);
        let ahead = mesh.value(p + gradient * 1e-6);
        assert!((ahead - d - 1e-6).abs() < 1e-9);
    }
    let (d, out) = mesh.at(DVec3::new(1.0, 0.3, 0.2));
    assert!(d.abs() < 1e-20);
    assert_eq!(out, DVec3::X);
}

#[test]
fn a_ball_and_a_torus_are_near_to_what_they_are_made_of() {
    let ball = mesh(&ball(10.0, 5));
    let ring = mesh(&torus(10.0, 4.0, 200));
    let mut random = Random::new(2);
    for _ in 0..5000 {
        let p = random.within(16.0);
        assert!((ball.value(p) - (p.length() - 10.0)).abs() < 0.03);
        let around = p.truncate().length() - 10.0;
        let d = around.hypot(p.z) - 4.0;
        assert!((ring.value(p) - d).abs() < 0.01, "{p}");
    }
}

/// Values of places one after another are those of each alone.
#[test]
fn values_do_not_depend_on_those_before() {
    let mesh = mesh(&torus(10.0, 4.0, 60));
    let mut random = Random::new(3);
    let mut p = DVec3::ZERO;
    let places: Vec<DVec3> = (0..20_000)
        .map(|i| {
            if i % 500 == 0 {
                p = random.within(15.0);
            }
            p += random.within(0.1);
            p.as_vec3().as_dvec3()
        })
        .collect();
    let axis =
        |k: usize| -> Vec<f32> { places.iter().map(|p| p[k] as f32).collect() };
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let mut values = Vec::new();
    mesh.values([&x, &y, &z], &mut values);
    for (p, value) in places.iter().zip(values) {
        assert_eq!(mesh.value(*p) as f32, value);
        assert_eq!(mesh.at(*p).0 as f32, value);
    }
    values = Vec::new();
    mesh.values(
        [&[f32::NAN, 1.0], &[0.0, f32::INFINITY], &[0.0; 2]],
        &mut values,
    );
    assert!(values.iter().all(|v| v.is_nan()));
}

/// Places of a lattice's leaves: rows of 9, 9 rows to a leaf, 3 leaves.
fn leaves(step: f32) -> [Vec<f32>; 3] {
    let mut places: [Vec<f32>; 3] = Default::default();
    for k in 0..3 * 81 {
        let (leaf, row, column) = (k / 81, k / 9 % 9, k % 9);
        places[0].push(step * (8 * leaf + column) as f32);
        places[1].push(step * row as f32);
        places[2].push(0.3);
    }
    places
}

#[test]
fn a_lattice_has_the_values_of_single_places() {
    let mut random = Random::new(8);
    let mut loose = Vec::new();
    for _ in 0..60 {
        let middle = random.within(4.0);
        loose.push([(); 3].map(|()| middle + random.within(1.0)));
    }
    // Loose triangles, a sheet of two, a closed body, and one with a hole.
    let sheet = [loose[0], [loose[0][1], loose[0][0], middle(&loose[1])]];
    let whole = ball(2.0, 3);
    for faces in [&loose[..], &sheet, &whole, &whole[4..]] {
        let mesh = mesh(faces);
        for step in [0.02, 0.1, 0.4] {
            let [x, y, z] = leaves(step);
            let mut all = Vec::new();
            mesh.values([&x, &y, &z], &mut all);
            for (k, v) in all.into_iter().enumerate() {
                let p = [x[k], y[k], z[k]].map(f64::from);
                let alone = mesh.value(DVec3::from_array(p)) as f32;
                assert_eq!(v, alone, "{step} {p:?}");
            }
        }
    }
}

fn middle(face: &[DVec3; 3]) -> DVec3 {
    face.iter().sum::<DVec3>() / 3.0
}

fn ranges_hold(mesh: &Mesh, seed: u64, count: usize) {
    let mut random = Random::new(seed);
    let size = mesh.bounds.size().max_element();
    for i in 0..count {
        let centre = random.within(0.8 * size);
        let scale = size * [0.5, 0.1, 0.02, 0.0][i % 4];
        let half = random.within(scale).abs();
        let over = Bounds {
            min: centre - half,
            max: centre + half,
        };
        let [low, high] = mesh.range(&over);
        let slopes = mesh.slopes(&over);
        assert!(low <= high);
        for j in 0..6 {
            let p = if j < 2 {
                centre + half * if j == 0 { 1.0 } else { -1.0 }
            } else {
                centre + half * random.within(1.0)
            };
            let (d, gradient) = mesh.at(p);
            let single = d as f32;
            assert!(low <= d && d <= high, "{over:?} {p} {low} {d} {high}");
            assert!(low <= single.into() && f64::from(single) <= high);
            for k in 0..3 {
                let [low, high] = slopes[k];
                assert!(low <= gradient[k] && gradient[k] <= high);
            }
        }
    }
}

#[test]
fn ranges_hold_all_values() {
    let half = DVec3::new(1.0, 2.0, 3.0);
    let shapes = [
        cuboid(-half, half),
        torus(10.0, 4.0, 30),
        ball(5.0, 3)[1..].to_vec(),
        torus(10.0, 4.0, 30)[20..].to_vec(),
        [cuboid(-half, half), moved(&cuboid(-half, half), half)].concat(),
        bowl(),
        scattered(&ball(5.0, 3), 0.02),
    ];
    for (i, faces) in shapes.iter().enumerate() {
        ranges_hold(&mesh(faces), i as u64, 8000);
    }
}

#[test]
fn slopes_of_planes_are_those_of_the_plane() {
    let mesh = mesh(&cuboid(DVec3::splat(-10.0), DVec3::splat(10.0)));
    for z in [8.0, 9.5, 10.0, 11.5] {
        let over = Bounds {
            min: DVec3::new(-1.0, -1.0, z),
            max: DVec3::new(1.0, 1.0, z + 0.5),
        };
        let [x, _, z] = mesh.slopes(&over);
        assert!(x[0] > -1e-4 && x[1] < 1e-4 && z[0] > 0.999, "{x:?} {z:?}");
    }
    let over = Bounds {
        min: DVec3::new(9.0, -1.0, 9.0),
        max: DVec3::new(11.0, 1.0, 11.0),
    };
    assert_eq!(mesh.slopes(&over)[0], [-1.0, 1.0]);
}

#[test]
fn ranges_of_planes_are_tight() {
    let half = DVec3::splat(10.0);
    let mesh = mesh(&cuboid(-half, half));
    let over = Bounds {
        min: DVec3::new(-1.0, -1.0, 11.0),
        max: DVec3::new(1.0, 1.0, 12.0),
    };
    let [low, high] = mesh.range(&over);
    assert!((low - 1.0).abs() < 1e-5 && high < 2.5);
    let everything = Bounds {
        min: DVec3::NEG_INFINITY,
        max: DVec3::INFINITY,
    };
    let [low, high] = mesh.range(&everything);
    assert!(low < -10.0 && low > -20.0 && high == f64::INFINITY);
}

/// Compares the sections of a mesh with the signs of its field.
pub(crate) fn sections_are_where_it_is_inside(mesh: &Mesh, seed: u64) {
    let mut random = Random::new(seed);
    let size = mesh.bounds.size().max_element();
    let mut checked = 0;
    for i in 0..60 {
        let turned = DMat3::from_rotation_x(random.within(3.0).x)
            * DMat3::from_rotation_y(random.within(3.0).x);
        let matrix = match i % 3 {
            0 => DMat3::IDENTITY,
            1 => turned,
            _ => turned * DMat3::from_diagonal(DVec3::new(-1.5, 1.0, 0.7)),
        };
        let place =
            DAffine3::from_mat3_translation(matrix, random.within(0.1 * size));
        let z = random.within(0.5 * size).x;
        let rings = mesh.section(&place, z).unwrap();
        for _ in 0..50 {
            let p = random.within(0.7 * size).truncate();
            let d = mesh.value(place.transform_point3(p.extend(z)));
            if d.abs() > 1e-9 {
                assert_eq!(turns(&rings, p) >= 1, d < 0.0, "{p} at {z}");
                checked += usize::from(d < 0.0);
            }
        }
    }
    assert!(checked > 20);
}

#[test]
fn sections_agree_with_the_field() {
    let cube = cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
    let both = [cube.clone(), moved(&cube, DVec3::splat(0.7))].concat();
    let hollow = [
        cube.clone(),
        flipped(&cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))),
    ]
    .concat();
    let shapes = [
        cube.clone(),
        torus(10.0, 4.0, 40),
        both,
        [cube.clone(), cube.clone()].concat(),
        hollow,
    ];
    for (i, faces) in shapes.iter().enumerate() {
        sections_are_where_it_is_inside(&mesh(faces), i as u64);
    }
}

#[test]
fn sections_have_exact_areas() {
    let ring = mesh(&torus(10.0, 4.0, 100));
    let rings = ring.section(&DAffine3::IDENTITY, 0.05).unwrap();
    assert_eq!(rings.len(), 2);
    assert!(rings.iter().any(|r| area(std::slice::from_ref(r)) < 0.0));
    // Between the inner and the outer polygon of a hundred corners each.
    let n = 100.0;
    let polygon =
        |r: f64| 0.5 * n * r * r * (2.0 * std::f64::consts::PI / n).sin();
    let whole = ring.section(&DAffine3::IDENTITY, 0.0).unwrap();
    let expected = polygon(14.0) - polygon(6.0);
    assert!((area(&whole) - expected).abs() < 1e-9 * expected);
}

#[test]
fn level_faces_are_what_is_above_or_below() {
    // Steps: a wide box below a narrow one, as one body.
    let wide = cuboid(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(2.0, 2.0, 1.0));
    let mesh = mesh(&wide);
    for z in [0.0, 1.0] {
        let rings = mesh.section(&DAffine3::IDENTITY, z).unwrap();
        assert_eq!(rings.len(), 1);
        assert_eq!(area(&rings), 16.0);
    }
    assert!(mesh.section(&DAffine3::IDENTITY, 1.1).unwrap().is_empty());
    assert!(mesh.section(&DAffine3::IDENTITY, f64::NAN).is_none());
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    assert!(mesh.section(&flat, 0.5).is_none());
}

#[test]
fn overlapping_and_doubled_shells_are_solid() {
    let cube = cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
    let both = mesh(&[cube.clone(), moved(&cube, DVec3::splat(0.7))].concat());
    assert!(both.value(DVec3::splat(0.3)) < 0.0);
    assert!(both.value(DVec3::splat(1.2)) < 0.0);
    assert!(both.value(DVec3::new(1.2, -0.5, 0.0)) > 0.0);
    let doubled = mesh(&[cube.clone(), cube.clone()].concat());
    assert!((doubled.value(DVec3::ZERO) + 1.0).abs() < 1e-12);
    // In a face that is inside another body there is no gap.
    assert!(both.value(DVec3::new(1.0, 0.5, 0.5)) < 0.0);
}

#[test]
fn holes_are_closed() {
    let faces = ball(10.0, 4);
    let holed: Vec<_> =
        faces.iter().copied().filter(|f| f[0].z < 9.0).collect();
    let mesh = mesh(&holed);
    assert_eq!((mesh.facts().closed, mesh.facts().open_edges), (1, 0));
    let mut random = Random::new(5);
    for _ in 0..5000 {
        let p = random.within(14.0);
        if p.z < 8.0 && (p.length() - 10.0).abs() > 0.1 {
            assert_eq!(mesh.value(p) < 0.0, p.length() < 10.0, "{p}");
        }
    }
    sections_are_where_it_is_inside(&mesh, 8);
}

#[test]
fn openings_stay_open() {
    let tube = &cuboid(DVec3::splat(-1.0), DVec3::splat(1.0))[4..];
    let mesh = mesh(tube);
    assert_eq!(mesh.facts().open_edges, 8);
    assert!(mesh.value(DVec3::ZERO) < 0.0);
    assert!(mesh.value(DVec3::Z * 1.1) > 0.0);
    assert!((mesh.value(DVec3::Z * 0.99) + 1.0).abs() < 0.02);
    sections_are_where_it_is_inside(&mesh, 9);
    ranges_hold(&mesh, 9, 2000);
}

/// Small gaps, as between triangles of different sizes along an edge.
#[test]
fn seams_are_closed() {
    let half = DVec3::splat(1.0);
    let mut faces = cuboid(-half, half);
    let [a, b, c] = faces[0];
    let middle = a.midpoint(b) + DVec3::splat(1e-5);
    faces[0] = [a, middle, c];
    faces.push([middle, b, c]);
    let mesh = mesh(&faces);
    assert_eq!((mesh.facts().closed, mesh.facts().open_edges), (1, 0));
    sections_are_where_it_is_inside(&mesh, 10);
    ranges_hold(&mesh, 10, 2000);
}

/// The winding number with caps is that of the triangles alone.
#[test]
fn winding_numbers_are_sums_of_solid_angles() {
    let mut random = Random::new(6);
    let faces = torus(10.0, 4.0, 30);
    for share in [0, 30, 70] {
        let some: Vec<_> = faces
            .iter()
            .copied()
            .filter(|_| random.below(100) >= share)
            .collect();
        let triangles = triangles(&some);
        let bounds = triangles.bounds();
        let shell = Shell::new(triangles.vertices, triangles.corners);
        let rim = rim(&shell.corners, shell.vertices.len());
        let sign = if rim.is_empty() {
            Sign::Closed
        } else {
            Sign::open(&shell, &rim)
        };
        let mut worst = 0.0f64;
        for _ in 0..500 {
            let p = random.within(15.0);
            let sum: f64 = some
                .iter()
                .map(|f| crate::winding::solid_angle(p, *f))
                .sum();
            let exact = sum / (4.0 * std::f64::consts::PI);
            let winding = sign.winding(&shell, &bounds, p);
            worst = worst.max((winding - exact).abs());
        }
        assert!(worst < 2e-3, "{share}: {worst}");
    }
}

#[test]
fn flipped_triangles_are_turned_round() {
    let faces = torus(10.0, 4.0, 30);
    let mut random = Random::new(7);
    for share in [1, 20, 50, 80, 100] {
        let some: Vec<_> = faces
            .iter()
            .map(|&[a, b, c]| {
                if random.below(100) < share {
                    [a, c, b]
                } else {
                    [a, b, c]
                }
            })
            .collect();
        let mesh = mesh(&some);
        assert!(mesh.facts().is_sound() && mesh.facts().turned > 0);
        assert!(mesh.value(DVec3::X * 10.0) < 0.0);
        assert!(mesh.value(DVec3::X * 5.0) > 0.0);
        assert!(mesh.at(DVec3::X * 14.0).1.x > 0.9);
    }
}

#[test]
fn shells_are_bodies_or_cavities() {
    let cube = |half: f64| cuboid(DVec3::splat(-half), DVec3::splat(half));
    let aside = moved(&cube(1.0), DVec3::X * 9.0);
    // A body, its cavity, a body in that, and another body aside.
    let all = [cube(3.0), flipped(&cube(2.0)), cube(1.0), aside.clone()];
    let island = [cube(3.0), flipped(&cube(2.0)), flipped(&cube(1.0)), aside];
    let inverted = [&all[0], &all[1], &all[2]].map(|f| flipped(f)).concat();
    let apart = [all[0].clone(), all[1].clone(), flipped(&all[3])].concat();
    for (faces, x) in [
        (all.concat(), vec![(0.0, true), (9.0, true)]),
        (island.concat(), vec![(0.0, true), (9.0, true)]),
        (inverted, vec![(0.0, true), (9.0, false)]),
        (apart, vec![(0.0, false), (9.0, true)]),
    ] {
        let mesh = mesh(&faces);
        for (x, is_inside) in [(1.5, false), (2.5, true)].into_iter().chain(x) {
            let d = mesh.value(DVec3::new(x, 0.01, 0.02));
            assert_eq!(d < 0.0, is_inside, "{x}");
        }
        sections_are_where_it_is_inside(&mesh, 3);
    }
}

#[test]
fn doubled_triangles_in_a_part_of_a_shell_are_one() {
    let faces = ball(5.0, 3);
    let mut some = faces.clone();
    some.extend(flipped(&faces[10..50]));
    some.extend(&faces[100..150]);
    let mesh = mesh(&some);
    assert!(mesh.facts().is_sound());
    assert_eq!(mesh.facts().doubled, 90);
    assert!(mesh.value(DVec3::ZERO) < -4.8);
}

/// A fuzzer found these two needles, which are as good as one edge.
#[test]
fn triangles_of_which_nothing_is_left_are_refused() {
    let tiny = f64::from(f32::from_bits(1 << 14));
    let faces = [
        [DVec3::Z * tiny, DVec3::ZERO, DVec3::X * 5.9e-39],
        [DVec3::Y * tiny, DVec3::ZERO, DVec3::X * 4.0],
    ];
    let said = Mesh::new("mesh", triangles(&faces)).unwrap_err();
    assert!(said.to_string().contains("nothing is left"), "{said}");
}
