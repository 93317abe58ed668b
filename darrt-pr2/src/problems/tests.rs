use super::*;
use darrt_task::problem_file::{
    ArmSide, GoalState, GraspFamily, LengthRange, ObjectGoal, PrimitiveName, ShapeSpec, Symmetry,
};

#[test]
fn every_embedded_problem_is_valid_and_bears_its_name() {
    for name in builtin_names() {
        assert_eq!(builtin(name).unwrap().name, name);
    }
}

#[test]
fn the_spellings_of_the_paper_are_accepted() {
    for (spelling, name) in [
        ("Plate1", "plate1"),
        ("PLATE2", "plate2"),
        ("Plate3 (No Place)", "plate3-no-place"),
        ("Plate3-NoPlace", "plate3-no-place"),
        ("Simple Plate", "simple-plate"),
        ("simple_plate", "simple-plate"),
        ("Bowl", "bowl"),
    ] {
        assert_eq!(collection().find(spelling).unwrap().name, name);
    }
}

#[test]
fn an_unknown_name_lists_all_and_the_nearest() {
    let message = collection().open("plat2").unwrap_err().to_string();
    assert!(message.contains("`plat2`"), "{message}");
    assert!(message.contains("did you mean `plate2`?"), "{message}");
    for name in builtin_names() {
        assert!(message.contains(name), "{message}");
    }
    assert!(builtin_text("nothing").is_err());
}

fn problem(name: &str) -> ProblemFile {
    builtin(name).unwrap()
}

/// Centre x, y and size of every box that stands on the table, in the order of the file.
fn clutter(problem: &ProblemFile) -> Vec<([f64; 2], [f64; 3])> {
    problem
        .obstacles
        .iter()
        .filter(|obstacle| obstacle.standing_on.as_deref() == Some("central table"))
        .map(|obstacle| match &obstacle.shape {
            ShapeSpec::Box { size } => ([obstacle.at[0], obstacle.at[1]], *size),
            other => panic!("`{}` is a {}", obstacle.name, other.kind()),
        })
        .collect()
}

fn only_goal(problem: &ProblemFile) -> &ObjectGoal {
    assert_eq!(problem.goal.objects.len(), 1);
    &problem.goal.objects[0]
}

#[test]
fn all_problems_share_the_room_and_the_robot() {
    for name in builtin_names() {
        let problem = problem(name);
        assert_eq!(problem.robot.arm, ArmSide::Right);
        assert_eq!(problem.robot.torso_m, Some(0.20));
        assert_eq!(problem.robot.posture.as_deref(), Some("side"));
        assert_eq!(problem.robot.other_posture.as_deref(), Some("side"));
        assert_eq!(problem.objects.len(), 1, "{name}");
        let geometry = problem.geometry().unwrap();
        let central = geometry.scene.surface("central table").unwrap();
        let side = geometry.scene.surface("side table").unwrap();
        assert!((central.height() - 0.75).abs() < 1e-12);
        assert!((side.height() - 1.00).abs() < 1e-12);
        assert!((side.height() - central.height() - 0.25).abs() < 1e-12, "25 cm higher");
        let (low, high) = central.bounds();
        assert_eq!([low.x, low.y, high.x, high.y], [-0.45, -0.60, 0.45, 0.60]);
        let (_, corner) = side.bounds();
        assert!((corner.x + 2.05).abs() < 1e-12 && (corner.y + 1.00).abs() < 1e-12);
        let obstacle = |name| problem.obstacle(name).unwrap();
        let size = |name| match &obstacle(name).shape {
            ShapeSpec::Box { size } => *size,
            other => panic!("{}", other.kind()),
        };
        assert_eq!((size("side table"), obstacle("side table").at[2]), ([0.70, 0.90, 1.00], 0.50), "solid");
        assert_eq!(size("central table top"), [0.90, 1.20, 0.04]);
        for leg in ["leg near right", "leg near left", "leg far right", "leg far left"] {
            assert_eq!(size(leg), [0.05, 0.05, 0.71]);
            let at = &obstacle(leg).at;
            assert_eq!([at[0].abs(), at[1].abs(), at[2]], [0.40, 0.55, 0.355]);
        }
        for (wall, axis, at) in
            [("wall far", 0, 2.55), ("wall near", 0, -3.05), ("wall left", 1, 2.55), ("wall right", 1, -2.55)]
        {
            assert_eq!((obstacle(wall).at[axis], size(wall)[axis], size(wall)[2]), (at, 0.1, 2.0));
        }
    }
}

