//! A* over the lattice: the cheapest way between two poses along its rows and yaws.
//!
//! Cells are looked at when a neighbour is expanded. Where a pose is far from everything its neighbours are known to be clear
//! without a look. A cell that collides in the middle of a narrow passage is moved within itself to where it does not.
//!
//! # Source
//! Hart, Nilsson and Raphael, A formal basis for the heuristic determination of minimum cost paths, 1968; the weight on the
//! bound: Pohl, First results on the effect of error in heuristic search, 1970.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use darrt_core::space::so2::turn;

use super::bound::Bounds;
use super::lattice::{AROUND, Cell, Lattice};
use super::nudge::Room;
use super::sight::{FAR_M, Sight, Stop};

/// The bound on the rest of the way counts so many times: a way found costs at most so many times the cheapest of the lattice.
const WEIGHT: f64 = 1.1;

/// How far a cell may be moved in itself, as a share of the distance to the next one.
const WITHIN: f64 = 0.6;

/// Poses of the lattice from here on are connected with the goal, in rows and in steps of the yaw.
const NEAR_ROWS: f64 = 1.6;

/// How far outside a narrow passage it is entered and left, in rows.
const EXITS: [f64; 2] = [1.0, 2.0];

/// How a search ended.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// The poses of the way, both ends among them.
    Found(Vec<[f64; 3]>),
    /// All that can be reached has been seen.
    Enclosed,
    /// It was stopped.
    Stopped,
}

/// What is known of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    Unseen,
    Blocked,
    Node(u32),
}

/// A pose that can be reached.
#[derive(Debug, Clone, Copy)]
struct Node {
    stop: Stop,
    /// Is `stop.clear_m` what a look has shown, not what follows from a neighbour?
    is_seen: bool,
    /// Has it been pushed into the middle of a passage?
    is_pushed: bool,
    is_closed: bool,
    /// `None` for the goal.
    cell: Option<Cell>,
    /// Of the cheapest way found from the start, metres.
    cost_m: f64,
    /// What the rest costs at least, metres.
    bound_m: f64,
    parent: u32,
    /// A pose on the way from the parent.
    via: Option<[f64; 3]>,
}

/// A node to be expanded; the greatest is expanded first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Open {
    total_m: f64,
    cost_m: f64,
    node: u32,
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of equally promising ones the one that has come farthest, then the oldest.
        let by_total = other.total_m.total_cmp(&self.total_m);
        by_total.then(self.cost_m.total_cmp(&other.cost_m)).then(other.node.cmp(&self.node))
    }
}

/// A search from a start to a goal.
pub(super) struct Search<'a, 's> {
    sight: &'a mut Sight<'s>,
    lattice: &'a Lattice,
    bounds: &'a Bounds<'a>,
    room: Room,
    step_rad: f64,
    goal: [f64; 3],
    /// Only ways that cost less are wanted, metres.
    below_m: f64,
    /// By number of the cell.
    known: Vec<Known>,
    /// The goal, the start, and what was reached.
    nodes: Vec<Node>,
    open: BinaryHeap<Open>,
}

const GOAL: u32 = 0;
const START: u32 = 1;

impl<'a, 's> Search<'a, 's> {
    /// Begins at `start`. `bounds` are those of the goal; yaws of the lattice are at most `step_rad` apart.
    pub(super) fn new(
        sight: &'a mut Sight<'s>,
        lattice: &'a Lattice,
        bounds: &'a Bounds<'a>,
        step_rad: f64,
        [start, goal]: [Stop; 2],
    ) -> Self {
        let room = Room { shift_m: WITHIN * lattice.spacing_m(), turn_rad: WITHIN * step_rad };
        let known = vec![Known::Unseen; lattice.len()];
        let (nodes, open) = (Vec::new(), BinaryHeap::new());
        let mut search =
            Self { sight, lattice, bounds, room, step_rad, goal: goal.at, below_m: f64::INFINITY, known, nodes, open };
        search.add(goal, true, None);
        search.add(start, true, Some(lattice.nearest(&start.at)));
        search.arrive(START, START, 0.0, None);
        search
    }

    /// Looks only for ways that cost less.
    pub(super) fn below(mut self, below_m: f64) -> Self {
        self.below_m = below_m;
        self
    }

