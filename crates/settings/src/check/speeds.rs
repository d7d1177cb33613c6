//! Finds speeds that the hot end or the printer does not allow.

use crate::{Settings, Varying};
use isoslice_base::units::{Mm, cross_section};

/// A speed at which the hot end does not melt fast enough.
struct Limited {
    /// The speed's key.
    key: &'static str,
    /// The speed as set and the speed that is reached, mm/s.
    set: f64,
    possible: f64,
    /// Plastic that the speed as set takes, mm³/s.
    flow: f64,
}

/// Warns of speeds that were asked for and cannot be had.
pub(super) fn too_fast(
    s: &Settings,
    given: &dyn Fn(&str) -> bool,
    warnings: &mut Vec<String>,
) {
    for limited in limited_speeds(s) {
        if given(limited.key) {
            warnings.push(format!(
                "{} = {} mm/s takes {:.1} mm³/s of plastic, and \
                 filament.max_flow = {} mm³/s is what the hot end melts: the \
                 speed will be {:.0} mm/s; lower the speed, or raise \
                 filament.max_flow if yours melts more",
                limited.key,
                limited.set,
                limited.flow,
                s.filament.max_flow,
                limited.possible,
            ));
        }
    }
}

/// A note about the speeds that `filament.max_flow` limits; nothing if there
/// are none.
pub(crate) fn flow_note(s: &Settings) -> Option<String> {
    let limited: Vec<String> = limited_speeds(s)
        .iter()
        .map(|l| format!("{} from {} to {:.0}", l.key, l.set, l.possible))
        .collect();
    (!limited.is_empty()).then(|| {
        format!(
            "filament.max_flow = {} mm³/s slows {} mm/s",
            s.filament.max_flow,
            limited.join(", "),
        )
    })
}

/// A note about the speeds that `printer.max_speed` limits; nothing if there
/// are none.
pub(crate) fn speed_note(s: &Settings) -> Option<String> {
    let speed = &s.speed;
    let most = s.printer.max_speed;
    let asked = [
        ("speed.outer_wall", speed.outer_wall.constant()),
        ("speed.inner_wall", speed.inner_wall.constant()),
        ("speed.gap_fill", speed.gap_fill.constant()),
        ("speed.sparse_infill", speed.sparse_infill.constant()),
        ("speed.internal_skin", speed.internal_skin.constant()),
        ("speed.top_skin", speed.top_skin.constant()),
        ("speed.bottom_skin", speed.bottom_skin.constant()),
        ("speed.bridge", speed.bridge.constant()),
        ("speed.internal_bridge", speed.internal_bridge.constant()),
        (
            "speed.overhang",
            speed.overhang.same().and_then(Varying::constant),
        ),
        ("speed.ironing", speed.ironing.constant()),
        ("speed.skirt", Some(speed.skirt)),
        ("speed.travel", Some(speed.travel)),
    ];
    let limited: Vec<String> = asked
        .iter()
        .filter_map(|&(key, asked)| Some((key, asked?)))
        .filter(|&(_, asked)| asked > most)
        .map(|(key, asked)| format!("{key} ({asked})"))
        .collect();
    (!limited.is_empty()).then(|| {
        format!(
            "printer.max_speed = {most} mm/s is less than {}, and is used \
             instead",
            limited.join(", ")
        )
    })
}

/// The speeds that `filament.max_flow` does not allow.
fn limited_speeds(s: &Settings) -> Vec<Limited> {
    let share = |v: &Varying| v.constant().map(|percent| percent / 100.0);
    let (Some(flow), Some(widened)) = (share(&s.flow), share(&s.bead_width))
    else {
        return Vec::new();
    };
    let flow = flow * s.filament.flow / 100.0;
    let most = s.filament.max_flow;
    let limited = |(key, speed, width): (&'static str, &Varying, Mm)| {
        let speed = speed.constant()?;
        let area = flow * cross_section(width * widened, s.thickest_layer());
        // Only differences that show in the decimals of the message count.
        (speed * area > most + 0.05).then(|| Limited {
            key,
            set: speed,
            possible: most / area,
            flow: speed * area,
        })
    };
    let speed = &s.speed;
    [
        ("speed.outer_wall", &speed.outer_wall, s.outer_wall_width()),
        ("speed.inner_wall", &speed.inner_wall, s.inner_wall_width()),
        (
            "speed.sparse_infill",
            &speed.sparse_infill,
            s.infill_width(),
        ),
        ("speed.internal_skin", &speed.internal_skin, s.skin_width()),
        ("speed.top_skin", &speed.top_skin, s.top_skin_width()),
        ("speed.bottom_skin", &speed.bottom_skin, s.skin_width()),
    ]
    .into_iter()
    .filter_map(limited)
    .collect()
}
