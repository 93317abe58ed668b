//! V and its edges: an arena of states, each with its parent and the instance that led to it.

use std::sync::{Arc, OnceLock};

use crate::domain::Domain;
use crate::motion::Instance;
use crate::state::State;

/// Index of a node in its tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(u32);

impl NodeId {
    /// Position in the order of insertion.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// How a node was reached from its parent.
#[derive(Debug)]
pub struct Edge<D: Domain> {
    /// The node it starts from.
    pub parent: NodeId,
    /// The instance, shared by all nodes along it.
    pub instance: Arc<Instance<D>>,
    /// The parameter of the node on the instance's motion, in `(0, 1]`.
    pub t: f64,
    /// Index of the primitive (in the problem's order) that propagated the instance.
    pub primitive: u16,
}

impl<D: Domain> Clone for Edge<D> {
    fn clone(&self) -> Self {
        Self { parent: self.parent, instance: Arc::clone(&self.instance), t: self.t, primitive: self.primitive }
    }
}

/// One node.
#[derive(Debug)]
pub struct Node<D: Domain> {
    /// The state.
    pub state: State<D>,
    /// How it was reached; `None` for the root.
    pub edge: Option<Edge<D>>,
    /// Which placement of the objects: nodes between which only the robot moved share one.
    placement: u32,
    working_point: OnceLock<[f64; 3]>,
}

impl<D: Domain> Node<D> {
    fn new(state: State<D>, edge: Option<Edge<D>>, placement: u32) -> Self {
        Self { state, edge, placement, working_point: OnceLock::new() }
    }

    /// Index of its placement in the tree.
    pub(crate) fn placement(&self) -> usize {
        self.placement as usize
    }

    /// The robot's working point, computed when it is first asked for.
    pub fn working_point(&self, m: &D) -> [f64; 3] {
        *self.working_point.get_or_init(|| m.working_point(&self.state.robot))
    }
}

/// A tree of states rooted at the start.
#[derive(Debug)]
pub struct Tree<D: Domain> {
    nodes: Vec<Node<D>>,
    /// By placement: metres added to every distance from there.
    penalties_m: Vec<f64>,
}

impl<D: Domain> Tree<D> {
    /// More nodes than this are refused by [`Tree::add`].
    pub const MAX_NODES: usize = u32::MAX as usize;

    /// The tree that holds only the start.
    pub fn rooted_at(start: State<D>) -> Self {
        Self { nodes: vec![Node::new(start, None, 0)], penalties_m: vec![0.0] }
    }

    /// The root.
    pub const ROOT: NodeId = NodeId(0);

    /// Adds a node. `None` if the tree is full.
    pub fn add(&mut self, state: State<D>, edge: Edge<D>) -> Option<NodeId> {
        let id = NodeId(u32::try_from(self.nodes.len()).ok()?);
        let parent = self.node(edge.parent)?;
        let placement = if parent.state.objects == state.objects {
            parent.placement
        } else {
            self.penalties_m.push(0.0);
            u32::try_from(self.penalties_m.len() - 1).ok()?
        };
        self.nodes.push(Node::new(state, Some(edge), placement));
        Some(id)
    }

    /// Takes back the node that was added last; the root stays.
    pub fn remove_last(&mut self) {
        if self.nodes.len() > 1 {
            self.nodes.pop();
        }
    }

    /// Takes back the nodes from the first on the way to `last` that was reached by `instance`, with all that grew from
    /// them; the ids of all other nodes change, their order does not. Returns how many there were.
    pub fn prune(&mut self, last: NodeId, instance: &Arc<Instance<D>>) -> usize {
        let is_on = |edge: &Edge<D>| Arc::ptr_eq(&edge.instance, instance);
        let way = std::iter::successors(Some(last), |id| Some(self.node(*id)?.edge.as_ref()?.parent));
        let on: Vec<NodeId> =
            way.filter(|id| self.node(*id).and_then(|n| n.edge.as_ref()).is_some_and(is_on)).collect();
        let Some(first) = on.last().map(|id| id.index()) else { return 0 };
        let before = self.nodes.len();
        // By old index: the new one; `None` for what is gone. Parents come before their children.
        let mut kept: Vec<Option<NodeId>> = Vec::with_capacity(before);
        let mut nodes = Vec::with_capacity(before);
        for (index, mut node) in std::mem::take(&mut self.nodes).into_iter().enumerate() {
            let parent = node.edge.as_ref().map(|edge| kept.get(edge.parent.index()).copied().flatten());
            let id = u32::try_from(nodes.len()).ok().map(NodeId);
            let id = if index == first || parent == Some(None) { None } else { id };
            kept.push(id);
            if id.is_some() {
                if let (Some(edge), Some(Some(parent))) = (&mut node.edge, parent) {
                    edge.parent = parent;
                }
                nodes.push(node);
            }
        }
        self.nodes = nodes;
        before - self.nodes.len()
    }

    /// Adds `metres` to the penalty of all nodes with the placement of this one.
    pub fn penalise(&mut self, id: NodeId, metres: f64) {
        let placement = self.node(id).map(|node| node.placement as usize);
        if let Some(penalty_m) = placement.and_then(|placement| self.penalties_m.get_mut(placement)) {
            *penalty_m += metres;
        }
    }

    /// Metres added to every distance from `node`, for the extensions that have already been made from its placement.
    pub fn penalty_m(&self, node: &Node<D>) -> f64 {
        self.penalties_m.get(node.placement as usize).copied().unwrap_or(0.0)
    }

    /// A node; `None` if the id belongs to another tree.
    pub fn node(&self, id: NodeId) -> Option<&Node<D>> {
        self.nodes.get(id.index())
    }

    /// How many placements of the objects there are.
    pub(crate) fn placements(&self) -> usize {
        self.penalties_m.len()
    }

    /// How many nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never true: a tree has a root.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// All nodes in the order of insertion.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, &Node<D>)> {
        // The arena never grows past u32::MAX nodes (see `add`), so no index is lost.
        self.nodes.iter().enumerate().map(|(i, n)| (NodeId(u32::try_from(i).unwrap_or(u32::MAX)), n))
    }
}
