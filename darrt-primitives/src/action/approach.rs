//! How far the hand must travel before it can push or grasp an object: bounds for DISTANCE (paper section 4.3). They ask
//! neither the arm nor the obstacles, so they cost next to nothing, and every push and every grasp that is found travels
//! at least as far.

use std::f64::consts::{PI, TAU};

use darrt_core::domain::Domain;
use darrt_core::state::ObjectId;
use nalgebra::{Isometry3, Point2, Point3, Rotation2, Vector2};

use super::pick::overhangs;
use super::push::Pushable;
use crate::contact::HandStance;
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::push::edge_stop::EdgeRule;
use crate::tabletop::{Tabletop, TabletopState};

/// What stands for a way that there is not, metres: longer than any, and still a number that can be added.
pub const NO_WAY_M: f64 = 1e9;

/// Rounding of the depth of a place where a push may end, metres; less than the push itself allows.
const DEPTH_ROUNDING_M: f64 = 5e-10;

/// Metres from the nearest tool to the nearest contact from which [`push`](super::push::push) may bring `object` towards `target`:
/// behind it, seen from there, with the hand leaning as it may. Where the push ends at the edge, it may be any of an arc of
/// contacts, and near a corner of the surface any on the rim. [`NO_WAY_M`] for what cannot be pushed.
///
/// # Laws
/// At most the travel of every such push. The same for two targets above each other.
pub fn to_push_m<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    target: &Isometry3<f64>,
) -> f64 {
    let Ok(pushable) = Pushable::new(m, from, object) else { return NO_WAY_M };
    let ends = ends(m, &pushable, &flat(target));
    let of_stance = |stance: HandStance| {
        let (setback_m, height_m) = pushable.tool_place(&stance)?;
        let circle = PushCircle { center: pushable.center(), setback_m, height_m };
        tools(m, from).map(|tool| circle.distance_m(&tool, &ends)).min_by(f64::total_cmp)
    };
    pushable.stances(m, false).filter_map(of_stance).min_by(f64::total_cmp).unwrap_or(NO_WAY_M)
}

/// Metres from the nearest tool to the nearest place from which `object` can be grasped as far as its families know
/// ([`tool_reach_m`](crate::grasp::GraspFamily::tool_reach_m)), whichever side of the object that is on; [`NO_WAY_M`]
/// where no grasp fits, as for a plate in the middle of a table.
///
/// # Laws
/// At most the travel of every [`pick`](super::pick::pick).
pub fn to_grasp_m<M: Manipulator>(m: &Tabletop<M>, from: &TabletopState<M>, object: ObjectId) -> f64 {
    let (Some(movable), Some(pose)) = (m.movable(object), from.object(object)) else { return NO_WAY_M };
    let overhangs = overhangs(m, from, object, movable, pose);
    let fitting = movable.grasps.iter().filter(|family| !family.needs_overhang() || overhangs);
    let center = Point3::from(pose.translation.vector);
    let gap_m = tools(m, from).map(|tool| (tool - center).norm()).fold(NO_WAY_M, f64::min);
    fitting.map(|family| (gap_m - family.tool_reach_m()).max(0.0)).min_by(f64::total_cmp).unwrap_or(NO_WAY_M)
}

/// Where the object may be when it has been pushed.
enum Ends {
    /// Somewhere on the segment, or on the way there, which may be an arc: in a direction that differs by up to so many
    /// radians from that of its end.
    Between(Point2<f64>, Point2<f64>, f64),
    /// In any direction.
    Anywhere,
}

/// Where a push towards `target` may end.
fn ends<M: Manipulator>(m: &Tabletop<M>, pushable: &Pushable<'_>, target: &Point2<f64>) -> Ends {
    let settings = &m.settings().push;
    let surface = pushable.surface;
    let is_inside = surface.depth(target) >= m.edge_margin_m(pushable.object, pushable.on, target);
    if settings.edge_rule == EdgeRule::LineCrossing || is_inside {
        return between(m, pushable, *target, *target);
    }
    let [least, most] = Pushable::edge_distances_m(m);
    let edge = surface.nearest_edge_point(target);
    let [nearest, farthest] = [least, most].map(|inside| edge.point - inside * edge.outward.into_inner());
    // Where the farthest end is far enough from every other edge, the nearer ones are as well.
    let is_alone = surface.depth(&farthest) >= most - DEPTH_ROUNDING_M;
    if is_alone { between(m, pushable, nearest, farthest) } else { Ends::Anywhere }
}

fn between<M: Manipulator>(m: &Tabletop<M>, pushable: &Pushable<'_>, a: Point2<f64>, b: Point2<f64>) -> Ends {
    let farthest_m = [a, b].map(|end| (end - pushable.center()).norm()).into_iter().fold(0.0, f64::max);
    Ends::Between(a, b, pushable.most_half_turn(m, farthest_m))
}

/// The circle on which the tool stands to push an object.
struct PushCircle {
    center: Point2<f64>,
    setback_m: f64,
    height_m: f64,
}

impl PushCircle {
    /// From `tool` to the nearest contact behind the object for one of `ends`.
    fn distance_m(&self, tool: &Point3<f64>, ends: &Ends) -> f64 {
        let aside = tool.xy() - self.center;
        let to_circle_m = (aside.norm() - self.setback_m).abs();
        let across_m = match ends {
            Ends::Anywhere => to_circle_m,
            Ends::Between(a, b, beside) => {
                self.to_arc_m(&aside, &(self.center - a), &(self.center - b), *beside).unwrap_or(to_circle_m)
            }
        };
        across_m.hypot(tool.z - self.height_m)
    }

    /// From `aside` of the centre to the arc between two directions, the shorter one, made longer by `beside` radians at both
    /// ends; `None` where its middle part is nearest, as on the whole circle, or where there is no direction.
    fn to_arc_m(&self, aside: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>, beside: f64) -> Option<f64> {
        let angle = |v: &Vector2<f64>| v.y.atan2(v.x);
        let span = turned(angle(b) - angle(a));
        // From the middle: the arc is as long to both sides.
        let (middle, half) = (angle(a) + 0.5 * span, 0.5 * span.abs() + beside);
        let is_between = half >= PI || (half > 0.0 && turned(angle(aside) - middle).abs() < half);
        if is_between {
            return None;
        }
        let [a, b] = [a, b].map(|v| v.try_normalize(0.0));
        let outwards = if span < 0.0 { -beside } else { beside };
        let ends = [Rotation2::new(-outwards) * a?, Rotation2::new(outwards) * b?];
        let [a, b] = ends.map(|v| (aside - v * self.setback_m).norm());
        Some(a.min(b))
    }
}

/// The same turn, in `[-pi, pi)`.
fn turned(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

fn flat(pose: &Isometry3<f64>) -> Point2<f64> {
    Point2::new(pose.translation.x, pose.translation.y)
}

/// Where the hands are that may go to work.
fn tools<M: Manipulator>(m: &Tabletop<M>, from: &TabletopState<M>) -> impl Iterator<Item = Point3<f64>> {
    let hands = m.manipulator().hands();
    let all = if hands < 2 || from.mode.held().is_some() { 0..0 } else { 0..hands };
    let of_hand = |hand| Configuration { arm: from.robot.arm.with_hand_at_work(hand), ..from.robot };
    let only = all.is_empty().then_some(from.robot);
    only.into_iter().chain(all.map(of_hand)).map(|q| Point3::from(m.working_point(&q)))
}
