//! What a grasp tells of itself against its pose.

use darrt_core::laws::{Broken, at_most};
use darrt_core::space::so2::turn;
use nalgebra::Vector3;

use super::KIND;
use crate::grasp::{Grasp, GraspKind};

/// How far an angle may be off, radians: it names the grasp to a person and to the verifier.
const SLACK_RAD: f64 = 0.05;
/// Where less than this of a direction is level it has no azimuth.
const LEVEL: f64 = 0.2;
/// How much a hand from the side may point up or down, and how much one from above must point down at least.
const SIDEWAYS: f64 = 0.5;
const LEANING: f64 = 0.4;
const DOWN: f64 = 0.87;

pub(super) fn check(grasp: &Grasp) -> Result<(), Broken> {
    let pose = &grasp.object_from_tool;
    let (pointing, opening) = (pose.rotation * Vector3::x(), pose.rotation * Vector3::y());
    let place = pose.translation.vector;
    let same = |name: &str, told: f64, direction: Vector3<f64>| {
        let found = direction.y.atan2(direction.x);
        let is_level = direction.xy().norm() >= LEVEL * direction.norm() && direction.norm() > 0.0;
        let off = if is_level { turn(found, told).abs() } else { 0.0 };
        at_most(KIND, off, SLACK_RAD, 0.0).map_err(|broken| broken.of(format_args!("{name}, radians off")))
    };
    // Which way the hand points.
    let down = -pointing.z;
    let from_above =
        |least: f64| at_most(KIND, least, down, 0.0).map_err(|broken| broken.of("a hand that does not point down"));
    match grasp.kind {
        GraspKind::Rim { azimuth, tilt, .. } => {
            same("azimuth", azimuth, -pointing)?;
            let found = (-pointing.z).clamp(-1.0, 1.0).asin();
            at_most(KIND, (found - tilt).abs(), SLACK_RAD, 0.0).map_err(|broken| broken.of("tilt, radians off"))
        }
        GraspKind::Side { azimuth, .. } => {
            at_most(KIND, pointing.z.abs(), SIDEWAYS, 0.0).map_err(|broken| broken.of("a hand that is not level"))?;
            same("azimuth", azimuth, -pointing)
        }
        GraspKind::Wall { azimuth, .. } => {
            from_above(LEANING)?;
            // A wall is off the middle: one finger inside of it.
            at_most(KIND, 0.5 * grasp.closed_gap_m, place.xy().norm(), 1e-9)
                .map_err(|broken| broken.of("a wall in the middle"))?;
            same("azimuth", azimuth, place)
        }
        // Either finger.
        GraspKind::Overhead { azimuth } => {
            from_above(DOWN)?;
            same("azimuth", azimuth, opening).or_else(|_| same("azimuth", azimuth, -opening))
        }
    }
}
