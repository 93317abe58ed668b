//! How far points of the robot travel per unit of each joint.

use darrt_geom::Body;
use darrt_primitives::kinematics::JointLimit;
use nalgebra::{Isometry3, Point3};

use super::chain::{ArmChain, Driver, Joint, Own, Place};

/// Bounds for one link, or for what the hand holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Levers {
    /// Metres per unit of each joint of the robot.
    pub(super) arm: Vec<f64>,
    /// Metres from the vertical axis of the base.
    pub(super) base: f64,
}

/// Points whose convex hull contains a body, in the frame of its link: corners of the boxes around its parts.
pub(super) fn corners(body: &Body) -> Vec<Point3<f64>> {
    let parts = body.parts.iter().flat_map(|part| {
        let (low, high) = part.shape.local_aabb();
        let corner = move |bits: usize| {
            let side = |axis: usize| if bits & (1 << axis) == 0 { low[axis] } else { high[axis] };
            part.body_from_shape * Point3::new(side(0), side(1), side(2))
        };
        (0..8).map(corner)
    });
    parts.collect()
}

/// An arm with what bounds the ways of all joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Carrier<'a> {
    pub(super) chain: &'a ArmChain,
    pub(super) own: Own,
    /// Of all joints of the robot.
    pub(super) limits: &'a [JointLimit],
    /// Of the joints that open the hands.
    pub(super) fingers: [JointLimit; 2],
}

impl Levers {
    /// Of what is at `place` of this arm and within these corners (link frame).
    pub(super) fn new(of: &Carrier<'_>, place: &Place, corners: &[Point3<f64>]) -> Self {
        let Carrier { chain, own, limits, fingers } = *of;
        let mut arm = vec![0.0_f64; limits.len()];
        let reach = |at: &Isometry3<f64>| corners.iter().map(|corner| (at * corner).coords.norm()).fold(0.0, f64::max);
        // From the link inwards: how far its points are from the origin of the next frame.
        let mut norm = reach(&place.offset);
        for step in place.steps.iter().rev() {
            let limit = match step.driver {
                Driver::Arm(index) => limits.get(index).copied().unwrap_or(JointLimit::UNLIMITED),
                Driver::Finger(hand) => fingers.get(hand).copied().unwrap_or(JointLimit::UNLIMITED),
                Driver::Rests(value) => JointLimit::new(value, value),
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
                let from_axis = corners.iter().map(|corner| {
                    let at = (place.offset * corner).coords;
                    (at - axis.into_inner() * at.dot(&axis)).norm()
                });
                from_axis.fold(0.0, f64::max)
            })
        });
        for index in (0..place.anchor.min(chain.joints.len())).rev() {
            let Some(joint) = chain.joints.get(index) else { continue };
            let radius = about.take().unwrap_or(f64::INFINITY).min(norm);
            if let Some(slot) = arm.get_mut(own.index(index)) {
                *slot += if joint.slides { 1.0 } else { radius };
            }
            let limit = limits.get(own.index(index)).copied().unwrap_or(JointLimit::UNLIMITED);
            let slide_m = slide(joint, limit.lower.abs().max(limit.upper.abs()));
            let beyond = norm + slide_m;
            norm = beyond + joint.before.translation.vector.norm();
            about = index.checked_sub(1).and_then(|inner| chain.joints.get(inner)).map(|inner| {
                let at = joint.before.translation.vector;
                beyond + (at - inner.axis.into_inner() * at.dot(&inner.axis)).norm()
            });
        }
        let base = if place.anchor == 0 && place.steps.is_empty() {
            let from_axis = corners.iter().map(|corner| (place.offset * corner).coords.xy().norm());
            from_axis.fold(0.0, f64::max)
        } else {
            norm
        };
        Self { arm, base }
    }

    /// The same of what the arm holds, with a lever for each joint of the arm alone.
    pub(super) fn of_arm(self, own: &Own) -> Self {
        Self { arm: own.indices().filter_map(|joint| self.arm.get(joint).copied()).collect(), ..self }
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
