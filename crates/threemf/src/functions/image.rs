//! Stacks of pictures, as functions.
//!
//! ```text
//!   v ▲  row 0          A sheet is a PNG file. u leads along its rows, v from
//!     │  row 1          its last row to its first, and w from sheet to sheet.
//!     └──────▶ u        The stack lies from 0 to 1 along each.
//! ```

use crate::package::Package;
use crate::xml::Element;
use glam::DVec3;
use isoslice_mesh::MeshError;
use isoslice_pictures::{
    Axes, Border, Interpolation, Numbers, Volume, VolumeOptions,
};
use png::{BitDepth, Decoder, Limits, Transformations};
use std::io::{Cursor, Read, Seek};

/// Greatest number of pixels of a stack. Each takes two bytes.
pub(crate) const MOST_PIXELS: usize = 1 << 28;
/// Greatest memory for a whole sheet, bytes.
const MOST_DECODED: usize = 1 << 29;
/// Greatest length of a sheet's file, bytes.
pub(crate) const MOST_FILE: u64 = 1 << 28;

/// A stack of pictures.
#[derive(Debug)]
pub(crate) struct Stack {
    rows: usize,
    columns: usize,
    count: usize,
    pub sheets: Vec<String>,
}

/// A function of a stack.
#[derive(Clone, Debug)]
pub(crate) struct ImageFunction {
    pub image: u32,
    pub offset: f64,
    pub scale: f64,
    interpolation: Interpolation,
    border: [Border; 3],
}

/// What of a picture is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Red,
    Green,
    Blue,
    Alpha,
}

impl Channel {
    pub(crate) fn of(name: &str) -> Option<Channel> {
        match name {
            "red" => Some(Channel::Red),
            "green" => Some(Channel::Green),
            "blue" => Some(Channel::Blue),
            "alpha" => Some(Channel::Alpha),
            _ => None,
        }
    }
}

impl ImageFunction {
    /// What of its stack it reads, and how: functions for which that is the same
    /// have their numbers in common, before they are scaled.
    pub(crate) fn read_as(&self, channel: Channel) -> String {
        format!("{channel:?}, {:?}, {:?}", self.interpolation, self.border)
    }
}

impl Stack {
    pub(crate) fn new(element: &Element) -> Result<Stack, MeshError> {
        let stack = Stack {
            rows: element.number("rowcount")?,
            columns: element.number("columncount")?,
            count: element.number("sheetcount")?,
            sheets: Vec::new(),
        };
        let pixels = stack
            .rows
            .checked_mul(stack.columns)
            .and_then(|n| n.checked_mul(stack.count));
        match pixels {
            Some(0) => Err(element.wrong("it has no pixels")),
            Some(n) if n <= MOST_PIXELS => Ok(stack),
            _ => Err(element
                .wrong("it has more than 268 million pixels; scale it down")),
        }
    }

    pub(crate) fn add(&mut self, element: &Element) -> Result<(), MeshError> {
        let path = element.text("path")?;
        let path = path.ok_or_else(|| element.wrong("it has no path"))?;
        if self.sheets.len() >= self.count {
            return Err(element.wrong("more sheets than its stack has"));
        }
        self.sheets.push(path);
        Ok(())
    }

    /// A channel of the stack as a function of u, v and w, from 0 to 65535.
    pub(crate) fn channel<R: Read + Seek>(
        &self,
        name: &str,
        package: &mut Package<R>,
        function: &ImageFunction,
        channel: Channel,
    ) -> Result<Volume, MeshError> {
        if self.sheets.len() != self.count {
            return Err(MeshError::File(format!(
                "a stack of {} sheets names {} of them",
                self.count,
                self.sheets.len()
            )));
        }
        let mut numbers = Vec::new();
        for path in &self.sheets {
            isoslice_base::limits::go_on()?;
            let mut bytes = Vec::new();
            let found = package.with(path, |source| {
                source.take(MOST_FILE).read_to_end(&mut bytes)?;
                Ok(())
            })?;
            if found.is_none() {
                return Err(MeshError::at(path, "there is no such file"));
            }
            let sheet = self.sheet(&bytes, channel);
            numbers.extend(sheet.map_err(|what| MeshError::at(path, what))?);
        }
        let size = [self.columns, self.rows, self.count].map(|n| n as f64);
        let spacing = DVec3::from_array(size).recip();
        let options = VolumeOptions {
            spacing_mm: Some(spacing),
            origin_mm: Some(0.5 * spacing),
            axes: Axes::Zyx,
            interpolation: function.interpolation,
            border: function.border,
            missing: None,
        };
        let shape = [self.count, self.rows, self.columns];
        Volume::from_numbers(name, &shape, Numbers::U16(numbers), &options)
            .map_err(|e| MeshError::File(e.problem().to_owned()))
    }

