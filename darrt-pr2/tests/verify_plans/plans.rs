//! Three right plans, and what is needed to make them wrong.

use darrt_pr2::arm::{Arm, ArmConfiguration, LimitKind, Side};
use darrt_pr2::forward::{ArmChain, world_from_base};
use darrt_pr2::plan_file::{AllowedContact, ContactReason, PlanFile};
use darrt_pr2::postures::ArmPosture;
use darrt_pr2::problem_file::{Goal, ObjectGoal, PrimitiveName, ProblemFile, builtin};
use nalgebra::Vector3;

use crate::builder::{Builder, PLATE, TABLE};

/// The contact of the worked push of Plate1: base, and the right arm at the contact.
const PUSH_BASE: [f64; 3] = [-0.8, 0.0, 0.0];
const PUSH_CONTACT: ArmConfiguration = [0.240989, 0.225073, -1.17, -0.825254, -2.010273, -1.699174, -0.579167];

/// The level grasp of the worked pick at the right edge of Plate1.
const PICK_BASE: [f64; 3] = [-0.66, -1.43, 2.27];
const PICK_GRASP: ArmConfiguration = [-1.66434, 0.100358, -2.2, -1.432225, 2.30036, -0.790752, -2.153001];
const PICK_PLATE: [f64; 2] = [-0.2, -0.53];

/// Gap of the open hand of the pick, and of the hand that holds the plate.
pub(crate) const OPEN: f64 = 0.045;
pub(crate) const CLOSED: f64 = 0.02;

/// One object goal on the central table, all else by default.
pub(crate) fn goal_on_table(at: [f64; 2]) -> ObjectGoal {
    ObjectGoal {
        object: PLATE.to_owned(),
        on: Some("central table".to_owned()),
        at: Some(at),
        region: None,
        position: None,
        tolerance_m: 0.005,
        yaw: None,
        yaw_tolerance: 0.05,
        state: None,
    }
}

fn problem(name: &str, base: [f64; 3], q: ArmConfiguration, plate: [f64; 2], goal: [f64; 2]) -> ProblemFile {
    let mut problem = builtin(name).unwrap();
    problem.robot.base = base;
    problem.robot.posture = None;
    problem.robot.joints = Some(q.to_vec());
    problem.objects[0].at = plate;
    // It stands where the elbow of these simple motions goes.
    problem.obstacles.retain(|obstacle| obstacle.name != "tin");
    problem.goal = Goal { objects: vec![goal_on_table(goal)] };
    problem
}

/// Where the arm is when the tool is moved straight by `way` (world) from where `q` has it.
fn moved(base: [f64; 3], q: ArmConfiguration, way: Vector3<f64>) -> ArmConfiguration {
    let arm = Arm::new(Side::Right, 0.2, LimitKind::Soft).unwrap();
    let mut tool = ArmChain::new(Side::Right, 0.2).world_from_tool(&base, &q);
    let start = tool.translation.vector;
    (1..=10).fold(q, |near, i| {
        tool.translation.vector = start + way * (f64::from(i) / 10.0);
        arm.inverse_near(&(world_from_base(&base).inverse() * tool), &near, 0.3).expect("the arm reaches")
    })
}

/// Plate1, shortened: down behind the plate, push it 0.3 m to the right, up again.
pub(crate) fn push() -> PlanFile {
    push_of([-0.2, 0.05])
}

/// The same with the plate starting elsewhere.
pub(crate) fn push_of(plate: [f64; 2]) -> PlanFile {
    let back = Vector3::new(0.0, 0.01, 0.0);
    let up = Vector3::new(0.0, 0.0, 0.1);
    let high = moved(PUSH_BASE, PUSH_CONTACT, back + up);
    let problem = problem("plate1", PUSH_BASE, high, plate, [plate[0], plate[1] - 0.3]);
    let mut b = Builder::new(&problem, high, 0.08);
    b.begin(PrimitiveName::StraightLineArmTransit, Some(PLATE)).line(-up);
    b.begin(PrimitiveName::Push, Some(PLATE)).touching(ContactReason::Push).line(-back);
    b.push(Vector3::new(0.0, -0.3, 0.0), -1.44);
    b.begin(PrimitiveName::StraightLineArmTransit, Some(PLATE)).touching(ContactReason::Retreat).line(up);
    b.plan(&problem)
}

/// The empty table of Simple Plate, the plate over its right edge: grasp the rim, lift, carry it by base and by arm, set
/// it down again, back off.
pub(crate) fn carry() -> PlanFile {
    let out = Vector3::new(0.0, -0.1, 0.0);
    let lift = Vector3::new(0.0, 0.0, 0.05);
    let away = moved(PICK_BASE, PICK_GRASP, out);
    let problem = problem("simple-plate", PICK_BASE, away, PICK_PLATE, PICK_PLATE);
    let mut b = Builder::new(&problem, away, OPEN);
    b.begin(PrimitiveName::StraightLineArmTransit, Some(PLATE)).line(-out);
    b.begin(PrimitiveName::Pick, Some(PLATE)).attach().touching(ContactReason::Grasp);
    b.allow(vec![AllowedContact::support(PLATE, TABLE)]).hand(CLOSED).line(lift);
    let lifted = b.body.arms[0];
    b.begin(PrimitiveName::BaseRigidTransfer, None).touching(ContactReason::Grasp).drive([-0.66, -1.5, 2.3]);
    b.begin(PrimitiveName::ArmRigidTransfer, Some(PLATE)).touching(ContactReason::Grasp);
    let mut aside = lifted;
    aside[0] -= 0.1;
    b.arm_to(aside).arm_to(lifted);
    b.begin(PrimitiveName::BaseRigidTransfer, None).touching(ContactReason::Grasp).drive(PICK_BASE);
    b.begin(PrimitiveName::Place, Some(PLATE)).touching(ContactReason::Grasp);
    b.allow(vec![AllowedContact::support(PLATE, TABLE)]).line(-lift).hand(OPEN).detach();
    b.begin(PrimitiveName::StraightLineArmTransit, Some(PLATE)).touching(ContactReason::Retreat).line(out);
    b.plan(&problem)
}

/// Simple Plate with nothing to do: the arm waves and the base drives, two waypoints each.
pub(crate) fn wave() -> PlanFile {
    let mut problem = builtin("simple-plate").unwrap();
    let side = ArmPosture::Side.values(Side::Right);
    let plate = problem.objects[0].at;
    problem.goal = Goal { objects: vec![goal_on_table(plate)] };
    let mut b = Builder::new(&problem, side, 0.08);
    let mut high = side;
    high[0] += 1.2;
    b.begin(PrimitiveName::BaseTransit, None).hand(0.03).drive([-1.8, 0.0, 0.0]);
    b.begin(PrimitiveName::ArmTransit, None).arm_to(high);
    b.plan(&problem)
}
