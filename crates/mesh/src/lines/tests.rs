use crate::mesh::Mesh;
use crate::tests::{Random, ball, bowl, cuboid, flipped, mesh, moved, torus};
use fidget::context::Tree;
use glam::{DMat3, DVec3};
use isocontour::{Bounds, Data, Grid, Hit, Sight, call};
use std::sync::Arc;

/// A mesh that does not tell where lines cross it.
struct Sampled(Mesh);

impl Data for Sampled {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn at(&self, p: DVec3) -> (f64, DVec3) {
        self.0.at(p)
    }
    fn range(&self, over: &Bounds) -> [f64; 2] {
        self.0.range(over)
    }
    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3] {
        self.0.slopes(over)
    }
    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        self.0.contents(tell);
    }
    fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

/// Lines through the middle, in a direction that is along no face or edge.
fn lines(half: f64, count: usize) -> Grid {
    let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
    let step = 2.0 * half / (count - 1) as f64;
    let steps = turn.to_cols_array_2d().map(|c| step * DVec3::from_array(c));
    Grid {
        origin: steps.map(|s| -0.5 * (count - 1) as f64 * s).iter().sum(),
        steps,
        size: [count; 3],
    }
}

/// A body made of a mesh.
type Way<'a> = &'a dyn Fn(&Tree) -> Tree;

/// Bodies with cavities, shells that cross, and holes that are closed.
fn meshes() -> Vec<(&'static str, Vec<[DVec3; 3]>)> {
    let cube = |half: f64| cuboid(DVec3::splat(-half), DVec3::splat(half));
    let holed: Vec<_> =
        ball(5.0, 3).into_iter().filter(|f| f[0].z < 4.6).collect();
    let crossing = [cube(3.0), moved(&ball(3.0, 3), DVec3::new(2.0, 1.0, 0.5))];
    vec![
        ("torus", torus(4.0, 1.5, 40)),
        (
            "cavity",
            [cube(4.0), flipped(&cube(3.0)), cube(1.0)].concat(),
        ),
        ("crossing", crossing.concat()),
        ("doubled", [cube(3.0), cube(3.0)].concat()),
        ("holed", holed),
    ]
}

fn look(data: &Arc<dyn Data>, of: impl Fn(&Tree) -> Tree) -> Vec<Option<Hit>> {
    let (x, y, z) = Tree::axes();
    let tree = of(&call(data, [x, y, z]));
    let sight = Sight::new(&tree).unwrap();
    sight.look(&lines(7.0, 100)).unwrap()
}

#[test]
fn lines_meet_what_samples_meet() {
    let (x, y, z) = Tree::axes();
    let (x, y, z) = (&x, &y, &z);
    let turned = |t: &Tree| {
        t.remap_xyz(y.clone() - 1.0, x.clone() * 1.5, z.clone() * 1.25)
    };
    let ways: [(&str, Way<'_>); 4] = [
        ("alone", &|t| t.clone()),
        ("cut", &|t| {
            t.max(x.clone() + y.clone() * 0.5 - 1.0).max(z.abs() - 2.0)
        }),
        ("joined", &|t| t.min(turned(t))),
        ("taken off", &|t| t.max(turned(t).neg())),
    ];
    for (name, faces) in meshes() {
        let exact: Arc<dyn Data> = Arc::new(mesh(&faces));
        let sampled: Arc<dyn Data> = Arc::new(Sampled(mesh(&faces)));
        for (way, of) in ways {
            let (mut met, mut other, mut off) = (0, 0, 0);
            for (a, b) in look(&exact, of).iter().zip(look(&sampled, of)) {
                met += usize::from(a.is_some());
                match (a, b) {
                    (Some(a), Some(b)) => {
                        // A sample inside may be nearer to the next facet.
                        let same = (a.depth - b.depth).abs() < 0.2
                            && a.gradient.distance(b.gradient) < 0.3;
                        off += usize::from(!same);
                    }
                    (None, None) => {}
                    _ => other += 1,
                }
            }
            // Samples miss what is thinner than a step, at silhouettes and
            // edges, and there they see the field of a face beside.
            assert!(met > 1000, "{name}, {way}: {met}");
            assert!(other * 30 < met, "{name}, {way}: {other} of {met}");
            assert!(off * 25 < met, "{name}, {way}: {off} of {met}");
        }
    }
}

/// Lines go in and out where the field says so.
#[test]
fn lines_are_inside_where_the_field_is_negative() {
    let mut random = Random::new(11);
    // The cover over a bowl has no gradient of the field.
    let bowl = bowl().iter().map(|f| f.map(|p| 0.5 * p)).collect();
    for (name, faces) in meshes().into_iter().chain([("bowl", bowl)]) {
        let mesh = mesh(&faces);
        let lines = lines(7.0, 30);
        let found = mesh.crossings(&lines).unwrap();
        assert!(found.is_sorted_by_key(|c| (c.line, c.depth as f32)));
        for line in 0..900u32 {
            let own: Vec<_> = found.iter().filter(|c| c.line == line).collect();
            assert!(own.len().is_multiple_of(2), "{name}");
            for (k, crossing) in own.iter().enumerate() {
                let along = crossing.gradient.dot(lines.steps[2]);
                assert_eq!(k % 2 == 1, along > 0.0, "{name}, {line}");
            }
            for _ in 0..20 {
                let depth = 15.0 + random.within(15.0).x;
                let [i, j] = [line % 30, line / 30].map(f64::from);
                let [u, v, w] = lines.steps;
                let p = lines.origin + u * i + v * j + w * depth;
                let passed = own.iter().filter(|c| c.depth < depth).count();
                let d = mesh.value(p);
                assert!(
                    (passed % 2 == 1) == (d < 0.0) || d.abs() < 1e-9,
                    "{name}: {p}"
                );
            }
        }
    }
}

/// Lines through corners and along edges and faces.
#[test]
fn lines_through_corners_meet_a_body_once() {
    let faces = cuboid(DVec3::splat(-2.0), DVec3::splat(2.0));
    let mesh = mesh(&faces);
    for mirror in [1.0, -1.0] {
        let lines = Grid {
            origin: DVec3::new(-4.0 * mirror, -4.0, -4.0),
            steps: [DVec3::X * mirror, DVec3::Y, DVec3::Z],
            size: [9; 3],
        };
        let found = mesh.crossings(&lines).unwrap();
        let wanted = |n: u32| (2..6).contains(&n);
        // Sides to the right, and those far away, count as beside the body.
        for line in 0..81 {
            let own: Vec<_> = found.iter().filter(|c| c.line == line).collect();
            let [i, j] = [line % 9, line / 9];
            let is_met = wanted(i) && wanted(j);
            assert_eq!(own.len(), if is_met { 2 } else { 0 }, "{i}, {j}");
            if let [a, b] = own[..] {
                assert_eq!((a.depth, b.depth), (2.0, 6.0));
                assert_eq!((a.gradient, b.gradient), (-DVec3::Z, DVec3::Z));
            }
        }
    }
}
