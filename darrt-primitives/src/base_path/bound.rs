//! Lower bounds of the way to the goal: what a disc that the robot contains would have to drive.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use nalgebra::Vector2;

use super::footprint::Footprint;
use super::lattice::{AROUND, Lattice};

/// Ways longer than that from the start by this factor count as equally long.
const BEYOND: f64 = 1.3;

/// Metres to the goal by place, as the lattice goes.
#[derive(Debug, Clone)]
pub(super) enum Bounds<'a> {
    /// As the crow flies.
    Straight(&'a Lattice, Vector2<f64>),
    /// Around what the disc cannot pass: by place, and what is known of places that were not looked at.
    Around(Vec<f64>, f64),
}

/// The disc cannot be there.
const BLOCKED_M: f64 = f64::NEG_INFINITY;

impl<'a> Bounds<'a> {
    /// As if there were no obstacles.
    pub(super) fn straight(lattice: &'a Lattice, goal: [usize; 2]) -> Self {
        Self::Straight(lattice, lattice.at(goal))
    }

    /// From every place to `goal`, as far as ways from `start` need it. The disc may overlap obstacles by `tolerance_m`,
    /// because the poses of a cell lie about its middle. `None` if not even the disc gets from one to the other.
    pub(super) fn around(
        lattice: &Lattice,
        footprint: &Footprint,
        [start, goal]: [[usize; 2]; 2],
        tolerance_m: f64,
    ) -> Option<Self> {
        let mut metres = vec![f64::INFINITY; lattice.places()];
        let [columns, _] = lattice.size();
        let mut open = BinaryHeap::new();
        *metres.get_mut(lattice.place_number(goal))? = 0.0;
        open.push(Reverse((Metres(0.0), lattice.place_number(goal))));
        let mut farthest_m = f64::INFINITY;
        while let Some(Reverse((Metres(here_m), number))) = open.pop() {
            if here_m > farthest_m {
                break;
            }
            if metres.get(number).is_some_and(|m| here_m > *m) {
                continue;
            }
            let place = [number % columns, number / columns];
            if place == start {
                farthest_m = here_m * BEYOND + lattice.spacing_m();
            }
            for step in AROUND {
                let Some(next) = lattice.step(place, step) else { continue };
                let Some(slot) = metres.get_mut(lattice.place_number(next)) else { continue };
                let rows = if step[0] != 0 && step[1] != 0 { std::f64::consts::SQRT_2 } else { 1.0 };
                let next_m = here_m + lattice.spacing_m() * rows;
                if next_m >= *slot {
                    continue;
                }
                let is_new = slot.is_infinite() && next != start;
                if is_new && footprint.beyond_core_m(&lattice.at(next), 0.0) < -tolerance_m {
                    *slot = BLOCKED_M;
                    continue;
                }
                *slot = next_m;
                open.push(Reverse((Metres(next_m), lattice.place_number(next))));
            }
        }
        farthest_m.is_finite().then_some(Self::Around(metres, farthest_m))
    }

    /// Metres from a place; infinite where the disc cannot be.
    pub(super) fn metres(&self, lattice_place: [usize; 2], number: usize) -> f64 {
        match self {
            Self::Straight(lattice, goal) => (lattice.at(lattice_place) - goal).norm(),
            Self::Around(metres, farthest_m) => match metres.get(number) {
                Some(m) if *m != BLOCKED_M => m.min(*farthest_m),
                _ => f64::INFINITY,
            },
        }
    }
}

/// Metres in the order of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Metres(f64);

impl Eq for Metres {}

impl PartialOrd for Metres {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Metres {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}
