use super::*;
use nalgebra::Point3;

const TWO: &str = "<robot name='r'>
  <link name='tip'/><link name='mid'/><link name='base'/><link name='slide'/>
  <joint name='b' type='revolute'><parent link='mid'/><child link='tip'/><origin xyz='1 0 0'/><axis xyz='0 0 1'/>
    <limit lower='-1' upper='1' velocity='1'/><mimic joint='a' multiplier='-2' offset='0.5'/></joint>
  <joint name='a' type='continuous'><parent link='base'/><child link='mid'/><origin xyz='0 0 1' rpy='0 0 0.3'/>
    <axis xyz='0 0 3'/></joint>
  <joint name='s' type='prismatic'><parent link='tip'/><child link='slide'/><axis xyz='0 2 0'/>
    <limit lower='0.1' upper='1' velocity='1'/></joint>
</robot>";

fn tree() -> KinematicTree {
    KinematicTree::new(&RobotDescription::from_text(TWO).unwrap()).unwrap()
}

#[test]
fn parents_come_first_and_names_resolve() {
    let tree = tree();
    let names: Vec<&str> = tree.link_names().iter().map(|n| &**n).collect();
    assert_eq!(names, ["base", "mid", "tip", "slide"]);
    for (link, name) in names.iter().enumerate() {
        assert!(tree.parent(link).is_none_or(|p| p < link));
        assert_eq!(tree.link_index(name), Some(link));
    }
    assert_eq!(tree.parent(0), None);
    let variables: Vec<&str> = tree.variables().iter().map(|v| &*v.name).collect();
    assert_eq!(variables, ["a", "s"]);
    assert_eq!(tree.variable_index("b"), None);
    assert_eq!(tree.neutral(), [0.0, 0.1]);
}

#[test]
fn forward_follows_mimics_and_slides() {
    let tree = tree();
    let root = Isometry3::translation(5.0, 0.0, 0.0);
    let mut out = [Isometry3::identity(); 4];
    tree.forward(&[0.2, 0.4], &root, &mut out).unwrap();
    // mid is turned by 0.3 + 0.2, tip by -2 * 0.2 + 0.5 more, slide stands 0.4 along tip's y.
    let turn = |angle: f64| Isometry3::rotation(Vector3::z() * angle);
    let expected = root
        * Isometry3::translation(0.0, 0.0, 1.0)
        * turn(0.5)
        * Isometry3::translation(1.0, 0.0, 0.0)
        * turn(0.1)
        * Isometry3::translation(0.0, 0.4, 0.0);
    let point = Point3::new(0.1, 0.2, 0.3);
    assert!((out[3] * point - expected * point).norm() < 1e-14);
}

#[test]
fn wrong_lengths_are_errors() {
    let tree = tree();
    let mut out = [Isometry3::identity(); 4];
    let error = tree.forward(&[0.0], &Isometry3::identity(), &mut out);
    assert_eq!(error, Err(KinematicsError::Length { what: "joint_values", got: 1, expected: 2 }));
    assert!(tree.forward(&[0.0; 2], &Isometry3::identity(), &mut out[..3]).is_err());
}

#[test]
fn an_altered_description_is_refused_not_followed() {
    let sound = RobotDescription::from_text(TWO).unwrap();
    let mut cycle = sound.clone();
    cycle.joints[0].child = 2;
    assert!(KinematicTree::new(&cycle).is_err());
    let mut mimic = sound.clone();
    mimic.joints[1].mimic = mimic.joints[0].mimic;
    assert!(KinematicTree::new(&mimic).is_err());
    let mut outside = sound;
    outside.joints[0].parent = 99;
    assert!(KinematicTree::new(&outside).is_err());
}
