//! Bounds on how far any point of the robot travels when joints move.
//!
//! For each joint: an upper bound of the distance from its axis to the farthest point of anything it carries, over all
//! configurations. A motion that changes joint i by `d_i` then moves no point farther than the sum of
//! `|d_i| * radius_i`, whatever the order: the speed of a point is at most the sum of joint speeds times radii.

use darrt_geom::Body;
use nalgebra::{Isometry3, Point3, Vector3};

use super::Side;
use crate::forward::{FOREARM, Frame, SHOULDER_X, SHOULDER_Y, TOOL, UPPER_ARM, UPPER_ARM_OFFSET};
use crate::gripper::{self, MAX_FINGER_ANGLE};
use crate::model::{ArmBody, Pr2Model, WholeBody};

/// Finger angles at which the hand is measured.
const FINGER_SAMPLES: u32 = 64;
/// From the finger joint to the tip joint, rounded up, m; a tip does not turn, so all of it moves as its joint does.
const TIP_LEVER: f64 = 0.0916;

/// Radii of the joints of one arm and of the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravelBound {
    /// Per joint: largest distance from its axis to anything it carries, m.
    pub joint: [f64; 7],
    /// Largest distance from the vertical axis of the base to anything on the robot, for any configuration of this
    /// arm, m.
    pub base: f64,
}

impl TravelBound {
    /// Largest distance any point can travel on a motion that changes the joints by `joints` (rad), moves the base by
    /// `base_translation` (m) and turns it by `base_yaw` (rad).
    pub fn distance(&self, joints: &[f64; 7], base_translation: f64, base_yaw: f64) -> f64 {
        let arm: f64 = joints.iter().zip(&self.joint).map(|(d, radius)| d.abs() * radius).sum();
        arm + base_translation.abs() + base_yaw.abs() * self.base
    }
}

impl Pr2Model {
    /// Radii of the joints of one arm, m, open fingers included; `held_radius`: radius of a ball about the tool frame
    /// that holds everything the hand carries, m (0 for nothing).
    pub fn joint_radius(&self, side: Side, held_radius: f64) -> [f64; 7] {
        self.arm_extents(side).joint_radius(held_radius)
    }

    /// What [`joint_radius`](Self::joint_radius) is made of, for several things held.
    pub(crate) fn arm_extents(&self, side: Side) -> ArmExtents {
        ArmExtents {
            hand: self.hand_extent(side),
            elbow: self.extent(side, &[Frame::ElbowFlex, Frame::ForearmRoll]),
            forearm: self.extent(side, &[Frame::ForearmRoll]),
            upper_arm: self.extent(side, &[Frame::UpperArmRoll]),
            lift: self.extent(side, &[Frame::ShoulderLift, Frame::UpperArmRoll]),
            pan: self.extent(side, &[Frame::ShoulderPan]),
        }
    }

    /// Levers of one arm, m, a row per link in the order of [`arm_bodies`](Self::arm_bodies): largest distance from the axis
    /// of each joint to any point of the link, 0 for a joint that does not move it; fingers at any opening.
    pub fn link_levers(&self, side: Side) -> Vec<[f64; 7]> {
        let hand = self.hand_extent(side);
        self.arm_bodies(side).iter().map(|arm_body| self.levers_of(arm_body, hand)).collect()
    }

    fn levers_of(&self, arm_body: &ArmBody, hand: Extent) -> [f64; 7] {
        let mut own = Extent::default();
        match arm_body.frame {
            // The whole hand's extent bounds each finger's at any opening; they differ by centimetres only.
            Frame::LeftFinger | Frame::RightFinger | Frame::LeftFingerTip | Frame::RightFingerTip => {
                own = hand;
            }
            _ => {
                if let Some(body) = self.body(arm_body.link) {
                    own.cover(body, &Isometry3::identity());
                }
            }
        }
        let mut levers = [0.0; 7];
        let centre = own.centre;
        let beyond_lift = match arm_body.frame {
            Frame::ShoulderPan => {
                levers[0] = own.axis_z;
                return levers;
            }
            Frame::ShoulderLift => centre,
            Frame::UpperArmRoll => {
                levers[2] = own.axis_x;
                centre
            }
            Frame::ElbowFlex | Frame::ForearmRoll => {
                (levers[2], levers[3]) = (centre, centre);
                levers[4] = if arm_body.frame == Frame::ForearmRoll { own.axis_x } else { 0.0 };
                UPPER_ARM + centre
            }
            _ => {
                let beyond_elbow = FOREARM + centre;
                (levers[2], levers[3]) = (beyond_elbow, beyond_elbow);
                (levers[4], levers[5]) = (centre, centre);
                levers[6] = if arm_body.frame == Frame::WristFlex { 0.0 } else { own.axis_x };
                UPPER_ARM + beyond_elbow
            }
        };
        levers[1] = beyond_lift;
        levers[0] = UPPER_ARM_OFFSET + beyond_lift;
        levers
    }

