//! Manipulation tasks as files, for any robot: a problem is read, planned from end to end, judged and drawn.
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
