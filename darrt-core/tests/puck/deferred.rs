//! Motions that are judged only when a plan needs them.

use std::sync::Arc;

use darrt_core::budget::Interrupt;
use darrt_core::distance::{Distance, GreedyVisit};
use darrt_core::extend::{ExtendOptions, Extender};
use darrt_core::laws::check_planner;
use darrt_core::lazy_validation::{NotValidated, validate_steps};
use darrt_core::local_repair::{LocalRepair, NoWay};
use darrt_core::motion::{Instance, Waypoints};
use darrt_core::nearest::linear::nearest_by;
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::plan::Step;
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::shorten::ShortenOptions;
use darrt_core::solve::solve;
use darrt_core::state::{ComponentSet, State};
use darrt_core::testing::puck::{Setup, paper_strategy, problems};
use darrt_core::tree::{Edge, NodeId, Tree};
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use rand::Rng;

use super::support::{World, called, id, options, rng, robot_instance, small};

const DEFER: ExtendOptions = ExtendOptions { spacing_m: 0.1, max_depth: 20, defer: true, step_m: None };

fn deferring() -> Strategy<World> {
    Strategy { extend: DEFER, shorten: ShortenOptions { extensions: 200 }, ..paper_strategy().unwrap() }
}

#[test]
fn what_is_solved_so_is_verified_and_keeps_the_laws_of_the_planner() {
    let strategy = deferring();
    for make in [problems::open, problems::two_pucks] {
        let problem = make().unwrap();
        for seed in 0..4 {
            let outcome = solve(&problem, &strategy, &options(seed, 5000), &mut Silent);
            assert!(outcome.solution.is_some(), "seed {seed}: {:?}", outcome.stop);
        }
    }
    for make in [problems::open, problems::wall_with_gap] {
        check_planner(&make().unwrap(), &strategy, &options(2, 60)).unwrap();
    }
}

/// A wall stands between the robot and where it is to go; the straight way is blocked, around it one is not.
fn walled() -> Problem<World> {
    let floor = Setup::new([3.0, 2.0], 0.15).robot_at([0.5, 0.5]).puck("red", 0.12, [2.5, 1.5]);
    floor.wall("wall", [0.9, 0.0], [1.1, 1.5]).puck_goal(0, [2.5, 1.0]).problem().unwrap()
}

/// Above the wall.
struct Above;

impl LocalRepair<World> for Above {
    fn is_free_to_turn(&self, _: &World, instance: &Instance<World>) -> bool {
        instance.primitive.name() == "Transit"
    }

    fn repair(
        &self,
        m: &World,
        _: &dyn Validity<World>,
        _: usize,
        instance: &Instance<World>,
        from: &State<World>,
        _: &mut dyn Rng,
    ) -> Result<Instance<World>, NoWay> {
        let end = instance.at(m, 1.0, from);
        let over = |x| State { robot: [x, 1.8], ..from.clone() };
        let stops = vec![from.clone(), over(from.robot[0]), over(end.robot[0]), end.clone()];
        let motion = Waypoints::new(stops, &[1.5, 2.0, 1.5], from.mode.clone()).ok_or(NoWay::WithAnyCare)?;
        Ok(Instance { motion: Box::new(motion), ..robot_instance(from, &end) })
    }
}

#[test]
fn a_blocked_motion_goes_another_way_or_is_named() {
    let problem = walled();
    let m = problem.domain();
    let start = problem.start().clone();
    let there = PartialState::anywhere(m).with_robot(m, [2.0, 0.5]);
    let extender =
        |local_repair| Extender { problem: &problem, options: &DEFER, local_repair, interrupt: Interrupt::NEVER };
    let steps = |extender: &Extender<'_, World>| {
        let reached = extender.extend(&start, &there, &mut rng(0)).reached;
        assert_eq!(reached.iter().map(|r| r.t).collect::<Vec<_>>(), [1.0], "taken as free, and only its end is a node");
        reached
            .into_iter()
            .map(|r| Step { instance: r.instance, until: r.t, primitive: r.primitive })
            .collect::<Vec<_>>()
    };
    let straight = extender(None);
    match validate_steps(&straight, &start, steps(&straight), &mut rng(0)) {
        Err(NotValidated::Blocked(instance, blame)) => {
            assert_eq!(instance.primitive.name(), "Transit");
            assert!(blame.to_string().contains("robot against obstacle"), "{blame}");
        }
        other => panic!("{other:?}"),
    }
    let around = extender(Some(&Above as &dyn LocalRepair<World>));
    let validated = validate_steps(&around, &start, steps(&around), &mut rng(0)).unwrap();
    let [step] = &validated[..] else { panic!("{validated:?}") };
    assert_eq!(problem.validity().free_prefix(m, &step.instance, &start).blame, None);
    assert_eq!(step.instance.at(m, 1.0, &start).robot, [2.0, 0.5]);
    // What has been judged before is not judged again.
    let eager = ExtendOptions { defer: false, ..DEFER };
    let eager = Extender { options: &eager, ..straight };
    assert!(validate_steps(&eager, &start, steps(&straight), &mut rng(0)).is_ok());
}

/// By the rules all is free; with a care of 1 only motions called "narrow" or "wide" are, with 2 only "wide" ones.
struct Wary;

impl Validity<World> for Wary {
    fn check(&self, _: &World, _: &State<World>, _: &ComponentSet) -> Result<(), Blame> {
        Ok(())
    }