    /// Radii of one arm's joints and of the base; the arm may be anywhere, everything else stands as in `rest`.
    ///
    /// `held_radius` as in [`joint_radius`](Self::joint_radius).
    pub fn travel_bound(&self, side: Side, held_radius: f64, rest: &WholeBody) -> TravelBound {
        let joint = self.joint_radius(side, held_radius);
        let moving: Vec<usize> = self.arm_bodies(side).iter().map(|b| b.link).collect();
        let standing = self.radius_of(rest, |link| !moving.contains(&link));
        let shoulder = SHOULDER_X.hypot(SHOULDER_Y);
        TravelBound { joint, base: standing.max(shoulder + joint[0]) }
    }

    /// Largest distance from the vertical axis of the base to any point of the robot in this state, m.
    pub fn radius(&self, state: &WholeBody) -> f64 {
        self.radius_of(state, |_| true)
    }

    fn radius_of(&self, state: &WholeBody, counts: impl Fn(usize) -> bool) -> f64 {
        let poses = self.link_poses(&WholeBody { base: [0.0; 3], ..state.clone() });
        let links = poses.iter().enumerate().filter(|(link, _)| counts(*link));
        let corners = links.filter_map(|(link, pose)| Some((self.body(link)?, pose)));
        corners.flat_map(|(body, pose)| corners_of(body, pose)).map(|p| p.x.hypot(p.y)).fold(0.0, f64::max)
    }

    /// Extent of the geometry on some frames, each in its own axes.
    fn extent(&self, side: Side, frames: &[Frame]) -> Extent {
        let mut extent = Extent::default();
        for arm_body in self.arm_bodies(side).iter().filter(|b| frames.contains(&b.frame)) {
            if let Some(body) = self.body(arm_body.link) {
                extent.cover(body, &Isometry3::identity());
            }
        }
        extent
    }

    /// Extent of everything beyond the wrist, in the wrist frame, over all finger angles.
    fn hand_extent(&self, side: Side) -> Extent {
        let mut extent = self.extent(side, &[Frame::WristFlex, Frame::WristRoll]);
        let spacing = MAX_FINGER_ANGLE / f64::from(FINGER_SAMPLES);
        let mut fingers = Extent::default();
        for sample in 0..=FINGER_SAMPLES {
            let poses = gripper::finger_poses(spacing * f64::from(sample));
            for arm_body in self.arm_bodies(side) {
                let pose = match arm_body.frame {
                    Frame::LeftFinger => poses.left_finger,
                    Frame::RightFinger => poses.right_finger,
                    Frame::LeftFingerTip => poses.left_tip,
                    Frame::RightFingerTip => poses.right_tip,
                    _ => continue,
                };
                if let Some(body) = self.body(arm_body.link) {
                    fingers.cover(body, &pose);
                }
            }
        }
        // Between two samples no point moves farther than its lever times half the spacing.
        let lever = self.extent(side, &[Frame::LeftFinger, Frame::RightFinger]).centre.max(TIP_LEVER);
        let between = lever * spacing / 2.0;
        extent.centre = extent.centre.max(fingers.centre + between);
        extent.axis_x = extent.axis_x.max(fingers.axis_x + between);
        extent
    }
}

/// How far the parts of one arm extend.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ArmExtents {
    hand: Extent,
    elbow: Extent,
    forearm: Extent,
    upper_arm: Extent,
    lift: Extent,
    pan: Extent,
}

impl ArmExtents {
    /// See [`Pr2Model::joint_radius`].
    pub(crate) fn joint_radius(&self, held_radius: f64) -> [f64; 7] {
        let wrist = self.hand.centre.max(TOOL + held_radius);
        let roll = self.hand.axis_x.max(held_radius);
        let beyond_elbow = self.elbow.centre.max(FOREARM + wrist);
        let beyond_lift = self.lift.centre.max(UPPER_ARM + beyond_elbow);
        [
            self.pan.axis_z.max(UPPER_ARM_OFFSET + beyond_lift),
            beyond_lift,
            self.upper_arm.axis_x.max(beyond_elbow),
            beyond_elbow,
            self.forearm.axis_x.max(wrist),
            wrist,
            roll,
        ]
    }
}

