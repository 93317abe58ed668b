//! The tips of the fingers as boxes along the axes of the tool, as pushes and grasps take them to be.

use std::path::PathBuf;

use darrt_geom::{Body, Shape};
use darrt_primitives::kinematics::urdf::{Geometry, PlacedGeometry};
use darrt_primitives::kinematics::{KinematicTree, RobotDescription};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::ArmTables;
use super::amend::{add_fixed, link_index, solids};
use super::error::Fault;

/// How far tips may turn while the hand opens, radians.
const PARALLEL_RAD: f64 = 1e-6;
/// How far the middle between the pads may be beside the tool frame, metres.
const MIDDLE_M: f64 = 1e-3;
/// How far the ends of the tips may differ, metres.
const ENDS_M: f64 = 2e-3;
/// What rounding does.
const ROUNDING: f64 = 1e-9;

/// The box around one tip along the axes of the tool, in a frame at the tip's origin.
#[derive(Debug, Clone, Copy)]
struct Cover {
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Turns from the tool's axes to those of the link.
    tool_from_tip: UnitQuaternion<f64>,
    /// Where the tip's origin is in the tool frame, the hand at its joint's lower and upper limit.
    at: [Vector3<f64>; 2],
    /// The link is such a box already.
    is_box: bool,
}

/// Gives both tips a box along the axes of the tool that covers their shapes, in place of these. The links with the boxes.
pub(super) fn box_in(
    of: ArmTables<'_>,
    description: &mut RobotDescription,
    tool_link: &str,
    wrist_link: &str,
    mesh_path: &dyn Fn(&str) -> Option<PathBuf>,
) -> Result<[String; 2], Fault> {
    let links = [
        link_index(description, &of.key("gripper.tips"), &of.gripper.tips[0])?,
        link_index(description, &of.key("gripper.tips"), &of.gripper.tips[1])?,
    ];
    // The tips alone: other links may have large meshes.
    let mut tips = description.clone();
    for (index, link) in tips.links.iter_mut().enumerate() {
        if !links.contains(&index) {
            link.collision.clear();
        }
    }
    let (tree, bodies) = solids(&tips, mesh_path)?;
    let cover = |name: &str| cover(of, &tree, &bodies, (tool_link, wrist_link), name);
    let mut covers = [cover(&of.gripper.tips[0])?, cover(&of.gripper.tips[1])?];
    check_symmetry(of, &covers)?;
    // The end of both, and as wide to one side of the tool frame as to the other.
    let end = covers.iter().map(|c| c.at[0].x + c.high.x).fold(f64::NEG_INFINITY, f64::max);
    let half = covers.iter().map(|c| (c.at[0].z + c.high.z).max(-(c.at[0].z + c.low.z))).fold(0.0, f64::max);
    for cover in &mut covers {
        let (x, z) = (end - cover.at[0].x, cover.at[0].z);
        let is_same = (cover.high.x - x).abs() <= ROUNDING
            && (cover.high.z - (half - z)).abs() <= ROUNDING
            && (cover.low.z - (-half - z)).abs() <= ROUNDING;
        cover.is_box &= is_same;
        (cover.high.x, cover.high.z, cover.low.z) = (x, half - z, -half - z);
    }
    let mut names = of.gripper.tips.clone();
    for ((name, link), cover) in names.iter_mut().zip(links).zip(&covers) {
        if cover.is_box {
            continue;
        }
        let pad = format!("{name}_pad");
        let tip_from_pad = Isometry3::from_parts(Translation3::identity(), cover.tool_from_tip.inverse());
        let index = add_fixed(description, link, &pad, tip_from_pad);
        let centre = (cover.low + cover.high) / 2.0;
        let geometry = Geometry::Cuboid { size: cover.high - cover.low };
        let placed =
            PlacedGeometry { link_from_geometry: Isometry3::translation(centre.x, centre.y, centre.z), geometry };
        description.links[index].collision.push(placed);
        description.links[link].collision.clear();
        *name = pad;
    }
    Ok(names)
}

/// The pose of `link` in the tool frame, the hand at its joint's lower and upper limit, all else at rest.
fn in_tool(of: ArmTables<'_>, tree: &KinematicTree, tool: usize, link: usize) -> Option<[Isometry3<f64>; 2]> {
    let finger = tree.variable_index(&of.gripper.joint)?;
    let limit = tree.variables().get(finger)?.limit;
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    let mut at = |value: f64| {
        let mut values = tree.neutral();
        *values.get_mut(finger)? = value;
        tree.forward(&values, &Isometry3::identity(), &mut poses).ok()?;
        Some(poses.get(tool)?.inverse() * poses.get(link)?)
    };
    Some([at(limit.lower)?, at(limit.upper)?])
}

