//! The description as the robot file completes it: with a tool frame, pads, joints that follow others, and what it stands on.
//!
//! What comes out is a description again, so that planner, verifier and pictures read the same robot, each in its own way.

use std::f64::consts::PI;
use std::sync::Arc;

use darrt_primitives::joints::MAX_JOINTS;
use darrt_primitives::kinematics::urdf::{JointDescription, JointKind, LinkDescription, Mimic};
use darrt_primitives::kinematics::{JointLimit, KinematicTree, RobotDescription, link_bodies};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use super::error::Fault;
use super::straight::straighten;
use super::{ArmTables, BaseKind, RobotFile, pads, two_arms};
use std::path::PathBuf;

/// Where a hand is in a plane, and how it is turned there.
pub(crate) const LEAST_JOINTS: usize = 3;
/// So many joints take a hand to any pose.
pub(crate) const ANY_POSE: usize = 6;
/// The joint of a rail.
const RAIL: &str = "rail";

/// A completed description, and which part of it is what.
#[derive(Debug, Clone)]
pub struct Amended {
    /// Links, joints and shapes.
    pub description: RobotDescription,
    /// The joints of all arms: those of the first, then those of the second that the first has not.
    pub arm_joints: Vec<String>,
    /// The first arm.
    pub first: AmendedArm,
    /// The second, if there is one.
    pub second: Option<AmendedArm>,
    /// Values of the joints that no arm and no hand has (rad or m).
    pub rest: Vec<(String, f64)>,
    /// Joints whose angles were made right ones, which was meant: only of an arm of fewer joints than six.
    pub straightened: Vec<String>,
}

/// Which part of a completed description is one of the arms.
#[derive(Debug, Clone)]
pub struct AmendedArm {
    /// Its joints, from the base outwards.
    pub joints: Vec<String>,
    /// The link whose frame is the tool frame.
    pub tool_link: String,
    /// The link that the last joint of the arm moves.
    pub wrist_link: String,
    /// The links with the pads: boxes along the axes of the tool; that on the side of +y first.
    pub tip_links: [String; 2],
}

impl Amended {
    /// The arms, the first one first.
    pub fn arms(&self) -> impl Iterator<Item = &AmendedArm> {
        std::iter::once(&self.first).chain(&self.second)
    }
}

/// Completes `description`; `mesh_path` says where the file of a mesh is.
///
/// # Errors
/// [`Fault`] with the key of the robot file that does not fit the description.
pub fn amend(
    file: &RobotFile,
    mut description: RobotDescription,
    mesh_path: &dyn Fn(&str) -> Option<PathBuf>,
) -> Result<Amended, Fault> {
    if let Some(hand) = &file.hand {
        hand.add(&mut description)?;
    }
    let is_of_two = file.second.is_some();
    let mut first = with_tool(file.first_arm(), is_of_two, &mut description)?;
    if let Some(tables) = file.second_arm().filter(|tables| tables.arm.to == file.arm.to) {
        let why = format!("names `{}`, in which the first arm ends: a second arm has a hand of its own", file.arm.to);
        return Err(Fault::new(tables.key("arm.to"), why));
    }
    let mut second = file.second_arm().map(|tables| with_tool(tables, is_of_two, &mut description)).transpose()?;
    if let Some(joint) = stand(file, &mut description)? {
        for arm in std::iter::once(&mut first).chain(&mut second) {
            arm.joints.insert(0, joint.clone());
        }
    }
    let pair = file.second_arm().zip(second.as_ref());
    check_count(file.first_arm(), &first, pair.is_some())?;
    if let Some((tables, second)) = pair {
        check_count(tables, second, true)?;
        two_arms::check((file.first_arm(), &first), (tables, second), &description)?;
    }
    let others = second.iter().flat_map(|second| &second.joints).filter(|name| !first.joints.contains(name));
    let arm_joints: Vec<String> = first.joints.iter().chain(others).cloned().collect();
    if let Some((tables, _)) = pair.filter(|_| arm_joints.len() > MAX_JOINTS) {
        let why = format!("makes it {} joints of both arms, at most {MAX_JOINTS} are planned with", arm_joints.len());
        return Err(Fault::new(tables.key("arm.to"), why));
    }
    let is_few = first.joints.len() < ANY_POSE;
    let tool = link_index(&description, "tool.link", &first.tool_link)?;
    let straightened = if is_few { straighten(&mut description, tool) } else { Vec::new() };
    let rest = rest(file, &description, &arm_joints)?;
    for (tables, arm) in file.arms().zip(std::iter::once(&mut first).chain(&mut second)) {
        arm.tip_links = pads::box_in(tables, &mut description, &arm.tool_link, &arm.wrist_link, mesh_path)?;
    }
    Ok(Amended { description, arm_joints, first, second, rest, straightened })
}

