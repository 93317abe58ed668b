//! Objects in the hand, from the grasp to letting go.

use darrt_core::laws::{Broken, at_most, ensure};
use darrt_core::state::ObjectId;
use nalgebra::{Isometry3, Point2, Vector3};

use super::{ATTACH, HELD_RIGID, PICK_YAW, RELEASE, Trial};
use crate::laws::manipulator::same_pose;
use crate::manipulator::Manipulator;
use crate::mode::SurfaceId;
use crate::tabletop::TabletopState;

/// Rounding that is forgiven in the pose of a held object, metres and radians.
const RIGID: f64 = 1e-9;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn held(&self) -> Result<(), Broken> {
        let Some(held) = self.during.mode.held() else { return Ok(()) };
        let of = |broken: Broken| broken.of(self.name(held.object));
        let all = self.looks.iter().map(|look| (look.t, &look.state)).chain([(1.0, &self.end)]);
        for (t, state) in all {
            let grasp = self.tool(state).inverse() * pose_of(state, held.object);
            same_pose(HELD_RIGID, &grasp, &held.tool_from_object, RIGID).map_err(|broken| of(broken).at(t))?;
        }
        if self.from.mode.held().is_none() {
            self.attached(held.object).map_err(of)?;
        }
        if let Some(surface) = self.end.mode.support_of(held.object) {
            self.released(held.object, surface).map_err(|broken| of(broken).at(1.0))?;
        }
        Ok(())
    }

    fn attached(&self, object: ObjectId) -> Result<(), Broken> {
        let before = pose_of(self.from, object);
        same_pose(ATTACH, &pose_of(&self.during, object), &before, RIGID).map_err(|broken| broken.at(0.0))?;
        self.touched(object, &self.during).map_err(|broken| broken.at(0.0))?;
        for look in &self.looks {
            let angle = pose_of(&look.state, object).rotation.angle_to(&before.rotation);
            at_most(PICK_YAW, angle, 0.0, self.tolerance(look)).map_err(|broken| broken.at(look.t))?;
        }
        let angle = pose_of(&self.end, object).rotation.angle_to(&before.rotation);
        at_most(PICK_YAW, angle, 0.0, self.claims.knot).map_err(|broken| broken.at(1.0))
    }

    fn released(&self, object: ObjectId, surface: SurfaceId) -> Result<(), Broken> {
        let pose = pose_of(&self.end, object);
        let (Some(surface), Some(movable)) = (self.m.surface(surface), self.m.movable(object)) else {
            return Err(Broken::new(RELEASE, format!("{surface:?}"), "a surface and an object of the domain"));
        };
        let tilt = (pose.rotation * Vector3::z()).angle(&Vector3::z());
        // The angle of two vectors is only exact to the root of a rounding error.
        at_most(RELEASE, tilt, 0.0, self.claims.knot.max(1e-6)).map_err(|broken| broken.of("tilt"))?;
        let height = pose.translation.z - movable.half_height_m - surface.height();
        at_most(RELEASE, height.abs(), 0.0, self.claims.knot)
            .map_err(|broken| broken.of("height above the surface"))?;
        let at = Point2::new(pose.translation.x, pose.translation.y);
        ensure(RELEASE, surface.contains(&at), || format!("{:?}", at.coords.as_slice()), "a place over the surface")
    }
}

fn pose_of<M: Manipulator>(state: &TabletopState<M>, object: ObjectId) -> Isometry3<f64> {
    state.object(object).copied().unwrap_or_default()
}
