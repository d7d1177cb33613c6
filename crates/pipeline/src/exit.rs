//! What runs in order for the whole plate: from paths to the text.
//!
//! In: layers of all parts from below. Out: their G-code. First come the sums and
//! speeds (`pacing`), and then the text. On a machine with many processors the speeds
//! have a thread of their own, so that the slower of the two bounds how fast layers
//! can be written, and not their sum.

use super::ahead::{Made, Threads};
use super::job::Job;
use super::layer::OnPlate;
use super::pacing::Pacing;
use super::part::Passed;
use super::sums::{PartDone, PartSums};
use super::supply::plate::Laid;
use super::{Options, SliceError};
use crate::report;
use glam::DVec2;
use isoslice_base::limits;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::Mm3;
use isoslice_gcode::{Totals, Writer};
use isoslice_path::pace::{PacedLayer, PacedMove, Sums};
use isoslice_planar::bead::Role;
use std::io;
use std::ops::Range;

/// The stages that run in order.
pub(super) struct Exit<'a, 'w> {
    counts: Counts<'a>,
    pub pacing: Pacing<'a>,
    text: Text<'a, 'w>,
}

/// The sums of all parts.
struct Counts<'a> {
    parts: Vec<PartSums<'a>>,
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
    /// An exit for writing a job. It takes all layers that the job makes, of which
    /// the lowest ones may not be written.
    pub(super) fn new(
        job: &'a Job<'a>,
        parts: Vec<PartSums<'a>>,
        pacing: Pacing<'a>,
        options: &'a Options<'a>,
        writer: Writer<'a, &'w mut dyn io::Write>,
    ) -> Self {
        Exit {
            counts: Counts {
                parts,
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
        layers: impl Iterator<Item = Made<OnPlate<Laid>>> + Send + 's,
        threads: &Threads<'s, '_>,
        apart: bool,
    ) -> Result<(), SliceError> {
        let Exit {
            counts,
            pacing,
            text,
        } = self;
        let paced = layers.map(|layer| {
            let layer = layer?.after(|k, laid| Ok(counts.add(k, laid)))?;
            pacing.layer(layer.span, &|part| layer.part(part))
        });
        for layer in threads.ahead(apart, "pace", paced)? {
            let layer = layer?;
            let written = text.layers.contains(&layer.span.index);
            text.layer(&layer, written)?;
        }
        Ok(())
    }

    /// Counts what there is in a part's next layer, and returns its path.
    pub(super) fn count(&mut self, part: usize, laid: Laid) -> Passed {
        self.counts.add(part, laid)
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
        let Counts { parts, figures, .. } = self.counts;
        let text = self.text;
        let mut warnings = self.pacing.warnings;
        warnings.extend(text.writer.warnings_of_layers());
        Ok(Done {
            parts: parts.into_iter().map(PartSums::finish).collect(),
            sums: text.sums,
            extruded: text.extruded,
            warnings,
            totals: text.writer.finish()?,
            figures,
        })
    }
}

impl Counts<'_> {
    /// Counts what there is in a part's next layer, and returns its path.
    fn add(&mut self, part: usize, (passed, mut counted): Laid) -> Passed {
        if let Some(figures) = counted.figures.take() {
            self.figures.add(&figures, self.options.report);
        }
        self.parts[part].add(counted);
        passed
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
