//! The algebra of partial states, and the distances to them.

use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::nearest::linear::nearest_by;
use darrt_core::partial::PartialState;
use darrt_core::sample::{Full, RandomSubset, Sampler};
use darrt_core::space::{ComponentSpace, GroupSet};
use darrt_core::state::{ComponentId, ComponentSet, State};
use darrt_core::testing::puck::problems;
use darrt_core::tree::Tree;

use super::support::{World, id, random_pair, robot_or_objects, small};

fn world() -> World {
    problems::four_pucks().unwrap().domain().clone()
}

#[test]
fn an_overlay_meets_its_target_and_keeps_the_rest() {
    let m = world();
    for seed in 0..200 {
        let (state, target) = random_pair(&m, &RandomSubset, seed);
        let there = target.overlay(&m, &state);
        assert!(target.is_met(&m, &there));
        assert_eq!(target.overlay(&m, &there), there);
        for object in m.ids().filter(|object| target.object(*object).is_none()) {
            assert_eq!(there.object(object), state.object(object));
        }
        if target.robot().is_none() {
            assert_eq!(there.robot, state.robot);
        }
        assert!(PartialState::anywhere(&m).is_met(&m, &state));
        assert!(PartialState::of_state(&m, &state).is_met(&m, &state));
    }
}

#[test]
fn a_subset_is_met_whenever_the_whole_is() {
    let m = world();
    for seed in 0..200 {
        let (state, a) = random_pair(&m, &RandomSubset, seed);
        let (_, b) = random_pair(&m, &RandomSubset, seed + 1000);
        let both = a.clone().or(&m, &b);
        assert!(a.is_subset_of(&m, &both));
        assert!(PartialState::anywhere(&m).is_subset_of(&m, &a));
        assert_eq!(both.components(), a.components().union(b.components()));
        let there = both.overlay(&m, &state);
        assert!(a.is_met(&m, &there));
        assert_eq!(b.is_subset_of(&m, &a), b.components().is_empty());
    }
}

#[test]
fn unknown_objects_and_empty_groups_name_nothing() {
    let m = world();
    let nowhere = PartialState::anywhere(&m).with_object(id(9), [1.0, 1.0]);
    assert!(nowhere.components().is_empty());
    let state = random_pair(&m, &Full, 0).0;
    assert!(nowhere.is_object_met(&m, &state, id(9)));
    assert_eq!(state.object(id(9)), None);
    let no_group = PartialState::<World>::anywhere(&m).with_robot_groups([1.0, 1.0], GroupSet::NONE);
    assert_eq!(no_group, PartialState::anywhere(&m));
}

#[test]
fn a_target_is_met_up_to_the_tolerance_and_no_further() {
    let m = world();
    let (robot, puck) = (m.robot().tolerance(), m.objects()[0].tolerance());
    let mut state = random_pair(&m, &Full, 0).0;
    state.robot = [0.0, 1.0];
    state.objects[0] = [0.0, 2.0];
    for (off, is_met) in [(0.0, true), (0.5, true), (1.0, true), (1.5, false)] {
        let there = PartialState::anywhere(&m).with_robot(&m, [off * robot, 1.0]);
        assert_eq!(there.is_robot_met(&m, &state), is_met, "{off}");
        let there = PartialState::anywhere(&m).with_object(id(0), [off * puck, 2.0]);
        assert_eq!(there.is_object_met(&m, &state, id(0)), is_met, "{off}");
    }
}

#[test]
fn sets_of_components() {
    let all = world().ids().fold(ComponentSet::ROBOT, |set, i| set.with(ComponentId::Object(i)));
    assert_eq!(all.len(), 5);
    assert!(ComponentSet::ROBOT.is_subset_of(all) && !all.is_subset_of(ComponentSet::ROBOT));
    assert!(ComponentSet::EMPTY.is_empty() && !all.contains(ComponentId::Object(id(4))));
    let last = ComponentSet::EMPTY.with(ComponentId::Object(id(62)));
    assert!(last.contains(ComponentId::Object(id(62))) && !last.contains(ComponentId::Robot));
    let none = ComponentSet::EMPTY.with(ComponentId::Object(id(63))).with(ComponentId::Object(id(1 << 20)));
    assert!(none.is_empty());
}

