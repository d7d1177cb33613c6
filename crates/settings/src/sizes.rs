//! Sizes of the pictures in a file's head: `32x32, 300x300/QOI`.

use super::value::{Measure, Raw, Refused, Value, ValueKind};

/// Greatest side of a picture in a file, pixels. No host shows a larger one,
/// and its text takes 1 MB.
const GREATEST: u32 = 1024;

/// Greatest number of pictures in a file.
const MOST_PICTURES: usize = 8;

/// What may be assigned.
pub(super) const EXPECTED: &str = "sizes in pixels, width x height, and \
    formats (PNG, if none is given, QOI or JPG), such as \"32x32, \
    300x300/QOI\" (up to 8, each side from 1 to 1024), or \"\" for none";

isoslice_base::named! {
    /// The format of a picture, by its name in settings and in files.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum ImageFormat {
        /// PNG, which hosts and web pages show.
        #[default]
        Png = "PNG",
        /// JPEG, which is small and has no transparency.
        Jpg = "JPG",
        /// QOI, which small processors can read: Prusa's screens, Duet's PanelDue.
        Qoi = "QOI",
    }
}

impl ImageFormat {
    fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        if text.eq_ignore_ascii_case("jpeg") {
            return Some(ImageFormat::Jpg);
        }
        ImageFormat::ALL
            .into_iter()
            .find(|f| f.name().eq_ignore_ascii_case(text))
    }
}

/// A picture that a file is to have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Width and height, pixels.
    pub pixels: [u32; 2],
    /// The picture's format.
    pub format: ImageFormat,
}

/// Sizes and formats of pictures.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sizes(Vec<PictureSize>);

impl Sizes {
    /// The sizes that most hosts show.
    pub(super) fn thumbnails() -> Self {
        let png = |side: u32| PictureSize {
            pixels: [side; 2],
            format: ImageFormat::Png,
        };
        Sizes(vec![png(32), png(300)])
    }

    /// The pictures, in the order given.
    pub fn all(&self) -> &[PictureSize] {
        &self.0
    }

    fn read(text: &str) -> Option<Self> {
        if text.trim().is_empty() {
            return Some(Sizes::default());
        }
        let sizes: Option<Vec<_>> = text.split(',').map(picture).collect();
        sizes.filter(|all| all.len() <= MOST_PICTURES).map(Sizes)
    }
}

fn picture(text: &str) -> Option<PictureSize> {
    let (size, format) = match text.split_once('/') {
        Some((size, format)) => (size, ImageFormat::read(format)?),
        None => (text, ImageFormat::default()),
    };
    let (width, height) = size.trim().split_once(['x', 'X', '×'])?;
    let side = |text: &str| -> Option<u32> {
        let side = text.trim().parse().ok()?;
        (1..=GREATEST).contains(&side).then_some(side)
    };
    Some(PictureSize {
        pixels: [side(width)?, side(height)?],
        format,
    })
}

impl Value for Sizes {
    fn read(raw: Raw<'_>, _: Measure) -> Result<Self, Refused> {
        Ok(match raw {
            Raw::Text(text) | Raw::Word(text) => {
                Sizes::read(text).ok_or(Refused::Type)?
            }
            _ => return Err(Refused::Type),
        })
    }

    fn to_toml(&self) -> String {
        let sizes = self.0.iter().map(|PictureSize { pixels, format }| {
            let [w, h] = pixels;
            match format {
                ImageFormat::Png => format!("{w}x{h}"),
                _ => format!("{w}x{h}/{}", format.name()),
            }
        });
        format!("\"{}\"", sizes.collect::<Vec<_>>().join(", "))
    }

    fn kind(&self) -> ValueKind {
        ValueKind::Sizes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_formats_are_read_and_refused() {
        let written = |text: &str| Sizes::read(text).map(|s| s.to_toml());
        assert_eq!(
            written(" 16x16 /png,220X124, 640 x 480/jpeg,313x173/QOI"),
            Some("\"16x16, 220x124, 640x480/JPG, 313x173/QOI\"".into())
        );
        assert_eq!(written(" "), Some("\"\"".into()));
        for bad in [
            "16",
            "16x",
            "0x16",
            "16x1025",
            "16x16,",
            "-1x1",
            "axb",
            "16x16/",
            "16x16/gif",
            "16x16/QOI/PNG",
            "/QOI",
        ] {
            assert_eq!(Sizes::read(bad), None, "{bad}");
        }
        assert_eq!(Sizes::read(&["8x8"; 9].join(",")), None);
    }
}
