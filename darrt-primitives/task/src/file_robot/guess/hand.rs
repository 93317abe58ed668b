//! Where the hand is, which joint opens it, and where its tool frame goes.

use darrt_geom::Body;
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::robot_file::BuiltHand;
use crate::robot_file::amend::{ANY_POSE, LEAST_JOINTS};
use crate::text::counted;

/// How far the tool frame lies before the end of the tips, metres.
pub(super) const BEHIND_TIPS_M: f64 = 0.02;
/// Longest pad that is guessed, metres, and its share of the finger.
const PAD_M: f64 = 0.03;
const PAD_SHARE: f64 = 0.5;
/// The pads are so far from the origin of a hand that lies behind them, metres.
const FINGER_M: f64 = 0.02;
/// How far pads may turn, radians, and how far ends are the same, metres.
const PARALLEL_RAD: f64 = 1e-6;
const SAME_M: f64 = 1e-6;
/// Tips whose distance changes less, metres, do not open.
const OPENS_M: f64 = 1e-3;
/// A finger has at most so many joints.
const MOST_FINGER_JOINTS: usize = 3;

/// A hand with two fingers.
#[derive(Debug, Clone)]
pub(super) struct HandGuess {
    pub(super) link: String,
    /// The link of the description that carries it.
    pub(super) on: String,
    pub(super) xyz: [f64; 3],
    pub(super) rpy: [f64; 3],
    pub(super) joint: String,
    pub(super) tips: [String; 2],
    /// Joints that must follow, with their factor.
    pub(super) follow: Vec<(String, f64)>,
    pub(super) pad_length_m: f64,
    /// What is built because the description has no hand.
    pub(super) built: Option<BuiltHand>,
}

/// One finger: the links below one child of the hand.
struct Finger {
    tip: usize,
    /// Variables that move it.
    variables: Vec<usize>,
}

/// The hand farthest out; `None` if there is nothing like one.
pub(super) fn guess(tree: &KinematicTree, bodies: &[Option<Body>]) -> Option<HandGuess> {
    // Of two arms the first. What fewer joints carry than an arm has is a head, say.
    let arms: Vec<_> = hands(tree, bodies).into_iter().filter(|(above, ..)| *above >= ANY_POSE).collect();
    let best = |is_parallel: bool| arms.iter().find(|(_, _, parallel)| *parallel || !is_parallel);
    best(true).or_else(|| best(false)).map(|(_, hand, _)| hand.clone())
}

/// The hand with two parallel fingers that the most joints carry of those on arms that do not take it to any pose.
pub(super) fn guess_few(tree: &KinematicTree, bodies: &[Option<Body>]) -> Option<HandGuess> {
    let few = hands(tree, bodies).into_iter().find(|(above, _, is_parallel)| *is_parallel && *above < ANY_POSE);
    few.filter(|(above, ..)| *above >= LEAST_JOINTS).map(|(_, hand, _)| hand)
}

/// Why a hand with two parallel fingers is none for planning: fewer joints carry it than an arm has. `None` if there is none.
pub(super) fn on_a_short_arm(tree: &KinematicTree, bodies: &[Option<Body>]) -> Option<String> {
    let (above, hand, _) = hands(tree, bodies).into_iter().find(|(.., is_parallel)| *is_parallel)?;
    let joints = counted(above as u64, "joint");
    Some(format!(
        "has a hand with two fingers, at `{}`, but only {joints} carry it: an arm that is planned with has {LEAST_JOINTS} at least",
        hand.on
    ))
}

/// All hands on what moves: how many joints carry each, what it is, and whether its pads stay parallel; those with the most joints
/// first.
fn hands(tree: &KinematicTree, bodies: &[Option<Body>]) -> Vec<(usize, HandGuess, bool)> {
    let candidates = (0..tree.link_count()).filter_map(|link| {
        let fingers: Vec<_> = children(tree, link).filter_map(|child| finger(tree, bodies, child)).collect();
        (fingers.len() >= 2).then(|| (joints_above(tree, link), link, fingers))
    });
    let mut hands: Vec<_> = candidates
        .filter(|(above, ..)| *above > 0)
        .filter_map(|(above, link, fingers)| {
            best_pair(tree, bodies, link, &fingers).map(|(hand, is_parallel)| (above, hand, is_parallel))
        })
        .collect();
    hands.sort_by_key(|(above, ..)| std::cmp::Reverse(*above));
    hands
}

