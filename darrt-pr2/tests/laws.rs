//! The PR2 keeps every law: the robot, its spaces, the eight primitives, the validity of its scenes, distances, samplers
//! and goals, on the problems of the paper. `PROPTEST_CASES` makes all of it longer; see
//! [`config`](darrt_core::testing::strategies::config).

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

#[path = "laws/carried.rs"]
mod carried;
#[path = "laws/everything.rs"]
mod everything;
#[path = "laws/grasps.rs"]
mod grasps;
#[path = "laws/primitives.rs"]
mod primitives;
#[path = "laws/robot.rs"]
mod robot;
#[path = "laws/search.rs"]
mod search;
#[path = "laws/spaces.rs"]
mod spaces;
#[path = "laws/support.rs"]
mod support;
#[path = "laws/validity.rs"]
mod validity;
