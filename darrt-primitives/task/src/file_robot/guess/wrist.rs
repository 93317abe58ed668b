//! A hand for an arm that comes without one: where it is bolted on.

use darrt_geom::Body;
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::hand::{BEHIND_TIPS_M, HandGuess, children, joints_above, variable_of};
use crate::robot_file::BuiltHand;
use crate::robot_file::built_hand::{HAND, JOINT, TIPS};

/// An arm has at least so many joints in a row, with nothing else that moves on them.
const LEAST_JOINTS: usize = 6;
/// It is so long at least, metres: what is shorter is a finger.
const LEAST_M: f64 = 0.25;
/// HEURISTIC: a last joint that turns less, radians, is the jaw of a hand.
const WRIST_RAD: f64 = 2.5;
/// A hand of common size: palm along x, y, z; length, thickness, width of a finger; how far it opens; metres.
const PALM_M: [f64; 3] = [0.06, 0.11, 0.05];
const FINGER_M: [f64; 3] = [0.06, 0.012, 0.02];
const OPENING_M: f64 = 0.08;
const PAD_M: f64 = 0.02;

/// A hand of boxes at the end of the longest arm, out of which the axis of its last joint points; or why there is no such arm.
pub(super) fn hand(tree: &KinematicTree, bodies: &[Option<Body>]) -> Result<HandGuess, String> {
    let none = "has neither a link with two fingers at the end of an arm (two parts with a shape, each moved by a joint of its own) nor \
                an arm of six joints in a row, with nothing else that moves on them, which a hand could be bolted to; hands of three \
                fingers or more, and with one jaw that swings, are not planned with";
    let moving = (0..tree.link_count()).filter(|link| variable_of(tree, *link).is_some());
    let last =
        moving.reduce(|best, next| if joints_above(tree, next) > joints_above(tree, best) { next } else { best });
    let last = last.filter(|last| is_arm(tree, *last)).ok_or_else(|| none.to_owned())?;
    let Some(LinkMotion::Turning { axis, .. }) = tree.motion(last) else { return Err(none.to_owned()) };
    // How far what is rigid to the last link reaches along the axis, either way.
    let mut reach = [0.0_f64; 2];
    let mut rigid = vec![(last, Isometry3::identity())];
    while let Some((link, last_from_link)) = rigid.pop() {
        for (side, reach) in [1.0, -1.0].into_iter().zip(&mut reach) {
            let out = axis.into_inner() * side;
            *reach = reach.max(last_from_link.translation.vector.dot(&out));
            for part in bodies.get(link).into_iter().flatten().flat_map(|body| &body.parts) {
                let at = last_from_link * part.body_from_shape;
                let inside = at.rotation.inverse() * out;
                *reach = reach.max(at.translation.vector.dot(&out) + part.shape.support_extent(&inside));
            }
        }
        let below = children(tree, link).filter(|child| variable_of(tree, *child).is_none());
        rigid.extend(below.filter_map(|child| Some((child, last_from_link * tree.parent_from_link(child)?))));
    }
    let (side, offset) = if reach[1] > reach[0] { (-1.0, reach[1]) } else { (1.0, reach[0]) };
    let x = axis.into_inner() * side;
    // Any way across.
    let across = Vector3::ith(x.map(f64::abs).imin(), 1.0);
    let y = (across - x * across.dot(&x)).normalize();
    let columns = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns));
    let (roll, pitch, yaw) = rotation.euler_angles();
    let on = tree.link_names().get(last).map(ToString::to_string).ok_or_else(|| none.to_owned())?;
    let built = BuiltHand {
        on: on.clone(),
        xyz: (x * offset).into(),
        rpy: [roll, pitch, yaw],
        palm_m: PALM_M,
        finger_m: FINGER_M,
        opening_m: OPENING_M,
    };
    Ok(HandGuess {
        link: HAND.to_owned(),
        on,
        xyz: [PALM_M[0] + FINGER_M[0] - BEHIND_TIPS_M, 0.0, 0.0],
        rpy: [0.0; 3],
        joint: JOINT.to_owned(),
        tips: TIPS.map(str::to_owned),
        follow: Vec::new(),
        pad_length_m: PAD_M,
        built: Some(built),
    })
}

/// Do the joints up to this link stand in a row, nothing else on them?
fn is_arm(tree: &KinematicTree, last: usize) -> bool {
    let above = |mut link: usize| loop {
        link = tree.parent(link)?;
        if variable_of(tree, link).is_some() {
            return Some(link);
        }
    };
    let moved_by = |link: usize| {
        (0..tree.link_count()).filter(move |below| variable_of(tree, *below).is_some() && above(*below) == Some(link))
    };
    let mut at = last;
    let mut row = vec![last];
    for joint in 1..LEAST_JOINTS {
        let Some(next) = above(at) else { return false };
        // The first joint may stand on what carries other limbs too.
        if joint + 1 < LEAST_JOINTS && moved_by(next).count() != 1 {
            return false;
        }
        row.push(next);
        at = next;
    }
    let length_m: f64 =
        row.iter().filter_map(|link| tree.parent_from_link(*link)).map(|at| at.translation.vector.norm()).sum();
    // A wrist turns far, a jaw does not.
    let limit = variable_of(tree, last).and_then(|variable| tree.variables().get(variable)).map(|v| v.limit);
    let is_wrist = limit.is_some_and(|limit| limit.is_unlimited() || limit.upper - limit.lower >= WRIST_RAD);
    moved_by(last).count() == 0 && length_m >= LEAST_M && is_wrist
}
