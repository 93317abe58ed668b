//! The robot of a picture: its tree, its solids, and which of its links are arm and hand.

use std::sync::Arc;

use darrt_geom::Body;
use darrt_primitives::kinematics::limit::wrap_to_pi;
use darrt_primitives::kinematics::link_bodies;
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use darrt_primitives::manipulator::world_from_base;
use nalgebra::Isometry3;

use crate::plan_file::JointTable;
use crate::robot::{RobotError, RobotFacts};

/// Base and joints of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// x, y (m), yaw (rad).
    pub base: [f64; 3],
    /// By variable of the tree, rad or m.
    pub joints: Vec<f64>,
}

/// The robot.
#[derive(Debug, Clone)]
pub struct Model {
    tree: Arc<KinematicTree>,
    bodies: Arc<Vec<Option<Body>>>,
    pub(super) table: JointTable,
    /// Variables of the arms that manipulate.
    arm: Vec<usize>,
    /// By hand.
    tools: Vec<usize>,
    /// Links with a body, in the order of the tree: what stands on the base.
    pub(super) base_links: Vec<usize>,
    /// All that is neither base nor an arm that manipulates.
    pub(super) trunk_links: Vec<usize>,
    /// What only the first joint of an arm moves.
    pub(super) shoulder_links: Vec<usize>,
    pub(super) arm_links: Vec<usize>,
    pub(super) hand_links: Vec<usize>,
    /// Where joints stand at the start of the problem.
    pub(super) start: Vec<f64>,
}

/// The words of a name, between underscores, that another one has not at their ends; all of it where nothing would be left.
fn what_differs<'a>(name: &'a str, other: &str) -> &'a str {
    fn same<'a>(words: impl Iterator<Item = (&'a str, &'a str)>) -> usize {
        words.take_while(|(a, b)| a == b).map(|(a, _)| a.len() + 1).sum()
    }
    let front = same(name.split('_').zip(other.split('_')));
    let back = same(name.rsplit('_').zip(other.rsplit('_')));
    let short = name.get(front..name.len().saturating_sub(back)).filter(|short| !short.is_empty());
    short.unwrap_or(name)
}

impl Model {
    /// The robot of these facts.
    ///
    /// # Errors
    /// [`RobotError`] when its description has no tree, no such link or joint, or a shape that cannot be used.
    pub fn new(facts: &RobotFacts) -> Result<Self, RobotError> {
        let tree = KinematicTree::new(&facts.description)?;
        let bodies = link_bodies(&facts.description, &tree, &facts.meshes.paths())?;
        let missing = |what: &str, name: &str| RobotError::Key { key: "robot", why: format!("has no {what} `{name}`") };
        let variable = |name: &str| tree.variable_index(name).ok_or_else(|| missing("joint", name));
        let arm = facts.all_arm_joints().into_iter().map(variable).collect::<Result<Vec<_>, _>>()?;
        let (mut tools, mut firsts, mut lasts) = (Vec::new(), Vec::new(), Vec::new());
        for hand in 0..facts.hands() {
            let facts = facts.of_hand(hand);
            tools.push(tree.link_index(&facts.tool_link).ok_or_else(|| missing("link", &facts.tool_link))?);
            firsts.extend(facts.arm_joints.first().map(|name| variable(name)).transpose()?);
            lasts.extend(facts.arm_joints.last().map(|name| variable(name)).transpose()?);
        }
        let mut start = tree.neutral();
        for (name, value) in facts.at_rest.iter().chain(&facts.start) {
            if let Some(slot) = start.get_mut(variable(name)?) {
                *slot = *value;
            }
        }
        let above: Vec<Vec<usize>> = (0..tree.link_count()).map(|link| variables_above(&tree, link)).collect();
        let solid: Vec<usize> = (0..tree.link_count()).filter(|l| matches!(bodies.get(*l), Some(Some(_)))).collect();
        let moved_by = |wanted: &dyn Fn(&[usize]) -> bool| -> Vec<usize> {
            solid.iter().copied().filter(|link| above.get(*link).is_some_and(|above| wanted(above))).collect()
        };
        let arm_joints = |above: &[usize]| above.iter().filter(|v| arm.contains(v)).copied().collect::<Vec<_>>();
        let is_hand = |above: &[usize]| lasts.iter().any(|last| above.contains(last));
        let is_shoulder = |above: &[usize]| firsts.iter().any(|first| arm_joints(above) == [*first]) && !is_hand(above);
        Ok(Self {
            base_links: moved_by(&|above| above.is_empty()),
            trunk_links: moved_by(&|above| !above.is_empty() && arm_joints(above).is_empty()),
            shoulder_links: moved_by(&is_shoulder),
            arm_links: moved_by(&|above| !arm_joints(above).is_empty() && !is_shoulder(above) && !is_hand(above)),
            hand_links: moved_by(&is_hand),
            table: JointTable::new(&facts.description, &tree),
            tree: Arc::new(tree),
            bodies: Arc::new(bodies),
            arm,
            tools,
            start,
        })
    }

    /// Links and joints.
    pub fn tree(&self) -> &KinematicTree {
        &self.tree
    }

    /// Geometry of one link.
    pub fn body(&self, link: usize) -> Option<&Body> {
        self.bodies.get(link).and_then(Option::as_ref)
    }

    /// World pose of every link of the tree.
    pub fn link_poses(&self, pose: &Pose) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.tree.link_count()];
        // A pose that was read from a plan has as many joints as the tree.
        let written = self.tree.forward(&pose.joints, &world_from_base(&pose.base), &mut poses);
        debug_assert!(written.is_ok(), "{written:?}");
        poses
    }

    /// Pose of the tool frame of a hand, counted from 0, in the world.
    pub fn world_from_tool(&self, pose: &Pose, hand: usize) -> Isometry3<f64> {
        let tool = self.tools.get(hand).copied().unwrap_or_default();
        self.link_poses(pose).get(tool).copied().unwrap_or_else(Isometry3::identity)
    }

    /// The name of the link of that frame, where there is more than one: as much of it as tells it from the others.
    pub(super) fn tool_name(&self, hand: usize) -> Option<&str> {
        let name = |hand: usize| self.tree.link_names().get(*self.tools.get(hand)?).map(|name| &**name);
        let others = (0..self.tools.len()).filter(|other| *other != hand).filter_map(name);
        others.map(|other| Some(what_differs(name(hand)?, other))).next()?
    }

    /// How far the joints of the arms turn between two poses, summed; a continuous joint goes the short way round.
    pub(super) fn arm_turns(&self, from: &Pose, to: &Pose) -> f64 {
        let turn = |variable: &usize| {
            let (a, b) = (from.joints.get(*variable)?, to.joints.get(*variable)?);
            let is_continuous = self.tree.variables().get(*variable)?.limit.is_unlimited();
            Some(if is_continuous { wrap_to_pi(b - a) } else { b - a }.abs())
        };
        self.arm.iter().filter_map(turn).sum()
    }
}

/// The variables that move a link, from the link upwards.
fn variables_above(tree: &KinematicTree, mut link: usize) -> Vec<usize> {
    let mut found = Vec::new();
    loop {
        if let Some(LinkMotion::Turning { drive, .. } | LinkMotion::Sliding { drive, .. }) = tree.motion(link) {
            found.push(drive.variable);
        }
        match tree.parent(link) {
            Some(parent) if parent < link => link = parent,
            _ => return found,
        }
    }
}
