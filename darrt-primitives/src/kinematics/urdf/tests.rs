use super::*;
use crate::kinematics::{KinematicTree, link_bodies, no_meshes};
use rand::{RngExt, SeedableRng};

/// Two links, one joint with the given inside; extra text before the end.
fn robot(joint_type: &str, joint: &str, extra: &str) -> String {
    format!(
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='{joint_type}'><parent link='a'/>\
         <child link='b'/>{joint}</joint>{extra}</robot>"
    )
}

const LIMIT: &str = "<limit lower='-1' upper='2' effort='3' velocity='4'/>";

fn error(text: &str) -> UrdfError {
    RobotDescription::from_text(text).expect_err(text)
}

#[test]
fn reads_every_field() {
    let text = robot(
        "revolute",
        &format!(
            "<origin xyz='1 2 3' rpy='0 0 0.5'/><axis xyz='0 0 2'/>{LIMIT}\
             <safety_controller soft_lower_limit='-0.5' soft_upper_limit='5' k_velocity='1'/>"
        ),
        "<link name='c'><collision><origin xyz='0 0 1'/><geometry><cylinder radius='1' length='2'/></geometry>\
         </collision></link><joint name='k' type='continuous'><parent link='b'/><child link='c'/>\
         <mimic joint='j' multiplier='2' offset='1'/></joint>",
    );
    let robot = RobotDescription::from_text(&text).unwrap();
    let joint = &robot.joints[0];
    assert_eq!((joint.kind, joint.parent, joint.child), (JointKind::Turning, 0, 1));
    assert_eq!(joint.axis.into_inner(), Vector3::z());
    assert_eq!(joint.parent_from_child.translation.vector, Vector3::new(1.0, 2.0, 3.0));
    assert!((joint.parent_from_child.rotation.angle() - 0.5).abs() < 1e-12);
    assert_eq!(joint.limit, JointLimit::new(-1.0, 2.0));
    assert_eq!(joint.soft_limit, JointLimit::new(-0.5, 2.0));
    assert_eq!((joint.max_effort, joint.max_velocity), (3.0, 4.0));
    assert!(robot.joints[1].limit.is_unlimited());
    assert_eq!(robot.joints[1].mimic, Some(Mimic { joint: 0, multiplier: 2.0, offset: 1.0 }));
    assert_eq!(robot.links[2].collision[0].geometry, Geometry::Cylinder { radius: 1.0, length: 2.0 });
    assert_eq!(robot.root, 0);
}

#[test]
fn a_huge_or_tiny_axis_still_has_a_direction() {
    for axis in ["1e300 1e300 0", "1e-300 1e-300 0"] {
        let text = robot("revolute", &format!("<axis xyz='{axis}'/>{LIMIT}"), "");
        let robot = RobotDescription::from_text(&text).unwrap();
        assert!((robot.joints[0].axis.x - 0.5_f64.sqrt()).abs() < 1e-12);
    }
}

#[test]
fn names_the_joint_and_the_number() {
    let cases = [
        ("<origin xyz='1e400 0 0'/>", "joint j: origin xyz is inf, not a finite number"),
        ("<origin rpy='0 NaN 0'/>", "joint j: origin rpy is NaN, not a finite number"),
        ("<origin xyz='1e300 0 0'/>", "origin xyz is 1"),
        ("<axis xyz='0 0 0'/><limit lower='0' upper='1' velocity='1'/>", "axis (0, 0, 0) has no direction"),
        ("<axis xyz='0 inf 0'/><limit lower='0' upper='1' velocity='1'/>", "axis is inf"),
        ("<limit lower='2' upper='1' velocity='1'/>", "hard limits [2, 1] are in the wrong order"),
        ("<limit lower='NaN' upper='1' velocity='1'/>", "lower limit is NaN"),
        ("<limit lower='0' upper='1' velocity='NaN'/>", "velocity is NaN"),
        ("<limit lower='0' upper='1' velocity='-1'/>", "velocity is -1; it must be zero or more"),
        ("<mimic joint='j'/>", "mimics itself"),
        ("<mimic joint='x'/>", "mimicked joint \"x\" does not exist"),
    ];
    for (inside, expected) in cases {
        let kind = if inside.contains("limit") { "revolute" } else { "continuous" };
        let message = error(&robot(kind, inside, "")).to_string();
        assert!(message.contains(expected), "{inside}: {message}");
    }
    for kind in ["floating", "planar", "spherical"] {
        assert!(matches!(error(&robot(kind, LIMIT, "")), UrdfError::UnsupportedJoint { .. }));
    }
    assert!(matches!(error(&robot("bendy", LIMIT, "")), UrdfError::Syntax { .. }));
}

