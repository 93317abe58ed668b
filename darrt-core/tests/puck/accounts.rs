//! The one bucket of every primitive in hand-made extensions.

use darrt_core::budget::{Interrupt, Stop};
use darrt_core::extend::{ExtendOptions, Extender, Extension, extend_towards};
use darrt_core::observe::Silent;
use darrt_core::observe::accounts::{Accounts, Bucket};
use darrt_core::partial::PartialState;
use darrt_core::problem::Problem;
use darrt_core::sample::RandomSubset;
use darrt_core::solve::solve;
use darrt_core::testing::puck::{Point, problems};
use darrt_core::validity::BlockKind;

use super::support::{World, greedy, id, options, rng, small};

const TRANSIT: usize = 0;
const PUSH: usize = 1;

fn problem(setup: darrt_core::testing::puck::Setup) -> Problem<World> {
    setup.puck_goal(0, [2.0, 1.5]).problem().unwrap()
}

fn extend(problem: &Problem<World>, robot: Option<Point>, puck: Option<Point>) -> Extension<World> {
    let m = problem.domain();
    let mut target = PartialState::anywhere(m);
    if let Some(at) = robot {
        target = target.with_robot(m, at);
    }
    if let Some(at) = puck {
        target = target.with_object(id(0), at);
    }
    extend_towards(problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(0))
}

/// The bucket of every primitive, in the order Transit, Push, Pick, Carry, Place.
fn buckets(transit: Bucket, push: Bucket) -> [Bucket; 5] {
    [transit, push, Bucket::NotUseful, Bucket::NotUseful, Bucket::NotUseful]
}

fn blamed(e: &Extension<World>) -> (BlockKind, &str, &str) {
    let blame = e.blame.as_ref().unwrap();
    (blame.kind, &*blame.first, &*blame.second)
}

#[test]
fn free_from_end_to_end() {
    let e = extend(&problem(small()), Some([0.5, 0.3]), None);
    assert_eq!(e.buckets[..], buckets(Bucket::Accepted, Bucket::NotUseful));
    assert!(e.is_met && e.blame.is_none());
    let e = extend(&problem(small()), Some([0.5, 0.3]), Some([1.5, 1.0]));
    assert_eq!(e.buckets[..], buckets(Bucket::Accepted, Bucket::Accepted));
    assert!(e.is_met && e.blame.is_none());
}

#[test]
fn the_robot_meets_an_obstacle() {
    let e = extend(&problem(small().wall("wall", [0.0, 0.5], [1.0, 0.6])), Some([0.5, 0.2]), None);
    assert_eq!(e.buckets[..], buckets(Bucket::RobotFixed, Bucket::NotUseful));
    assert_eq!(blamed(&e), (BlockKind::RobotFixed, "robot", "wall"));
    assert!(!e.is_met);
}

#[test]
fn the_robot_meets_a_puck() {
    let e = extend(&problem(small()), Some([1.5, 1.0]), None);
    assert_eq!(e.buckets[..], buckets(Bucket::RobotObject, Bucket::NotUseful));
    assert_eq!(blamed(&e), (BlockKind::RobotObject, "robot", "red"));
}

#[test]
fn the_pushed_puck_meets_an_obstacle_and_what_comes_behind_counts_as_behind() {
    let walled = problem(small().pillar("pillar", [1.5, 1.0], 0.1));
    let e = extend(&walled, None, Some([2.0, 1.0]));
    assert_eq!(e.buckets[..], buckets(Bucket::NotUseful, Bucket::ObjectFixed));
    assert_eq!(blamed(&e), (BlockKind::ObjectFixed, "red", "pillar"));
    let e = extend(&walled, Some([0.5, 0.3]), Some([2.0, 1.0]));
    assert_eq!(e.buckets[..], buckets(Bucket::Behind, Bucket::ObjectFixed));
}

#[test]
fn the_pushed_puck_meets_another() {
    let e = extend(&problem(small().puck("blue", 0.12, [1.5, 1.0])), None, Some([2.0, 1.0]));
    assert_eq!(e.buckets[..], buckets(Bucket::NotUseful, Bucket::ObjectObject));
    assert_eq!(blamed(&e), (BlockKind::ObjectObject, "red", "blue"));
}

#[test]
fn no_room_for_the_robot_behind_the_puck() {
    let cornered = small().puck("blue", 0.12, [0.12, 0.12]).puck_goal(1, [0.5, 0.5]).problem().unwrap();
    let m = cornered.domain();
    let target = PartialState::anywhere(m).with_object(id(1), [0.5, 0.5]);
    let e = extend_towards(&cornered, &ExtendOptions::default(), cornered.start(), &target, &mut rng(0));
    assert_eq!(e.buckets[PUSH], Bucket::NoContact);
    assert!(e.reached.is_empty() && !e.is_met && e.blame.is_none());
}

