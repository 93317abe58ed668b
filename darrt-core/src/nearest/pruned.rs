//! The nearest node among those that a lower bound does not rule out.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::bounds::{Aim, LANES, Lanes, Ways};
use super::linear::nearest_node_by;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::tree::{Node, NodeId, Tree};

/// The node of the least `measure` plus penalty, as [`nearest_by`](super::linear::nearest_by) finds it.
///
/// `bound` writes, for every lane of the [`Ways`], a number that the measure of a node with these ways is never below; it may
/// only grow with each of them. The better the bound, the fewer nodes are measured.
pub fn nearest_pruned<D: Domain>(
    m: &D,
    tree: &Tree<D>,
    to: &PartialState<D>,
    bound: impl Fn(&Ways, &mut Lanes),
    measure: impl Fn(&Node<D>) -> f64,
) -> Option<NodeId> {
    let aim = tree.indices().and_then(|indices| Aim::new(m, to, indices));
    let Some((coordinate_index, aim, mut ways)) = aim else { return nearest_node_by(tree, measure) };
    let mut best = Best { least: None };
    let look = |best: &mut Best, index: u32| {
        if let Some(node) = tree.at(index) {
            best.offer(measure(node) + tree.penalty_m(node), index);
        }
    };
    for index in coordinate_index.odd() {
        look(&mut best, *index);
    }
    let mut open = BinaryHeap::with_capacity(4 * LANES);
    open.push(Reverse(Open { at_least_m: 0.0, height: coordinate_index.height() - 1, block: 0 }));
    let mut at_least = [0.0; LANES];
    while let Some(Reverse(Open { at_least_m, height, block })) = open.pop() {
        if best.rules_out(at_least_m) {
            break;
        }
        let Some((lower, upper)) = coordinate_index.block(height, block) else { continue };
        aim.look(m, lower, upper, &mut ways);
        bound(&ways, &mut at_least);
        if height == 0 {
            let mut promising = (f32::INFINITY, None);
            let (nodes, placements) = coordinate_index.nodes(block);
            for (lane, (at_least_m, placement)) in at_least.iter_mut().zip(placements).enumerate() {
                *at_least_m += super::coordinate_index::narrow(tree.penalty_at(*placement));
                if *at_least_m < promising.0 {
                    promising = (*at_least_m, Some(lane));
                }
            }
            // OPTIMIZATION: the most promising node first; it often rules out the rest of the block.
            let first = promising.1.filter(|_| !best.rules_out(promising.0));
            if let Some(index) = first.and_then(|lane| nodes.get(lane)) {
                look(&mut best, *index);
            }
            for (lane, (at_least_m, index)) in at_least.iter().zip(nodes).enumerate() {
                if Some(lane) != first && !best.rules_out(*at_least_m) {
                    look(&mut best, *index);
                }
            }
            continue;
        }
        for (lane, (at_least_m, penalty_m)) in
            at_least.iter().zip(coordinate_index.penalties_m(height, block)).enumerate()
        {
            let sum = at_least_m + penalty_m;
            // No number rules nothing out.
            let at_least_m = if sum.is_nan() { 0.0 } else { sum };
            if !best.rules_out(at_least_m) {
                open.push(Reverse(Open { at_least_m, height: height - 1, block: block * LANES + lane }));
            }
        }
    }
    best.least.and_then(|(_, index)| NodeId::at(index as usize))
}

/// What is left of a sum of up to a hundred bounds in single precision when all roundings of the sum went up.
const SUMMED: f64 = 1.0 - 1e-5;

/// A block that may hold the nearest node.
struct Open {
    at_least_m: f32,
    height: usize,
    block: usize,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_bound = self.at_least_m.total_cmp(&other.at_least_m);
        by_bound.then(self.height.cmp(&other.height)).then(self.block.cmp(&other.block))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

/// The best node so far.
struct Best {
    least: Option<(f64, u32)>,
}

impl Best {
    fn rules_out(&self, at_least_m: f32) -> bool {
        let at_least_m = f64::from(at_least_m) * SUMMED;
        self.least.is_some_and(|(least, _)| at_least_m > least)
    }

    fn offer(&mut self, metres: f64, index: u32) {
        let is_better = self.least.is_none_or(|(least, best)| {
            metres < least
                || (metres == least && index < best)
                || (least.is_nan() && (!metres.is_nan() || index < best))
        });
        if is_better {
            self.least = Some((metres, index));
        }
    }
}
