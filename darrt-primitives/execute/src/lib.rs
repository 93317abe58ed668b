//! Plans executed in physics before they are real, for any robot.
//!
//! A puck is pushed across a table, with a fifth of the errors of a real robot:
//! ```
//! use darrt_core::{budget::Cancel, observe::Silent};
//! use darrt_execute::{Execution, Loop, NoiseModel, execute};
//! use darrt_task::file_robot::FileRobot;
//! use darrt_task::planning::{PlanRequest, plan};
//! use darrt_task::problem_file::ProblemFile;
//! use darrt_task::registry::Registry;
//! use darrt_task::robot::TaskRobot as _;
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
//! let facts = FileRobot::facts(&found.problem.robot)?;
//! let (execution, noise) = (Execution::new(&found, &facts)?, NoiseModel::real()?.scaled(0.2));
//! let expected = execution.predict(&noise, false);
//! let runs = execute(&execution, &noise, Loop::Open, (0, 4), 1, &Cancel::new(), &|_| {});
//! assert!(expected.within_5_cm > 0.95 && runs.near() == 4, "{:?}", runs.failures());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | file |
//! |---|---|
//! | what is executed, and how did it go? | [`run`] |
//! | how are many runs done? | [`runs`] |
//! | what happened at every moment? | [`recording`] |
//! | what is to be expected before it is tried? | [`predict`] |
//! | what may be off? | [`noise`] |
//! | what went wrong first? | [`watch`] |
//! | is it where it should be? | [`goal`] |
//! | when is the robot where? | `course`, `timeline` |
//! | what happens in one execution? | `performance` |
//! | what does the robot know of where everything is? | `belief`, `progress` |
//! | what does it do about it? | `feedback`, `arm`, `recovery` |
//! | what is the world made of? | `stage`, `solids`, `robot`, `fingers` |
//!
//! Metres, kilograms, seconds, radians; the floor is z = 0, z up. The engine is rapier; its types stay inside.

mod arm;
mod belief;
mod course;
pub mod error;
mod feedback;
mod fingers;
pub mod goal;
#[cfg(test)]
mod known_cases;
pub mod noise;
mod performance;
pub mod predict;
mod progress;
pub mod recording;
mod recovery;
mod robot;
pub mod run;
pub mod runs;
mod solids;
mod stage;
mod timeline;
pub mod watch;

pub use error::ExecuteError;
pub use noise::{NoiseError, NoiseModel};
pub use predict::{Prediction, Spread, StepPrediction};
pub use recording::Recording;
pub use run::{Execution, FeedbackCount, Loop, Replan, RunReport};
pub use runs::{Runs, execute};
pub use watch::{Cause, Departure};
