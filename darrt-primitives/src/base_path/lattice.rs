//! Poses of the base in rows: places in a square grid, times yaws that include those of both ends and the quarter turns.

use std::f64::consts::TAU;

use darrt_core::space::so2::{turn, wrap};
use nalgebra::Vector2;

/// Yaws nearer than this are one, radians.
const SAME_RAD: f64 = 0.01;

/// A point of a lattice: column, row and yaw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell {
    pub(super) place: [usize; 2],
    pub(super) yaw: usize,
}

/// The poses. One of the places is that of the start, bit for bit.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    /// Place of column and row 0.
    origin: Vector2<f64>,
    spacing_m: f64,
    /// Number of columns and rows.
    size: [usize; 2],
    /// In `(-pi, pi]`, ascending.
    yaws: Vec<f64>,
}

impl Lattice {
    /// Rows through `start` that fill the rectangle from `low` to `high`, which holds it; yaws at most `step_rad` apart,
    /// among them those of `ends`.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers from 0 on")]
    pub(super) fn new(
        start: &Vector2<f64>,
        [low, high]: [Vector2<f64>; 2],
        ends: [f64; 2],
        spacing_m: f64,
        step_rad: f64,
    ) -> Self {
        let before = (start - low).map(|d| (d / spacing_m).floor().max(0.0));
        let after = (high - start).map(|d| (d / spacing_m).floor().max(0.0));
        let steps = (TAU / step_rad).ceil().max(1.0);
        let count = steps as usize;
        let mut yaws: Vec<f64> = (0..count).map(|i| wrap(i as f64 * TAU / steps)).collect();
        for end in ends {
            yaws.retain(|yaw| turn(*yaw, end).abs() > SAME_RAD || ends.contains(yaw));
            if !yaws.contains(&end) {
                yaws.push(end);
            }
        }
        yaws.sort_by(f64::total_cmp);
        Self {
            origin: start - before * spacing_m,
            spacing_m,
            size: [(before.x + after.x) as usize + 1, (before.y + after.y) as usize + 1],
            yaws,
        }
    }

    /// Number of places.
    pub(super) fn places(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Number of poses.
    pub(super) fn len(&self) -> usize {
        self.places() * self.yaws.len()
    }

    /// Distance between two rows, metres.
    pub(super) fn spacing_m(&self) -> f64 {
        self.spacing_m
    }

    /// Number of columns and rows.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The place of a column and a row.
    pub(super) fn at(&self, [column, row]: [usize; 2]) -> Vector2<f64> {
        self.origin + Vector2::new(column as f64, row as f64) * self.spacing_m
    }

    /// The pose of a cell.
    pub(super) fn pose(&self, cell: Cell) -> [f64; 3] {
        let at = self.at(cell.place);
        [at.x, at.y, self.yaws.get(cell.yaw).copied().unwrap_or(0.0)]
    }

    /// The cell nearest to a pose that lies in the rectangle.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number from 0 on")]
    pub(super) fn nearest(&self, [x, y, yaw]: &[f64; 3]) -> Cell {
        let steps = (Vector2::new(*x, *y) - self.origin) / self.spacing_m;
        let index = |step: f64, count: usize| (step.round().max(0.0) as usize).min(count - 1);
        let by_turn = |i: &usize, j: &usize| {
            let off = |i: &usize| self.yaws.get(*i).map_or(TAU, |other| turn(*other, *yaw).abs());
            off(i).total_cmp(&off(j))
        };
        let yaw = (0..self.yaws.len()).min_by(by_turn).unwrap_or(0);
        Cell { place: [index(steps.x, self.size[0]), index(steps.y, self.size[1])], yaw }
    }

    /// The number of a place.
    pub(super) fn place_number(&self, [column, row]: [usize; 2]) -> usize {
        row * self.size[0] + column
    }

    /// The number of a cell, less than [`Lattice::len`].
    pub(super) fn number(&self, cell: Cell) -> usize {
        self.place_number(cell.place) * self.yaws.len() + cell.yaw
    }

    /// The place a step away; `None` past the edge.
    pub(super) fn step(&self, [column, row]: [usize; 2], [right, up]: [isize; 2]) -> Option<[usize; 2]> {
        let (column, row) = (column.checked_add_signed(right)?, row.checked_add_signed(up)?);
        (column < self.size[0] && row < self.size[1]).then_some([column, row])
    }

    /// The next yaws on both sides.
    pub(super) fn turned(&self, yaw: usize) -> [usize; 2] {
        let count = self.yaws.len();
        [(yaw + 1) % count, (yaw + count - 1) % count]
    }
}

/// The eight steps to the places around.
pub(super) const AROUND: [[isize; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice() -> Lattice {
        let corners = [Vector2::new(-1.0, -2.0), Vector2::new(3.0, 1.0)];
        Lattice::new(&Vector2::new(0.123, 0.456), corners, [0.3, -1.5], 0.1, 0.26)
    }

    #[test]
    fn numbers_and_cells_belong_together() {
        let lattice = lattice();
        let ([columns, rows], yaws) = (lattice.size(), lattice.yaws.len());
        let cells = (0..columns * rows * yaws).map(|number| (number, number / yaws, number % yaws));
        for (number, place, yaw) in cells {
            let cell = Cell { place: [place % columns, place / columns], yaw };
            assert_eq!(lattice.number(cell), number);
            assert_eq!(lattice.nearest(&lattice.pose(cell)), cell);
        }
        assert_eq!(lattice.len(), columns * rows * yaws);
    }

    #[test]
    fn both_ends_and_quarter_turns_are_yaws_and_the_start_is_a_place() {
        let lattice = lattice();
        for yaw in [0.3, -1.5, 0.0, TAU / 4.0, -TAU / 4.0] {
            let cell = lattice.nearest(&[0.123, 0.456, yaw]);
            assert!((turn(lattice.pose(cell)[2], yaw)).abs() < 0.1);
        }
        let start = [0.123, 0.456, 0.3];
        let [x, y, yaw] = lattice.pose(lattice.nearest(&start));
        assert!((x - 0.123).abs() < 1e-12 && (y - 0.456).abs() < 1e-12 && yaw == 0.3);
        let gaps = lattice.yaws.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(gaps.fold(0.0, f64::max) <= 0.2619 && lattice.yaws.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn steps_end_at_the_edge() {
        let lattice = lattice();
        let [columns, rows] = lattice.size();
        assert_eq!(lattice.step([0, 0], [-1, 0]), None);
        assert_eq!(lattice.step([columns - 1, rows - 1], [0, 1]), None);
        assert_eq!(lattice.step([1, 1], [-1, 1]), Some([0, 2]));
        assert_eq!(lattice.turned(0), [1, lattice.yaws.len() - 1]);
    }
}
