//! Meshes a model with fidget's own mesher, as an STL file.
//!
//!     cargo run --release -p through-mesh -- MODEL OUT.stl DEPTH
//!
//! What isoslice does without, for `benchmark.py` to compare with. The mesh
//! has 2^DEPTH cells along a cube a fifth larger than the model's largest
//! side.

use fidget_jit::JitShape;
use fidget_mesh::{Octree, Settings};
use isoslice::model::{self, BuildVolume, Placement, Source};
use nalgebra::{Matrix4, Vector3};
use std::error::Error;
use std::fs::File;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [path, out, depth] = args.as_slice() else {
        return Err("usage: through-mesh MODEL OUT.stl DEPTH".into());
    };
    let volume = BuildVolume {
        x: 400.0,
        y: 400.0,
        z: 400.0,
    };
    let loaded = model::load(&Source::File(path.into()), &[])?;
    let model = model::place(&loaded, &Placement::default(), volume)?;
    let half = 0.6 * model.bounds.size().max_element();
    let middle = model.bounds.centre();
    let middle = Vector3::from(middle.as_vec3().to_array());
    let shape = JitShape::from(model.tree).try_into()?;
    let settings = Settings {
        depth: depth.parse()?,
        world_to_model: Matrix4::new_translation(&middle)
            * Matrix4::new_scaling(half as f32),
        ..Default::default()
    };
    let octree = Octree::build(&shape, &settings).ok_or("cancelled")?;
    let mut mesh = octree.walk_dual();
    // A corner that the mesher has guessed below the part would lift all of it
    // off the bed.
    let lowest = model.bounds.min.z as f32;
    mesh.vertices.iter_mut().for_each(|v| v.z = v.z.max(lowest));
    mesh.write_stl(&mut File::create(out)?)?;
    println!("{} triangles", mesh.triangles.len());
    Ok(())
}
