//! By how much what looks alike from all sides is to be turned.

use std::f64::consts::{PI, TAU};

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure, equal};
use darrt_core::random::{Purpose, stream};
use nalgebra::{Isometry3, Point2, Translation3};
use rand::RngExt;

use super::{SEEDED, TURN, Trial};
use crate::action::turned::turned_about;
use crate::manipulator::{Configuration, JointVector as _, Manipulator};

/// How often each of the two configurations is turned away.
const TURNS: u64 = 4;
/// So many answers are judged together, at least.
const FEWEST: u32 = 3;
/// How many configurations are drawn for a pose that is to be reached.
const DRAWS: u64 = 8;
/// How far the middle of what is in the hand is beside the tool, metres.
const ASIDE_M: f64 = 0.1;
/// So many joints bring a hand to any heading.
const FREEDOM: usize = 6;

impl<M: Manipulator> Trial<'_, M> {
    /// Poses that are reached, turned away about something beside the tool, and about the tool itself.
    pub(super) fn turn(&self) -> Result<(), Broken> {
        self.turned_away(ASIDE_M).and_then(|()| self.turned_away(0.0))
    }

    fn turned_away(&self, aside_m: f64) -> Result<(), Broken> {
        let (mut answers, mut reached) = (0_u32, 0_u32);
        for (q, number) in [(self.a, 0), (self.b, 1)] {
            let tool = self.robot.world_from_tool(q);
            for attempt in 0..TURNS {
                let mut rng = self.rng(TURNS * number + attempt);
                let bearing = rng.random_range(-PI..PI);
                let at = tool.translation.vector;
                let centre = Point2::new(at.x + aside_m * bearing.cos(), at.y + aside_m * bearing.sin());
                let pose = turned_about(&tool, &centre, rng.random_range(-PI..PI));
                let Some(turn) = self.asked(&q.base, &pose, &centre, attempt)? else { continue };
                let turned = turned_about(&pose, &centre, turn);
                let mut draws =
                    (0..DRAWS).map(|draw| self.robot.inverse_from(&q.arm, &q.base, &turned, &mut self.rng(draw)));
                answers += 1;
                reached += u32::from(draws.any(|found| found.is_some()));
            }
        }
        let text =
            || format!("{reached} of {answers} poses reached as they were to be turned, {aside_m} m beside the tool");
        ensure(TURN, answers < FEWEST || 2 * reached >= answers, text, "at least half")
    }

    /// An answer, which is the same for the same generator.
    fn asked(
        &self,
        base: &[f64; 3],
        pose: &Isometry3<f64>,
        centre: &Point2<f64>,
        attempt: u64,
    ) -> Result<Option<f64>, Broken> {
        entering("turn_to_reach");
        let ask = |attempt| self.robot.turn_to_reach_with(self.at_work(), base, pose, centre, &mut self.rng(attempt));
        let found = ask(attempt);
        let is_angle = found.is_none_or(|turn| turn.abs() <= TAU);
        ensure(TURN, is_angle, || format!("{found:?}"), "radians, a turn at most")?;
        let _ = ask(attempt + 1);
        equal(SEEDED, &ask(attempt), &found).map_err(|broken| broken.of("turn_to_reach"))?;
        Ok(found)
    }
}

/// How many of the poses of these configurations, each turned by chance, the arm reaches or turns; `None` where it is not asked.
pub(super) fn found<M: Manipulator>(robot: &M, configurations: &[Configuration<M::Joints>], seed: u64) -> Option<u32> {
    let first = configurations.first()?;
    let tool = robot.world_from_tool(first);
    let elsewhere = Translation3::new(1.0, 1.0, 0.0) * tool;
    let hand = first.arm.hand_at_work();
    let [here, there] =
        [&tool, &elsewhere].map(|tool| robot.base_for_hand(hand, tool, &mut stream(seed, 0, 2, Purpose::Extend)));
    let movable = robot.limits().iter().filter(|limit| limit.upper > limit.lower).count();
    if movable >= FREEDOM || here != there {
        return None;
    }
    let found = configurations.iter().zip(0..).filter(|(q, attempt)| {
        let mut rng = stream(seed, *attempt, 3, Purpose::Extend);
        let tool = robot.world_from_tool(q);
        let centre = Point2::from(tool.translation.vector.xy());
        let pose = turned_about(&tool, &centre, rng.random_range(-PI..PI));
        robot.inverse_from(&q.arm, &q.base, &pose, &mut rng).is_some()
            || robot.turn_to_reach_with(q.arm.hand_at_work(), &q.base, &pose, &centre, &mut rng).is_some()
    });
    u32::try_from(found.count()).ok()
}
