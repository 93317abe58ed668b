//! Robot-independent building blocks for manipulation primitives.
//!
//! ```
//! use darrt_primitives::push::Friction;
//! use darrt_primitives::push::steady::SlidingDisc;
//!
//! let (table, fingers) = (Friction::new(0.3)?, Friction::new(0.4)?);
//! let plate = SlidingDisc { radius_m: 0.12, mass_kg: 0.4, table, fingers };
//! // Two fingers, a place that is known to 10 mm, an arm that pushes with 30 N.
//! let push = plate.steady_push(plate.finger_gap_m(0.088), 0.01, 30.0)?;
//! assert!(push.settle_m > 0.0, "so far it slides until it rests against both");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | file |
//! |---|---|
//! | what must a robot offer? | [`manipulator`], [`joints`], [`kinematics`] |
//! | where can robot and objects be? | [`mobile_arm_space`], [`object_space`], [`tabletop`] |
//! | what is held, what rests on what? | [`mode`] |
//! | which primitives are there, and what do they promise? | [`primitive`], [`contract`] |
//! | to which poses can the hand not come, whatever the joints? | [`hand_ties`] |
//! | how do objects slide when pushed? | [`push`], [`contact`] |
//! | how can an object be held? | [`grasp`] |
//! | how far may what is held lean? | [`tilt`] |
//! | how near to an edge may an object be left? | [`edge_margin`] |
//! | how does a target become motions? | [`action`], [`arm_motion`] |
//! | how long are straight lines of the hand? | [`length_range`] |
//! | who may touch whom, and what is too near? | [`collision_scene`] |
//! | what is in the way, and is there a way around? | [`validity`], [`local_repair`], [`base_path`] |
//! | how long does a plan take? | [`execution_time`] |
//! | what is asked for, and what is a goal? | [`target_query`], [`goal`] |
//! | is my robot right? | [`laws`], and `testing` (feature `testing`) |
//!
//! | feature | what it adds |
//! |---|---|
//! | `testing` | `testing`: a gantry at two tables, implementations that break the laws, proptest strategies |
//!
//! Nothing here names a robot.

pub mod action;
pub mod arm_motion;
pub mod base_path;
pub mod collision_scene;
mod configurations;
pub mod contact;
pub mod contract;
pub mod edge_margin;
pub mod error;
pub mod execution_time;
pub mod goal;
pub mod grasp;
pub mod hand_ties;
pub mod heading_drive;
pub mod joints;
pub mod kinematics;
pub mod laws;
pub mod length_range;
pub mod local_repair;
pub mod manipulator;
pub mod mobile_arm_space;
pub mod mode;
pub mod object_space;
pub mod primitive;
pub mod push;
mod segment;
pub mod success;
pub mod tabletop;
pub mod target_query;
#[cfg(feature = "testing")]
pub mod testing;
pub mod tilt;
pub mod validity;
