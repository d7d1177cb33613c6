//! The walk over the tiles of a slab.

use super::axis::{Axis, Grouping, Level};
use super::expr::Expr;
use super::split::{Axes, Split};
use super::workspace::{Proof, Workspace};
use super::{
    Batch, FieldError, LEAF, Lattice, Leaf, SLAB, Sampler, Visit, apart,
};
use crate::cancel::Cancel;
use std::ops::Range;

/// Cells along the side of a slab's tiles. A tile spans all layers of the slab.
const TILE: usize = 64;
/// Cells along the side of a tile's blocks.
const BLOCK: usize = 32;
/// Layers of a block.
const BLOCK_LAYERS: usize = 8;

/// Boxes along x and y. The cell around a tile or block belongs to its proof,
/// so that its simpler expression also serves for a corner just outside.
const IN_PLANE: [Grouping; 3] = [
    Grouping::of_cells(TILE, 1),
    Grouping::of_cells(BLOCK, 1),
    Grouping::of_cells(LEAF, 0),
];

/// Boxes along z. They reach from just below the first of their layers to just
/// above the last one, since a layer may be what is there.
const UPWARDS: [Grouping; 3] = [
    Grouping::of_layers(SLAB),
    Grouping::of_layers(BLOCK_LAYERS),
    Grouping::of_layers(1),
];

/// An expression on a lattice, with what follows from these alone, before any
/// layer.
pub(super) struct Engine {
    split: Split,
    x: Axis,
    y: Axis,
}

impl Engine {
    /// Evaluates along the lattice what one coordinate decides.
    pub(super) fn new(split: Split, lattice: &Lattice) -> Engine {
        let density = 1.0 / lattice.spacing;
        let make = |nodes: &[f32], parts| {
            Axis::new(nodes.to_vec(), density, IN_PLANE, |_| 0.0, parts)
        };
        Engine {
            x: make(&lattice.x, &split.parts[0]),
            y: make(&lattice.y, &split.parts[1]),
            split,
        }
    }

    fn layers(&self, z: &[f32]) -> Axis {
        Axis::new(z.to_vec(), 0.0, UPWARDS, apart, &self.split.parts[2])
    }

    /// The whole expression.
    fn root(&self) -> Expr {
        Expr::new(self.split.f.clone())
    }

    fn walk<'a>(&'a self, layers: &'a Axis, cancel: &'a Cancel) -> Walk<'a> {
        Walk {
            cancel,
            axes: Axes([&self.x, &self.y, layers]),
            cells: [&self.x, &self.y].map(|axis| axis.nodes().len() - 1),
            ws: Workspace::new(&self.split),
            boxes: Vec::new(),
            leaves: Vec::new(),
            values: Vec::new(),
        }
    }
}

/// A walk over the tiles of a slab.
struct Walk<'a> {
    cancel: &'a Cancel,
    axes: Axes<'a>,
    /// Cells of the lattice along x and y.
    cells: [usize; 2],
    ws: Workspace<'a>,
    /// The leaves of a block that are to be sampled.
    boxes: Vec<[usize; 3]>,
    leaves: Vec<Leaf>,
    values: Vec<f32>,
}

/// A batch's expression with the thread's workspace.
struct ExprSampler<'w, 'a> {
    expr: &'w Expr,
    cancel: &'w Cancel,
    ws: &'w mut Workspace<'a>,
    axes: Axes<'a>,
}

impl Sampler for ExprSampler<'_, '_> {
    fn values(
        &mut self,
        at: [&[f32]; 3],
        out: &mut Vec<f32>,
    ) -> Result<(), FieldError> {
        self.cancel.check()?;
        self.ws.values(self.expr, self.axes, at, out);
        Ok(())
    }

    fn slopes(&mut self, at: [&[f32]; 3], out: &mut Vec<[f32; 3]>) {
        self.ws.slopes(self.expr, self.axes, at, out);
    }
}

