//! What hangs, in words: the warnings.

use super::foot::Foot;
use super::plan::OverhangPlan;
use super::{Hanging, Sum};
use isoslice_base::units::{Mm, Mm2};

/// Faces that lean are reported if one is as large as this, mm², or gets as far
/// away from what holds it, mm. Smaller ones sag by a layer or two, which is a
/// blemish, and lattices are full of them.
const LARGE: Mm2 = 10.0;
const FAR: Mm = 5.0;
/// Islands that begin on nothing are reported if one gets as large as this, mm².
/// Smaller ones are a thread that falls down, or a blemish.
const ISLAND: Mm2 = 1.0;

/// The place of the first finding, in words.
fn place(sum: &Sum) -> String {
    let Some(p) = sum.first else {
        return String::new();
    };
    format!("x = {:.1}, y = {:.1}, z = {:.1} on the bed", p.x, p.y, p.z)
}

/// The number of findings besides the first, in words.
fn others(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        n => format!(" (and {} more like it)", n - 1),
    }
}

impl Hanging {
    /// What the user should know. `height` is the part's.
    pub fn warnings(&self, height: Mm, plan: &OverhangPlan) -> Vec<String> {
        let mut all = Vec::new();
        // A vase has no supports.
        let supported = if plan.vase {
            ""
        } else {
            "set supports = \"auto\", "
        };
        let inside = &self.in_cavity;
        if inside.largest >= ISLAND {
            all.push(format!(
                "what begins at {} hangs in a cavity of the part{}: nothing \
                 holds it while it is printed; {}turn the part, or give the \
                 cavity a hole through which supports can be taken out",
                place(inside),
                others(inside.count),
                if plan.vase {
                    ""
                } else {
                    "if the cavity is open below or above, set supports = \
                     \"auto\", otherwise "
                }
            ));
        }
        let begins = &self.in_the_open;
        if begins.largest >= ISLAND {
            all.push(format!(
                "what begins at {} begins on nothing{}: it would be printed \
                 into the air; {supported}turn the part, or give it something to \
                 stand on in the model",
                place(begins),
                others(begins.count)
            ));
        }
        let leans = &self.leans;
        if leans.reach >= FAR || leans.largest >= LARGE {
            all.push(format!(
                "{:.0} mm² of undersides lean by more than support.angle = \
                 {}° from the vertical and get up to {:.1} mm away from what \
                 holds them, the first at {}: they will sag; {supported}turn the \
                 part or make them steeper, or raise support.angle if your \
                 printer does better",
                leans.area,
                plan.angle,
                leans.reach,
                place(leans)
            ));
        }
        let bridges = &self.bridges;
        if !bridges.is_none() {
            let key = if plan.bridges { "bridge_max = " } else { "" };
            all.push(format!(
                "the bridge at {} is longer than {key}{} mm{}, the longest \
                 {:.1} mm: they will sag; turn the part, or raise bridge_max \
                 if your printer does better",
                place(bridges),
                plan.bridge_max,
                others(bridges.count),
                bridges.reach,
            ));
        }
        if let Some(foot) = self.foot {
            all.push(off_the_bed(foot, height, plan.raft_layers > 0));
        }
        all
    }
}

/// What a part of some height has to fear that stands on a small foot.
fn off_the_bed(foot: Foot, height: Mm, raft: bool) -> String {
    let (ground, help) = if raft {
        (
            "raft",
            "a raft holds it no better: lay it down, or give it a wider foot",
        )
    } else {
        (
            "bed",
            "give it a brim (brim.place = \"outer\"), or lay it down",
        )
    };
    let from = if foot.holds_nothing() {
        format!(
            "the nozzle may tear it off the {ground} from its first layers on"
        )
    } else {
        format!(
            "from about {:.0} mm on the nozzle may tear it off the {ground}",
            foot.holds
        )
    };
    // A foot may be a point.
    let area = if foot.area < 0.05 {
        "hardly more than a point".to_owned()
    } else {
        format!("{:.1} mm²", foot.area)
    };
    format!(
        "the part stands on {area} and is {height:.1} mm high: {from}; {help}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use isoslice_settings::testing::usual_plan;

    /// A ball in a closed cavity, and slivers elsewhere that need no word.
    #[test]
    fn no_island_is_told_twice() {
        let mut hanging = Hanging::default();
        let told = |hanging: &Hanging| {
            let all = hanging.warnings(30.0, &usual_plan(OverhangPlan::of));
            all.iter().map(|w| w.contains("cavity")).collect::<Vec<_>>()
        };
        hanging.add_where(true, 12.0, DVec3::new(1.0, 2.0, 3.0));
        hanging.add_where(false, 0.36, DVec3::new(7.0, 8.0, 9.0));
        assert_eq!(told(&hanging), [true]);
        hanging.add_where(false, 4.0, DVec3::new(7.0, 8.0, 10.0));
        assert_eq!(told(&hanging), [true, false]);
    }

    #[test]
    fn no_foot_holds_a_height_of_0_mm() {
        let told = |area, holds| off_the_bed(Foot { area, holds }, 30.0, false);
        let on_raft = off_the_bed(
            Foot {
                area: 9.0,
                holds: 8.0,
            },
            30.0,
            true,
        );
        assert!(on_raft.contains("off the raft; a raft holds"), "{on_raft}");
        let small = told(9.0, 8.0);
        assert!(small.contains("9.0 mm² and is 30.0 mm high"), "{small}");
        assert!(small.contains("from about 8 mm on"), "{small}");
        let tiny = told(0.02, 0.001);
        assert!(tiny.contains("hardly more than a point"), "{tiny}");
        assert!(tiny.contains("from its first layers on"), "{tiny}");
        assert!(!tiny.contains(" 0 mm") && !tiny.contains(" 0.0 "), "{tiny}");
    }
}
