//! PATH ends: with primitives that undo each other, that never arrive, that do nothing.

use darrt_core::extend::{ExtendOptions, extend_towards};
use darrt_core::observe::accounts::Bucket;
use darrt_core::partial::PartialState;
use darrt_core::path::{Path, PathEnd, Trial, path};
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use darrt_core::problem::Problem;
use darrt_core::state::State;
use darrt_core::testing::puck::{Point, Setup};
use darrt_core::validity::{Blame, BlockKind};
use rand::Rng;

use super::support::{Made, World, options, rng, run, small};

type Primitives = Vec<Box<dyn Primitive<World>>>;

fn always(name: &'static str, visit: impl Fn(&State<World>) -> Vec<Point> + Send + Sync + 'static) -> Primitives {
    vec![Box::new(Made { name, useful: |_: &State<World>| true, visit })]
}

/// A path of `primitives` from the start of the small world to a robot target that they never reach.
fn wander(primitives: &Primitives, max_depth: usize, seed: u64) -> Path<World> {
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let m = problem.domain();
    let target = PartialState::anywhere(m).with_robot(m, [2.5, 1.7]);
    path(m, primitives, problem.start(), &target, max_depth, &mut rng(seed))
}

#[test]
fn primitives_that_undo_each_other_end_in_no_progress() {
    let mut primitives = always("There", |_| vec![[0.5, 0.5]]);
    primitives.extend(always("Back", |_| vec![[0.5, 1.0]]));
    for seed in 0..10 {
        let e = wander(&primitives, 50, seed);
        assert_eq!(e.end, PathEnd::Stuck);
        assert_eq!(e.instances.len(), 1, "only There leads anywhere");
        assert_eq!(e.states.len(), 2);
        let propagated = e.trials.iter().filter(|(_, trial)| matches!(trial, Trial::Propagated { .. })).count();
        assert_eq!(propagated, 1);
        assert!(e.trials.contains(&(1, Trial::NoProgress)) && e.trials.contains(&(0, Trial::NoProgress)));
    }
}

#[test]
fn a_loop_within_one_propagation_is_no_progress_either() {
    let e = wander(&always("Loop", |from| vec![[0.5, 0.5], from.robot]), 50, 0);
    assert_eq!((e.end, e.instances.len(), e.states.len()), (PathEnd::Stuck, 0, 1));
    assert_eq!(e.trials[..], [(0, Trial::NoProgress)]);
}

#[test]
fn a_primitive_that_never_arrives_is_stopped_by_the_depth() {
    let restless = || always("Restless", |from| vec![[from.robot[0], from.robot[1] - 0.01]]);
    for depth in [0, 1, 7] {
        let e = wander(&restless(), depth, 0);
        assert_eq!((e.end, e.instances.len(), e.states.len()), (PathEnd::Depth, depth, depth + 1));
    }
    let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
    parts.primitives = restless();
    let problem = Problem::new(parts).unwrap();
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [2.5, 1.7]);
    let extend = |max_depth| {
        let options = ExtendOptions { max_depth, ..ExtendOptions::default() };
        extend_towards(&problem, &options, problem.start(), &target, &mut rng(0))
    };
    assert_eq!(extend(5).buckets[..], [Bucket::Depth]);
    // Blocked at the edge of the floor before the depth matters; the bucket tells how far it got before.
    let blocked = extend(200);
    assert_eq!(blocked.buckets[..], [Bucket::Accepted]);
    assert_eq!(blocked.blame.unwrap().kind, BlockKind::Limits);
}

#[test]
fn a_primitive_that_gives_nothing_or_nonsense_makes_no_progress() {
    for primitives in [
        always("Nothing", |_| Vec::new()),
        always("Still", |from| vec![from.robot]),
        always("NotANumber", |_| vec![[f64::NAN, 0.5]]),
        always("Nearly", |from| vec![[from.robot[0] + 1e-12, from.robot[1]]]),
    ] {
        let e = wander(&primitives, 50, 0);
        assert_eq!((e.end, e.instances.len()), (PathEnd::Stuck, 0), "{}", primitives[0].name());
        assert_eq!(e.trials[..], [(0, Trial::NoProgress)]);
    }
}

