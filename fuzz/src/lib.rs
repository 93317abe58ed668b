//! What the fuzz targets share: structured inputs made from bytes.
//!
//! | target | asks |
//! |---|---|
//! | `urdf_reader` | a robot description is refused, or keeps the laws of `RobotDescription` and can be built |
//! | `srdf_reader` | a semantic description is refused, or all its names are those of the robot |
//! | `robot_file_reader` | a robot file is refused, or its robot stands where numbers say, with either hand at work |
//! | `problem_reader` | a problem file is refused, or survives being written as TOML and as JSON; its geometry can be built |
//! | `problem_planner` | a problem that reads is refused by the planner, or a few iterations keep the accounts balanced |
//! | `plan_reader` | a plan file is refused, or survives being written |
//! | `plan_verifier` | a plan that reads is proven or refused |
//! | `plan_round_trip` | any plan with finite numbers survives, bit for bit; any other is refused by the writer |
//! | `scene_mesh_reader` | an STL, OBJ, COLLADA or GLB file is refused, or is a sound mesh |
//! | `partial_overlay` | the laws of partial states |
//! | `path_terminates` | PATH ends within its bounds, extensions are valid, counts balance, primitives keep their laws |
//! | `push_stays_on_support` | a push ends on the support with the margin that was asked for |
//! | `batched_against_oracle` | the collision checker never says more than the oracle |
//!
//! Nothing may panic, hang (`-timeout`) or take much memory (`-rss_limit_mb`). The targets run on stable Rust without
//! sanitizer, because the workspace has no unsafe code; `Cargo.toml` beside this folder shows the commands.

pub mod puck;
pub mod solids;
pub mod text;
