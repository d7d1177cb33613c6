//! Follows the head through a file with relative extrusion, line by line.

use glam::DVec3;

/// What a line makes the head do.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub from: DVec3,
    pub to: DVec3,
    /// Filament, mm.
    pub fed: f64,
    /// Speed, mm/min.
    pub speed: f64,
}

impl Step {
    /// True if the step lays a bead.
    pub fn prints(&self) -> bool {
        self.fed > 0.0 && self.from.truncate() != self.to.truncate()
    }
}

/// The head, whose place is not known at first.
pub struct Head {
    origin: DVec3,
    at: DVec3,
    speed: f64,
}

impl Head {
    /// A head whose places are told from `origin`.
    pub fn new(origin: DVec3) -> Head {
        Head {
            origin,
            at: DVec3::NAN,
            speed: 0.0,
        }
    }

    /// What a line makes the head do, if the line is a straight move.
    pub fn step(&mut self, line: &str) -> Option<Step> {
        let words = line.strip_prefix("G1 ").or(line.strip_prefix("G0 "))?;
        let (from, mut fed) = (self.at, 0.0);
        for word in words.split_whitespace() {
            let value: f64 = word[1..].parse().unwrap();
            match &word[..1] {
                "X" => self.at.x = value - self.origin.x,
                "Y" => self.at.y = value - self.origin.y,
                "Z" => self.at.z = value - self.origin.z,
                "E" => fed = value,
                "F" => self.speed = value,
                _ => {}
            }
        }
        Some(Step {
            from,
            to: self.at,
            fed,
            speed: self.speed,
        })
    }
}
