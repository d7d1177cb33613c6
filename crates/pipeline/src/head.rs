//! What a file's start says of the print, and its pictures.

use super::SliceError;
use super::fingerprint::fingerprint;
use super::job::{Job, Run, outline_of};
use isoslice_base::timings::Stage;
use isoslice_gcode::{Header, Standing, Thumbnail, WriterPlan};
use isoslice_path::pace::rates::Rater;
use isoslice_plate::Plate;
use isoslice_preview::{PictureError, thumbnails};

/// What a file's start says. Returns a warning as well, if there is no picture.
///
/// # Errors
/// If the plate cannot be drawn, or a temperature has no value.
pub(super) fn header(
    run: &Run<'_>,
    job: &Job<'_>,
    rater: &Rater<'_>,
) -> Result<(Header, Option<String>), SliceError> {
    let Job { plate, spans, .. } = *job;
    let (low, high) = plate.reach();
    // Only the first range's pictures come into the joined file, and a glimpse
    // needs none.
    let glimpse = run.options.glimpse.is_some();
    let first = job.extent.layers.start == 0 && !glimpse;
    let (pictures, parts) = run.pool.install(|| {
        job.stopwatch().time(Stage::Picture, || {
            let pictures = if first {
                pictures_of(run.on_bed)?
            } else {
                Some(Vec::new())
            };
            Ok::<_, PictureError>((pictures, standing(plate)?))
        })
    })?;
    let no_picture = pictures.is_none().then(|| {
        "the file has no picture of the part, as drawing this expression would \
         take too long; gcode.thumbnails = \"\" asks for none"
            .to_owned()
    });
    let header = Header {
        model_name: plate.name.clone(),
        layer_count: job.count,
        layers: job.extent.layers.clone(),
        timestamp: run.options.timestamp,
        nozzle_temperature: match spans.get(job.extent.layers.start) {
            Some(span) => rater.temperature(span)?,
            None => plate.settings.first_layer_nozzle_temperature(),
        },
        part_min: low,
        part_max: high,
        parts,
        thumbnails: pictures.unwrap_or_default(),
        format: run.options.format,
        fingerprint: if job.extent.layers.len() < spans.len() && !glimpse {
            let of_parts = job.parts.iter().map(|planned| planned.spans);
            Some(fingerprint(plate, of_parts)?)
        } else {
            None
        },
        one_by_one: job.turns.is_some(),
    };
    Ok((header, no_picture))
}

/// The parts, for their labels.
fn standing(plate: &Plate) -> Result<Vec<Standing>, PictureError> {
    let mut all = Vec::new();
    for part in &plate.parts {
        let outline = if WriterPlan::of(&plate.settings).needs_outline() {
            outline_of(part)?
        } else {
            Vec::new()
        };
        let (low, high) = part.reach();
        for place in &part.places {
            all.push(Standing {
                name: place.name.clone(),
                min: low.truncate() + place.shift,
                max: high.truncate() + place.shift,
                outline: outline.iter().map(|p| *p + place.shift).collect(),
            });
        }
    }
    Ok(all)
}

/// The pictures for the file's head, if they can be afforded.
fn pictures_of(plate: &Plate) -> Result<Option<Vec<Thumbnail>>, PictureError> {
    let sizes = plate.settings.gcode.thumbnails.all();
    if sizes.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let Some(whole) = plate.whole() else {
        return Ok(None);
    };
    Ok(thumbnails(&whole, sizes)?.map(|files| {
        let pictures = sizes.iter().zip(files);
        pictures
            .map(|(&size, file)| Thumbnail { size, file })
            .collect()
    }))
}
