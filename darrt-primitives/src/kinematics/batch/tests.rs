use std::fmt::Write as _;

use nalgebra::Vector3;
use proptest::prelude::*;
use pulp::Scalar;

use super::super::urdf::RobotDescription;
use super::*;

const GENERIC: &str = include_str!("../../../tests/data/generic_arm.urdf");

fn tree_of(text: &str) -> KinematicTree {
    KinematicTree::new(&RobotDescription::from_text(text).unwrap()).unwrap()
}

/// One joint of a random tree, with everything drawn that any kind of joint needs.
type Drawn = (usize, usize, usize, [f64; 3], [f64; 3], usize, [f64; 3], bool);

fn joint() -> impl Strategy<Value = Drawn> {
    let kind = 0..5_usize;
    let parent = 0..1000_usize;
    let axis = 0..8_usize;
    let offset = prop::array::uniform3(prop_oneof![Just(0.0), -0.5_f64..0.5]);
    let turn = prop_oneof![Just([0.0; 3]), prop::array::uniform3(-3.0_f64..3.0)];
    (kind, parent, axis, offset, turn, 0..1000_usize, prop::array::uniform3(-2.0_f64..2.0), any::<bool>())
}

/// A tree of as many joints: fixed, revolute, continuous, prismatic and mimic ones, about coordinate axes and skew ones.
fn urdf(joints: &[Drawn]) -> String {
    let mut text = String::from("<robot name='random'><link name='l0'/>");
    let mut movable: Vec<usize> = Vec::new();
    for (i, (kind, parent, axis, [x, y, z], [roll, pitch, yaw], follows, numbers, both)) in joints.iter().enumerate() {
        let child = i + 1;
        let kind_name = ["fixed", "revolute", "continuous", "prismatic", "revolute"][*kind];
        let [a, b, c] = numbers;
        let skew = format!("{} {b} {c}", a + 2.5);
        let axis = ["1 0 0", "0 1 0", "0 0 1", "-1 0 0", "0 -1 0", "0 0 -1", &skew, &skew][*axis];
        write!(
            text,
            "<link name='l{child}'/><joint name='j{child}' type='{kind_name}'><parent link='l{}'/>
             <child link='l{child}'/><origin xyz='{x} {y} {z}' rpy='{roll} {pitch} {yaw}'/><axis xyz='{axis}'/>",
            parent % child
        )
        .unwrap();
        if *kind != 0 {
            text += "<limit lower='-4' upper='4' velocity='1' effort='1'/>";
            // The fifth kind follows another joint, and so do sliding ones now and then.
            if (*kind == 4 || (*kind == 3 && *both)) && !movable.is_empty() {
                let joint = movable[follows % movable.len()];
                write!(text, "<mimic joint='j{joint}' multiplier='{a}' offset='{b}'/>").unwrap();
            }
            movable.push(child);
        }
        text += "</joint>";
    }
    text + "</robot>"
}

fn largest_difference(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).abs().max()
}

/// The batch against the tree, lane by lane, and against itself without a vector unit, bit by bit.
fn check(
    tree: &KinematicTree,
    batch: &BatchForward,
    asked: &[usize],
    rows: &[Row],
    root: &Isometry3<f64>,
) -> Result<(), TestCaseError> {
    let roots = PoseLanes::splat(root);
    let mut out = batch.poses();
    batch.forward(rows, &roots, &mut out).unwrap();
    let mut twin = batch.poses();
    Scalar.vectorize(batch.run(rows, &roots, &mut twin).unwrap());
    prop_assert_eq!(&out.frames, &twin.frames);
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    for lane in 0..LANES {
        let values: Vec<f64> = rows.iter().map(|row| row.0[lane]).collect();
        tree.forward(&values, root, &mut poses).unwrap();
        for link in 0..tree.link_count() {
            let found = out.link(link).map(|poses| poses.pose(lane).unwrap());
            prop_assert_eq!(found.is_some(), asked.contains(&link));
            let difference = found.map_or(0.0, |pose| largest_difference(&pose, &poses[link]));
            prop_assert!(difference < 1e-13, "link {link}, lane {lane}: {difference}");
        }
    }
    Ok(())
}