fn cover(
    of: ArmTables<'_>,
    tree: &KinematicTree,
    bodies: &[Option<Body>],
    (tool_link, wrist_link): (&str, &str),
    name: &str,
) -> Result<Cover, Fault> {
    let refuse = |why: String| Fault::new(of.key("gripper.tips"), format!("names `{name}`, {why}"));
    let index = |name: &str| tree.link_index(name).ok_or_else(|| refuse(format!("and there is no link `{name}`")));
    let (link, tool, wrist) = (index(name)?, index(tool_link)?, index(wrist_link)?);
    let mut above = link;
    while above != wrist {
        above = tree.parent(above).ok_or_else(|| refuse("which the arm does not carry".to_owned()))?;
    }
    let [closed, open] = in_tool(of, tree, tool, link).ok_or_else(|| refuse("which has no place".to_owned()))?;
    if (closed.translation.vector - open.translation.vector).norm() <= ROUNDING {
        let why = format!(
            "which `{}` does not move; if a joint of its own moves it, see `{}`",
            of.gripper.joint,
            of.key("gripper.follow")
        );
        return Err(refuse(why));
    }
    let turn = closed.rotation.angle_to(&open.rotation);
    if turn > PARALLEL_RAD {
        let why = format!(
            "which turns by {:.1} degrees while the hand opens; pads must stay parallel, and a hand whose fingers swing has none",
            turn.to_degrees()
        );
        return Err(refuse(why));
    }
    let body = bodies.get(link).and_then(Option::as_ref);
    let body = body.ok_or_else(|| refuse("which has no collision shape: the pads must be known".to_owned()))?;
    let rotation = closed.rotation;
    let farthest = |axis: Vector3<f64>| {
        let axis = rotation.inverse() * axis;
        let parts = body.parts.iter().map(|part| {
            let inside = part.body_from_shape.rotation.inverse() * axis;
            part.body_from_shape.translation.vector.dot(&axis) + part.shape.support_extent(&inside)
        });
        parts.fold(f64::NEG_INFINITY, f64::max)
    };
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let is_box = rotation.angle() <= ROUNDING
        && matches!(&body.parts[..], [part] if matches!(part.shape, Shape::Cuboid { .. })
            && part.body_from_shape.rotation.angle() <= ROUNDING);
    Ok(Cover {
        low: Vector3::from(axes.map(|axis| -farthest(-axis))),
        high: Vector3::from(axes.map(farthest)),
        tool_from_tip: rotation,
        at: [closed.translation.vector, open.translation.vector],
        is_box,
    })
}

/// The tool frame is in the middle between the pads, and the pads face each other.
fn check_symmetry(of: ArmTables<'_>, [left, right]: &[Cover; 2]) -> Result<(), Fault> {
    let [first, second] = &of.gripper.tips;
    for at in 0..2 {
        let (inner_left, inner_right) = (left.at[at].y + left.low.y, right.at[at].y + right.high.y);
        let middle = f64::midpoint(inner_left, inner_right);
        if middle.abs() > MIDDLE_M {
            let why = format!(
                "puts the tool frame {:.1} mm beside the middle between the pads, along its y axis: fingers must move against each \
                 other, and the frame must be in their middle",
                1e3 * middle
            );
            return Err(Fault::new(of.key("tool.xyz"), why));
        }
    }
    let gaps = [0, 1].map(|at| left.at[at].y + left.low.y - right.at[at].y - right.high.y);
    if gaps[0].max(gaps[1]) <= 0.0 {
        let why = format!(
            "are `{first}` and `{second}`, which overlap by {:.1} mm along the tool's y axis however far the hand is open: the first \
             must be that on the side of +y, and y the axis along which they open",
            -1e3 * gaps[0].max(gaps[1])
        );
        return Err(Fault::new(of.key("gripper.tips"), why));
    }
    let ends = [left, right].map(|tip| tip.at[0].x + tip.high.x);
    if (ends[0] - ends[1]).abs() > ENDS_M {
        let why = format!("ends {:.1} mm before `{second}` along the tool's x axis", 1e3 * (ends[1] - ends[0]));
        return Err(Fault::new(of.key("gripper.tips"), why));
    }
    Ok(())
}
