//! The robot as the verifier sees it: the tree of the description, its boxes one by one, its limits.
//!
//! Nothing here goes through the planner's model: poses come from the general tree, geometry from the description.

use std::sync::Arc;

use darrt_primitives::kinematics::tree::{Drive, KinematicTree, LinkMotion};
use darrt_primitives::kinematics::{JointLimit, link_bodies};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::refusal::{Refusal, RefusalKind};
use super::solid::Solid;
use crate::plan_file::JointTable;
use crate::robot::RobotFacts;

/// One solid of one link.
#[derive(Debug)]
pub(super) struct LinkSolid {
    pub(super) link: usize,
    pub(super) link_from_solid: Isometry3<f64>,
    pub(super) solid: Solid,
}

/// What all hands of a robot share.
#[derive(Debug)]
pub(super) struct Frame {
    tree: Arc<KinematicTree>,
    table: Arc<JointTable>,
    solids: Arc<Vec<LinkSolid>>,
    self_pairs: Arc<Vec<(usize, usize)>>,
    /// By variable: may a step move it, whichever hand is at work?
    is_planned: Vec<bool>,
    arm_links: Arc<Vec<usize>>,
    standing: Arc<Vec<Option<Isometry3<f64>>>>,
}

/// What may move a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// One of the joints of the arms that are planned.
    Arm,
    /// The finger joint of the manipulating hand.
    Finger,
    /// Torso, head, parked arm, fingers of a hand that is not at work: stands still.
    Parked,
}

/// The robot with one of its hands at work, the manipulating hand.
#[derive(Debug)]
pub(super) struct Robot {
    /// Which of its hands that is, from 0.
    pub(super) which: usize,
    pub(super) tree: Arc<KinematicTree>,
    pub(super) table: Arc<JointTable>,
    pub(super) solids: Arc<Vec<LinkSolid>>,
    /// Indices into `solids`.
    pub(super) self_pairs: Arc<Vec<(usize, usize)>>,
    /// By variable.
    pub(super) roles: Vec<Role>,
    /// By variable: does it move this hand?
    pub(super) is_own: Vec<bool>,
    /// By variable.
    pub(super) limits: Vec<JointLimit>,
    pub(super) tool: usize,
    /// Links of the manipulating hand that may touch things.
    pub(super) fingers: Vec<usize>,
    /// Those whose inner faces are the pads, that on the side of +y first.
    pub(super) tips: [usize; 2],
    /// Links of the manipulating hand: all that moves with the arm's last joint, in ascending order.
    pub(super) hand: Vec<usize>,
    /// The variable that opens the manipulating hand.
    pub(super) finger_joint: usize,
    /// By how much the gap between the tips grows per unit of that variable, metres; negative in a hand that closes as it grows.
    pub(super) gap_rate: f64,
    /// The base never moves.
    pub(super) is_bolted: bool,
    /// It moves along its heading only, and turns on the spot.
    pub(super) drives_along_heading: bool,
    /// Links that move with the arms that are planned or their fingers, in ascending order.
    arm_links: Arc<Vec<usize>>,
    /// By link: its pose in the frame of the robot's root, if it stands there whatever is planned.
    standing: Arc<Vec<Option<Isometry3<f64>>>>,
    pub(super) strength: Strength,
}

/// What hand and arm bear.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strength {
    /// Length of a pad from the tip back, metres.
    pub(super) pad_length_m: f64,
    /// Force of each finger on what it holds, newton.
    pub(super) grip_force_n: f64,
    /// The heaviest object that the arm carries, kilograms.
    pub(super) payload_kg: f64,
    /// The largest force with which the hand pushes sideways, newton.
    pub(super) push_force_n: f64,
}

fn refuse(error: &dyn std::fmt::Display) -> Refusal {
    Refusal::whole(RefusalKind::Problem, format!("the robot of the problem cannot be built: {error}"))
}

fn variable(tree: &KinematicTree, name: &str) -> Result<usize, Refusal> {
    tree.variable_index(name).ok_or_else(|| refuse(&format!("it has no joint `{name}`")))
}

