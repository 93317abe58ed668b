//! How long a drive of the base must be: a plain search over a fine grid, for [`base_path`](crate::base_path) to be measured
//! against, of which it uses nothing.
//!
//! Every state is asked about in full, between two of them nobody looks, and turning costs nothing: what it finds is not longer
//! than the shortest way but for the directions of the grid, and those are straightened out afterwards.
//!
//! # Source
//! Hart, Nilsson and Raphael, A formal basis for the heuristic determination of minimum cost paths, 1968.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells are a few hundred from the start, and cells within the grid count from 0"
)]

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::{turn, wrap};

use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::tabletop::{Tabletop, TabletopState};

/// The grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yardstick {
    /// Between two places, metres.
    pub spacing_m: f64,
    /// Between two yaws, degrees.
    pub step_deg: f64,
}

impl Default for Yardstick {
    fn default() -> Self {
        Self { spacing_m: 0.025, step_deg: 7.5 }
    }
}

/// A step of the yaw counts this little, so that of equal ways the one that turns less is found, metres.
const TURN_M: f64 = 1e-4;
/// States that are looked at on the straight drives between the corners of a way are not farther apart, metres and radians.
const LOOK_M: f64 = 0.01;

/// Steps to the places around and those a knight's move away.
const STEPS: [[i32; 2]; 16] = [
    [1, 0],
    [0, 1],
    [-1, 0],
    [0, -1],
    [1, 1],
    [-1, 1],
    [-1, -1],
    [1, -1],
    [2, 1],
    [1, 2],
    [-1, 2],
    [-2, 1],
    [-2, -1],
    [-1, -2],
    [1, -2],
    [2, -1],
];

/// Column, row and yaw.
type Cell = [i32; 3];

struct Grid<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    state: TabletopState<M>,
    spacing_m: f64,
    yaws: i32,
    start: [f64; 3],
    /// Columns and rows reach so far to both sides of the start.
    reach: i32,
    /// By cell: metres from the start, and where from.
    reached: Vec<(f32, Cell)>,
    /// By cell: 0 for not asked about, 1 for clear, 2 for not.
    asked: Vec<u8>,
}

impl Yardstick {
    /// Metres of the shortest way of the base found from the state `from` to `to`, with arm and objects at rest and what is
    /// held in the hand; at least the straight line. `None` if none shorter than `at_most_m` is found.
    pub fn shortest_m<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &[f64; 3],
        at_most_m: f64,
    ) -> Option<f64> {
        let reach = (at_most_m / self.spacing_m).ceil().clamp(0.0, 1000.0) as i32 + 1;
        let yaws = (360.0 / self.step_deg).round().max(1.0) as i32;
        let cells = (2 * reach + 1) as usize * (2 * reach + 1) as usize * yaws as usize;
        let mut grid = Grid {
            m,
            state: from.clone(),
            spacing_m: self.spacing_m,
            yaws,
            start: from.robot.base,
            reach,
            reached: vec![(f32::INFINITY, [0; 3]); cells],
            asked: vec![0; cells],
        };
        let mut way = grid.search(to, at_most_m)?;
        grid.straighten(&mut way);
        let length_m = way.windows(2).map(|pair| straight_m(&pair[0], &pair[1])).sum::<f64>();
        (length_m <= at_most_m).then_some(length_m)
    }
}

