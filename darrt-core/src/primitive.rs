//! The actions A: what a robot can do, as `useful` and `propagate` (paper section 4.1).

use std::fmt;

use rand::Rng;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::state::State;
use crate::validity::Blame;

/// The instances that one `propagate` returns, in order of execution.
pub type Instances<D> = Vec<Instance<D>>;

/// What a primitive is known by: an index into the set of primitives that a program knows, and a name for people. Two ids
/// are the same if their indices are, whatever the names.
///
/// # Example
/// ```
/// use darrt_core::primitive::PrimitiveId;
///
/// const PUSH: PrimitiveId = PrimitiveId::new(7, "Push");
/// assert_eq!(PUSH, PrimitiveId::new(7, "Schieben"));
/// assert_eq!(PUSH.to_string(), "Push");
/// ```
#[derive(Clone, Copy)]
pub struct PrimitiveId {
    index: u16,
    name: &'static str,
}

impl PrimitiveId {
    /// The primitive with this index.
    pub const fn new(index: u16, name: &'static str) -> Self {
        Self { index, name }
    }

    /// Its place in the set.
    pub const fn index(self) -> usize {
        self.index as usize
    }

    /// Its name, for people.
    pub const fn name(self) -> &'static str {
        self.name
    }
}

impl PartialEq for PrimitiveId {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl Eq for PrimitiveId {}

impl PartialOrd for PrimitiveId {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for PrimitiveId {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.index.cmp(&other.index)
    }
}

impl std::hash::Hash for PrimitiveId {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.index.hash(state);
    }
}

impl fmt::Debug for PrimitiveId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}

impl fmt::Display for PrimitiveId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}

/// Why a primitive that looked useful cannot be propagated: an ordinary outcome, counted, not an error.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Infeasible {
    /// No grasp of the object fits.
    NoGrasp,
    /// No grasp that fits would hold the object against its weight.
    NoHold,
    /// No contact from which the object could be moved the right way.
    NoContact,
    /// The object would not stay at the contacts while it is pushed, or is too heavy to be pushed.
    UnstablePush,
    /// No robot configuration reaches the pose that is needed.
    Unreachable,
    /// Reached only outside the limits of the robot.
    Limits,
    /// The object would leave its support.
    OffSupport,
    /// It would end where it began.
    NoProgress,
    /// The primitive asked its domain what is in the way, and in every try something was; the one of the last try.
    Blocked(Blame),
}

/// A manipulation primitive.
///
/// Obstacles need not be seen here: whether a motion is free is judged afterwards (Algorithm 1, `PATH(c1, c2, M, A)`).
/// A primitive whose domain knows the obstacles may ask it, so as not to propose what cannot be. Several instances may be
/// returned, also of other kinds: Push returns the transit to the pushing pose first.
///
/// # Laws
/// - If `useful` and `propagate` succeeds, the instances are not empty, the first starts at `from` bit for
///   bit, each next one starts where the last ended, and the end is nearer to `to` in the subspace that
///   the primitive moves.
/// - Components that an instance does not name in [`Instance::moves`] stay bit for bit.
/// - Unnamed components of `to` are never used as a target.
/// - Pure but for `rng`: same arguments, same generator, same result.
///
/// # Example
/// A robot that goes straight to its target ("Transit" of paper section 3):
/// ```
/// use darrt_core::prelude::*;
/// use darrt_core::motion::Straight;
///
/// const TRANSIT: PrimitiveId = PrimitiveId::new(0, "Transit");
/// struct Transit;
/// impl<D: Domain> Primitive<D> for Transit {
///     fn id(&self) -> PrimitiveId { TRANSIT }
///     fn useful(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> bool {
///         to.are_objects_met(m, from) && !to.is_robot_met(m, from)
///     }
///     fn propagate(&self, m: &D, from: &State<D>, to: &PartialState<D>, _: &mut dyn rand::Rng)
///         -> Result<Instances<D>, Infeasible>
///     {
///         let target = to.robot_overlay(m, &from.robot);
///         let length = m.robot().distance(&from.robot, &target);
///         Ok(vec![Instance {
///             primitive: TRANSIT,
///             motion: Box::new(Straight::new(from.clone(), target, length)),
///             contacts: D::Contacts::default(),
///             moves: ComponentSet::ROBOT,
///             object: None,
///             reversible: true,
///         }])
///     }
/// }
/// ```
pub trait Primitive<D: Domain>: Send + Sync {
    /// What it is known by; no two primitives of a problem have the same one.
    fn id(&self) -> PrimitiveId;

    /// Its name, for people.
    fn name(&self) -> &'static str {
        self.id().name()
    }

    /// Would propagating `from` towards `to` end nearer to `to`? Cheap: no inverse kinematics.
    fn useful(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> bool;

    /// Metres the robot must travel before it can start, if the primitive knows: how DISTANCE gets to see
    /// A (paper section 4.3). Must not exceed the travel of a propagation that succeeds.
    fn approach(&self, _m: &D, _from: &State<D>, _to: &PartialState<D>) -> Option<f64> {
        None
    }

    /// A sequence of instances that takes `from` to a state nearer to `to`.
    ///
    /// # Errors
    /// [`Infeasible`] when there is none, or none was found for this draw of `rng`.
    fn propagate(
        &self,
        m: &D,
        from: &State<D>,
        to: &PartialState<D>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<D>, Infeasible>;
}
