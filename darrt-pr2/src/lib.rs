//! DARRT on the PR2: kinematics, the paper's eight primitives, its problems, the command line.
//!
//! | question | file |
//! |---|---|
//! | what is the PR2? | [`model`], [`arm`], [`forward`], [`gripper`], [`postures`], [`self_collision`] |
//! | from where does the arm reach a pose? | [`reachability`] |
//! | how does it plan? | [`robot`], [`world`] (with the private `supports`), [`planning`] |
//! | the primitives of paper section 5.1 | [`arm_transit`], [`straight_line_arm_transit`], [`arm_rigid_transfer`], [`base_transit`], [`base_rigid_transfer`], [`pick`](mod@pick), [`place`](mod@place), [`push`](mod@push) |
//! | what is a problem? | [`problem_file`], [`mod@generate`], [`grasp_families`], [`goal_means`], [`goal_check`], [`goal_edges`] |
//! | what is a plan, and is it right? | [`export`], [`plan_file`], [`verify`](mod@verify) |
//! | how well does it plan? | [`mod@bench`], [`stopwatch`] |
//! | how are files read, written and described? | [`text_file`], [`schema`] |
//! | what does a person see? | [`cli`], [`picture`], [`viewer`] |

pub mod arm;
pub mod arm_rigid_transfer;
pub mod arm_transit;
pub mod base_rigid_transfer;
pub mod base_transit;
pub mod bench;
pub mod cli;
pub mod export;
mod file_kind;
pub mod forward;
pub mod generate;
pub mod goal_check;
pub mod goal_edges;
pub mod goal_means;
pub mod grasp_families;
pub mod gripper;
pub mod model;
mod near_pairs;
mod one_group;
pub mod pick;
pub mod picture;
pub mod place;
pub mod plan_file;
pub mod planning;
pub mod planning_error;
pub mod postures;
pub mod problem_file;
pub mod push;
pub mod reachability;
pub mod robot;
pub mod schema;
pub mod self_collision;
pub mod stopwatch;
pub mod straight_line_arm_transit;
mod supports;
pub mod text_file;
pub mod verify;
pub mod viewer;
mod words;
pub mod world;
