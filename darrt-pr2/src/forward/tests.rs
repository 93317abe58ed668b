use super::*;

const Q: ArmConfiguration = [0.2, 0.3, -0.4, -0.5, 0.6, -0.7, 0.8];

#[test]
fn stretched_out_the_tool_is_where_the_lengths_say() {
    for side in Side::BOTH {
        let tool = ArmChain::new(side, 0.0).base_from_tool(&[0.0; 7]);
        let expected = Vector3::new(0.951, side.sign() * 0.188, 0.790_675);
        assert!((tool.translation.vector - expected).norm() < 1e-15);
        assert!(tool.rotation.angle() < 1e-15);
    }
}

#[test]
fn one_frame_per_entry_and_all_agree_on_the_tool() {
    let base = [1.0, -2.0, 0.7];
    let chain = ArmChain::new(Side::Left, 0.25);
    let mut poses = ArmPoses::default();
    chain.world_from_links(&base, &Q, 0.3, &mut poses);
    assert_eq!(poses.as_slice().len(), Frame::ALL.len());
    for (i, frame) in Frame::ALL.into_iter().enumerate() {
        assert_eq!(poses.pose(frame), &poses.as_slice()[i]);
    }
    let tool = *poses.pose(Frame::Tool);
    assert_eq!(tool, chain.world_from_tool(&base, &Q));
    let moved = world_from_base(&base) * chain.base_from_tool(&Q);
    assert!((tool.to_homogeneous() - moved.to_homogeneous()).abs().max() < 1e-14);
}

#[test]
fn fingertips_stand_a_gap_apart() {
    let mut poses = ArmPoses::default();
    let angle = gripper::finger_angle(0.05);
    ArmChain::new(Side::Right, 0.1).world_from_links(&[0.3, 0.2, -1.0], &Q, angle, &mut poses);
    let left = poses.pose(Frame::LeftFingerTip);
    let between = left.translation.vector - poses.pose(Frame::RightFingerTip).translation.vector;
    // The pads stand 15.8 mm inside the joints.
    assert!((between.norm() - 0.05 - 2.0 * 0.0158).abs() < 1e-12);
    assert!(left.rotation.angle_to(&poses.pose(Frame::Tool).rotation) < 1e-12);
}
