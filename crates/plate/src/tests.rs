use super::*;
use isoslice_settings::testing::settings;

impl Wanted {
    /// Copies of a formula's part with the default settings.
    pub(super) fn of_test(text: &str, copies: u64) -> Wanted {
        Wanted {
            source: Source::formula("part", text),
            defines: Vec::new(),
            placement: Placement::default(),
            settings: settings(&[]),
            at: None,
            copies,
            asked: "here".into(),
        }
    }
}

const BALL: &str = "sqrt(x^2 + y^2 + (z - 5)^2) - 5";
const LARGE: &str = "sqrt(x^2 + y^2 + (z - 20)^2) - 20";

#[test]
fn equal_parts_are_places_of_one() {
    let mut turned = Wanted::of_test(BALL, 1);
    turned.placement.rotate = [0.0, 0.0, 30.0];
    let mut placed = Wanted::of_test(BALL, 1);
    placed.at = Some((30.0, 40.0));
    let all = [
        Wanted::of_test(BALL, 3),
        Wanted::of_test(LARGE, 1),
        turned,
        placed,
    ];
    let plate = Plate::new("p", &all, &settings(&[])).unwrap();
    let count: Vec<usize> =
        plate.parts.iter().map(|p| p.places.len()).collect();
    assert_eq!(count, [4, 1, 1]);
    let names: Vec<&str> = plate.parts[0]
        .places
        .iter()
        .map(|place| place.name.as_str())
        .collect();
    assert_eq!(names, ["part_1", "part_2", "part_3", "part_6"]);
    // The one with a place is there.
    let bounds = plate.parts[0].model.printed_bounds();
    let middle = bounds.centre().truncate();
    let there = middle + plate.parts[0].places[3].shift;
    assert!(there.distance(DVec2::new(30.0, 40.0)) < 1e-3, "{there}");
    assert!(plate.whole().is_some());
}

#[test]
fn what_a_plate_does_not_have_is_refused() {
    let settings = &settings(&[]);
    let error = |all: &[Wanted]| match Plate::new("p", all, settings) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    };
    assert!(error(&[]).contains("nothing on the plate"));
    let many = error(&[
        Wanted::of_test(BALL, 1_000_000_000),
        Wanted::of_test(BALL, u64::MAX),
    ]);
    assert!(many.contains("at most 1000"), "{many}");
    let mut thin = Wanted::of_test(BALL, 2);
    thin.settings.first_layer_height = isoslice_settings::ByNozzle::Length(0.1);
    let differs = error(&[thin]);
    assert!(
        differs.starts_with("here: first_layer_height = 0.1"),
        "{differs}"
    );
    let mut in_one_place = Wanted::of_test(BALL, 2);
    in_one_place.at = Some((50.0, 50.0));
    assert!(error(&[in_one_place]).contains("2 copies cannot all stand"));
    let mut vase = Wanted::of_test(BALL, 2);
    vase.settings.spiral = isoslice_settings::SwitchOr::On;
    assert!(error(&[vase]).contains("spiral prints one part"));
    let full = error(&[Wanted::of_test(LARGE, 30)]);
    assert!(full.contains("there is no place for part_"), "{full}");
}

#[test]
fn errors_of_a_plate_file_tell_its_lines() {
    let in_file = |text: &str, copies, line| {
        let one = Wanted::of_test(text, copies);
        let asked = format!("p.toml:{line} ({})", one.source);
        Wanted { asked, ..one }
    };
    let error = |all: &[Wanted]| {
        let made = Plate::new("p", all, &all[0].settings);
        made.map(|_| ()).unwrap_err().to_string()
    };
    let mut off = in_file(BALL, 1, 7);
    off.at = Some((-50.0, 50.0));
    let told = error(&[in_file(LARGE, 1, 3), off.clone()]);
    assert!(told.starts_with("part_2 (p.toml:7) would reach"), "{told}");
    off.at = Some((50.0, 50.0));
    let mut over = in_file(LARGE, 1, 3);
    over.at = Some((55.0, 50.0));
    let told = error(&[over, off]);
    assert!(
        told.contains("part_1 (p.toml:3) and part_2 (p.toml:7)"),
        "{told}"
    );
    let told = error(&[in_file(LARGE, 30, 4)]);
    assert!(told.contains("no place for part_"), "{told}");
    assert!(told.contains("(p.toml:4), "), "{told}");
    let told = error(&[in_file(BALL, 9999, 4)]);
    assert!(told.starts_with("p.toml: 9999 parts"), "{told}");
    let mut two = in_file(BALL, 2, 4);
    two.settings = settings(&["plate.sequence=one-by-one"]);
    let told = error(&[two]);
    assert!(told.starts_with("p.toml: plate.sequence"), "{told}");
}
