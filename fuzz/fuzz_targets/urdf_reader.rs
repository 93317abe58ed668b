//! Robot descriptions: refused, or sound and fit for building.
#![no_main]

use std::collections::BTreeSet;

use darrt_fuzz::text::text;
use darrt_pr2::model::{Pr2Model, URDF};
use darrt_primitives::kinematics::{KinematicTree, RobotDescription, link_bodies, no_meshes};
use libfuzzer_sys::fuzz_target;
use nalgebra::Isometry3;

const ARM: &str = include_str!("../../darrt-primitives/tests/data/generic_arm.urdf");

fuzz_target!(|data: &[u8]| {
    let Ok(robot) = RobotDescription::from_text(&text(data, &[ARM, URDF])) else { return };
    sound(&robot);
    let Ok(tree) = KinematicTree::new(&robot) else { return };
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    let _ = tree.forward(&tree.neutral(), &Isometry3::identity(), &mut poses);
    let _ = link_bodies(&robot, &tree, &no_meshes);
    let _ = Pr2Model::from_urdf(&robot, &no_meshes);
});

/// The laws of a robot description.
fn sound(robot: &RobotDescription) {
    assert!(robot.root < robot.links.len());
    let children: BTreeSet<usize> = robot.joints.iter().map(|joint| joint.child).collect();
    assert_eq!(children.len(), robot.joints.len(), "a link is the child of two joints");
    assert_eq!(children.len() + 1, robot.links.len(), "every link but the root is a child");
    assert!(!children.contains(&robot.root), "the root is nobody's child");
    for joint in &robot.joints {
        assert!(joint.parent < robot.links.len() && joint.child < robot.links.len());
        assert!(joint.mimic.is_none_or(|mimic| mimic.joint < robot.joints.len() && mimic.multiplier.is_finite()));
        assert!(finite(&joint.parent_from_child), "{joint:?}");
        assert!((joint.axis.norm() - 1.0).abs() < 1e-9, "{joint:?}");
        assert!(joint.limit.lower <= joint.limit.upper, "{joint:?}");
        assert!(
            joint.soft_limit.lower >= joint.limit.lower && joint.soft_limit.upper <= joint.limit.upper,
            "{joint:?}"
        );
    }
    let names: BTreeSet<_> = robot.links.iter().map(|link| &link.name).collect();
    assert_eq!(names.len(), robot.links.len(), "two links of one name");
    let mut pieces = robot.links.iter().flat_map(|link| &link.collision);
    assert!(pieces.all(|piece| finite(&piece.link_from_geometry)));
}

fn finite(pose: &Isometry3<f64>) -> bool {
    pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|x| x.is_finite())
}
