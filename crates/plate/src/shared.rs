//! Which settings hold for the whole plate.

use super::{Plate, Wanted};
use isoslice_settings::keys;

/// Groups of settings that are of the printer, of the filament, of the file, or
/// of what the nozzle does between parts.
const GROUPS: [&str; 10] = [
    "printer",
    "filament",
    "gcode",
    "cooling",
    "retract",
    "acceleration",
    "travel",
    "skirt",
    "raft",
    "plate",
];

/// The settings outside of groups that all parts of a layer share, and the speed
/// between parts.
const SINGLE: [&str; 7] = [
    "layer_height",
    "first_layer_height",
    "layer_heights",
    "layer_height_min",
    "layer_height_max",
    "speed.travel",
    "draft_shield",
];

/// A setting of a part that differs from the plate's, although all parts share
/// it.
pub(super) struct Difference {
    pub key: &'static str,
    pub value: String,
    pub of_plate: String,
}

/// True if all parts on a plate have the same value of a setting.
pub(super) fn is_shared(key: &str) -> bool {
    let group = key.split_once('.').map(|(group, _)| group);
    group.is_some_and(|group| GROUPS.contains(&group)) || SINGLE.contains(&key)
}

/// The first setting that differs although all parts share it.
pub(super) fn difference(
    Plate {
        settings: plate, ..
    }: &Plate,
    Wanted { settings: part, .. }: &Wanted,
) -> Option<Difference> {
    let shared = keys().iter().filter(|key| is_shared(key.name));
    let differs =
        |key: &&isoslice_settings::Key| key.get(plate) != key.get(part);
    shared.into_iter().find(differs).map(|key| Difference {
        key: key.name,
        value: key.get(part),
        of_plate: key.get(plate),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_in_the_lists_is_a_setting() {
        for name in SINGLE {
            assert!(keys().iter().any(|key| key.name == name), "{name}");
        }
        for group in GROUPS {
            let of_group =
                |name: &str| name.split_once('.').is_some_and(|n| n.0 == group);
            assert!(keys().iter().any(|key| of_group(key.name)), "{group}");
        }
    }

    #[test]
    fn parts_may_differ_in_their_walls_and_not_in_their_layers() {
        let mut part = Wanted::of_test("x", 1);
        let plate = Plate {
            name: String::new(),
            settings: part.settings.clone(),
            parts: Vec::new(),
        };
        part.settings.walls = 4;
        part.settings.brim.width = 3.0;
        assert!(difference(&plate, &part).is_none());
        part.settings.filament.flow = 95.0;
        let found = difference(&plate, &part).unwrap();
        assert_eq!((found.key, &*found.value), ("filament.flow", "95"));
    }
}
