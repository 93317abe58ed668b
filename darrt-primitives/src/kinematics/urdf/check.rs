//! The checks `urdf-rs` does not make, and the translation into our own types.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use super::{
    Geometry, JointDescription, JointKind, LinkDescription, Mimic, PlacedGeometry, RobotDescription, UrdfError,
};
use crate::kinematics::limit::JointLimit;

/// Lengths beyond this (m) are mistakes, joint limits beyond it (rad, m) mean none; the geometry crate has the same bound.
const FARTHEST: f64 = 1e4;

/// Checks a parsed description and translates it.
///
/// `seen`: the links that have a visual.
pub(super) fn checked(robot: &urdf_rs::Robot, seen: &BTreeSet<String>) -> Result<RobotDescription, UrdfError> {
    if robot.links.is_empty() {
        return Err(UrdfError::NoLink);
    }
    let link_index = index_names("link", robot.links.iter().map(|l| l.name.as_str()))?;
    let joint_index = index_names("joint", robot.joints.iter().map(|j| j.name.as_str()))?;
    let links = robot.links.iter().map(|l| link(l, seen)).collect::<Result<Vec<_>, _>>()?;
    let mut joints = robot.joints.iter().map(|j| joint(j, &link_index, &joint_index)).collect::<Result<Vec<_>, _>>()?;
    let root = single_root(&links, &joints)?;
    settle_mimics(&mut joints)?;
    Ok(RobotDescription { name: robot.name.clone(), links, joints, root })
}

/// Name to index, refusing doubles.
fn index_names<'a>(
    kind: &'static str,
    names: impl Iterator<Item = &'a str>,
) -> Result<BTreeMap<&'a str, usize>, UrdfError> {
    let mut index = BTreeMap::new();
    for (i, name) in names.enumerate() {
        if index.insert(name, i).is_some() {
            return Err(UrdfError::DuplicateName { kind, name: name.to_owned() });
        }
    }
    Ok(index)
}

fn link(link: &urdf_rs::Link, seen: &BTreeSet<String>) -> Result<LinkDescription, UrdfError> {
    let element = || format!("link {}", link.name);
    let place = |c: &urdf_rs::Collision| {
        Ok(PlacedGeometry {
            link_from_geometry: pose(&c.origin, &element)?,
            geometry: geometry(&c.geometry, &element)?,
        })
    };
    Ok(LinkDescription {
        name: Arc::from(link.name.as_str()),
        collision: link.collision.iter().map(place).collect::<Result<_, _>>()?,
        has_visual: seen.contains(&link.name),
    })
}

fn geometry(geometry: &urdf_rs::Geometry, element: &dyn Fn() -> String) -> Result<Geometry, UrdfError> {
    let size = |quantity, value: f64| {
        finite(quantity, value, element)?;
        if value > 0.0 && value <= FARTHEST {
            Ok(value)
        } else {
            Err(UrdfError::OutOfBounds { element: element(), quantity, value, bound: "positive and at most 1e4" })
        }
    };
    Ok(match geometry {
        urdf_rs::Geometry::Box { size: edges } => Geometry::Cuboid {
            size: Vector3::new(size("box size", edges[0])?, size("box size", edges[1])?, size("box size", edges[2])?),
        },
        urdf_rs::Geometry::Sphere { radius } => Geometry::Sphere { radius: size("sphere radius", *radius)? },
        urdf_rs::Geometry::Cylinder { radius, length } => {
            Geometry::Cylinder { radius: size("cylinder radius", *radius)?, length: size("cylinder length", *length)? }
        }
        urdf_rs::Geometry::Capsule { radius, length } => {
            Geometry::Capsule { radius: size("capsule radius", *radius)?, length: size("capsule length", *length)? }
        }
        urdf_rs::Geometry::Mesh { filename, scale } => {
            let scale = scale.map_or([1.0; 3], |s| *s);
            for value in scale {
                size("mesh scale", value.abs())?;
            }
            Geometry::Mesh { filename: filename.clone(), scale: Vector3::from(scale) }
        }
    })
}

fn joint(
    joint: &urdf_rs::Joint,
    link_index: &BTreeMap<&str, usize>,
    joint_index: &BTreeMap<&str, usize>,
) -> Result<JointDescription, UrdfError> {
    let element = || format!("joint {}", joint.name);
    let resolve = |role, index: &BTreeMap<&str, usize>, name: &str| {
        index.get(name).copied().ok_or_else(|| UrdfError::Dangling {
            joint: joint.name.clone(),
            role,
            name: name.to_owned(),
        })
    };
    let kind = kind(joint)?;
    let limit = hard_limit(joint)?;
    for (quantity, value) in [("velocity", joint.limit.velocity), ("effort", joint.limit.effort)] {
        not_negative(quantity, value, &element)?;
    }
    let mimic = match &joint.mimic {
        None => None,
        Some(m) => Some(Mimic {
            joint: resolve("mimicked joint", joint_index, &m.joint)?,
            multiplier: finite("mimic multiplier", m.multiplier.unwrap_or(1.0), &element)?,
            offset: finite("mimic offset", m.offset.unwrap_or(0.0), &element)?,
        }),
    };
    Ok(JointDescription {
        name: Arc::from(joint.name.as_str()),
        kind,
        parent: resolve("parent link", link_index, &joint.parent.link)?,
        child: resolve("child link", link_index, &joint.child.link)?,
        parent_from_child: pose(&joint.origin, &element)?,
        axis: axis(joint, kind)?,
        limit,
        soft_limit: soft_limit(joint, limit)?,
        max_velocity: joint.limit.velocity,
        max_effort: joint.limit.effort,
        mimic,
    })
}

