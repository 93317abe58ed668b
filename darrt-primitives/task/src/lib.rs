//! Manipulation tasks as files, for any robot: a problem is read, planned from end to end, judged and drawn.
//!
//! An arm that does not lift, one of those that come with this crate, pushes a puck across a table:
//! ```
//! use darrt_core::{budget::Cancel, observe::Silent};
//! use darrt_task::file_robot::FileRobot;
//! use darrt_task::picture::{Extent, Story, draw};
//! use darrt_task::plan_file::PlanFile;
//! use darrt_task::planning::{PlanRequest, plan};
//! use darrt_task::problem_file::ProblemFile;
//! use darrt_task::registry::Registry;
//! use darrt_task::robot::TaskRobot as _;
//! use darrt_task::verify::{VerifyOptions, verify_for};
//!
//! let text = r#"
//! format = "darrt-problem"
//! version = 1
//! name = "puck"
//! primitives = ["Arm-Transit", "Straight-Line-Arm-Transit", "Push"]
//! transit.postures = ["ready", "left", "right"]
//! robot = { model = "planar-arm", base = [0.0, 0.0, 0.0] }
//! bounds = { base_x = [-1, 1], base_y = [-1, 1], object_x = [0, 1.2], object_y = [-0.8, 0.8], object_z = [0, 1.2] }
//! obstacle = [{ name = "table top", shape = { box = { size = [0.75, 1.2, 0.04] } }, at = [0.5, 0.0, 0.73] }]
//! surface = [{ name = "table", top_of = "table top" }]
//! goal.object = [{ object = "puck", on = "table", at = [0.48, -0.25], tolerance_m = 0.01, state = "released" }]
//! [[object]]
//! name = "puck"
//! shape = { cylinder = { radius = 0.06, height = 0.05 } }
//! symmetry = "z"
//! on = "table"
//! at = [0.48, 0.22]
//! pushable = true
//! "#;
//! let problem = ProblemFile::from_toml(text, "puck.toml")?;
//! let robots = Registry::<FileRobot>::new();
//! let found = plan(&robots, &PlanRequest::new(problem, 0), &Cancel::new(), &mut Silent)?.plan.ok_or("no plan")?;
//!
//! // Written, read by somebody else, judged from the file alone, and drawn.
//! let read = PlanFile::from_json(&found.to_json()?, "puck.plan.json")?;
//! let proof = verify_for::<FileRobot>(&read, &VerifyOptions::default())?;
//! assert!(read.steps.iter().any(|step| step.primitive.as_str() == "Push") && proof.steps == read.steps.len());
//! let story = Story::of_plan(&read, &FileRobot::facts(&read.problem.robot)?)?;
//! assert!(draw(&story, Extent::Whole).contains("Push"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | file |
//! |---|---|
//! | what must a robot say of itself? | [`robot`], and its [`laws`]; one that comes as a file: [`robot_file`], [`file_robot`] |
//! | which primitives, samplers, distances and problems are there? | [`registry`], and for command lines [`program`] |
//! | what is a problem? | [`problem_file`], [`grasp_families`], [`goal_edges`] |
//! | is it hopeless? | [`goal_feasibility`], [`goal_check`], `doubts` |
//! | why has it no plan? | [`diagnosis`] |
//! | how is it planned? | [`world`] (with the private `supports`), [`planning`] |
//! | how does an old plan help? | [`replan`](mod@replan) |
//! | what is a plan, and is it right? | [`export`], [`plan_file`], [`verify`](mod@verify) |
//! | when is the robot where? | [`clock`], and for controllers [`trajectory`] |
//! | where does the time go? | [`profile`] |
//! | how are files read, written and described? | [`text_file`], [`text`], [`schema`] |
//! | what does a person see? | [`picture`], [`viewer`] |
//!
//! Nothing here names a robot.

pub mod clock;
pub mod diagnosis;
mod doubts;
pub mod export;
pub mod file_kind;
pub mod file_robot;
pub mod goal_check;
pub mod goal_edges;
pub mod goal_feasibility;
pub mod grasp_families;
pub mod laws;
mod near_pairs;
pub mod picture;
pub mod plan_file;
pub mod planning;
pub mod planning_error;
pub mod problem_file;
pub mod profile;
pub mod program;
pub mod recording;
pub mod registry;
pub mod replan;
pub mod robot;
pub mod robot_file;
pub mod schema;
mod steer_feasibility;
mod supports;
#[cfg(test)]
mod testing;
pub mod text;
pub mod text_file;
mod tied_hand;
pub mod toml_error;
pub mod trajectory;
pub mod verify;
pub mod viewer;
pub mod world;
