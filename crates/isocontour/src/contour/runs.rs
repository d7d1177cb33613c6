//! The chains of a slab's layers. Layers that are alike share theirs.
//!
//! ```text
//!   layer 3  ┐             All layers are one run to begin with. Leaves that do
//!   layer 2  ┘ run 2…3     not stand for all of a run divide it: the part above
//!   layer 1  ┐             goes on with a copy of what was found so far. So the
//!   layer 0  ┘ run 0…1     outline of a prism is found and joined once.
//! ```

use super::link::Chains;
use std::ops::Range;

/// The chains of the runs.
pub(super) struct Runs {
    /// For each layer its chains, if a run begins with it.
    chains: Vec<Option<Chains>>,
}

impl Runs {
    /// One run of `count` layers, without any outline.
    pub(super) fn new(count: usize) -> Runs {
        let mut chains: Vec<Option<Chains>> = Vec::new();
        chains.resize_with(count, || None);
        if let Some(first) = chains.first_mut() {
            *first = Some(Chains::default());
        }
        Runs { chains }
    }

    /// Lets a run begin with `layer`.
    pub(super) fn divide(&mut self, layer: usize) {
        if let Some(None) = self.chains.get(layer) {
            let below = self.chains[..layer].iter().rev();
            self.chains[layer] = below.flatten().next().cloned();
        }
    }

    /// The runs' layers.
    pub(super) fn all(&self) -> Vec<Range<usize>> {
        let begins = self.firsts(0..self.chains.len());
        let ends = begins[1.min(begins.len())..].iter().copied();
        let ends = ends.chain([self.chains.len()]);
        begins
            .iter()
            .zip(ends)
            .map(|(&from, to)| from..to)
            .collect()
    }

    /// The layers with which a run begins, among some.
    pub(super) fn firsts(&self, layers: Range<usize>) -> Vec<usize> {
        layers.filter(|&k| self.chains[k].is_some()).collect()
    }

    /// The chains of the run that begins with `layer`, made empty if none does.
    pub(super) fn at(&mut self, layer: usize) -> &mut Chains {
        self.chains[layer].get_or_insert_default()
    }
}