fn straight_m(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

impl<M: Manipulator> Grid<'_, M> {
    fn number(&self, [column, row, yaw]: Cell) -> Option<usize> {
        let side = 2 * self.reach + 1;
        let (column, row) = (column + self.reach, row + self.reach);
        let is_inside = (0..side).contains(&column) && (0..side).contains(&row);
        is_inside.then(|| ((row * side + column) as usize) * self.yaws as usize + yaw as usize)
    }

    fn pose(&self, [column, row, yaw]: Cell) -> [f64; 3] {
        let [x, y, heading] = self.start;
        let turned = wrap(heading + f64::from(yaw) * TAU / f64::from(self.yaws));
        [x + f64::from(column) * self.spacing_m, y + f64::from(row) * self.spacing_m, turned]
    }

    fn cell_of(&self, [x, y, yaw]: &[f64; 3]) -> Cell {
        let steps = |d: f64| (d / self.spacing_m).round() as i32;
        let turns = (turn(self.start[2], *yaw) / TAU * f64::from(self.yaws)).round() as i32;
        [steps(x - self.start[0]), steps(y - self.start[1]), turns.rem_euclid(self.yaws)]
    }

    fn is_clear(&mut self, base: &[f64; 3]) -> bool {
        if !self.m.robot().base().contains(base) {
            return false;
        }
        let robot = self.m.manipulator();
        self.state.robot.base = *base;
        if let Some(held) = self.state.mode.held().copied() {
            let pose = robot.world_from_tool(&self.state.robot) * held.tool_from_object;
            if let Some(slot) = self.state.objects.get_mut(held.object.index()) {
                *slot = pose;
            }
        }
        self.m.collision_scene().is_state_clear(robot, &self.state, &Contacts::default(), 0)
    }

    fn is_cell_clear(&mut self, number: usize, cell: Cell) -> bool {
        if self.asked[number] == 0 {
            let base = self.pose(cell);
            self.asked[number] = if self.is_clear(&base) { 1 } else { 2 };
        }
        self.asked[number] == 1
    }

    /// The cells of the shortest way, as poses with both ends exact.
    fn search(&mut self, to: &[f64; 3], at_most_m: f64) -> Option<Vec<[f64; 3]>> {
        let goal = self.cell_of(to);
        let left_m = |grid: &Self, cell: Cell| straight_m(&grid.pose(cell), to);
        let start = [0; 3];
        let number = self.number(start)?;
        self.reached[number] = (0.0, start);
        // Costs in micrometres, which are in order.
        let key = |metres: f64| (metres * 1e6) as u64;
        let mut open = BinaryHeap::from([Reverse((key(left_m(self, start)), 0_u64, start))]);
        while let Some(Reverse((_, cost, cell))) = open.pop() {
            let here_m = f64::from(self.reached[self.number(cell)?].0);
            if cost > key(here_m) {
                continue;
            }
            if cell == goal {
                return Some(self.way_to(goal, to));
            }
            let moves = STEPS.iter().map(|[right, up]| [cell[0] + right, cell[1] + up, cell[2]]);
            let turns = [1, self.yaws - 1].map(|by| [cell[0], cell[1], (cell[2] + by) % self.yaws]);
            for next in moves.chain(turns) {
                let Some(number) = self.number(next) else { continue };
                let step_m = straight_m(&self.pose(cell), &self.pose(next)).max(TURN_M);
                let next_m = here_m + step_m;
                let total_m = next_m + left_m(self, next);
                if total_m > at_most_m + self.spacing_m || next_m + 1e-6 >= f64::from(self.reached[number].0) {
                    continue;
                }
                if self.is_cell_clear(number, next) {
                    self.reached[number] = (next_m as f32, cell);
                    open.push(Reverse((key(total_m), key(f64::from(next_m as f32)), next)));
                }
            }
        }
        None
    }

    fn way_to(&self, goal: Cell, to: &[f64; 3]) -> Vec<[f64; 3]> {
        let mut way = vec![*to];
        let mut cell = goal;
        while let Some((_, before)) = self.number(cell).map(|number| self.reached[number])
            && before != cell
        {
            way.push(self.pose(before));
            cell = before;
        }
        way.reverse();
        way
    }

    /// From every pose straight to the farthest one that can be seen.
    fn straighten(&mut self, way: &mut Vec<[f64; 3]>) {
        let mut i = 0;
        while i + 2 < way.len() {
            let seen = (i + 2..way.len()).rev().find(|j| self.sees(&way[i], &way[*j]));
            if let Some(j) = seen {
                way.drain(i + 1..j);
            }
            i += 1;
        }
    }

    fn sees(&mut self, a: &[f64; 3], b: &[f64; 3]) -> bool {
        let looks = (straight_m(a, b).max(turn(a[2], b[2]).abs()) / LOOK_M).ceil().max(1.0);
        let space = self.m.robot().base().clone();
        (1..looks as u32).all(|look| self.is_clear(&space.interpolate(a, b, f64::from(look) / looks)))
    }
}
