//! What hangs, as JSON: for `--json` of the command line and for Python.

use super::{Hanging, Sum};
use isoslice_base::units::{Mm, Mm2};
use serde::{Serialize, Serializer};

/// The area that hangs while it is printed, by kind.
#[derive(Serialize)]
struct Kinds {
    begins_on_nothing: Kind,
    leans: Kind,
    long_bridges: Kind,
    small_foot: Option<SmallFoot>,
}

#[derive(Serialize)]
struct Kind {
    #[serde(skip_serializing_if = "Option::is_none")]
    count: Option<usize>,
    area_mm2: Mm2,
    #[serde(skip_serializing_if = "Option::is_none")]
    reach_mm: Option<Mm>,
    first_mm: Option<[Mm; 3]>,
}

#[derive(Serialize)]
struct SmallFoot {
    area_mm2: Mm2,
    holds_mm: Mm,
}

impl Serialize for Hanging {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let kind = |sum: &Sum, counted: bool, reach: bool| Kind {
            count: counted.then_some(sum.count),
            area_mm2: sum.area,
            reach_mm: reach.then_some(sum.reach),
            first_mm: sum.first.map(|p| p.to_array()),
        };
        let kinds = Kinds {
            begins_on_nothing: kind(&self.begins, true, false),
            leans: kind(&self.leans, false, true),
            long_bridges: kind(&self.bridges, true, true),
            small_foot: self.foot.map(|foot| SmallFoot {
                area_mm2: foot.area,
                holds_mm: foot.holds,
            }),
        };
        kinds.serialize(to)
    }
}
