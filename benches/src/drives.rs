//! The drives of a plan against the shortest ways that there are.

use std::f64::consts::PI;

use darrt_core::space::so2::turn;
use darrt_core::state::{ObjectId, State};
use darrt_pr2::arm::{ArmConfiguration, JOINT_NAMES, Side};
use darrt_pr2::gripper;
use darrt_pr2::{World, WorldState};
use darrt_primitives::manipulator::Configuration;
use darrt_primitives::mode::{Held, Mode, SurfaceId};
use darrt_primitives::testing::yardstick::Yardstick;
use darrt_task::plan_file::{PlanFile, Step, Waypoint};
use darrt_task::problem_file::ArmSide;
use darrt_task::world::{Built, build};
use nalgebra::Isometry3;

/// A step in which the base drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Its place in the plan, from 1.
    pub step: usize,
    /// Metres driven.
    pub length_m: f64,
    /// Degrees turned.
    pub turn_deg: f64,
    /// From one end to the other, metres.
    pub straight_m: f64,
    /// The shortest way found between the ends, metres.
    pub shortest_m: f64,
}

impl Drive {
    /// How many times the shortest way; 1 for one that goes straight, or goes nowhere.
    pub fn ratio(&self) -> f64 {
        if self.shortest_m > 0.0 { self.length_m / self.shortest_m } else { 1.0 }
    }
}

/// How near a resting object must be to a surface to stand on it, metres.
const SLACK_M: f64 = 0.01;
/// Longer by no more than this is not longer, metres.
const ROUNDING_M: f64 = 1e-6;

/// The drives of a plan, in order.
///
/// # Errors
/// In words, if the problem of the plan cannot be built or a waypoint lacks a joint or an object.
pub fn drives(plan: &PlanFile, yardstick: &Yardstick) -> Result<Vec<Drive>, String> {
    let Built { world, .. } = build(&darrt_pr2::registry(), &plan.problem).map_err(|error| error.to_string())?;
    let side = match plan.problem.robot.arm {
        ArmSide::Right => Side::Right,
        ArmSide::Left => Side::Left,
    };
    let mut drives = Vec::new();
    for (index, step) in plan.steps.iter().enumerate() {
        let bases: Vec<_> = step.waypoints.iter().map(|waypoint| waypoint.base).collect();
        let (Some(from), Some(to)) = (step.waypoints.last(), bases.last()) else { continue };
        let segments = bases.windows(2).map(|pair| (pair[0], pair[1]));
        let metres = |a: &[f64; 3], b: &[f64; 3]| (b[0] - a[0]).hypot(b[1] - a[1]);
        let length_m: f64 = segments.clone().map(|(a, b)| metres(&a, &b)).sum();
        let turn_deg = segments.map(|(a, b)| turn(a[2], b[2]).abs().to_degrees()).sum();
        if length_m == 0.0 && turn_deg == 0.0 {
            continue;
        }
        let straight_m = metres(&bases[0], to);
        let mut shortest_m = straight_m;
        if length_m > straight_m + ROUNDING_M {
            let mut state = state(&world, side, step, from)
                .ok_or_else(|| format!("step {}: a joint or an object is missing", index + 1))?;
            state.robot.base = bases[0];
            shortest_m = yardstick.shortest_m(&world, &state, to, length_m).unwrap_or(length_m);
        }
        drives.push(Drive { step: index + 1, length_m, turn_deg, straight_m, shortest_m });
    }
    Ok(drives)
}

/// Where everything stands at a waypoint of a step. `None` if a joint or an object is missing.
fn state(m: &World, side: Side, step: &Step, waypoint: &Waypoint) -> Option<WorldState> {
    let joint = |name: &str| waypoint.joints.get(format!("{}_{name}_joint", side.prefix()).as_str()).copied();
    let mut arm: ArmConfiguration = [0.0; 7];
    for (slot, name) in arm.iter_mut().zip(JOINT_NAMES) {
        *slot = joint(name)?;
    }
    let gap_m = gripper::gap(joint("gripper_l_finger")?);
    let pose = |name: &str| waypoint.objects.get(name).map(|pose| Isometry3::from(*pose));
    let objects: Vec<_> = m.movables().iter().map(|movable| pose(&movable.body.name)).collect::<Option<_>>()?;
    let under = |(index, pose): (usize, &Isometry3<f64>)| {
        m.surface_under(ObjectId::new(index), pose, SLACK_M).unwrap_or(SurfaceId::new(usize::MAX))
    };
    let mut mode = Mode::resting(objects.iter().enumerate().map(under), gap_m);
    if let Some(hold) = &step.holds {
        let object = m.movables().iter().position(|movable| *movable.body.name == *hold.object).map(ObjectId::new)?;
        mode =
            mode.attached(Held { object, tool_from_object: hold.tool_from_object.into(), max_tilt_rad: PI }, gap_m)?;
    }
    Some(State { robot: Configuration { base: waypoint.base, arm }, objects: objects.into_iter().collect(), mode })
}
