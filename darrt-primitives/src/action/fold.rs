//! How the arm is held while the base drives: folded, unless the drive is so short that folding is not worth the way.
//!
//! An arm that sticks out meets things, and what its hand holds is carried level: a careful driver folds it first. Here the
//! ways to drive are compared by what they cost: arm as it is, arm already where it shall go, or folded in between.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Point2, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};

use super::Chain;
use super::drive::{Drive, Looks};
use super::line;
use super::turned::turned_about;
use super::width::Widths;
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::mode::Held;
use crate::object_space::upright;
use crate::tabletop::{Tabletop, TabletopState};
use crate::tilt::tilt_rad;

/// As far from the middle of the base the hand may be while the robot drives without anybody minding, metres.
const FOLDED_M: f64 = 0.5;
/// What a metre driven costs more for each metre that the hand is farther out, metres of arm travel.
const OUT_COSTS: f64 = 4.0;
/// Every way counts up to this much more by chance, so that where the best one is blocked others are tried.
const CHANCE: f64 = 0.5;
/// How many ways to carry an object are drawn.
const DRAWS: usize = 16;
/// How many more are drawn where the robot would be too wide for a passage with all of them.
const NARROW_DRAWS: usize = 96;
/// So far to both sides of straight ahead an object is carried through a passage, radians.
const AHEAD_RAD: f64 = 0.4;
/// Where the hand is when an object is carried: least and largest distance from the middle of the base, metres.
const CARRIED_M: [f64; 2] = [0.35, 0.75];
/// How much higher or lower than now an object is carried, metres.
const CARRIED_RISE_M: f64 = 0.25;
/// How much higher than it is the empty hand is carried above things, metres.
const RAISED_M: f64 = 0.25;
/// In how many parts a move of the arm is looked at for how far what is held leans.
const LOOKS: u32 = 8;

/// How arm and base go one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Order<J> {
    /// The base first.
    BaseFirst,
    /// The arm first.
    ArmFirst,
    /// The arm to this configuration, the base, the arm again.
    Through(J),
}

/// The cheapest order found in which nothing is in the way of the robot and what it holds at either end of the drive; first
/// those in which the robot is not too wide for a passage. One whose straight drive is clear too, as far as a few looks tell, goes
/// before: an arm that sticks out makes the base go around what a folded one passes.
/// Costs are metres of travel, with a part left to chance.
pub(super) fn order<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &Chain<M>,
    target: &Configuration<M::Joints>,
    rng: &mut dyn Rng,
) -> Order<M::Joints> {
    let from = &chain.end;
    let held = from.mode.held().copied();
    let mut choices = vec![(Order::BaseFirst, from.robot.arm), (Order::ArmFirst, target.arm)];
    choices.extend(m.settings().postures.iter().map(|posture| (Order::Through(*posture), *posture)));
    let mut widths = Widths::new(m, from, target);
    if let Some(held) = &held {
        let anywhere = std::f64::consts::PI;
        let drawn = (0..DRAWS).filter_map(|_| carrying(m, from, held, anywhere, rng));
        choices.extend(drawn.map(|arm| (Order::Through(arm), arm)));
        if choices.iter().all(|(_, arm)| widths.is_wide(arm)) {
            let mut drawn = (0..NARROW_DRAWS).filter_map(|_| carrying(m, from, held, AHEAD_RAD, rng));
            choices.extend(drawn.find(|arm| !widths.is_wide(arm)).map(|arm| (Order::Through(arm), arm)));
        }
    }
    let costed = |choices: Vec<(Order<M::Joints>, M::Joints)>, rng: &mut dyn Rng| {
        let mut choices: Vec<_> = choices
            .into_iter()
            .map(|(order, arm)| (cost_m(m, from, target, &arm) * rng.random_range(1.0..1.0 + CHANCE), order, arm))
            .collect();
        choices.sort_by(|a, b| a.0.total_cmp(&b.0));
        choices
    };
    let mut chooser =
        Chooser { m, from, target, held, widths, drive: Drive::new(m, from, &target.base, Looks::FEW), fallback: None };
    let most = m.collision_scene().most_care();
    let mut choices = costed(choices, rng);
    let mut cheapest = match chooser.best(&choices, most) {
        Best::Straight(order) => return order,
        Best::Fits(order) => Some(order),
        Best::None => None,
    };
    // OPTIMIZATION: mostly they are not needed.
    let raised = costed(raised(m, from, target), rng);
    chooser.drive = Drive::new(m, from, &target.base, Looks::MANY);
    match chooser.best(&raised, most) {
        Best::Straight(order) => return order,
        Best::Fits(order) => cheapest = cheapest.or(Some(order)),
        Best::None => {}
    }
    choices.extend(raised);
    let less = || (0..most).rev().find_map(|care| chooser.best(&choices, care).order());
    cheapest.or_else(less).or(chooser.fallback).unwrap_or(Order::BaseFirst)
}

/// A way to hold the arm: what it costs in metres, the order, and the arm on the drive.
type Choice<J> = (f64, Order<J>, J);

/// The best of some ways to hold the arm.
enum Best<J> {
    /// The cheapest with which the straight drive is clear.
    Straight(Order<J>),
    /// There is none, but this one is clear at both ends.
    Fits(Order<J>),
    None,
}

impl<J> Best<J> {
    fn order(self) -> Option<Order<J>> {
        match self {
            Self::Straight(order) | Self::Fits(order) => Some(order),
            Self::None => None,
        }
    }
}

/// Compares ways to hold the arm on a drive from `from` to `target`.
struct Chooser<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    target: &'a Configuration<M::Joints>,
    held: Option<Held>,
    widths: Widths<'a, M>,
    drive: Drive<'a, M>,
    /// The cheapest one with which the robot is not too wide, else the cheapest of all, whether or not it is clear.
    fallback: Option<Order<M::Joints>>,
}

