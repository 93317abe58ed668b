//! The linear scan.

use crate::domain::Domain;
use crate::state::State;
use crate::tree::{Node, NodeId, Tree};

/// The node whose state has the least `measure` plus penalty; the lowest index wins a tie, and a measure that is not a
/// number loses against every other. `None` for an empty tree.
pub fn nearest_by<D: Domain>(tree: &Tree<D>, measure: impl Fn(&State<D>) -> f64) -> Option<NodeId> {
    nearest_node_by(tree, |node| measure(&node.state))
}

/// [`nearest_by`] for a measure that asks the node for more than its state.
pub(super) fn nearest_node_by<D: Domain>(tree: &Tree<D>, measure: impl Fn(&Node<D>) -> f64) -> Option<NodeId> {
    let mut best: Option<(NodeId, f64)> = None;
    for (id, node) in tree.iter() {
        let d = measure(node) + tree.penalty_m(node);
        if best.is_none_or(|(_, least)| d < least || (least.is_nan() && !d.is_nan())) {
            best = Some((id, d));
        }
    }
    best.map(|(id, _)| id)
}