impl Frame {
    pub(super) fn new(facts: &RobotFacts) -> Result<Self, Refusal> {
        let description = &*facts.description;
        let tree = KinematicTree::new(description).map_err(|e| refuse(&e))?;
        let bodies = link_bodies(description, &tree, &facts.meshes.paths()).map_err(|e| refuse(&e))?;
        let mut solids = Vec::new();
        for (link, body) in bodies.iter().enumerate() {
            for part in body.iter().flat_map(|body| &body.parts) {
                let name = tree.link_names().get(link).cloned().unwrap_or_else(|| Arc::from("link"));
                let solid = Solid::new(&name, part.shape.clone()).map_err(|e| refuse(&e))?;
                solids.push(LinkSolid { link, link_from_solid: part.body_from_shape, solid });
            }
        }
        let mut is_planned = vec![false; tree.variables().len()];
        for name in facts.all_arm_joints().into_iter().chain(facts.finger_joints()) {
            is_planned[variable(&tree, name)?] = true;
        }
        let self_pairs = self_pairs(&tree, &solids, &facts.self_pairs);
        let table = JointTable::new(description, &tree);
        let arm_links = links_moved(&tree, |variable| is_planned.get(variable) == Some(&true));
        let standing = standing(&tree, &is_planned, facts);
        Ok(Self {
            tree: Arc::new(tree),
            table: Arc::new(table),
            solids: Arc::new(solids),
            self_pairs: Arc::new(self_pairs),
            is_planned,
            arm_links: Arc::new(arm_links),
            standing: Arc::new(standing),
        })
    }
}

impl Robot {
    /// The robot with this hand at work, counted from 0.
    pub(super) fn new(frame: &Frame, facts: &RobotFacts, which: usize) -> Result<Self, Refusal> {
        let Frame { tree, table, solids, self_pairs, is_planned, arm_links, standing } = frame;
        let arms = facts.all_arm_joints();
        let facts = facts.of_hand(which);
        let link = |name: &String| tree.link_index(name).ok_or_else(|| refuse(&format!("it has no link `{name}`")));
        let fingers = facts.finger_links.iter().map(link).collect::<Result<Vec<_>, _>>()?;
        let tips = [link(&facts.tip_links[0])?, link(&facts.tip_links[1])?];
        let tool = link(&facts.tool_link)?;
        let finger_joint = variable(tree, &facts.finger_joint)?;
        let mut roles = vec![Role::Parked; is_planned.len()];
        for name in arms {
            roles[variable(tree, name)?] = Role::Arm;
        }
        roles[finger_joint] = Role::Finger;
        let mut is_own = vec![false; is_planned.len()];
        for name in &facts.arm_joints {
            is_own[variable(tree, name)?] = true;
        }
        let limits = tree.variables().iter().zip(&roles).map(|(variable, role)| {
            // What stands still was put there by the problem, which may use the whole range.
            let is_soft = *role == Role::Arm && facts.is_limited_softly;
            if is_soft { variable.soft_limit } else { variable.limit }
        });
        let limits = limits.collect();
        let wrist = facts.arm_joints.last().ok_or_else(|| refuse(&"its arm has no joints"))?;
        let wrist = variable(tree, wrist)?;
        let hand = links_moved(tree, |variable| variable == wrist);
        let gap_rate = gap_rate(tree, solids, tool, tips, finger_joint);
        let strength = Strength {
            pad_length_m: facts.pad_length_m,
            grip_force_n: facts.grip_force_n,
            payload_kg: facts.payload_kg,
            push_force_n: facts.push_force_n,
        };
        Ok(Self {
            which,
            tree: Arc::clone(tree),
            table: Arc::clone(table),
            solids: Arc::clone(solids),
            self_pairs: Arc::clone(self_pairs),
            roles,
            is_own,
            limits,
            tool,
            fingers,
            tips,
            hand,
            finger_joint,
            gap_rate,
            is_bolted: facts.is_bolted,
            drives_along_heading: facts.drives_along_heading,
            arm_links: Arc::clone(arm_links),
            standing: Arc::clone(standing),
            strength,
        })
    }

