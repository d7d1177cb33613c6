//! What a file prints, told by what any firmware would do with it.

use glam::{DVec2, DVec3};

/// A move that lays material.
#[derive(Clone, Debug)]
pub struct Laid {
    pub role: String,
    pub from: DVec3,
    pub to: DVec3,
    /// The middle of the circle, if it is an arc.
    pub centre: Option<DVec2>,
    /// Filament, mm.
    pub fed: f64,
}

impl Laid {
    /// True if `other` lays the same. Places are written to a micrometre, by
    /// which a bead may be longer.
    pub fn is_like(&self, other: &Laid) -> bool {
        let near = |a: DVec3, b: DVec3| (b - a).abs().max_element() < 1.5e-3;
        let centre = |l: &Laid| l.centre.map(|c| c.extend(0.0));
        let centres = match (centre(self), centre(other)) {
            (Some(a), Some(b)) => near(a, b),
            (a, b) => a == b,
        };
        self.role == other.role
            && centres
            && near(self.from, other.from)
            && near(self.to, other.to)
            && (self.fed - other.fed).abs() < 1e-4
    }

    /// Moves the bead in the plane.
    pub fn shift(&mut self, by: DVec2) {
        self.from += by.extend(0.0);
        self.to += by.extend(0.0);
        self.centre = self.centre.map(|c| c + by);
    }

    /// The move, made from its end to its beginning.
    pub fn reversed(&self) -> Laid {
        Laid {
            from: self.to,
            to: self.from,
            ..self.clone()
        }
    }
}

/// Everything that is laid within a label of this name, or all if there is none.
pub fn printed(gcode: &str, label: Option<&str>) -> Vec<Laid> {
    let mut found = Vec::new();
    let (mut at, mut e) = (DVec3::NAN, 0.0);
    let (mut relative, mut all_relative) = (false, false);
    let (mut begun, mut role, mut here) = (false, "", String::new());
    for line in gcode.lines() {
        begun |= line == ";LAYER_CHANGE";
        if let Some(name) = line.strip_prefix(";TYPE:") {
            role = name;
        }
        if let Some(name) = line.strip_prefix("EXCLUDE_OBJECT_START NAME=") {
            name.clone_into(&mut here);
        }
        if line.starts_with("EXCLUDE_OBJECT_END") {
            here.clear();
        }
        let mut words = line.split(';').next().unwrap().split_whitespace();
        let command = words.next().unwrap_or_default();
        match command {
            "M82" => relative = false,
            "M83" => relative = true,
            "G90" => all_relative = false,
            "G91" => all_relative = true,
            "G92" => {
                let value = words.next().and_then(|w| w.strip_prefix('E'));
                e = value.unwrap().parse().unwrap();
            }
            "G0" | "G1" | "G2" | "G3" => {
                assert!(!all_relative || !begun, "{line}");
                let (from, mut fed) = (at, 0.0);
                let mut centre = from.truncate();
                for word in words {
                    let value: f64 = word[1..].parse().unwrap();
                    match &word[..1] {
                        "X" => at.x = value,
                        "Y" => at.y = value,
                        "Z" => at.z = value,
                        "I" => centre.x += value,
                        "J" => centre.y += value,
                        "E" if relative => fed = value,
                        "E" => {
                            fed = value - e;
                            e = value;
                        }
                        _ => {}
                    }
                }
                let across = from.truncate() != at.truncate();
                if begun
                    && across
                    && fed > 0.0
                    && label.is_none_or(|l| l == here)
                {
                    found.push(Laid {
                        role: role.to_owned(),
                        from,
                        to: at,
                        centre: (command > "G1").then_some(centre),
                        fed,
                    });
                }
            }
            _ => {}
        }
    }
    found
}
