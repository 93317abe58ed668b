//! Pruned searches for the nearest node against the linear scan, on trees large enough to be sorted several times.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use darrt_core::primitive::PrimitiveId;
use darrt_core::variants::{ApproachVisit, Weighted};
use std::sync::Arc;

use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::laws::check_nearest;
use darrt_core::motion::{Instance, Straight};
use darrt_core::partial::PartialState;
use darrt_core::random::{Purpose, Stream, stream};
use darrt_core::space::{ComponentSpace, GroupSet};
use darrt_core::state::{ComponentSet, ObjectId, State};
use darrt_core::testing::broken::bench::{Bench, Tag};
use darrt_core::testing::puck::{Mode, Puck, PuckWorld};
use darrt_core::tree::{Edge, NodeId, Tree};
use rand::RngExt;

fn pucks(count: usize) -> PuckWorld {
    let puck = |i| Puck { name: format!("puck {i}").into(), radius_m: 0.12, is_graspable: false };
    PuckWorld::new([4.0, 3.0], 0.15, (0..count).map(puck).collect()).unwrap()
}

fn anywhere<D: Domain>(m: &D, mode: &D::Mode, rng: &mut Stream) -> State<D> {
    let objects = m.objects().iter().map(|space| space.sample(rng)).collect();
    State { robot: m.robot().sample(rng), objects, mode: mode.clone() }
}

/// Moves the robot a little, seldom an object, from a random node; sometimes a twin of the parent.
fn child<D: Domain>(m: &D, parent: &State<D>, rng: &mut Stream) -> State<D> {
    let mut state = parent.clone();
    if rng.random_bool(0.05) {
        return state;
    }
    let target = m.robot().sample(rng);
    state.robot = m.robot().interpolate(&parent.robot, &target, 0.2);
    for (space, object) in m.objects().iter().zip(&mut state.objects) {
        if rng.random_bool(0.2) {
            let target = space.sample(rng);
            *object = space.interpolate(object, &target, 0.2);
        }
    }
    state
}

fn target<D: Domain>(m: &D, rng: &mut Stream) -> PartialState<D> {
    let mut to = PartialState::anywhere(m);
    if rng.random_bool(0.5) {
        let group = rng.random_range(0..4);
        let named = GroupSet::only(group).intersection(m.robot().groups());
        let groups = if named.is_empty() { m.robot().groups() } else { named };
        to = to.with_robot_groups(m.robot().sample(rng), groups);
    }
    for (i, space) in m.objects().iter().enumerate() {
        if rng.random_bool(0.5) {
            to = to.with_object(ObjectId::new(i), space.sample(rng));
        }
    }
    to
}

/// Grows a tree to `count` nodes, with penalties and with nodes taken back, and asks on the way.
fn grow_and_ask<D: Domain>(m: &D, mode: &D::Mode, count: usize, penalty_m: f64) {
    let rng = &mut stream(7, 0, count as u64, Purpose::Sample);
    let root = anywhere(m, mode, rng);
    let instance = Arc::new(Instance {
        primitive: PrimitiveId::new(10, "test"),
        motion: Box::new(Straight::new(root.clone(), root.robot.clone(), 0.0)),
        contacts: D::Contacts::default(),
        moves: ComponentSet::ROBOT,
        object: None,
        reversible: true,
    });
    let mut tree = Tree::rooted_at(m, root);
    let mut ids: Vec<NodeId> = vec![Tree::<D>::ROOT];
    while tree.len() < count {
        let parent = ids[rng.random_range(0..ids.len())];
        let state = child(m, &tree.node(parent).unwrap().state, rng);
        let edge = Edge { parent, instance: Arc::clone(&instance), t: 1.0, primitive: 0 };
        ids.push(tree.add(m, state, edge).unwrap());
        if rng.random_bool(0.03) {
            tree.remove_last();
            ids.pop();
        }
        if rng.random_bool(0.3) {
            let id = ids[rng.random_range(0..ids.len())];
            tree.penalise(id, penalty_m);
        }
        if tree.len() % 97 == 0 {
            let to = target(m, rng);
            let (sum, maximum) = (Weighted::sum(0.5, 3.0).unwrap(), Weighted::maximum(0.5, 3.0).unwrap());
            let approach = ApproachVisit::new(Vec::new());
            let all = [&Euclidean as &dyn Distance<D>, &GreedyVisit, &ExactTour, &sum, &maximum, &approach];
            for distance in all {
                check_nearest(m, distance, &tree, &to).unwrap();
            }
        }
    }
}

#[test]
fn large_trees_are_searched_as_by_a_linear_scan() {
    grow_and_ask(&pucks(1), &Mode::resting(1), 9_500, 0.1);
    grow_and_ask(&pucks(3), &Mode::resting(3), 2_500, 0.0);
    grow_and_ask(&Bench::default(), &Tag::default(), 2_500, 0.2);
}

/// Coordinates that are no number, infinite or huge bound nothing, and must not hide a node.
#[test]
fn coordinates_that_bound_nothing_hide_no_node() {
    let m = pucks(1);
    let mode = Mode::resting(1);
    let state = |robot, puck| State { robot, objects: [puck].into_iter().collect(), mode: mode.clone() };
    let mut states: Vec<_> = (0..40).map(|i| anywhere(&m, &mode, &mut stream(3, 0, i, Purpose::Sample))).collect();
    states.insert(5, state([f64::NAN, 1.0], [1.0, 1.0]));
    states.insert(7, state([1e300, 1.0], [1.0, 1.0]));
    states.insert(9, state([1.0, f64::INFINITY], [1.0, 1.0]));
    states.insert(11, state([1.0, 1.0], [f64::NAN, 1.0]));
    let at = |x| PartialState::anywhere(&m).with_object(ObjectId::new(0), x);
    let robot_at = |x| PartialState::anywhere(&m).with_robot(&m, x);
    let targets =
        [at([1.0, 1.0]), at([f64::NAN, 1.0]), at([1e200, 0.0]), robot_at([f64::NAN, 0.0]), robot_at([1.0, 2.0])];
    for (first, root) in states.iter().enumerate() {
        let others = states.iter().skip(first + 1).cloned();
        let tree = darrt_core::laws::nearest::tree_of(&m, root, others);
        for to in &targets {
            for distance in [&Euclidean as &dyn Distance<PuckWorld>, &GreedyVisit, &ExactTour] {
                check_nearest(&m, distance, &tree, to).unwrap();
            }
        }
    }
}

/// A penalty that is negative, or no number, breaks every bound; then the linear scan answers.
#[test]
fn a_negative_penalty_is_honoured() {
    let m = pucks(1);
    let states: Vec<_> =
        (0..200).map(|i| anywhere(&m, &Mode::resting(1), &mut stream(4, 0, i, Purpose::Sample))).collect();
    for penalty_m in [-30.0, f64::NAN] {
        let mut tree = darrt_core::laws::nearest::tree_of(&m, &states[0], states[1..].iter().cloned());
        let id = tree.iter().nth(150).unwrap().0;
        tree.penalise(id, penalty_m);
        let to = PartialState::of_state(&m, &states[20]);
        check_nearest(&m, &GreedyVisit, &tree, &to).unwrap();
        let found = GreedyVisit.nearest(&m, &tree, &to).unwrap();
        assert_eq!(found.index(), if penalty_m < 0.0 { 150 } else { 20 });
    }
}
