//! A hand for an arm that comes without one: where it is bolted on.

use crate::text::counted;
use darrt_geom::Body;
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::hand::{BEHIND_TIPS_M, HandGuess, children, joints_above, variable_of};
use crate::robot_file::BuiltHand;
use crate::robot_file::built_hand::{HAND, JOINT, TIPS};

/// An arm that is given a hand has at least so many joints in a row, with nothing else that moves on them: fewer are a head or a tail.
const LEAST_JOINTS: usize = 6;
/// It is so long at least, metres: what is shorter is a finger.
const LEAST_M: f64 = 0.25;
/// HEURISTIC: a last joint that turns less, radians, is the jaw of a hand.
const WRIST_RAD: f64 = 2.5;
/// The shapes of a last link lie aside if their middle is so far from the axis, as a share of half their width.
const ASIDE: f64 = 0.5;
/// Middles so near to each other are at one place, metres.
const SAME_M: f64 = 1e-3;
/// A hand of common size: palm along x, y, z; length, thickness, width of a finger; how far it opens; metres.
const PALM_M: [f64; 3] = [0.06, 0.11, 0.05];
const FINGER_M: [f64; 3] = [0.06, 0.012, 0.02];
const OPENING_M: f64 = 0.08;
const PAD_M: f64 = 0.03;

/// A hand of boxes at the end of the longest arm; or why there is no such arm.
pub(super) fn hand(tree: &KinematicTree, bodies: &[Option<Body>]) -> Result<HandGuess, String> {
    let moving = (0..tree.link_count()).filter(|link| variable_of(tree, *link).is_some());
    let last =
        moving.reduce(|best, next| if joints_above(tree, next) > joints_above(tree, best) { next } else { best });
    let last = last.ok_or("has no joint that moves")?;
    let name = tree.link_names().get(last).map(ToString::to_string).unwrap_or_default();
    is_arm(tree, last).map_err(|why| {
        format!(
            "has no hand with two fingers at the end of an arm (two parts with a shape, each moved by a joint of its own), and no arm \
             that a hand could be bolted to: the longest row of joints ends at `{name}`, {why}"
        )
    })?;
    let not_turning = || format!("has no hand, and its longest arm ends with a joint that slides, at `{name}`");
    let Some(LinkMotion::Turning { axis, .. }) = tree.motion(last) else { return Err(not_turning()) };
    let a = axis.into_inner();
    // Any ways across.
    let u = Vector3::ith(a.map(f64::abs).imin(), 1.0);
    let u = (u - a * u.dot(&a)).normalize();
    let ways = [a, u, a.cross(&u)];
    let own = reach(tree, bodies, last, &Isometry3::identity(), &ways);
    let (x, offset) = out(own, before(tree, bodies, last, &ways), &ways);
    let y = if x.dot(&a).abs() > 0.5 { u } else { a };
    let columns = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns));
    let (roll, pitch, yaw) = rotation.euler_angles();
    let on = name.clone();
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

/// How far something reaches along three ways and against them, metres.
type Reach = [[f64; 2]; 3];

/// Of a body at `origin_from_body`.
fn of_body(body: &Body, origin_from_body: &Isometry3<f64>, ways: &[Vector3<f64>; 3]) -> Option<Reach> {
    let along = |out: Vector3<f64>| {
        let each = body.parts.iter().map(|part| {
            let at = origin_from_body * part.body_from_shape;
            at.translation.vector.dot(&out) + part.shape.support_extent(&(at.rotation.inverse() * out))
        });
        each.reduce(f64::max)
    };
    let both = |way: Vector3<f64>| Some([along(way)?, along(-way)?]);
    Some([both(ways[0])?, both(ways[1])?, both(ways[2])?])
}

/// Of a link and what is rigid to it; the link is at `origin_from_link`.
fn reach(
    tree: &KinematicTree,
    bodies: &[Option<Body>],
    link: usize,
    origin_from_link: &Isometry3<f64>,
    ways: &[Vector3<f64>; 3],
) -> Option<Reach> {
    let mut found: Option<Reach> = None;
    let mut rigid = vec![(link, *origin_from_link)];
    while let Some((link, pose)) = rigid.pop() {
        if let Some(reach) = bodies.get(link).and_then(|body| of_body(body.as_ref()?, &pose, ways)) {
            let larger = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.max(d)];
            found =
                Some(found.map_or(reach, |[i, j, k]| [larger(i, reach[0]), larger(j, reach[1]), larger(k, reach[2])]));
        }
        let below = children(tree, link).filter(|child| variable_of(tree, *child).is_none());
        rigid.extend(below.filter_map(|child| Some((child, pose * tree.parent_from_link(child)?))));
    }
    found
}

