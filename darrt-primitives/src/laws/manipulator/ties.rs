//! What ties the hand, and the other facts that a robot tells of itself.

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure, equal};
use nalgebra::Isometry3;

use super::{PURE, TIES, TIES_ALL, Trial};
use crate::hand_ties::up_in_tool;
use crate::manipulator::{Configuration, Manipulator};

/// So many configurations are drawn to see what they have in common.
const CONFIGURATIONS: usize = 16;
/// A joint with a smaller range is held still, radians or metres.
const STILL: f64 = 1e-2;
/// What differs by less in all of them does not change, metres and radians.
const SAME: f64 = 1e-9;
/// By how much an axis may be longer or shorter than 1.
const UNIT: f64 = 1e-6;

/// What a robot tells of itself in numbers, by the function that tells it.
pub(super) type Told = Vec<(&'static str, Vec<u64>)>;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn ties(&self) -> Result<(), Broken> {
        entering("hand_ties");
        let ties = self.robot.hand_ties_of(self.at_work());
        let length = ties.up_in_tool.map_or(1.0, |up| up.norm());
        ensure(TIES, (length - 1.0).abs() <= UNIT, || format!("an axis of length {length:?}"), "a unit vector")?;
        let text = || format!("{ties:?}");
        ensure(TIES, ties.height_m.is_none_or(f64::is_finite), text, "a finite height, or none")?;
        let tools = self.tools();
        for tool in &tools {
            if !ties.allow(tool) {
                let up = up_in_tool(tool);
                let found = format!("the hand {:?} m high, up in its frame {:?}", tool.translation.z, up.as_slice());
                return Err(Broken::new(TIES, found, format!("{ties:?}")));
            }
        }
        // What is held still by its limits may yet change the hand.
        let is_still = self.robot.limits().iter().any(|limit| limit.upper - limit.lower < STILL);
        let Some((first, rest)) = tools.split_first().filter(|_| !is_still) else { return Ok(()) };
        let up = up_in_tool(first);
        let tilts = rest.iter().any(|tool| (up_in_tool(tool) - up).norm() > SAME);
        let text = || format!("no tie of its tilt, but up is {:?} in its frame wherever it is", up.as_slice());
        ensure(TIES_ALL, tilts || ties.up_in_tool.is_some(), text, "that tilt")?;
        let height_m = first.translation.z;
        let rises = rest.iter().any(|tool| (tool.translation.z - height_m).abs() > SAME);
        let text = || format!("no tie of its height, but it is {height_m:?} m high wherever it is");
        ensure(TIES_ALL, rises || ties.height_m.is_some(), text, "that height")
    }

    /// The hand in both configurations and in some that are drawn.
    fn tools(&self) -> Vec<Isometry3<f64>> {
        let mut rng = self.rng(11);
        let drawn = (0..CONFIGURATIONS).map(|_| Configuration { base: self.a.base, ..self.anywhere(&mut rng) });
        [*self.a, *self.b].into_iter().chain(drawn).map(|q| self.robot.world_from_tool(&q)).collect()
    }

    pub(super) fn told(&self) -> Told {
        let (robot, hand) = (self.robot, self.hand_facts());
        let ties = robot.hand_ties_of(self.at_work());
        let up = ties.up_in_tool.map_or_else(Vec::new, |up| up.iter().copied().collect());
        let tips = self.gaps_m.map(|gap_m| hand.tip_beyond_tool_m(gap_m));
        let limits = robot.limits().iter().flat_map(|limit| [limit.lower, limit.upper]).collect();
        let pairs = robot.self_pairs().iter().flat_map(|(i, j)| [*i as f64, *j as f64]).collect();
        let numbers = [
            ("limits", limits),
            ("joint_weights_m", robot.joint_weights_m().to_vec()),
            ("links", vec![robot.links().len() as f64]),
            ("self_pairs", pairs),
            ("payload_kg", vec![robot.payload_kg()]),
            ("push_force_n", vec![robot.push_force_n()]),
            ("drives_along_heading", vec![f64::from(u8::from(robot.drives_along_heading()))]),
            ("hand_ties", up),
            ("hand_ties", ties.height_m.into_iter().collect()),
            ("max_gap_m", vec![hand.max_gap_m()]),
            ("tip_beyond_tool_m", tips.to_vec()),
            ("tip_half_width_m", vec![hand.tip_half_width_m()]),
            ("pad_length_m", vec![hand.pad_length_m()]),
            ("grip_force_n", vec![hand.grip_force_n()]),
        ];
        numbers.map(|(name, values)| (name, values.into_iter().map(f64::to_bits).collect())).to_vec()
    }

    /// What was told before all other questions is told again.
    pub(super) fn tells_the_same(&self, before: &Told) -> Result<(), Broken> {
        let numbers = |bits: &[u64]| bits.iter().map(|bits| f64::from_bits(*bits)).collect::<Vec<_>>();
        for ((name, again), (_, first)) in self.told().iter().zip(before) {
            if again != first {
                equal(PURE, &numbers(again), &numbers(first)).map_err(|broken| broken.of(*name))?;
            }
        }
        Ok(())
    }
}