fn distances() -> [(&'static str, Box<dyn Distance<World>>); 3] {
    [("euclidean", Box::new(Euclidean)), ("greedy", Box::new(GreedyVisit)), ("exact", Box::new(ExactTour))]
}

#[test]
fn zero_exactly_when_met() {
    let m = world();
    let samplers: [&dyn Sampler<World>; 3] = [&Full, &RandomSubset, &robot_or_objects()];
    for seed in 0..100 {
        for sampler in samplers {
            let (state, target) = random_pair(&m, sampler, seed);
            for (name, distance) in distances() {
                let d = distance.distance(&m, &state, &target);
                assert!(d.is_finite() && d > 0.0, "{name}: {d}");
                let there = target.overlay(&m, &state);
                assert_eq!(distance.distance(&m, &there, &target), 0.0, "{name}");
                assert_eq!(distance.distance(&m, &state, &PartialState::anywhere(&m)), 0.0, "{name}");
            }
        }
    }
}

#[test]
fn the_exact_tour_is_never_longer_than_the_greedy_one_and_sometimes_shorter() {
    let m = world();
    let mut shorter = 0;
    for seed in 0..300 {
        let (state, target) = random_pair(&m, &RandomSubset, seed);
        let (exact, greedy) = (ExactTour.distance(&m, &state, &target), GreedyVisit.distance(&m, &state, &target));
        assert!(exact <= greedy + 1e-12, "{exact} > {greedy}");
        shorter += u32::from(exact < greedy - 1e-9);
    }
    assert!(shorter > 10, "{shorter}");
}

#[test]
fn a_tour_by_hand() {
    // Robot at (0.5, 1), puck at (1, 1): 0.23 m to the rim, 1 m along with it, and from the rim at (2, 1)
    // to the robot's target at (2, 0.5) another 0.23 m.
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let (m, start) = (problem.domain(), problem.start());
    let target = PartialState::anywhere(m).with_object(id(0), [2.0, 1.0]);
    for distance in [&GreedyVisit as &dyn Distance<World>, &ExactTour] {
        assert!((distance.distance(m, start, &target) - 1.23).abs() < 1e-12);
        let with_robot = target.clone().with_robot(m, [2.0, 0.5]);
        assert!((distance.distance(m, start, &with_robot) - 1.46).abs() < 1e-12);
    }
    assert!((Euclidean.distance(m, start, &target) - 1.0).abs() < 1e-12);
}

#[test]
fn the_lowest_index_wins_a_tie_and_nan_loses() {
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let mut tree = Tree::rooted_at(problem.domain(), problem.start().clone());
    let target = State { robot: [0.5, 0.5], ..problem.start().clone() };
    let instance = std::sync::Arc::new(super::support::robot_instance(problem.start(), &target));
    for i in 1..5_u8 {
        let t = f64::from(i) / 4.0;
        let state = instance.at(problem.domain(), t, problem.start());
        let edge = darrt_core::tree::Edge { parent: Tree::<World>::ROOT, instance: instance.clone(), t, primitive: 0 };
        tree.add(problem.domain(), state, edge).unwrap();
    }
    let index = |measure: &dyn Fn(f64) -> f64| nearest_by(&tree, |s| measure(s.robot[1])).unwrap().index();
    assert_eq!(index(&|_| 1.0), 0);
    assert_eq!(index(&|y| y), 4);
    assert_eq!(index(&|y| if y > 0.7 { f64::NAN } else { -y }), 3);
    assert_eq!(index(&|y| if y > 0.7 { -f64::NAN } else { 1.0 }), 3);
    assert_eq!(index(&|_| f64::NAN), 0);
}
