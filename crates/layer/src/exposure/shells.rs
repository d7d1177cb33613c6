//! How many layers a shell of a thickness has.
//!
//! Where their number is set, it is the same everywhere. Otherwise it is the
//! least number of layers that are as thick as asked for, layer by layer.

use isoslice_base::units::Mm;
use isoslice_settings::THICKNESS_SLACK;
use isoslice_settings::layers::LayerSpan;

/// Layers of the shells on one side.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shells {
    /// This many layers, everywhere.
    Alike(usize),
    /// For each layer, this many layers from it on, counting itself.
    Each(Vec<usize>),
}

impl Shells {
    /// The fewest layers as thick as `thickness`, from each layer upwards (or
    /// else downwards) to a face; a layer itself counts as one of them. A face
    /// is the far side of a layer, so the layer itself is in its shell if what
    /// lies between is too thin. There are none if the thickness is 0.
    pub(super) fn of_thickness(
        spans: &[LayerSpan],
        thickness: Mm,
        upwards: bool,
    ) -> Shells {
        let asked = thickness - THICKNESS_SLACK;
        if thickness <= 0.0 {
            return Shells::Alike(0);
        }
        let count = |i: usize| {
            let (below, above) = spans.split_at(i);
            let here = &spans[i];
            let others = if upwards {
                above.partition_point(|s| s.top - here.top < asked)
            } else {
                let thick = |s: &LayerSpan| here.bottom - s.bottom >= asked;
                1 + below.len() - below.partition_point(thick)
            };
            others.max(1)
        };
        Shells::Each((0..spans.len()).map(count).collect())
    }

    /// The layers of a shell from a layer on.
    pub(super) fn at(&self, number: usize) -> usize {
        match self {
            Shells::Alike(count) => *count,
            Shells::Each(counts) => counts.get(number).copied().unwrap_or(1),
        }
    }

    /// The greatest number of layers.
    pub(super) fn most(&self) -> usize {
        match self {
            Shells::Alike(count) => *count,
            Shells::Each(counts) => counts.iter().copied().max().unwrap_or(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans(heights: &[Mm]) -> Vec<LayerSpan> {
        let mut top = 0.0;
        let spans = heights.iter().enumerate().map(|(index, height)| {
            let bottom = top;
            top += height;
            LayerSpan { index, bottom, top }
        });
        spans.collect()
    }

    #[test]
    fn layers_of_one_height_are_as_many_as_the_thickness_takes() {
        for (height, thickness, count) in [
            (0.2, 0.8, 4),
            (0.3, 0.8, 3),
            (0.3, 0.605, 2),
            (0.3, 0.615, 3),
        ] {
            let spans = spans(&[height; 20]);
            let up = Shells::of_thickness(&spans, thickness, true);
            let down = Shells::of_thickness(&spans, thickness, false);
            assert_eq!([0, 10].map(|i| up.at(i)), [count; 2]);
            assert_eq!([19, 10].map(|i| down.at(i)), [count; 2]);
            // The part ends: all layers left are in the shell.
            assert_eq!([18, 19].map(|i| up.at(i)), [2, 1]);
            assert_eq!([0, 1].map(|i| down.at(i)), [1, 2]);
        }
    }

    /// Whatever the heights, the layers in the shell of each face are as thick
    /// as asked for, and one fewer would not be.
    #[test]
    fn no_face_has_a_shell_thinner_than_asked_or_a_layer_too_many() {
        let heights: Vec<Mm> =
            (0..60).map(|i| 0.1 + 0.05 * f64::from(i * 7 % 5)).collect();
        let spans = spans(&heights);
        let n = spans.len();
        for thickness in [0.05, 0.6, 0.8, 1.23] {
            let up = Shells::of_thickness(&spans, thickness, true);
            let down = Shells::of_thickness(&spans, thickness, false);
            for face in 10..n - 10 {
                // Layer i is in the shell below the top of layer `face` if its
                // count reaches up to that layer.
                let tops = (0..=face).filter(|&i| i + up.at(i) > face);
                let bottoms = (face..n).filter(|&i| i < face + down.at(i));
                for shell in [tops.collect(), bottoms.collect::<Vec<_>>()] {
                    let all = shell.iter().map(|&i| heights[i]);
                    let is: Mm = all.sum();
                    assert!(is >= thickness - 0.01, "{is} {thickness}");
                    let far = if shell.contains(&(face - 1)) {
                        shell[0]
                    } else {
                        shell[shell.len() - 1]
                    };
                    let less = is - heights[far];
                    assert!(less < thickness - 0.01 + 1e-9, "{less}");
                }
            }
            assert!(up.most() >= 1 && down.most() >= 1);
        }
        assert_eq!(Shells::of_thickness(&spans, 0.0, true).most(), 0);
    }
}
