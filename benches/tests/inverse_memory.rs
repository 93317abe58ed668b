//! A numeric inverse allocates nothing.
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use allocation_counter::measure;
use darrt_benches::stream;
use darrt_primitives::kinematics::{ChainInverse, InverseOptions, KinematicTree, RobotDescription};
use darrt_primitives::testing::arms;
use nalgebra::Isometry3;

#[test]
fn an_inverse_allocates_nothing() {
    for (name, urdf) in arms::all() {
        let tree = KinematicTree::new(&RobotDescription::from_text(&urdf).unwrap()).unwrap();
        let (tool, options) = (Isometry3::identity(), InverseOptions::default());
        let inverse = ChainInverse::new(&tree, arms::BASE, arms::TOOL, &tool, options).unwrap();
        let middle = |limit: &darrt_primitives::kinematics::JointLimit| {
            if limit.is_unlimited() { 0.3 } else { 0.4 * limit.lower + 0.6 * limit.upper }
        };
        let joints: Vec<f64> = inverse.limits().iter().map(middle).collect();
        let pose = inverse.base_from_tool(&joints).unwrap();
        let nowhere = Isometry3::translation(0.0, 0.0, -0.2);
        let mut rng = stream(0);
        let mut found = (false, false);
        let info = measure(|| {
            found.0 = inverse.inverse(&pose, &mut rng).is_some();
            let _unreachable = inverse.inverse(&nowhere, &mut rng);
            found.1 = inverse.inverse_near(&pose, &joints, 0.1).is_some();
        });
        assert_eq!((info.count_total, found), (0, (true, true)), "{name}");
    }
}