#[test]
fn a_useful_primitive_that_fails_gives_way_to_another() {
    let mut primitives = always("Nothing", |_| Vec::new());
    primitives.extend(always("Arrive", |_| vec![[2.5, 1.7]]));
    for seed in 0..10 {
        let e = wander(&primitives, 5, seed);
        assert_eq!((e.end, e.instances.len()), (PathEnd::Met, 1));
        assert_eq!(e.useful[..], [true, true]);
    }
}

#[test]
fn the_buckets_tell_who_got_how_far() {
    use Bucket::{Accepted, Behind, Depth, NotUseful, RobotFixed};
    type Move = Made<fn(&State<World>) -> bool, fn(&State<World>) -> Vec<Point>>;
    let down = || Move { name: "Down", useful: |s| s.robot[1] > 0.7 && s.robot[0] < 1.0, visit: |_| vec![[0.5, 0.5]] };
    let right = || Move { name: "Right", useful: |s| s.robot == [0.5, 0.5], visit: |_| vec![[2.0, 0.5]] };
    let up = || Move { name: "Up", useful: |s| s.robot[0] > 1.0, visit: |_| vec![[2.0, 1.5]] };
    let buckets = |setup: Setup, max_depth| {
        let mut parts = setup.puck_goal(0, [2.0, 1.0]).parts().unwrap();
        parts.primitives = vec![Box::new(down()), Box::new(right()), Box::new(up())];
        let problem = Problem::new(parts).unwrap();
        let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [2.0, 1.5]);
        let options = ExtendOptions { max_depth, ..ExtendOptions::default() };
        extend_towards(&problem, &options, problem.start(), &target, &mut rng(0)).buckets.to_vec()
    };
    assert_eq!(buckets(small(), 5), [Accepted, Accepted, Accepted]);
    assert_eq!(buckets(small(), 2), [Accepted, Depth, NotUseful]);
    let walled = small().wall("wall", [1.2, 0.3], [1.3, 0.7]);
    assert_eq!(buckets(walled, 5), [Accepted, RobotFixed, Behind]);
}

/// Finds something in the way before it goes anywhere.
struct Walled(BlockKind);

impl Primitive<World> for Walled {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(24, "Walled")
    }

    fn useful(&self, _: &World, _: &State<World>, _: &PartialState<World>) -> bool {
        true
    }

    fn propagate(
        &self,
        _: &World,
        _: &State<World>,
        _: &PartialState<World>,
        _: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let blame = Blame { kind: self.0, first: "robot".into(), second: "wall".into(), place: [0.0; 3] };
        Err(Infeasible::Blocked(blame))
    }
}

#[test]
fn an_extension_tells_what_its_primitives_found_in_the_way() {
    let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
    parts.primitives = vec![Box::new(Walled(BlockKind::RobotFixed))];
    let problem = Problem::new(parts).unwrap();
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [2.5, 1.7]);
    let e = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(0));
    assert!(!e.is_met && e.reached.is_empty());
    assert_eq!(e.blame.unwrap().kind, BlockKind::RobotFixed);
    assert_eq!(e.buckets[..], [Bucket::RobotFixed]);
}

#[test]
fn arriving_with_the_last_allowed_primitive_counts_as_met() {
    assert_eq!(wander(&always("Arrive", |_| vec![[2.5, 1.7]]), 1, 0).end, PathEnd::Met);
}

#[test]
fn a_search_with_only_bad_primitives_ends_and_balances() {
    let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
    parts.primitives = always("There", |_| vec![[0.5, 0.5]]);
    parts.primitives.extend(always("Back", |_| vec![[0.5, 1.0]]));
    parts.primitives.extend(always("NotANumber", |_| vec![[f64::NAN, 0.5]]));
    parts.primitives.extend(always("Nothing", |_| Vec::new()));
    let outcome = run(&Problem::new(parts).unwrap(), &options(0, 300));
    assert!(outcome.solution.is_none() && outcome.accounts.are_balanced());
    assert_eq!(outcome.iterations, 300);
}
