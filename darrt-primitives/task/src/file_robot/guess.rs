//! A first robot file for a description: what can be guessed, with comments that say what to look at.

use std::path::{Path, PathBuf};

use darrt_primitives::joints::MAX_JOINTS;
use darrt_primitives::kinematics::srdf::{VirtualJoint, VirtualKind};
use darrt_primitives::kinematics::tree::LinkMotion;
use darrt_primitives::kinematics::urdf::{JointDescription, JointKind};
use darrt_primitives::kinematics::{KinematicTree, MeshPlaces, RobotDescription, link_bodies};
use nalgebra::Isometry3;

use super::FileRobot;
use super::load::Loaded;
use super::semantic::Semantic;
use crate::robot_file::{RobotFileError, Source};

mod hand;
mod posture;
mod rest;
mod text;
mod wheels;
mod wrist;

use hand::HandGuess;
use text::{Guess, State};

/// So many joints an arm is guessed to have at most: what is further in is a lift or a waist, and rests.
const MOST_ARM_JOINTS: usize = 7;
/// HEURISTIC: an arm that comes without a body and has its shoulder lower than this, metres, stands on something; then its shoulder
/// is so high, a little above a table.
const LOW_SHOULDER_M: f64 = 0.5;
const SHOULDER_M: f64 = 0.8;
/// The vertical part of the direction of a lift is larger.
const UPRIGHT: f64 = 0.95;
/// A group of an SRDF that has so many is an arm.
const ARM_JOINTS: std::ops::RangeInclusive<usize> = 6..=MAX_JOINTS;

/// What a person says besides the description.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Folders of packages by name, for meshes called `package://NAME/...`.
    pub packages: Vec<(String, PathBuf)>,
}

/// The text of a robot file for the description at `urdf`, to be written into the folder `beside`.
///
/// # Errors
/// [`RobotFileError`] for a description that cannot be read, or in which there is nothing like an arm.
pub fn robot_file(urdf: &Path, beside: &Path, known: &Known) -> Result<String, RobotFileError> {
    let name = urdf.display().to_string();
    let wrong = |source| RobotFileError::Description { file: name.clone(), source };
    let description = RobotDescription::from_file(urdf).map_err(wrong)?;
    let mut places = MeshPlaces::around(urdf);
    known.packages.iter().for_each(|(name, path)| places.add_package(name, path));
    let refuse = |why: &str| RobotFileError::Invalid {
        file: name.clone(),
        line: 1,
        key: "robot".to_owned(),
        why: why.to_owned(),
    };
    let (semantic, unread) = Semantic::beside(urdf, &description);
    let tree = KinematicTree::new(&description).map_err(wrong)?;
    let bodies = link_bodies(&description, &tree, &places.paths()).map_err(wrong)?;
    let hand = match hand::guess(&tree, &bodies) {
        Some(hand) => hand,
        // An arm that takes a hand to any pose comes before one that does not.
        None => match (wrist::hand(&tree, &bodies), hand::guess_few(&tree, &bodies)) {
            (Ok(hand), _) | (Err(_), Some(hand)) => hand,
            (Err(why), None) => return Err(refuse(&hand::on_a_short_arm(&tree, &bodies).unwrap_or(why))),
        },
    };
    let shapeless = description.links.iter().filter(|link| link.has_visual && link.collision.is_empty());
    let arm = arm(&description, &hand, semantic.as_ref())
        .ok_or_else(|| refuse("has no joint between its root and its hand"))?;
    let mut mine = arm.joints.clone();
    mine.extend(std::iter::once(hand.joint.clone()).chain(hand.follow.iter().map(|(name, _)| name.clone())));
    let lifts = lifts(&description, &tree, &arm);
    let rest = rest::limbs((&description, &tree), &bodies, &mine, &lifts, semantic.as_ref());
    let states = semantic.iter().flat_map(|semantic| semantic.states(&description, &arm.joints));
    let limits =
        |name: &String| description.joints.iter().find(|joint| *joint.name == **name).map(|joint| joint.soft_limit);
    let limits: Vec<_> = arm.joints.iter().filter_map(limits).collect();
    let states = states.map(|(name, values)| {
        let is_within = values.iter().zip(&limits).all(|(value, limit)| limit.contains(*value));
        State { name: name.to_owned(), values, is_within }
    });
    let states = states.collect();
    // Read with all joints where they are nearest to 0, it tells which postures are of use.
    let home = arm.joints.iter().filter_map(|name| {
        let joint = description.joints.iter().find(|joint| *joint.name == **name)?;
        Some(joint.soft_limit.clamp(0.0))
    });
    let guess = Guess {
        name: file_name(&description, urdf),
        urdf: seen_from(urdf, beside),
        srdf: semantic.as_ref().map(|semantic| seen_from(&semantic.path, beside)),
        packages: known.packages.iter().map(|(name, path)| (name.clone(), seen_from(path, beside))).collect(),
        shapeless: shapeless.map(|link| link.name.to_string()).collect(),
        unread,
        base: semantic.as_ref().and_then(base_kind).unwrap_or_else(|| wheels::base_kind(&tree, &bodies, &mine)),
        home: home.collect(),
        hand_down: None,
        arm,
        hand,
        rest,
        lifts,
        states,
        base_z: 0.0,
        pedestal: false,
        ignore: Vec::new(),
    };
    let sources = Sources { urdf, srdf: semantic.map(|semantic| semantic.path), packages: &known.packages };
    // What cannot be read is written all the same: `darrt robot check` says what is wrong with it.
    let Ok(robot) = sources.loaded(&guess).and_then(|loaded| loaded.robot_anywhere()) else { return Ok(guess.text()) };
    let (base_z, pedestal) = raised_m(&robot, &guess, &description);
    let guess = Guess { base_z, pedestal, ..guess };
    let posture::Found { hand_down, drawn_in, ignore } = posture::search(&sources.loaded(&guess)?)?;
    let home = drawn_in.or_else(|| hand_down.clone()).unwrap_or_else(|| guess.home.clone());
    let hand_down = hand_down.filter(|hand_down| *hand_down != home);
    Ok(Guess { home, hand_down, ignore, ..guess }.text())
}

