//! Do the grid and what is drawn speak of the same grasps?

use darrt_core::laws::{Broken, ensure};
use nalgebra::{UnitQuaternion, Vector3};

use super::{COVERS, GRID};
use crate::grasp::Grasp;

/// How far apart two grasps may be turned and still be neighbours, radians.
const NEAR_RAD: f64 = std::f64::consts::FRAC_PI_3;
/// Grasps that are nearer to each other are the same, metres and radians.
const SAME: f64 = 1e-9;
/// Of what is drawn so many are looked at.
const MOST: usize = 128;

pub(super) fn check(grid: &[Grasp], drawn: &[Grasp]) -> Result<(), Broken> {
    for (i, a) in grid.iter().enumerate() {
        let is_again = |b: &&Grasp| {
            let (p, q) = (&a.object_from_tool, &b.object_from_tool);
            (p.translation.vector - q.translation.vector).norm() <= SAME
                && p.rotation.angle_to(&q.rotation) <= SAME
                && a.kind == b.kind
        };
        let again = grid.iter().skip(i + 1).find(is_again);
        ensure(GRID, again.is_none(), || format!("{:?} twice", a.kind), "each once")?;
    }
    for (these, those, what) in [(grid, drawn, "drawn is near"), (drawn, grid, "of the grid is near")] {
        for grasp in these.iter().take(MOST) {
            let is_near = those.iter().take(MOST).any(|other| apart(grasp, other) <= NEAR_RAD);
            ensure(COVERS, is_near, || format!("none {what} {:?}", grasp.kind), "one within 60 degrees")?;
        }
    }
    Ok(())
}

/// How far two grasps are turned against each other; the two fingers are alike.
fn apart(a: &Grasp, b: &Grasp) -> f64 {
    let exchanged = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let (p, q) = (a.object_from_tool.rotation, b.object_from_tool.rotation);
    p.angle_to(&q).min(p.angle_to(&(q * exchanged)))
}
