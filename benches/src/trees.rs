//! Trees of any domain and any size.

use std::sync::Arc;

use darrt_core::domain::Domain;
use darrt_core::motion::{Instance, Straight};
use darrt_core::partial::PartialState;
use darrt_core::primitive::PrimitiveId;
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::{ComponentSet, State};
use darrt_core::tree::{Edge, Tree};

use crate::stream;

/// A tree of `count` random states, all of them children of the root: the hardest for a search, because no two nodes have
/// anything in common.
pub fn random<D: Domain>(m: &D, start: &State<D>, count: u64) -> Tree<D> {
    let instance = Arc::new(Instance {
        primitive: PrimitiveId::new(10, "random"),
        motion: Box::new(Straight::new(start.clone(), start.robot.clone(), 0.0)),
        contacts: D::Contacts::default(),
        moves: ComponentSet::ROBOT,
        object: None,
        reversible: true,
    });
    let mut tree = Tree::rooted_at(m, start.clone());
    for index in 1..count {
        let rng = &mut stream(index);
        let objects = m.objects().iter().map(|space| space.sample(rng)).collect();
        let state = State { robot: m.robot().sample(rng), objects, mode: start.mode.clone() };
        let edge = Edge { parent: Tree::<D>::ROOT, instance: Arc::clone(&instance), t: 1.0, primitive: 0 };
        tree.add(m, state, edge).unwrap();
    }
    tree
}

/// `count` targets as the planner draws them.
pub fn targets<D: Domain>(problem: &Problem<D>, strategy: &Strategy<D>, count: u64) -> Vec<PartialState<D>> {
    (0..count).map(|i| strategy.sampler.sample(problem.domain(), problem.goal(), &mut stream(i))).collect()
}
