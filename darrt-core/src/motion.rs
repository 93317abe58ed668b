//! What a primitive instance does over time: a pure function of `t` in `[0, 1]`.

use std::fmt::{self, Debug};

use crate::domain::Domain;
use crate::primitive::PrimitiveId;
use crate::state::{ComponentSet, ObjectId, State};

pub mod reversed;
pub mod spliced;
pub mod straight;
pub mod waypoints;

pub use reversed::Reversed;
pub use spliced::{Section, Spliced};
pub use straight::Straight;
pub use waypoints::Waypoints;

/// One motion of the combined system.
///
/// # Laws
/// - Pure: the same `t` gives the same state, bit for bit, and whatever `out` held before does not matter.
/// - At `t = 0` it is the state it was propagated from, at `t = 1` the state it leads to; the mode changes
///   only at these ends: it is constant over the open interval.
/// - No point of any component moves farther than `length() * |t2 - t1|` between `t1` and `t2`. This is
///   what lets a validity check prove that a motion is free between two samples.
///
/// # Example
/// ```
/// use darrt_core::prelude::*;
///
/// /// Nothing moves, for instance while a gripper closes.
/// struct Rest<D: Domain>(State<D>);
///
/// impl<D: Domain> Motion<D> for Rest<D> {
///     fn length(&self) -> f64 {
///         0.0
///     }
///
///     fn at_into(&self, _: &D, _: f64, out: &mut State<D>) {
///         out.clone_from(&self.0);
///     }
/// }
/// # impl<D: Domain> std::fmt::Debug for Rest<D> {
/// #     fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
/// #         f.write_str("Rest")
/// #     }
/// # }
/// ```
pub trait Motion<D: Domain>: Send + Sync + Debug {
    /// Metres: a bound on how far any point of any component travels over the whole motion.
    fn length(&self) -> f64;

    /// Parameters in `[0, 1]`, ascending, at which the direction of motion may change: between two of them every
    /// moved component follows the interpolation of its space (or is rigid to one that does). For exporting plans.
    fn knots(&self) -> &[f64] {
        &[]
    }

    /// Writes the state at `t` (clamped to `[0, 1]`) into `out`, without allocating.
    fn at_into(&self, m: &D, t: f64, out: &mut State<D>);
}

/// A primitive instance: a primitive with a specific start and displacement (paper section 3).
pub struct Instance<D: Domain> {
    /// The primitive that it is an instance of; one `propagate` may return instances of several.
    pub primitive: PrimitiveId,
    /// The motion.
    pub motion: Box<dyn Motion<D>>,
    /// What may touch during this instance, and no longer.
    pub contacts: D::Contacts,
    /// The components that it moves; all others stay bit for bit.
    pub moves: ComponentSet,
    /// The object that it manipulates or approaches, if any.
    pub object: Option<ObjectId>,
    /// May it be run backwards? A push may not.
    pub reversible: bool,
}

impl<D: Domain> Instance<D> {
    /// The state at `t`, as a new value.
    pub fn at(&self, m: &D, t: f64, like: &State<D>) -> State<D> {
        let mut out = like.clone();
        self.motion.at_into(m, t, &mut out);
        out
    }
}

// Not derived: that would ask the domain to be printable.
impl<D: Domain> Debug for Instance<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instance")
            .field("primitive", &self.primitive)
            .field("motion", &self.motion)
            .field("contacts", &self.contacts)
            .field("moves", &self.moves)
            .field("object", &self.object)
            .field("reversible", &self.reversible)
            .finish()
    }
}
