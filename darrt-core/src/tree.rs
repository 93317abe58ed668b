//! V and its edges: an arena of states, each with its parent and the instance that led to it.

use std::num::NonZeroU32;
use std::sync::Arc;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::nearest::bounds::CoordinateIndices;
use crate::nearest::coordinate_index::push_frugally;
use crate::state::State;

/// Index of a node in its tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(NonZeroU32);

impl NodeId {
    /// The node at this position in the order of insertion; `None` if no tree has so many.
    pub(crate) fn at(index: usize) -> Option<Self> {
        Some(Self(NonZeroU32::new(u32::try_from(index).ok()?.checked_add(1)?)?))
    }

    /// Position in the order of insertion.
    pub fn index(self) -> usize {
        self.0.get() as usize - 1
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
    /// The node before it in the same placement.
    before: Option<NodeId>,
    working_point: [f64; 3],
}

impl<D: Domain> Node<D> {
    /// The robot's working point ([`Domain::working_point`]).
    pub fn working_point(&self) -> [f64; 3] {
        self.working_point
    }
}

/// The nodes in which the objects stand in the same way.
#[derive(Debug, Clone, Copy)]
struct Placement {
    /// The last of its nodes; `None` if it was taken back.
    last: Option<NodeId>,
    count: u32,
    /// Penalties since the index was last told.
    untold: u32,
}

/// The index is told of a penalty when there have been this many for each node of the placement: what it knows may be too
/// little, but never too much, and a placement of many nodes is expensive to update.
const TOLD_SHARE: u32 = 16;

/// A tree of states rooted at the start.
#[derive(Debug)]
pub struct Tree<D: Domain> {
    nodes: Vec<Node<D>>,
    placements: Vec<Placement>,
    /// By placement: metres added to every distance from there.
    penalties_m: Vec<f64>,
    /// What bounds on distances are reckoned from; `None` since a penalty was negative or no number.
    indices: Option<CoordinateIndices>,
    /// For whoever records what becomes of it; `None` if nobody does.
    births: Option<Births>,
}

/// A number for each node, which it keeps while nodes before it are taken back.
#[derive(Debug, Clone, Default)]
struct Births {
    /// By node.
    of: Vec<u32>,
    /// The number of the next node.
    next: u32,
}

impl<D: Domain> Tree<D> {
    /// More nodes than this are refused by [`Tree::add`].
    pub const MAX_NODES: usize = u32::MAX as usize - 1;

    /// The tree that holds only the start.
    pub fn rooted_at(m: &D, start: State<D>) -> Self {
        let indices = Some(CoordinateIndices::new(m, &start.robot));
        let mut tree =
            Self { nodes: Vec::new(), placements: Vec::new(), penalties_m: Vec::new(), indices, births: None };
        tree.open_placement();
        tree.push(m, start, None, 0);
        tree
    }

    /// The root.
    pub const ROOT: NodeId = NodeId(NonZeroU32::MIN);

    /// Adds a node. `None` if the tree is full.
    pub fn add(&mut self, m: &D, state: State<D>, edge: Edge<D>) -> Option<NodeId> {
        let id = NodeId::at(self.nodes.len())?;
        let parent = self.node(edge.parent)?;
        let placement = if parent.state.objects == state.objects { parent.placement } else { self.open_placement() };
        self.push(m, state, Some(edge), placement);
        Some(id)
    }

    fn open_placement(&mut self) -> u32 {
        push_frugally(&mut self.penalties_m, 0.0);
        push_frugally(&mut self.placements, Placement { last: None, count: 0, untold: 0 });
        // There are no more placements than nodes.
        u32::try_from(self.placements.len() - 1).unwrap_or(u32::MAX)
    }

    fn push(&mut self, m: &D, state: State<D>, edge: Option<Edge<D>>, placement: u32) {
        let working_point = m.working_point(&state.robot);
        if let Some(indices) = &mut self.indices {
            indices.push(m, &state, working_point, placement, &self.penalties_m);
        }
        if let Some(births) = &mut self.births {
            births.of.push(births.next);
            births.next = births.next.saturating_add(1);
        }
        let id = NodeId::at(self.nodes.len());
        let before = self.placements.get_mut(placement as usize).and_then(|p| {
            p.count += 1;
            std::mem::replace(&mut p.last, id)
        });
        push_frugally(&mut self.nodes, Node { state, edge, placement, before, working_point });
    }

    /// Takes back the node that was added last; the root stays.
    pub fn remove_last(&mut self) {
        if self.nodes.len() <= 1 {
            return;
        }
        if let Some(node) = self.nodes.pop()
            && let Some(placement) = self.placements.get_mut(node.placement as usize)
        {
            placement.last = node.before;
            placement.count -= 1;
        }
        if let Some(births) = &mut self.births {
            births.of.pop();
        }
        for coordinate_index in self.indices.iter_mut().flat_map(CoordinateIndices::all) {
            coordinate_index.pop(&self.penalties_m);
        }
    }

