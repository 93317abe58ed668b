//! Kinematics of any tree of rigid links: reading a URDF, forward kinematics, Jacobians, numeric inverse.
//!
//! | question | file |
//! |---|---|
//! | is this text safe to hand to an XML reader? | [`guard`] |
//! | is this robot description sound? | [`urdf`] |
//! | what are its groups, postures, hands, harmless pairs? | [`srdf`] |
//! | between which values may a joint stand? | [`limit`] |
//! | where are all links? | [`tree`] |
//! | where are they in many configurations at once? | [`batch`], in the arithmetic of [`lanes`] |
//! | what do the links occupy? | [`collision`] |
//! | which pairs of links need a collision check? | [`pair_sampling`] |
//! | where do their meshes lie? | [`mesh_places`] |
//! | how does a link move when one joint moves? | [`jacobian`] |
//! | which joint values bring a link to a pose? | [`chain_inverse`] |
//!
//! Nothing here names a robot. A robot with a closed-form inverse brings its own; [`chain_inverse`] is for the rest.

pub mod batch;
pub mod chain_inverse;
pub mod collision;
pub mod guard;
pub mod jacobian;
pub mod lanes;
pub mod limit;
pub mod mesh_places;
pub mod pair_sampling;
pub mod srdf;
pub mod tree;
pub mod urdf;

pub use batch::{BatchForward, BatchPoses, PoseLanes};
pub use chain_inverse::{ChainInverse, InverseOptions, JointValues};
pub use collision::{link_bodies, no_meshes};
pub use jacobian::KinematicChain;
pub use limit::JointLimit;
pub use mesh_places::MeshPlaces;
pub use pair_sampling::{PairFate, SampledPairs, sample_pairs};
pub use srdf::{SemanticDescription, SrdfError};
pub use tree::{KinematicTree, KinematicsError};
pub use urdf::{RobotDescription, UrdfError};
