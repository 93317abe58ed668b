//! Semantic descriptions: refused, or all their indices are those of the robot.
#![no_main]

use std::sync::LazyLock;

use darrt_fuzz::text::text;
use darrt_primitives::kinematics::RobotDescription;
use darrt_primitives::kinematics::srdf::{AnyJoint, SemanticDescription};
use libfuzzer_sys::fuzz_target;

const ARM: &str = include_str!("../../darrt-primitives/tests/data/generic_arm.urdf");
const SEED: &str = include_str!("../seeds/srdf_reader/generic_arm.srdf");

static ROBOT: LazyLock<RobotDescription> = LazyLock::new(|| RobotDescription::from_text(ARM).expect("a sound robot"));

fuzz_target!(|data: &[u8]| {
    let Ok(read) = SemanticDescription::from_text(&text(data, &[SEED]), &ROBOT) else { return };
    let (links, joints) = (ROBOT.links.len(), ROBOT.joints.len());
    for group in &read.groups {
        assert!(group.joints.iter().all(|joint| *joint < joints) && group.links.iter().all(|link| *link < links));
        assert!(group.joints.is_sorted() && group.links.is_sorted());
        assert!(group.subgroups.iter().all(|sub| *sub < read.groups.len()));
        assert!(group.virtual_joints.iter().all(|joint| *joint < read.virtual_joints.len()));
        // A group has what its subgroups have.
        for sub in group.subgroups.iter().map(|sub| &read.groups[*sub]) {
            assert!(sub.joints.iter().all(|joint| group.joints.contains(joint)));
        }
    }
    for state in &read.states {
        assert!(state.group < read.groups.len());
        for (joint, values) in &state.joints {
            assert!(values.iter().all(|value| value.is_finite()));
            match joint {
                AnyJoint::Robot(joint) => assert!(*joint < joints && values.len() <= 1),
                AnyJoint::Virtual(joint) => assert_eq!(values.len(), read.virtual_joints[*joint].kind.values()),
            }
        }
    }
    assert!(read.end_effectors.iter().all(|hand| hand.parent_link < links && hand.group < read.groups.len()));
    assert!(read.virtual_joints.iter().all(|joint| joint.child_link < links));
    for pair in &read.disabled {
        assert!(pair.first < links && pair.second < links);
        assert_eq!(read.is_disabled(pair.first, pair.second), read.is_disabled(pair.second, pair.first));
    }
});
