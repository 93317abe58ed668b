//! A robot with two hands, neither of which reaches all of a table: one sets an object down where the other takes it up.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::budget::Budget;
use darrt_core::distance::Euclidean;
use darrt_core::observe::Silent;
use darrt_core::problem::{Parts, Problem};
use darrt_core::sample::{Full, GoalBiased};
use darrt_core::search::Strategy;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::state::ObjectId;
use darrt_core::verify::{Replay, Solution};
use darrt_geom::shape::Shape;
use darrt_primitives::goal::{Grip as InHand, ObjectGoal, TabletopGoal, Whereabouts};
use darrt_primitives::grasp::footprint::Footprint;
use darrt_primitives::grasp::{Grip, overhead::OverheadGrasps};
use darrt_primitives::laws::{TabletopClaims, check_tabletop_instance};
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator as _};
use darrt_primitives::primitive::PICK;
use darrt_primitives::primitive::arm_rigid_transfer::ArmRigidTransfer;
use darrt_primitives::primitive::arm_transit::ArmTransit;
use darrt_primitives::primitive::pick::Pick;
use darrt_primitives::primitive::place::Place;
use darrt_primitives::primitive::straight_line_arm_transit::StraightLineArmTransit;
use darrt_primitives::tabletop::builder::TabletopBuilder;
use darrt_primitives::tabletop::{Movable, Tabletop};
use darrt_primitives::testing::twins::{BASE, Twins, hands_at};
use darrt_primitives::validity::SceneValidity;
use nalgebra::Vector3;

type Solved = (Solution<Tabletop<Twins>>, Problem<Tabletop<Twins>>);

/// A tin on the left of a table is wanted on the right of it.
fn across(robot: Twins, seed: u64) -> Option<Solved> {
    let (radius, half_height) = (0.03, 0.05);
    let grip = Grip { open_gap: 0.08, tip_ahead: 0.03, ..Grip::default() };
    let grasps = OverheadGrasps::new(Footprint::Disc { radius }, 2.0 * half_height, 0.03, grip).unwrap();
    let tin = Movable::new("tin", Shape::cylinder(radius, half_height).unwrap()).unwrap().grasped_by(grasps);
    let aside = hands_at([-0.9, 0.0, 1.4], [0.9, 0.0, 1.4], 0).unwrap();
    let (domain, start) = TabletopBuilder::new(robot, Configuration { base: BASE, arm: aside })
        .table("table", [0.0, 0.0], [2.2, 1.2], 0.7)
        .object(tin, "table", [-0.7, 0.2], 0.0)
        .with_settings(|settings| {
            settings.drives = [false; 2];
            settings.postures = vec![aside];
        })
        .build()
        .unwrap();
    let goal = TabletopGoal::new(vec![vec![ObjectGoal {
        object: ObjectId::new(0),
        whereabouts: Whereabouts::At(Vector3::new(0.7, -0.2, 0.7 + half_height)),
        tolerance_m: 0.01,
        yaw: None,
        grip: InHand::Released,
    }]]);
    let validity = Box::new(SceneValidity::new(&domain));
    let verifier = Box::new(Replay::new(SceneValidity::new(&domain), 0.005));
    let primitives: Vec<Box<dyn darrt_core::primitive::Primitive<_>>> = vec![
        Box::new(ArmTransit),
        Box::new(StraightLineArmTransit),
        Box::new(ArmRigidTransfer),
        Box::new(Pick),
        Box::new(Place),
    ];
    let problem = Problem::new(Parts { domain, start, goal: Box::new(goal), primitives, validity, verifier }).unwrap();
    let strategy = Strategy::new(GoalBiased::new(Full, 0.3).unwrap(), Euclidean);
    let budget = Budget { iterations: Some(3000), ..Budget::default() };
    let options = SolveOptions { seed, budget, ..SolveOptions::default() };
    let solution = solve(&problem, &strategy, &options, &mut Silent).solution?;
    Some((solution, problem))
}

#[test]
fn one_hand_sets_down_what_the_other_takes_up() {
    for seed in 0..5 {
        let (solution, problem) = across(Twins::new().unwrap(), seed).unwrap();
        let m = problem.domain();
        let mut here = problem.start().clone();
        let mut takers = Vec::new();
        let ts = [0.1, 0.35, 0.5, 0.85];
        for step in solution.plan().steps() {
            if step.until >= 1.0 {
                check_tabletop_instance(m, &step.instance, &here, &ts, &TabletopClaims::default()).unwrap();
            }
            let inside = step.instance.at(m, f64::MIN_POSITIVE, &here);
            assert_eq!(inside.mode.hand(), inside.robot.arm.hand_at_work());
            if step.instance.primitive == PICK {
                takers.push(inside.mode.hand());
            }
            here = step.instance.at(m, step.until, &here);
            assert_eq!(here.mode.hand(), here.robot.arm.hand_at_work());
            if let Some(held) = here.mode.held() {
                let expected = m.manipulator().world_from_tool(&here.robot) * held.tool_from_object;
                assert!((expected.translation.vector - here.objects[0].translation.vector).norm() < 1e-9);
            }
        }
        assert!(takers.contains(&0) && takers.contains(&1), "{takers:?}");
    }
}
