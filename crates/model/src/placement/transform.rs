//! Turned and scaled expressions, and boxes.

use fidget::context::Tree;
use glam::DMat3;
use isocontour::Bounds;
use isoslice_base::units::sin_cos;

/// The matrix that turns about x, then y, then z.
pub(super) fn rotation([x, y, z]: [f64; 3]) -> DMat3 {
    let (sx, cx) = sin_cos(x);
    let (sy, cy) = sin_cos(y);
    let (sz, cz) = sin_cos(z);
    let about_x =
        DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
    let about_y =
        DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
    let about_z =
        DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
    about_z * about_y * about_x
}

/// The field of the turned and scaled part: g(p) = s·f(R⁻¹·p/s).
pub(super) fn mapped(tree: &Tree, rotation: DMat3, scale: f64) -> Tree {
    // The inverse of a rotation is its transpose.
    let back = rotation.transpose() * (1.0 / scale);
    let mut m = nalgebra::Matrix4::<f32>::identity();
    for row in 0..3 {
        for column in 0..3 {
            // This avoids negative zeros, which would not cancel in the
            // expression.
            m[(row, column)] = back.col(column)[row] as f32 + 0.0;
        }
    }
    let turned = tree.remap_affine(nalgebra::Affine3::from_matrix_unchecked(m));
    if scale == 1.0 {
        turned
    } else {
        turned * scale as f32
    }
}

/// Distance-like field of a box.
pub(super) fn box_field(bounds: &Bounds) -> Tree {
    let (x, y, z) = Tree::axes();
    let side = |axis: Tree, min: f64, max: f64| {
        (Tree::constant(min as f32) - axis.clone()).max(axis - max as f32)
    };
    side(x, bounds.min.x, bounds.max.x)
        .max(side(y, bounds.min.y, bounds.max.y))
        .max(side(z, bounds.min.z, bounds.max.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use isocontour::expand;

    #[test]
    fn quarter_turns_are_exact() {
        let m = rotation([90.0, 0.0, 0.0]);
        assert_eq!(m * DVec3::Y, DVec3::Z);
        let m = rotation([0.0, 90.0, 0.0]);
        assert_eq!(m * DVec3::Z, DVec3::X);
        let m = rotation([0.0, 0.0, -270.0]);
        assert_eq!(m * DVec3::X, DVec3::Y);
        // The rotation about x comes first, then that about z.
        let m = rotation([90.0, 0.0, 90.0]);
        assert_eq!(m * DVec3::Y, DVec3::Z);
        assert_eq!(m * DVec3::X, DVec3::Y);
    }

    #[test]
    fn a_quarter_turn_leaves_no_products_behind() {
        let (x, y, z) = Tree::axes();
        let tree = x.abs().max(y.abs() - 1.0).max(z.abs() - 2.0) - 1.0;
        let turned = mapped(&tree, rotation([0.0, 0.0, 90.0]), 1.0);
        let plain = expand(&tree).unwrap().0.len();
        let size = expand(&turned).unwrap().0.len();
        // The zeros vanish on import. What is left is at most a few constants
        // and one sign.
        assert!(size <= plain + 4, "{size} from {plain}");
    }
}
