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

/// Width of a cell, metres.
const CELL_M: f64 = 0.05;
/// How many cells make a full turn.
const TURNS: i64 = 24;
/// With more cells than this nothing is said.
const MOST_CELLS: usize = 300_000;

type Cell = [i64; 3];

/// Whether the base can drive from its start to one of these poses: `Ok` if it can, or if there is too much floor to tell.
///
/// # Errors
/// The floor that it can drive on.
pub(super) fn drive_to_any<M: Manipulator>(
    m: &Tabletop<M>,
    start: &TabletopState<M>,
    wanted: &[[f64; 3]],
) -> Result<(), Box<Floor>> {
    let cell_rad = TAU / TURNS as f64;
    let origin = start.robot.base;
    let place = |[i, j, k]: Cell| {
        let yaw = origin[2] + k as f64 * cell_rad;
        // As the space of the base counts them.
        let yaw = (yaw + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
        [origin[0] + i as f64 * CELL_M, origin[1] + j as f64 * CELL_M, yaw]
    };
    // A pose lies between cells: it is reached with any of those around it.
    let near = |base: &[f64; 3]| {
        let cell = |axis: usize| (base[axis] - origin[axis]) / CELL_M;
        let turn = (base[2] - origin[2]) / cell_rad;
        [cell(0), cell(1), turn].map(|x| [x.floor() as i64, x.ceil() as i64])
    };
    let mut goals = HashSet::new();
    for [is, js, ks] in wanted.iter().map(near) {
        for i in is {
            for j in js {
                goals.extend(ks.map(|k| [i, j, k.rem_euclid(TURNS)]));
            }
        }
    }
    let ahead = |cell: Cell| {
        let [x, y, _] = place(cell);
        let far_m = wanted.iter().map(|[u, v, _]| (x - u).hypot(y - v)).fold(f64::INFINITY, f64::min);
        (far_m / CELL_M) as i64
    };
    let mut walls = BTreeMap::<String, u64>::new();
    let (mut seen, mut open) = (HashSet::from([[0; 3]]), BinaryHeap::from([Reverse((ahead([0; 3]), [0; 3]))]));
    let mut free = HashSet::new();
    while let Some(Reverse((_, cell))) = open.pop() {
        if goals.contains(&cell) || seen.len() > MOST_CELLS {
            return Ok(());
        }
        free.insert([cell[0], cell[1]]);
        for (axis, step) in [(0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1)] {
            let mut next: Cell = cell;
            next[axis] += step;
            next[2] = next[2].rem_euclid(TURNS);
            if !seen.insert(next) {
                continue;
            }
            let q = Configuration { base: place(next), arm: start.robot.arm };
            if !m.robot().base().contains(&q.base) {
                *walls.entry(BOUNDS.to_owned()).or_default() += 1;
            } else if let Err(blame) = m.surroundings().check_base(m.manipulator(), &q) {
                *walls.entry(culprit(m, ObjectId::new(usize::MAX), &blame)).or_default() += 1;
            } else {
                open.push(Reverse((ahead(next), next)));
            }
        }
    }
    let free_m2 = free.len() as f64 * CELL_M * CELL_M;
    Err(Box::new(Floor { free_m2, cell_m: CELL_M, cell_rad, wanted: wanted.len() as u64, walls: ranked(walls) }))
}
