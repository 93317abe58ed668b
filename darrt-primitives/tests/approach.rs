//! How far the hand must travel at least until it can push or grasp: never more than it does, and often just as much.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::primitive::Instances;
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_primitives::action::approach::{NO_WAY_M, to_grasp_m, to_push_m};
use darrt_primitives::action::{pick::pick, push::push};
use darrt_primitives::grasp::Grip;
use darrt_primitives::grasp::rim::{Rim, RimGrasps, RimOptions};
use darrt_primitives::length_range::LengthRange;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::primitive;
use darrt_primitives::push::edge_stop::EdgeRule;
use darrt_primitives::testing::gantry::{Gantry, TIP_BEYOND_TOOL_M};
use darrt_primitives::testing::table::{Table, TableState, altered_table, honest_table, object, start};
use nalgebra::{Isometry3, Vector3};

fn tool(m: &Table, state: &TableState) -> Vector3<f64> {
    m.manipulator().world_from_tool(&state.robot).translation.vector
}

/// Metres between where the hand is and where it comes to push or to grasp, after a law: no more than the travel.
fn gap_m(m: &Table, from: &TableState, instances: &Instances<Table>, bound_m: f64) -> f64 {
    let last = instances.last().unwrap();
    // The hand comes down a little behind what it pushes: the contact is the last waypoint where that has not moved yet.
    let rests = |t: f64| last.at(m, t, from).object(object(0)) == from.object(object(0));
    let knots = last.motion.knots();
    let t = if last.primitive == primitive::PUSH { knots.iter().copied().rfind(|t| rests(*t)).unwrap() } else { 0.0 };
    let travel_m: f64 = instances.iter().map(|instance| instance.motion.length()).sum();
    assert!(bound_m <= travel_m, "{bound_m} {travel_m}");
    (tool(m, &last.at(m, t, from)) - tool(m, from)).norm()
}

/// A push along an arc begins to one side of the line to its end: so much nearer may the contact of such a one be.
const ARC_M: f64 = 0.02;

fn is_tight(bound_m: f64, gap_m: f64) -> bool {
    (-1e-8..ARC_M).contains(&(gap_m - bound_m))
}

/// The target for the red tin.
fn target(from: &TableState, [x, y]: [f64; 2]) -> Isometry3<f64> {
    let mut target = *from.object(object(0)).unwrap();
    (target.translation.x, target.translation.y) = (x, y);
    target
}

/// The bound for a push of the red tin, and how far the hand came in many of them.
fn pushes(m: &Table, from: &TableState, at: [f64; 2]) -> (f64, Vec<f64>) {
    let target = target(from, at);
    let bound_m = to_push_m(m, from, object(0), &target);
    let all =
        (0..96).filter_map(|seed| push(m, from, object(0), &target, &mut stream(seed, 0, 0, Purpose::Extend)).ok());
    let gaps: Vec<_> = all.map(|instances| gap_m(m, from, &instances, bound_m)).collect();
    assert!(gaps.len() > 3, "{at:?}: {} pushes", gaps.len());
    (bound_m, gaps)
}

#[test]
fn to_a_push_on_the_table_it_is_the_way_to_the_contact() {
    let m = honest_table().unwrap();
    let from = start(&m);
    for at in [[-0.5, -0.3], [-0.7, -0.4], [-0.6, -0.1], [-0.62, -0.5]] {
        let (bound_m, gaps) = pushes(&m, &from, at);
        assert!(gaps.iter().all(|gap| is_tight(bound_m, *gap)), "{at:?}: {bound_m} {gaps:?}");
    }
    let [left, right] = [-0.5, -0.7].map(|x| to_push_m(&m, &from, object(0), &target(&from, [x, -0.3])));
    assert!((left - right).abs() > 0.01, "the contact lies behind the tin: {left} {right}");
}

