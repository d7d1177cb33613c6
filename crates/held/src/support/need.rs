//! What of a layer gets a support.
//!
//! In: what the layer below does not hold ([`overhangs`](crate::overhangs)), and what
//! `support.where` asks for. Out: what needs a support, and what is to have one.

use super::wish::Wish;
use crate::overhangs::large;
use isoslice_base::units::Mm;
use isoslice_planar::Area;
use isoslice_planar::clip::difference;

/// What of a layer gets a support.
#[derive(Clone, Debug, Default)]
pub(super) struct Need {
    /// What the layer below does not hold, without what wishes forbid.
    pub must: Area,
    /// What gets a support because of a wish.
    pub wanted: Area,
}

impl Need {
    /// What of a layer of some height gets a support. `unheld` is what the
    /// layer below does not hold.
    pub(super) fn new(unheld: Area, wish: &Wish, height: Mm) -> Need {
        let must = if wish.left.is_empty() {
            unheld
        } else {
            difference(&unheld, &wish.left)
        };
        let wanted = large(wish.held.clone(), height);
        Need { must, wanted }
    }
}
