//! DARRT, the Diverse Action Rapidly Exploring Random Tree: planning with several types of action for a
//! robot and movable objects, generic over all of them.
//!
//! Barry, Hsiao, Kaelbling, Lozano-Pérez, *Manipulation with Multiple Action Types*, ISER 2012 ("the
//! paper" throughout).
//!
//! | Algorithm 1 | here |
//! |---|---|
//! | input M, B, A, `c_I`, G | [`problem`] ([`domain`], [`validity`], [`primitive`], [`goal`]) |
//! | the loop | [`search`], owned by [`solve`] |
//! | SAMPLE(M) | [`sample`] |
//! | arg min DISTANCE(v, s, M, A) | [`nearest`], [`distance`] |
//! | EXTENDTOWARDS | [`extend`] |
//! | PATH, `useful`, `propagate` | [`path`](mod@path), [`primitive`] |
//! | `collision(e_i, M, B)` | [`validity`] |
//! | V | [`tree`] |
//! | (beyond the paper) from the first plan to a better, proved one | `pipeline`: [`shorten`], [`improve`] in a [`cost`], [`smooth`], [`verify`] |
//! | (for comparisons) what is no better | [`variants`] |
//!
//! A result is a [`verify::Solution`], and only the independent verifier can make one.

pub mod budget;
pub mod cost;
pub mod distance;
pub mod domain;
pub mod error;
pub mod extend;
pub mod goal;
pub mod improve;
pub mod laws;
pub mod lazy_validation;
pub mod local_repair;
pub mod motion;
pub mod nearest;
pub mod observe;
pub mod partial;
pub mod path;
mod pipeline;
pub mod plan;
pub mod primitive;
pub mod problem;
pub mod random;
pub mod record;
pub mod sample;
pub mod search;
pub mod shorten;
pub mod smooth;
pub mod solve;
pub mod space;
pub mod state;
#[cfg(feature = "testing")]
pub mod testing;
pub mod tree;
pub mod validity;
pub mod variants;
pub mod verify;

/// What an implementor of a domain or a primitive needs.
pub mod prelude {
    pub use crate::domain::Domain;
    pub use crate::goal::Goal;
    pub use crate::motion::{Instance, Motion};
    pub use crate::partial::PartialState;
    pub use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
    pub use crate::space::{ComponentSpace, GroupSet};
    pub use crate::state::{ComponentId, ComponentSet, ObjectId, State};
    pub use crate::validity::{Blame, BlockKind, FreePrefix, Validity};
}

#[cfg(all(doctest, feature = "testing"))]
#[doc = include_str!("../README.md")]
struct VariantExamples;

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct ReadmeExamples;
