//! The robot: its links as solids, and its hand as a table of where the fingers are at which opening.

use darrt_primitives::kinematics::link_bodies;
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use darrt_task::robot::RobotFacts;
use nalgebra::Isometry3;
use rapier3d_f64::prelude::Pose;

use crate::error::ExecuteError;
use crate::solids::{self, Piece};

/// Openings of the hand that are computed; those between are interpolated.
const OPENINGS: u32 = 65;

/// A robot ready to be put into a world.
#[derive(Debug)]
pub(crate) struct Robot {
    pub(crate) tree: KinematicTree,
    /// By link.
    pub(crate) pieces: Vec<Vec<Piece>>,
    /// The variables of the arm.
    pub(crate) arm: Vec<usize>,
    pub(crate) finger: usize,
    pub(crate) tool: usize,
    pub(crate) tips: [usize; 2],
    /// How far the fingertips reach beyond the tool frame, out of the hand, m.
    pub(crate) reach_beyond_tool_m: f64,
    /// By link: does no joint move it?
    pub(crate) is_base: Vec<bool>,
    pub(crate) hand: Hand,
    pub(crate) grip_force_n: f64,
    pub(crate) push_force_n: f64,
}

/// Where the tips are, by opening.
#[derive(Debug)]
pub(crate) struct Hand {
    openings: Vec<Opening>,
    /// The links that are rigid to the tool or move with the fingers.
    pub(crate) links: Vec<usize>,
    /// The links with solids between hand and tips: on the way to which tip, and the link.
    pub(crate) between: Vec<(usize, usize)>,
}

/// The hand at one value of its finger joint.
#[derive(Debug, Clone)]
pub(crate) struct Opening {
    pub(crate) joint: f64,
    pub(crate) tool_from_tip: [Isometry3<f64>; 2],
    /// By link of [`Hand::between`].
    tool_from_between: Vec<Isometry3<f64>>,
}

impl Opening {
    /// How far the tips are from the middle of the hand, on average, metres.
    pub(crate) fn half_width(&self) -> f64 {
        let [a, b] = &self.tool_from_tip;
        (a.translation.y - b.translation.y) / 2.0
    }

    /// A link of [`Hand::between`] in the frame of the tip.
    pub(crate) fn tip_from_between(&self, index: usize, tip: usize) -> Pose {
        let tool_from_link = self.tool_from_between.get(index).copied().unwrap_or_else(Isometry3::identity);
        (self.tool_from_tip[tip].inverse() * tool_from_link).into()
    }
}

impl Robot {
    pub(crate) fn new(facts: &RobotFacts) -> Result<Self, ExecuteError> {
        let description = &*facts.description;
        let tree = KinematicTree::new(description)?;
        let bodies = link_bodies(description, &tree, &facts.meshes.paths())?;
        let part = |body: &darrt_geom::Body| {
            let parts = body.parts.iter();
            parts.map(|part| solids::of_part(&body.name, &part.shape, &part.body_from_shape)).collect()
        };
        let pieces: Vec<Vec<Piece>> =
            bodies.iter().map(|body| body.as_ref().map_or(Ok(Vec::new()), part)).collect::<Result<_, _>>()?;
        let missing = |what, name: &str| ExecuteError::NoSuchPart { what, name: name.to_owned() };
        let link = |name: &str| tree.link_index(name).ok_or_else(|| missing("link", name));
        let variable = |name: &str| tree.variable_index(name).ok_or_else(|| missing("joint", name));
        let tips = [link(&facts.tip_links[0])?, link(&facts.tip_links[1])?];
        let (tool, finger) = (link(&facts.tool_link)?, variable(&facts.finger_joint)?);
        let arm = facts.arm_joints.iter().map(|name| variable(name)).collect::<Result<_, _>>()?;
        let mut is_base = vec![true; tree.link_count()];
        for at in 1..tree.link_count() {
            let moves = !matches!(tree.motion(at), None | Some(LinkMotion::Fixed));
            let parent = tree.parent(at).and_then(|parent| is_base.get(parent).copied()).unwrap_or(true);
            if let Some(slot) = is_base.get_mut(at) {
                *slot = parent && !moves;
            }
        }
        let between = between(&tree, &pieces, tool, tips);
        let hand = Hand::new(&tree, finger, tool, tips, between)?;
        let tip_pieces = pieces.get(tips[0]).into_iter().flatten();
        let tool_from_tip = hand.at_joint(hand.closed()).tool_from_tip[0];
        let reach = tip_pieces.map(|piece| {
            let at = Pose::from(tool_from_tip) * piece.body_from_piece;
            piece.shape.compute_aabb(&at).maxs.x
        });
        let reach_beyond_tool_m = reach.fold(0.0, f64::max);
        Ok(Self {
            tree,
            pieces,
            arm,
            finger,
            tool,
            tips,
            reach_beyond_tool_m,
            is_base,
            hand,
            grip_force_n: facts.grip_force_n,
            push_force_n: facts.push_force_n,
        })
    }

