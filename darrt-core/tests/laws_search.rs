//! Partial states, distances, samplers and goals of the core keep their laws on two domains.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::goal::{AnyOf, Goal, Reach, Region};
use darrt_core::laws::motion::component_travel;
use darrt_core::laws::nearest::tree_of;
use darrt_core::laws::{
    MotionClaims, SpaceClaims, check_distance, check_domain, check_goal, check_motion, check_nearest, check_not_above,
    check_partial, check_sampler, check_sampler_covers,
};
use darrt_core::motion::{Straight, Waypoints};
use darrt_core::partial::PartialState;
use darrt_core::sample::{Full, GoalBiased, Placed, RandomSubset, RobotOrObjects, Sampler};
use darrt_core::space::Place;
use darrt_core::state::{ObjectId, State};
use darrt_core::testing::broken::bench::{Bench, Tag, state};
use darrt_core::testing::puck::{Mode, Puck, PuckWorld};
use darrt_core::testing::strategies::{config, looks, parameters, seeds, states, targets};
use darrt_core::variants::{ApproachVisit, Frontier, Weighted};
use proptest::prelude::*;

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_search.txt");

fn pucks(count: usize) -> PuckWorld {
    let puck = |i| Puck { name: format!("puck {i}").into(), radius_m: 0.12, is_graspable: i % 2 == 0 };
    PuckWorld::new([4.0, 3.0], 0.15, (0..count).map(puck).collect()).unwrap()
}

/// Every distance of the core.
fn all_distances<D: Domain>() -> Vec<Box<dyn Distance<D>>> {
    vec![
        Box::new(Euclidean),
        Box::new(GreedyVisit),
        Box::new(ExactTour),
        Box::new(Weighted::sum(0.3, 2.0).unwrap()),
        Box::new(Weighted::maximum(1.0, 0.7).unwrap()),
        Box::new(ApproachVisit::new(Vec::new())),
    ]
}

/// One generic check, on both domains.
macro_rules! on_both_domains {
    ($($name:ident),+) => { $(
        #[test]
        fn $name() {
            checks::$name(&Bench::default(), Tag::default());
            for count in [0, 1, 4] {
                checks::$name(&pucks(count), Mode::resting(count));
            }
        }
    )+ };
}

on_both_domains!(domains, motions, partial_states, distances, nearest_nodes, samplers, goals);

mod checks {
    use super::*;

    pub(super) fn domains<D: Domain>(m: &D, mode: D::Mode) {
        let s = states(m, mode);
        let all = (s.clone(), s.clone(), s, parameters(), parameters(), seeds());
        proptest!(config(48, REGRESSIONS), |((a, b, c, t, u, seed) in all)| {
            check_domain(m, &SpaceClaims::default(), [&a, &b, &c], [t, u], seed)?;
        });
    }

    /// Through random states, some twice (a segment without length); from one mode to another and back.
    pub(super) fn motions<D: Domain>(m: &D, mode: D::Mode) {
        let way = proptest::collection::vec((states(m, mode), any::<bool>()), 2..6);
        proptest!(config(96, REGRESSIONS), |(way in way, ts in looks())| {
            let stops: Vec<_> = way.into_iter().flat_map(|(s, twice)| vec![s; 1 + usize::from(twice)]).collect();
            let segments: Vec<_> = stops.windows(2).map(|segment| component_travel(m, &segment[0], &segment[1])).collect();
            let (start, claims) = (stops[0].clone(), MotionClaims::default());
            let straight = Straight::new(start.clone(), stops[1].robot.clone(), segments[0]);
            check_motion(m, &straight, &start, &ts, &claims)?;
            if let Some(motion) = Waypoints::new(stops, &segments, start.mode.clone()) {
                check_motion(m, &motion, &start, &ts, &claims)?;
            }
        });
    }

    pub(super) fn partial_states<D: Domain>(m: &D, mode: D::Mode) {
        let s = states(m, mode);
        proptest!(config(96, REGRESSIONS), |(a in targets(m), b in targets(m), here in s.clone(), there in s)| {
            check_partial(m, [&a, &b], &here, &there)?;
            check_partial(m, [&a, &a], &here, &here)?;
        });
    }

    pub(super) fn distances<D: Domain>(m: &D, mode: D::Mode) {
        let s = states(m, mode);
        proptest!(config(96, REGRESSIONS), |(to in targets(m), here in s.clone(), there in s)| {
            for distance in all_distances() {
                let distance = &*distance;
                check_distance(m, distance, &here, &to, &there)?;
                check_distance(m, distance, &to.overlay(m, &here), &to, &there)?;
            }
            check_not_above(m, &ExactTour, &GreedyVisit, &here, &to)?;
        });
    }

    pub(super) fn nearest_nodes<D: Domain>(m: &D, mode: D::Mode) {
        let s = states(m, mode);
        let many = proptest::collection::vec(s.clone(), 0..24);
        proptest!(config(48, REGRESSIONS), |(to in targets(m), root in s, others in many)| {
            // Twins of the nodes make ties.
            let twice = others.iter().chain(&others).cloned();
            let tree = tree_of(m, &root, twice);
            for distance in all_distances() {
                check_nearest(m, &*distance, &tree, &to)?;
            }
        });
    }

