//! Three right plans, and what is needed to make them wrong.

use std::sync::LazyLock;

use darrt_pr2::arm::{Arm, ArmConfiguration, LimitKind, Side};
use darrt_pr2::forward::{ArmChain, world_from_base};
use darrt_pr2::postures::ArmPosture;
use darrt_pr2::problems::builtin;
use darrt_task::plan_file::{ContactReason, PlanFile};
use darrt_task::problem_file::{Goal, ObjectGoal, PrimitiveName, ProblemFile};
use nalgebra::Vector3;

use crate::verify_plans::builder::{Builder, PLATE, TABLE};

/// The contact of the worked push of Plate1: base, and the right arm at the contact.
const PUSH_BASE: [f64; 3] = [-0.8, 0.0, 0.0];
const PUSH_CONTACT: ArmConfiguration = [0.240_989, 0.225_073, -1.17, -0.825_254, -2.010_273, -1.699_174, -0.579_167];

/// The level grasp of the worked pick at the right edge of Plate1, of a plate 0.01 m farther out: the fingertips are 0.04 m
/// inside its rim.
const PICK_BASE: [f64; 3] = [-0.66, -1.43, 2.27];
const PICK_GRASP: ArmConfiguration = [-1.664_34, 0.100_358, -2.2, -1.432_225, 2.300_36, -0.790_752, -2.153_001];
pub(crate) const PICK_PLATE: [f64; 2] = [-0.2, -0.54];

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
    // They stand where the elbow of these simple motions goes.
    problem.obstacles.retain(|obstacle| !["tin", "mug"].contains(&obstacle.name.as_str()));
    problem.goal = Goal { objects: vec![goal_on_table(goal)], robot: None };
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
    static PLAN: LazyLock<PlanFile> = LazyLock::new(|| push_of([-0.2, 0.05]));
    PLAN.clone()
}

/// The same with the plate starting elsewhere.
pub(crate) fn push_of(plate: [f64; 2]) -> PlanFile {
    let back = Vector3::new(0.0, 0.01, 0.0);
    let up = Vector3::new(0.0, 0.0, 0.1);
    let high = moved(PUSH_BASE, PUSH_CONTACT, back + up);
    let problem = problem("plate1", PUSH_BASE, high, plate, [plate[0], plate[1] - 0.3]);
    let mut b = Builder::new(&problem, high, 0.08);
    b.begin(&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Some(PLATE)).line(-up);
    b.begin(&PrimitiveName::PUSH, Some(PLATE)).touching(ContactReason::Push).line(-back);
    b.push(Vector3::new(0.0, -0.3, 0.0), -1.44);
    b.begin(&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Some(PLATE)).touching(ContactReason::Retreat).line(up);
    b.plan(&problem)
}

/// The empty table of Simple Plate, the plate over its right edge: grasp the rim, lift, carry it by base and by arm, set
/// it down again, back off.
pub(crate) fn carry() -> PlanFile {
    static PLAN: LazyLock<PlanFile> = LazyLock::new(build_carry);
    PLAN.clone()
}

fn build_carry() -> PlanFile {
    carry_of(PICK_PLATE, |_| ())
}

/// The same with the plate elsewhere, its arm going to `aside` of where it lifts the plate.
pub(crate) fn carry_of(plate: [f64; 2], aside: impl Fn(&mut ArmConfiguration)) -> PlanFile {
    let out = Vector3::new(0.0, -0.1, 0.0);
    let lift = Vector3::new(0.0, 0.0, 0.05);
    let away = moved(PICK_BASE, PICK_GRASP, out);
    let problem = problem("simple-plate", PICK_BASE, away, plate, plate);
    let mut b = Builder::new(&problem, away, OPEN);
    b.begin(&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Some(PLATE)).line(-out);
    b.begin(&PrimitiveName::PICK, Some(PLATE)).attach().touching(ContactReason::Grasp);
    b.lifting_from(TABLE).hand(CLOSED).line(lift);
    let lifted = b.body.arms[0];
    b.begin(&PrimitiveName::BASE_RIGID_TRANSFER, None).touching(ContactReason::Grasp).drive([-0.66, -1.5, 2.3]);
    b.begin(&PrimitiveName::ARM_RIGID_TRANSFER, Some(PLATE)).touching(ContactReason::Grasp);
    let mut there = lifted;
    there[0] -= 0.1;
    aside(&mut there);
    b.arm_to(there).arm_to(lifted);
    b.begin(&PrimitiveName::BASE_RIGID_TRANSFER, None).touching(ContactReason::Grasp).drive(PICK_BASE);
    b.begin(&PrimitiveName::PLACE, Some(PLATE)).touching(ContactReason::Grasp);
    b.lifting_from(TABLE).line(-lift).hand(OPEN).detach();
    b.begin(&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Some(PLATE)).touching(ContactReason::Retreat).line(out);
    b.plan(&problem)
}

