//! The eight primitives.

use std::cell::Cell;

use darrt_core::laws::primitive::Excuse;
use darrt_core::laws::{MotionClaims, PrimitiveClaims, Tried, check_primitive, try_primitive};
use darrt_core::partial::PartialState;
use darrt_core::primitive::Primitive;
use darrt_core::state::ObjectId;
use darrt_core::testing::strategies::{config, looks, seen, tasks_from};
use darrt_pr2::primitives::ArmRigidTransfer;
use darrt_pr2::primitives::ArmTransit;
use darrt_pr2::primitives::BaseRigidTransfer;
use darrt_pr2::primitives::BaseTransit;
use darrt_pr2::primitives::Pick;
use darrt_pr2::primitives::Place;
use darrt_pr2::primitives::Push;
use darrt_pr2::primitives::StraightLineArmTransit;
use darrt_pr2::{World, WorldState};
use darrt_primitives::laws::{TabletopClaims, body_travel, check_finger_contacts, check_tabletop};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::mode::Held;
use darrt_primitives::testing::strategies::{any_mode, engaged, grasping, holding, resting};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::laws::support::{PROBLEMS, problem};

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_primitives.txt");

/// What a primitive starts from, most of the time.
#[derive(Clone, Copy)]
enum Starts {
    Resting,
    Holding,
    Engaged,
}

/// Along a line the arm takes steps of up to 0.3 rad per joint, straight in joint space: between two of them the hand may
/// turn by a few hundredths of a radian and leave the line by some millimetres.
const CLAIMS: TabletopClaims = TabletopClaims { knot: 1e-6, bow: 0.05, touch_m: 0.005, slack_m: 1e-7, looks: 16 };

/// All laws of one primitive from all kinds of states; it must succeed now and then, or nothing is shown.
fn check(primitive: &dyn Primitive<World>, starts: Starts, cases: u32, excuse: Option<Excuse<'_, World>>) {
    let succeeded = seen(3, || {
        let count = Cell::new(0);
        for name in PROBLEMS {
            let problem = problem(name);
            let m = problem.domain();
            let all = (0..5_u8, resting(m), holding(m), engaged(m), any_mode(m));
            let starts = all.prop_map(move |(kind, resting, holding, engaged, any)| match (kind, starts) {
                (4, _) => any,
                (_, Starts::Resting) => resting,
                (_, Starts::Holding) => holding,
                (_, Starts::Engaged) => engaged,
            });
            proptest!(config(cases, REGRESSIONS), |((from, to, seed) in tasks_from(m, starts), ts in looks())| {
                let motion = MotionClaims { travel: &body_travel, looks: 16, ..MotionClaims::default() };
                let claims = PrimitiveClaims { ts: &ts, motion, max_instances: 8, excuse, ..PrimitiveClaims::default() };
                if let Tried::Propagated(instances) = try_primitive(m, primitive, &from, &to, seed, &claims)? {
                    count.set(count.get() + 1);
                    check_tabletop(m, &instances, &from, &ts, &CLAIMS)?;
                    check_finger_contacts(m, problem.validity(), &instances, &from, &ts)?;
                }
            });
        }
        count.get()
    });
    assert!(succeeded >= 3, "{} succeeded {succeeded} times only", primitive.name());
}

#[test]
fn arm_transit() {
    check(&ArmTransit, Starts::Resting, 96, None);
}

#[test]
fn straight_line_arm_transit() {
    check(&StraightLineArmTransit, Starts::Engaged, 192, None);
}

#[test]
fn arm_rigid_transfer() {
    check(&ArmRigidTransfer, Starts::Holding, 64, None);
}

#[test]
fn base_transit() {
    check(&BaseTransit, Starts::Resting, 96, None);
}

#[test]
fn base_rigid_transfer() {
    check(&BaseRigidTransfer, Starts::Holding, 96, None);
}

/// Targets that the base alone can reach: what is held upright, moved in the plane and turned about the vertical.
#[test]
fn base_rigid_transfer_in_the_plane() {
    let succeeded = seen(3, || {
        let count = Cell::new(0);
        for name in PROBLEMS {
            let problem = problem(name);
            let m = problem.domain();
            // Round objects may be turned at will, and the base with them: in the middle of the room it stays in the room.
            let places = (-1.0..1.0, -1.0..1.0, -3.0..3.0_f64);
            proptest!(config(32, REGRESSIONS), |(from in grasping(m), (x, y, yaw) in places, seed in 0..1000_u64, ts in looks())| {
                let id = from.mode.held().unwrap().object;
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
                let pose = from.objects[id.index()];
                let target = Isometry3::from_parts(Translation3::new(x, y, pose.translation.z), turn * pose.rotation);
                let to = PartialState::anywhere(m).with_object(id, target);
                let motion = MotionClaims { travel: &body_travel, looks: 16, ..MotionClaims::default() };
                let claims = PrimitiveClaims { ts: &ts, motion, max_instances: 1, ..PrimitiveClaims::default() };
                if let Tried::Propagated(instances) = try_primitive(m, &BaseRigidTransfer, &from, &to, seed, &claims)? {
                    count.set(count.get() + 1);
                    check_tabletop(m, &instances, &from, &ts, &CLAIMS)?;
                    let end = instances[0].at(m, 1.0, &from);
                    prop_assert!(to.is_object_met(m, &end, id), "{:?} instead of {target:?}", end.objects);
                }
            });
        }
        count.get()
    });
    assert!(succeeded >= 3, "{succeeded}");
}

/// What is grasped is lifted, which may well be away from its target.
#[test]
fn pick() {
    let lifted: Excuse<'_, World> =
        &|_, from: &WorldState, _: &_, end: &WorldState| from.mode.held().is_none() && end.mode.held().is_some();
    check(&Pick, Starts::Resting, 96, Some(lifted));
}

/// What is already held where it should stand is let go there.
#[test]
fn place() {
    let let_go: Excuse<'_, World> = &|m, from: &WorldState, to: &PartialState<World>, end: &WorldState| {
        let was_met = from.mode.held().is_some_and(|held| to.is_object_met(m, from, held.object));
        was_met && end.mode.held().is_none() && to.are_objects_met(m, end)
    };
    check(&Place, Starts::Holding, 96, Some(let_go));
}

#[test]
fn push() {
    check(&Push, Starts::Resting, 96, None);
}

/// Found by the laws: Place wanted to set down what the target wants to be held where it is.
#[test]
fn place_is_not_useful_for_a_target_that_is_met() {
    let problem = problem("plate1");
    let m = problem.domain();
    let (plate, mut here) = (ObjectId::new(0), problem.start().clone());
    let tool = m.manipulator().world_from_tool(&here.robot);
    // In the hand, but still where it stood.
    let held = Held { object: plate, tool_from_object: tool.inverse() * here.objects[0], max_tilt_rad: 1.0 };
    here.mode = here.mode.attached(held, 0.02).unwrap();
    let to = PartialState::of_state(m, &here);
    assert!(!Place.useful(m, &here, &to));
    check_primitive(m, &Place, &here, &to, 0).unwrap_or_else(|broken| panic!("{broken}"));
}
