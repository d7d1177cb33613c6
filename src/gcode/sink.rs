//! Where the text goes: into a text file, or packed into a binary one.

use super::Format;
use crate::bgcode::{About, Packer};
use std::io::{self, Write};

#[derive(Debug)]
pub(super) enum Sink<W: Write> {
    Text(W),
    Binary(Packer<W>),
}

impl<W: Write> Sink<W> {
    pub(super) fn new(out: W, format: Format) -> io::Result<Self> {
        Ok(match format {
            Format::Text => Sink::Text(out),
            Format::Binary => Sink::Binary(Packer::new(out)?),
        })
    }

    /// Ends the file. Packed files begin with `about`.
    pub(super) fn finish(
        self,
        about: impl FnOnce() -> About,
    ) -> io::Result<()> {
        match self {
            Sink::Text(mut out) => out.flush(),
            Sink::Binary(packer) => packer.finish(&about()),
        }
    }
}

impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Sink::Text(out) => out.write(bytes),
            Sink::Binary(packer) => packer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Sink::Text(out) => out.flush(),
            Sink::Binary(packer) => packer.flush(),
        }
    }
}