#[test]
fn plates_are_round_flat_and_only_taken_by_the_rim() {
    for name in ["simple-plate", "plate1", "plate2", "plate3", "plate3-no-place"] {
        let problem = problem(name);
        let plate = &problem.objects[0];
        assert_eq!(plate.shape, ShapeSpec::Cylinder { radius: 0.14, height: 0.02 });
        assert_eq!((plate.mass_kg, plate.symmetry(), plate.pushable()), (0.5, Symmetry::Z, true));
        assert_eq!(plate.grasps, [GraspFamily::Rim]);
        assert_eq!(plate.rim_tilts_deg(), [0.0]);
        assert_eq!((plate.rim.insertion_m, plate.rim.lift_m), (0.04, 0.12));
        assert_eq!(plate.rim.approach_m, LengthRange::new(0.05, 0.10));
        assert_eq!(problem.primitives, PrimitiveName::PAPER);
        assert_eq!((problem.push.gap_m, problem.push.fingertip_clearance_m), (0.088, 0.005));
        assert_eq!(problem.push.standoff_m, LengthRange::new(0.03, 0.05));
        assert_eq!(problem.push.edge_distance_m, [0.03, 0.08]);
        assert_eq!(problem.place.approach_directions, [[-0.424, -0.424, -0.8]]);
        assert_eq!(problem.place.approach_m, LengthRange::new(0.02, 0.20));
        assert_eq!(only_goal(&problem).yaw, None, "{name}: any orientation about z");
    }
}

#[test]
fn the_corner_goal_is_0_09_inside_both_edges() {
    for name in ["plate1", "plate2", "plate3"] {
        let problem = problem(name);
        let goal = only_goal(&problem);
        assert_eq!((goal.on.as_deref(), goal.state()), (Some("side table"), GoalState::Released));
        let geometry = problem.geometry().unwrap();
        let side = geometry.scene.surface("side table").unwrap();
        let (_, corner) = side.bounds();
        let [x, y] = goal.at.unwrap();
        assert!((corner.x - x - 0.09).abs() < 1e-12 && (corner.y - y - 0.09).abs() < 1e-12);
        let pose = geometry.objects[0].world_from_goal(goal, &geometry.scene).unwrap();
        assert!((pose.translation.z - 1.01).abs() < 1e-12, "bottom at 1.00");
        // Farther in the fingers have no room below the rim: the goal must not reach that far.
        assert!(goal.tolerance_m < 0.01);
    }
}

#[test]
fn plates_carried_after_the_lift_hit_the_side_table() {
    let plate1 = problem("plate1");
    let geometry = plate1.geometry().unwrap();
    let bottom = 0.75 + plate1.objects[0].rim.lift_m;
    assert!((bottom - 0.87).abs() < 1e-12);
    assert!(bottom + 0.02 < geometry.scene.surface("side table").unwrap().height());
}

#[test]
fn goals_without_a_table_are_in_the_air_in_the_middle() {
    for name in ["simple-plate", "plate3-no-place"] {
        let problem = problem(name);
        let goal = only_goal(&problem);
        assert_eq!((goal.position, goal.state()), (Some([-1.5, 0.0, 0.90]), GoalState::Held));
    }
}

#[test]
fn starts_are_those_of_the_problems() {
    for (name, base, at) in [
        ("simple-plate", -0.80, [-0.20, 0.05]),
        ("plate1", -0.80, [-0.20, 0.05]),
        ("plate2", -1.00, [-0.03, -0.12]),
        ("plate3", -1.00, [-0.03, -0.12]),
        ("plate3-no-place", -1.00, [-0.03, -0.12]),
        ("bowl", -1.00, [-1.20, 2.29]),
    ] {
        let problem = problem(name);
        assert_eq!((problem.robot.base, problem.objects[0].at), ([base, 0.0, 0.0], at), "{name}");
    }
}

