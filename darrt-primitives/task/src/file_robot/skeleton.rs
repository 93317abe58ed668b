//! From what a robot file says of one arm to that arm.

use darrt_geom::{Body, Shape};
use darrt_primitives::kinematics::{JointLimit, KinematicTree, KinematicsError};
use nalgebra::{Isometry3, Point3};

use super::arm::{ParallelHand, PlannedArm};
use super::bases::Ring;
use super::chain::{ArmChain, Driver, Fingers, Layout, Own, Place};
use super::few_joints::FewJoints;
use super::inverse::Inverse;
use super::load::Loaded;
use super::opening::{Law, Opening};
use super::ties::ties;
use super::travel::{Carrier, Levers};
use crate::problem_file::Limits;
use crate::robot_file::error::Fault;
use crate::robot_file::{AmendedArm, ArmTables, RobotFileError};

/// What of an arm is known before its hand.
pub(super) struct Skeleton<'a> {
    tables: ArmTables<'a>,
    amended: &'a AmendedArm,
    pub(super) layout: Layout<'a>,
    /// The link of the tool frame.
    tool: usize,
    pub(super) chain: ArmChain,
    pub(super) inverse: Inverse,
    pub(super) own: Own,
}

impl Skeleton<'_> {
    pub(super) fn carrier<'a>(&'a self, limits: &'a [JointLimit], fingers: [JointLimit; 2]) -> Carrier<'a> {
        Carrier { chain: &self.chain, own: self.own, limits, fingers }
    }
}

impl Loaded {
    /// The tree as one arm sees it.
    pub(super) fn layout<'a>(tree: &'a KinematicTree, drivers: &'a [Driver], arm: &AmendedArm) -> Option<Layout<'a>> {
        let link = |name: &String| Some(tree.variables().get(tree.variable_index(name)?)?.link);
        Some(Layout { tree, drivers, arm_links: arm.joints.iter().map(link).collect::<Option<_>>()? })
    }

    /// The chain of one arm.
    pub(super) fn skeleton<'a>(
        &'a self,
        (tree, drivers): (&'a KinematicTree, &'a [Driver]),
        (tables, amended): (ArmTables<'a>, &'a AmendedArm),
        kind: Limits,
    ) -> Result<Skeleton<'a>, RobotFileError> {
        let no_layout = || self.source.located(Fault::new(tables.key("arm"), "does not fit the description"));
        let layout = Self::layout(tree, drivers, amended).ok_or_else(no_layout)?;
        let tool = tree.link_index(&amended.tool_link).ok_or_else(no_layout)?;
        let chain = layout.chain(tool).ok_or_else(no_layout)?;
        let inverse = Inverse::new(&layout, &amended.tool_link, kind);
        let inverse = inverse.map_err(|error| self.unsolvable(tables, &error))?;
        let first = &self.amended.first.joints;
        let count = amended.joints.len();
        // The chain of the inverse begins at the rail.
        if inverse.limits().len() != count {
            let why = format!(
                "names `{}`: between it and the rail is a joint that rests; let the arm begin above that joint",
                tables.arm.from
            );
            return Err(self.source.located(Fault::new(tables.key("arm.from"), why)));
        }
        let shared = amended.joints.iter().take_while(|name| first.contains(name)).count();
        let own = if shared == count { Own::first(count) } else { Own::second(shared, first.len(), count) };
        Ok(Skeleton { tables, amended, layout, tool, chain, inverse, own })
    }

    /// The inverse kinematics of an arm cannot be made.
    fn unsolvable(&self, tables: ArmTables<'_>, error: &KinematicsError) -> RobotFileError {
        self.source.located(Fault::new(tables.key("arm.to"), format!("cannot be used: {error}")))
    }

    /// The arm of a chain; `base` is where it is bolted down.
    pub(super) fn arm(
        &self,
        skeleton: Skeleton<'_>,
        tool_levers: Levers,
        bodies: &[Option<Body>],
        base: Option<[f64; 3]>,
    ) -> Result<PlannedArm, RobotFileError> {
        let hand = self.hand(&skeleton, bodies)?;
        let Skeleton { tables, chain, inverse, own, .. } = skeleton;
        let limits = inverse.limits().to_vec();
        Ok(PlannedArm {
            hand,
            tool_levers: tool_levers.of_arm(&own),
            ring: Ring::new(&chain, &limits, base),
            few: FewJoints::new(&chain, &limits).map_err(|error| self.unsolvable(tables, &error))?,
            ties: ties(&chain),
            own,
            inverse,
            limits,
            chain,
            payload_kg: tables.arm.payload_kg,
            push_force_n: tables.arm.push_force_n,
        })
    }

    /// The opening of a hand, from where the pads are.
    fn hand(&self, skeleton: &Skeleton<'_>, bodies: &[Option<Body>]) -> Result<ParallelHand, RobotFileError> {
        let Skeleton { tables, amended, layout, tool, .. } = skeleton;
        let gripper = tables.gripper;
        let refuse = |why: &str| self.source.located(Fault::new(tables.key("gripper.joint"), why));
        let lost = || refuse("does not move the tips");
        let finger = layout.tree.variable_index(&gripper.joint).ok_or_else(lost)?;
        let limit = layout.tree.variables().get(finger).ok_or_else(lost)?.limit;
        let tip = |name: &String| {
            let link = layout.tree.link_index(name)?;
            let part = bodies.get(link)?.as_ref()?.parts.first()?;
            let Shape::Cuboid { half_extents, .. } = &part.shape else { return None };
            Some((layout.place(link)?, part.body_from_shape, *half_extents))
        };
        let [Some(left), Some(right)] = amended.tip_links.each_ref().map(tip) else {
            return Err(lost());
        };
        let wrist_from_tool = layout.place(*tool).ok_or_else(lost)?.in_anchor(&[], Fingers::default());
        let centre = |(place, link_from_box, _): &(Place, Isometry3<f64>, _), q: f64| {
            wrist_from_tool.inverse() * (place.in_anchor(&[], [q; 2]) * link_from_box * Point3::origin())
        };
        let gap = |q: f64| centre(&left, q).y - left.2.y - (centre(&right, q).y + right.2.y);
        let end = |q: f64| centre(&left, q).x + left.2.x;
        let range = [limit.lower, limit.upper];
        let turns: Vec<f64> = left.0.steps.iter().map(|step| step.multiplier.abs()).collect();
        let no_law = || {
            refuse(
                "opens the pads neither in proportion to its value nor to a sine of it; such hands are not planned with",
            )
        };
        let (gap, end) = Law::of(gap, range, &turns).zip(Law::of(end, range, &turns)).ok_or_else(no_law)?;
        let opening = Opening::new(gap, end, range, gripper.max_gap_m)
            .ok_or_else(|| refuse("does not open the pads further and further, or not at all, between its limits"))?;
        Ok(ParallelHand {
            opening,
            tip_half_width_m: left.2.z,
            pad_length_m: gripper.pad_length_m.min(2.0 * left.2.x),
            grip_force_n: gripper.grip_force_n,
        })
    }
}