    /// Takes back the nodes from the first on the way to `last` that was reached by `instance`, with all that grew from
    /// them; the ids of all other nodes change, their order does not. Returns how many there were.
    pub fn prune(&mut self, m: &D, last: NodeId, instance: &Arc<Instance<D>>) -> usize {
        let is_on = |id: &NodeId| {
            let edge = self.node(*id).and_then(|node| node.edge.as_ref());
            edge.is_some_and(|edge| Arc::ptr_eq(&edge.instance, instance))
        };
        let way = std::iter::successors(Some(last), |id| Some(self.node(*id)?.edge.as_ref()?.parent));
        let Some(first) = way.filter(is_on).last() else { return 0 };
        let Some(root) = self.node(Self::ROOT).map(|root| root.state.clone()) else { return 0 };
        let old = std::mem::replace(self, Self::rooted_at(m, root));
        let has_indices = old.indices.is_some();
        let births = old.births;
        // By old index: the new id; `None` for what is gone. Parents come before their children.
        let mut kept = vec![Some(Self::ROOT)];
        let before = old.nodes.len();
        for (index, node) in old.nodes.into_iter().enumerate().skip(1) {
            let parent = node.edge.as_ref().and_then(|edge| kept.get(edge.parent.index()).copied().flatten());
            let id = match (parent, node.edge) {
                (Some(parent), Some(edge)) if index != first.index() => {
                    self.add(m, node.state, Edge { parent, ..edge })
                }
                _ => None,
            };
            if let Some(new) = id.and_then(|id| self.node(id)).map(|new| new.placement as usize)
                && let (Some(penalty_m), Some(known_m)) =
                    (self.penalties_m.get_mut(new), old.penalties_m.get(node.placement as usize))
            {
                *penalty_m = *known_m;
            }
            kept.push(id);
        }
        if let (Some(penalty_m), Some(known_m)) = (self.penalties_m.first_mut(), old.penalties_m.first()) {
            *penalty_m = *known_m;
        }
        if !has_indices {
            self.indices = None;
        }
        self.births = births.map(|births| {
            let all = births.of.iter().zip(&kept).filter(|(_, id)| id.is_some());
            Births { of: all.map(|(birth, _)| *birth).collect(), next: births.next }
        });
        before - self.nodes.len()
    }

    /// Adds `metres`, at least 0, to the penalty of all nodes with the placement of this one.
    pub fn penalise(&mut self, id: NodeId, metres: f64) {
        let Some(placement) = self.node(id).map(|node| node.placement) else { return };
        let at = placement as usize;
        let (Some(penalty_m), Some(p)) = (self.penalties_m.get_mut(at), self.placements.get_mut(at)) else { return };
        *penalty_m += metres;
        if metres.is_nan() || metres < 0.0 {
            self.indices = None;
        }
        p.untold += 1;
        if metres > 0.0 && p.untold.saturating_mul(TOLD_SHARE) >= p.count {
            p.untold = 0;
            let last = p.last;
            self.tell_indices(last);
        }
    }

    /// Tells the indices the penalty of `last` and of all nodes before it in the same placement.
    fn tell_indices(&mut self, last: Option<NodeId>) {
        for coordinate_index in self.indices.iter_mut().flat_map(CoordinateIndices::all) {
            let (mut next, mut told) = (last, None);
            while let Some(id) = next {
                let block = coordinate_index.block_of(id.index());
                if block != told {
                    coordinate_index.refresh_penalty(id.index(), &self.penalties_m);
                    told = block;
                }
                next = self.nodes.get(id.index()).and_then(|node| node.before);
            }
        }
    }

    /// Metres added to every distance from `node`, for the extensions that have already been made from its placement.
    pub fn penalty_m(&self, node: &Node<D>) -> f64 {
        self.penalty_at(node.placement)
    }

    pub(crate) fn penalty_at(&self, placement: u32) -> f64 {
        self.penalties_m.get(placement as usize).copied().unwrap_or(0.0)
    }

    /// Numbers the nodes from now on, in the order in which they come, the present ones first.
    pub(crate) fn number_births(&mut self) {
        let count = u32::try_from(self.nodes.len()).unwrap_or(u32::MAX);
        self.births = Some(Births { of: (0..count).collect(), next: count });
    }

    /// By node, in the order of insertion: its number among all that the tree ever had. Empty unless somebody
    /// [records](crate::record::Recorder) the search.
    pub fn births(&self) -> &[u32] {
        self.births.as_ref().map_or(&[], |births| &births.of)
    }

    pub(crate) fn indices(&self) -> Option<&CoordinateIndices> {
        self.indices.as_ref()
    }

    pub(crate) fn at(&self, index: u32) -> Option<&Node<D>> {
        self.nodes.get(index as usize)
    }

    /// A node; `None` if the id belongs to another tree.
    pub fn node(&self, id: NodeId) -> Option<&Node<D>> {
        self.nodes.get(id.index())
    }

    /// The node that was added last.
    pub(crate) fn last(&self) -> NodeId {
        NodeId::at(self.nodes.len().saturating_sub(1)).unwrap_or(Self::ROOT)
    }

    /// How many nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never true: a tree has a root.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The nodes from this position in the order of insertion on.
    pub fn since(&self, first: usize) -> impl Iterator<Item = &Node<D>> {
        self.nodes.iter().skip(first)
    }

    /// All nodes in the order of insertion.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, &Node<D>)> {
        self.nodes.iter().enumerate().filter_map(|(i, n)| Some((NodeId::at(i)?, n)))
    }
}
