//! The stages that run in order for the whole plate: from filled layers to the
//! text.
//!
//! In: layers of all parts from below. Out: their G-code. Four steps follow each
//! other: the order of the beads (`part`), paths (`ways`), speeds (`pacing`),
//! and the text. On a machine with many processors each has a thread of its
//! own, so that the slowest step alone bounds how fast layers can be written,
//! and not the sum of all. What one layer passes to the next is forgotten at the
//! beginning of every block.

use super::ahead::{Made, Threads};
use super::job::Job;
use super::layer::{Filled, OnPlate, Restart};
use super::pacing::Pacing;
use super::part::{Ordered, PartOrder};
use super::ways::{PartDone, PartTravel, Passed};
use super::{BLOCK, Options, SliceError};
use crate::report;
use glam::DVec2;
use isoslice_base::limits;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::{Mm, Mm3};
use isoslice_gcode::{Totals, Writer};
use isoslice_path::pace::{PacedLayer, PacedMove, Sums};
use isoslice_planar::bead::Role;
use std::io;
use std::ops::Range;

/// The stages that run in order.
pub(super) struct Exit<'a, 'w> {
    parts: Vec<PartOrder<'a>>,
    ways: Ways<'a>,
    pacing: Pacing<'a>,
    text: Text<'a, 'w>,
}

/// The paths of all parts.
struct Ways<'a> {
    parts: Vec<PartTravel<'a>>,
    figures: report::RunFigures,
    options: &'a Options<'a>,
}

/// The text, and sums of what is in it.
struct Text<'a, 'w> {
    writer: Writer<'a, &'w mut dyn io::Write>,
    options: &'a Options<'a>,
    /// The layers to be written.
    layers: Range<usize>,
    /// Number of layers that were written.
    done: usize,
    timings: &'a Timings,
    sums: Sums,
    /// Volume extruded at each place.
    extruded: Vec<Mm3>,
}

/// The results of a plate.
pub(super) struct Done {
    /// The results of each part.
    pub parts: Vec<PartDone>,
    /// What the beads amount to.
    pub sums: Sums,
    /// Volume extruded at each place.
    pub extruded: Vec<Mm3>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What the print takes: time and filament.
    pub totals: Totals,
    /// The measured accuracy.
    pub figures: report::RunFigures,
}

impl<'a, 'w> Exit<'a, 'w> {
    /// An exit for writing a job. The layers of the same block before the job's
    /// have to be given, too.
    pub(super) fn new(
        job: &'a Job<'a>,
        parts: Vec<(PartOrder<'a>, PartTravel<'a>)>,
        pacing: Pacing<'a>,
        options: &'a Options<'a>,
        writer: Writer<'a, &'w mut dyn io::Write>,
    ) -> Self {
        let (parts, ways) = parts.into_iter().unzip();
        Exit {
            parts,
            ways: Ways {
                parts: ways,
                figures: report::RunFigures::default(),
                options,
            },
            pacing,
            text: Text {
                writer,
                options,
                layers: job.extent.layers.clone(),
                done: 0,
                timings: job.stopwatch(),
                sums: Sums::default(),
                extruded: vec![0.0; job.plate.shifts().len()],
            },
        }
    }