/// The joints that lift the arm, upright, each halfway up, metres: at its lower end an arm reaches no table well.
fn lifts(description: &RobotDescription, tree: &KinematicTree, arm: &ArmGuess) -> Vec<(String, f64)> {
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    // The values are the tree's own, so there are as many as it wants.
    let _ = tree.forward(&tree.neutral(), &Isometry3::identity(), &mut poses);
    let mut at = tree.link_index(&arm.from);
    let mut found = Vec::new();
    while let Some(link) = at {
        if let Some(LinkMotion::Sliding { axis, .. }) = tree.motion(link)
            && let Some(joint) = description.joints.iter().find(|joint| {
                tree.link_names().get(link).is_some_and(|name| {
                    description.links.get(joint.child).is_some_and(|child| *child.name == **name)
                        && joint.mimic.is_none()
                })
            })
        {
            let limit = joint.soft_limit;
            let is_upright = poses.get(link).is_some_and(|pose| (pose.rotation * axis.into_inner()).z.abs() > UPRIGHT);
            if is_upright && limit.lower.is_finite() && limit.upper.is_finite() {
                found.push((joint.name.to_string(), f64::midpoint(limit.lower, limit.upper)));
            }
        }
        at = tree.parent(link);
    }
    found
}

/// How far the root must be raised, metres: until nothing is in the floor; an arm that comes alone, so low that it reaches no table, as
/// if it stood on something. Is that so?
fn raised_m(robot: &FileRobot, guess: &Guess, description: &RobotDescription) -> (f64, bool) {
    let hundredths = |up_m: f64| (up_m.max(0.0) * 1e2).ceil() / 1e2;
    let (lowest_m, shoulder_m) = (robot.lowest_m(), robot.shoulder_m());
    let moves = |joint: &&JointDescription| joint.kind != JointKind::Fixed && joint.mimic.is_none();
    let fingers = 1 + guess.hand.follow.len();
    let built = usize::from(guess.hand.built.is_some());
    let is_alone = description.joints.iter().filter(moves).count() + built <= guess.arm.joints.len() + fingers;
    if is_alone && shoulder_m < LOW_SHOULDER_M {
        return (hundredths((SHOULDER_M - shoulder_m).max(-lowest_m)), true);
    }
    let exact_m = if lowest_m < 0.0 { (-lowest_m * 1e4).ceil() / 1e4 } else { 0.0 };
    (exact_m, false)
}

