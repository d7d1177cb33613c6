//! Wiping: the nozzle goes on along the bead just printed while the filament is
//! pulled back, so that ooze is spread where there is plastic already.
//!
//! In: the bead. Out: the way, and where it ends. A closed bead is followed
//! once more from its beginning, an open one back from its end. A wipe is never
//! longer than its bead.

use glam::DVec2;
use isoslice_planar::along::parted;
use isoslice_planar::bead::Bead;
use isoslice_settings::Retract;

/// The way of the wipe after a bead, without the bead's end, and the way's last
/// point; none if there is no wipe.
pub(super) fn path(
    bead: &Bead,
    retract: &Retract,
) -> Option<(Vec<DVec2>, DVec2)> {
    if retract.wipe <= 0.0 || retract.length <= 0.0 {
        return None;
    }
    let [mut way, _] = if bead.stroke.closed {
        parted(bead.stroke.path(), retract.wipe)
    } else {
        parted(bead.stroke.path().rev(), retract.wipe)
    };
    way.dedup();
    let way: Vec<DVec2> = way.into_iter().skip(1).collect();
    let end = *way.last()?;
    Some((way, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::{Role, Stroke};
    use isoslice_planar::path_length;

    fn bead(closed: bool) -> Bead {
        Bead::new(
            Role::OuterWall,
            Stroke::new(
                [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]
                    .map(DVec2::from)
                    .to_vec(),
                closed,
                0.45,
            ),
            0.2,
        )
    }

    fn wiped(closed: bool, length: f64) -> Vec<DVec2> {
        let wipe = Retract {
            wipe: length,
            ..Retract::default()
        };
        path(&bead(closed), &wipe).map_or_else(Vec::new, |w| {
            assert_eq!(w.0.last(), Some(&w.1));
            w.0
        })
    }

    #[test]
    fn closed_beads_go_on_and_open_ones_back() {
        assert_eq!(wiped(true, 1.0), [DVec2::new(1.0, 0.0)]);
        assert_eq!(wiped(false, 1.0), [DVec2::new(4.0, 2.0)]);
        let round = [DVec2::new(4.0, 0.0), DVec2::new(4.0, 1.5)];
        assert_eq!(wiped(true, 5.5), round);
        let back = [DVec2::new(4.0, 0.0), DVec2::new(1.5, 0.0)];
        assert_eq!(wiped(false, 5.5), back);
    }

    #[test]
    fn a_wipe_ends_with_its_bead() {
        assert!(wiped(true, 0.0).is_empty());
        let open = wiped(false, 50.0);
        assert_eq!(open.last(), Some(&DVec2::ZERO));
        let closed = wiped(true, 50.0);
        assert_eq!(path_length(&closed, false), 3.0 + 5.0);
        let mut point = bead(false);
        point.stroke.points.truncate(1);
        let wipe = Retract {
            wipe: 1.0,
            ..Retract::default()
        };
        assert!(path(&point, &wipe).is_none());
    }
}
