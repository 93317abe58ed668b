//! What looks alike from all sides is held and set down from the side from which the arm reaches it.
//!
//! An arm of fewer joints than six comes to a place with some headings of the hand only. A heading that is drawn is none of them.

use darrt_core::domain::Domain;
use darrt_core::state::ObjectId;
use nalgebra::{Isometry3, Point2, UnitQuaternion, Vector3};
use rand::Rng;

use crate::manipulator::Manipulator;
use crate::tabletop::Tabletop;

/// An object whose axis leans by more from the vertical is not turned about it, radians.
const UPRIGHT_RAD: f64 = 1e-6;

/// Where a round object stands upright, turned about its axis as the robot, its base at `base`, wants it to bring this hand to
/// `object_from_tool` on it; all else as it is.
pub fn turned<M: Manipulator>(
    m: &Tabletop<M>,
    (object, hand): (ObjectId, usize),
    base: &[f64; 3],
    world_from_object: &Isometry3<f64>,
    object_from_tool: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Isometry3<f64> {
    let is_round = m.objects().get(object.index()).is_some_and(crate::object_space::ObjectSpace::is_round);
    let is_upright = (world_from_object.rotation * Vector3::z()).xy().norm() <= UPRIGHT_RAD;
    if !(is_round && is_upright) {
        return *world_from_object;
    }
    let centre = Point2::from(world_from_object.translation.vector.xy());
    let turn = m.manipulator().turn_to_reach_with(hand, base, &(world_from_object * object_from_tool), &centre, rng);
    turn.map_or(*world_from_object, |turn| turned_about(world_from_object, &centre, turn))
}

/// `pose` turned by `angle` (rad) about the vertical through `centre`.
pub fn turned_about(pose: &Isometry3<f64>, centre: &Point2<f64>, angle: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
    let middle = Vector3::new(centre.x, centre.y, 0.0);
    let at = middle + turn * (pose.translation.vector - middle);
    Isometry3::from_parts(at.into(), turn * pose.rotation)
}