impl<M: Manipulator> Chooser<'_, M> {
    /// The best of `choices`, which are sorted by cost; those with which the robot is too wide for a passage last.
    fn best(&mut self, choices: &[Choice<M::Joints>], care: usize) -> Best<M::Joints> {
        // OPTIMIZATION: how wide the robot is with an arm is asked only of the arms that are looked at.
        let mut wide: Vec<Option<bool>> = vec![None; choices.len()];
        let mut fits = None;
        for is_wide in [false, true] {
            for ((_, order, arm), wide) in choices.iter().zip(&mut wide) {
                if *wide.get_or_insert_with(|| self.widths.is_wide(arm)) != is_wide {
                    continue;
                }
                self.fallback.get_or_insert(*order);
                if !self.drive.fits(arm, care) || !self.stays(arm) {
                    continue;
                }
                if self.drive.is_straight(care) {
                    return Best::Straight(*order);
                }
                fits.get_or_insert(*order);
            }
        }
        fits.map_or(Best::None, Best::Fits)
    }

    /// Does what is held stay level on the way to this arm and from there on?
    fn stays(&self, arm: &M::Joints) -> bool {
        let Self { m, from, target, .. } = self;
        self.held
            .is_none_or(|held| stays_level(m, &held, &from.robot.arm, arm) && stays_level(m, &held, arm, &target.arm))
    }
}

/// The empty hand raised straight up from where it is, and from where it shall go, as far as the arm reaches: above what stands
/// there.
fn raised<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    target: &Configuration<M::Joints>,
) -> Vec<(Order<M::Joints>, M::Joints)> {
    if from.mode.held().is_some() {
        return Vec::new();
    }
    let up = |q: &Configuration<M::Joints>| {
        let at = m.manipulator().world_from_tool(q);
        let line = line::follow(m, &q.base, &q.arm, &at, &(Vector3::z() * RAISED_M));
        line.arms.last().map(|arm| (Order::Through(*arm), *arm))
    };
    [&from.robot, target].into_iter().filter_map(up).collect()
}

/// What it costs to drive with the arm at `arm`: the arm's travel to there and from there on, and the drive, dearer with the
/// hand out.
fn cost_m<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    target: &Configuration<M::Joints>,
    arm: &M::Joints,
) -> f64 {
    let robot = m.manipulator();
    let at = |arm: &M::Joints| Configuration { base: from.robot.base, arm: *arm };
    let reach_m = m.held_reach_m(&from.mode);
    let moved_m = robot.travel_m(&from.robot, &at(arm), reach_m) + robot.travel_m(&at(arm), &at(&target.arm), reach_m);
    let driven_m = m.robot().base().distance(&from.robot.base, &target.base);
    moved_m + OUT_COSTS * driven_m * (out_m(m, &at(arm)) - FOLDED_M).max(0.0)
}

/// Horizontal distance of the hand from the middle of the base, metres.
fn out_m<M: Manipulator>(m: &Tabletop<M>, q: &Configuration<M::Joints>) -> f64 {
    let [x, y, _] = q.base;
    let tool = m.manipulator().world_from_tool(q).translation.vector;
    (tool.x - x).hypot(tool.y - y)
}

/// An arm configuration, drawn at random, that carries what is held upright and near the robot, not farther than `aside_rad`
/// from straight ahead; `None` if the draw is out of reach.
fn carrying<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    held: &Held,
    aside_rad: f64,
    rng: &mut dyn Rng,
) -> Option<M::Joints> {
    let here = from.object(held.object)?;
    let [x, y, heading] = from.robot.base;
    let bearing = heading + rng.random_range(-aside_rad..aside_rad);
    let distance_m = rng.random_range(CARRIED_M[0]..CARRIED_M[1]);
    let height_m = here.translation.z + rng.random_range(-CARRIED_RISE_M..CARRIED_RISE_M);
    let yaw = rng.random_range(-std::f64::consts::PI..std::f64::consts::PI);
    let turned = upright(Vector3::zeros(), yaw) * held.tool_from_object.inverse();
    let tool = Vector3::new(x + distance_m * bearing.cos(), y + distance_m * bearing.sin(), height_m);
    let at_tool = Isometry3::from_parts(tool.into(), UnitQuaternion::from(turned.rotation));
    let robot = m.manipulator();
    let (base, hand) = (&from.robot.base, from.robot.arm.hand_at_work());
    if !robot.may_reach_with(hand, base, &at_tool) {
        return None;
    }
    let centre = Point2::new(tool.x, tool.y);
    let turn = robot.turn_to_reach_with(hand, base, &at_tool, &centre, rng);
    let at_tool = turn.map_or(at_tool, |turn| turned_about(&at_tool, &centre, turn));
    robot.inverse_from(&from.robot.arm, base, &at_tool, rng)
}

/// Does what is held lean no farther than it may while the arm goes straight from `a` to `b`, as far as a few looks tell?
fn stays_level<M: Manipulator>(m: &Tabletop<M>, held: &Held, a: &M::Joints, b: &M::Joints) -> bool {
    let limit = m.tilt_limit_rad(held);
    if limit >= std::f64::consts::PI {
        return true;
    }
    let at = |arm: &M::Joints| Configuration { base: [0.0; 3], arm: *arm };
    (1..LOOKS).all(|i| {
        let q = m.robot().interpolate(&at(a), &at(b), f64::from(i) / f64::from(LOOKS));
        tilt_rad(&(m.manipulator().world_from_tool(&q) * held.tool_from_object)) <= limit
    })
}