    /// Name of the link whose frame is the tool frame.
    pub(super) fn tool_name(&self) -> &str {
        self.tree.link_names().get(self.tool).map_or("tool", |name| name)
    }

    /// Name of a variable's joint.
    pub(super) fn joint_name(&self, variable: usize) -> &str {
        self.tree.variables().get(variable).map_or("joint", |v| &v.name)
    }

    /// Whether a variable turns without end.
    pub(super) fn is_continuous(&self, variable: usize) -> bool {
        self.tree.variables().get(variable).is_some_and(|v| v.limit.is_unlimited())
    }

    /// The link of the manipulating hand's finger or tip called `name`.
    pub(super) fn is_finger(&self, name: &str) -> bool {
        self.fingers.iter().any(|link| self.tree.link_names().get(*link).is_some_and(|n| &**n == name))
    }

    /// Indices of the solids of a link.
    pub(super) fn solids_of(&self, link: usize) -> impl Iterator<Item = usize> + '_ {
        self.solids.iter().enumerate().filter(move |(_, solid)| solid.link == link).map(|(index, _)| index)
    }

    /// The height of the lowest point of a solid that nothing moves but the base, above the robot's root: it keeps it while the base
    /// drives. `None` for a solid that a joint moves, or that a joint carries of which the problem does not say where it stands.
    pub(super) fn lowest_m(&self, solid: usize) -> Option<f64> {
        let LinkSolid { link, link_from_solid, solid } = self.solids.get(solid)?;
        let root_from_solid = self.standing.get(*link)?.as_ref()? * link_from_solid;
        let down = root_from_solid.rotation.inverse() * -Vector3::z();
        Some(root_from_solid.translation.z - solid.shape()?.support_extent(&down))
    }

    /// Writes the pose of every link in the frame of the robot's root.
    pub(super) fn link_poses(&self, joints: &[f64], out: &mut Vec<Isometry3<f64>>) {
        out.resize(self.tree.link_count(), Isometry3::identity());
        // Both slices have the tree's own lengths.
        let written = self.tree.forward(joints, &Isometry3::identity(), out);
        debug_assert!(written.is_ok(), "{written:?}");
    }

    /// [`Robot::link_poses`] when since the last call only the arm and the fingers have moved.
    pub(super) fn arm_link_poses(&self, joints: &[f64], out: &mut [Isometry3<f64>]) {
        let written = self.tree.forward_only(joints, &self.arm_links, out);
        debug_assert!(written.is_ok(), "{written:?}");
    }

    /// How far the robot, with something that reaches `held_m` beyond the tool frame, extends from each link's origin.
    pub(super) fn extents(&self, held_m: f64) -> Vec<f64> {
        let count = self.tree.link_count();
        let mut extents = vec![0.0_f64; count];
        for solid in &*self.solids {
            let reach = solid.link_from_solid.translation.vector.norm() + solid.solid.reach();
            extents[solid.link] = extents[solid.link].max(reach);
        }
        extents[self.tool] = extents[self.tool].max(held_m);
        // Children come after their parents.
        for link in (1..count).rev() {
            let offset = self.tree.parent_from_link(link).map_or(0.0, |pose| pose.translation.vector.norm());
            let slide = match self.tree.motion(link) {
                Some(LinkMotion::Sliding { drive, .. }) => self.farthest(drive),
                _ => 0.0,
            };
            if let Some(parent) = self.tree.parent(link) {
                extents[parent] = extents[parent].max(offset + slide + extents[link]);
            }
        }
        extents
    }

    /// Largest displacement of a sliding joint.
    fn farthest(&self, drive: &Drive) -> f64 {
        let limit = self.tree.variables().get(drive.variable).map_or(JointLimit::UNLIMITED, |v| v.limit);
        let at = |value: f64| (drive.multiplier * value + drive.offset).abs();
        at(limit.lower).max(at(limit.upper)).min(1e3)
    }

    /// Bound on the metres that any point travels per unit of each variable, and per radian of base yaw (last).
    /// `extents`: see [`Robot::extents`].
    pub(super) fn travel_rates(&self, extents: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; self.tree.variables().len() + 1];
        for (link, extent) in extents.iter().enumerate() {
            match self.tree.motion(link) {
                Some(LinkMotion::Turning { drive, .. }) => rates[drive.variable] += drive.multiplier.abs() * extent,
                Some(LinkMotion::Sliding { drive, .. }) => rates[drive.variable] += drive.multiplier.abs(),
                _ => {}
            }
        }
        if let (Some(last), Some(root)) = (rates.last_mut(), extents.first()) {
            *last = *root;
        }
        rates
    }
}

