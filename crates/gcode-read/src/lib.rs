//! Reads G-code of any slicer: as text, packed, or in an archive.
//!
//! In: the bytes of a file. Out: what its lines do, as
//! [`Event`](reader::Event)s, each with the number of its line.
//!
//! | module | what it does |
//! |---|---|
//! | [`package`] | opens and makes the archives of Bambu Lab's printers, `.gcode.3mf` |
//! | [`bgcode`] | opens and makes the binary files of Prusa's printers |
//! | [`reader`] | follows the machine through the text |
//!
//! Guarantees: any bytes give events or an error, in bounded memory and without
//! panics. What is packed and unpacked again is the same text.
//!
//! Not guaranteed: that a firmware does the same with commands that it alone
//! knows; the reader tells which lines it does not understand.

#![warn(unreachable_pub)]

pub mod bgcode;
pub mod package;
pub mod reader;
