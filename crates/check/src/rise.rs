//! How far layers rise above those below them, and how wide their beads are for
//! that.
//!
//! In: beads with the air down to what lies below them, in order. Out: layers
//! whose beads rise farther than they did, without more plastic, so that a layer
//! was left out; and layers of the same beads with twice the plastic.
//!
//! A file that does not say how high its beads are does not tell either. Beads
//! that lie straight on others do: in every layer, some do. The least rise of a
//! layer is the height of these, since beads over sparse infill and overhangs
//! rise farther.

use isoslice_base::units::{Mm, Mm2};
use isoslice_gcode_read::reader::Role;

/// Rises that are closer than this are alike.
const RISE_STEP: Mm = 0.01;

/// Number of rises that are told from one another, up to 3 mm.
const RISES: usize = 300;

/// Length of beads that tell the least rise, mm. Shorter ones may be chance.
const ENOUGH: Mm = 2.0;

/// How much farther beads rise that lie on others, too, as a share.
const NEAR: f64 = 1.15;

/// Length of the beads of a layer that is compared, mm.
const LEAST: Mm = 10.0;

/// Growth of the rise, or of the width, that is no change of settings: a layer that
/// is left out doubles the rise, and thick layers of 0.3 mm follow on thin ones of
/// 0.2 mm.
const FARTHER: f64 = 1.7;

/// What is left of the width, if layers rise farther without more plastic. If a
/// layer is left out it is half.
const NARROWER: f64 = 0.65;

/// Difference between the lengths, and the rises, of two layers of the same beads,
/// as a share.
const ALIKE: f64 = 0.05;

/// Room for what beads are for: there are fewer roles.
const ROLES: usize = 32;

/// Layers over which a raft and its gap may lie. Files that do not say what beads
/// are for do not tell this gap from a layer that is missing.
const RAFT: u32 = 10;

/// Beads that rise equally far.
#[derive(Clone, Copy, Debug, Default)]
struct Beads {
    length: Mm,
    volume: f64,
    rise: f64,
    /// Their height, by what the file says or seems to say, times their length.
    said: f64,
    /// Their volume, by what the file says.
    told: f64,
}

/// What is known of a layer.
#[derive(Clone, Copy, Debug)]
struct Layer {
    /// Its least rise.
    rise: Mm,
    /// The height of the beads that rise least, by what the file says.
    said: Mm,
    /// Cross-section of the beads that rise least, by their rise.
    width: Mm,
    /// Length of all beads, and their cross-section on average.
    length: Mm,
    area: Mm2,
    /// Their cross-section on average, by what the file says.
    told: Mm2,
    /// What most of the beads are for.
    role: usize,
}

/// What is wrong with a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wrong {
    /// It rises by `rise`, with plastic for `before`.
    Left { rise: Mm, before: Mm },
    /// Its beads have this many times the plastic of those below.
    Thick { share: f64 },
}

/// The layer being printed, and the one below.
#[derive(Debug)]
pub(super) struct Rise {
    /// The layer's beads, by how far they rise.
    beads: [Beads; RISES + 1],
    /// Their length by what they are for.
    of_role: [Mm; ROLES],
    last: Option<Layer>,
    /// Least width of the beads of a layer. Cells do not tell a wall from the
    /// next one, so that interlocked walls, each half a layer higher or lower than
    /// the next, seem to rise by half a layer and to be twice as wide.
    narrowest: Option<Mm>,
    /// Number of layers that were compared.
    layers: u32,
}

impl Default for Rise {
    fn default() -> Self {
        Rise {
            beads: [Beads::default(); RISES + 1],
            of_role: [0.0; ROLES],
            last: None,
            narrowest: None,
            layers: 0,
        }
    }
}

impl Rise {
    /// Takes in a piece of a bead that rises by `rise` above what lies below it.
    /// `said` are its height and its cross-section by what the file says, and `role` is
    /// what the bead is for.
    pub(super) fn bead(
        &mut self,
        rise: Mm,
        length: Mm,
        area: Mm2,
        said: (Mm, Mm2),
        role: Role,
    ) {
        self.of_role[role as usize % ROLES] += length;
        let rise = rise.clamp(0.0, RISES as f64 * RISE_STEP);
        let beads = &mut self.beads[(rise / RISE_STEP + 0.5) as usize];
        beads.length += length;
        beads.volume += area * length;
        beads.rise += rise * length;
        beads.said += said.0 * length;
        beads.told += said.1 * length;
    }

    /// True once a layer is known.
    pub(super) fn has_begun(&self) -> bool {
        self.layers > 0
    }

    /// Ends the layer with this number. From one layer to the next, its beads may
    /// have up to `steps` times the plastic.
    pub(super) fn next_layer(
        &mut self,
        number: u32,
        steps: f64,
    ) -> Option<Wrong> {
        let here = summed(&self.beads, &self.of_role);
        self.beads.fill(Beads::default());
        let of_role = std::mem::replace(&mut self.of_role, [0.0; ROLES]);
        let unnamed = of_role[Role::Unknown as usize % ROLES] > 0.0;
        let here = here?;
        let narrowest = self.narrowest.unwrap_or(f64::INFINITY);
        let maybe_raft = unnamed && number <= RAFT;
        // The first layer has a height of its own, and those above it theirs.
        let own = self.layers == 1 && here.said * FARTHER > here.rise;
        self.layers += 1;
        if let Some(last) = self.last.filter(|_| !maybe_raft && !own)
            && here.rise > FARTHER * last.rise
            && here.width < NARROWER * narrowest
        {
            // The next layer is compared with those before the gap.
            let (rise, before) = (here.rise, last.rise);
            return Some(Wrong::Left { rise, before });
        }
        self.narrowest = Some(narrowest.min(here.width));
        let last = self.last.replace(here).filter(|_| !maybe_raft)?;
        let alike = |a: f64, b: f64| (a / b - 1.0).abs() < ALIKE;
        let same = here.role == last.role
            && alike(here.length, last.length)
            && alike(here.rise, last.rise);
        let share = (here.width / last.width).min(here.area / last.area);
        // Beads that are meant to be wider have more plastic.
        let share = share / (here.told / last.told).max(1.0);
        (same && share > FARTHER * steps).then_some(Wrong::Thick { share })
    }
}

