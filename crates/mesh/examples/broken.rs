//! Temporary: figures for broken meshes.
use glam::{DAffine3, DVec3};
use isocontour::Data;
use isoslice_mesh::{Format, Mesh, Triangles, read};
use std::fs::File;
use std::time::Instant;

fn main() {
    for file in std::env::args().skip(1) {
        let extension = file.rsplit('.').next().unwrap();
        let format = Format::of_extension(extension).unwrap();
        let t = Instant::now();
        let triangles =
            read(std::io::BufReader::new(File::open(&file).unwrap()), format)
                .unwrap();
        let read_time = t.elapsed();
        let t = Instant::now();
        let sound = Mesh::new("sound", triangles.clone()).unwrap();
        println!(
            "{file}: read {read_time:?} new {:?}: {}",
            t.elapsed(),
            sound.facts()
        );
        let mut rng = fastrand::Rng::with_seed(1);
        for (deleted, turned) in [(0.01, 0.1), (0.05, 0.3), (0.2, 0.1)] {
            let mut broken = Triangles {
                corners: vec![],
                ..triangles.clone()
            };
            for &[a, b, c] in &triangles.corners {
                if rng.f64() < deleted {
                    continue;
                }
                broken.corners.push(if rng.f64() < turned {
                    [a, c, b]
                } else {
                    [a, b, c]
                });
            }
            let t = Instant::now();
            let broken = Mesh::new("broken", broken).unwrap();
            let took = t.elapsed();
            let bounds = triangles.bounds();
            let size = bounds.size();
            let (mut wrong, n) = (0, 100_000);
            let mut worst = 0.0f64;
            for i in 0..n {
                let p = bounds.min
                    + DVec3::new(rng.f64(), rng.f64(), rng.f64()) * size;
                let (a, b) = (sound.value(p), broken.value(p));
                wrong += usize::from((a < 0.0) != (b < 0.0));
                if i % 10 == 0 {
                    worst = worst.max((a.abs() - b.abs()).abs());
                }
            }
            let none = (0..100)
                .filter(|i| {
                    let z =
                        bounds.min.z + size.z * (f64::from(*i) + 0.37) / 100.0;
                    broken.section(&DAffine3::IDENTITY, z).is_none()
                })
                .count();
            println!(
                "  deleted {deleted} turned {turned}: right {:.4} % distance off {:.3} % of size, {none} of 100 sections missing, {took:?}; {}",
                100.0 * (1.0 - wrong as f64 / n as f64),
                100.0 * worst / size.max_element(),
                broken.facts()
            );
        }
    }
}