/// Of the nearest link further in that has a shape and moves against this one, all joints where they are nearest to 0.
fn before(tree: &KinematicTree, bodies: &[Option<Body>], last: usize, ways: &[Vector3<f64>; 3]) -> Option<Reach> {
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    tree.forward(&tree.neutral(), &Isometry3::identity(), &mut poses).ok()?;
    let last_from_root = poses.get(last)?.inverse();
    let mut at = last;
    loop {
        at = tree.parent(at)?;
        if bodies.get(at).is_some_and(Option::is_some) {
            return of_body(bodies.get(at)?.as_ref()?, &(last_from_root * poses.get(at)?), ways);
        }
    }
}

/// Which way is out of the last link, and how far it reaches that way: along the axis of its joint, away from the link before it; or
/// aside, if its shapes lie there.
fn out(own: Option<Reach>, before: Option<Reach>, ways: &[Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let centre = |[ahead, back]: [f64; 2]| 0.5 * (ahead - back);
    let half = |[ahead, back]: [f64; 2]| 0.5 * (ahead + back);
    let along = own.map_or([0.0; 2], |own| own[0]);
    if let Some(own) = own {
        for (way, reach) in ways.iter().zip(own).skip(1) {
            let is_beside = centre(reach).abs() > ASIDE * half(reach);
            let most = reach[0].max(reach[1]);
            if is_beside && most > along[0].max(along[1]) {
                return (way * centre(reach).signum(), most);
            }
        }
    }
    let inner = before.map_or(0.0, |before| centre(before[0]));
    let apart = centre(along) - inner;
    let is_ahead = if apart.abs() > SAME_M { apart > 0.0 } else { along[0] >= along[1] };
    if is_ahead { (ways[0], along[0].max(0.0)) } else { (-ways[0], along[1].max(0.0)) }
}

/// Do the joints up to this link stand in a row, nothing else on them? If not, why not.
fn is_arm(tree: &KinematicTree, last: usize) -> Result<(), String> {
    let above = |mut link: usize| loop {
        link = tree.parent(link)?;
        if variable_of(tree, link).is_some() {
            return Some(link);
        }
    };
    let moved_by = |link: usize| {
        (0..tree.link_count()).filter(move |below| variable_of(tree, *below).is_some() && above(*below) == Some(link))
    };
    let name = |link: usize| tree.link_names().get(link).map(ToString::to_string).unwrap_or_default();
    let mut at = last;
    let mut row = vec![last];
    for joint in 1..LEAST_JOINTS {
        let Some(next) = above(at) else {
            let needed = format!("an arm without a hand is known by {LEAST_JOINTS} joints at least");
            return Err(if joint == 1 {
                format!("and is one joint: {needed}")
            } else {
                format!("and has {joint} joints: {needed}")
            });
        };
        // The first joint may stand on what carries other limbs too.
        let carried = moved_by(next).count();
        if joint + 1 < LEAST_JOINTS && carried != 1 {
            return Err(format!(
                "and branches {} before it, at `{}`, which carries {carried} moving parts: that is a hand of more than two \
                 fingers, or one that is not planned with, or a body with legs",
                counted(joint as u64, "joint"),
                name(next)
            ));
        }
        row.push(next);
        at = next;
    }
    let length_m: f64 =
        row.iter().filter_map(|link| tree.parent_from_link(*link)).map(|at| at.translation.vector.norm()).sum();
    if length_m < LEAST_M {
        return Err(format!("and is {length_m:.2} m long: what is shorter than {LEAST_M} m is a finger"));
    }
    // A wrist turns far, a jaw does not.
    let limit = variable_of(tree, last).and_then(|variable| tree.variables().get(variable)).map(|v| v.limit);
    let range = limit.filter(|limit| !limit.is_unlimited()).map(|limit| limit.upper - limit.lower);
    match range.filter(|range| *range < WRIST_RAD) {
        Some(range) => Err(format!(
            "which turns by {:.0} degrees only, as a jaw or a foot does: hands with one jaw that swings are not planned with",
            range.to_degrees()
        )),
        None => Ok(()),
    }
}
