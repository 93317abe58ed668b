//! The law of [`Distance::nearest`]: whatever it skips, it answers as the obvious scan does.

use crate::primitive::PrimitiveId;
use std::sync::Arc;

use crate::distance::Distance;
use crate::domain::Domain;
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::state::{ComponentSet, State};
use crate::tree::{Edge, NodeId, Tree};

use super::Broken;
use super::watch::{entering, watched};

/// Faster searches agree with the linear scan.
pub const LINEAR: &str = "nearest.linear: nearest answers the node of least distance and penalty, the earliest on a tie, as a linear scan does";

/// The laws of this file.
pub const LAWS: &[&str] = &[LINEAR];

/// `nearest` names the node that a scan over all nodes names: in the given tree, and in a copy of it in which that node, and
/// then the next, were given a penalty.
///
/// # Errors
/// [`LINEAR`] with both nodes and their distances.
pub fn check_nearest<D: Domain>(
    m: &D,
    distance: &dyn Distance<D>,
    tree: &Tree<D>,
    to: &PartialState<D>,
) -> Result<(), Broken> {
    let about = || {
        let states: Vec<_> = tree.iter().map(|(_, node)| &node.state).collect();
        format!("check_nearest(&tree_of({states:?}), &{to:?})")
    };
    let check = || {
        agree(m, distance, tree, to)?;
        if let Some((_, root)) = tree.iter().next() {
            agree(m, distance, &tree_of(m, &root.state, []), to).map_err(|broken| broken.of("a tree of one node"))?;
        }
        let mut states = tree.iter().map(|(_, node)| node.state.clone());
        let Some(root) = states.next() else { return Ok(()) };
        let mut penalised = tree_of(m, &root, states);
        for _ in 0..PENALTIES {
            if let Some((index, _)) = scan(m, distance, &penalised, to)
                && let Some(id) = NodeId::at(index)
            {
                penalised.penalise(id, PENALTY_M);
            }
            agree(m, distance, &penalised, to).map_err(|broken| broken.of("after a penalty"))?;
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// How many nodes get a penalty, one after the other, and how large it is, metres.
const PENALTIES: usize = 2;
const PENALTY_M: f64 = 5.0;

/// The index of the nearest node and its metres, penalty included.
fn scan<D: Domain>(m: &D, distance: &dyn Distance<D>, tree: &Tree<D>, to: &PartialState<D>) -> Option<(usize, f64)> {
    let mut best: Option<(usize, f64)> = None;
    for (id, node) in tree.iter() {
        entering("distance");
        let metres = distance.distance(m, &node.state, to) + tree.penalty_m(node);
        if best.is_none_or(|(_, least)| metres < least || (least.is_nan() && !metres.is_nan())) {
            best = Some((id.index(), metres));
        }
    }
    best
}

fn agree<D: Domain>(m: &D, distance: &dyn Distance<D>, tree: &Tree<D>, to: &PartialState<D>) -> Result<(), Broken> {
    let best = scan(m, distance, tree, to);
    entering("nearest");
    let found = distance.nearest(m, tree, to).map(NodeId::index);
    if found == best.map(|(index, _)| index) {
        return Ok(());
    }
    let state = found.and_then(|i| tree.iter().nth(i)).map(|(_, node)| distance.distance(m, &node.state, to));
    Err(Broken::new(LINEAR, format!("node {found:?} at {state:?} m"), format!("node and metres {best:?}")))
}

/// A tree that holds `root` and then `others`, each a child of the root: something to search in.
pub fn tree_of<D: Domain>(m: &D, root: &State<D>, others: impl IntoIterator<Item = State<D>>) -> Tree<D> {
    let mut tree = Tree::rooted_at(m, root.clone());
    for state in others {
        let states = vec![root.clone(), state.clone()];
        let Some(motion) = Waypoints::new(states, &[0.0], root.mode.clone()) else { continue };
        let instance = Arc::new(Instance {
            primitive: PrimitiveId::new(10, "law"),
            motion: Box::new(motion),
            contacts: D::Contacts::default(),
            moves: ComponentSet::EMPTY,
            object: None,
            reversible: false,
        });
        // Only a tree of 2^32 nodes refuses another.
        let _ = tree.add(m, state, Edge { parent: Tree::<D>::ROOT, instance, t: 1.0, primitive: 0 });
    }
    tree
}