/// By how much the distance of the tips along the tool's y axis grows per unit of the finger joint, over its whole range.
fn gap_rate(tree: &KinematicTree, solids: &[LinkSolid], tool: usize, tips: [usize; 2], finger: usize) -> f64 {
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    let mut width_at = |value: f64| {
        let mut values = tree.neutral();
        if let Some(slot) = values.get_mut(finger) {
            *slot = value;
        }
        let written = tree.forward(&values, &Isometry3::identity(), &mut poses);
        debug_assert!(written.is_ok(), "{written:?}");
        let [left, right] = tips.map(|tip| {
            let solid = solids.iter().find(|solid| solid.link == tip);
            let link_from_solid = solid.map_or(Isometry3::identity(), |solid| solid.link_from_solid);
            (poses[tool].inverse() * poses[tip] * link_from_solid).translation.y
        });
        left - right
    };
    let Some(limit) = tree.variables().get(finger).map(|variable| variable.limit) else { return 0.0 };
    (width_at(limit.upper) - width_at(limit.lower)) / (limit.upper - limit.lower)
}

/// The links that one of these variables moves, in ascending order.
fn links_moved(tree: &KinematicTree, moves: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut is_moved = vec![false; tree.link_count()];
    for link in 1..is_moved.len() {
        let drive = match tree.motion(link) {
            Some(LinkMotion::Turning { drive, .. } | LinkMotion::Sliding { drive, .. }) => Some(drive),
            _ => None,
        };
        let own = drive.is_some_and(|drive| moves(drive.variable));
        is_moved[link] = own || tree.parent(link).is_some_and(|parent| is_moved[parent]);
    }
    is_moved.iter().enumerate().filter(|(_, is_moved)| **is_moved).map(|(link, _)| link).collect()
}

/// The poses, in the frame of the root, of the links that stand there: no joint is above them but parked ones that the problem puts
/// somewhere. By link.
fn standing(tree: &KinematicTree, is_planned: &[bool], facts: &RobotFacts) -> Vec<Option<Isometry3<f64>>> {
    let mut values = tree.neutral();
    let mut is_put = vec![false; values.len()];
    for (name, value) in &facts.start {
        let parked = tree.variable_index(name).filter(|variable| is_planned.get(*variable) == Some(&false));
        if let Some((slot, put)) = parked.and_then(|v| Some((values.get_mut(v)?, is_put.get_mut(v)?))) {
            (*slot, *put) = (*value, true);
        }
    }
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    if tree.forward(&values, &Isometry3::identity(), &mut poses).is_err() {
        return vec![None; poses.len()];
    }
    let moved = links_moved(tree, |variable| is_put.get(variable) != Some(&true));
    poses.into_iter().enumerate().map(|(link, pose)| (!moved.contains(&link)).then_some(pose)).collect()
}

/// Where a base at x, y and yaw has the robot's root.
pub(super) fn world_from_robot(base: &[f64; 3]) -> Isometry3<f64> {
    let [x, y, yaw] = *base;
    Isometry3::from_parts(Translation3::new(x, y, 0.0), UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw))
}