/// A hand that leans stands farther back and lower: whichever lean is chosen, the bound is no more than the way to it.
#[test]
fn to_a_push_it_is_no_more_than_the_way_to_any_lean() {
    let from = start(&honest_table().unwrap());
    let leaning = |leans: &[f64]| {
        let leans_rad = leans.to_vec();
        altered_table(Gantry::new().unwrap(), |_, settings| settings.push.leans_rad = leans_rad).unwrap()
    };
    for at in [[-0.5, -0.3], [-0.7, -0.4], [-0.6, -0.1]] {
        let (upright_m, _) = pushes(&leaning(&[0.0]), &from, at);
        let (bound_m, gaps) = pushes(&leaning(&[0.6]), &from, at);
        assert!(gaps.iter().all(|gap| is_tight(bound_m, *gap)), "{at:?}: {bound_m} {gaps:?}");
        assert!((bound_m - upright_m).abs() > 1e-4, "{bound_m} {upright_m}");
        let any_m = to_push_m(&leaning(&[0.6, 0.0]), &from, object(0), &target(&from, at));
        assert_eq!(any_m, bound_m.min(upright_m));
    }
}

#[test]
fn to_a_push_over_the_edge_it_is_the_way_to_the_nearest_contact_that_may_be_chosen() {
    let m = honest_table().unwrap();
    let from = start(&m);
    // Beside an edge, and beside a corner.
    for (at, slack_m) in [([-1.4, 0.0], ARC_M), ([-1.2, -0.5], ARC_M), ([-1.4, -1.2], 0.1)] {
        let (bound_m, gaps) = pushes(&m, &from, at);
        let least_m = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(bound_m <= least_m + 1e-8 && least_m < bound_m + slack_m, "{at:?}: {bound_m} {least_m}");
    }
    let gantry = Gantry::new().unwrap();
    let m = altered_table(gantry, |_, settings| settings.push.edge_rule = EdgeRule::LineCrossing).unwrap();
    let (bound_m, gaps) = pushes(&m, &from, [-1.4, -0.1]);
    assert!(gaps.iter().all(|gap| is_tight(bound_m, *gap)), "{bound_m} {gaps:?}");
}

#[test]
fn to_a_grasp_it_is_no_more_than_the_way_to_any() {
    let m = honest_table().unwrap();
    let from = start(&m);
    for id in [object(0), object(1), object(2)] {
        let bound_m = to_grasp_m(&m, &from, id);
        let all = (0..48).filter_map(|seed| pick(&m, &from, id, &mut stream(seed, 0, 0, Purpose::Extend)).ok());
        let gaps: Vec<_> = all.map(|instances| gap_m(&m, &from, &instances, bound_m)).collect();
        assert!(!gaps.is_empty() && bound_m > 0.1, "{bound_m}");
        assert!(gaps.iter().all(|gap| bound_m <= *gap && *gap < bound_m + 0.1), "{bound_m} {gaps:?}");
    }
}

#[test]
fn there_is_no_way_to_what_can_be_neither_pushed_nor_grasped() {
    let approach = LengthRange::new(0.05, 0.1).unwrap();
    let grip = Grip { open_gap: 0.09, tip_ahead: TIP_BEYOND_TOOL_M, approach, ..Grip::default() };
    let rim = RimGrasps::new(
        Rim::level(0.04, 0.02, 0.04).unwrap(),
        grip,
        RimOptions { insertion: 0.02, ..RimOptions::default() },
    )
    .unwrap();
    let m = altered_table(Gantry::new().unwrap(), |objects, _| objects[0].grasps = vec![Box::new(rim)]).unwrap();
    let mut here = start(&m);
    assert_eq!(to_grasp_m(&m, &here, object(0)), NO_WAY_M, "no rim sticks out in the middle of the table");
    here.objects[0] = target(&here, [-0.9, -0.3]);
    assert!(to_grasp_m(&m, &here, object(0)) < 2.0);
    assert_eq!(to_push_m(&m, &here, object(2), &target(&here, [-0.6, 0.0])), NO_WAY_M, "a box is not pushed");
    let nothing = ObjectId::new(9);
    assert_eq!(to_push_m(&m, &here, nothing, &target(&here, [-0.6, 0.0])), NO_WAY_M);
    assert_eq!(to_grasp_m(&m, &here, nothing), NO_WAY_M);
}
