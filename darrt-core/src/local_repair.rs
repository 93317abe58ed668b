//! A way around: what an extension may try when the straight motion of a transit is blocked.
//!
//! The paper names this as where most of the planning time goes (section 6.2, figure 7b): the hand must get around the
//! plate. PATH does not see obstacles, so the way around is looked for here, between PATH and the collision check.

use rand::Rng;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::state::State;
use crate::validity::Validity;

/// Why there is no way around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoWay {
    /// None was found with this care; with less there may be one.
    WithThisCare,
    /// None was found with any care.
    WithAnyCare,
}

/// Finds another motion between the ends of a blocked one.
///
/// # Laws
/// The result starts at `from` and ends where `instance` ends, bit for bit; it moves the same components and touches
/// nothing more; the validity that was asked finds it free without care. Pure but for `rng`.
///
/// # Example
/// ```
/// use darrt_core::prelude::*;
/// use darrt_core::local_repair::{NoWay, LocalRepair};
/// use rand::Rng;
///
/// /// Another one's ways around, but never for an instance that names an object.
/// struct Alone<R>(R);
///
/// impl<D: Domain, R: LocalRepair<D>> LocalRepair<D> for Alone<R> {
///     fn is_free_to_turn(&self, m: &D, instance: &Instance<D>) -> bool {
///         instance.object.is_none() && self.0.is_free_to_turn(m, instance)
///     }
///
///     fn repair(
///         &self,
///         m: &D,
///         validity: &dyn Validity<D>,
///         care: usize,
///         instance: &Instance<D>,
///         from: &State<D>,
///         rng: &mut dyn Rng,
///     ) -> Result<Instance<D>, NoWay> {
///         if !self.is_free_to_turn(m, instance) {
///             return Err(NoWay::WithAnyCare);
///         }
///         self.0.repair(m, validity, care, instance, from, rng)
///     }
/// }
/// ```
pub trait LocalRepair<D: Domain>: Send + Sync {
    /// May this instance go any way between its ends? A transit may; a push, an approach or a pick may not.
    fn is_free_to_turn(&self, m: &D, instance: &Instance<D>) -> bool;

    /// Another instance with the same ends as `instance`, which begins at `from` and is blocked with this `care`
    /// ([`Validity::most_care`]). It keeps as much of this care as was found, which may be less; it is not asked for again
    /// then.
    ///
    /// # Errors
    /// [`NoWay`] if the instance must go as it does (a push, an approach), or if no way was found with the effort allowed.
    fn repair(
        &self,
        m: &D,
        validity: &dyn Validity<D>,
        care: usize,
        instance: &Instance<D>,
        from: &State<D>,
        rng: &mut dyn Rng,
    ) -> Result<Instance<D>, NoWay>;
}
