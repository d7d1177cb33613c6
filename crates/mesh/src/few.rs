//! The few triangles that may be closest to any place of a ball.
//!
//! ```text
//!      . - - - .         d  from the middle to the closest triangle
//!    .   . - .   .       r  from the middle to the place
//!   .   .  +-.-p  .      No triangle is farther than d + r from the place that is
//!    .   . - .   .       closest to it, and so d + 2r from the middle: all of
//!      . - - - .         those are known.
//! ```
//!
//! In: places that follow one another closely, such as those of a lattice. Out: the
//! closest triangles, the same as a search through the tree finds. Where triangles
//! are large and lie loosely, a ball has two or three of them, and a search takes
//! ten times as long as a look at those.

use crate::closest::Near;
use crate::shell::{Reach, Shell};
use crate::tree::Node;
use glam::DVec3;
use std::cell::Cell;

/// Most triangles of a ball. A search looks at about as many.
const MOST: usize = 8;
/// How many steps between places a ball reaches from its middle: the side of a
/// leaf of the lattice.
const STEPS: f64 = 8.5;
/// Balls that are kept. So many cover a leaf of the lattice, which is gone through
/// row by row.
const BALLS: usize = 4;
/// A ball that fewer places ask was not worth its while. With any number from 1 to 8
/// a place among 2,000 loose triangles takes 0.8 µs, with 16 takes 1.0, and without
/// balls 2.7.
const WORTH: u32 = 4;
/// How many places do without a new ball after one that was not worth its while.
/// Where triangles are many, no ball is: among 20,000 loose ones a place takes 4 µs
/// if each makes a ball, and 2.4 with any pause from 16 on, as without balls.
const PAUSE: u32 = 16;

/// A ball, and the triangles that may be closest to its places.
#[derive(Default)]
struct Ball {
    middle: DVec3,
    /// How far from the middle places may be; 0 if there is no ball.
    reach: f64,
    triangles: Vec<usize>,
    /// How many places have asked.
    asked: u32,
}

/// What is kept from place to place.
#[derive(Default)]
pub(crate) struct Few {
    balls: [Ball; BALLS],
    /// The number of the oldest ball.
    oldest: usize,
    /// The last place that was asked for, and how far the place before it was.
    last: Option<(DVec3, f64)>,
    /// How many places do without a new ball.
    pause: u32,
}

impl Few {
    /// The triangle that is closest to a place, which `search` finds too.
    pub(crate) fn nearest(
        &mut self,
        shell: &Shell,
        p: DVec3,
        search: impl FnOnce() -> Near,
    ) -> Near {
        // Ways from row to row are longer than steps.
        let step = self.last.map_or(f64::INFINITY, |l| p.distance(l.0));
        let before = self.last.replace((p, step)).map_or(step, |l| l.1);
        let holds = |ball: &&mut Ball| p.distance(ball.middle) < ball.reach;
        if let Some(ball) = self.balls.iter_mut().find(holds) {
            ball.asked += 1;
            return shell.nearest_of(&ball.triangles, p);
        }
        let near = search();
        let reach = STEPS * step.min(before);
        if self.pause > 0 {
            self.pause -= 1;
        } else if reach.is_finite() {
            self.renew(shell, p, near.square.sqrt(), reach);
        }
        near
    }

    /// Makes a ball around a place that is `distance` away from the closest
    /// triangle, in place of the oldest one.
    fn renew(&mut self, shell: &Shell, p: DVec3, distance: f64, reach: f64) {
        let ball = &mut self.balls[self.oldest];
        self.oldest = (self.oldest + 1) % BALLS;
        let was_worth = ball.reach == 0.0 || ball.asked >= WORTH;
        let roundings = 1e-9 * (distance + p.abs().max_element());
        let all = distance + 2.0 * reach + roundings;
        ball.triangles.clear();
        let found = shell.within(p, all, MOST, &mut ball.triangles);
        (ball.middle, ball.asked) = (p, 0);
        ball.reach = if found { reach } else { 0.0 };
        if !(found && was_worth) {
            self.pause = PAUSE;
        }
    }
}

impl Shell {
    /// Adds all triangles that are within a distance of a place, and perhaps some
    /// more. False if there are more than `most`.
    fn within(
        &self,
        p: DVec3,
        distance: f64,
        most: usize,
        found: &mut Vec<usize>,
    ) -> bool {
        let reach = Reach::around(p);
        let square = distance * distance;
        let limit = reach.limit(square);
        let few = Cell::new(true);
        let is_near = |node: &Node| {
            let left = few.get();
            reach.squares(node).map(|square| left && square <= limit)
        };
        self.tree.visit(is_near, |first, end| {
            let near = |i: &usize| self.look(*i, p).square <= square;
            found.extend((first..end).filter(near));
            few.set(few.get() && found.len() <= most);
        });
        few.get()
    }

    /// The triangle that is closest to a place, of some that include it.
    fn nearest_of(&self, triangles: &[usize], p: DVec3) -> Near {
        let mut best = Near::NOTHING;
        for &triangle in triangles {
            let near = self.look(triangle, p);
            if near.is_closer(&best) {
                best = near;
            }
        }
        best
    }
}
