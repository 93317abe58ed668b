//! Ready problems, all on a floor of four by three metres with a robot of 0.15 m and pucks of 0.12 m
//! radius.

use super::setup::Setup;
use super::world::{Point, PuckWorld};
use crate::error::Error;
use crate::problem::Problem;

const FLOOR: Point = [4.0, 3.0];
const ROBOT_M: f64 = 0.15;
const PUCK_M: f64 = 0.12;

/// The result of every constructor here; never an error in practice.
pub type Ready = Result<Problem<PuckWorld>, Error>;

/// A ready problem and its name.
pub type Named = (&'static str, fn() -> Ready);

/// All ready problems.
pub const ALL: [Named; 7] = [
    ("open", open),
    ("wall_with_gap", wall_with_gap),
    ("two_pucks", two_pucks),
    ("four_pucks", four_pucks),
    ("eight_pucks", eight_pucks),
    ("graspable", graspable),
    ("fig3", fig3),
];

/// One puck, nothing in the way.
///
/// # Errors
/// None in practice.
pub fn open() -> Ready {
    Setup::new(FLOOR, ROBOT_M).robot_at([0.5, 1.5]).puck("red", PUCK_M, [1.5, 1.0]).puck_goal(0, [3.0, 2.0]).problem()
}

/// The puck must go through the gap in a wall across the floor.
///
/// # Errors
/// None in practice.
pub fn wall_with_gap() -> Ready {
    Setup::new(FLOOR, ROBOT_M)
        .robot_at([1.5, 2.5])
        .puck("red", PUCK_M, [1.0, 0.8])
        .wall("south wall", [1.9, 0.0], [2.1, 1.0])
        .wall("north wall", [1.9, 1.9], [2.1, 3.0])
        .puck_goal(0, [3.2, 2.3])
        .problem()
}

/// Two pucks that change sides around a pillar.
///
/// # Errors
/// None in practice.
pub fn two_pucks() -> Ready {
    Setup::new(FLOOR, ROBOT_M)
        .robot_at([2.0, 0.5])
        .puck("red", PUCK_M, [1.0, 1.5])
        .puck("blue", PUCK_M, [3.0, 1.5])
        .pillar("pillar", [2.0, 1.5], 0.2)
        .puck_goal(0, [3.0, 2.4])
        .puck_goal(1, [1.0, 0.6])
        .problem()
}

/// Four pucks to be moved from one side to the other.
///
/// # Errors
/// None in practice.
pub fn four_pucks() -> Ready {
    let names = ["red", "blue", "green", "yellow"];
    names
        .iter()
        .zip([0.6, 1.2, 1.8, 2.4])
        .enumerate()
        .fold(Setup::new(FLOOR, ROBOT_M).robot_at([0.4, 1.5]), |setup, (i, (name, y))| {
            setup.puck(name, PUCK_M, [1.2, y]).puck_goal(i, [2.8, y])
        })
        .problem()
}

/// Eight pucks, of which the first must leave the crowd.
///
/// # Errors
/// None in practice.
pub fn eight_pucks() -> Ready {
    let mut setup = Setup::new(FLOOR, ROBOT_M).robot_at([0.4, 0.4]).puck("red", PUCK_M, [2.0, 1.5]);
    for (i, (x, y)) in
        (1_u8..).zip([(1.2, 0.8), (2.0, 0.7), (2.8, 0.8), (1.1, 1.5), (1.2, 2.2), (2.0, 2.3), (2.8, 2.2)])
    {
        setup = setup.puck(&format!("grey {i}"), PUCK_M, [x, y]);
    }
    setup.puck_goal(0, [3.6, 1.5]).problem()
}

/// Pucks in a column on one side of the floor, of which the first `moved` must get to the other side, each to the row of its
/// neighbour; the others may be anywhere. The floor is 4 by 6 metres however many there are.
///
/// # Errors
/// If there are more than eight, which do not fit; none in practice for up to eight.
pub fn many_pucks(count: u8, moved: u8) -> Ready {
    let row = |i: u8| 0.6 + 0.68 * f64::from(i);
    let setup = Setup::new([4.0, 6.0], ROBOT_M).robot_at([0.3, 3.0]);
    let setup = (0..count).fold(setup, |setup, i| setup.puck(&format!("puck {}", i + 1), PUCK_M, [1.2, row(i)]));
    (0..moved.min(count)).fold(setup, |setup, i| setup.puck_goal(usize::from(i), [2.8, row(i ^ 1)])).problem()
}

/// A puck in a corner, where it cannot be pushed away from the walls, but can be grabbed.
///
/// # Errors
/// None in practice.
pub fn graspable() -> Ready {
    Setup::new(FLOOR, ROBOT_M)
        .robot_at([3.0, 0.5])
        .graspable_puck("red", PUCK_M, [0.15, 0.15])
        .pillar("pillar", [2.0, 1.5], 0.4)
        .puck_goal(0, [3.5, 2.5])
        .problem()
}

/// Figure 3 of the paper: a wall hides the puck from the robot so well that every direct way to it is cut
/// off. Sampling full configurations never gets the robot around the wall.
///
/// # Errors
/// None in practice.
pub fn fig3() -> Ready {
    Setup::new(FLOOR, ROBOT_M)
        .robot_at([0.5, 1.5])
        .puck("plate", PUCK_M, [3.0, 1.5])
        .wall("wall", [1.9, 0.6], [2.1, 2.4])
        .puck_goal(0, [3.2, 0.6])
        .problem()
}
