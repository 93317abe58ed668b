//! Do the links of the hand, the facts about it and the weights of the joints speak of one robot, in metres?

use darrt_core::laws::{Broken, ensure};
use nalgebra::{Isometry3, Point3};

use super::travel::directions;
use super::{ARM_MOVES, GAP_METRES, TIPS, Trial, WEIGHTS};
use crate::laws::tabletop::corners;
use crate::manipulator::{Configuration, LinkGroup, Manipulator};

/// How far the links of the fingers may reach beyond the tips, or the tips beyond the links, metres.
const TIP_SLACK_M: f64 = 0.05;
/// What the links of the fingers may lack to the gap, metres: shapes are rounded.
const SPAN_SLACK_M: f64 = 0.005;
/// Share of the difference of two gaps by which the fingers may move more or less: some move on arcs.
const OPENS_SLACK: f64 = 0.5;
/// By what factor a weight may differ from what the hand travels: it is typical, and the travel that of one configuration.
const WEIGHT_FACTOR: f64 = 30.0;
/// What the hand is taken to hold, metres beyond the tool, for the weight of a joint that only turns the hand.
const HELD_M: f64 = 0.1;
/// Joint travel by which what a joint does is measured, radians or metres.
const SMALL: f64 = 1e-3;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn hand(&self) -> Result<(), Broken> {
        self.arm_moves()?;
        self.gap_is_in_metres()?;
        self.tips()?;
        self.weights()
    }

    fn links_of(&self, group: LinkGroup) -> impl Iterator<Item = usize> + '_ {
        let links = self.robot.links().iter().enumerate();
        links.filter(move |(_, link)| link.group == group).map(|(number, _)| number)
    }

    /// Every link of the arm stands elsewhere when every joint does.
    fn arm_moves(&self) -> Result<(), Broken> {
        let joints = self.a.arm.as_ref().iter().zip(self.b.arm.as_ref());
        if joints.clone().any(|(a, b)| (a - b).abs() < SMALL) {
            return Ok(());
        }
        let there = Configuration { arm: self.b.arm, ..*self.a };
        let [before, after] = [self.a, &there].map(|q| self.poses(q, self.gaps_m[0]));
        for link in self.links_of(LinkGroup::Arm) {
            let stays = before.get(link) == after.get(link);
            ensure(ARM_MOVES, !stays, || "where it was".to_owned(), "elsewhere, with all joints elsewhere")
                .map_err(|broken| broken.of(self.link_name(link)))?;
        }
        Ok(())
    }

    /// Corners of the fingers in the frame of the tool.
    fn finger_corners(&self, gap_m: f64) -> Vec<Point3<f64>> {
        let poses = self.poses(self.a, gap_m);
        let tool_from_world = self.robot.world_from_tool(self.a).inverse();
        let links = self
            .links_of(LinkGroup::Finger)
            .filter_map(|link| Some((self.robot.links().get(link)?, tool_from_world * poses.get(link)?)));
        let points = links.flat_map(|(link, pose)| {
            let points: Vec<_> = corners(&link.body, &Isometry3::identity()).collect();
            points.into_iter().map(move |point| pose * point)
        });
        points.collect()
    }

    fn gap_is_in_metres(&self) -> Result<(), Broken> {
        let span_m = |gap_m: f64| {
            let points = self.finger_corners(gap_m);
            let ends = points.iter().map(|point| point.y);
            let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| [low.min(y), high.max(y)]);
            (!points.is_empty()).then_some(high - low)
        };
        let widest_m = self.robot.hand().max_gap_m();
        for gap_m in [self.gaps_m[0], self.gaps_m[1], widest_m] {
            let Some(span) = span_m(gap_m) else { return Ok(()) };
            let text = || format!("links that span {span:?} m with a gap of {gap_m:?} m");
            ensure(GAP_METRES, span + SPAN_SLACK_M >= gap_m, text, "at least the gap")?;
        }
        let [Some(closed), Some(open)] = [0.0, widest_m].map(span_m) else { return Ok(()) };
        let opened_m = open - closed;
        let is_near = (opened_m - widest_m).abs() <= OPENS_SLACK * widest_m;
        let text = || format!("links that move apart by {opened_m:?} m when the gap opens by {widest_m:?} m");
        ensure(GAP_METRES, is_near, text, "as far as the gap opens, within half of it")
    }

    fn tips(&self) -> Result<(), Broken> {
        for gap_m in self.gaps_m {
            let reach_m = self.finger_corners(gap_m).iter().map(|point| point.x).fold(f64::NEG_INFINITY, f64::max);
            let tips_m = self.robot.hand().tip_beyond_tool_m(gap_m);
            let holds = reach_m.is_infinite() || (reach_m - tips_m).abs() <= TIP_SLACK_M;
            let text = || format!("tips {tips_m:?} m beyond the tool, links {reach_m:?} m, gap {gap_m:?} m");
            ensure(TIPS, holds, text, "the same, within 5 cm")?;
        }
        Ok(())
    }

    /// A joint at a time.
    fn weights(&self) -> Result<(), Broken> {
        let held: Vec<Point3<f64>> = directions().map(|d| Point3::from(d * HELD_M)).collect();
        let at = [self.a, self.b].map(|q| (q, self.robot.world_from_tool(q)));
        for (joint, weight_m) in self.robot.joint_weights_m().iter().enumerate() {
            let travel_m = at.iter().map(|(q, tool)| {
                let mut moved = **q;
                moved.arm.as_mut().iter_mut().skip(joint).take(1).for_each(|value| *value += SMALL);
                let after = self.robot.world_from_tool(&moved);
                held.iter().map(|point| (after * point - tool * point).norm()).fold(0.0, f64::max) / SMALL
            });
            let most_m = travel_m.fold(0.0, f64::max);
            let is_near = most_m == 0.0 || (weight_m / most_m).max(most_m / weight_m) <= WEIGHT_FACTOR;
            let text = || format!("weight {weight_m:?} m, travel {most_m:?} m per unit");
            ensure(WEIGHTS, is_near, text, "the same, within a factor of thirty")
                .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
        }
        Ok(())
    }
}
