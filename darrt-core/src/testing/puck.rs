//! A disc robot on a floor with pucks that it can push, and some that it can grab.
//!
//! The smallest domain with everything that DARRT is about: objects that do not move by themselves,
//! several primitives, modes, contacts and obstacles. Read it in this order, and copy what you need:
//!
//! | what | where |
//! |---|---|
//! | M: robot and pucks, their spaces and modes | [`world`] |
//! | A: Transit, Push, Pick, Carry, Place, one file each | [`transit`], [`push`], [`pick`], [`carry`], [`place`] |
//! | the way to a puck, around it | [`approach`](mod@approach) |
//! | B: obstacles, and how far a motion is free | [`clearance`] |
//! | the judge | [`judge`] |
//! | putting a problem together | [`setup`] |
//! | ready problems | [`problems`] |
//!
//! # Example
//! ```
//! use darrt_core::observe::Silent;
//! use darrt_core::solve::{SolveOptions, solve};
//! use darrt_core::testing::puck::{Setup, paper_strategy};
//!
//! # fn main() -> Result<(), darrt_core::error::Error> {
//! let problem = Setup::new([3.0, 2.0], 0.15)
//!     .robot_at([0.5, 1.0])
//!     .puck("red", 0.12, [1.0, 1.0])
//!     .wall("shelf", [1.4, 0.0], [1.6, 0.6])
//!     .puck_goal(0, [2.5, 1.0])
//!     .problem()?;
//! let outcome = solve(&problem, &paper_strategy()?, &SolveOptions::default(), &mut Silent);
//! assert!(outcome.solution.is_some());
//! # Ok(())
//! # }
//! ```

pub mod approach;
pub mod carry;
pub mod clearance;
pub mod judge;
pub mod pick;
pub mod place;
mod plane;
pub mod problems;
pub mod push;
pub mod setup;
pub mod transit;
pub mod world;

pub use carry::Carry;
pub use clearance::{Clearance, Obstacle, Outline};
pub use judge::{Judge, Oracle};
pub use pick::Pick;
pub use place::Place;
pub use push::Push;
pub use setup::{Setup, paper_strategy};
pub use transit::Transit;
pub use world::{Grip, Mode, Point, Puck, PuckWorld};