#[test]
fn the_robot_is_pushed_off_the_floor() {
    // The puck may lie nearer to the edge than the larger robot.
    let e = extend(&problem(small()), None, Some([2.88, 0.12]));
    assert!(e.is_met, "{:?}", e.blame);
    let along_the_edge = problem(small().puck("blue", 0.12, [1.0, 0.2]));
    let m = along_the_edge.domain();
    let target = PartialState::anywhere(m).with_object(id(1), [2.88, 0.12]);
    let e = extend_towards(&along_the_edge, &ExtendOptions::default(), along_the_edge.start(), &target, &mut rng(0));
    assert_eq!(blamed(&e), (BlockKind::Limits, "robot", "edge of the floor"));
    assert_eq!(e.buckets[PUSH], Bucket::Limits);
    assert_eq!(e.buckets[TRANSIT], Bucket::NotUseful);
}

#[test]
fn one_useful_primitive_is_drawn_and_the_other_is_not_chosen() {
    let setup = darrt_core::testing::puck::Setup::new([3.0, 2.0], 0.15).graspable_puck("red", 0.12, [1.5, 1.0]);
    let problem = setup.robot_at([0.5, 1.0]).puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let target = PartialState::anywhere(problem.domain()).with_object(id(0), [2.0, 1.0]);
    let (mut pushed, mut picked) = (0, 0);
    for seed in 0..40 {
        let e = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(seed));
        match e.buckets[PUSH..=PUSH + 1] {
            [Bucket::Accepted, Bucket::NotChosen] => pushed += 1,
            [Bucket::NotChosen, Bucket::Accepted] => picked += 1,
            ref other => panic!("seed {seed}: {other:?}"),
        }
        assert!(e.is_met, "seed {seed}: {:?}", e.blame);
    }
    assert!(pushed > 10 && picked > 10, "{pushed} pushed, {picked} picked");
}

#[test]
fn the_counts_of_a_whole_search_balance_and_add_up() {
    for (name, make) in problems::ALL {
        let problem = make().unwrap();
        let outcome = solve(&problem, &greedy(RandomSubset), &options(0, 150), &mut Silent);
        let a = &outcome.accounts;
        assert!(a.are_balanced(), "{name}");
        assert_eq!(a.extensions, outcome.iterations, "{name}");
        assert_eq!(a.added, outcome.nodes as u64 - 1, "{name}: one attempt, so all states are in one tree");
        assert!(a.met + a.blocks.values().sum::<u64>() <= a.extensions, "{name}");
    }
}

#[test]
fn merged_counts_are_sums() {
    let mut a = Accounts::new(vec!["Transit"]);
    a.count(&[Bucket::Accepted], 3, true, None);
    let mut b = Accounts::new(vec!["Transit"]);
    b.count(&[Bucket::NotUseful], 0, false, None);
    b.refused = 2;
    let mut sum = Accounts::default();
    sum.merge(&a);
    sum.merge(&b);
    assert_eq!((sum.extensions, sum.met, sum.empty, sum.added, sum.refused), (2, 1, 1, 3, 2));
    assert!(sum.are_balanced());
    sum.extensions += 1;
    assert!(!sum.are_balanced());
}

#[test]
fn every_bucket_has_its_own_place_and_heading() {
    for (i, bucket) in Bucket::ALL.into_iter().enumerate() {
        assert_eq!(bucket as usize, i);
        assert_eq!(Bucket::ALL.iter().filter(|b| b.heading() == bucket.heading()).count(), 1);
    }
}

#[test]
fn what_an_interrupt_cuts_off_counts_as_budget() {
    use std::sync::atomic::{AtomicU32, Ordering};
    let problem = problem(small());
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.5, 0.3]);
    let target = target.with_object(id(0), [1.5, 1.0]);
    let options = ExtendOptions::default();
    let after = |instances: u32| {
        let asked = AtomicU32::new(0);
        let ask = || (asked.fetch_add(1, Ordering::Relaxed) >= instances).then_some(Stop::Cancelled);
        let interrupt = Interrupt::new(&ask);
        let extender = Extender { problem: &problem, options: &options, local_repair: None, interrupt };
        extender.extend(problem.start(), &target, &mut rng(0))
    };
    let whole = extend_towards(&problem, &options, problem.start(), &target, &mut rng(0));
    assert!(whole.is_met);
    let e = after(0);
    assert_eq!(e.buckets[..], buckets(Bucket::Budget, Bucket::Budget));
    assert!(!e.is_met && e.blame.is_none() && e.reached.is_empty());
    let e = after(1);
    assert_eq!(e.buckets[..], buckets(Bucket::Budget, Bucket::Budget), "the push has two instances");
    assert!(!e.is_met && !e.reached.is_empty() && e.reached.len() < whole.reached.len());
    assert!(after(100).is_met);
}
