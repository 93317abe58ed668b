//! `collision(e_i, M, B)` over a whole motion at once, with the answer to "why not".

use std::fmt;
use std::sync::Arc;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::state::State;

/// What kind of rule a state breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum BlockKind {
    /// The robot hits a fixed obstacle.
    RobotFixed,
    /// The robot hits itself.
    RobotItself,
    /// The robot hits a movable object.
    RobotObject,
    /// A movable object hits a fixed obstacle.
    ObjectFixed,
    /// Two movable objects hit each other.
    ObjectObject,
    /// A component leaves its limits.
    Limits,
    /// An object that is not held has no support.
    OffSupport,
    /// Any other rule of the domain.
    Other,
}

impl fmt::Display for BlockKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RobotFixed => "robot against obstacle",
            Self::RobotItself => "robot against itself",
            Self::RobotObject => "robot against object",
            Self::ObjectFixed => "object against obstacle",
            Self::ObjectObject => "object against object",
            Self::Limits => "outside limits",
            Self::OffSupport => "off its support",
            Self::Other => "not valid",
        })
    }
}

/// Which two bodies break which rule, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Blame {
    /// The rule.
    pub kind: BlockKind,
    /// The body (or joint, or object) at fault.
    pub first: Arc<str>,
    /// What it meets: another body, or the bound in words.
    pub second: Arc<str>,
    /// A point in the world where they meet, metres.
    pub place: [f64; 3],
}

impl fmt::Display for Blame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.place;
        write!(f, "{}: {} and {} at ({x:.3}, {y:.3}, {z:.3})", self.kind, self.first, self.second)
    }
}

/// How far along a motion all states are valid.
#[derive(Debug, Clone, PartialEq)]
pub struct FreePrefix {
    /// The motion is free on `[0, fraction]`; 1 if it is free altogether.
    pub fraction: f64,
    /// What blocks it just behind `fraction`; `None` if free altogether.
    pub blame: Option<Blame>,
}

impl FreePrefix {
    /// A motion that is free from end to end.
    pub const FREE: Self = Self { fraction: 1.0, blame: None };

    /// A motion free up to `fraction`, then blocked.
    pub fn blocked(fraction: f64, blame: Blame) -> Self {
        Self { fraction: fraction.clamp(0.0, 1.0), blame: Some(blame) }
    }
}

/// The obstacles B and every other rule that a state must keep.
///
/// # Laws
/// - `free_prefix` agrees with `check` on every state of the prefix.
/// - `blame` names bodies that really touch (or come nearer than the stated clearance).
/// - Enlarging an obstacle never makes an invalid state valid.
/// - What is free with more care is free with less; a care of 0 are the rules.
///
/// # Example
/// ```
/// use darrt_core::prelude::*;
///
/// /// The robot keeps within its space; states are looked at every centimetre.
/// struct KeepsIn;
///
/// impl<D: Domain> Validity<D> for KeepsIn {
///     fn check(&self, m: &D, state: &State<D>, _: &D::Contacts) -> Result<(), Blame> {
///         if m.robot().contains(&state.robot) {
///             return Ok(());
///         }
///         let [first, second] = ["robot", "its limits"].map(Into::into);
///         Err(Blame { kind: BlockKind::Limits, first, second, place: [0.0; 3] })
///     }
///
///     fn free_prefix(&self, m: &D, instance: &Instance<D>, from: &State<D>) -> FreePrefix {
///         let steps = (instance.motion.length() / 0.01).ceil().max(1.0);
///         let mut state = from.clone();
///         let mut free = 0.0;
///         for i in 0..=steps as u32 {
///             let t = f64::from(i) / steps;
///             instance.motion.at_into(m, t, &mut state);
///             match self.check(m, &state, &instance.contacts) {
///                 Ok(()) => free = t,
///                 Err(blame) => return FreePrefix::blocked(free, blame),
///             }
///         }
///         FreePrefix::FREE
///     }
/// }
/// ```
pub trait Validity<D: Domain>: Send + Sync {
    /// Is one state valid when `contacts` may touch?
    ///
    /// # Errors
    /// The [`Blame`].
    fn check(&self, m: &D, state: &State<D>, contacts: &D::Contacts) -> Result<(), Blame>;

    /// The same rules for the objects alone, as if the robot could pass through everything: what the hierarchical search
    /// plans with first. `None` if they are not separate.
    fn without_robot(&self) -> Option<Arc<dyn Validity<D>>> {
        None
    }

    /// How far is the motion of `instance` free? The whole motion is handed over so that the
    /// implementation may batch, bound and reorder; it must not allocate per state.
    fn free_prefix(&self, m: &D, instance: &Instance<D>, from: &State<D>) -> FreePrefix;

    /// The most care there is. A care of 0 are the rules that every plan keeps; with more of it a state or a motion also
    /// keeps what plans keep where they can, for instance a wider margin.
    fn most_care(&self) -> usize {
        0
    }

    /// [`Validity::check`] with a care of at most [`Validity::most_care`].
    ///
    /// # Errors
    /// The [`Blame`].
    fn check_with(&self, care: usize, m: &D, state: &State<D>, contacts: &D::Contacts) -> Result<(), Blame> {
        let _ = care;
        self.check(m, state, contacts)
    }

    /// [`Validity::free_prefix`] with a care of at most [`Validity::most_care`].
    fn free_prefix_with(&self, care: usize, m: &D, instance: &Instance<D>, from: &State<D>) -> FreePrefix {
        let _ = care;
        self.free_prefix(m, instance, from)
    }
}

/// Everything is valid: for problems without obstacles, and for tests.
#[derive(Debug, Clone, Copy, Default)]
pub struct AlwaysValid;

impl<D: Domain> Validity<D> for AlwaysValid {
    fn check(&self, _: &D, _: &State<D>, _: &D::Contacts) -> Result<(), Blame> {
        Ok(())
    }

    fn free_prefix(&self, _: &D, _: &Instance<D>, _: &State<D>) -> FreePrefix {
        FreePrefix::FREE
    }
}