#[test]
fn sees_broken_trees() {
    let extra = |inside: &str| error(&robot("fixed", "", inside));
    let joint = |name: &str, parent: &str, child: &str| {
        format!("<joint name='{name}' type='fixed'><parent link='{parent}'/><child link='{child}'/></joint>")
    };
    assert!(matches!(error("<robot name='r'/>"), UrdfError::NoLink));
    assert!(matches!(extra("<link name='a'/>"), UrdfError::DuplicateName { kind: "link", .. }));
    let twice = format!("<link name='c'/>{}", joint("j", "b", "c"));
    assert!(matches!(extra(&twice), UrdfError::DuplicateName { kind: "joint", .. }));
    assert!(matches!(extra("<link name='c'/>"), UrdfError::SeveralRoots { .. }));
    assert!(matches!(extra(&joint("k", "b", "z")), UrdfError::Dangling { role: "child link", .. }));
    assert!(matches!(extra(&joint("k", "z", "b")), UrdfError::Dangling { role: "parent link", .. }));
    assert!(matches!(extra(&joint("k", "b", "a")), UrdfError::Cycle { .. }));
    assert!(matches!(extra(&joint("k", "a", "b")), UrdfError::TwoParents { .. }));
    assert!(matches!(extra(&joint("k", "b", "b")), UrdfError::TwoParents { .. }));
    let island = format!("<link name='c'/><link name='d'/>{}{}", joint("k", "c", "d"), joint("l", "d", "c"));
    assert!(matches!(extra(&island), UrdfError::Cycle { .. }));
}

#[test]
fn sees_mimic_circles_and_fixed_masters() {
    let joint = |name: &str, parent: &str, mimic: &str| {
        format!(
            "<link name='{name}l'/><joint name='{name}' type='continuous'><parent link='{parent}'/>\
             <child link='{name}l'/><mimic joint='{mimic}'/></joint>"
        )
    };
    let circle = joint("k", "b", "l") + &joint("l", "b", "m") + &joint("m", "b", "k");
    assert!(matches!(error(&robot("revolute", LIMIT, &circle)), UrdfError::MimicCycle { .. }));
    let chain = joint("k", "b", "j") + &joint("l", "b", "k") + &joint("m", "b", "k");
    assert!(RobotDescription::from_text(&robot("revolute", LIMIT, &chain)).is_ok());
}

#[test]
fn what_follows_a_fixed_joint_is_fixed_where_that_says() {
    let follower = |name: &str, child: &str, leader: &str, offset: f64| {
        format!(
            "<link name='{child}'/><joint name='{name}' type='prismatic'><parent link='a'/><child link='{child}'/>\
             <axis xyz='0 0 1'/>{LIMIT}<mimic joint='{leader}' multiplier='3' offset='{offset}'/></joint>"
        )
    };
    // The second is settled by the first, whichever stands first in the file.
    let extra = follower("l", "d", "k", 0.25) + &follower("k", "c", "j", 0.5);
    let robot = RobotDescription::from_text(&robot("fixed", "<mimic joint='k'/>", &extra)).unwrap();
    assert!(robot.joints.iter().all(|joint| joint.kind == JointKind::Fixed && joint.mimic.is_none()));
    let heights: Vec<f64> = robot.joints.iter().map(|joint| joint.parent_from_child.translation.z).collect();
    assert_eq!(heights, [0.0, 1.75, 0.5]);
}