/// The files of a guess, where they are.
struct Sources<'a> {
    urdf: &'a Path,
    srdf: Option<PathBuf>,
    packages: &'a [(String, PathBuf)],
}

impl Sources<'_> {
    /// As a robot file beside its description.
    fn loaded(&self, guess: &Guess) -> Result<Loaded, RobotFileError> {
        let mut source = Source::from_text(&guess.text(), "the guess")?;
        source.file.urdf = self.urdf.to_path_buf();
        source.file.srdf.clone_from(&self.srdf);
        source.file.packages = self.packages.iter().cloned().collect();
        Loaded::new(source, None)
    }
}

/// What the SRDF says of the root, if that is that it stands where it is.
fn base_kind(semantic: &Semantic) -> Option<&'static str> {
    let is_fixed = |joint: &VirtualJoint| joint.kind == VirtualKind::Fixed;
    let joints = &semantic.description.virtual_joints;
    (!joints.is_empty() && joints.iter().all(is_fixed)).then_some("fixed")
}

fn file_name(description: &RobotDescription, urdf: &Path) -> String {
    let stem = urdf.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let name = if description.name.is_empty() { stem } else { description.name.clone() };
    let letter = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c.to_ascii_lowercase() } else { '-' };
    let name: String = name.chars().map(letter).take(60).collect();
    if name.is_empty() { "robot".to_owned() } else { name }
}

fn seen_from(urdf: &Path, folder: &Path) -> PathBuf {
    match (urdf.canonicalize(), folder.canonicalize()) {
        (Ok(urdf), Ok(folder)) => urdf.strip_prefix(&folder).map(Path::to_path_buf).unwrap_or(urdf),
        _ => urdf.to_path_buf(),
    }
}

struct ArmGuess {
    from: String,
    to: String,
    joints: Vec<String>,
}

/// The last joints between root and hand: those of the SRDF's smallest group that can take a hand to a pose, or so many as an arm
/// has mostly.
fn arm(description: &RobotDescription, hand: &HandGuess, semantic: Option<&Semantic>) -> Option<ArmGuess> {
    let index = |name: &str| description.links.iter().position(|link| *link.name == *name);
    let mut at = index(&hand.on)?;
    let mut path = Vec::new();
    while let Some(joint) = description.joints.iter().position(|joint| joint.child == at) {
        let found = description.joints.get(joint)?;
        at = found.parent;
        if found.kind != JointKind::Fixed && found.mimic.is_none() {
            path.push(joint);
        }
    }
    let moves = |joint: &usize| description.joints.get(*joint).is_some_and(|joint| joint.kind != JointKind::Fixed);
    // As many of them, from the hand inwards, as a group has, if it has no others.
    let of_group = |joints: &Vec<usize>| {
        let moving: Vec<_> = joints.iter().filter(|joint| moves(joint)).collect();
        let outer = path.get(..moving.len())?;
        outer.iter().all(|joint| moving.contains(&joint)).then_some(moving.len())
    };
    let groups = semantic.iter().flat_map(|semantic| &semantic.description.groups);
    let sizes = groups.filter_map(|group| of_group(&group.joints)).filter(|size| ARM_JOINTS.contains(size));
    path.truncate(sizes.min().unwrap_or(MOST_ARM_JOINTS));
    let joint = |joint: Option<&usize>| joint.and_then(|joint| description.joints.get(*joint));
    let name = |link: usize| description.links.get(link).map(|link| link.name.to_string());
    let (to, from) = (joint(path.first())?.child, joint(path.last())?.parent);
    let joints = path.iter().rev().filter_map(|index| joint(Some(index))).map(|joint| joint.name.to_string()).collect();
    Some(ArmGuess { from: name(from)?, to: name(to)?, joints })
}
