//! Do the links of the hand, the facts about it and the weights of the joints speak of one robot, in metres?

use darrt_core::laws::{Broken, ensure};
use darrt_geom::body::{Body, Part};
use darrt_geom::oracle::{PosedBody, intersections};
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use super::travel::directions;
use super::{ARM_MOVES, CENTRED, CLEAR, GAP_METRES, JOINTS, TIPS, Trial, WEIGHTS};
use crate::laws::tabletop::corners;
use crate::manipulator::{Configuration, LinkGroup, Manipulator};

/// How far the links of the fingers may reach beyond the tips, or the tips beyond the links, metres.
const TIP_SLACK_M: f64 = 0.05;
/// By what factor tips may be wider or narrower than the links of the fingers.
const WIDTH_FACTOR: f64 = 20.0;
/// How far off the middle between the fingers the tool may be, metres: shapes are rounded.
const CENTRE_SLACK_M: f64 = 0.015;
/// So far ahead of the tips there is nothing of the hand, metres.
const AHEAD_M: f64 = 0.1;
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
        self.widths()?;
        self.centred()?;
        self.clear()?;
        self.joints()?;
        self.weights()
    }

    /// The links of a group, but for those of hands that are not at work.
    fn links_of(&self, group: LinkGroup) -> impl Iterator<Item = usize> + '_ {
        let links = self.robot.links().iter().enumerate();
        let of_group = links.filter(move |(_, link)| link.group == group).map(|(number, _)| number);
        of_group.filter(|link| !self.is_idle(*link))
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
        let widest_m = self.hand_facts().max_gap_m();
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
            let tips_m = self.hand_facts().tip_beyond_tool_m(gap_m);
            let holds = reach_m.is_infinite() || (reach_m - tips_m).abs() <= TIP_SLACK_M;
            let text = || format!("tips {tips_m:?} m beyond the tool, links {reach_m:?} m, gap {gap_m:?} m");
            ensure(TIPS, holds, text, "the same, within 5 cm")?;
        }
        Ok(())
    }

    /// Tips and pads are as wide and as long as the links of the fingers, but for a factor that no shape explains.
    fn widths(&self) -> Result<(), Broken> {
        let points = self.finger_corners(self.gaps_m[0]);
        if points.is_empty() {
            return Ok(());
        }
        let extent = |axis: usize| {
            let all = points.iter().map(|point| point[axis]);
            let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            high - low
        };
        let hand = self.hand_facts();
        let (width_m, links_m) = (2.0 * hand.tip_half_width_m(), extent(2));
        let text = || format!("tips {width_m:?} m wide, links {links_m:?} m");
        let is_near = (1.0 / WIDTH_FACTOR..=WIDTH_FACTOR).contains(&(width_m / links_m));
        ensure(TIPS, is_near, text, "the same, within a factor of twenty")?;
        let (pad_m, finger_m) = (hand.pad_length_m(), extent(0));
        let text = || format!("pads {pad_m:?} m long, links {finger_m:?} m");
        ensure(TIPS, pad_m <= finger_m + TIP_SLACK_M, text, "no longer, within 5 cm")
    }

    /// The fingers on both sides of the tool are as far from it.
    fn centred(&self) -> Result<(), Broken> {
        for gap_m in [self.gaps_m[0], self.gaps_m[1], self.hand_facts().max_gap_m()] {
            let points = self.finger_corners(gap_m);
            for (axis, slack_m) in [(1, CENTRE_SLACK_M), (2, 0.0)] {
                let all = points.iter().map(|point| point[axis]);
                let [low, high] =
                    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
                let holds = points.is_empty()
                    || if axis == 1 { (low + high).abs() <= 2.0 * slack_m } else { low <= 0.0 && high >= 0.0 };
                let text =
                    || format!("fingers from {low:?} to {high:?} m along the tool's axis {axis}, gap {gap_m:?} m");
                ensure(CENTRED, holds, text, "the tool midway")?;
            }
        }
        Ok(())
    }

    /// Where something is grasped there is room for it.
    fn clear(&self) -> Result<(), Broken> {
        let hand = self.hand_facts();
        let gap_m = hand.max_gap_m();
        let tip_m = hand.tip_beyond_tool_m(gap_m);
        let (from_m, to_m) = (tip_m - 0.5 * hand.pad_length_m(), tip_m + AHEAD_M);
        let half = Vector3::new(0.5 * (to_m - from_m), 0.3 * gap_m, 0.6 * hand.tip_half_width_m());
        let unusable =
            |error: &dyn std::fmt::Display| Broken::new(CLEAR, error.to_string(), "a hand that can be placed");
        let shape = Shape::cuboid(half).map_err(|error| unusable(&error))?;
        let probe = Body::new("room between the tips", vec![Part::centred(shape)]).map_err(|error| unusable(&error))?;
        let tool = self.robot.world_from_tool(self.a);
        let middle = tool * Translation3::new(0.5 * (from_m + to_m), 0.0, 0.0);
        let poses = self.poses(self.a, gap_m);
        let links = self.links_of(LinkGroup::Hand).filter_map(|link| {
            Some(PosedBody { body: &self.robot.links().get(link)?.body, world_from_body: *poses.get(link)? })
        });
        let all: Vec<_> = std::iter::once(PosedBody { body: &probe, world_from_body: middle }).chain(links).collect();
        let found = intersections(&all, &|i, j| i != 0 && j != 0).map_err(|error| unusable(&error))?;
        let Some(hit) = found.first() else { return Ok(()) };
        let name = all.get(hit.first.max(hit.second)).map_or("a link", |posed| &*posed.body.name);
        Err(Broken::new(CLEAR, format!("{name} between the tips or ahead of them"), "room for what is grasped"))
    }

    /// A joint alone moves the tool or a link.
    fn joints(&self) -> Result<(), Broken> {
        let before = (self.robot.world_from_tool(self.a), self.poses(self.a, self.gaps_m[0]));
        for joint in 0..self.a.arm.as_ref().len() {
            let mut moved = *self.a;
            moved.arm.as_mut().iter_mut().skip(joint).take(1).for_each(|value| *value += SMALL);
            let after = (self.robot.world_from_tool(&moved), self.poses(&moved, self.gaps_m[0]));
            ensure(JOINTS, after != before, || "nothing moves".to_owned(), "the tool, or a link")
                .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
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
