//! Shapes, scenes, support surfaces, collision and clearance for manipulation planning.
//!
//! ```
//! use darrt_geom::clearance::between;
//! use darrt_geom::{Body, Shape};
//! use nalgebra::{Isometry3, Vector3};
//!
//! let ball = Body::single("ball", Shape::sphere(0.05)?)?;
//! let table = Body::single("table", Shape::cuboid(Vector3::new(0.5, 0.5, 0.02))?)?; // half its size, metres
//! let gap = between(&ball, &Isometry3::translation(0.0, 0.0, 0.1), &table, &Isometry3::identity())?;
//! assert!((gap.distance - 0.03).abs() < 1e-6);
//! # Ok::<(), darrt_geom::GeomError>(())
//! ```
//!
//! | question | file |
//! |---|---|
//! | what solids are there, and how big are they? | [`shape`], [`hull`], [`mesh`] |
//! | what is a rigid body, what stands around? | [`body`], [`scene`] |
//! | what do things rest on, and where is its edge? | [`support`] |
//! | which bodies may touch, and why? | [`allowed`], [`body_set`] |
//! | how are files of unknown size and kind read? | [`bounded_file`] |
//! | how far may the planner go? | [`collide`] (cheap lower bounds, on top of the private `batch`) |
//! | how far apart are two bodies exactly, and where? | [`clearance`] |
//! | what does an independent judge say? | [`oracle`] |
//!
//! Metres and radians throughout; the world's floor is the plane z = 0 with z up; poses read `world_from_body`. nalgebra
//! types at every public surface: parry and glam stay inside.

pub mod allowed;
mod batch;
pub mod body;
pub mod body_set;
pub mod bounded_file;
mod check;
pub mod clearance;
pub mod collide;
mod convert;
pub mod error;
pub mod hull;
pub mod mesh;
mod narrow;
pub mod oracle;
mod place;
pub mod scene;
pub mod shape;
pub mod support;

pub use allowed::{AllowedContact, AllowedContacts, ContactReason};
pub use body::{Body, Part};
pub use body_set::{BodyIndex, BodySet, FIRST_OF_CROWD, MAXIMUM_BODIES};
pub use bounded_file::FileError;
pub use check::{MAXIMUM_LENGTH, MINIMUM_LENGTH};
pub use clearance::Clearance;
pub use collide::{Closer, CollisionModel, CollisionModelBuilder, Hit, Query, Scratch};
pub use error::GeomError;
pub use hull::ConvexHull;
pub use mesh::TriangleMesh;
pub use scene::{FixedBody, Scene};
pub use shape::Shape;
pub use support::{EdgePoint, SupportSurface};