/// Farthest points of some geometry, m.
#[derive(Debug, Clone, Copy, Default)]
struct Extent {
    /// From the origin.
    centre: f64,
    /// From the x axis.
    axis_x: f64,
    /// From the z axis.
    axis_z: f64,
}

impl Extent {
    fn cover(&mut self, body: &Body, pose: &Isometry3<f64>) {
        for p in corners_of(body, pose) {
            self.centre = self.centre.max(p.coords.norm());
            self.axis_x = self.axis_x.max(p.y.hypot(p.z));
            self.axis_z = self.axis_z.max(p.x.hypot(p.y));
        }
    }
}

/// Corners of the boxes around the parts of a body: nothing of it lies outside their hull.
pub fn corners_of<'a>(body: &'a Body, world_from_body: &'a Isometry3<f64>) -> impl Iterator<Item = Point3<f64>> + 'a {
    body.parts.iter().flat_map(move |part| {
        let (low, high) = part.shape.local_aabb();
        let pose = world_from_body * part.body_from_shape;
        (0..8_u8).map(move |corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            pose * Point3::from(Vector3::new(pick(0), pick(1), pick(2)))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn radii_are_tight_enough_to_be_useful() {
        let model = Pr2Model::embedded().unwrap();
        let radius = model.joint_radius(Side::Right, 0.0);
        let expected = [1.03, 0.93, 0.53, 0.53, 0.21, 0.21, 0.096];
        for (r, e) in radius.iter().zip(expected) {
            assert!((r - e).abs() < 0.01, "{radius:?}");
        }
        let held = model.joint_radius(Side::Right, 0.3);
        assert!(held.iter().zip(radius).all(|(h, r)| *h >= r) && held[6] == 0.3 && held[5] == 0.48);
        let state = WholeBody::at_rest();
        let bound = model.travel_bound(Side::Right, 0.0, &state);
        assert!(model.radius(&state) <= bound.base && bound.base < 1.25, "{bound:?}");
    }

    #[test]
    fn no_corner_travels_farther_than_the_bound() {
        let model = Pr2Model::embedded().unwrap();
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(21);
        let levers = Side::BOTH.map(|side| model.link_levers(side));
        for round in 0..150 {
            let side = Side::BOTH[round % 2];
            let i = side.index();
            let mut from = WholeBody::at_rest();
            from.base = std::array::from_fn(|_| rng.random_range(-2.0..2.0));
            from.arms[i] = std::array::from_fn(|_| rng.random_range(-3.0..3.0));
            from.finger_angles = [rng.random_range(0.0..=MAX_FINGER_ANGLE); 2];
            let scale = if round % 3 == 0 { 1.0 } else { 0.05 };
            let mut to = from.clone();
            for value in to.base.iter_mut().chain(&mut to.arms[i]) {
                *value += scale * rng.random_range(-1.0..1.0);
            }
            if round % 5 == 0 {
                // One joint alone is where a radius that is too small would show.
                let joint = round / 5 % 7;
                (to.base, to.arms[i]) = (from.base, from.arms[i]);
                to.arms[i][joint] += 0.02;
            }
            let d: [f64; 7] = std::array::from_fn(|j| to.arms[i][j] - from.arms[i][j]);
            let shift = (to.base[0] - from.base[0]).hypot(to.base[1] - from.base[1]);
            let bound = model.travel_bound(side, 0.0, &from).distance(&d, shift, to.base[2] - from.base[2]);
            let (start, end) = (model.link_poses(&from), model.link_poses(&to));
            for (link, (a, b)) in start.iter().zip(&end).enumerate() {
                let Some(body) = model.body(link) else { continue };
                let row = model.arm_bodies(side).iter().position(|b| b.link == link);
                let own = row.map_or(f64::INFINITY, |row| {
                    let base = shift + (to.base[2] - from.base[2]).abs() * model.travel_bound(side, 0.0, &from).base;
                    base + levers[side.index()][row].iter().zip(&d).map(|(r, d)| r * d.abs()).sum::<f64>()
                });
                for (p, q) in corners_of(body, a).zip(corners_of(body, b)) {
                    let travel = (q - p).norm();
                    assert!(travel <= bound.min(own) + 1e-12, "{} {travel} > {bound}, {own}", body.name);
                }
            }
        }
    }
}
