//! A robot with several hands: which of them is meant, and what the others do meanwhile.

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure, equal};
use nalgebra::Isometry3;

use super::{HANDS_GAP, HANDS_IDLE, HANDS_INVERSE, HANDS_LINKS, HANDS_OTHERS, Trial, VECTOR, same_pose};
use crate::manipulator::{Configuration, JointVector, LinkGroup, Manipulator};

/// Joint travel by which what a joint does is measured, radians or metres.
const SMALL: f64 = 1e-3;
/// How many solutions are drawn.
const DRAWS: u64 = 4;

/// Does a joint alone move the hand that is at work in `q`?
pub(super) fn moves_hand<M: Manipulator>(robot: &M, q: &Configuration<M::Joints>, joint: usize) -> bool {
    let mut moved = *q;
    moved.arm.as_mut().iter_mut().skip(joint).take(1).for_each(|value| *value += SMALL);
    robot.world_from_tool(&moved) != robot.world_from_tool(q)
}

impl<M: Manipulator> Trial<'_, M> {
    /// Laws of robots with several hands; nothing is asked of one with one.
    pub(super) fn hands(&self) -> Result<(), Broken> {
        let hands = self.robot.hands();
        ensure(HANDS_LINKS, hands > 0, || "no hand".to_owned(), "at least one")?;
        let text = || format!("hand {} at work, of {hands}", self.hand);
        ensure(HANDS_LINKS, self.hand < hands, text, "one that there is")?;
        if hands < 2 {
            return Ok(());
        }
        self.vector(hands)?;
        self.links_of_hands(hands)?;
        self.only_its_arm()?;
        self.others()?;
        self.idle(hands)
    }

    /// Which hand is at work is kept, and tells vectors apart.
    fn vector(&self, hands: usize) -> Result<(), Broken> {
        for hand in 0..hands {
            let arm = self.a.arm.with_hand_at_work(hand);
            let wrong = |broken: Broken| broken.of("with_hand_at_work");
            equal(VECTOR, &arm.hand_at_work(), &hand).map_err(wrong)?;
            equal(VECTOR, &arm.as_ref().to_vec(), &self.a.arm.as_ref().to_vec()).map_err(wrong)?;
            let text = || format!("hand {hand} and hand {}: {}", self.hand, arm == self.a.arm);
            ensure(VECTOR, (arm == self.a.arm) == (hand == self.hand), text, "equal only for the same hand")
                .map_err(|broken| broken.of("eq"))?;
        }
        Ok(())
    }

    fn links_of_hands(&self, hands: usize) -> Result<(), Broken> {
        entering("hand_of_link");
        let links = self.robot.links().iter().enumerate();
        let of_hands = links.filter(|(_, link)| matches!(link.group, LinkGroup::Hand | LinkGroup::Finger));
        let mut fingers = vec![0_usize; hands];
        for (number, link) in of_hands {
            let hand = self.robot.hand_of_link(number);
            ensure(HANDS_LINKS, hand < hands, || format!("hand {hand} of {hands}"), "one that there is")
                .map_err(|broken| broken.of(&*link.body.name))?;
            let is_finger = link.group == LinkGroup::Finger;
            fingers.iter_mut().skip(hand).take(usize::from(is_finger)).take(1).for_each(|count| *count += 1);
        }
        let text = || format!("{fingers:?} fingers by hand");
        ensure(HANDS_LINKS, fingers.iter().all(|count| *count > 0), text, "some for every hand")
    }

    /// A configuration for a pose of one hand leaves the other arms as they are.
    fn only_its_arm(&self) -> Result<(), Broken> {
        let tool = self.robot.world_from_tool(self.b);
        let drawn = (0..DRAWS).filter_map(|draw| Some(("inverse_from", self.inverse_of(&self.b.base, &tool, draw)?)));
        let at_a = self.robot.world_from_tool(self.a);
        let near = self.robot.inverse_near(&self.a.base, &at_a, &self.a.arm).map(|arm| ("inverse_near", arm));
        for (call, arm) in drawn.chain(near) {
            equal(HANDS_INVERSE, &arm.hand_at_work(), &self.hand).map_err(|broken| broken.of(call))?;
            for (joint, (was, is)) in self.a.arm.as_ref().iter().zip(arm.as_ref()).enumerate() {
                let stays = was.to_bits() == is.to_bits() || moves_hand(self.robot, self.a, joint);
                ensure(
                    HANDS_INVERSE,
                    stays,
                    || format!("{is:?}, was {was:?}"),
                    "where it was: it does not move the hand",
                )
                .map_err(|broken| broken.of(format_args!("{call}, joint {joint}")))?;
            }
        }
        Ok(())
    }

    fn others(&self) -> Result<(), Broken> {
        entering("with_others_at");
        let arm = self.robot.with_others_at(&self.a.arm, &self.b.arm);
        equal(HANDS_OTHERS, &arm.hand_at_work(), &self.hand)?;
        let there = Configuration { arm, ..*self.a };
        let tool = |q| self.robot.world_from_tool(q);
        same_pose(HANDS_OTHERS, &tool(&there), &tool(self.a), self.claims.pose).map_err(|broken| broken.of("tool"))?;
        let joints = self.a.arm.as_ref().iter().zip(self.b.arm.as_ref()).zip(arm.as_ref());
        for (joint, ((now, posture), is)) in joints.enumerate() {
            let wanted = if moves_hand(self.robot, self.a, joint) { now } else { posture };
            ensure(
                HANDS_OTHERS,
                is.to_bits() == wanted.to_bits(),
                || format!("{is:?}, not {wanted:?}"),
                "as asked for",
            )
            .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
        }
        Ok(())
    }

    fn idle(&self, hands: usize) -> Result<(), Broken> {
        let idle_m = self.robot.idle_gap_m();
        let fits = (0..hands).all(|hand| (0.0..=self.robot.hand_of(hand).max_gap_m()).contains(&idle_m));
        ensure(HANDS_IDLE, fits, || format!("{idle_m:?} m"), "a gap to which every hand opens")?;
        let poses = |hand, gap_m| {
            let arm = self.a.arm.with_hand_at_work(hand);
            self.poses(&Configuration { arm, ..*self.a }, gap_m)
        };
        let expected = poses(self.hand, idle_m);
        for hand in 0..hands {
            self.stand_alike(HANDS_IDLE, &poses(hand, idle_m), &expected, |_| true)?;
        }
        let is_other = |link: usize| self.robot.hand_of_link(link) != self.hand;
        for gap_m in self.gaps_m {
            self.stand_alike(HANDS_GAP, &poses(self.hand, gap_m), &expected, is_other)?;
        }
        Ok(())
    }

    /// The links that `counts` names.
    fn stand_alike(
        &self,
        law: &'static str,
        found: &[Isometry3<f64>],
        expected: &[Isometry3<f64>],
        counts: impl Fn(usize) -> bool,
    ) -> Result<(), Broken> {
        let both = found.iter().zip(expected).enumerate().filter(|(link, _)| counts(*link));
        for (link, (found, expected)) in both {
            same_pose(law, found, expected, self.claims.pose).map_err(|broken| broken.of(self.link_name(link)))?;
        }
        Ok(())
    }
}