/// Pairs of solids of links that can meet while the arm moves.
fn self_pairs(tree: &KinematicTree, solids: &[LinkSolid], links: &[[String; 2]]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for [moving, other] in links {
        let (Some(moving), Some(other)) = (tree.link_index(moving), tree.link_index(other)) else {
            continue;
        };
        let of = |link: usize| (0..).zip(solids).filter(move |(_, solid)| solid.link == link).map(|(i, _)| i);
        pairs.extend(of(moving).flat_map(|a: usize| of(other).map(move |b: usize| (a, b))));
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::builtin;
    use crate::verify::hands::Hands;
    use rand::{RngExt as _, SeedableRng as _};

    #[test]
    fn no_solid_travels_farther_than_the_rates_say() {
        let robot = Hands::new(&crate::testing::facts(&builtin("plate1").unwrap())).unwrap().first;
        let rates = robot.travel_rates(&robot.extents(0.0));
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(9);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for _ in 0..200 {
            let values: Vec<f64> =
                robot.limits.iter().map(|l| rng.random_range(l.lower.max(-3.0)..l.upper.min(3.0))).collect();
            let moved: Vec<f64> = values.iter().map(|v| v + rng.random_range(-0.05..0.05)).collect();
            robot.link_poses(&values, &mut before);
            robot.link_poses(&moved, &mut after);
            for pose in &mut after {
                *pose = world_from_robot(&[0.1, 0.0, 0.02]) * *pose;
            }
            let bound = 0.1
                + 0.02 * rates[values.len()]
                + values.iter().zip(&moved).zip(&rates).map(|((a, b), r)| (a - b).abs() * r).sum::<f64>();
            for solid in &*robot.solids {
                let (low, high) = solid.solid.shape().unwrap().local_aabb();
                for corner in [low, high] {
                    let p = solid.link_from_solid * corner;
                    let travel = (after[solid.link] * p - before[solid.link] * p).norm();
                    assert!(travel <= bound, "{}: {travel} > {bound}", solid.solid.name());
                }
            }
        }
    }

    #[test]
    fn the_links_of_the_arm_are_all_that_an_arm_moves() {
        let robot = Hands::new(&crate::testing::facts(&builtin("plate1").unwrap())).unwrap().first;
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(10);
        let (mut now, mut anew) = (Vec::new(), Vec::new());
        let mut values: Vec<f64> = robot.limits.iter().map(|limit| limit.clamp(0.0)).collect();
        robot.link_poses(&values, &mut now);
        for _ in 0..100 {
            let own =
                values.iter_mut().zip(&robot.roles).zip(&robot.limits).filter(|((_, role), _)| **role != Role::Parked);
            own.for_each(|((value, _), limit)| *value = rng.random_range(limit.lower.max(-3.0)..limit.upper.min(3.0)));
            robot.arm_link_poses(&values, &mut now);
            robot.link_poses(&values, &mut anew);
            assert_eq!(now, anew);
        }
        let of_arm = robot.arm_links.len();
        let others = robot.tree.link_count() - of_arm;
        assert!(of_arm > 10 && others > 10, "{of_arm} of the arm, {others} others");
    }

    #[test]
    fn only_one_arm_and_one_finger_joint_may_move() {
        let robot = Hands::new(&crate::testing::facts(&builtin("plate1").unwrap())).unwrap().first;
        let count = |role| robot.roles.iter().filter(|r| **r == role).count();
        assert_eq!((count(Role::Arm), count(Role::Finger)), (7, 1));
        assert!(robot.is_finger("r_gripper_l_finger_tip_link") && !robot.is_finger("l_gripper_l_finger_tip_link"));
        assert!(!robot.is_finger("r_gripper_palm_link"));
        let palm = robot.tree.link_index("r_gripper_palm_link").unwrap();
        let forearm = robot.tree.link_index("r_forearm_link").unwrap();
        assert!(robot.hand.contains(&palm) && robot.fingers.iter().all(|finger| robot.hand.contains(finger)));
        assert!(!robot.hand.contains(&forearm));
        assert!(robot.self_pairs.len() > 100);
    }
}
