//! What the hand is at needs time: slow where it is near an object, gentle with what it pushes or carries, and waits around
//! grasps and contacts.

use darrt_primitives::contract::{HandUse, HandWay};
use nalgebra::{Isometry3, Vector3};

use super::Timed;
use super::curve::Curve;
use crate::clock::limits::{
    GRAVITY_M_S2, HELD_SHARE, LEAN_SHARE, MotionLimits, coasting_speed, quasi_static_acceleration,
};
use crate::plan_file::PlanFile;
use crate::plan_file::timing::Phase;
use crate::verify::refusal::{Refusal, RefusalKind};
use crate::verify::robot::world_from_robot;

/// Seconds between two looks at the hand.
const LOOK_S: f64 = 0.02;
/// Most looks at one phase.
const MOST_LOOKS: f64 = 20_000.0;
/// How far a bound of the hand may be exceeded, as a part of it: the hand goes curves that are looked at only here and there.
const SLACK: f64 = 0.05;
/// What rounding may take from a wait, seconds.
const WAIT_SLACK_S: f64 = 1e-9;

pub(super) fn check(timed: &Timed<'_>, plan: &PlanFile, limits: &MotionLimits) -> Result<(), Refusal> {
    let robot = timed.robot;
    check_waits(timed, limits)?;
    let contract = timed.site.contract;
    let object = |name: &Option<String>| {
        let name = name.as_ref()?;
        plan.problem.objects.iter().find(|object| object.name == *name)
    };
    let (mut speed, mut push) = (f64::INFINITY, f64::INFINITY);
    if contract.way != HandWay::Free {
        speed = limits.at_object_m_per_s;
    }
    if let Some(pushed) = object(&timed.step.pushes) {
        check_every_knot(timed)?;
        speed = speed.min(coasting_speed(pushed.friction.table));
        push = quasi_static_acceleration(pushed.friction.table);
    }
    let held = timed.step.holds.as_ref();
    if let Some(held) = held.and_then(|hold| plan.problem.objects.iter().find(|object| object.name == hold.object)) {
        // Pushed sideways by a it feels as if it leant by atan(a / g).
        let lean = (LEAN_SHARE * held.max_tilt_deg()).to_radians();
        let sideways = if lean < std::f64::consts::FRAC_PI_2 { GRAVITY_M_S2 * lean.tan() } else { f64::INFINITY };
        push = push.min(sideways).min(HELD_SHARE * GRAVITY_M_S2);
    }
    if speed == f64::INFINITY && push == f64::INFINITY {
        return Ok(());
    }
    let tool_from_held = held.map_or_else(Isometry3::identity, |hold| hold.tool_from_object.into());
    let mut links = vec![Isometry3::identity(); robot.tree.link_count()];
    let mut begin_s = 0.0;
    for phase in timed.phases {
        let curve = Curve::new(phase, &timed.points);
        robot.link_poses(curve.at(0.0).get(3..).unwrap_or_default(), &mut links);
        let mut place = |t_s: f64| -> Vector3<f64> {
            let point = curve.when(t_s);
            let base = [0, 1, 2].map(|i| point.get(i).copied().unwrap_or(0.0));
            robot.arm_link_poses(point.get(3..).unwrap_or_default(), &mut links);
            let tool = links.get(robot.tool).copied().unwrap_or_default();
            (world_from_robot(&base) * tool * tool_from_held).translation.vector
        };
        let count = (phase.moving_s() / LOOK_S).ceil().clamp(4.0, MOST_LOOKS);
        let look_s = phase.moving_s() / count;
        let (mut before, mut here) = (place(0.0), place(look_s));
        let mut i = 2.0;
        while i <= count && look_s > 0.0 {
            let next = place(i * look_s);
            let t_s = begin_s + phase.wait_s + (i - 1.0) * look_s;
            let found = (next - here).norm() / look_s;
            let words = |what: &str, found: f64, bound: f64, unit: &str| {
                format!("the hand {what} {found:.4} {unit} at {t_s:.3} s of the step, at most {bound:.4} is allowed")
            };
            if found > speed * (1.0 + SLACK) {
                return Err(timed.refusal(t_s, RefusalKind::Pace, words("moves at", found, speed, "m/s")));
            }
            let found = (next - here * 2.0 + before).norm() / (look_s * look_s);
            if found > push * (1.0 + SLACK) {
                return Err(timed.refusal(t_s, RefusalKind::Pace, words("accelerates by", found, push, "m/s^2")));
            }
            (before, here) = (here, next);
            i += 1.0;
        }
        begin_s += phase.duration_s();
    }
    Ok(())
}

/// What slides keeps pace with the hand from waypoint to waypoint, so none may be left out.
fn check_every_knot(timed: &Timed<'_>) -> Result<(), Refusal> {
    let is_moved = |a: usize, b: usize| match (timed.step.waypoints.get(a), timed.step.waypoints.get(b)) {
        (Some(a), Some(b)) => a.objects != b.objects,
        _ => false,
    };
    for phase in timed.phases {
        for pair in phase.knots.windows(2) {
            let [from, to] = pair else { continue };
            if to - from > 1 && is_moved(*from, *to) {
                let text =
                    format!("the clock leaves out waypoints between {from} and {to}, but something is pushed there");
                return Err(timed.refusal(0.0, RefusalKind::Clock, text));
            }
        }
    }
    Ok(())
}

/// The robot stands around grasps and contacts as long as it must.
fn check_waits(timed: &Timed<'_>, limits: &MotionLimits) -> Result<(), Refusal> {
    let finger = 3 + timed.robot.finger_joint;
    let ends = |phase: &Phase, coordinate: usize| {
        let value = |knot: Option<&usize>| timed.points.get(*knot?)?.get(coordinate).copied();
        [value(phase.knots.first()), value(phase.knots.last())]
    };
    let is_fingers = |phase: &Phase| {
        let [a, b] = ends(phase, finger);
        a != b
    };
    let mut begin_s = 0.0;
    let contract = timed.site.contract;
    let first_move = timed.phases.iter().position(|phase| !is_fingers(phase));
    let last_move = timed.phases.iter().rposition(|phase| !is_fingers(phase));
    for (index, phase) in timed.phases.iter().enumerate() {
        let (mut before_s, mut after_s) = (0.0_f64, 0.0_f64);
        match contract.hand {
            HandUse::Takes if is_fingers(phase) => after_s = limits.grasp_s,
            HandUse::LetsGo if is_fingers(phase) => (before_s, after_s) = (limits.release_s, limits.release_s),
            _ => {}
        }
        if contract.slides() && Some(index) == first_move {
            before_s = limits.contact_s;
        }
        if contract.slides() && Some(index) == last_move {
            after_s = limits.contact_s;
        }
        for (when, found, wanted) in [("before", phase.wait_s, before_s), ("after", phase.rest_s, after_s)] {
            if found < wanted - WAIT_SLACK_S {
                let what = if is_fingers(phase) { "the fingers move" } else { "the object is pushed" };
                let text = format!("the robot stands {found} s {when} {what}, at least {wanted} s are wanted");
                return Err(timed.refusal(begin_s, RefusalKind::Wait, text));
            }
        }
        begin_s += phase.duration_s();
    }
    Ok(())
}
