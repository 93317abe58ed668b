//! Where the base can drive: the free floor around it, in cells of x, y and yaw.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, HashSet};
use std::f64::consts::TAU;

use darrt_core::domain::Domain as _;
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::ObjectId;
use darrt_primitives::manipulator::{Configuration, Manipulator};
use darrt_primitives::tabletop::{Tabletop, TabletopState};

use super::cause::Floor;
use super::hands::{BOUNDS, culprit, ranked};

/// Two sizes of cells: large ones mostly tell where there is a way, small ones where there is none.
const COARSE: Cells = Cells { width_m: 0.1, turns: 16, is_searched: false, most: 100_000 };
const FINE: Cells = Cells { width_m: 0.05, turns: 24, is_searched: true, most: 1_000_000 };

type Cell = [i64; 3];

/// How the poses of the base are divided.
#[derive(Clone, Copy)]
struct Cells {
    width_m: f64,
    /// How many make a full turn.
    turns: i64,
    /// Is a cell free if the base is clear anywhere in it, of 27 poses, and not only in its middle? So a narrow door is not
    /// taken for a wall because no cell lies in its middle.
    is_searched: bool,
    /// With more of them nothing is said.
    most: usize,
}

/// What a flood of cells comes to.
enum Flood {
    Reached,
    TooMuch,
    Ended(Box<Floor>),
}

/// Whether the base can drive from its start to one of these poses: `Ok` if it can, or if there is too much floor to tell.
///
/// # Errors
/// The floor that it can drive on.
pub(super) fn drive_to_any<M: Manipulator>(
    m: &Tabletop<M>,
    start: &TabletopState<M>,
    wanted: &[[f64; 3]],
) -> Result<(), Box<Floor>> {
    if matches!(flood(m, start, wanted, COARSE), Flood::Reached) {
        return Ok(());
    }
    match flood(m, start, wanted, FINE) {
        Flood::Ended(floor) => Err(floor),
        Flood::Reached | Flood::TooMuch => Ok(()),
    }
}

/// From the cell of the start to its free neighbours and on, those nearest to a wanted pose first.
#[expect(clippy::cast_possible_truncation, reason = "the floor has bounds, and so have the indices of its cells")]
fn flood<M: Manipulator>(m: &Tabletop<M>, start: &TabletopState<M>, wanted: &[[f64; 3]], cells: Cells) -> Flood {
    let Cells { width_m, turns, is_searched, most } = cells;
    let turn_rad = TAU / turns as f64;
    let origin = start.robot.base;
    // As the space of the base counts turns.
    let wrapped = |yaw: f64| (yaw + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
    let place = |[i, j, k]: Cell, [u, v, w]: [f64; 3]| {
        let at = |index: i64, offset: f64| index as f64 + offset;
        let yaw = wrapped(origin[2] + at(k, w) * turn_rad);
        [origin[0] + at(i, u) * width_m, origin[1] + at(j, v) * width_m, yaw]
    };
    // A pose lies between the middles of cells: it is reached with any of them.
    let near = |base: &[f64; 3]| {
        let steps =
            [(base[0] - origin[0]) / width_m, (base[1] - origin[1]) / width_m, (base[2] - origin[2]) / turn_rad];
        steps.map(|x| [x.floor() as i64, x.ceil() as i64])
    };
    let mut goals = HashSet::new();
    for [is, js, ks] in wanted.iter().map(near) {
        for i in is {
            for j in js {
                goals.extend(ks.map(|k| [i, j, k.rem_euclid(turns)]));
            }
        }
    }
    let ahead = |cell: Cell| {
        let [x, y, _] = place(cell, [0.0; 3]);
        let far_m = wanted.iter().map(|[u, v, _]| (x - u).hypot(y - v)).fold(f64::INFINITY, f64::min);
        (far_m / width_m) as i64
    };
    // What is in the way in the middle of a cell, if the base is clear nowhere in it.
    let blocked = |cell: Cell| {
        let check = |offset: [f64; 3]| {
            let q = Configuration { base: place(cell, offset), arm: start.robot.arm };
            if !m.robot().base().contains(&q.base) {
                return Some(BOUNDS.to_owned());
            }
            let found = m.collision_scene().check_base(m.manipulator(), &q);
            found.err().map(|blame| culprit(m, ObjectId::new(usize::MAX), &blame))
        };
        let in_the_middle = check([0.0; 3])?;
        let is_clear = is_searched && offsets().any(|offset| check(offset).is_none());
        (!is_clear).then_some(in_the_middle)
    };
    let mut walls = BTreeMap::<String, u64>::new();
    let (mut seen, mut open) = (HashSet::from([[0; 3]]), BinaryHeap::from([Reverse((ahead([0; 3]), [0; 3]))]));
    let mut free = HashSet::new();
    while let Some(Reverse((_, cell))) = open.pop() {
        if goals.contains(&cell) {
            return Flood::Reached;
        }
        if seen.len() > most {
            return Flood::TooMuch;
        }
        let [i, j, k] = cell;
        free.insert([i, j]);
        let around = [[i + 1, j, k], [i - 1, j, k], [i, j + 1, k], [i, j - 1, k], [i, j, k + 1], [i, j, k - 1]];
        for next in around.map(|[i, j, k]| [i, j, k.rem_euclid(turns)]) {
            if !seen.insert(next) {
                continue;
            }
            match blocked(next) {
                Some(body) => *walls.entry(body).or_default() += 1,
                None => open.push(Reverse((ahead(next), next))),
            }
        }
    }
    let free_m2 = free.len() as f64 * width_m * width_m;
    let (cell_m, cell_rad, wanted) = (width_m, turn_rad, wanted.len() as u64);
    Flood::Ended(Box::new(Floor { free_m2, cell_m, cell_rad, wanted, walls: ranked(walls) }))
}

/// Places in a cell besides its middle, as parts of it.
fn offsets() -> impl Iterator<Item = [f64; 3]> {
    let steps = [0.0, -0.25, 0.25];
    steps.into_iter().flat_map(move |u| steps.into_iter().flat_map(move |v| steps.map(|w| [u, v, w]))).skip(1)
}