    /// Expands up to `expansions` nodes, as long as no more than `looks` poses have been looked at in all.
    pub(super) fn run(&mut self, expansions: usize, looks: usize) -> Outcome {
        let mut left = expansions;
        while let Some(Open { node, cost_m, .. }) = self.open.pop() {
            let Some(current) = self.node(node) else { continue };
            if current.is_closed || current.cost_m < cost_m {
                continue;
            }
            let Some(cell) = current.cell else { return Outcome::Found(self.way_to_goal()) };
            if left == 0 || self.sight.footprint.looks() >= looks {
                return Outcome::Stopped;
            }
            left -= 1;
            self.expand(node, cell);
        }
        Outcome::Enclosed
    }

    /// What the rest of a way costs at least from a pose, metres.
    fn rest_m(&self, cell: Cell, at: &[f64; 3]) -> f64 {
        let turn_m = self.sight.terms.turn_m * turn(at[2], self.goal[2]).abs();
        self.bounds.metres(cell.place, self.lattice.place_number(cell.place)) + turn_m
    }

    fn node(&self, node: u32) -> Option<Node> {
        self.nodes.get(node as usize).copied()
    }

    /// A new node, to which no way is known yet.
    fn add(&mut self, stop: Stop, is_seen: bool, cell: Option<Cell>) -> u32 {
        let bound_m = cell.map_or(0.0, |cell| self.rest_m(cell, &stop.at));
        #[expect(
            clippy::cast_possible_truncation,
            reason = "fewer nodes than cells, of which there are fewer than 2^32"
        )]
        let number = self.nodes.len() as u32;
        let is_pushed = cell.is_some_and(|cell| self.lattice.pose(cell) != stop.at);
        let parent = number;
        let node = Node {
            stop,
            is_seen,
            is_pushed,
            is_closed: false,
            cell,
            cost_m: f64::INFINITY,
            bound_m,
            parent,
            via: None,
        };
        self.nodes.push(node);
        if let Some(slot) = cell.and_then(|cell| self.known.get_mut(self.lattice.number(cell))) {
            *slot = Known::Node(number);
        }
        number
    }

    /// A way to `node` that costs `cost_m`: is it the cheapest so far?
    fn arrive(&mut self, node: u32, parent: u32, cost_m: f64, via: Option<[f64; 3]>) {
        let Some(slot) = self.nodes.get_mut(node as usize) else { return };
        if cost_m < slot.cost_m && cost_m + slot.bound_m < self.below_m {
            (slot.cost_m, slot.parent, slot.via) = (cost_m, parent, via);
            self.open.push(Open { total_m: cost_m + WEIGHT * slot.bound_m, cost_m, node });
        }
    }

    fn expand(&mut self, number: u32, cell: Cell) {
        let Some(mut here) = self.node(number) else { return };
        here.is_closed = true;
        if !here.is_seen && here.stop.clear_m < FAR_M / 2.0 {
            // A look shows how far the neighbours are clear.
            let seen_m = self.sight.footprint.distance_m(&here.stop.at, FAR_M, f64::NEG_INFINITY);
            here.stop.clear_m = here.stop.clear_m.max(seen_m);
            here.is_seen = true;
        }
        if let Some(slot) = self.nodes.get_mut(number as usize) {
            *slot = here;
        }
        for step in AROUND {
            let Some(place) = self.lattice.step(cell.place, step) else { continue };
            let is_blocked = self.reach(number, &here, Cell { place, ..cell }).is_break();
            if is_blocked && let Some(place) = self.lattice.step(place, step) {
                // The mouth of a narrow passage: no pose beside it is pushed into it.
                self.reach_passage(number, &here, Cell { place, ..cell });
            }
        }
        for yaw in self.lattice.turned(cell.yaw) {
            if yaw != cell.yaw {
                let _ = self.reach(number, &here, Cell { yaw, ..cell });
            }
        }
        let rows = (0..2).map(|i| (self.goal[i] - here.stop.at[i]).abs() / self.lattice.spacing_m());
        let turns = turn(here.stop.at[2], self.goal[2]).abs() / self.step_rad;
        if rows.fold(turns, f64::max) <= NEAR_ROWS {
            self.connect(number, &here, GOAL);
        }
    }

    /// Tries the step from a node to a cell; `Break` if the cell is blocked.
    fn reach(&mut self, from: u32, here: &Node, cell: Cell) -> ControlFlow<()> {
        let number = self.lattice.number(cell);
        let at = self.lattice.pose(cell);
        if here.cost_m + self.sight.open_cost_m(&here.stop.at, &at) + self.rest_m(cell, &at) >= self.below_m {
            return ControlFlow::Continue(());
        }
        let to = match self.known.get(number) {
            Some(Known::Node(to)) => *to,
            Some(Known::Unseen) => {
                if let Some((stop, is_seen)) = self.look(here, cell) {
                    self.add(stop, is_seen, Some(cell))
                } else {
                    if let Some(slot) = self.known.get_mut(number) {
                        *slot = Known::Blocked;
                    }
                    return ControlFlow::Break(());
                }
            }
            _ => return ControlFlow::Break(()),
        };
        self.connect(from, here, to);
        ControlFlow::Continue(())
    }

    /// Tries the way from a node to a cell behind a blocked one, if it is in a narrow passage.
    fn reach_passage(&mut self, from: u32, here: &Node, cell: Cell) {
        match self.known.get(self.lattice.number(cell)) {
            Some(Known::Node(to)) => {
                let to = *to;
                if self.node(to).is_some_and(|there| there.is_pushed) {
                    self.connect(from, here, to);
                }
            }
            Some(Known::Unseen) => {
                if let Some(stop) = self.sight.stop_beside(&self.lattice.pose(cell), self.room) {
                    let to = self.add(stop, true, Some(cell));
                    self.connect(from, here, to);
                }
            }
            _ => {}
        }
    }

    /// Where to stop in a cell beside a node, and whether that was looked at.
    fn look(&mut self, here: &Node, cell: Cell) -> Option<(Stop, bool)> {
        let at = self.lattice.pose(cell);
        let known_m = here.stop.clear_m - self.sight.travel_m(&here.stop.at, &at);
        if known_m >= self.sight.terms.wanted_m && self.sight.footprint.is_within(&at) {
            return Some((Stop { at, clear_m: known_m }, false));
        }
        if self.bounds.metres(cell.place, self.lattice.place_number(cell.place)).is_infinite() {
            return None;
        }
        let stop = self.sight.stop(&at).or_else(|| self.sight.stop_beside(&at, self.room));
        stop.map(|stop| (stop, true))
    }

    /// Tries the drive from one node to another.
    fn connect(&mut self, from: u32, here: &Node, to: u32) {
        let Some(there) = self.node(to) else { return };
        let open_m = self.sight.open_cost_m(&here.stop.at, &there.stop.at);
        if there.is_closed || here.cost_m + open_m >= there.cost_m {
            return;
        }
        if let Some(cost_m) = self.sight.cost_m(&here.stop, &there.stop) {
            self.arrive(to, from, here.cost_m + cost_m, None);
        } else if here.stop.clear_m.min(there.stop.clear_m) < self.sight.terms.wanted_m {
            // In a narrow passage.
            if let Some((cost_m, via)) = self.by_way(&here.stop, &there.stop) {
                self.arrive(to, from, here.cost_m + cost_m, Some(via));
            }
        }
    }

    /// What the way from one stop of a narrow passage to another costs by a pose between, and that.
    fn by_way(&mut self, here: &Stop, there: &Stop) -> Option<(f64, [f64; 3])> {
        // Two poses in its middle may have no straight drive between them.
        let middle = self.sight.between(&here.at, &there.at, 0.5);
        let middle = self.sight.stop_beside(&middle, self.room);
        if let Some(found) = middle.and_then(|via| self.by(here, &via, there)) {
            return Some(found);
        }
        // It is entered and left straight ahead.
        for steps in EXITS {
            let way_m = steps * self.lattice.spacing_m();
            for (inside, outside) in [(there, here), (here, there)] {
                let via = self.sight.stop_along(inside, &outside.at, way_m);
                if let Some(found) = via.and_then(|via| self.by(here, &via, there)) {
                    return Some(found);
                }
            }
        }
        None
    }

    fn by(&mut self, here: &Stop, via: &Stop, there: &Stop) -> Option<(f64, [f64; 3])> {
        let cost_m = self.sight.cost_m(here, via)? + self.sight.cost_m(via, there)?;
        Some((cost_m, via.at))
    }

    fn way_to_goal(&self) -> Vec<[f64; 3]> {
        let mut way = Vec::new();
        let mut number = GOAL;
        while let Some(node) = self.node(number) {
            way.push(node.stop.at);
            way.extend(node.via);
            if node.parent == number {
                break;
            }
            number = node.parent;
        }
        way.reverse();
        way
    }
}
