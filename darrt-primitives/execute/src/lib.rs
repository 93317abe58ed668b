//! Plans executed in physics before they are real, for any robot.
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