/// What the beads of a layer come to, and their lengths by what they are for.
fn summed(beads: &[Beads], of_role: &[Mm; ROLES]) -> Option<Layer> {
    let roles = 0..ROLES;
    let most = roles.max_by(|&a, &b| of_role[a].total_cmp(&of_role[b]));
    let mut low = Beads::default();
    for beads in beads {
        // Beads that lie on others rise alike.
        let alike = beads.rise * low.length <= NEAR * low.rise * beads.length;
        if low.length < ENOUGH || alike {
            low.length += beads.length;
            low.volume += beads.volume;
            low.rise += beads.rise;
            low.said += beads.said;
        }
    }
    let all = |part: fn(&Beads) -> f64| beads.iter().map(part).sum::<f64>();
    let length = all(|beads| beads.length);
    let rise = low.rise / low.length;
    (length >= LEAST && rise >= RISE_STEP).then(|| Layer {
        rise,
        said: low.said / low.length,
        width: low.volume / low.rise,
        length,
        area: all(|beads| beads.volume) / length,
        told: all(|beads| beads.told) / length,
        role: most.unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found in layers, each with its rise, area and length.
    fn found(layers: &[(f64, f64, f64)], named: bool) -> Vec<(u32, Wrong)> {
        found_if(layers, 0.2, named)
    }

    /// What is found, if the file says that its beads are `said` high.
    fn found_if(
        layers: &[(f64, f64, f64)],
        said: f64,
        named: bool,
    ) -> Vec<(u32, Wrong)> {
        let mut rise = Rise::default();
        let mut number = 0;
        let all = layers.iter().filter_map(|&(up, area, length)| {
            number += 1;
            // A tenth lies on others, and the rest over sparse infill.
            let role = if named {
                Role::OuterWall
            } else {
                Role::Unknown
            };
            let said = (said, 0.08);
            rise.bead(up, 0.1 * length, area, said, role);
            rise.bead(3.0 * up, 0.9 * length, area, said, role);
            Some((number, rise.next_layer(number, 1.0)?))
        });
        all.collect()
    }

    #[test]
    fn a_layer_that_is_left_out_is_missed() {
        let usual = (0.2, 0.08, 100.0);
        let mut layers = vec![usual; 20];
        assert_eq!(found(&layers, true), []);
        layers[12] = (0.4, 0.08, 100.0);
        for named in [true, false] {
            let wrong = found(&layers, named);
            let [(13, Wrong::Left { rise, before })] = wrong[..] else {
                panic!("{wrong:?}");
            };
            assert!((rise - 0.4).abs() < 1e-9 && (before - 0.2).abs() < 1e-9);
        }
        // Thicker layers have more plastic, also if they begin at once.
        layers[12..].fill((0.4, 0.16, 100.0));
        assert_eq!(found(&layers, true), []);
        // What looks like it may be a raft.
        let mut raft = vec![usual; 20];
        raft[4] = (0.4, 0.08, 100.0);
        assert_eq!(found(&raft, false), []);
        assert_eq!(found(&raft, true).len(), 1);
    }

    #[test]
    fn the_first_layer_has_a_height_of_its_own() {
        // Beads of 0.3 mm stand on beads of 0.6 mm.
        let mut layers = vec![(0.35, 0.08, 100.0); 9];
        layers[0] = (0.2, 0.11, 100.0);
        assert_eq!(found_if(&layers, 0.35, true), []);
        // The file says that its layers are less high.
        assert!(!found_if(&layers, 0.2, true).is_empty());
    }

    #[test]
    fn the_same_beads_do_not_get_twice_the_plastic() {
        let mut layers = vec![(0.2, 0.08, 100.0); 20];
        layers[15..].fill((0.2, 0.16, 100.0));
        let [(16, Wrong::Thick { share })] = found(&layers, true)[..] else {
            panic!();
        };
        assert!((share - 2.0).abs() < 1e-9);
        // Other beads may be as thick as they like.
        layers[15..].fill((0.2, 0.16, 80.0));
        assert_eq!(found(&layers, true), []);
        // So may skin that comes where there was a wall.
        let mut rise = Rise::default();
        for (area, role) in [(0.08, Role::OuterWall), (0.16, Role::Skin)] {
            rise.bead(0.2, 100.0, area, (0.2, 0.08), role);
            assert_eq!(rise.next_layer(5, 1.0), None);
        }
        // And a bead that is meant to be twice as wide, where a part stands on an edge.
        let mut rise = Rise::default();
        for area in [0.05, 0.12] {
            let role = Role::OuterWall;
            rise.bead(0.2, 100.0, area, (0.2, area), role);
            assert_eq!(rise.next_layer(5, 1.0), None);
        }
    }
}