#[test]
fn obstacles_are_the_boxes_of_the_problems() {
    let plate2 = [
        ([0.09, 0.12], [0.14, 0.14, 0.07]),
        ([0.30, -0.12], [0.10, 0.40, 0.20]),
        ([0.00, -0.42], [0.12, 0.12, 0.15]),
        ([-0.26, -0.44], [0.16, 0.16, 0.18]),
        ([0.36, 0.34], [0.08, 0.08, 0.12]),
    ];
    assert_eq!(clutter(&problem("plate2")), plate2);
    let mugs = [0.20, 0.00, -0.20].map(|y| ([-0.40, y], [0.08, 0.08, 0.09]));
    assert_eq!(clutter(&problem("plate3")), [plate2.as_slice(), &mugs].concat());
    assert_eq!(clutter(&problem("plate3-no-place")), clutter(&problem("plate3")));
    assert_eq!(clutter(&problem("simple-plate")), []);
    let plate1 = [
        ([0.07, 0.05], [0.18, 0.18, 0.09]),
        ([-0.20, 0.34], [0.09, 0.09, 0.10]),
        ([-0.40, 0.05], [0.08, 0.08, 0.09]),
        ([0.06, -0.30], [0.12, 0.12, 0.15]),
        ([-0.41, -0.33], [0.07, 0.07, 0.08]),
    ];
    assert_eq!(clutter(&problem("plate1")), plate1);
    let bowl =
        [([-0.20, 0.34], [0.09, 0.09, 0.10]), ([0.20, -0.30], [0.12, 0.12, 0.15]), ([0.20, 0.15], [0.18, 0.18, 0.09])];
    assert_eq!(clutter(&problem("bowl")), bowl);
}

#[test]
fn the_bowl_is_not_pushed_and_stands_on_a_shelf() {
    let problem = problem("bowl");
    assert!(!problem.allows(&PrimitiveName::PUSH));
    assert_eq!(problem.primitives.len(), 7);
    let bowl = &problem.objects[0];
    assert_eq!(bowl.shape, ShapeSpec::Bowl { radius: 0.075, height: 0.065, wall: 0.005 });
    assert_eq!((bowl.mass_kg, bowl.pushable(), bowl.on.as_str()), (0.3, false, "shelf"));
    assert_eq!(
        (bowl.grasps.as_slice(), bowl.overhead.insertion_m),
        ([GraspFamily::Overhead].as_slice(), LengthRange::new(0.015, 0.03))
    );
    assert_eq!((bowl.overhead.approach_m, bowl.overhead.lift_m), (LengthRange::new(0.05, 0.10), 0.10));
    let geometry = problem.geometry().unwrap();
    assert!((geometry.scene.surface("shelf").unwrap().height() - 0.80).abs() < 1e-12);
    assert!((geometry.objects[0].world_from_object.translation.z - 0.8325).abs() < 1e-12);
    let goal = only_goal(&problem);
    assert_eq!((goal.on.as_deref(), goal.at), (Some("central table"), Some([-0.20, -0.20])));
    assert_eq!((goal.yaw, goal.state()), (None, GoalState::Released));
}

#[test]
fn the_figures_of_the_paper_are_kept() {
    for (name, planning, restart, executions) in [
        ("plate1", 257.0, 60.0, Some([2, 5])),
        ("plate2", 461.0, 200.0, Some([4, 5])),
        ("plate3", 480.0, 200.0, Some([3, 5])),
        ("bowl", 66.0, 30.0, Some([5, 5])),
        ("plate3-no-place", 82.0, 60.0, None),
        ("simple-plate", 19.0, 30.0, None),
    ] {
        let paper = problem(name).paper.unwrap();
        assert_eq!((paper.planning_time_s, paper.restart_time_s, paper.executions), (planning, restart, executions));
    }
}

#[test]
fn standing_boxes_touch_their_table_and_nothing_overlaps_the_object() {
    for name in builtin_names() {
        let problem = problem(name);
        let geometry = problem.geometry().unwrap();
        let (at, radius) = (problem.objects[0].at, problem.objects[0].shape.round_radius().unwrap());
        for (centre, size) in clutter(&problem) {
            let gap = |axis: usize| ((at[axis] - centre[axis]).abs() - size[axis] / 2.0).max(0.0);
            assert!(gap(0).hypot(gap(1)) > radius, "{name}: {centre:?}");
        }
        for (obstacle, fixed) in problem.obstacles.iter().zip(geometry.scene.bodies()) {
            if obstacle.standing_on.is_some() {
                let (low, _) = fixed.body.parts[0].shape.local_aabb();
                assert!((fixed.world_from_body.translation.z + low.z - 0.75).abs() < 1e-12);
            }
        }
        assert_eq!(geometry.carriers.len(), problem.surfaces.len());
        assert!(geometry.carriers.iter().all(Option::is_some));
    }
}

