//! Where tool and links are.

use darrt_core::laws::{Broken, ensure, equal};
use nalgebra::Isometry3;

use super::{
    BASE_FRAME, BASE_LINKS, FINGERS_FOLLOW, GAP, HAND_FOLLOWS, PURE, RIGID, Trial, same_pose, world_from_base,
};
use crate::manipulator::{Configuration, LinkGroup, Manipulator};

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn links(&self) -> Result<(), Broken> {
        for q in [self.a, self.b] {
            is_rigid(&self.robot.world_from_tool(q)).map_err(|broken| broken.of("tool"))?;
            for (link, pose) in self.poses(q, self.gaps_m[0]).iter().enumerate() {
                is_rigid(pose).map_err(|broken| broken.of(self.link_name(link)))?;
            }
            self.base_moves_all(q)?;
            self.gap_moves_fingers(q)?;
        }
        self.arm_moves_the_hand()?;
        self.purity()
    }

    /// From the origin to where `q` stands.
    fn base_moves_all(&self, q: &Configuration<M::Joints>) -> Result<(), Broken> {
        let home = Configuration { base: [0.0; 3], ..*q };
        let moved = world_from_base(&q.base);
        let tolerance = self.claims.pose;
        same_pose(BASE_FRAME, &self.robot.world_from_tool(q), &(moved * self.robot.world_from_tool(&home)), tolerance)
            .map_err(|broken| broken.of("tool"))?;
        let (found, at_home) = (self.poses(q, self.gaps_m[0]), self.poses(&home, self.gaps_m[0]));
        for (link, (found, at_home)) in found.iter().zip(&at_home).enumerate() {
            same_pose(BASE_FRAME, found, &(moved * at_home), tolerance)
                .map_err(|broken| broken.of(self.link_name(link)))?;
        }
        Ok(())
    }

    fn gap_moves_fingers(&self, q: &Configuration<M::Joints>) -> Result<(), Broken> {
        let [narrow, wide] = self.gaps_m.map(|gap_m| self.poses(q, gap_m));
        for (link, (narrow, wide)) in narrow.iter().zip(&wide).enumerate() {
            if self.group(link) != Some(LinkGroup::Finger) || self.is_idle(link) {
                same_pose(GAP, wide, narrow, self.claims.pose).map_err(|broken| broken.of(self.link_name(link)))?;
            }
        }
        Ok(())
    }

    /// From the arm of one configuration to that of the other, the base at rest.
    fn arm_moves_the_hand(&self) -> Result<(), Broken> {
        let there = Configuration { arm: self.b.arm, ..*self.a };
        let gap_m = self.gaps_m[0];
        let (before, after) = (self.poses(self.a, gap_m), self.poses(&there, gap_m));
        let [tool_before, tool_after] = [self.a, &there].map(|q| self.robot.world_from_tool(q));
        for (link, (before, after)) in before.iter().zip(&after).enumerate() {
            let rigid_to_tool = || tool_after * (tool_before.inverse() * before);
            let (law, expected) = match self.group(link).filter(|_| !self.is_idle(link)) {
                Some(LinkGroup::Base) => (BASE_LINKS, *before),
                Some(LinkGroup::Hand) => (HAND_FOLLOWS, rigid_to_tool()),
                Some(LinkGroup::Finger) => (FINGERS_FOLLOW, rigid_to_tool()),
                Some(LinkGroup::Arm) | None => continue,
            };
            same_pose(law, after, &expected, self.claims.pose).map_err(|broken| broken.of(self.link_name(link)))?;
        }
        Ok(())
    }

    /// The same answers, also after questions about another configuration and into a place that held another answer.
    pub(super) fn purity(&self) -> Result<(), Broken> {
        let gap_m = self.gaps_m[0];
        let (tool, links) = (self.robot.world_from_tool(self.a), self.poses(self.a, gap_m));
        let mut again = self.poses(self.b, self.gaps_m[1]);
        let _ = self.robot.world_from_tool(self.b);
        self.robot.link_poses(self.a, gap_m, &mut again);
        equal(PURE, &again, &links).map_err(|broken| broken.of("link_poses"))?;
        equal(PURE, &self.robot.world_from_tool(self.a), &tool).map_err(|broken| broken.of("world_from_tool"))?;
        let travel = || self.robot.travel_m(self.a, self.b, 0.1);
        equal(PURE, &travel(), &travel()).map_err(|broken| broken.of("travel_m"))?;
        let base = self.b.base;
        let reach = || self.may_reach(&base, &tool);
        equal(PURE, &reach(), &reach()).map_err(|broken| broken.of("may_reach"))
    }

    fn group(&self, link: usize) -> Option<LinkGroup> {
        self.robot.links().get(link).map(|l| l.group)
    }
}

pub(super) fn is_rigid(pose: &Isometry3<f64>) -> Result<(), Broken> {
    let place = pose.translation.vector;
    let norm = pose.rotation.quaternion().norm();
    let holds = place.iter().all(|x| x.is_finite()) && (norm - 1.0).abs() <= 1e-9;
    let text = || format!("{:?}, quaternion of norm {norm:?}", place.as_slice());
    ensure(RIGID, holds, text, "finite, quaternion of norm 1")
}
