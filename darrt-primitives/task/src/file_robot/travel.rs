//! How far points of the robot travel per unit of each joint.

use darrt_geom::Body;
use darrt_primitives::kinematics::JointLimit;
use nalgebra::{Isometry3, Point3};

use super::chain::{ArmChain, Driver, Joint, Place};

/// Bounds for one link, or for what the hand holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Levers {
    /// Metres per unit of each joint of the arm.
    pub(super) arm: Vec<f64>,
    /// Metres from the vertical axis of the base.
    pub(super) base: f64,
}

/// Balls that contain a body, in the frame of its link: centre and radius, metres.
pub(super) fn balls(body: &Body) -> Vec<(Point3<f64>, f64)> {
    let parts = body.parts.iter().map(|part| {
        let (centre, radius) = part.shape.bounding_sphere();
        (part.body_from_shape * centre, radius)
    });
    parts.collect()
}

impl Levers {
    /// Of the points within `balls` (link frame) of what is at `place`.
    pub(super) fn new(
        chain: &ArmChain,
        limits: &[JointLimit],
        place: &Place,
        finger: JointLimit,
        balls: &[(Point3<f64>, f64)],
    ) -> Self {
        let mut arm = vec![0.0_f64; chain.joints.len()];
        let reach = |at: &Isometry3<f64>| {
            balls.iter().map(|(centre, radius)| (at * centre).coords.norm() + radius).fold(0.0, f64::max)
        };
        // From the link inwards: how far its points are from the origin of the next frame.
        let mut norm = reach(&place.offset);
        for step in place.steps.iter().rev() {
            let limit = match step.driver {
                Driver::Arm(index) => limits.get(index).copied().unwrap_or(JointLimit::UNLIMITED),
                Driver::Finger | Driver::Rests(_) => finger,
            };
            if let Driver::Arm(index) = step.driver
                && let Some(slot) = arm.get_mut(index)
            {
                *slot += step.multiplier.abs() * if step.joint.slides { 1.0 } else { norm };
            }
            let at = |value: f64| (step.multiplier * value + step.offset).abs();
            norm += slide(&step.joint, at(limit.lower).max(at(limit.upper)));
            norm += step.joint.before.translation.vector.norm();
        }
        // About the joint that carries it the points of a link that no further joint moves are known more nearly.
        let mut about = place.steps.is_empty().then(|| {
            let axis = chain.joints.get(place.anchor.wrapping_sub(1)).map(|joint| joint.axis);
            axis.map_or(f64::INFINITY, |axis| {
                let from_axis = balls.iter().map(|(centre, radius)| {
                    let at = (place.offset * centre).coords;
                    (at - axis.into_inner() * at.dot(&axis)).norm() + radius
                });
                from_axis.fold(0.0, f64::max)
            })
        });
        for index in (0..place.anchor.min(chain.joints.len())).rev() {
            let Some(joint) = chain.joints.get(index) else { continue };
            let radius = about.take().unwrap_or(f64::INFINITY).min(norm);
            if let Some(slot) = arm.get_mut(index) {
                *slot += if joint.slides { 1.0 } else { radius };
            }
            let limit = limits.get(index).copied().unwrap_or(JointLimit::UNLIMITED);
            let slide_m = slide(joint, limit.lower.abs().max(limit.upper.abs()));
            let beyond = norm + slide_m;
            norm = beyond + joint.before.translation.vector.norm();
            about = index.checked_sub(1).and_then(|inner| chain.joints.get(inner)).map(|inner| {
                let at = joint.before.translation.vector;
                beyond + (at - inner.axis.into_inner() * at.dot(&inner.axis)).norm()
            });
        }
        let base = if place.anchor == 0 && place.steps.is_empty() {
            let from_axis = balls.iter().map(|(centre, radius)| (place.offset * centre).coords.xy().norm() + radius);
            from_axis.fold(0.0, f64::max)
        } else {
            norm
        };
        Self { arm, base }
    }

    /// Metres, for these ways of the joints, of the base and of its heading; what is held reaches so much farther.
    pub(super) fn travel_m(&self, joints: &[f64], [shift, turn]: [f64; 2], farther_m: f64) -> f64 {
        let arm: f64 = joints.iter().zip(&self.arm).map(|(way, lever)| way.abs() * (lever + farther_m)).sum();
        arm + shift + turn * (self.base + farther_m)
    }
}

fn slide(joint: &Joint, most: f64) -> f64 {
    if joint.slides { most } else { 0.0 }
}
