//! Where two pieces of a plan meet, the hands of a robot with several may be open otherwise in the one than in the other.

use std::collections::BTreeMap;

use darrt_primitives::contract::Contract;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::primitive::STANDARD;

use crate::plan_file::tool::{fingers_alone, tool_links};
use crate::plan_file::{JointTable, Step, Waypoint};
use crate::problem_file::PrimitiveName;
use crate::robot::RobotFacts;

/// The steps in which the hands, but for one, open or close from where they are to where `wanted` has them, while all else stands.
/// Moves `here` along. None for a robot with one hand that is left out, and where joints are not the robot's.
pub(super) fn readied(facts: &RobotFacts, here: &mut Waypoint, wanted: &Waypoint, but_for: Option<usize>) -> Vec<Step> {
    let mut steps = Vec::new();
    let Ok(tree) = KinematicTree::new(&facts.description) else { return steps };
    let table = JointTable::new(&facts.description, &tree);
    let (Ok(mut joints), Ok(there)) = (table.variables(&here.joints), table.variables(&wanted.joints)) else {
        return steps;
    };
    for (hand, (finger, tool)) in facts.finger_joints().zip(tool_links(facts)).enumerate() {
        let finger = tree.variable_index(finger).filter(|_| but_for != Some(hand));
        let values = finger.and_then(|finger| Some((joints.get_mut(finger)?, there.get(finger)?)));
        let Some((value, wanted)) = values.filter(|(value, wanted)| **value != **wanted) else { continue };
        *value = *wanted;
        let opened = Waypoint { joints: table.complete(&joints), ..here.clone() };
        steps.push(fingers_alone((hand > 0).then(|| tool.to_owned()), [here.clone(), opened.clone()]));
        *here = opened;
    }
    steps
}

/// What those steps keep to.
pub(super) fn add_contract(contracts: &mut BTreeMap<PrimitiveName, Contract>, steps: &[Step]) {
    if steps.iter().any(|step| step.primitive == PrimitiveName::ARM_TRANSIT) {
        let standard = STANDARD.iter().filter(|(id, _)| PrimitiveName::ARM_TRANSIT.as_str() == id.name());
        for (_, contract) in standard {
            contracts.entry(PrimitiveName::ARM_TRANSIT).or_insert(*contract);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{LEFT_TOOL, both_hands, facts, left_handed};

    #[test]
    fn hands_are_readied_one_after_the_other() {
        let plan = left_handed();
        let both = both_hands(&plan.problem);
        let mut wanted = plan.start.clone();
        let fingers = wanted.joints.iter_mut().filter(|(name, _)| name.contains("_gripper_"));
        fingers.for_each(|(_, value)| *value = 0.3);
        let ready = |but_for| {
            let mut here = plan.start.clone();
            (readied(&both, &mut here, &wanted, but_for), here)
        };
        let (steps, here) = ready(None);
        assert_eq!(here, wanted);
        assert_eq!(steps.iter().map(|step| step.tool.as_deref()).collect::<Vec<_>>(), [None, Some(LEFT_TOOL)]);
        assert_eq!(steps[0].waypoints[0], plan.start);
        assert_eq!(steps[0].waypoints[1], steps[1].waypoints[0]);
        assert_eq!(steps[1].waypoints[1], wanted);
        let (steps, here) = ready(Some(0));
        assert_eq!((steps.len(), steps[0].tool.as_deref()), (1, Some(LEFT_TOOL)));
        assert_eq!(here.joints["r_gripper_l_finger_joint"], plan.start.joints["r_gripper_l_finger_joint"]);
        let mut here = plan.start.clone();
        assert!(readied(&facts(&plan.problem), &mut here, &wanted, Some(0)).is_empty() && here == plan.start);
    }
}