fn kind(joint: &urdf_rs::Joint) -> Result<JointKind, UrdfError> {
    let unsupported = |kind| Err(UrdfError::UnsupportedJoint { joint: joint.name.clone(), kind });
    match joint.joint_type {
        urdf_rs::JointType::Fixed => Ok(JointKind::Fixed),
        urdf_rs::JointType::Revolute | urdf_rs::JointType::Continuous => Ok(JointKind::Turning),
        urdf_rs::JointType::Prismatic => Ok(JointKind::Sliding),
        urdf_rs::JointType::Floating => unsupported("floating"),
        urdf_rs::JointType::Planar => unsupported("planar"),
        urdf_rs::JointType::Spherical => unsupported("spherical"),
    }
}

/// Hard limits; a continuous joint arrives from the reader with (0, 0) and has none.
fn hard_limit(joint: &urdf_rs::Joint) -> Result<JointLimit, UrdfError> {
    if joint.joint_type == urdf_rs::JointType::Continuous {
        return Ok(JointLimit::UNLIMITED);
    }
    ordered(joint, "hard", joint.limit.lower, joint.limit.upper)
}

/// Soft limits, cut to the hard ones.
fn soft_limit(joint: &urdf_rs::Joint, hard: JointLimit) -> Result<JointLimit, UrdfError> {
    let Some(safety) = &joint.safety_controller else {
        return Ok(hard);
    };
    let soft = ordered(joint, "soft", safety.soft_lower_limit, safety.soft_upper_limit)?;
    // A controller without limits of its own reads as (0, 0).
    if hard.is_unlimited() || soft == JointLimit::new(0.0, 0.0) {
        return Ok(hard);
    }
    ordered(joint, "soft", soft.lower.max(hard.lower), soft.upper.min(hard.upper))
}

fn ordered(joint: &urdf_rs::Joint, which: &'static str, lower: f64, upper: f64) -> Result<JointLimit, UrdfError> {
    let element = || format!("joint {}", joint.name);
    for (quantity, value, absent) in [("lower limit", lower, f64::NEG_INFINITY), ("upper limit", upper, f64::INFINITY)]
    {
        if value != absent {
            finite(quantity, value, &element)?;
        }
    }
    // Descriptions write 1e16 and the like for "none".
    let lower = if lower < -FARTHEST { f64::NEG_INFINITY } else { lower };
    let upper = if upper > FARTHEST { f64::INFINITY } else { upper };
    if lower > upper {
        return Err(UrdfError::LimitOrder { joint: joint.name.clone(), which, lower, upper });
    }
    Ok(JointLimit::new(lower, upper))
}

fn axis(joint: &urdf_rs::Joint, kind: JointKind) -> Result<Unit<Vector3<f64>>, UrdfError> {
    let [x, y, z] = *joint.axis.xyz;
    for value in [x, y, z] {
        finite("axis", value, &|| format!("joint {}", joint.name))?;
    }
    // Scaled first: the norm of huge or tiny components must neither overflow nor vanish.
    let largest = x.abs().max(y.abs()).max(z.abs());
    let scaled = Vector3::new(x / largest, y / largest, z / largest);
    match Unit::try_new(scaled, 0.5) {
        Some(axis) => Ok(axis),
        None if kind == JointKind::Fixed => Ok(Vector3::x_axis()),
        None => Err(UrdfError::ZeroAxis { joint: joint.name.clone(), x, y, z }),
    }
}

fn pose(origin: &urdf_rs::Pose, element: &dyn Fn() -> String) -> Result<Isometry3<f64>, UrdfError> {
    let [x, y, z] = *origin.xyz;
    let [roll, pitch, yaw] = *origin.rpy;
    for value in [x, y, z] {
        finite("origin xyz", value, element)?;
        if value.abs() > FARTHEST {
            return Err(UrdfError::OutOfBounds {
                element: element(),
                quantity: "origin xyz",
                value,
                bound: "within 1e4 of zero",
            });
        }
    }
    for value in [roll, pitch, yaw] {
        finite("origin rpy", value, element)?;
    }
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw)))
}

fn finite(quantity: &'static str, value: f64, element: &dyn Fn() -> String) -> Result<f64, UrdfError> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(UrdfError::NotFinite { element: element(), quantity, value })
}

