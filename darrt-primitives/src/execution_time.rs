//! Seconds that base and arm take to carry out a plan.
//!
//! Speeds of base and joints are the robot's ([`Manipulator::duration_s`]). The constants of this file are choices of an
//! operator, not measurements of a robot: they say what a step, a grip and an arm that sticks out are worth in seconds.

use darrt_core::cost::ExecutionCost;
use darrt_core::domain::Domain;
use darrt_core::motion::Instance;
use darrt_core::state::ComponentSet;

use crate::manipulator::{Configuration, Manipulator};
use crate::tabletop::{Tabletop, TabletopState};

/// Starting, stopping and coming to rest, seconds for every step.
const STEP_S: f64 = 1.0;
/// Closing the fingers on an object or letting it go, seconds.
const GRIP_S: f64 = 2.0;
/// Speed of the hand in straight lines at an object: approaching, pushing, lifting, setting down, retreating; metres per second.
/// Up to it pushes are quasi-static: a plate coasts less than 2 mm (speed squared over twice friction times gravity).
const AT_OBJECT_M_PER_S: f64 = 0.1;

/// How far from the middle of the base the hand may be while the robot drives at full speed, metres.
const FOLDED_M: f64 = 0.5;
/// By how many times its time a drive takes longer for every metre that the hand is farther out.
const OUT_PER_M: f64 = 2.0;

/// How many times as long a drive takes because the hand is far out, where it meets things and swings.
fn slowness<M: Manipulator>(robot: &M, a: &Configuration<M::Joints>, b: &Configuration<M::Joints>) -> f64 {
    if a.base == b.base {
        return 1.0;
    }
    let hand = robot.world_from_tool(a).translation.vector;
    let out_m = (hand.x - a.base[0]).hypot(hand.y - a.base[1]);
    1.0 + OUT_PER_M * (out_m - FOLDED_M).max(0.0)
}

/// Every segment of a motion takes what [`Manipulator::duration_s`] says.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ExecutionTime;

impl<M: Manipulator> ExecutionCost<Tabletop<M>> for ExecutionTime {
    fn step_s(&self) -> f64 {
        STEP_S
    }

    fn seconds(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>, until: f64) -> f64 {
        let robot = m.manipulator();
        let (mut here, mut next) = (from.clone(), from.clone());
        instance.motion.at_into(m, 0.0, &mut here);
        let held_before = m.carried(&here.mode);
        let is_free = instance.object.is_none() || (instance.reversible && held_before != ComponentSet::EMPTY);
        let mut seconds = STEP_S;
        let knots = instance.motion.knots().iter().copied().filter(|knot| *knot > 0.0 && *knot < until);
        for end in knots.chain([until]) {
            instance.motion.at_into(m, end, &mut next);
            let is_loaded = next.mode.held().is_some() || here.mode.held().is_some();
            let mut segment_s = robot.duration_s(&here.robot, &next.robot, is_loaded);
            segment_s *= slowness(robot, &here.robot, &next.robot);
            if !is_free {
                let [a, b] = [&here, &next].map(|state| robot.world_from_tool(&state.robot).translation.vector);
                segment_s = segment_s.max((b - a).norm() / AT_OBJECT_M_PER_S);
            }
            seconds += segment_s;
            std::mem::swap(&mut here, &mut next);
        }
        if m.carried(&here.mode) == held_before { seconds } else { seconds + GRIP_S }
    }

    fn between(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &TabletopState<M>) -> f64 {
        let (a, b) = (&from.robot, &to.robot);
        let steps = f64::from(u8::from(a.arm != b.arm) + u8::from(a.base != b.base));
        steps * STEP_S + m.manipulator().duration_s(a, b, from.mode.held().is_some())
    }
}
