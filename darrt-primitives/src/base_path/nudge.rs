//! Pushes a pose of the base that collides into the free space beside it, if that is near.
//!
//! A lattice never has a point in a door barely wider than the robot. A point beside the middle of the door is pushed there:
//! the least squares of what every near pair lacks to the wanted clearance, which in a passage too narrow for that is its
//! middle.
//!
//! # Source
//! Wilmarth, Amato and Stiller, MAPRM: a probabilistic roadmap planner with sampling on the medial axis of the free space, ICRA
//! 1999 (samples are moved to the middle of a passage); Levenberg, A method for the solution of certain non-linear problems in
//! least squares, 1944.

use darrt_core::space::so2::wrap;
use nalgebra::{Matrix3, Vector3};

use super::footprint::{Footprint, Near};

/// Steps that are tried.
const STEPS: usize = 5;
/// Damping of the least squares: keeps a pose where it is as long as nothing pushes it.
const DAMPING: f64 = 1e-3;
/// Cosine between two directions from which they count as opposed.
const OPPOSED: f64 = -0.3;

/// A passage in whose direction less than this share is driving is none.
const LENGTHWISE: f64 = 0.7;

/// How far a pose may be pushed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    /// In each direction, metres.
    pub(super) shift_m: f64,
    /// To each side, radians.
    pub(super) turn_rad: f64,
}

/// Pushes poses; keeps its lists.
#[derive(Debug, Clone, Default)]
pub(super) struct Nudge {
    near: Vec<Near>,
}

impl Nudge {
    /// A pose between two obstacles, not farther from `q` than `room`, and its distance from them, which is not exact where
    /// it is less than `least_m`. `wanted_m` is what it is pushed to, where there is room. `None` if `q` is beside a
    /// single obstacle: there one that is clear is a step away.
    pub(super) fn between(
        &mut self,
        footprint: &mut Footprint,
        q: &[f64; 3],
        room: Room,
        (least_m, wanted_m): (f64, f64),
    ) -> Option<([f64; 3], f64)> {
        // Those that are far enough now matter once the pose has been pushed.
        footprint.near(q, wanted_m + room.shift_m, &mut self.near);
        if self.worst_m() < -room.shift_m || !self.is_between() {
            return None;
        }
        let at = self.pushed(footprint, q, room, wanted_m)?;
        let distance_m = footprint.distance_m(&at, wanted_m, least_m);
        Some((at, distance_m))
    }

    /// The direction of the passage in which `q` lies with something nearer than `wanted_m` on two sides: how x, y and yaw
    /// change by metre, in either sense. `None` if it lies in none.
    pub(super) fn along(&mut self, footprint: &mut Footprint, q: &[f64; 3], wanted_m: f64) -> Option<Vector3<f64>> {
        footprint.near(q, wanted_m, &mut self.near);
        if !self.is_between() {
            return None;
        }
        let reach_m = footprint.reach_m().max(f64::MIN_POSITIVE);
        let normal = self.near.iter().fold(Matrix3::zeros(), |sum, near| {
            let row = near.row(reach_m);
            sum + row * row.transpose()
        });
        // Along it no distance changes.
        let eigen = normal.symmetric_eigen();
        let along = eigen.eigenvectors.column(eigen.eigenvalues.imin());
        let shift = along.xy().norm();
        (shift > LENGTHWISE).then(|| Vector3::new(along.x, along.y, along.z / reach_m) / shift)
    }

    /// `q` pushed towards a distance of `wanted_m` from everything, not farther away than `room`.
    pub(super) fn pushed(
        &mut self,
        footprint: &mut Footprint,
        q: &[f64; 3],
        room: Room,
        wanted_m: f64,
    ) -> Option<[f64; 3]> {
        let mut here = *q;
        for _ in 0..STEPS {
            footprint.near(&here, wanted_m + room.shift_m, &mut self.near);
            if self.worst_m() >= wanted_m {
                break;
            }
            let reach_m = footprint.reach_m().max(f64::MIN_POSITIVE);
            let push = self.push(wanted_m, reach_m)?;
            let shifted = |i: usize, most: f64| (here[i] + push[i]).clamp(q[i] - most, q[i] + most);
            let turn = wrap(here[2] + push.z / reach_m - q[2]).clamp(-room.turn_rad, room.turn_rad);
            here = [shifted(0, room.shift_m), shifted(1, room.shift_m), wrap(q[2] + turn)];
        }
        Some(here)
    }

    /// The least distance, metres.
    fn worst_m(&self) -> f64 {
        self.near.iter().map(|near| near.distance_m).fold(f64::INFINITY, f64::min)
    }

    /// Is something on two sides?
    fn is_between(&self) -> bool {
        let pushes = |near: &Near| near.slope.xy();
        self.near.iter().any(|a| self.near.iter().any(|b| pushes(a).dot(&pushes(b)) < OPPOSED))
    }

    /// The least squares of what the near pairs lack to `wanted_m`; the yaw counts as `reach_m` metres per radian.
    fn push(&self, wanted_m: f64, reach_m: f64) -> Option<Vector3<f64>> {
        let mut normal = Matrix3::identity() * DAMPING;
        let mut right = Vector3::zeros();
        for near in &self.near {
            let lack = wanted_m - near.distance_m;
            if lack > 0.0 {
                let row = near.row(reach_m);
                normal += row * row.transpose();
                right += row * lack;
            }
        }
        normal.cholesky().map(|factors| factors.solve(&right))
    }
}
