//! DARRT, the Diverse Action Rapidly Exploring Random Tree: planning with several types of action for a
//! robot and movable objects, generic over all of them.
//!
//! A cart on a rail that is to shove a crate to 8 m, with a primitive of its own:
//! ```
//! use darrt_core::{distance::*, goal::Reach, motion::Waypoints, prelude::*, problem::*, sample::*, search::*};
//! use darrt_core::{observe::Silent, solve::*, space::RealBox, validity::AlwaysValid, verify::Replay};
//!
//! struct Rail(RealBox<1>, [RealBox<1>; 1]); // where the cart may be, and where the crate
//! impl Domain for Rail {
//!     type Robot = RealBox<1>;
//!     type Object = RealBox<1>;
//!     type Mode = (); // nothing is ever held
//!     type Contacts = ();
//!     fn robot(&self) -> &RealBox<1> { &self.0 }
//!     fn objects(&self) -> &[RealBox<1>] { &self.1 }
//!     fn reach(&self, cart: &[f64; 1], _: ObjectId, at: &[f64; 1]) -> f64 { (at[0] - cart[0]).abs() }
//!     fn travel_between(&self, a: (ObjectId, &[f64; 1]), b: (ObjectId, &[f64; 1])) -> f64 { (b.1[0] - a.1[0]).abs() }
//! }
//!
//! struct Shove; // drives up to the crate from below, 1 m from its middle, and on
//! impl Primitive<Rail> for Shove {
//!     fn id(&self) -> PrimitiveId { PrimitiveId::new(0, "Shove") }
//!     fn useful(&self, m: &Rail, from: &State<Rail>, to: &PartialState<Rail>) -> bool { !to.are_objects_met(m, from) }
//!     fn propagate(&self, _: &Rail, from: &State<Rail>, to: &PartialState<Rail>, _: &mut dyn rand::Rng)
//!         -> Result<Instances<Rail>, Infeasible> {
//!         let (id, wanted) = to.objects().next().ok_or(Infeasible::NoProgress)?;
//!         let (cart, at, end) = (from.robot[0], from.objects[0][0], wanted[0]);
//!         if end <= at || cart > at - 1.0 { return Err(Infeasible::NoContact) }
//!         let state = |x, y| State { robot: [x], objects: [[y]].into_iter().collect(), mode: () };
//!         let states = vec![state(cart, at), state(at - 1.0, at), state(end - 1.0, end)];
//!         let way = Waypoints::new(states, &[at - 1.0 - cart, end - at], ()).ok_or(Infeasible::NoProgress)?;
//!         let (motion, moves) = (Box::new(way), ComponentSet::ROBOT.with(ComponentId::Object(id)));
//!         let primitive = self.id();
//!         Ok(vec![Instance { primitive, motion, contacts: (), moves, object: Some(id), reversible: false }])
//!     }
//! }
//!
//! let space = RealBox::new([0.0], [10.0])?;
//! let domain = Rail(space.clone(), [space]);
//! let goal = Box::new(Reach::new(PartialState::anywhere(&domain).with_object(ObjectId::new(0), [8.0])));
//! let start = State { robot: [1.0], objects: [[4.0]].into_iter().collect(), mode: () };
//! let (validity, verifier) = (Box::new(AlwaysValid), Box::new(Replay::new(AlwaysValid, 0.01)));
//! let problem = Problem::new(Parts { domain, start, goal, primitives: vec![Box::new(Shove)], validity, verifier })?;
//! let strategy = Strategy::new(GoalBiased::new(Full, 0.2)?, Euclidean);
//! let plan = solve(&problem, &strategy, &SolveOptions::default(), &mut Silent).solution.ok_or("no plan")?;
//! assert_eq!(plan.plan().end(problem.domain()).objects[0], [8.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
//!
//! | feature | what it adds |
//! |---|---|
//! | `testing` | `testing`: a planar toy domain, implementations that break the laws, proptest strategies |

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
