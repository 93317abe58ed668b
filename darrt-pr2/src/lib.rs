//! DARRT on the PR2.

pub mod arm;
pub mod forward;
pub mod gripper;
pub mod model;
pub mod postures;
pub mod problem_file;
pub mod schema;
pub mod self_collision;