/// An arm with its tool frame and the joints that follow the one of its hand; its tips are still those of the file.
fn with_tool(of: ArmTables<'_>, is_of_two: bool, description: &mut RobotDescription) -> Result<AmendedArm, Fault> {
    let joints = arm_joints(of, description)?;
    let wrist = joints.last().and_then(|name| joint_index(description, name));
    let wrist = wrist.ok_or_else(|| Fault::new(of.key("arm.to"), "is moved by no joint of the arm"))?;
    let wrist_link = description.joints[wrist].child;
    follow(of, description)?;
    let tool = link_index(description, &of.key("tool.link"), &of.tool.link)?;
    if !is_rigid_to(description, tool, wrist_link) {
        let why = format!("names `{}`, which is not rigid to the last link that the arm moves", of.tool.link);
        return Err(Fault::new(of.key("tool.link"), why));
    }
    let link_from_tool = pose(of.tool.xyz, of.tool.rpy);
    let tool_link = if link_from_tool == Isometry3::identity() {
        of.tool.link.clone()
    } else {
        // Where there are two, people read which one is meant.
        let wanted = if is_of_two { format!("{}_tool", of.tool.link) } else { "tool".to_owned() };
        let name = free_name(description, &wanted);
        add_fixed(description, tool, &name, link_from_tool);
        name
    };
    let wrist_link = description.links[wrist_link].name.to_string();
    Ok(AmendedArm { joints, tool_link, wrist_link, tip_links: of.gripper.tips.clone() })
}

/// An arm has neither more joints than are planned with nor fewer than are of use; one of two has enough for any pose.
fn check_count(of: ArmTables<'_>, arm: &AmendedArm, is_of_two: bool) -> Result<(), Fault> {
    let count = arm.joints.len();
    let why = if count > MAX_JOINTS {
        format!("is moved by {count} joints below `{}`, at most {MAX_JOINTS} are planned with", of.key("arm.from"))
    } else if count < LEAST_JOINTS {
        format!(
            "is moved by {count} joints: an arm has at least {LEAST_JOINTS}, a rail among them, for a hand that comes to a place and \
             turns there"
        )
    } else if is_of_two && count < ANY_POSE {
        format!(
            "is moved by {count} joints: each arm of a robot with two has at least {ANY_POSE}, for a hand that comes to any pose"
        )
    } else {
        return Ok(());
    };
    Err(Fault::new(of.key("arm.to"), why))
}