/// Of the fingers of a hand whose pads stay parallel the two that reach farthest out, or any two; and do they? A hand may have links
/// beside the fingers that guide them.
fn best_pair(
    tree: &KinematicTree,
    bodies: &[Option<Body>],
    link: usize,
    fingers: &[Finger],
) -> Option<(HandGuess, bool)> {
    let pairs = fingers.iter().enumerate().flat_map(|(at, a)| fingers.iter().skip(at + 1).map(move |b| [a, b]));
    let found: Vec<_> = pairs.filter_map(|pair| describe(tree, bodies, link, pair)).collect();
    let parallel = found.iter().filter(|(_, is_parallel, _)| *is_parallel);
    let best = parallel.reduce(|best, next| if next.2 > best.2 + SAME_M { next } else { best });
    best.or(found.first()).map(|(hand, is_parallel, _)| (hand.clone(), *is_parallel))
}

pub(super) fn children(tree: &KinematicTree, link: usize) -> impl Iterator<Item = usize> + '_ {
    (1..tree.link_count()).filter(move |child| tree.parent(*child) == Some(link))
}

pub(super) fn variable_of(tree: &KinematicTree, link: usize) -> Option<usize> {
    match tree.motion(link)? {
        LinkMotion::Turning { drive, .. } | LinkMotion::Sliding { drive, .. } => Some(drive.variable),
        LinkMotion::Fixed => None,
    }
}

/// Is there no joint that moves between a link and the root?
pub(super) fn is_rigid(tree: &KinematicTree, link: usize) -> bool {
    joints_above(tree, link) == 0
}

pub(super) fn joints_above(tree: &KinematicTree, mut link: usize) -> usize {
    let mut count = 0;
    loop {
        count += usize::from(variable_of(tree, link).is_some());
        match tree.parent(link) {
            Some(parent) => link = parent,
            None => return count,
        }
    }
}

/// The part of the robot below `top`, if it is like a finger.
fn finger(tree: &KinematicTree, bodies: &[Option<Body>], top: usize) -> Option<Finger> {
    let mut below = vec![top];
    let mut at = 0;
    while let Some(link) = below.get(at).copied() {
        below.extend(children(tree, link));
        at += 1;
    }
    let moving = below.iter().filter(|link| variable_of(tree, **link).is_some()).count();
    if moving == 0 || moving > MOST_FINGER_JOINTS {
        return None;
    }
    let mut variables: Vec<_> = below.iter().filter_map(|link| variable_of(tree, *link)).collect();
    variables.sort_unstable();
    variables.dedup();
    let is_bounded = variables.iter().all(|variable| {
        tree.variables().get(*variable).is_some_and(|v| v.limit.lower.is_finite() && v.limit.upper.is_finite())
    });
    let is_moved = |mut link: usize| loop {
        if variable_of(tree, link).is_some() {
            return true;
        }
        match tree.parent(link) {
            Some(parent) if link != top => link = parent,
            _ => return false,
        }
    };
    let has_shape = |link: &usize| bodies.get(*link).is_some_and(Option::is_some);
    let tip = below.iter().copied().filter(has_shape).rfind(|link| is_moved(*link))?;
    is_bounded.then_some(Finger { tip, variables })
}

