//! Which fields of a script are bodies: what shapes make, and what is made of
//! shapes alone.
//!
//! `a + b` of two fields adds their values. Of two bodies, this is hardly what
//! is meant, so `operators` refuses it.

use fidget::context::{Tree, TreeOp};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The bodies of one run of a script.
#[derive(Clone, Default)]
pub(super) struct Bodies {
    /// The fields by their addresses. They are kept, so that no other field
    /// gets the address of one of them. Nothing is kept without a script.
    known: Option<Arc<Mutex<HashMap<usize, Tree>>>>,
}

fn address(tree: &Tree) -> usize {
    std::ptr::from_ref::<TreeOp>(tree).addr()
}

impl Bodies {
    /// The bodies of a script that is about to run.
    pub(super) fn of_script() -> Self {
        Self {
            known: Some(Arc::default()),
        }
    }

    /// Remembers that a field is a body.
    pub(super) fn mark(&self, tree: Tree) -> Tree {
        if let Some(known) = &self.known {
            let mut known =
                known.lock().unwrap_or_else(PoisonError::into_inner);
            known.insert(address(&tree), tree.clone());
        }
        tree
    }

    /// True if a field is a body.
    pub(super) fn has(&self, tree: &Tree) -> bool {
        self.known.as_ref().is_some_and(|known| {
            let known = known.lock().unwrap_or_else(PoisonError::into_inner);
            known.contains_key(&address(tree))
        })
    }
}
