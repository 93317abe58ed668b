//! Problems without a plan, each with what keeps a plan away: the tests look at the cause, not at the words.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what is wrong by panicking")]

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_pr2::robot::Pr2;
use darrt_task::diagnosis::cause::{Cause, Hands, Occupant, Place, Stage};
use darrt_task::diagnosis::explain::{ExplainRequest, explain};
use darrt_task::diagnosis::relax::Relaxation;
use darrt_task::diagnosis::{Diagnosis, Outcome, causes, diagnose};
use darrt_task::plan_file::{Partial, PlanFile, Step};
use darrt_task::planning::{PlanRequest, plan};
use darrt_task::problem_file::{PrimitiveName, ProblemFile};
use darrt_task::registry::Registry;
use darrt_task::verify::{RefusalKind, VerifyOptions, verify_for};
use nalgebra::Isometry3;

const ALL: &str = r#"["Arm-Transit","Straight-Line-Arm-Transit","Arm-Rigid-Transfer","Base-Transit","Base-Rigid-Transfer","Pick","Place","Push"]"#;

/// The parts of a problem.
struct Case {
    primitives: String,
    robot: &'static str,
    /// Obstacles, surfaces and other tables besides the table.
    world: String,
    objects: String,
    goals: String,
    iterations: u64,
}

impl Default for Case {
    /// A mug on a table that shall stand elsewhere on it.
    fn default() -> Self {
        Self {
            primitives: ALL.to_owned(),
            robot: "",
            world: block("table", [0.8, 1.2, 0.74], [0.0, 0.0, 0.37]) + &top("table"),
            objects: mug("mug", [-0.2, 0.2], ""),
            goals: goal("mug", "table", [-0.2, -0.3]),
            iterations: 60,
        }
    }
}

fn block(name: &str, size: [f64; 3], at: [f64; 3]) -> String {
    format!("[[obstacle]]\nname = \"{name}\"\nshape = {{ box = {{ size = {size:?} }} }}\nat = {at:?}\n")
}

fn post(name: &str, at: [f64; 3]) -> String {
    format!(
        "[[obstacle]]\nname = \"{name}\"\nshape = {{ cylinder = {{ radius = 0.01, height = 0.3 }} }}\nat = {at:?}\n"
    )
}

fn top(name: &str) -> String {
    format!("[[surface]]\nname = \"{name}\"\ntop_of = \"{name}\"\n")
}

fn mug(name: &str, at: [f64; 2], more: &str) -> String {
    format!(
        "[[object]]\nname = \"{name}\"\nshape = {{ cylinder = {{ radius = 0.035, height = 0.10 }} }}\non = \"table\"\nat = \
         {at:?}\ngrasps = [\"side\"]\n{more}\n"
    )
}

fn plate(at: [f64; 2]) -> String {
    format!(
        "[[object]]\nname = \"plate\"\nshape = {{ cylinder = {{ radius = 0.14, height = 0.02 }} }}\non = \"table\"\nat = \
         {at:?}\ngrasps = [\"rim\"]\n"
    )
}

fn goal(object: &str, on: &str, at: [f64; 2]) -> String {
    format!("[[goal.object]]\nobject = \"{object}\"\non = \"{on}\"\nat = {at:?}\n")
}