    fn free_prefix(&self, _: &World, _: &Instance<World>, _: &State<World>) -> FreePrefix {
        FreePrefix::FREE
    }

    fn most_care(&self) -> usize {
        2
    }

    fn free_prefix_with(&self, care: usize, _: &World, instance: &Instance<World>, _: &State<World>) -> FreePrefix {
        match (care, instance.primitive.name()) {
            (0, _) | (1, "narrow") | (_, "wide") => FreePrefix::FREE,
            _ => {
                let (first, second) = ("robot".into(), "margin".into());
                FreePrefix::blocked(0.5, Blame { kind: BlockKind::Other, first, second, place: [0.0; 3] })
            }
        }
    }
}

/// By care: what it finds another way for, called so.
struct Finds([Option<&'static str>; 3]);

impl LocalRepair<World> for Finds {
    fn is_free_to_turn(&self, _: &World, instance: &Instance<World>) -> bool {
        instance.primitive.name() == "go"
    }

    fn repair(
        &self,
        m: &World,
        _: &dyn Validity<World>,
        care: usize,
        instance: &Instance<World>,
        from: &State<World>,
        _: &mut dyn Rng,
    ) -> Result<Instance<World>, NoWay> {
        let found = self.0[care]
            .map(|name| Instance { primitive: called(name), ..robot_instance(from, &instance.at(m, 1.0, from)) });
        found.ok_or(NoWay::WithThisCare)
    }
}

#[test]
fn what_may_turn_aside_goes_with_as_much_care_as_a_way_is_found_for() {
    let mut parts = small().puck_goal(0, [1.5, 1.5]).parts().unwrap();
    parts.validity = Box::new(Wary);
    let problem = Problem::new(parts).unwrap();
    let start = problem.start().clone();
    let there = State { robot: [1.0, 0.3], ..start.clone() };
    let validated = |name, finds| {
        let instance = Arc::new(Instance { primitive: called(name), ..robot_instance(&start, &there) });
        let local_repair = Finds(finds);
        let extender = Extender {
            problem: &problem,
            options: &DEFER,
            local_repair: Some(&local_repair),
            interrupt: Interrupt::NEVER,
        };
        validate_steps(&extender, &start, [Step { instance, until: 1.0, primitive: 0 }], &mut rng(0)).unwrap()[0]
            .instance
            .primitive
            .name()
    };
    assert_eq!(validated("wide", [None; 3]), "wide");
    assert_eq!(validated("go", [None, Some("narrow"), Some("wide")]), "wide");
    assert_eq!(validated("go", [None, Some("narrow"), Some("narrow")]), "narrow", "what is found is judged");
    assert_eq!(validated("go", [None, Some("narrow"), None]), "narrow");
    assert_eq!(validated("go", [None; 3]), "go", "free by the rules");
    assert_eq!(validated("push", [None, Some("narrow"), Some("wide")]), "push", "it must go as it does");
}

#[test]
fn a_pruned_branch_is_gone_and_all_else_stays_as_it_was() {
    let problem = small().problem().unwrap();
    let m = problem.domain();
    let at = |x: f64, puck: f64| {
        let mut state = State { robot: [x, 0.3], ..problem.start().clone() };
        state.objects[0][1] += puck;
        state
    };
    // Root - a - b - c, b - d, root - e; a moves the puck, and so does d.
    let mut tree = Tree::rooted_at(m, problem.start().clone());
    let mut add = |parent: NodeId, state: State<World>| {
        let instance = Arc::new(robot_instance(&tree.node(parent).unwrap().state.clone(), &state));
        let edge = Edge { parent, instance: Arc::clone(&instance), t: 1.0, primitive: 0 };
        (tree.add(m, state, edge).unwrap(), instance)
    };
    let (a, _) = add(Tree::<World>::ROOT, at(0.2, 0.1));
    let (b, to_b) = add(a, at(0.4, 0.1));
    let (c, _) = add(b, at(0.6, 0.1));
    let (d, to_d) = add(b, at(0.8, 0.2));
    let (e, _) = add(Tree::<World>::ROOT, at(1.0, 0.0));
    for (node, metres) in [(a, 0.5), (e, 0.25)] {
        tree.penalise(node, metres);
    }
    assert_eq!(tree.prune(m, e, &to_d), 0, "not on the way to e");
    assert_eq!(tree.len(), 6);
    assert_eq!(tree.prune(m, c, &to_b), 3, "b, c and d");
    let left: Vec<_> = tree.iter().map(|(_, node)| node.state.robot[0]).collect();
    assert_eq!(left, [problem.start().robot[0], 0.2, 1.0]);
    assert!(tree.iter().skip(1).all(|(_, node)| node.edge.as_ref().unwrap().parent == Tree::<World>::ROOT));
    let penalties: Vec<_> = tree.iter().map(|(_, node)| tree.penalty_m(node)).collect();
    assert_eq!(penalties, [0.25, 0.5, 0.25]);
    for (x, y) in [(0.1, 1.0), (0.9, 1.4), (2.0, 0.5)] {
        for target in
            [PartialState::anywhere(m).with_robot(m, [x, y]), PartialState::anywhere(m).with_object(id(0), [x, y])]
        {
            let obvious = nearest_by(&tree, |state| GreedyVisit.distance(m, state, &target));
            assert_eq!(GreedyVisit.nearest(m, &tree, &target), obvious);
        }
    }
    assert!(d.index() > b.index());
}
