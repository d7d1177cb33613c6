//! Sizes of pictures: `32x32, 300x300`.

use super::Key;
use super::value::{Kind, Raw, Refused, Value};

/// Greatest side of a picture in a file, pixels: no host shows a larger one,
/// and the text of one is a megabyte.
const GREATEST: u32 = 1024;

/// Greatest number of pictures in a file.
const MOST: usize = 8;

/// What may be assigned.
pub(super) const EXPECTED: &str = "sizes in pixels, width x height, such as \
    \"32x32, 300x300\" (up to 8, each side from 1 to 1024), or \"\" for none";

/// Sizes of pictures, in pixels: width, height.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sizes(Vec<[u32; 2]>);

impl Sizes {
    /// What hosts and printers' screens show.
    pub(super) fn thumbnails() -> Self {
        Sizes(vec![[32, 32], [300, 300]])
    }

    /// The sizes, in the order given.
    pub fn all(&self) -> &[[u32; 2]] {
        &self.0
    }

    fn read(text: &str) -> Option<Self> {
        if text.trim().is_empty() {
            return Some(Sizes::default());
        }
        let sizes: Option<Vec<[u32; 2]>> = text.split(',').map(size).collect();
        sizes.filter(|all| all.len() <= MOST).map(Sizes)
    }
}

fn size(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.trim().split_once(['x', 'X', '×'])?;
    let side = |text: &str| -> Option<u32> {
        let side = text.trim().parse().ok()?;
        (1..=GREATEST).contains(&side).then_some(side)
    };
    Some([side(width)?, side(height)?])
}

impl Value for Sizes {
    fn assign(&mut self, raw: Raw<'_>, _: &Key) -> Result<(), Refused> {
        *self = match raw {
            Raw::Text(text) | Raw::Word(text) => {
                Sizes::read(text).ok_or(Refused::Type)?
            }
            _ => return Err(Refused::Type),
        };
        Ok(())
    }

    fn to_toml(&self) -> String {
        let sizes = self.0.iter().map(|[w, h]| format!("{w}x{h}"));
        format!("\"{}\"", sizes.collect::<Vec<_>>().join(", "))
    }

    fn number(&self) -> Option<f64> {
        None
    }

    fn kind(&self) -> Kind {
        Kind::Sizes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_refused() {
        assert_eq!(
            Sizes::read(" 16x16 ,220X124").map(|s| s.0),
            Some(vec![[16, 16], [220, 124]])
        );
        assert_eq!(Sizes::read(" ").map(|s| s.0), Some(vec![]));
        for bad in ["16", "16x", "0x16", "16x1025", "16x16,", "-1x1", "axb"] {
            assert_eq!(Sizes::read(bad), None, "{bad}");
        }
        assert_eq!(Sizes::read(&["8x8"; 9].join(",")), None);
    }
}
