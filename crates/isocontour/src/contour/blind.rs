//! Notices planes in which the field does not tell inside from outside.
//!
//! ```text
//!        ┌───────┐        Where a level face lies exactly in a layer's plane,
//!        │       │        the field is 0 all over the face: not below zero,
//!   ┄┄┌──┴───────┴──┐┄┄   so nothing would be inside, although two bodies may
//!     │             │     meet there. What is just above the plane or just
//!     │             │     below it then belongs to the layer.
//! ```
//!
//! Some fields, such as min(f, 0), are 0 all over their outside. There the
//! values do not tell how far the outline is, and a place where the field is 0
//! need not be on it.
//!
//! A plane is judged by those of its nodes whose values are next to nothing, if
//! the field is as level there as it is on a level face. So fields that have no
//! such nodes cost nothing. What is done about such planes is up to the caller.
//!
//! Not guaranteed: that a face without any node in it is noticed.

use super::samples::Eyes;
use crate::field::{FieldError, Leaf, NODES, apart};
use glam::DVec2;
use std::ops::Range;

/// Why the field in a plane does not tell inside from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Blind {
    /// A level face lies in the plane.
    pub face: bool,
    /// The field is 0 all over a part of space.
    pub void: bool,
}

impl Blind {
    /// The plane is not blind.
    pub(super) const NOT: Blind = Blind {
        face: false,
        void: false,
    };

    /// All reasons of two.
    pub(super) fn or(self, other: Blind) -> Blind {
        Blind {
            face: self.face || other.face,
            void: self.void || other.void,
        }
    }

    /// The reasons of one that another one has, too.
    pub(super) fn and(self, other: Blind) -> Blind {
        Blind {
            face: self.face && other.face,
            void: self.void && other.void,
        }
    }
}

/// Greatest value of a node that is next to nothing, as a share of the greatest
/// value in its leaf. On a face it is a rounding error. Hardly any node beside
/// an outline is as close to it: a thousandth of a cell.
const NOTHING: f32 = 1e-4;
/// Greatest number of nodes of a leaf that are looked at. Each is asked for at six
/// points, so 8 of them cost about half as much as the leaf's own 81 nodes. Where
/// a face lies in the plane, they are spread over it.
const MOST_NODES: usize = 8;
/// Distance of the points beside a node in its plane, in distances of the
/// planes above and below ([`apart`]): up to there the field of a level face
/// changes by roundings only, and less than from plane to plane. A surface that
/// leans by 0.6° changes as much.
const ACROSS: f32 = 100.0;

/// The points beside a node at which the field is asked, in these distances:
/// four in its plane, then those above and below it.
const BESIDE: [[f32; 3]; 6] = [
    [-ACROSS, 0.0, 0.0],
    [ACROSS, 0.0, 0.0],
    [0.0, -ACROSS, 0.0],
    [0.0, ACROSS, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
];

/// The nodes of a leaf, at most [`MOST_NODES`] of them, whose values are next to
/// nothing.
fn suspects(values: &[f32]) -> impl Iterator<Item = usize> {
    let (mut least, mut most) = (f32::INFINITY, 0.0);
    for v in values {
        let size = v.abs();
        least = if size < least { size } else { least };
        let finite = size < f32::INFINITY;
        most = if finite && size > most { size } else { most };
    }
    let nothing = NOTHING * most;
    let values = if least <= nothing { values } else { &[] };
    let small = move |v: &f32| v.abs() <= nothing;
    let count = values.iter().filter(|v| small(v)).count();
    let small = values.iter().enumerate().filter(move |(_, v)| small(v));
    small
        .step_by(count.div_ceil(MOST_NODES).max(1))
        .map(|(k, _)| k)
}

/// What a node with the value `f` says of its plane, given the field beside it.
fn judge(f: f32, beside: [f32; 6]) -> Blind {
    let [west, east, south, north, below, above] = beside;
    let void = f == 0.0 && beside.iter().all(|f| *f == 0.0);
    let change = |all: &[f32]| {
        let sizes = all.iter().map(|g| (g - f).abs());
        sizes.fold(0.0, f32::max)
    };
    let level = change(&[west, east, south, north]) <= change(&[below, above]);
    let solid = below < 0.0 || above < 0.0;
    let face = !void && level && (f == 0.0 || solid != (f < 0.0));
    Blind { face, void }
}

/// Why the planes of leaves are blind, of those whose layers are needed. Each leaf
/// stands for `span` layers. A layer may be named several times.
pub(super) fn judge_planes(
    leaves: &[Leaf],
    span: usize,
    values: &[f32],
    needed: &Range<usize>,
    eyes: &mut Eyes<'_>,
) -> Result<Vec<(usize, Blind)>, FieldError> {
    // The layer and the value of each node that is looked at.
    let mut nodes: Vec<(usize, f32)> = Vec::new();
    eyes.clear();
    let of_leaf = values.chunks_exact(NODES * NODES);
    for (leaf, values) in leaves.iter().zip(of_leaf) {
        let span = leaf.layer..leaf.layer + span;
        if span.end <= needed.start || needed.end <= span.start {
            continue;
        }
        let z = eyes.z[leaf.layer];
        let apart = apart(z);
        for k in suspects(values) {
            nodes.push((leaf.layer, values[k]));
            let x = eyes.lattice.x[leaf.i + k % NODES];
            let y = eyes.lattice.y[leaf.j + k / NODES];
            for [dx, dy, dz] in BESIDE {
                let [x, y] = [x + dx * apart, y + dy * apart].map(f64::from);
                eyes.push(DVec2::new(x, y), z + dz * apart);
            }
        }
    }
    let beside = eyes.values()?.as_chunks().0;
    let judged = nodes.iter().zip(beside);
    let judged = judged.map(|(&(layer, f), beside)| (layer, judge(f, *beside)));
    Ok(judged.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACE: Blind = Blind {
        face: true,
        void: false,
    };

    #[test]
    fn leaning_surfaces_through_a_node_are_not_blind() {
        // The values around a node of a field that rises by `lean` along x and
        // by 1 along z.
        let beside = |lean: f32| BESIDE.map(|[x, _, z]| 1e-4 * (lean * x + z));
        for (lean, blind) in
            [(1.0, Blind::NOT), (0.02, Blind::NOT), (0.005, FACE)]
        {
            assert_eq!(judge(0.0, beside(lean)), blind, "{lean}");
        }
    }

    #[test]
    fn faces_are_told_from_voids() {
        let shared = [0.0, 0.0, 0.0, 0.0, -1e-4, -1e-4];
        assert_eq!(judge(0.0, shared), FACE);
        let void = Blind {
            face: false,
            void: true,
        };
        assert_eq!(judge(0.0, [0.0; 6]), void);
        // A film of no thickness, which is a rounding error.
        let film = [-1e-7, 0.0, -1e-7, 0.0, 1e-4, 1e-4];
        assert_eq!(judge(-1e-7, film), FACE);
        // Solid above and below, and in the plane.
        let solid = [-1e-7, 0.0, -1e-7, 0.0, -1e-4, -1e-4];
        assert_eq!(judge(-1e-7, solid), Blind::NOT);
    }

    #[test]
    fn few_nodes_are_suspects() {
        let mut leaf = [1.0; NODES * NODES];
        assert_eq!(suspects(&leaf).count(), 0);
        leaf[7] = -1e-5;
        assert_eq!(suspects(&leaf).collect::<Vec<_>>(), [7]);
        leaf[..40].fill(0.0);
        assert_eq!(suspects(&leaf).count(), MOST_NODES);
    }
}