    /// A channel of a sheet, the last row first.
    fn sheet(
        &self,
        bytes: &[u8],
        channel: Channel,
    ) -> Result<Vec<u16>, String> {
        let limits = Limits {
            bytes: MOST_DECODED,
        };
        let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
        decoder.set_transformations(Transformations::EXPAND);
        let broken = |e: png::DecodingError| format!("no sound PNG ({e})");
        let mut reader = decoder.read_info().map_err(broken)?;
        let (width, height) = (reader.info().width, reader.info().height);
        if (width as usize, height as usize) != (self.columns, self.rows) {
            return Err(format!(
                "it has {width} × {height} pixels, and its stack {} × {}",
                self.columns, self.rows
            ));
        }
        let (colours, depth) = reader.output_color_type();
        let needed = reader.output_buffer_size().unwrap_or(usize::MAX);
        if needed > MOST_DECODED {
            return Err("it takes more than 512 MB".to_owned());
        }
        let mut decoded = vec![0; needed];
        reader.next_frame(&mut decoded).map_err(broken)?;
        let channels = colours.samples();
        let wide = depth == BitDepth::Sixteen;
        let size = channels * if wide { 2 } else { 1 };
        // Grey stands for all three colours.
        let at = match (channel, channels) {
            (Channel::Alpha, 2 | 4) => Some(channels - 1),
            (Channel::Alpha, _) => None,
            (Channel::Red, _) | (_, 1 | 2) => Some(0),
            (Channel::Green, _) => Some(1),
            (Channel::Blue, _) => Some(2),
        };
        let value = |pixel: &[u8]| match (at, wide) {
            (None, _) => u16::MAX,
            (Some(c), true) => {
                u16::from_be_bytes([pixel[2 * c], pixel[2 * c + 1]])
            }
            (Some(c), false) => u16::from(pixel[c]) * 257,
        };
        let rows = decoded.chunks_exact(size * self.columns).rev();
        Ok(rows
            .flat_map(|row| row.chunks_exact(size).map(value))
            .collect())
    }
}

impl ImageFunction {
    pub(crate) fn new(element: &Element) -> Result<ImageFunction, MeshError> {
        // Drafts have other names for the same.
        let number = |names: [&str; 2], usual: f64| -> Result<f64, MeshError> {
            for name in names {
                if element.text(name)?.is_some() {
                    return element.number(name);
                }
            }
            Ok(usual)
        };
        let filters = [
            ("linear", Interpolation::Linear),
            ("nearest", Interpolation::Nearest),
        ];
        let interpolation = element.word("filter", "filter", &filters)?;
        let styles = [
            ("wrap", Border::Repeat),
            ("mirror", Border::Mirror),
            ("clamp", Border::Clamp),
        ];
        let mut border = [Border::Repeat; 3];
        let names = ["tilestyleu", "tilestylev", "tilestylew"];
        for (border, name) in border.iter_mut().zip(names) {
            let style = element.word(name, "style of tiles", &styles)?;
            *border = style.unwrap_or(*border);
        }
        let image = if element.text("image3Did")?.is_some() {
            "image3Did"
        } else if element.text("image3dID")?.is_some() {
            "image3dID"
        } else {
            "image3did"
        };
        let (scale, offset) = (
            number(["valuescale", "scale"], 1.0)?,
            number(["valueoffset", "offset"], 0.0)?,
        );
        if !scale.is_finite() || !offset.is_finite() {
            return Err(element.wrong("its scale or offset is not finite"));
        }
        Ok(ImageFunction {
            image: element.number(image)?,
            offset,
            scale,
            interpolation: interpolation.unwrap_or(Interpolation::Linear),
            border,
        })
    }
}