impl Walk<'_> {
    /// Numbers of the smaller boxes in box `b` of an axis with `count` of its
    /// smallest units.
    fn inside(
        b: usize,
        big: usize,
        small: usize,
        count: usize,
    ) -> Range<usize> {
        let end = ((b + 1) * big).min(count);
        b * big / small..end.div_ceil(small)
    }

    /// Number of the tiles' rows.
    fn rows(&self) -> usize {
        self.cells[1].div_ceil(TILE)
    }

    /// True if the field reads no z in a tile, or has no outline there.
    fn is_level(
        &mut self,
        root: &Expr,
        at: [usize; 3],
    ) -> Result<bool, FieldError> {
        let proof = self.ws.prove(root, self.axes, Level::Tile, at, true)?;
        let Proof::Ambiguous(own) = proof else {
            return Ok(true);
        };
        let is_level = self.ws.is_level(own.as_ref().unwrap_or(root));
        self.ws.recycle(own);
        Ok(is_level)
    }

    /// The tiles of some rows in which the field may change its sign.
    fn tiles(
        &mut self,
        root: &Expr,
        rows: Range<usize>,
    ) -> Result<Vec<[usize; 3]>, FieldError> {
        let columns = self.cells[0].div_ceil(TILE);
        let mut tiles: Vec<[usize; 3]> = rows
            .flat_map(|j| (0..columns).map(move |i| [i, j, 0]))
            .collect();
        self.ws.sift(root, self.axes, Level::Tile, &mut tiles)?;
        Ok(tiles)
    }

    /// Simplifies for tile number `at` of the slab, then looks at its blocks.
    fn tile(
        &mut self,
        root: &Expr,
        at: [usize; 2],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let [i, j] = at;
        let proof =
            self.ws
                .prove(root, self.axes, Level::Tile, [i, j, 0], true)?;
        let own = match proof {
            Proof::Uniform => return Ok(()),
            Proof::Ambiguous(simpler) => simpler,
        };
        let expr = own.as_ref().unwrap_or(root);
        let layers = self.axes.0[2].nodes().len();
        let level = self.ws.is_level(expr);
        let rows = if level { 1 } else { layers };
        let mut blocks = Vec::new();
        for k in 0..rows.div_ceil(BLOCK_LAYERS) {
            for j in Self::inside(j, TILE, BLOCK, self.cells[1]) {
                let row = Self::inside(i, TILE, BLOCK, self.cells[0]);
                blocks.extend(row.map(|i| [i, j, k]));
            }
        }
        self.ws.sift(expr, self.axes, Level::Block, &mut blocks)?;
        for at in blocks {
            self.block(expr, at, level.then_some(layers), visit)?;
        }
        self.ws.recycle(own);
        Ok(())
    }

    /// Simplifies for block number `at`, then samples its leaves. These stand
    /// for `span` layers if the `parent` does not read z.
    fn block(
        &mut self,
        parent: &Expr,
        at: [usize; 3],
        span: Option<usize>,
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        self.cancel.check()?;
        let [i, j, k] = at;
        let proof = self.ws.prove(parent, self.axes, Level::Block, at, true)?;
        let own = match proof {
            Proof::Uniform => return Ok(()),
            Proof::Ambiguous(simpler) => simpler,
        };
        let expr = own.as_ref().unwrap_or(parent);
        let layers = self.axes.0[2].nodes().len();
        let mut own_layers = Self::inside(k, BLOCK_LAYERS, 1, layers);
        let alike = self.ws.is_level(expr).then_some(own_layers.len());
        let span = span.or(alike);
        if span.is_some() {
            own_layers.end = own_layers.start + 1;
        }
        let mut boxes = std::mem::take(&mut self.boxes);
        boxes.clear();
        for layer in own_layers {
            for j in Self::inside(j, BLOCK, LEAF, self.cells[1]) {
                let row = Self::inside(i, BLOCK, LEAF, self.cells[0]);
                boxes.extend(row.map(|i| [i, j, layer]));
            }
        }
        self.ws.sift(expr, self.axes, Level::Leaf, &mut boxes)?;
        self.leaves.clear();
        self.leaves.extend(boxes.iter().map(|&[i, j, layer]| Leaf {
            layer,
            i: i * LEAF,
            j: j * LEAF,
        }));
        self.boxes = boxes;
        self.sample(expr, span.unwrap_or(1), visit)?;
        self.ws.recycle(own);
        Ok(())
    }

    /// Evaluates the nodes of all leaves in the buffer at once and passes them
    /// to the visitor. Each leaf stands for `span` layers.
    fn sample(
        &mut self,
        expr: &Expr,
        span: usize,
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        if self.leaves.is_empty() {
            return Ok(());
        }
        let (ws, axes) = (&mut self.ws, self.axes);
        ws.leaves(expr, axes, &self.leaves, &mut self.values);
        visit(Batch {
            leaves: &self.leaves,
            span,
            values: &self.values,
            sampler: &mut ExprSampler {
                expr,
                cancel: self.cancel,
                ws,
                axes,
            },
        })
    }
}

impl Engine {
    pub(super) fn slab(
        &self,
        z: &[f32],
        cancel: &Cancel,
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let z = &z[..z.len().min(SLAB)];
        if z.is_empty() {
            return Ok(());
        }
        let layers = self.layers(z);
        let mut walk = self.walk(&layers, cancel);
        let root = self.root();
        let rows = 0..walk.rows();
        for [i, j, _] in walk.tiles(&root, rows)? {
            walk.tile(&root, [i, j], visit)?;
        }
        Ok(())
    }

    /// True if proofs of whole tiles show that the layers of a slab are alike.
    pub(super) fn is_level(
        &self,
        z: &[f32],
        cancel: &Cancel,
    ) -> Result<bool, FieldError> {
        let layers = self.layers(z);
        let mut walk = self.walk(&layers, cancel);
        let root = self.root();
        // The first tile that is not level ends the search.
        for row in 0..walk.rows() {
            cancel.check()?;
            for at in walk.tiles(&root, row..row + 1)? {
                if !walk.is_level(&root, at)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    pub(super) fn leaves(
        &self,
        z: &[f32],
        leaves: &[Leaf],
        cancel: &Cancel,
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        if z.is_empty() {
            return Ok(());
        }
        let layers = self.layers(z);
        let mut walk = self.walk(&layers, cancel);
        walk.leaves = leaves.to_vec();
        walk.sample(&self.root(), 1, visit)
    }
}
