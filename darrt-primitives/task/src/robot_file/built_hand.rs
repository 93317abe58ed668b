//! A hand of boxes for a description that has none: a palm, and two fingers that slide against each other.

use darrt_primitives::kinematics::urdf::{Geometry, JointDescription, JointKind, Mimic, PlacedGeometry};
use darrt_primitives::kinematics::{JointLimit, RobotDescription};
use nalgebra::{Isometry3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::amend::{add_fixed, joint_index, link_index, new_joint, new_link, pose};
use super::error::Fault;

/// The link of its palm.
pub const HAND: &str = "hand";
/// The joint that opens it.
pub const JOINT: &str = "hand_left";
/// The links of its fingers: that on the side of +y first.
pub const TIPS: [&str; 2] = ["hand_left", "hand_right"];
/// How fast a finger moves at most, metres per second.
const FINGER_SPEED: f64 = 0.1;

/// `[hand]`: adds the links `hand`, `hand_left` and `hand_right` and the joints of these names; `hand_left` opens it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BuiltHand {
    /// The link that it is bolted to.
    pub on: String,
    /// Where the middle of the palm's back is in the frame of that link: x, y, z, metres.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// How it is turned there: roll, pitch, yaw, radians. Its x axis points out of the hand, its y axis the way the fingers open.
    #[serde(default)]
    pub rpy: [f64; 3],
    /// Edges of the palm along x, y and z, metres.
    pub palm_m: [f64; 3],
    /// Length (x), thickness (y) and width (z) of a finger, metres.
    pub finger_m: [f64; 3],
    /// The widest gap between the fingers, metres.
    pub opening_m: f64,
}

impl BuiltHand {
    /// Adds it to the description.
    pub(super) fn add(&self, description: &mut RobotDescription) -> Result<(), Fault> {
        let lengths = [("hand.palm_m", &self.palm_m[..]), ("hand.finger_m", &self.finger_m[..])];
        let opening = [self.opening_m];
        for (key, values) in lengths.into_iter().chain([("hand.opening_m", &opening[..])]) {
            if let Some(value) = values.iter().find(|value| !(**value > 0.0 && **value <= 1.0)) {
                return Err(Fault::new(key, format!("is {value}, must be above 0 and at most 1")));
            }
        }
        let on = link_index(description, "hand.on", &self.on)?;
        let taken = |name: &&str| {
            joint_index(description, name).is_some() || description.links.iter().any(|link| *link.name == **name)
        };
        if let Some(name) = [HAND, TIPS[0], TIPS[1]].iter().find(|name| taken(name)) {
            return Err(Fault::new("hand", format!("adds `{name}`, which the description has already")));
        }
        let palm = add_fixed(description, on, HAND, pose(self.xyz, self.rpy));
        let [length, thickness, _] = self.finger_m;
        let cuboid = |size: [f64; 3], middle: [f64; 3]| PlacedGeometry {
            link_from_geometry: Isometry3::translation(middle[0], middle[1], middle[2]),
            geometry: Geometry::Cuboid { size: Vector3::from(size) },
        };
        let shape = cuboid(self.palm_m, [0.5 * self.palm_m[0], 0.0, 0.0]);
        if let Some(link) = description.links.get_mut(palm) {
            link.collision.push(shape);
        }
        let half = 0.5 * self.opening_m;
        let mut driver = None;
        for (name, side) in TIPS.into_iter().zip([1.0, -1.0]) {
            let finger = new_link(description, name);
            let shape = cuboid(self.finger_m, [0.5 * length, 0.5 * side * thickness, 0.0]);
            if let Some(link) = description.links.get_mut(finger) {
                link.collision.push(shape);
            }
            let limit = if side > 0.0 { JointLimit::new(0.0, half) } else { JointLimit::new(-half, 0.0) };
            let at = Isometry3::translation(self.palm_m[0], 0.0, 0.0);
            let joint = new_joint(name, JointKind::Sliding, [palm, finger], at);
            let mimic = driver.map(|joint| Mimic { joint, multiplier: -1.0, offset: 0.0 });
            description.joints.push(JointDescription {
                axis: Vector3::y_axis(),
                limit,
                soft_limit: limit,
                max_velocity: FINGER_SPEED,
                mimic,
                ..joint
            });
            driver = driver.or(Some(description.joints.len() - 1));
        }
        Ok(())
    }
}
