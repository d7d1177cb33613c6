//! The z plan: which layers there are, and at which height each is sampled.
//!
//! In: the part's height and the two layer heights. Out: contiguous spans
//! from the bed up. The outline of a layer is the field at its mid-plane, so
//! a layer neither gains nor loses material on average; the stack ends within
//! half a layer of the part's top.

use crate::units::Mm;

/// One layer: the slab of space between `bottom` and `top`, in print
/// coordinates (z = 0 is the bed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerSpan {
    /// Number of the layer, from 0.
    pub index: usize,
    /// Lower face.
    pub bottom: Mm,
    /// Upper face, at which the nozzle runs.
    pub top: Mm,
}

impl LayerSpan {
    /// Thickness of the layer.
    pub fn height(&self) -> Mm {
        self.top - self.bottom
    }

    /// The plane whose outline the layer prints: its middle.
    pub fn sample_z(&self) -> Mm {
        0.5 * (self.bottom + self.top)
    }
}

/// Why there is no z plan.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PlanError {
    /// The part is thinner than half its first layer.
    #[error(
        "the part is {height:.3} mm high, less than half the first layer \
         ({first:.3} mm): nothing would be printed; scale it up with --size \
         or --scale, or lower first_layer_height"
    )]
    TooFlat {
        /// Height of the part, mm.
        height: Mm,
        /// First layer's height, mm.
        first: Mm,
    },
    /// More layers than anybody prints.
    #[error(
        "{count:.0} layers of {layer:.3} mm: more than the limit of \
         {MAX_LAYERS}; raise layer_height or scale the part down"
    )]
    TooMany {
        /// How many layers it would be.
        count: f64,
        /// Layer height, mm.
        layer: Mm,
    },
}

/// A metre of the thinnest layers anybody prints (0.02 mm).
pub const MAX_LAYERS: usize = 50_000;

/// Layers of a part `height` high standing on the bed: one of `first`, then
/// uniform ones of `layer`, as many as bring the top nearest to the part's.
///
/// # Errors
/// If the part is too flat for a single layer, or has too many.
pub fn plan(
    height: Mm,
    first: Mm,
    layer: Mm,
) -> Result<Vec<LayerSpan>, PlanError> {
    // A rounding error of the bounds must not add a layer to a part whose
    // height is a whole number of layers and a half.
    const SLACK: f64 = 1e-6;
    if height < 0.5 * first {
        return Err(PlanError::TooFlat { height, first });
    }
    let above = ((height - first) / layer - SLACK).round().max(0.0);
    if above >= MAX_LAYERS as f64 {
        return Err(PlanError::TooMany {
            count: above + 1.0,
            layer,
        });
    }
    let top = |i: usize| first + layer * i as f64;
    Ok((0..=above as usize)
        .map(|index| LayerSpan {
            index,
            bottom: if index == 0 { 0.0 } else { top(index - 1) },
            top: top(index),
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_contiguous_and_end_within_half_a_layer() {
        for i in 1..400 {
            let height = 0.1 + 0.037 * f64::from(i);
            let spans = plan(height, 0.3, 0.2).unwrap_or_default();
            let Some(last) = spans.last() else {
                assert!(height < 0.15);
                continue;
            };
            assert!((last.top - height).abs() <= 0.151, "{height}");
            for w in spans.windows(2) {
                assert!((w[0].top - w[1].bottom).abs() < 1e-12);
                assert!((w[1].height() - 0.2).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_whole_number_of_layers_is_kept() {
        assert_eq!(plan(20.00004, 0.2, 0.2).map(|s| s.len()), Ok(100));
        assert_eq!(plan(19.99996, 0.2, 0.2).map(|s| s.len()), Ok(100));
    }

    #[test]
    fn too_flat_and_too_high_are_errors() {
        assert!(matches!(
            plan(0.05, 0.2, 0.2),
            Err(PlanError::TooFlat { .. })
        ));
        assert!(matches!(
            plan(1e9, 0.2, 0.2),
            Err(PlanError::TooMany { .. })
        ));
    }
}