/// The hand with these fingers, do its pads stay parallel while it opens, and how far they reach out of it, metres.
fn describe(
    tree: &KinematicTree,
    bodies: &[Option<Body>],
    hand: usize,
    fingers: [&Finger; 2],
) -> Option<(HandGuess, bool, f64)> {
    let name = |link: usize| tree.link_names().get(link).map(ToString::to_string);
    let joint_name = |variable: usize| tree.variables().get(variable).map(|v| v.name.to_string());
    let driver = *fingers[0].variables.first()?;
    let mut others: Vec<usize> = fingers.iter().flat_map(|finger| finger.variables.iter().copied()).collect();
    others.sort_unstable();
    others.dedup();
    others.retain(|variable| *variable != driver);
    // Both fingers half open: each at the middle of its joints.
    let limit = |variable: usize| tree.variables().get(variable).map(|v| v.limit);
    let mut values = tree.neutral();
    for variable in std::iter::once(driver).chain(others.iter().copied()) {
        let limit = limit(variable)?;
        *values.get_mut(variable)? = f64::midpoint(limit.lower, limit.upper);
    }
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    tree.forward(&values, &Isometry3::identity(), &mut poses).ok()?;
    let hand_from_world = poses.get(hand)?.inverse();
    let tips = fingers.map(|finger| finger.tip);
    let [a, b] = tips.map(|tip| box_of(bodies, &poses, &hand_from_world, tip));
    let (a, b) = (a?, b?);
    let centre = |(low, high): (Vector3<f64>, Vector3<f64>)| (low + high) / 2.0;
    // Fingers open along the axis of the hand along which they are farthest apart.
    let apart = centre(a) - centre(b);
    let y = apart.map(|x| if x.abs() == apart.amax() { x.signum() } else { 0.0 });
    // They reach out along that of the others along which they are farthest from the hand's own origin.
    let middle = (centre(a) + centre(b)) / 2.0;
    // Where that is between the pads, from where the last joint before it is.
    let middle_from_origin = middle - y * middle.dot(&y);
    let out = if middle_from_origin.amax() >= FINGER_M {
        middle_from_origin
    } else {
        let mut wrist = hand;
        while variable_of(tree, wrist).is_none() {
            wrist = tree.parent(wrist)?;
        }
        let from_wrist = middle - (hand_from_world * poses.get(wrist)?).translation.vector;
        from_wrist - y * from_wrist.dot(&y)
    };
    let x = out.map(|v| if v.abs() == out.amax() && v != 0.0 { v.signum() } else { 0.0 });
    if (x.norm() - 1.0).abs() > 1e-9 || (y.norm() - 1.0).abs() > 1e-9 {
        return None;
    }
    let end = [a, b].iter().map(|(low, high)| low.dot(&x).max(high.dot(&x))).fold(f64::NEG_INFINITY, f64::max);
    let start = [a, b].iter().map(|(low, high)| low.dot(&x).min(high.dot(&x))).fold(f64::INFINITY, f64::min);
    let inner =
        |side: f64, (low, high): (Vector3<f64>, Vector3<f64>)| side * (side * low.dot(&y)).min(side * high.dot(&y));
    let between = f64::midpoint(inner(1.0, a), inner(-1.0, b));
    let z = x.cross(&y);
    let origin = x * (end - BEHIND_TIPS_M) + y * between + z * middle.dot(&z);
    let rotation =
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z])));
    let (roll, pitch, yaw) = rotation.euler_angles();
    let follow = others
        .iter()
        .filter_map(|variable| Some((joint_name(*variable)?, follow_factor(limit(driver)?, limit(*variable)?))));
    let follow: Vec<_> = follow.collect();
    let turned = |upper: bool| {
        let end = |variable: usize| limit(variable).map(|limit| if upper { limit.upper } else { limit.lower });
        let mut values = tree.neutral();
        *values.get_mut(driver)? = end(driver)?;
        for (variable, (_, factor)) in others.iter().zip(&follow) {
            // A follower that goes the other way is at its other end.
            *values.get_mut(*variable)? = factor * end(driver)?;
        }
        let mut poses = vec![Isometry3::identity(); tree.link_count()];
        tree.forward(&values, &Isometry3::identity(), &mut poses).ok()?;
        let hand = poses.get(hand)?.inverse();
        Some([hand * poses.get(tips[0])?, hand * poses.get(tips[1])?])
    };
    let (closed, open) = (turned(false)?, turned(true)?);
    let gap = |at: &[Isometry3<f64>; 2]| (at[0].translation.vector - at[1].translation.vector).dot(&y);
    if closed.iter().zip(&open).all(|(closed, open)| closed.rotation.angle_to(&open.rotation) <= PARALLEL_RAD)
        && (gap(&closed) - gap(&open)).abs() < OPENS_M
    {
        // Two parts that move together are one finger.
        return None;
    }
    let is_parallel =
        closed.iter().zip(&open).all(|(closed, open)| closed.rotation.angle_to(&open.rotation) <= PARALLEL_RAD);
    let hand = HandGuess {
        link: name(hand)?,
        on: name(hand)?,
        xyz: origin.into(),
        rpy: [roll, pitch, yaw],
        joint: joint_name(driver)?,
        tips: [name(tips[0])?, name(tips[1])?],
        follow,
        pad_length_m: (PAD_SHARE * (end - start)).min(PAD_M),
        built: None,
    };
    Some((hand, is_parallel, end))
}

/// A joint with the mirrored range moves the other way.
fn follow_factor(
    driver: darrt_primitives::kinematics::JointLimit,
    other: darrt_primitives::kinematics::JointLimit,
) -> f64 {
    let same = (driver.lower - other.lower).abs() + (driver.upper - other.upper).abs();
    let mirrored = (driver.lower + other.upper).abs() + (driver.upper + other.lower).abs();
    if mirrored < same { -1.0 } else { 1.0 }
}

/// The box around a link's shapes along the axes of the hand.
fn box_of(
    bodies: &[Option<Body>],
    poses: &[Isometry3<f64>],
    hand_from_world: &Isometry3<f64>,
    link: usize,
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let body = bodies.get(link)?.as_ref()?;
    let pose = hand_from_world * poses.get(link)?;
    let farthest = |axis: Vector3<f64>| {
        let parts = body.parts.iter().map(|part| {
            let at = pose * part.body_from_shape;
            at.translation.vector.dot(&axis) + part.shape.support_extent(&(at.rotation.inverse() * axis))
        });
        parts.fold(f64::NEG_INFINITY, f64::max)
    };
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    Some((Vector3::from(axes.map(|axis| -farthest(-axis))), Vector3::from(axes.map(farthest))))
}