    /// Writes where the links are in the world.
    pub(crate) fn link_poses(&self, base: &Isometry3<f64>, joints: &[f64], out: &mut Vec<Isometry3<f64>>) {
        out.resize(self.tree.link_count(), Isometry3::identity());
        // Both slices have the tree's own lengths.
        let written = self.tree.forward(joints, base, out);
        debug_assert!(written.is_ok(), "{written:?}");
    }
}

impl Hand {
    fn new(
        tree: &KinematicTree,
        finger: usize,
        tool: usize,
        tips: [usize; 2],
        between: Vec<(usize, usize)>,
    ) -> Result<Self, ExecuteError> {
        let limit = tree.variables().get(finger).map(|variable| variable.limit);
        let Some(limit) = limit.filter(|limit| limit.lower.is_finite() && limit.upper.is_finite()) else {
            return Err(ExecuteError::Hand("its finger joint has no limits".to_owned()));
        };
        let mut joints = tree.neutral();
        let mut links = vec![Isometry3::identity(); tree.link_count()];
        let mut opening = |index: u32| {
            let joint = limit.lower + (limit.upper - limit.lower) * f64::from(index) / f64::from(OPENINGS - 1);
            if let Some(slot) = joints.get_mut(finger) {
                *slot = joint;
            }
            let _ = tree.forward(&joints, &Isometry3::identity(), &mut links);
            let at = |link: usize| links.get(link).copied().unwrap_or_else(Isometry3::identity);
            let tool_from_world = at(tool).inverse();
            Opening {
                joint,
                tool_from_tip: tips.map(|tip| tool_from_world * at(tip)),
                tool_from_between: between.iter().map(|(_, link)| tool_from_world * at(*link)).collect(),
            }
        };
        let openings: Vec<Opening> = (0..OPENINGS).map(&mut opening).collect();
        if openings.windows(2).any(|pair| matches!(pair, [a, b] if b.half_width() <= a.half_width())) {
            return Err(ExecuteError::Hand("its tips do not part as its finger joint grows".to_owned()));
        }
        Ok(Self { openings, links: hand_links(tree, finger, tool), between })
    }

    /// The closed hand.
    pub(crate) fn closed(&self) -> f64 {
        self.openings.first().map_or(0.0, |opening| opening.joint)
    }

    /// The hand at a value of its joint; outside its limits, at them.
    pub(crate) fn at_joint(&self, joint: f64) -> Opening {
        self.at(joint, |opening| opening.joint)
    }

    /// The hand whose tips are so far from its middle.
    pub(crate) fn at_half_width(&self, half_width_m: f64) -> Opening {
        self.at(half_width_m, Opening::half_width)
    }

    fn at(&self, value: f64, key: impl Fn(&Opening) -> f64) -> Opening {
        let above = self.openings.partition_point(|opening| key(opening) < value).clamp(1, self.openings.len() - 1);
        let pair = self.openings.get(above - 1..=above);
        let Some([low, high]) = pair else {
            // There are always two.
            return Opening { joint: 0.0, tool_from_tip: [Isometry3::identity(); 2], tool_from_between: Vec::new() };
        };
        let part = ((value - key(low)) / (key(high) - key(low))).clamp(0.0, 1.0);
        let tip = |index: usize| low.tool_from_tip[index].lerp_slerp(&high.tool_from_tip[index], part);
        let between = low.tool_from_between.iter().zip(&high.tool_from_between);
        Opening {
            joint: low.joint + part * (high.joint - low.joint),
            tool_from_tip: [tip(0), tip(1)],
            tool_from_between: between.map(|(low, high)| low.lerp_slerp(high, part)).collect(),
        }
    }
}

/// All that moves with the hand: links that only fixed joints and those of the fingers part from the tool.
fn hand_links(tree: &KinematicTree, finger: usize, tool: usize) -> Vec<usize> {
    let is_own = |link: usize| match tree.motion(link) {
        Some(LinkMotion::Turning { drive, .. } | LinkMotion::Sliding { drive, .. }) => drive.variable == finger,
        Some(LinkMotion::Fixed) => true,
        None => false,
    };
    let mut root = tool;
    while root > 0 && is_own(root) {
        root = tree.parent(root).unwrap_or(0);
    }
    let mut is_hand = vec![false; tree.link_count()];
    for link in root..tree.link_count() {
        let is_below = link > 0 && is_own(link) && tree.parent(link).is_some_and(|parent| is_hand[parent]);
        is_hand[link] = link == root || is_below;
    }
    (0..tree.link_count()).filter(|link| is_hand[*link]).collect()
}

/// The links above the tips that the hand itself is not on: with solids, and below the last one that tool and tip share.
fn between(tree: &KinematicTree, pieces: &[Vec<Piece>], tool: usize, tips: [usize; 2]) -> Vec<(usize, usize)> {
    let above = |link: usize| std::iter::successors(tree.parent(link), |link| tree.parent(*link));
    let mut found = Vec::new();
    for (index, tip) in tips.into_iter().enumerate() {
        let own = above(tip).take_while(|link| *link != tool && !above(tool).any(|shared| shared == *link));
        found.extend(own.filter(|link| pieces.get(*link).is_some_and(|own| !own.is_empty())).map(|link| (index, link)));
    }
    found
}
