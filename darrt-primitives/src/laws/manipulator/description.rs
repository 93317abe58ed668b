//! What a robot says about itself.

use std::collections::BTreeSet;

use darrt_core::laws::{Broken, ensure, equal};

use super::{COUNTS, HAND, LIMITS, LINKS, PAIRS, STRENGTH};
use crate::manipulator::{Hand, JointVector, Manipulator};
use crate::push::GRAVITY;

/// A payload weighs at most so many times the force of the grip.
const MOST_HELD: f64 = 100.0;

pub(super) fn check<M: Manipulator>(robot: &M) -> Result<(), Broken> {
    let count = robot.limits().len();
    let fits = M::Joints::zeros(count).is_some_and(|zeros| zeros.as_ref().len() == count);
    ensure(COUNTS, fits, || format!("{count} limits"), "as many as there are joints").map_err(|b| b.of("limits"))?;
    super::vector::check_joint_vector::<M::Joints>(count)?;
    equal(COUNTS, &robot.joint_weights_m().len(), &count).map_err(|broken| broken.of("weights"))?;
    for (joint, weight) in robot.joint_weights_m().iter().enumerate() {
        let text = || format!("{weight:?}");
        ensure(COUNTS, weight.is_finite() && *weight > 0.0, text, "a finite positive weight")
            .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
    }
    for (joint, limit) in robot.limits().iter().enumerate() {
        let is_closed = limit.lower.is_finite() && limit.upper.is_finite() && limit.lower <= limit.upper;
        let text = || format!("[{:?}, {:?}]", limit.lower, limit.upper);
        ensure(LIMITS, is_closed || limit.is_unlimited(), text, "two ordered finite ends, or minus and plus infinity")
            .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
    }
    links(robot)?;
    (0..robot.hands()).try_for_each(|number| {
        let facts = robot.hand_of(number);
        hand(facts).and_then(|()| strength(robot, facts))
    })
}

fn links<M: Manipulator>(robot: &M) -> Result<(), Broken> {
    let links = robot.links();
    let mut names = BTreeSet::new();
    for link in links {
        ensure(LINKS, names.insert(&link.body.name), || format!("two links {:?}", link.body.name), "one of each name")?;
    }
    for (a, b) in robot.self_pairs() {
        let holds = a != b && *a < links.len() && *b < links.len();
        ensure(LINKS, holds, || format!("pair ({a}, {b}) of {} links", links.len()), "two different links")?;
    }
    let pairs = robot.self_pairs();
    let distinct: BTreeSet<_> = pairs.iter().map(|(a, b)| (a.min(b), a.max(b))).collect();
    let text = || format!("{} pairs, {} of them distinct, for {} links", pairs.len(), distinct.len(), links.len());
    let is_sound = distinct.len() == pairs.len() && (links.len() <= 2 || !pairs.is_empty());
    ensure(PAIRS, is_sound, text, "some pairs, each once")
}

/// Infinite is never the limit; nothing and not a number are no strength.
fn strength<M: Manipulator>(robot: &M, hand: &dyn Hand) -> Result<(), Broken> {
    let pad = hand.pad_length_m();
    ensure(STRENGTH, pad.is_finite() && pad > 0.0, || format!("pads of {pad:?} m"), "a finite positive length")?;
    let all = [("grip", hand.grip_force_n()), ("payload", robot.payload_kg()), ("push force", robot.push_force_n())];
    for (name, value) in all {
        ensure(STRENGTH, value > 0.0, || format!("{name} {value:?}"), "positive, or infinite")?;
    }
    // No friction holds more, and no hook or rim so much more: one of the two is in another unit.
    let (grip_n, payload_kg) = (hand.grip_force_n(), robot.payload_kg());
    let fits = payload_kg.is_infinite() || GRAVITY * payload_kg <= MOST_HELD * grip_n;
    let text = || format!("payload {payload_kg:?} kg with a grip of {grip_n:?} N");
    ensure(STRENGTH, fits, text, "a weight of at most a hundred times the grip")
}

fn hand(hand: &dyn Hand) -> Result<(), Broken> {
    let widest = hand.max_gap_m();
    ensure(
        HAND,
        (f64::MIN_POSITIVE..=1.0).contains(&widest),
        || format!("widest gap {widest:?}"),
        "positive, at most a metre",
    )?;
    let half = hand.tip_half_width_m();
    ensure(HAND, half.is_finite() && half > 0.0, || format!("half width {half:?}"), "a finite positive width")?;
    for gap_m in [0.0, 0.5 * widest, widest] {
        let tip = hand.tip_beyond_tool_m(gap_m);
        ensure(HAND, tip.is_finite(), || format!("tip at {tip:?} for gap {gap_m:?}"), "a finite place of the tips")?;
        equal(HAND, &hand.tip_beyond_tool_m(gap_m), &tip)?;
    }
    Ok(())
}
