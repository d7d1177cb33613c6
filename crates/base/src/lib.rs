//! What any stage may need, and what is no stage itself.
//!
//! | module | what it does |
//! |---|---|
//! | [`units`] | names units, and writes times and sizes for people |
//! | [`sets`] | joins what belongs together |
//! | [`random`] | makes numbers that look random, and are the same in every run |
//! | [`encoding`] | reads text from bytes |
//! | [`stopwatch`] | measures the processor time of a thread |
//! | [`parallel`] | finds answers on all threads, in order |
//! | [`limits`] | bounds the time, the work and the memory of a run, and stops it |
//! | [`problem`] | says what is wrong with what a user has named |
//! | [`named!`] | declares an enum whose values have names |
//! | [`pairs!`] | makes a table of words |
//! | [`archive`] | counts the files of an archive before it is opened |
//! | [`files`] | reads files within limits, and writes them whole or not at all |
//! | [`timings`] | adds up the time of each stage |
//!
//! In and out: plain values; each module says which.
//!
//! Guarantees: nothing here knows a model, a setting or a layer. Bytes and files
//! from outside give a value or an error, never a panic, and are bounded in size.

#![warn(unreachable_pub)]

pub mod archive;
pub mod encoding;
pub mod files;
pub mod limits;
mod named;
mod pairs;
pub mod parallel;
pub mod problem;
pub mod random;
pub mod sets;
pub mod stopwatch;
pub mod timings;
pub mod units;