/// Simple Plate with nothing to do: the base drives backwards, then to its left.
pub(crate) fn around() -> PlanFile {
    let mut problem = builtin("simple-plate").unwrap();
    let side = ArmPosture::Side.values(Side::Right);
    let plate = problem.objects[0].at;
    problem.goal = Goal { objects: vec![goal_on_table(plate)], robot: None };
    let mut b = Builder::new(&problem, side, 0.08);
    b.begin(&PrimitiveName::BASE_TRANSIT, None).drive([-2.4, 0.0, 0.0]).drive([-2.4, 1.6, 0.0]);
    b.plan(&problem)
}

/// Simple Plate with nothing to do: the arm waves and the base drives, two waypoints each.
pub(crate) fn wave() -> PlanFile {
    let mut problem = builtin("simple-plate").unwrap();
    let side = ArmPosture::Side.values(Side::Right);
    let plate = problem.objects[0].at;
    problem.goal = Goal { objects: vec![goal_on_table(plate)], robot: None };
    let mut b = Builder::new(&problem, side, 0.08);
    let mut high = side;
    high[0] += 1.2;
    b.begin(&PrimitiveName::BASE_TRANSIT, None).hand(0.03).drive([-1.8, 0.0, 0.0]);
    b.begin(&PrimitiveName::ARM_TRANSIT, None).arm_to(high);
    b.plan(&problem)
}

/// A grasp to lift an object by and to set it down again.
pub(crate) struct Lift {
    /// An embedded problem, the body that carries its object, and where the object starts.
    pub(crate) problem: &'static str,
    pub(crate) carrier: &'static str,
    pub(crate) at: [f64; 2],
    /// Base and right arm at the grasp.
    pub(crate) base: [f64; 3],
    pub(crate) grasp: ArmConfiguration,
    /// Gaps of the open and of the closed hand.
    pub(crate) gaps: [f64; 2],
    /// Whether the open fingers touch the solid that stands for the object.
    pub(crate) straddles: bool,
}

/// In along the hand, close, up 2 cm, down, open, out along the hand.
pub(crate) fn lift(lift: &Lift) -> PlanFile {
    let tool = ArmChain::new(Side::Right, 0.2).world_from_tool(&lift.base, &lift.grasp);
    let out = tool.rotation * Vector3::new(-0.1, 0.0, 0.0);
    let up = Vector3::new(0.0, 0.0, 0.02);
    let [open, closed] = lift.gaps;
    let away = moved(lift.base, lift.grasp, out);
    let mut problem = problem(lift.problem, lift.base, away, lift.at, lift.at);
    let (name, on) = (problem.objects[0].name.clone(), problem.objects[0].on.clone());
    (problem.goal.objects[0].object, problem.goal.objects[0].on) = (name.clone(), Some(on));
    let mut b = Builder::new(&problem, away, open);
    b.begin(&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Some(&name));
    if lift.straddles {
        b.touching(ContactReason::Grasp);
    }
    b.line(-out).begin(&PrimitiveName::PICK, Some(&name)).attach().touching(ContactReason::Grasp);
    b.lifting_from(lift.carrier).hand(closed).line(up);
    b.begin(&PrimitiveName::PLACE, Some(&name)).touching(ContactReason::Grasp).lifting_from(lift.carrier);
    b.line(-up).hand(open).detach();
    b.begin(&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Some(&name)).touching(ContactReason::Retreat).line(out);
    b.plan(&problem)
}

/// Where the plate is in the tilted lifts.
const TILTED_PLATE: [f64; 2] = [-0.2, -0.53];

/// A plate by its rim with the hand tilted by 30 and by 45 degrees, which does not hold.
pub(crate) const TILTED: [Lift; 2] = [
    Lift {
        problem: "simple-plate",
        carrier: TABLE,
        at: TILTED_PLATE,
        base: [-0.9, -0.39, 1.08],
        grasp: [-1.291_075, -0.265_656, -3.7, -1.409_072, 1.274_59, -1.699_329, -1.308_411],
        gaps: [0.05, 0.02],
        straddles: false,
    },
    Lift {
        problem: "simple-plate",
        carrier: TABLE,
        at: TILTED_PLATE,
        base: [-0.03, -1.54, 2.01],
        grasp: [0.049_088, 0.274_588, 0.2, -0.295_963, 2.558_943, -0.887_428, 2.138_716],
        gaps: [0.075, 0.02],
        straddles: false,
    },
];

/// The worked pick of a bowl by its wall, from above.
pub(crate) const OVERHEAD: Lift = Lift {
    problem: "bowl",
    carrier: "shelf",
    at: [-1.2, 2.29],
    base: [-1.299_591, 1.625_02, 1.849_774],
    grasp: [-0.469_971, 0.106_428, -1.137_863, -0.919_746, -1.928_431, -1.841_546, 2.236_706],
    gaps: [0.05, 0.005],
    straddles: true,
};