    /// Takes all layers. If the steps are to be `apart`, each works ahead of
    /// the next one.
    ///
    /// # Errors
    /// The error of the lowest layer that has one.
    pub(super) fn layers<'s>(
        &'s mut self,
        layers: impl Iterator<Item = Made<OnPlate<Filled>>> + Send + 's,
        threads: &Threads<'s, '_>,
        apart: bool,
    ) -> Result<(), SliceError> {
        let Exit {
            parts,
            ways,
            pacing,
            text,
        } = self;
        let ordered = layers.map(|layer| in_order(parts, layer?));
        let ordered = threads.ahead(apart, "order", ordered)?;
        let passed =
            ordered.map(|layer| layer?.after(|k, part| ways.pass(k, part)));
        let passed = threads.ahead(apart, "travel", passed)?;
        let paced = passed.map(|layer| paced(pacing, &layer?));
        for layer in threads.ahead(apart, "pace", paced)? {
            let (restart, layer) = layer?;
            let span = layer.span;
            if let Some(Restart { head }) = restart {
                text.writer.restart(head.map(|p| p.extend(span.bottom)))?;
            }
            let written = text.layers.contains(&span.index);
            text.layer(&layer, written)?;
        }
        Ok(())
    }

    /// Makes the path of a part's next layer.
    pub(super) fn pass(
        &mut self,
        part: usize,
        filled: Filled,
    ) -> Result<Passed, SliceError> {
        let ordered = self.parts[part].layer(filled);
        self.ways.pass(part, ordered)
    }

    /// Begins with the part in a place, which is finished before the next one
    /// begins. The one before was as high as `below`.
    pub(super) fn begin(&mut self, place: usize, below: Mm) {
        self.pacing.begin(place, below);
    }

    /// Prints the next layer of the part whose turn it is.
    pub(super) fn print_turn(
        &mut self,
        part: usize,
        passed: &Passed,
    ) -> Result<(), SliceError> {
        let of_part = |k| (k == part).then_some(passed);
        let paced = self.pacing.layer(passed.path.span, &of_part)?;
        self.text.layer(&paced, true)
    }

    /// Ends the file.
    pub(super) fn finish(self) -> Result<Done, SliceError> {
        let parts = self.parts.into_iter().zip(self.ways.parts);
        let text = self.text;
        Ok(Done {
            parts: parts.map(|(order, ways)| ways.finish(order)).collect(),
            sums: text.sums,
            extruded: text.extruded,
            warnings: self.pacing.warnings,
            totals: text.writer.finish()?,
            figures: self.ways.figures,
        })
    }
}

/// Puts the beads of each part in a layer in order.
fn in_order(
    parts: &mut [PartOrder<'_>],
    mut layer: OnPlate<Filled>,
) -> Made<OnPlate<Ordered>> {
    let span = layer.span;
    if span.index > 0 && span.index.is_multiple_of(BLOCK) {
        let heads = parts.iter_mut().map(|part| part.restart(&span));
        let heads: Vec<Option<DVec2>> = heads.collect();
        let head = match *heads {
            [head] => head,
            _ => None,
        };
        layer.restart = Some(Restart { head });
    }
    layer.after(|k, filled| Ok(parts[k].layer(filled)))
}

/// Gives the moves of a layer their speeds.
fn paced(
    pacing: &mut Pacing<'_>,
    layer: &OnPlate<Passed>,
) -> Made<(Option<Restart>, PacedLayer)> {
    if let Some(Restart { head }) = layer.restart {
        pacing.restart(head, &layer.span);
    }
    let paced = pacing.layer(layer.span, &|part| layer.part(part))?;
    Ok((layer.restart, paced))
}

impl Ways<'_> {
    /// Makes the path of a part's next layer.
    fn pass(
        &mut self,
        part: usize,
        ordered: Ordered,
    ) -> Result<Passed, SliceError> {
        let figures = ordered.filled.figures.as_ref();
        if let Some(figures) = figures {
            self.figures.add(figures, self.options.report);
        }
        self.parts[part].layer(ordered)
    }
}

impl Text<'_, '_> {
    /// Takes the next layer.
    fn layer(
        &mut self,
        paced: &PacedLayer,
        written: bool,
    ) -> Result<(), SliceError> {
        limits::go_on()?;
        if written {
            self.sums.add(&paced.sums);
            self.count(paced);
        }
        self.timings.time(Stage::Gcode, || {
            if written {
                self.writer.layer(paced)
            } else {
                self.writer.rehearse(paced)
            }
        })?;
        limits::made(paced.moves.len());
        if written {
            self.done += 1;
            limits::layers_done(self.done, self.layers.len());
            (self.options.on_layer)(self.done, self.layers.len());
        }
        Ok(())
    }

    /// Adds up what is extruded at each place.
    fn count(&mut self, paced: &PacedLayer) {
        for part in &paced.parts {
            let Some(place) = part.place else { continue };
            let volume = paced.moves[part.moves.clone()].iter().map(volume);
            self.extruded[place] += volume.sum::<Mm3>();
        }
    }
}

/// Volume that a step extrudes for the part or its supports.
fn volume(step: &PacedMove) -> Mm3 {
    match step {
        PacedMove::Print {
            bead, turns, flow, ..
        } if bead.role != Role::Skirt => {
            let along = |(i, (a, b)): (usize, (DVec2, DVec2))| {
                let turn = turns.get(i).copied().flatten();
                let length = turn.map_or(a.distance(b), |t| t.length(a));
                length
                    * if bead.stroke.levels.is_empty() {
                        bead.area()
                    } else {
                        bead.area_along(i)
                    }
            };
            flow * bead.stroke.segments().enumerate().map(along).sum::<Mm3>()
        }
        _ => 0.0,
    }
}
