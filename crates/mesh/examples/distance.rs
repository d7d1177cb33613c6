//! The signed distance of a mesh at places: `distance part.stl < places`.
//!
//! Each line of the standard input has x, y and z, mm. For each there is a line
//! with the distance, negative inside, and its gradient.

use glam::DVec3;
use isocontour::Data;
use isoslice_mesh::{Format, Mesh, read};
use std::error::Error;
use std::fs::File;
use std::io::{BufRead, BufWriter, Write, stdin, stdout};
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: distance FILE")?;
    let extension = Path::new(&file).extension().unwrap_or_default();
    let format = Format::of_extension(&extension.to_string_lossy())
        .ok_or("it is no STL, OBJ or PLY file")?;
    let mesh = Mesh::new(&file, read(File::open(&file)?, format)?)?;
    eprintln!("{}", mesh.facts());
    let mut out = BufWriter::new(stdout().lock());
    for line in stdin().lock().lines() {
        let line = line?;
        let mut numbers = line.split_whitespace().map(str::parse::<f64>);
        let mut next = || numbers.next().ok_or("a place has three numbers");
        let p = DVec3::new(next()??, next()??, next()??);
        let (d, g) = mesh.at(p);
        writeln!(out, "{d} {} {} {}", g.x, g.y, g.z)?;
    }
    Ok(())
}
