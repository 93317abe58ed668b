//! V and its edges: an arena of states, each with its parent and the instance that led to it.

use std::sync::Arc;

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
}

/// A tree of states rooted at the start.
#[derive(Debug)]
pub struct Tree<D: Domain> {
    nodes: Vec<Node<D>>,
}

impl<D: Domain> Tree<D> {
    /// More nodes than this are refused by [`Tree::add`].
    pub const MAX_NODES: usize = u32::MAX as usize;

    /// The tree that holds only the start.
    pub fn rooted_at(start: State<D>) -> Self {
        Self { nodes: vec![Node { state: start, edge: None }] }
    }

    /// The root.
    pub const ROOT: NodeId = NodeId(0);

    /// Adds a node. `None` if the tree is full.
    pub fn add(&mut self, state: State<D>, edge: Edge<D>) -> Option<NodeId> {
        let id = NodeId(u32::try_from(self.nodes.len()).ok()?);
        self.nodes.push(Node { state, edge: Some(edge) });
        Some(id)
    }

    /// Takes back the node that was added last; the root stays.
    pub fn remove_last(&mut self) {
        if self.nodes.len() > 1 {
            self.nodes.pop();
        }
    }

    /// A node; `None` if the id belongs to another tree.
    pub fn node(&self, id: NodeId) -> Option<&Node<D>> {
        self.nodes.get(id.index())
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
