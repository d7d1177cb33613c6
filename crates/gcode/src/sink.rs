//! Where the text goes: into a text file, or packed into another one.

use super::Format;
use isoslice_gcode_read::bgcode;
use isoslice_gcode_read::package;
use std::io::{self, Write};

#[derive(Debug)]
pub(super) enum Sink<W: Write> {
    Text(W),
    Binary(bgcode::Packer<W>),
    Plate(package::Packer<W>),
}

impl<W: Write> Sink<W> {
    pub(super) fn new(out: W, format: Format) -> io::Result<Self> {
        Ok(match format {
            Format::Text => Sink::Text(out),
            Format::Binary => Sink::Binary(bgcode::Packer::new(out)?),
            Format::Plate => Sink::Plate(package::Packer::new(out)?),
        })
    }

    /// Ends the file. Packed files also have what stands beside the text.
    pub(super) fn finish(
        self,
        binary: impl FnOnce() -> bgcode::About,
        plate: impl FnOnce() -> package::About,
    ) -> io::Result<()> {
        match self {
            Sink::Text(mut out) => out.flush(),
            Sink::Binary(packer) => packer.finish(&binary()),
            Sink::Plate(packer) => packer.finish(&plate()),
        }
    }
}

impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Sink::Text(out) => out.write(bytes),
            Sink::Binary(packer) => packer.write(bytes),
            Sink::Plate(packer) => packer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Sink::Text(out) => out.flush(),
            Sink::Binary(packer) => packer.flush(),
            Sink::Plate(packer) => packer.flush(),
        }
    }
}