/// Not NaN, not negative; infinity means no bound.
fn not_negative(quantity: &'static str, value: f64, element: &dyn Fn() -> String) -> Result<(), UrdfError> {
    if value.is_nan() {
        return finite(quantity, value, element).map(|_| ());
    }
    if value < 0.0 {
        return Err(UrdfError::OutOfBounds { element: element(), quantity, value, bound: "zero or more" });
    }
    Ok(())
}

/// The one link that is no joint's child, given that every link can be reached from it.
fn single_root(links: &[LinkDescription], joints: &[JointDescription]) -> Result<usize, UrdfError> {
    let name = |link: usize| links.get(link).map_or_else(String::new, |l| l.name.to_string());
    let mut parent_joint: Vec<Option<&JointDescription>> = vec![None; links.len()];
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    for joint in joints {
        if let Some(slot) = parent_joint.get_mut(joint.child) {
            if let Some(first) = slot {
                return Err(UrdfError::TwoParents {
                    link: name(joint.child),
                    first: first.name.to_string(),
                    second: joint.name.to_string(),
                });
            }
            *slot = Some(joint);
        }
        if let Some(list) = children.get_mut(joint.parent) {
            list.push(joint.child);
        }
    }
    let mut roots = (0..links.len()).filter(|&i| parent_joint.get(i).is_some_and(Option::is_none));
    let root = roots.next().ok_or_else(|| UrdfError::Cycle { link: name(0) })?;
    if let Some(second) = roots.next() {
        return Err(UrdfError::SeveralRoots { first: name(root), second: name(second) });
    }
    // Every link has at most one parent, so this walk visits each at most once.
    let mut reached = vec![false; links.len()];
    let mut stack = vec![root];
    while let Some(link) = stack.pop() {
        if let Some(mark) = reached.get_mut(link) {
            *mark = true;
        }
        stack.extend(children.get(link).into_iter().flatten());
    }
    match reached.iter().position(|r| !r) {
        None => Ok(root),
        Some(link) => Err(UrdfError::Cycle { link: name(link) }),
    }
}

/// Every chain of mimic joints ends at a movable joint that mimics none: what follows a joint that stands still stands still
/// too, where that says.
fn settle_mimics(joints: &mut [JointDescription]) -> Result<(), UrdfError> {
    let mut followers: Vec<Vec<usize>> = vec![Vec::new(); joints.len()];
    for (index, joint) in joints.iter_mut().enumerate() {
        if joint.kind == JointKind::Fixed {
            joint.mimic = None;
        }
        if let Some(list) = joint.mimic.and_then(|mimic| followers.get_mut(mimic.joint)) {
            list.push(index);
        }
    }
    // Each joint mimics at most one other, so that each is settled at most once.
    let fixed = joints.iter().enumerate().filter(|(_, joint)| joint.kind == JointKind::Fixed);
    // With where each stands: a joint that is fixed in the file at zero.
    let mut still: Vec<(usize, f64)> = fixed.map(|(index, _)| (index, 0.0)).collect();
    while let Some((leader, at)) = still.pop() {
        for follower in followers.get_mut(leader).map(std::mem::take).unwrap_or_default() {
            let Some(joint) = joints.get_mut(follower) else { continue };
            let value = joint.mimic.map_or(0.0, |mimic| mimic.multiplier * at + mimic.offset);
            if value.is_nan() || value.abs() > FARTHEST {
                let (element, quantity) = (format!("joint {}", joint.name), "value from the joint that it mimics");
                return Err(UrdfError::OutOfBounds { element, quantity, value, bound: "within 1e4 of zero" });
            }
            joint.parent_from_child *= match joint.kind {
                JointKind::Fixed => Isometry3::identity(),
                JointKind::Turning => Isometry3::rotation(joint.axis.into_inner() * value),
                JointKind::Sliding => Isometry3::from(Translation3::from(joint.axis.into_inner() * value)),
            };
            (joint.kind, joint.mimic, joint.limit, joint.soft_limit) = (JointKind::Fixed, None, STILL, STILL);
            still.push((follower, value));
        }
    }
    mimics_end(joints)
}

/// The limits of a joint that does not move.
const STILL: JointLimit = JointLimit::new(0.0, 0.0);

/// No joint mimics itself, directly or through others.
fn mimics_end(joints: &[JointDescription]) -> Result<(), UrdfError> {
    // Per joint: 0 not seen, otherwise the number of the walk that saw it first.
    let mut seen = vec![0_usize; joints.len()];
    for (walk, start) in joints.iter().enumerate() {
        let mut joint = start;
        while let Some(mimic) = joint.mimic {
            let (Some(target), Some(mark)) = (joints.get(mimic.joint), seen.get_mut(mimic.joint)) else {
                break;
            };
            if *mark == walk + 1 {
                return Err(UrdfError::MimicCycle { joint: target.name.to_string() });
            }
            if *mark != 0 {
                break; // an earlier walk went on from here and ended
            }
            *mark = walk + 1;
            joint = target;
        }
    }
    Ok(())
}
