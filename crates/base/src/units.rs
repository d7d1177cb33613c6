//! Units of the quantities that pass between the stages.
//!
//! All of them are `f64`. The aliases exist so that a signature says what it
//! takes. Lengths are millimetres and z points up everywhere. Conversions to
//! and from other units are in this module and nowhere else.

/// Length in millimetres.
pub type Mm = f64;
/// Area in square millimetres.
pub type Mm2 = f64;
/// Volume in cubic millimetres.
pub type Mm3 = f64;
/// Speed in millimetres per second.
pub type MmPerSec = f64;
/// Curvature: one over a radius in millimetres.
pub type PerMm = f64;
/// Number in a second.
pub type PerSec = f64;
/// Acceleration in millimetres per second squared.
pub type MmPerSec2 = f64;
/// Volumetric flow in cubic millimetres per second.
pub type Mm3PerSec = f64;
/// Change of a volumetric flow in cubic millimetres per second squared.
pub type Mm3PerSec2 = f64;
/// Time in seconds.
pub type Seconds = f64;
/// Angle in degrees, counter-clockwise from the x axis.
pub type Degrees = f64;
/// Density in grams per cubic centimetre.
pub type GramsPerCm3 = f64;
/// Price of a kilogram, in the user's currency.
pub type PricePerKg = f64;
/// Temperature in degrees Celsius.
pub type Celsius = f64;
/// Share in percent (100 is the whole).
pub type Percent = f64;

/// A unit of the last decimal of the coordinates in G-code.
pub const MICRON: Mm = 1e-3;

/// Feed rate of a `G1` word, mm/min, from a speed in mm/s.
pub fn feed_rate(speed: MmPerSec) -> f64 {
    speed * 60.0
}

/// Cross-section of round filament, mm².
pub fn filament_area(diameter: Mm) -> Mm2 {
    std::f64::consts::FRAC_PI_4 * diameter * diameter
}

/// Cross-section (w − h)·h + π(h/2)² of a bead `width` wide and `height` high.
/// A bead narrower than it is high is taken as an ellipse, π/4·w·h.
pub fn cross_section(width: Mm, height: Mm) -> Mm2 {
    use std::f64::consts::FRAC_PI_4;
    if width <= height {
        return FRAC_PI_4 * width * height;
    }
    (width - height) * height + FRAC_PI_4 * height * height
}

/// A duration as people read it: `1h 2m 3s`, leading zero units left out.
pub fn human_time(seconds: Seconds) -> String {
    let s = seconds.max(0.0).round() as u64;
    let (h, m, s) = (s / 3600, s / 60 % 60, s % 60);
    match (h, m) {
        (0, 0) => format!("{s}s"),
        (0, _) => format!("{m}m {s}s"),
        _ => format!("{h}h {m}m {s}s"),
    }
}

/// Words as people list them, with `or` or `and` before the last one: `a, b or c`.
pub fn human_list<T: AsRef<str>>(words: &[T], before_last: &str) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [rest @ .., last] => {
            format!("{} {before_last} {last}", rest.join(", "))
        }
    }
}

/// The beginning of a text, as much of it as people read in a message: so many
/// characters, and `…` where more would follow.
pub fn human_start(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A number of bytes in whole units, rounded down: `512 MB`, `4 kB`.
pub fn human_bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} bytes"),
        1024..0x10_0000 => format!("{} kB", bytes >> 10),
        _ => format!("{} MB", bytes >> 20),
    }
}

/// A number as people write it: `0.25`, but `1e300` without its zeros.
pub fn human_number(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && size.is_finite() && !(1e-6..1e15).contains(&size) {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// Sine and cosine of an angle, exact at multiples of 90°: a part that is
/// turned onto its side, or seen from one, keeps its planes along the axes.
pub fn sin_cos(degrees: Degrees) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    match turn {
        0.0 | 360.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => turn.to_radians().sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_naturally() {
        assert_eq!(human_time(0.4), "0s");
        assert_eq!(human_time(61.6), "1m 2s");
        assert_eq!(human_time(3600.0 * 26.0 + 5.0), "26h 0m 5s");
    }

    #[test]
    fn conversions() {
        assert_eq!(feed_rate(50.0), 3000.0);
        assert!((filament_area(1.75) - 2.405282).abs() < 1e-6);
    }
}
