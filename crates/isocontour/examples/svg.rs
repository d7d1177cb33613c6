//! Draws the contours of a gyroid in a ball at one height as SVG:
//! `cargo run --release -p isocontour --example svg > contours.svg`

use fidget::context::Tree;
use glam::DVec2;
use isocontour::{Detail, Field, FieldError, Rect, outlines};

fn main() -> Result<(), FieldError> {
    let (x, y, z) = Tree::axes();
    let [s, c] = [Tree::sin, Tree::cos]
        .map(|f| [&x, &y, &z].map(|a| f(&(a.clone() * 0.6))));
    let gyroid = s[0].clone() * c[1].clone()
        + s[1].clone() * c[2].clone()
        + s[2].clone() * c[0].clone();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 20.0;
    let shell = (gyroid.abs() - 0.5).max(ball);

    let rect = Rect::new(DVec2::splat(-21.0), DVec2::splat(21.0));
    let field = Field::new(&shell, 0.0, rect, 0.25)?;
    let detail = Detail {
        accuracy: 0.02,
        smallest: 0.2,
    };
    let height = 3.0;
    let found = outlines(&field, &[height], detail)?;

    println!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"420\" \
         height=\"420\" viewBox=\"-21 -21 42 42\">"
    );
    // Outer rings and holes run opposite ways, so SVG's default rule fills the
    // inside. SVG's y axis points down.
    let mut path = String::new();
    for ring in found.iter().flat_map(|outline| &outline.area.rings) {
        for (n, p) in ring.iter().enumerate() {
            let step = if n == 0 { 'M' } else { 'L' };
            path += &format!("{step}{:.2} {:.2}", p.x, -p.y);
        }
        path += "Z";
    }
    println!(
        "<path d=\"{path}\" fill=\"#e8a33d\" stroke=\"#333\" \
         stroke-width=\"0.12\"/>"
    );
    println!("</svg>");
    Ok(())
}