#[test]
fn what_planning_does_not_use_never_stops_it() {
    let text = "<robot name='r'>\n<material name='m'><texture/></material>\n<transmission/><gazebo><link/></gazebo>\n\
        <link name='a'><inertial><mass value='NaN'/><inertia ixx='lots'/></inertial>\n\
        <visual><origin xyz='left'/><geometry><mesh/></geometry><material name='&amp;\u{e4}'><texture/></material></visual>\n\
        <collision><contact_coefficients mu='?'/><geometry><sphere radius='1'/></geometry></collision></link>\n\
        <link name='b'/><joint name='j' type='continuous'><parent link='a'/><child link='b'/>\n\
        <dynamics damping='much'/><calibration rising='?'/></joint></robot>";
    let robot = RobotDescription::from_text(text).unwrap();
    assert_eq!((robot.links[0].has_visual, robot.links[1].has_visual), (true, false));
    assert_eq!(robot.links[0].collision.len(), 1);
}

#[test]
fn what_it_needs_and_lacks_is_named_with_its_line() {
    let link = |inside: &str| format!("<robot name='r'>\n<link name='a'>\n{inside}</link></robot>");
    let joint = |inside: &str, kind: &str| {
        format!("<robot name='r'><link name='a'/>\n<link name='b'/>\n<joint name='j' {kind}>{inside}</joint></robot>")
    };
    let (parent, child) = ("<parent link='a'/>", "<child link='b'/>");
    for (text, expected) in [
        ("<robot name='r'>\n<link/></robot>".to_owned(), "line 2: <link> has no `name`"),
        (link("<collision/>"), "line 3: <collision> of link \"a\" has no <geometry>"),
        (link("<collision>\n<geometry/></collision>"), "line 4: <geometry> of link \"a\" has no shape"),
        (link("<collision><geometry><box/></geometry></collision>"), "line 3: <box> of link \"a\" has no `size`"),
        (
            link("<collision><geometry><mesh scale='1 1 1'/></geometry></collision>"),
            "line 3: <mesh> of link \"a\" has no `filename`",
        ),
        (joint(&format!("{parent}{child}"), ""), "line 3: <joint> of joint \"j\" has no `type`"),
        (joint(child, "type='fixed'"), "line 3: <joint> of joint \"j\" has no <parent>"),
        (joint(&format!("{parent}<child/>"), "type='fixed'"), "line 3: <child> of joint \"j\" has no `link`"),
        (joint(&format!("{parent}{child}"), "type='revolute'"), "line 3: <joint> of joint \"j\" has no <limit>"),
        (
            joint(&format!("{parent}{child}<limit effort='1'/>"), "type='prismatic'"),
            "line 3: <limit> of joint \"j\" has no `velocity`",
        ),
    ] {
        let message = error(&text).to_string();
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn sees_impossible_geometry() {
    let message = |geometry: &str| {
        error(&format!(
            "<robot name='r'><link name='a'><collision><geometry>{geometry}</geometry></collision></link></robot>"
        ))
        .to_string()
    };
    assert!(message("<box size='1 0 1'/>").contains("link a: box size is 0; it must be positive"));
    assert!(message("<box size='1 NaN 1'/>").contains("box size is NaN"));
    assert!(message("<sphere radius='-1'/>").contains("sphere radius is -1"));
    assert!(message("<cylinder radius='1' length='1e400'/>").contains("cylinder length is inf"));
    assert!(message("<mesh filename='m.stl' scale='1 0 1'/>").contains("mesh scale is 0"));
}

#[test]
fn hostile_texts_are_refused_quickly() {
    let deep = |n: usize| format!("<robot name='r'>{}{}</robot>", "<a>".repeat(n), "</a>".repeat(n));
    for text in [
        deep(10_000),
        "<robot name='r'>".to_owned() + &"<a>".repeat(100_000),
        format!("<robot name='r'>{}</robot>", " ".repeat(20 << 20)),
        "<!DOCTYPE r><robot name='r'><link name='a'/></robot>".to_owned(),
        "<robot name='r'><link name='a'></robot>".to_owned(),
        "not xml".to_owned(),
        String::new(),
        "<robot name='r'><link/></robot>".to_owned(),
    ] {
        let start: String = text.chars().take(60).collect();
        assert!(RobotDescription::from_text(&text).is_err(), "{start}");
    }
}

#[test]
fn files_that_are_none_and_bad_texts_are_named() {
    let refused = |path: &Path| RobotDescription::from_file(path).expect_err("no robot").to_string();
    let message = refused(Path::new("/nowhere/robot.urdf"));
    assert!(message.contains("/nowhere/robot.urdf"), "{message}");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    assert!(refused(folder).ends_with("is not a regular file"));
    let message = refused(&folder.join("Cargo.toml"));
    assert!(message.contains("Cargo.toml: "), "{message}");
}

#[test]
fn a_link_that_is_only_seen_is_refused_unless_it_is_listed() {
    let shape = "<geometry><box size='1 1 1'/></geometry>";
    let text = format!(
        "<robot name='r'><link name='a'><visual>{shape}</visual></link><link name='b'><visual>{shape}</visual>\
         <collision>{shape}</collision></link><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>"
    );
    let robot = RobotDescription::from_text(&text).unwrap();
    let message = robot.check_shapes(&[]).unwrap_err().to_string();
    assert!(message.contains("link \"a\" has a visual and no collision"), "{message}");
    robot.check_shapes(&["a".to_owned()]).unwrap();
    assert!(robot.check_shapes(&["c".to_owned()]).unwrap_err().to_string().contains("no link \"c\""));
}

/// Random damage to a sound text: any answer but a panic. What is still accepted must work in every later step.
#[test]
fn damaged_texts_never_panic() {
    let sound = include_str!("../../../tests/data/generic_arm.urdf");
    let spare = [
        "<", ">", "\"", "'", "/", "NaN", "-1e400", "<a>", "</link>", "<!--", "]]>", "&amp;", "&x;", "<?", "0", "\u{e9}",
    ];
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(9);
    let mut accepted = 0;
    for _ in 0..400 {
        let mut text: Vec<char> = sound.chars().collect();
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(0..text.len());
            let removed = rng.random_range(0..8).min(text.len() - at);
            let added = spare[rng.random_range(0..spare.len())];
            text.splice(at..at + removed, added.chars());
        }
        let text: String = text.into_iter().collect();
        let Ok(robot) = RobotDescription::from_text(&text) else {
            continue;
        };
        accepted += 1;
        let tree = KinematicTree::new(&robot).unwrap();
        let mut poses = vec![Isometry3::identity(); tree.link_count()];
        tree.forward(&tree.neutral(), &Isometry3::identity(), &mut poses).unwrap();
        assert!(poses.iter().all(|p| p.translation.vector.iter().all(|x| x.is_finite())), "{text}");
        let _ = link_bodies(&robot, &tree, &no_meshes);
    }
    assert!(accepted > 10, "{accepted} of 400");
}

#[test]
fn a_prefix_without_declaration_stops_nothing() {
    let text = "<?xml version='1.0'?><!-- <robot> --><robot name='r'>\n<link name='a'/>\n\
                <gazebo><sensor:camera name='c'/><controller:x a:b='1'/></gazebo></robot>";
    let robot = RobotDescription::from_text(text).unwrap();
    assert_eq!(&*robot.links[0].name, "a");
    let message = RobotDescription::from_text(&text.replace("name='a'", "")).unwrap_err().to_string();
    assert!(message.contains("line 2") || message.contains(":2"), "{message}");
}
