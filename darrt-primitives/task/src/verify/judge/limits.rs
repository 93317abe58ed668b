//! Joint limits, and the bounds of base and objects.

use nalgebra::{Isometry3, Vector3};

use super::Judge;
use crate::verify::motion::State;
use crate::verify::refusal::RefusalKind;

/// What rounding may do to the angle between two unit vectors, radians.
const TILT_ROUNDING: f64 = 1e-6;

impl Judge<'_> {
    /// Joint limits of a waypoint, bounds of base and objects.
    pub(super) fn check_limits(&self, state: &State) -> Result<(), (RefusalKind, String)> {
        let slack = self.options.rounding;
        for (i, (value, limit)) in state.joints.iter().zip(&self.robot.limits).enumerate() {
            if *value < limit.lower - slack || *value > limit.upper + slack {
                let (name, low, high) = (self.robot.joint_name(i), limit.lower, limit.upper);
                return Err((RefusalKind::Joints, format!("`{name}` is {value}, its limits are [{low}, {high}]")));
            }
        }
        let bounds = &self.plan.problem.bounds;
        for (axis, value, [low, high]) in [("x", state.base[0], bounds.base_x), ("y", state.base[1], bounds.base_y)] {
            if value < low - slack || value > high + slack {
                return Err((
                    RefusalKind::Bounds,
                    format!("the base's {axis} is {value}, its bounds are [{low}, {high}]"),
                ));
            }
        }
        (0..state.objects.len())
            .try_for_each(|object| self.check_object_bounds(object, state))
            .map_err(|text| (RefusalKind::Bounds, text))
    }

    /// How far an object at `pose` is from leaving the bounds of objects, metres; negative outside.
    pub(super) fn inside_object_bounds(&self, pose: &Isometry3<f64>) -> f64 {
        let bounds = &self.plan.problem.bounds;
        let ranges = [bounds.object_x, bounds.object_y, bounds.object_z];
        let insides =
            ranges.iter().zip(pose.translation.vector.iter()).map(|([low, high], at)| (at - low).min(high - at));
        insides.fold(f64::INFINITY, f64::min)
    }

    /// How much farther a held object at `pose` may lean, radians; negative beyond its limit.
    pub(super) fn tilt_left(&self, object: usize, pose: &Isometry3<f64>) -> f64 {
        let limit = self.world.movables.get(object).map_or(180.0, |movable| movable.spec.max_tilt_deg()).to_radians();
        if limit >= std::f64::consts::PI {
            return f64::INFINITY;
        }
        limit + self.options.rounding.max(TILT_ROUNDING) - (pose.rotation * Vector3::z()).angle(&Vector3::z())
    }

    /// What is held leans no farther than it may.
    pub(super) fn check_tilt(&self, object: usize, state: &State) -> Result<(), String> {
        let Some(pose) = state.objects.get(object) else { return Ok(()) };
        let left = self.tilt_left(object, pose);
        if left >= 0.0 {
            return Ok(());
        }
        let (name, angle) = (self.world.object_name(object), (pose.rotation * Vector3::z()).angle(&Vector3::z()));
        let bound = self.world.movables.get(object).map_or(180.0, |movable| movable.spec.max_tilt_deg());
        Err(format!("{name} leans {:.2} degrees while it is carried, at most {bound} are allowed", angle.to_degrees()))
    }

    pub(super) fn check_object_bounds(&self, object: usize, state: &State) -> Result<(), String> {
        let Some(pose) = state.objects.get(object) else { return Ok(()) };
        let (bounds, slack) = (&self.plan.problem.bounds, self.options.rounding);
        let ranges = [("x", bounds.object_x), ("y", bounds.object_y), ("z", bounds.object_z)];
        for ((axis, [low, high]), value) in ranges.into_iter().zip(pose.translation.vector.iter()) {
            if *value < low - slack || *value > high + slack {
                let name = self.world.object_name(object);
                return Err(format!("the {axis} of {name} is {value}, its bounds are [{low}, {high}]"));
            }
        }
        Ok(())
    }
}
