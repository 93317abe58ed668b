//! Which of a robot's hands goes to work on an object.

use std::borrow::Cow;

use rand::{Rng, RngExt};

use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::tabletop::{Tabletop, TabletopState};

/// Share of the draws in which the arms that do not work stay where they are, though there is a posture for them.
const STAY_SHARE: f64 = 0.5;

/// `from` with one of the robot's hands at work, retreated from what the last one stood at: any hand, while nothing is held. The
/// other arms stay where they are, or are as in one of the postures. The same state for a robot with one hand.
pub fn at_work<'a, M: Manipulator>(
    m: &Tabletop<M>,
    from: &'a TabletopState<M>,
    rng: &mut dyn Rng,
) -> Cow<'a, TabletopState<M>> {
    let robot = m.manipulator();
    let hands = robot.hands();
    if hands < 2 || from.mode.held().is_some() {
        return Cow::Borrowed(from);
    }
    let hand = rng.random_range(0..hands);
    let mut arm = from.robot.arm.with_hand_at_work(hand);
    let postures = &m.settings().postures;
    if !postures.is_empty()
        && !rng.random_bool(STAY_SHARE)
        && let Some(posture) = postures.get(rng.random_range(0..postures.len()))
    {
        arm = robot.with_others_at(&arm, posture);
    }
    let mode = from.mode.disengaged().unwrap_or_else(|| from.mode.clone()).with_hand(hand);
    let robot = Configuration { base: from.robot.base, arm };
    Cow::Owned(TabletopState::<M> { robot, mode, objects: from.objects.clone() })
}