#[test]
fn json_and_toml_give_the_same_problem_bit_for_bit() {
    for name in builtin_names() {
        let original = problem(name);
        let json = serde_json::to_string(&original).unwrap();
        let from_json: ProblemFile = serde_json::from_str(&json).unwrap();
        assert_eq!(from_json, original);
        assert_eq!(serde_json::to_string(&from_json).unwrap(), json);
        assert_eq!(ProblemFile::from_toml(&original.to_toml().unwrap(), name).unwrap(), original);
    }
}

proptest::proptest! {
    #[test]
    fn every_float_survives_json(bits in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO) {
        let mut original = problem("bowl");
        original.robot.base[2] = bits;
        let json = serde_json::to_string(&original).unwrap();
        let back: ProblemFile = serde_json::from_str(&json).unwrap();
        proptest::prop_assert_eq!(back.robot.base[2].to_bits(), bits.to_bits());
    }
}

#[test]
fn further_problems_are_valid_and_bear_their_names() {
    for name in further_names() {
        assert_eq!(problem(name).name, name);
    }
}

#[test]
fn everyday_problems_are_valid_and_say_what_they_are_about() {
    for name in everyday_names() {
        let problem = problem(name);
        assert_eq!(problem.name, name);
        assert!(problem.title.contains(": ") && problem.description.len() > 80, "{name}");
        let (masses, frictions) =
            (problem.objects.iter().map(|o| o.mass_kg), problem.objects.iter().map(|o| &o.friction));
        assert!(masses.into_iter().all(|kg| (0.05..=5.0).contains(&kg)), "{name}");
        assert!(
            frictions.into_iter().all(|f| (0.05..=1.0).contains(&f.table) && (0.01..=1.0).contains(&f.fingers)),
            "{name}"
        );
    }
}

#[test]
fn larger_problems_have_more_objects_and_room_for_each() {
    for (name, objects, goals) in [("plate-and-bowl", 2, 2), ("plate-and-two-bowls", 3, 3), ("bowl-in-the-way", 2, 1)] {
        let problem = problem(name);
        assert_eq!((problem.objects.len(), problem.goal.objects.len()), (objects, goals), "{name}");
        assert_eq!((&problem.primitives, problem.paper), (&PrimitiveName::PAPER.to_vec(), None), "{name}");
        let radius = |i: usize| problem.objects[i].shape.round_radius().unwrap();
        let place = |i: usize| {
            let goal = problem.goal.objects.iter().find(|goal| goal.object == problem.objects[i].name);
            let (on, at) = goal.map(|goal| (goal.on.clone().unwrap(), goal.at.unwrap()))?;
            Some((on, at))
        };
        let start = |i: usize| Some((problem.objects[i].on.clone(), problem.objects[i].at));
        for i in 0..objects {
            for j in 0..i {
                for (a, b) in [(start(i), start(j)), (place(i), place(j))] {
                    let (Some((a_on, a)), Some((b_on, b))) = (a, b) else { continue };
                    let gap = (a[0] - b[0]).hypot(a[1] - b[1]) - radius(i) - radius(j);
                    assert!(a_on != b_on || gap > 0.03, "{name}: {gap}");
                }
            }
        }
    }
}

#[test]
fn a_bowl_stands_where_the_plate_must_go() {
    let problem = problem("bowl-in-the-way");
    let (goal, [plate, bowl]) = (only_goal(&problem), &problem.objects[..]) else { panic!("not two objects") };
    assert_eq!((goal.object.as_str(), bowl.name.as_str()), ("plate", "bowl"));
    assert_eq!(goal.on.as_deref(), Some(bowl.on.as_str()));
    let [x, y] = goal.at.unwrap();
    let apart = (x - bowl.at[0]).hypot(y - bowl.at[1]);
    let least = plate.shape.round_radius().unwrap() + bowl.shape.round_radius().unwrap();
    assert!(apart + goal.tolerance_m < least, "wherever the goal lets the plate lie, the bowl is in its way");
    assert!(!bowl.pushable() && bowl.grasps == [GraspFamily::Overhead], "it cannot be pushed aside");
}