/// Eight posts around a place on the table.
fn cage([x, y]: [f64; 2]) -> String {
    let place = |i: u32| (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
    (0..8)
        .map(|i| (i, place(i)))
        .map(|(i, (s, c))| post(&format!("post {i}"), [x + 0.065 * c, y + 0.065 * s, 0.89]))
        .collect()
}

/// Walls around a place of the floor, so far from it.
fn walls([x, y]: [f64; 2], far: f64) -> String {
    let long = 2.0 * far + 0.2;
    block("wall n", [long, 0.1, 2.0], [x, y + far, 1.0])
        + &block("wall s", [long, 0.1, 2.0], [x, y - far, 1.0])
        + &block("wall e", [0.1, long, 2.0], [x + far, y, 1.0])
        + &block("wall w", [0.1, long, 2.0], [x - far, y, 1.0])
}

impl Case {
    fn problem(&self) -> ProblemFile {
        ProblemFile::from_toml(&self.text(), "case").unwrap()
    }

    fn text(&self) -> String {
        let Self { primitives, robot, world, objects, goals, .. } = self;
        format!(
            "format = \"darrt-problem\"\nversion = 1\nname = \"case\"\nprimitives = {primitives}\n[robot]\nbase = [-1.0, \
             0.0, 0.0]\n{robot}\n{world}\n{objects}\n{goals}\n"
        )
    }

    /// Plans, and finds out why there is no plan.
    fn diagnosis(&self) -> Diagnosis {
        let registry = Registry::<Pr2>::new();
        let request = PlanRequest { iterations: Some(self.iterations), ..PlanRequest::new(self.problem(), 0) };
        match plan(&registry, &request, &Cancel::new(), &mut Silent) {
            Ok(result) => {
                assert!(result.plan.is_none(), "has a plan");
                diagnose(&registry, &request, &result, &Cancel::new()).unwrap()
            }
            Err(error) => Diagnosis::of_error("case", &error).unwrap_or_else(|| panic!("{error}")),
        }
    }

    /// The only cause of this kind.
    fn cause<T>(&self, of: impl Fn(&Cause) -> Option<T>) -> (T, Diagnosis) {
        let diagnosis = self.diagnosis();
        let found = diagnosis.causes.iter().find_map(of);
        (found.unwrap_or_else(|| panic!("{diagnosis:#?}")), diagnosis)
    }

    fn hands(&self, place: Place, stage: Stage) -> (Hands, Diagnosis) {
        let (hands, diagnosis) = self.cause(|cause| match cause {
            Cause::NoHand { hands } if hands.place == place => Some(hands.clone()),
            _ => None,
        });
        assert_eq!(hands.last_stage(), Some(stage), "{diagnosis:#?}");
        assert_eq!((hands.good, diagnosis.outcome), (0, Outcome::Hopeless));
        assert_eq!(hands.tried, hands.ends.iter().map(|end| end.count).sum::<u64>());
        (hands, diagnosis)
    }

    fn occupied(&self) -> (String, Occupant) {
        let of = |cause: &Cause| match cause {
            Cause::GoalOccupied { by, occupant, .. } => Some((by.clone(), *occupant)),
            _ => None,
        };
        self.cause(of).0
    }
}

fn names(hands: &Hands) -> Vec<&str> {
    hands.blockers.iter().map(|blocker| blocker.body.as_str()).collect()
}

#[test]
fn the_plain_case_has_a_plan() {
    let registry = Registry::<Pr2>::new();
    let request = PlanRequest { iterations: Some(2000), ..PlanRequest::new(Case::default().problem(), 0) };
    assert!(plan(&registry, &request, &Cancel::new(), &mut Silent).unwrap().plan.is_some());
}

#[test]
fn goal_in_an_obstacle() {
    let mut case = Case::default();
    case.world += &block("kettle", [0.1, 0.1, 0.2], [-0.2, -0.3, 0.84]);
    assert_eq!(case.occupied(), ("kettle".to_owned(), Occupant::Fixed));
}

#[test]
fn two_objects_and_one_goal() {
    let mut case = Case::default();
    case.objects += &mug("jar", [0.1, 0.1], "");
    case.goals += &goal("jar", "table", [-0.2, -0.32]);
    assert_eq!(case.occupied().1, Occupant::Goal);
}

#[test]
fn goal_under_an_object_that_nothing_moves() {
    let mut case = Case::default();
    case.objects += &mug("jar", [-0.2, -0.3], "pushable = false").replace("grasps = [\"side\"]", "grasps = []");
    assert_eq!(case.occupied(), ("jar".to_owned(), Occupant::Immovable));
}

#[test]
fn plate_too_wide_and_no_push() {
    let primitives = ALL.replace(",\"Push\"", "");
    let case =
        Case { primitives, objects: plate([0.0, 0.0]), goals: goal("plate", "table", [0.1, 0.3]), ..Case::default() };
    let (object, _) = case.cause(|cause| match cause {
        Cause::InfeasibleGoal { object, .. } => Some(object.clone()),
        _ => None,
    });
    assert_eq!(object, "plate");
}

#[test]
fn wall_of_obstacles_between_robot_and_goal() {
    let mut case = Case::default();
    case.world += &(block("side table", [0.8, 0.8, 0.7], [2.5, 0.0, 0.35]) + &top("side table"));
    case.world += &block("wall", [0.1, 10.6, 2.0], [1.0, 0.0, 1.0]);
    case.goals = goal("mug", "side table", [2.3, 0.0]);
    let (floor, diagnosis) = case.cause(|cause| match cause {
        Cause::CutOff { object, place: Place::Goal, floor } => Some((object.clone(), floor.clone())),
        _ => None,
    });
    assert_eq!((floor.0.as_str(), diagnosis.outcome), ("mug", Outcome::Hopeless));
    assert!(floor.1.walls.iter().any(|wall| wall.body == "wall"), "{:?}", floor.1);
    // Between the wall and the bounds, less a table.
    assert!((40.0..60.0).contains(&floor.1.free_m2), "{:?}", floor.1);
}

#[test]
fn base_boxed_in() {
    let mut case = Case::default();
    case.world = case.world.replace("at = [0.0, 0.0, 0.37]", "at = [1.5, 0.0, 0.37]") + &walls([-1.0, 0.0], 0.9);
    case.objects = mug("mug", [1.3, 0.2], "");
    case.goals = goal("mug", "table", [1.3, -0.3]);
    let (floor, _) = case.cause(|cause| match cause {
        Cause::CutOff { place: Place::Start, floor, .. } => Some(floor.clone()),
        _ => None,
    });
    assert!(floor.free_m2 < 2.0, "{floor:?}");
    assert_eq!(floor.walls.iter().filter(|wall| wall.body.starts_with("wall")).count(), 4);
}

#[test]
fn no_edge_within_reach() {
    let mut case = Case { objects: plate([0.0, 0.0]), ..Case::default() };
    case.world += &(block("rail w", [0.02, 1.2, 0.1], [-0.39, 0.0, 0.79])
        + &block("wall e", [0.1, 1.4, 1.6], [0.46, 0.0, 0.8])
        + &block("wall n", [0.8, 0.1, 1.6], [0.0, 0.66, 0.8])
        + &block("wall s", [0.8, 0.1, 1.6], [0.0, -0.66, 0.8])
        + &block("side table", [0.8, 0.8, 0.7], [-2.5, 0.0, 0.35])
        + &top("side table"));
    case.goals = goal("plate", "side table", [-2.2, 0.0]);
    let ((pushes, edges), _) = case.cause(|cause| match cause {
        Cause::NoPush { pushes, edges } => Some((pushes.clone(), edges.clone())),
        _ => None,
    });
    assert_eq!((pushes.object.as_str(), pushes.taken), ("plate", 0));
    assert_eq!(edges.len(), 4);
    assert!(edges.iter().all(|edge| edge.hands.good == 0), "{edges:#?}");
}

#[test]
fn plate_in_the_middle_of_a_table_too_wide_for_the_arm() {
    let mut case = Case { objects: plate([2.0, 0.0]), goals: String::new(), ..Case::default() };
    case.world = block("table", [3.8, 3.8, 0.74], [2.0, 0.0, 0.37]) + &top("table");
    case.goals = goal("plate", "table", [0.4, 0.0]);
    let ((pushes, edges), _) = case.cause(|cause| match cause {
        Cause::NoPush { pushes, edges } => Some((pushes.clone(), edges.clone())),
        _ => None,
    });
    assert_eq!(pushes.made, 0);
    assert!(pushes.unreachable > pushes.tried / 2, "{pushes:?}");
    assert!(edges.iter().any(|edge| edge.hands.good > 0), "it could be taken at an edge");
}

#[test]
fn goal_on_a_surface_where_the_object_may_not_stand() {
    let mut case = Case::default();
    case.world += &(block("side table", [0.8, 0.8, 0.7], [-2.5, 0.0, 0.35]) + &top("side table"));
    case.objects = mug("mug", [-0.2, 0.2], "surfaces = [\"table\"]");
    case.goals = goal("mug", "side table", [-2.2, 0.0]);
    let Case { primitives, world, objects, goals, .. } = &case;
    let text = format!(
        "format = \"darrt-problem\"\nversion = 1\nname = \"case\"\nprimitives = {primitives}\n[robot]\nbase = [-1.0, 0.0, \
         0.0]\n{world}\n{objects}\n{goals}\n"
    );
    let error = ProblemFile::from_toml(&text, "case").unwrap_err().to_string();
    assert!(error.contains("side table") && error.contains("mug"), "{error}");
}

#[test]
fn cage_around_the_mug() {
    let mut case = Case::default();
    case.world += &cage([-0.2, 0.2]);
    let (hands, diagnosis) = case.hands(Place::Start, Stage::Hand);
    assert!(names(&hands).iter().all(|name| name.starts_with("post")), "{hands:?}");
    let pushes = diagnosis.causes.iter().find_map(|cause| match cause {
        Cause::NoPush { pushes, .. } => Some(pushes),
        _ => None,
    });
    assert!(pushes.unwrap().blockers.iter().all(|blocker| blocker.body.starts_with("post")));
    let is_without = |relaxation: &Relaxation| match relaxation {
        Relaxation::Without { obstacles } => obstacles.iter().all(|name| name.starts_with("post")),
        _ => false,
    };
    assert!(diagnosis.remedies.iter().any(is_without), "{:?}", diagnosis.remedies);
}

#[test]
fn side_table_too_high_for_the_arm() {
    let mut case = Case::default();
    case.world +=
        &(block("shelf", [0.6, 0.6, 0.05], [0.0, 2.0, 1.975]) + &top("shelf") + "[bounds]\nobject_z = [0.0, 2.5]\n");
    case.goals = goal("mug", "shelf", [-0.1, 1.9]);
    let (hands, _) = case.hands(Place::Goal, Stage::Reach);
    let beyond_m = hands.beyond_m.unwrap();
    assert!((0.3..1.0).contains(&beyond_m), "{beyond_m}");
    // So much lower it is reached.
    case.world = case.world.replace("1.975", &format!("{}", 1.975 - beyond_m - 0.3));
    let request = PlanRequest::new(case.problem(), 0);
    assert_eq!(causes(&Registry::<Pr2>::new(), &request, &Cancel::new()).unwrap(), []);
}

#[test]
fn heavier_than_the_gripper_holds() {
    let case = Case { objects: mug("mug", [-0.2, 0.2], "mass_kg = 500"), ..Case::default() };
    let (lack, _) = case.cause(|cause| match cause {
        Cause::InfeasibleGoal { lack, .. } => Some(lack.clone()),
        _ => None,
    });
    assert!(lack.contains("500 kg"), "{lack}");
}

/// A shelf at such a height, to which the mug shall go.
fn shelf(height_m: f64, robot: &'static str) -> Case {
    let mut case = Case { robot, ..Case::default() };
    case.world += &(block("shelf", [0.6, 0.6, 0.02], [0.0, 2.0, height_m - 0.01]) + &top("shelf"));
    case.goals = goal("mug", "shelf", [-0.15, 1.85]);
    case
}

#[test]
fn torso_too_low() {
    let case = shelf(1.30, "torso_m = 0.02");
    let (_, diagnosis) = case.hands(Place::Goal, Stage::Reach);
    let is_lift = |relaxation: &Relaxation| matches!(relaxation, Relaxation::Lift { to_m } if *to_m > 0.1);
    assert!(diagnosis.remedies.iter().any(is_lift), "{diagnosis:#?}");
}

#[test]
fn soft_limits_where_hard_ones_would_do() {
    let case = shelf(1.50, "torso_m = 0.3");
    let (_, diagnosis) = case.hands(Place::Goal, Stage::Arm);
    assert!(diagnosis.remedies.contains(&Relaxation::HardLimits), "{diagnosis:#?}");
}

#[test]
fn region_smaller_than_the_object() {
    let mut case = Case::default();
    case.world += &(block("book a", [0.1, 0.02, 0.2], [-0.2, -0.27, 0.84])
        + &block("book b", [0.1, 0.02, 0.2], [-0.2, -0.33, 0.84]));
    case.goals =
        "[[goal.object]]\nobject = \"mug\"\non = \"table\"\nregion = { min = [-0.22, -0.31], max = [-0.18, -0.29] }\n"
            .to_owned();
    // A region can have room where nobody looked: that is no proof. But every hand tried there meets one of the two.
    let (hands, diagnosis) = case.hands(Place::Goal, Stage::Room);
    assert!(!names(&hands).is_empty() && names(&hands).iter().all(|name| name.starts_with("book")), "{hands:?}");
    assert!(!diagnosis.remedies.is_empty(), "{diagnosis:#?}");
}

#[test]
fn time_limit_too_short() {
    let diagnosis = Case { iterations: 1, ..Case::default() }.diagnosis();
    assert_eq!((diagnosis.causes.as_slice(), diagnosis.outcome), (&[][..], Outcome::TooShort));
}

#[test]
fn primitive_missing() {
    let mut case = Case { primitives: ALL.replace(",\"Pick\"", ""), ..Case::default() };
    case.world += &(block("side table", [0.8, 0.8, 0.7], [-2.5, 0.0, 0.35]) + &top("side table"));
    case.goals = goal("mug", "side table", [-2.2, 0.0]);
    let (lack, _) = case.cause(|cause| match cause {
        Cause::InfeasibleGoal { lack, .. } => Some(lack.clone()),
        _ => None,
    });
    assert!(lack.contains(PrimitiveName::PICK.as_str()), "{lack}");
}

#[test]
fn goal_too_far_from_every_place_where_the_base_can_stand() {
    let mut case = Case::default();
    case.world += &(block("big table", [3.0, 3.0, 0.74], [3.0, 0.0, 0.37]) + &top("big table"));
    case.goals = goal("mug", "big table", [3.0, 0.0]);
    let (hands, _) = case.hands(Place::Goal, Stage::Stand);
    assert_eq!(names(&hands)[0], "big table");
    assert!(hands.beyond_m.unwrap() > 0.3, "{hands:?}");
}

#[test]
fn base_bounds_too_tight() {
    let mut case = Case::default();
    case.world += &(block("side table", [0.8, 0.8, 0.7], [-4.0, 0.0, 0.35]) + &top("side table"));
    case.world += "[bounds]\nbase_x = [-1.5, 1.5]\nbase_y = [-1.5, 1.5]\n";
    case.goals = goal("mug", "side table", [-3.9, 0.0]);
    let (hands, diagnosis) = case.hands(Place::Goal, Stage::Stand);
    assert_eq!(names(&hands), ["the bounds of the base"]);
    assert!(diagnosis.remedies.iter().any(|r| matches!(r, Relaxation::WiderBounds { .. })), "{diagnosis:#?}");
}

#[test]
fn a_base_that_may_not_drive_does_not_reach() {
    let mut case =
        Case { primitives: ALL.replace(",\"Base-Transit\",\"Base-Rigid-Transfer\"", ""), robot: "", ..Case::default() };
    case.world += &(block("side table", [0.8, 0.8, 0.7], [-4.0, 0.0, 0.35]) + &top("side table"));
    case.goals = goal("mug", "side table", [-3.9, 0.0]);
    case.hands(Place::Goal, Stage::Reach);
}

#[test]
fn the_same_problem_has_the_same_diagnosis() {
    let mut case = Case::default();
    case.world += &cage([-0.2, 0.2]);
    assert_eq!(case.diagnosis(), case.diagnosis());
}

#[test]
fn a_robot_goal_in_a_wall() {
    let mut case = Case::default();
    case.world += &block("kettle", [0.4, 0.4, 1.0], [3.0, 3.0, 0.5]);
    case.goals = "[goal.robot]\nbase = [3.0, 3.0, 0.0]\n".to_owned();
    let (blockers, _) = case.cause(|cause| match cause {
        Cause::NoRobotGoal { blockers, .. } => Some(blockers.clone()),
        _ => None,
    });
    assert_eq!(blockers[0].body, "kettle");
}

#[test]
fn what_was_done_before_the_end_is_a_plan_that_can_be_judged() {
    let mut case = Case { iterations: 600, ..Case::default() };
    case.objects += &mug("jar", [-0.2, -0.1], "");
    case.world += &cage([-0.2, 0.2]);
    case.goals += &goal("jar", "table", [-0.2, -0.4]);
    case.goals = case.goals.replace("-0.3]", "0.4]");
    let request = PlanRequest { iterations: Some(case.iterations), ..PlanRequest::new(case.problem(), 0) };
    let result = plan(&Registry::<Pr2>::new(), &request, &Cancel::new(), &mut Silent).unwrap();
    assert!(result.plan.is_none());
    let (file, _) = result.partial.unwrap();
    let partial = file.partial.clone().unwrap();
    assert_eq!((partial.met, partial.remains), (vec!["jar".to_owned()], vec!["mug".to_owned()]));
    verify_for::<Pr2>(&file, &VerifyOptions::default()).unwrap();
    // What it says of the goal is held against its end.
    for (met, remains) in [(vec!["jar", "mug"], vec![]), (vec!["mug"], vec!["jar"]), (vec!["jar"], vec![])] {
        let names = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
        let lie = Partial { met: names(met), remains: names(remains), robot_remains: false };
        let file = PlanFile { partial: Some(lie), ..file.clone() };
        assert!(verify_for::<Pr2>(&file, &VerifyOptions::default()).is_err());
    }
    assert!(verify_for::<Pr2>(&PlanFile { partial: None, ..file }, &VerifyOptions::default()).is_err());
}

#[test]
fn an_object_that_has_no_room_itself_and_a_tool_out_of_reach_are_said_so() {
    let mut case = Case::default();
    case.world += &block("crate", [0.3, 0.3, 0.2], [-0.2, -0.3, 0.84]);
    case.goals =
        "[[goal.object]]\nobject = \"mug\"\non = \"table\"\nregion = { min = [-0.28, -0.38], max = [-0.12, -0.22] }\n"
            .to_owned();
    let (hands, _) = case.hands(Place::Goal, Stage::Room);
    assert_eq!(hands.blockers[0].body, "crate");

    let mut case = Case { iterations: 20, ..Case::default() };
    case.goals = "[goal.robot]\ntool = { position = [0.0, 0.0, 2.4], rpy = [0.0, 0.0, 0.0] }\n".to_owned();
    let (beyond_m, _) = case.cause(|cause| match cause {
        Cause::NoRobotGoal { tried: 0, beyond_m, .. } => *beyond_m,
        _ => None,
    });
    assert!((0.3..1.5).contains(&beyond_m), "{beyond_m}");
}

#[test]
fn explained_changes_are_solved_and_as_few_as_can_be() {
    let mut case = Case::default();
    case.world += &cage([-0.2, 0.2]);
    let of = |threads| {
        let request = ExplainRequest { plan: PlanRequest::new(case.problem(), 0), iterations: 300, threads };
        let explained = explain(&Registry::<Pr2>::new(), &request, &Cancel::new()).unwrap();
        explained.solved.into_iter().map(|solved| (solved.changes, solved.iterations, solved.steps)).collect::<Vec<_>>()
    };
    let found = of(2);
    assert_eq!(found, of(1));
    let [Relaxation::Without { obstacles }] = found[0].0.as_slice() else { panic!("{found:?}") };
    assert!((1..8).contains(&obstacles.len()), "{obstacles:?}");
}

/// The hand's direction from the mug wherever it takes it, or lets go of it, in degrees.
fn sides(file: &PlanFile) -> Vec<f64> {
    let side = |step: &Step| {
        let hold = step.holds.as_ref()?;
        let waypoint = step.waypoints.first()?;
        let object = Isometry3::from(*waypoint.objects.get("mug")?);
        let hand = object * Isometry3::from(hold.tool_from_object).inverse();
        let wrist = hand * nalgebra::Point3::new(-0.1, 0.0, 0.0);
        let beside = wrist.coords - object.translation.vector;
        Some(beside.y.atan2(beside.x).to_degrees())
    };
    file.steps.iter().filter(|step| step.primitive == PrimitiveName::PICK).filter_map(side).collect()
}

/// The plan of the first seed that has one.
fn solved(case: &Case) -> PlanFile {
    let found = (0..6).find_map(|seed| {
        let request = PlanRequest { iterations: Some(case.iterations), ..PlanRequest::new(case.problem(), seed) };
        plan(&Registry::<Pr2>::new(), &request, &Cancel::new(), &mut Silent).unwrap().plan
    });
    found.unwrap()
}

fn steer(rule: &str) -> String {
    format!("[[steer]]\n{rule}\n")
}

#[test]
fn what_is_required_is_done_on_the_way() {
    // Carried, because nothing else is allowed; then it shall be pushed as well, from a part of the floor.
    let carried = Case { primitives: ALL.replace(",\"Push\"", ""), iterations: 3000, ..Case::default() };
    let usual = solved(&carried);
    let mut case = Case { primitives: ALL.to_owned(), ..carried };
    let goals = case.goals.clone();
    let rule = "require = true\nobject = \"mug\"\nprimitive = \"Push\"\nsurface = \"table\"\n";
    case.goals = goals.clone() + &steer(&(rule.to_owned() + "base = { min = [-5, -5], max = [5, 0.2] }"));
    let file = solved(&case);
    let fits = |step: &&Step| step.primitive == PrimitiveName::PUSH && step.waypoints[0].base[1] <= 0.2;
    assert!(file.steps.iter().any(|step| fits(&step)));
    // The verifier counts by itself: the usual plan lacks it, and what is required may not be forbidden elsewhere.
    let lacking = PlanFile { problem: file.problem.clone(), ..usual };
    let refusal = verify_for::<Pr2>(&lacking, &VerifyOptions::default()).unwrap_err();
    assert!(refusal.kind == RefusalKind::Steer && refusal.step.is_none(), "{refusal}");
    let mut elsewhere = file.clone();
    elsewhere.problem.steers[0].base.as_mut().unwrap().max[1] = -4.0;
    assert_eq!(verify_for::<Pr2>(&elsewhere, &VerifyOptions::default()).unwrap_err().kind, RefusalKind::Steer);
    let mut forbidden = file;
    (forbidden.problem.steers[0].require, forbidden.problem.steers[0].forbid) = (false, true);
    let refusal = verify_for::<Pr2>(&forbidden, &VerifyOptions::default()).unwrap_err();
    assert!(refusal.kind == RefusalKind::Steer && refusal.step.is_some(), "{refusal}");

    // What nothing can do is said at once; what says nothing is refused.
    case.goals = goals.clone() + &steer("require = true\nprimitive = \"Push\"");
    case.objects = mug("mug", [-0.2, 0.2], "pushable = false");
    assert!(
        matches!(&case.diagnosis().causes[..], [Cause::InfeasibleRule { rule: 0, lack }] if lack.contains("pushable"))
    );
    for (rule, why) in [
        ("require = true\nforbid = true", "no step that both allow"),
        ("require = true\nsurface = \"tabel\"", "did you mean `table`?"),
        ("require = true\nprimitive = \"Base-Transit\"", "neither takes, sets down nor pushes"),
        ("object = \"mug\"", "says nothing"),
        ("requires = true", "did you mean `require`?"),
    ] {
        let text = format!("{}{}", case.text(), steer(rule));
        let error = ProblemFile::from_toml(&text, "case").map_err(|error| error.to_string());
        let error =
            error.and_then(|problem| Registry::<Pr2>::new().check(&problem, "case").map_err(|error| error.to_string()));
        assert!(error.as_ref().unwrap_err().contains(why), "{error:?}");
    }
}

#[test]
fn a_person_says_from_which_side_and_where_from() {
    let mut case = Case { primitives: ALL.replace(",\"Push\"", ""), iterations: 3000, ..Case::default() };
    case.goals += "[[steer]]\nobject = \"mug\"\nprimitive = \"Pick\"\nfrom_deg = [60, 120]\n";
    let file = solved(&case);
    assert!(sides(&file).iter().all(|side| (60.0..=120.0).contains(side)), "{:?}", sides(&file));
    // The verifier looks by itself: the same plan breaks the opposite rule.
    let mut other = file.clone();
    other.problem.steers[0].from_deg = Some([-120.0, -60.0]);
    let refusal = verify_for::<Pr2>(&other, &VerifyOptions::default()).unwrap_err();
    assert_eq!(refusal.kind, RefusalKind::Steer, "{refusal}");

    case.goals = goal("mug", "table", [-0.2, -0.3]) + "[[steer]]\nnot_base = { min = [-5, 0.1], max = [5, 5] }\n";
    let file = solved(&case);
    let works = |step: &&Step| ["Pick", "Place"].contains(&step.primitive.as_str());
    assert!(file.steps.iter().filter(works).all(|step| step.waypoints[0].base[1] < 0.1));

    case.goals = goal("mug", "table", [-0.2, -0.3]) + "[[steer]]\nforbid = true\nprimitive = \"Pick\"\n";
    case.iterations = 1000;
    let diagnosis = case.diagnosis();
    assert!(diagnosis.causes.iter().any(|cause| matches!(cause, Cause::Steered { .. })), "{diagnosis:#?}");
}