fn row() -> impl Strategy<Value = Row> {
    prop::array::uniform8(-4.0_f64..4.0).prop_map(Row)
}

fn root_pose() -> impl Strategy<Value = Isometry3<f64>> {
    (prop::array::uniform3(-2.0_f64..2.0), prop::array::uniform3(-3.0_f64..3.0))
        .prop_map(|(at, turn)| Isometry3::new(Vector3::from(at), Vector3::from(turn)))
}

proptest! {
    #[test]
    fn random_trees_have_the_poses_of_the_scalar_walk(
        joints in prop::collection::vec(joint(), 0..14),
        rows in prop::collection::vec(row(), 14),
        root in root_pose(),
        every in 1..4_usize,
    ) {
        let tree = tree_of(&urdf(&joints));
        let rows = &rows[..tree.variables().len()];
        let all: Vec<usize> = (0..tree.link_count()).collect();
        check(&tree, &BatchForward::new(&tree), &all, rows, &root)?;
        let some: Vec<usize> = all.into_iter().step_by(every).skip(1).collect();
        check(&tree, &BatchForward::for_links(&tree, &some).unwrap(), &some, rows, &root)?;
    }

    #[test]
    fn an_arm_with_skew_axes_has_them_too(
        rows in prop::collection::vec(row(), 7), root in root_pose(),
    ) {
        let tree = tree_of(GENERIC);
        let all: Vec<usize> = (0..tree.link_count()).collect();
        check(&tree, &BatchForward::new(&tree), &all, &rows, &root)?;
    }
}

/// Each lane has a root of its own.
#[test]
fn roots_may_differ() {
    let tree = tree_of(GENERIC);
    let batch = BatchForward::new(&tree);
    let mut roots = PoseLanes::splat(&Isometry3::identity());
    roots.origin[1] = Row(std::array::from_fn(|lane| lane as f64));
    let mut out = batch.poses();
    let rows = vec![Row::splat(0.3); tree.variables().len()];
    batch.forward(&rows, &roots, &mut out).unwrap();
    let tip = out.link(tree.link_count() - 1).unwrap();
    for lane in 1..LANES {
        assert!((tip.origin[1].0[lane] - tip.origin[1].0[0] - lane as f64).abs() < 1e-14);
        assert_eq!(tip.origin[0].0[lane], tip.origin[0].0[0]);
    }
    assert!(tip.pose(LANES).is_none());
}

#[test]
fn only_what_is_asked_for_costs_steps() {
    let tree = tree_of(GENERIC);
    let tip = tree.link_index("hand").unwrap();
    let batch = BatchForward::for_links(&tree, &[tip]).unwrap();
    // Every joint between mount and hand moves; the probe beside it is left out.
    assert_eq!(batch.steps.len(), 7);
    assert!(batch.poses().link(0).is_none());
    assert!(batch.poses().link(99).is_none());
}

#[test]
fn wrong_lengths_and_links_are_errors() {
    let tree = tree_of(GENERIC);
    let batch = BatchForward::new(&tree);
    let root = PoseLanes::splat(&Isometry3::identity());
    let mut out = batch.poses();
    let error = batch.forward(&[Row::splat(0.0)], &root, &mut out);
    assert_eq!(error, Err(KinematicsError::Length { what: "joint_values", got: 1, expected: tree.variables().len() }));
    let rows = vec![Row::splat(0.0); tree.variables().len()];
    let mut other = BatchForward::for_links(&tree, &[3]).unwrap().poses();
    assert!(batch.forward(&rows, &root, &mut other).is_err());
    assert!(BatchForward::for_links(&tree, &[999]).is_err());
}
