//! What the facts name, and whether it is there.

use std::collections::BTreeSet;

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure, equal};
use darrt_primitives::manipulator::{Configuration, JointVector as _, LinkGroup};
use nalgebra::{Isometry3, Point3, Vector3};

use super::{LIMITS, PAIRS, POSTURES, ROLES, ROUNDING, SAME, START, Trial};
use crate::robot::{RobotFacts, TaskRobot};

/// No posture has this name.
const NO_POSTURE: &str = "no-posture-of-this-name";

impl<M: TaskRobot> Trial<'_, M> {
    pub(super) fn postures(&self) -> Result<(), Broken> {
        entering("posture_names");
        let names = M::posture_names(self.settings)
            .map_err(|error| Broken::new(POSTURES, error.to_string(), "the names of the postures"))?;
        let distinct: BTreeSet<_> = names.iter().collect();
        ensure(POSTURES, distinct.len() == names.len(), || format!("{names:?}"), "each once")?;
        entering("posture");
        for name in &names {
            let of = |broken: Broken| broken.of(format_args!("posture `{name}`"));
            let arm = self.robot.posture(name);
            let arm = arm.ok_or_else(|| of(Broken::new(POSTURES, "none", "the joints of the posture")))?;
            self.within_hard_limits(&arm).map_err(of)?;
            equal(POSTURES, &self.robot.posture(name), &Some(arm)).map_err(of)?;
        }
        let found = self.robot.posture(NO_POSTURE);
        ensure(POSTURES, found.is_none(), || format!("{found:?} for `{NO_POSTURE}`"), "none")
    }

    /// A posture may be one to park an arm in: the limits are those of the description, not the narrower ones that it is planned with.
    fn within_hard_limits(&self, arm: &M::Joints) -> Result<(), Broken> {
        let values = arm.as_ref();
        equal(POSTURES, &values.len(), &self.robot.limits().len()).map_err(|broken| broken.of("number of joints"))?;
        for (joint, value) in self.facts.all_arm_joints().into_iter().zip(values) {
            let variable = self.variable(POSTURES, joint)?;
            let Some(limit) = self.tree.variables().get(variable).map(|known| known.limit) else { continue };
            let holds = value.is_finite() && (limit.is_unlimited() || limit.contains(*value));
            ensure(POSTURES, holds, || format!("{value:?}, limits {limit:?}"), "a value within the limits")
                .map_err(|broken| broken.of(joint))?;
        }
        Ok(())
    }

    pub(super) fn roles(&self) -> Result<(), Broken> {
        let facts = self.facts;
        equal(ROLES, &facts.hands(), &self.robot.hands()).map_err(|broken| broken.of("hands"))?;
        let all = facts.all_arm_joints();
        equal(ROLES, &all.len(), &self.robot.limits().len()).map_err(|broken| broken.of("arm joints"))?;
        let fingers: BTreeSet<_> = facts.finger_joints().collect();
        ensure(ROLES, fingers.len() == facts.hands(), || format!("{fingers:?}"), "one for each hand")?;
        (0..facts.hands()).try_for_each(|hand| self.roles_of(hand, &facts.of_hand(hand)))
    }

    /// The roles for one of the hands.
    fn roles_of(&self, hand: usize, facts: &RobotFacts) -> Result<(), Broken> {
        let all = self.facts.all_arm_joints();
        let all = all.into_iter().map(|joint| self.variable(ROLES, joint)).collect::<Result<Vec<_>, _>>()?;
        let arm = facts.arm_joints.iter().map(|joint| self.variable(ROLES, joint)).collect::<Result<Vec<_>, _>>()?;
        let distinct: BTreeSet<_> = arm.iter().collect();
        ensure(ROLES, distinct.len() == arm.len(), || format!("{:?}", facts.arm_joints), "each once")?;
        let finger = self.variable(ROLES, &facts.finger_joint)?;
        ensure(ROLES, !all.contains(&finger), || facts.finger_joint.clone(), "a joint that is not the arm's")?;
        self.outwards(facts, &arm)?;
        let is_link = |name: &String| self.tree.link_index(name).is_some();
        let all = facts.finger_links.iter().chain(&facts.tip_links).chain([&facts.tool_link]);
        for name in all {
            ensure(ROLES, is_link(name), || format!("no link `{name}`"), "a link of the description")?;
        }
        let fingers: BTreeSet<&str> = facts.finger_links.iter().map(String::as_str).collect();
        let links = self.robot.links().iter().enumerate();
        let links = links.filter(|(_, link)| link.group == LinkGroup::Finger);
        for (_, link) in links.filter(|(number, _)| self.robot.hand_of_link(*number) == hand) {
            let is_named = fingers.contains(&*link.body.name);
            ensure(ROLES, is_named, || format!("{} is not among the finger links", link.body.name), "all fingers")?;
        }
        let [left, right] = &facts.tip_links;
        let holds = left != right && [left, right].iter().all(|tip| fingers.contains(tip.as_str()));
        ensure(ROLES, holds, || format!("tips {left} and {right}"), "two of the finger links")?;
        self.tips(hand, facts)
    }

    /// Each joint of the arm moves a link that stands beyond those that the joints before it move.
    fn outwards(&self, facts: &RobotFacts, arm: &[usize]) -> Result<(), Broken> {
        let link_of = |variable: &usize| self.tree.variables().get(*variable).map(|v| v.link);
        let is_above = |upper: usize, lower: usize| {
            let mut at = Some(lower);
            while let Some(link) = at {
                if link == upper {
                    return true;
                }
                at = self.tree.parent(link);
            }
            false
        };
        for pair in arm.windows(2) {
            let [Some(inner), Some(outer)] = [pair.first(), pair.last()].map(|v| v.and_then(link_of)) else { continue };
            let text = || format!("{:?}", facts.arm_joints);
            ensure(ROLES, is_above(inner, outer), text, "from the base outwards")?;
        }
        let (last, tool) = (arm.last().and_then(link_of), self.tree.link_index(&facts.tool_link));
        let holds = last.zip(tool).is_none_or(|(last, tool)| is_above(last, tool));
        ensure(ROLES, holds, || format!("tool link `{}`", facts.tool_link), "moved by the last joint of the arm")
    }

    /// The middle of the tip that is named first is on the side of +y of the tool.
    fn tips(&self, hand: usize, facts: &RobotFacts) -> Result<(), Broken> {
        let q = Configuration { base: [0.0; 3], arm: self.start.with_hand_at_work(hand) };
        let links = self.robot.links();
        let mut poses = vec![Isometry3::identity(); links.len()];
        self.robot.link_poses(&q, self.robot.hand_of(hand).max_gap_m(), &mut poses);
        let tool_from_world = self.robot.world_from_tool(&q).inverse();
        let middle = |name: &String| {
            let (link, pose) = links.iter().zip(&poses).find(|(link, _)| *link.body.name == **name)?;
            let boxes = link.body.parts.iter().map(|part| {
                let (low, high) = part.shape.local_aabb();
                let half = Vector3::from(std::array::from_fn::<f64, 3, _>(|i| 0.5 * (low[i] + high[i])));
                (tool_from_world * pose * part.body_from_shape * Point3::from(half)).y
            });
            let (sum, count) = boxes.fold((0.0, 0_u32), |(sum, count), y| (sum + y, count + 1));
            (count > 0).then(|| sum / f64::from(count))
        };
        let [Some(first), Some(second)] = facts.tip_links.each_ref().map(middle) else { return Ok(()) };
        let text = || format!("{} at y = {first:?} m, {} at y = {second:?} m", facts.tip_links[0], facts.tip_links[1]);
        ensure(ROLES, first > second, text, "the one at +y first")
    }

    pub(super) fn limits(&self) -> Result<(), Broken> {
        for (joint, limit) in self.facts.all_arm_joints().into_iter().zip(self.robot.limits()) {
            let variable = self.variable(LIMITS, joint)?;
            let Some(known) = self.tree.variables().get(variable) else { continue };
            let allowed = if self.facts.is_limited_softly { known.soft_limit } else { known.limit };
            let holds = allowed.is_unlimited()
                || limit.lower >= allowed.lower - ROUNDING && limit.upper <= allowed.upper + ROUNDING;
            ensure(
                LIMITS,
                holds,
                || format!("{limit:?}, the description {allowed:?}"),
                "no wider than the description",
            )
            .map_err(|broken| broken.of(joint))?;
        }
        Ok(())
    }

    pub(super) fn start(&self) -> Result<(), Broken> {
        let facts = self.facts;
        for named in [&facts.start, &facts.at_rest] {
            let distinct: BTreeSet<_> = named.iter().map(|(joint, _)| joint).collect();
            ensure(START, distinct.len() == named.len(), || format!("{named:?}"), "each joint once")?;
        }
        let q = Configuration { base: self.settings.base, arm: self.start };
        let values = self.robot.joint_values(&q, self.robot.hand().max_gap_m());
        for (joint, expected) in &facts.start {
            let variable = self.variable(START, joint)?;
            let found = values.get(variable).copied().unwrap_or(f64::NAN);
            let text = || format!("{found:?}, the facts {expected:?}");
            ensure(START, (found - expected).abs() <= ROUNDING, text, "the same").map_err(|b| b.of(joint))?;
        }
        let is_told = |joint: &&str| !facts.start.iter().any(|(name, _)| name == joint);
        let missing: Vec<_> = facts.all_arm_joints().into_iter().filter(is_told).collect();
        ensure(START, missing.is_empty(), || format!("nothing of {missing:?}"), "every joint of the arm")?;
        facts.at_rest.iter().try_for_each(|(joint, value)| {
            self.variable(START, joint)?;
            ensure(START, value.is_finite(), || format!("{joint} at {value:?}"), "a finite value")
        })
    }

    pub(super) fn pairs(&self) -> Result<(), Broken> {
        let link = |index: usize| self.robot.links().get(index).map(|link| &*link.body.name);
        for (a, b) in self.robot.self_pairs() {
            let (Some(a), Some(b)) = (link(*a), link(*b)) else { continue };
            let is_same = |pair: &[String; 2]| pair == &[a, b] || pair == &[b, a];
            ensure(
                PAIRS,
                self.facts.self_pairs.iter().any(is_same),
                || format!("{a} and {b} are missing"),
                "all pairs",
            )?;
        }
        for [a, b] in &self.facts.self_pairs {
            let holds = a != b && [a, b].iter().all(|name| self.tree.link_index(name).is_some());
            ensure(PAIRS, holds, || format!("{a} and {b}"), "two links of the description")?;
        }
        Ok(())
    }

    pub(super) fn same(&self) -> Result<(), Broken> {
        let (robot, facts) = (self.robot, self.facts);
        for hand in 0..facts.hands() {
            let (facts, hand) = (facts.of_hand(hand), robot.hand_of(hand));
            for (name, told, own) in [
                ("pad_length_m", facts.pad_length_m, hand.pad_length_m()),
                ("grip_force_n", facts.grip_force_n, hand.grip_force_n()),
            ] {
                equal(SAME, &told, &own).map_err(|broken| broken.of(name))?;
            }
        }
        // What each of the arms can do.
        let least = |first: f64, second: Option<f64>| second.map_or(first, |second| first.min(second));
        let second = facts.second.as_ref();
        let numbers = [
            ("payload_kg", least(facts.payload_kg, second.map(|hand| hand.payload_kg)), robot.payload_kg()),
            ("push_force_n", least(facts.push_force_n, second.map(|hand| hand.push_force_n)), robot.push_force_n()),
        ];
        for (name, told, own) in numbers {
            equal(SAME, &told, &own).map_err(|broken| broken.of(name))?;
        }
        equal(SAME, &facts.is_bolted, &!robot.drives()).map_err(|broken| broken.of("is_bolted"))?;
        equal(SAME, &facts.drives_along_heading, &robot.drives_along_heading())
            .map_err(|broken| broken.of("drives_along_heading"))
    }
}