/// The pose at x, y, z, turned by roll, pitch and yaw.
pub(super) fn pose(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

pub(super) fn joint_index(description: &RobotDescription, name: &str) -> Option<usize> {
    description.joints.iter().position(|joint| *joint.name == *name)
}

pub(super) fn link_index(description: &RobotDescription, key: &str, name: &str) -> Result<usize, Fault> {
    let found = description.links.iter().position(|link| *link.name == *name);
    found.ok_or_else(|| Fault::unknown(key, "link", name, description.links.iter().map(|link| &*link.name)))
}

fn named_joint(description: &RobotDescription, key: &str, name: &str) -> Result<usize, Fault> {
    let found = joint_index(description, name);
    found.ok_or_else(|| Fault::unknown(key, "joint", name, description.joints.iter().map(|joint| &*joint.name)))
}

/// The movable joints between the ends of an arm, from the base outwards.
fn arm_joints(of: ArmTables<'_>, description: &RobotDescription) -> Result<Vec<String>, Fault> {
    let from = link_index(description, &of.key("arm.from"), &of.arm.from)?;
    let mut link = link_index(description, &of.key("arm.to"), &of.arm.to)?;
    let mut joints = Vec::new();
    while link != from {
        let Some(joint) = description.joints.iter().find(|joint| joint.child == link) else {
            let why = format!("names `{}`, which is not below `{}`", of.arm.to, of.arm.from);
            return Err(Fault::new(of.key("arm.to"), why));
        };
        if joint.kind != JointKind::Fixed {
            if joint.mimic.is_some() {
                let why =
                    format!("is moved by `{}`, which follows another joint; an arm's joints are free", joint.name);
                return Err(Fault::new(of.key("arm.to"), why));
            }
            let (low, high) = (joint.limit.lower, joint.limit.upper);
            if low.is_finite() != high.is_finite() || (joint.kind == JointKind::Sliding && !low.is_finite()) {
                return Err(Fault::new(
                    of.key("arm.to"),
                    format!("is moved by `{}`, whose limits are not finite", joint.name),
                ));
            }
            joints.push(joint.name.to_string());
        }
        link = joint.parent;
    }
    if joints.is_empty() {
        return Err(Fault::new(
            of.key("arm.to"),
            format!("names `{}`, which no joint moves against `{}`", of.arm.to, of.key("arm.from")),
        ));
    }
    joints.reverse();
    Ok(joints)
}

/// Makes the joints of `gripper.follow` follow.
fn follow(of: ArmTables<'_>, description: &mut RobotDescription) -> Result<(), Fault> {
    let gripper = of.gripper;
    let driver = named_joint(description, &of.key("gripper.joint"), &gripper.joint)?;
    let joint = &description.joints[driver];
    let refuse = |why: String| Err(Fault::new(of.key("gripper.joint"), format!("names `{}`, {why}", gripper.joint)));
    if joint.kind == JointKind::Fixed {
        return refuse("which does not move".to_owned());
    }
    if let Some(mimic) = joint.mimic {
        return refuse(format!("which follows `{}`: name that one", description.joints[mimic.joint].name));
    }
    if !(joint.limit.lower.is_finite() && joint.limit.upper.is_finite() && joint.limit.lower < joint.limit.upper) {
        return refuse("whose limits are not two finite ends".to_owned());
    }
    for (name, follow) in &gripper.follow {
        let key = of.key(&format!("gripper.follow.{name}"));
        let index = named_joint(description, &key, name)?;
        if index == driver || description.joints[index].kind == JointKind::Fixed {
            return Err(Fault::new(key, "is a joint that cannot follow the gripper's"));
        }
        if !(follow.multiplier.is_finite() && follow.offset.is_finite()) {
            return Err(Fault::new(key, "has a number that is not finite"));
        }
        // What followed this joint follows the other one now: chains are allowed.
        description.joints[index].mimic =
            Some(Mimic { joint: driver, multiplier: follow.multiplier, offset: follow.offset });
    }
    Ok(())
}

/// Is `link` rigid to `to`, and below it?
fn is_rigid_to(description: &RobotDescription, mut link: usize, to: usize) -> bool {
    while link != to {
        match description.joints.iter().find(|joint| joint.child == link) {
            Some(joint) if joint.kind == JointKind::Fixed => link = joint.parent,
            _ => return false,
        }
    }
    true
}

/// A name that no link and no joint has.
fn free_name(description: &RobotDescription, wanted: &str) -> String {
    let is_taken = |name: &str| {
        description.links.iter().any(|link| *link.name == *name) || joint_index(description, name).is_some()
    };
    let numbered = (2..).map(|number| format!("{wanted}_{number}"));
    std::iter::once(wanted.to_owned()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
}

pub(super) fn new_link(description: &mut RobotDescription, name: &str) -> usize {
    description.links.push(LinkDescription { name: Arc::from(name), collision: Vec::new(), has_visual: false });
    description.links.len() - 1
}

pub(super) fn new_joint(
    name: &str,
    kind: JointKind,
    [parent, child]: [usize; 2],
    at: Isometry3<f64>,
) -> JointDescription {
    JointDescription {
        name: Arc::from(name),
        kind,
        parent,
        child,
        parent_from_child: at,
        axis: Vector3::x_axis(),
        limit: JointLimit::UNLIMITED,
        soft_limit: JointLimit::UNLIMITED,
        max_velocity: 0.0,
        max_effort: 0.0,
        mimic: None,
    }
}

/// A new link without shape that is rigid to another.
pub(super) fn add_fixed(
    description: &mut RobotDescription,
    parent: usize,
    name: &str,
    parent_from_link: Isometry3<f64>,
) -> usize {
    let link = new_link(description, name);
    description.joints.push(new_joint(name, JointKind::Fixed, [parent, link], parent_from_link));
    link
}

/// Puts the description on its base: below the root come a rail, of which this is the joint, and the place of the base.
fn stand(file: &RobotFile, description: &mut RobotDescription) -> Result<Option<String>, Fault> {
    let base = &file.base;
    let mut root_from_old = pose(base.xyz, base.rpy);
    let mut joint = None;
    let is_rail = base.kind == BaseKind::Rail;
    for (key, is_there) in [("base.rail_axis", base.rail_axis.is_some()), ("base.rail_m", base.rail_m.is_some())] {
        if is_there != is_rail {
            let why =
                if is_rail { "is missing: a base on a rail needs it" } else { "is for a base of the kind \"rail\"" };
            return Err(Fault::new(key, why));
        }
    }
    if let (Some(axis), Some([low, high])) = (base.rail_axis, base.rail_m) {
        let axis =
            Unit::try_new(Vector3::from(axis), 1e-6).ok_or_else(|| Fault::new("base.rail_axis", "has no length"))?;
        if !(low < high && low.abs() <= 1e2 && high.abs() <= 1e2) {
            let why = format!("is [{low}, {high}], must be two ends in order, within 100 m");
            return Err(Fault::new("base.rail_m", why));
        }
        let (old, name) = (description.root, free_name(description, RAIL));
        let root = new_link(description, &format!("{name}_base"));
        let limit = JointLimit::new(low, high);
        // The axis is that of the base, whichever way the description is turned on it.
        let axis = Unit::new_normalize(root_from_old.rotation.inverse() * axis.into_inner());
        let sliding = new_joint(&name, JointKind::Sliding, [root, old], root_from_old);
        let [max_velocity, _] = base.speed;
        description.joints.push(JointDescription { axis, limit, soft_limit: limit, max_velocity, ..sliding });
        description.root = root;
        root_from_old = Isometry3::identity();
        joint = Some(name);
    }
    if root_from_old != Isometry3::identity() {
        let (old, name) = (description.root, free_name(description, "base_frame"));
        let root = new_link(description, &name);
        description.joints.push(new_joint(&name, JointKind::Fixed, [root, old], root_from_old));
        description.root = root;
    }
    Ok(joint)
}

/// Where all other joints stand.
fn rest(file: &RobotFile, description: &RobotDescription, arm: &[String]) -> Result<Vec<(String, f64)>, Fault> {
    let is_mine =
        |name: &str| file.arms().any(|tables| tables.gripper.joint == name) || arm.iter().any(|joint| joint == name);
    for (name, value) in &file.rest {
        let key = format!("rest.{name}");
        let joint = &description.joints[named_joint(description, &key, name)?];
        if joint.kind == JointKind::Fixed || joint.mimic.is_some() || is_mine(name) {
            return Err(Fault::new(
                key,
                "is not a joint that rests: it is fixed, follows another, or belongs to arm or hand",
            ));
        }
        let limit = joint.limit;
        let bounds = if limit.is_unlimited() { JointLimit::new(-PI, PI) } else { limit };
        if !bounds.contains(*value) {
            let why = format!("is {value}, must be in [{}, {}]", bounds.lower, bounds.upper);
            return Err(Fault::new(key, why));
        }
    }
    let free = description.joints.iter().filter(|joint| joint.kind != JointKind::Fixed && joint.mimic.is_none());
    let resting = free.filter(|joint| !is_mine(&joint.name));
    let value = |joint: &JointDescription| file.rest.get(&*joint.name).copied().unwrap_or(joint.limit.clamp(0.0));
    Ok(resting.map(|joint| (joint.name.to_string(), value(joint))).collect())
}

/// Tree and shapes of a description as it is now.
pub(super) fn solids(
    description: &RobotDescription,
    mesh_path: &dyn Fn(&str) -> Option<PathBuf>,
) -> Result<(KinematicTree, Vec<Option<darrt_geom::Body>>), Fault> {
    let refuse =
        |error: darrt_primitives::kinematics::UrdfError| Fault::new("urdf", format!("cannot be used: {error}"));
    let tree = KinematicTree::new(description).map_err(refuse)?;
    let bodies = link_bodies(description, &tree, mesh_path).map_err(refuse)?;
    Ok((tree, bodies))
}
