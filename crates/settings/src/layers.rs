//! Plans the layers of a part, and the height at which each is sampled.
//!
//! In: the part's height and the two layer heights. Out: contiguous spans
//! from the bed up. The outline of a layer is the field at its mid-plane, so
//! a layer neither gains nor loses material on average; the stack ends within
//! half a layer of the part's top.

use isoslice_base::units::Mm;
use std::ops::Range;
use std::str::FromStr;

/// One layer: the slab of space between `bottom` and `top`, in print
/// coordinates (z = 0 is the bed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerSpan {
    /// Number of the layer, from 0.
    pub index: usize,
    /// Height of the lower face.
    pub bottom: Mm,
    /// Height of the upper face, at which the nozzle runs.
    pub top: Mm,
}

impl LayerSpan {
    /// Thickness of the layer, rounded to 10⁻⁹ mm: layers that are meant to be
    /// equally thick have the same number, whatever their heights above the bed
    /// round to.
    pub fn height(&self) -> Mm {
        (1e9 * (self.top - self.bottom)).round() / 1e9
    }

    /// The plane whose outline the layer prints: its middle.
    pub fn sample_z(&self) -> Mm {
        0.5 * (self.bottom + self.top)
    }

    /// So many layers of one height, from the bed up.
    pub fn stack(height: Mm, count: usize) -> Vec<LayerSpan> {
        let span = |index| LayerSpan {
            index,
            bottom: height * index as f64,
            top: height * (index + 1) as f64,
        };
        (0..count).map(span).collect()
    }
}

/// Why layers cannot be planned.
#[derive(Debug, thiserror::Error, PartialEq)]
#[non_exhaustive]
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
    /// The part has more layers than anybody prints.
    #[error(
        "{count:.0} layers of {layer:.3} mm: more than the limit of \
         {MAX_LAYERS}; raise layer_height or scale the part down"
    )]
    TooMany {
        /// Number of layers.
        count: f64,
        /// Layer height, mm.
        layer: Mm,
    },
    /// The range of layers lies above the part.
    #[error(
        "layers from {first} on were asked for, but the part has {count} \
         layers; ask for layers from 1 to {count}"
    )]
    Beyond {
        /// First layer of the range, counted from 1.
        first: usize,
        /// Number of the part's layers.
        count: usize,
    },
}

/// A range of a part's layers, counted from 1 as people do, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerRange {
    first: usize,
    last: usize,
}

impl LayerRange {
    /// All layers of any part.
    pub const ALL: LayerRange = LayerRange {
        first: 1,
        last: usize::MAX,
    };

    /// The range as indices into a plan of `count` layers. An end above the
    /// part's top is the top.
    ///
    /// # Errors
    /// If all of the range lies above the part.
    pub fn indices(self, count: usize) -> Result<Range<usize>, PlanError> {
        let first = self.first;
        if first > count {
            return Err(PlanError::Beyond { first, count });
        }
        Ok(first - 1..self.last.min(count))
    }
}

/// Reads `A..B`, `A..`, `..B` or a single number.
impl FromStr for LayerRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number =
            |text: &str, otherwise: usize| match text.trim() {
                "" => Ok(otherwise),
                text => text.parse::<usize>().ok().filter(|&n| n > 0).ok_or(
                    "write it as 10..20, 10.. or ..20; layers count from 1",
                ),
            };
        let range = match text.split_once("..") {
            Some((first, last)) => LayerRange {
                first: number(first, 1)?,
                last: number(last, usize::MAX)?,
            },
            None => {
                let only = number(text, 0)?;
                LayerRange {
                    first: only,
                    last: only,
                }
            }
        };
        if range.first == 0 || range.first > range.last {
            return Err("it has no layers: write the lower number first".into());
        }
        Ok(range)
    }
}

/// The layer at a height above the bed, or the one nearest to it, as a range;
/// an empty one if there are no layers.
pub fn layer_at(spans: &[LayerSpan], z: Mm) -> Range<usize> {
    let below = spans.partition_point(|span| span.top < z);
    let layer = below.min(spans.len().saturating_sub(1));
    layer..spans.len().min(layer + 1)
}

/// Greatest number of layers: 1 m of the thinnest ones that anybody prints
/// (0.02 mm).
pub const MAX_LAYERS: usize = 50_000;

/// Plans the layers of a part `height` high that stands on the bed: one layer
/// of height `first`, then as many of height `layer` as bring the top nearest
/// to the part's top.
///
/// # Errors
/// If the part is too flat for a single layer, or has too many.
pub fn plan(
    height: Mm,
    first: Mm,
    layer: Mm,
) -> Result<Vec<LayerSpan>, PlanError> {
    // A rounding error of the bounds must not add a layer to a part that is n +
    // 0.5 layers high.
    const ROUNDED_BOUND: f64 = 1e-6;
    if height < 0.5 * first {
        return Err(PlanError::TooFlat { height, first });
    }
    let above = ((height - first) / layer - ROUNDED_BOUND).round().max(0.0);
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
    fn ranges_count_from_one_and_include_both_ends() {
        let indices = |text: &str| {
            text.parse::<LayerRange>().unwrap().indices(20).unwrap()
        };
        assert_eq!(indices("1..20"), 0..20);
        assert_eq!(indices("3..5"), 2..5);
        assert_eq!(indices("7"), 6..7);
        assert_eq!(indices(" .. 4"), 0..4);
        assert_eq!(indices("18..99"), 17..20);
        assert_eq!(indices(".."), 0..20);
        assert_eq!(LayerRange::ALL.indices(20), Ok(0..20));
        for bad in ["", "0", "0..3", "5..4", "a..b", "1..2..3", "-1..", "..0"] {
            assert!(bad.parse::<LayerRange>().is_err(), "{bad}");
        }
        let beyond = "21..30".parse::<LayerRange>().unwrap().indices(20);
        assert!(matches!(beyond, Err(PlanError::Beyond { .. })));
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