    pub(super) fn samplers<D: Domain>(m: &D, mode: D::Mode) {
        let full = PartialState::anywhere(m).with_robot(m, home(m));
        let goal = Reach::<D>::new(full);
        let biased = GoalBiased::new(RandomSubset, 0.3).unwrap();
        let in_part = GoalBiased::new(RandomSubset, 0.5).unwrap().in_part(0.5).unwrap();
        let subsets = RobotOrObjects::new(0.5, 0.5).unwrap();
        let boxed: Box<dyn Sampler<D>> = Box::new(RandomSubset);
        let standing = Placed::new(Full, Place::OnSupport, 0.5).unwrap();
        let edge = Placed::new(RandomSubset, Place::SupportEdge, 0.7).unwrap();
        let mut frontier = Frontier::new(RandomSubset, 0.5, 0.2).unwrap();
        let from = anywhere(m, mode);
        for i in 0..20 {
            let rng = &mut darrt_core::random::stream(i, 0, 0, darrt_core::random::Purpose::Sample);
            let target = Full.sample(m, &goal, rng);
            let at = target.overlay(m, &from);
            frontier.learn_block(m, &at, &target);
        }
        let all =
            [&Full as &dyn Sampler<D>, &RandomSubset, &biased, &in_part, &subsets, &boxed, &standing, &edge, &frontier];
        for sampler in all {
            proptest!(config(48, REGRESSIONS), |(seed in seeds())| {
                check_sampler(m, sampler, &goal, seed)?;
            });
            check_sampler_covers(m, sampler, &goal, 200, 1).unwrap();
        }
    }

    fn anywhere<D: Domain>(m: &D, mode: D::Mode) -> State<D> {
        use darrt_core::random::{Purpose, stream};
        use darrt_core::space::ComponentSpace;
        let rng = &mut stream(9, 0, 0, Purpose::Sample);
        let objects = m.objects().iter().map(|space| space.sample(rng)).collect();
        State { robot: m.robot().sample(rng), objects, mode }
    }

    fn home<D: Domain>(m: &D) -> darrt_core::state::RobotConfig<D> {
        use darrt_core::random::{Purpose, stream};
        use darrt_core::space::ComponentSpace;
        m.robot().sample(&mut stream(0, 0, 0, Purpose::Sample))
    }

    #[allow(clippy::needless_pass_by_value, reason = "all checks here have one signature")]
    pub(super) fn goals<D: Domain>(m: &D, mode: D::Mode) {
        proptest!(config(48, REGRESSIONS), |(a in targets(m), b in targets(m), from in states(m, mode.clone()), seed in seeds())| {
            let wanted = mode.clone();
            let reach = Reach::new(a.clone()).in_mode(Box::new(move |mode| *mode == wanted));
            check_goal(m, &reach, &from, seed)?;
            // Of two goals of which one is part of the other, the larger one asks for nothing.
            prop_assume!(!a.is_met(m, &b.overlay(m, &from)) && !b.is_met(m, &a.overlay(m, &from)));
            let any = AnyOf::<D>::new(vec![Box::new(Reach::new(a.clone())), Box::new(Reach::new(b))]);
            check_goal(m, &any, &from, seed)?;
            check_goal(m, &AnyOf::new(Vec::new()), &from, seed)?;
            let (test, draw) = (a.clone(), a);
            let region = Region::<D>::new(Box::new(move |m, s| test.is_met(m, s)), Box::new(move |_, _| Some(draw.clone())));
            check_goal(m, &region, &from, seed)?;
        });
    }
}

/// The mode changes at the very beginning, before anything moves: a grasp and then a lift in one motion.
#[test]
fn a_first_segment_without_length_keeps_its_mode() {
    let m = Bench::default();
    let (open, held) = (state([0.5, 0.0]), State { mode: Tag::new(1), ..state([0.5, 0.0]) });
    let end = State { mode: Tag::new(2), ..state([1.5, 0.0]) };
    let motion = Waypoints::new(vec![open.clone(), held.clone(), end.clone()], &[0.0, 1.0], held.mode.clone()).unwrap();
    check_motion(&m, &motion, &open, &[0.1, 0.5, 0.999], &MotionClaims::default()).unwrap();
    let last = Waypoints::new(vec![open.clone(), end.clone(), end], &[1.0, 0.0], held.mode).unwrap();
    check_motion(&m, &last, &open, &[0.1, 0.5, 0.999], &MotionClaims::default()).unwrap();
}

#[test]
fn an_empty_union_of_goals_is_neither_satisfied_nor_sampled() {
    let m = pucks(1);
    let state = State { robot: [1.0, 1.0], objects: [[2.0, 2.0]].into_iter().collect(), mode: Mode::resting(1) };
    let goal = AnyOf::<PuckWorld>::new(Vec::new());
    assert!(!goal.is_satisfied(&m, &state));
    let mut rng = darrt_core::random::stream(0, 0, 0, darrt_core::random::Purpose::Sample);
    assert_eq!(goal.sample(&m, &mut rng), None);
    assert!(PartialState::anywhere(&m).object(ObjectId::new(3)).is_none());
}
