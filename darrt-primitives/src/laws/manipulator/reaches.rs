//! Is the inverse of any use?

use darrt_core::laws::{Broken, at_most};
use darrt_core::random::{Purpose, stream};

use super::{BASE_FINDS, INVERSE_FINDS, TURN_FINDS, turn};
use crate::manipulator::{Configuration, JointVector as _, Manipulator};

/// How often a robot claims to find something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachClaims {
    /// Share of the poses that can be reached for which a draw of `inverse` finds a configuration, in `[0, 1]`.
    pub inverse: f64,
    /// Share of the bases drawn for those poses from which `may_reach` is true.
    pub base: f64,
    /// Share of those poses, turned any way about the vertical, that `inverse` reaches or `turn_to_reach` turns; asked of arms of
    /// fewer than six joints that do not drive.
    pub turned: f64,
}

impl Default for ReachClaims {
    fn default() -> Self {
        Self { inverse: 0.9, base: 0.9, turned: 0.5 }
    }
}

/// For the tool poses of `configurations`, all within the limits: how often inverse, base and turn are found.
///
/// # Errors
/// [`INVERSE_FINDS`], [`BASE_FINDS`] or [`TURN_FINDS`] with both shares.
pub fn check_reaches<M: Manipulator>(
    robot: &M,
    configurations: &[Configuration<M::Joints>],
    seed: u64,
    claims: &ReachClaims,
) -> Result<(), Broken> {
    let (mut found, mut reached) = (0_u32, 0_u32);
    for (q, attempt) in configurations.iter().zip(0..) {
        let mut rng = stream(seed, attempt, 0, Purpose::Extend);
        let tool = robot.world_from_tool(q);
        found += u32::from(robot.inverse_from(&q.arm, &q.base, &tool, &mut rng).is_some());
        let hand = q.arm.hand_at_work();
        let base = robot.base_for_hand(hand, &tool, &mut rng);
        reached += u32::from(robot.may_reach_with(hand, &base, &tool));
    }
    let share = |count: u32| f64::from(count) / configurations.len().max(1) as f64;
    // A share that is large enough is one whose rest is small enough.
    let check = |law, count, claimed: f64| at_most(law, 1.0 - share(count), 1.0 - claimed, 1e-9);
    let all = check(INVERSE_FINDS, found, claims.inverse)
        .and_then(|()| check(BASE_FINDS, reached, claims.base))
        .and_then(|()| match turn::found(robot, configurations, seed) {
            Some(found) => check(TURN_FINDS, found, claims.turned),
            None => Ok(()),
        });
    all.map_err(|broken| {
        let broken = broken.of("share of failures");
        broken.replayed_by(|| format!("check_reaches(&robot, {} configurations, {seed})", configurations.len()))
    })
}
