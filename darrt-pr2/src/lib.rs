//! DARRT on the PR2: its kinematics, its primitives, the paper's problems.
//!
//! ```
//! use darrt_core::budget::Cancel;
//! use darrt_core::observe::Silent;
//! use darrt_task::planning::{PlanRequest, plan};
//!
//! let registry = darrt_pr2::registry();
//! let bowl = registry.problems().read("bowl")?;
//! let result = plan(&registry, &PlanRequest::new(bowl, 0), &Cancel::new(), &mut Silent)?;
//! let found = result.plan.ok_or("no plan within the limit")?;
//! // Judged again, from the file's content alone.
//! darrt_pr2::verify(&found)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | file |
//! |---|---|
//! | what is the PR2? | [`model`], [`arm`], [`forward`], [`gripper`], [`postures`], [`self_collision`] |
//! | from where does the arm reach a pose? | [`variants::reachability`] |
//! | how does it plan, and what do files say of it? | [`robot`], [`mod@task`] |
//! | the primitives of paper section 5.1 | [`primitives`] |
//! | which problems are built in? | [`problems`] |

pub mod arm;
pub mod forward;
pub mod gripper;
pub mod model;
pub mod postures;
pub mod primitives;
pub mod problems;
pub mod robot;
pub mod self_collision;
pub mod task;
pub mod variants;

use darrt_primitives::tabletop::{Tabletop, TabletopState};
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ProblemFile;
use darrt_task::registry::Registry;
use darrt_task::robot::{RobotError, RobotFacts, TaskRobot as _};
use darrt_task::verify::{Proof, Refusal, VerifyOptions, verify_for};

use crate::robot::Pr2;

/// The domain: the PR2 at tables.
pub type World = Tabletop<Pr2>;
/// Its state.
pub type WorldState = TabletopState<Pr2>;

/// What the program `darrt` knows: the PR2, the paper's primitives, the built-in problems. Add your own to it.
pub fn registry() -> Registry<Pr2> {
    Registry::new().with_problems(problems::collection())
}

/// The PR2 of a problem as data, for the verifier and for pictures.
///
/// # Errors
/// [`RobotError`] when the table `[robot]` asks for what the PR2 is not.
pub fn facts(problem: &ProblemFile) -> Result<RobotFacts, RobotError> {
    Pr2::facts(&problem.robot)
}

/// Replays a plan of the PR2; see [`darrt_task::verify`].
///
/// # Errors
/// As [`darrt_task::verify::verify`]; also when there is no such PR2.
pub fn verify(plan: &PlanFile) -> Result<Proof, Refusal> {
    verify_for::<Pr2>(plan, &VerifyOptions::default())
}
