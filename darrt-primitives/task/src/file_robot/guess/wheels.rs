//! How a base moves, from the wheels that it stands on.

use darrt_geom::Body;
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use nalgebra::Isometry3;

use super::super::load;
use super::hand::is_rigid;

/// How far above the robot's lowest point the lowest point of a wheel that it stands on is at most, metres: springs and casters
/// differ by so much.
const STANDS_M: f64 = 0.02;
/// How far the axle of a wheel may be out of level: its vertical part.
const LEVEL: f64 = 0.05;

/// `differential` for a robot that stands on two wheels with one axle, or on one such pair and casters (wheels that swivel); else
/// `planar`. The joints `mine` are no wheels.
pub(super) fn base_kind(tree: &KinematicTree, bodies: &[Option<Body>], mine: &[String]) -> &'static str {
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    if tree.forward(&tree.neutral(), &Isometry3::identity(), &mut poses).is_err() {
        return "planar";
    }
    let lowest = |link: usize| Some(load::lowest_m(bodies.get(link)?.as_ref()?, poses.get(link)?));
    let floor_m = (0..tree.link_count()).filter_map(lowest).fold(f64::INFINITY, f64::min);
    // A wheel turns without end about a level axle, and no joint is above it.
    let axle = |link: usize| {
        let Some(LinkMotion::Turning { axis, drive }) = tree.motion(link) else { return None };
        let variable = tree.variables().get(drive.variable)?;
        if tree.parent(link).is_some_and(|parent| !is_rigid(tree, parent)) {
            return None;
        }
        let pose = poses.get(link)?;
        let axis = pose.rotation * axis.into_inner();
        let is_wheel = variable.limit.is_unlimited() && axis.z.abs() <= LEVEL && lowest(link)? <= floor_m + STANDS_M;
        (is_wheel && !mine.iter().any(|name| *variable.name == **name)).then_some((pose.translation.vector, axis))
    };
    let wheels: Vec<_> = (0..tree.link_count()).filter_map(axle).collect();
    match &wheels[..] {
        [(left, axis), (right, other)] => {
            let apart = left - right;
            // One behind the other they are a bicycle.
            let is_pair = axis.cross(other).norm() <= LEVEL && apart.cross(axis).norm() <= LEVEL * apart.norm();
            if is_pair { "differential" } else { "planar" }
        }
        _ => "planar",
    }
}
