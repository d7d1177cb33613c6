//! The supports of a plate, for its picture.

use super::SliceError;
use super::job::{Base, has_supports};
use super::options::Options;
use super::start::{layers_of, pool, raised};
use isoslice_base::limits;
use isoslice_plate::Plate;
use isoslice_preview::Slabs;

/// Plans the supports of the parts on a plate that are to have some, on `threads`
/// threads or all of the machine's, and returns what they fill.
///
/// # Errors
/// If the plate cannot be sliced: there are no layers, next to nothing can be
/// printed, a part is too high on its raft, or an expression has no value.
pub fn supports(
    plate: &Plate,
    threads: Option<usize>,
) -> Result<Slabs, SliceError> {
    let mut slabs = Slabs::default();
    if !plate.parts.iter().any(has_supports) {
        return Ok(slabs);
    }
    let pool = pool(threads)?;
    let plate = &raised(plate)?;
    let spans = pool.install(|| layers_of(plate))?.0;
    let parts = plate.parts.iter().zip(&spans);
    for (part, spans) in parts.filter(|(part, _)| has_supports(part)) {
        let base = Base::new(part, spans);
        let all = 0..spans.len();
        let planned = base.stages(&all, &Options::default(), &pool);
        let planned = planned.and_then(|mut planned| {
            planned.plan_supports(&base, &pool)?;
            limits::go_on()?;
            Ok(planned)
        });
        let planned = planned.map_err(|e| SliceError::of(plate, part, e))?;
        let Some(support) = planned.stages.support() else {
            continue;
        };
        let own: Vec<_> = support.slabs().collect();
        for place in &part.places {
            let way = part.model.offset.truncate() + place.shift;
            for (span, area) in &own {
                let mut moved = area.clone();
                moved.rings.iter_mut().flatten().for_each(|p| *p += way);
                slabs.add([span.bottom, span.top], moved);
            }
        }
    }
    Ok(slabs)
}
