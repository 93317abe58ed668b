//! Laws of [`Distance`].

use crate::distance::Distance;
use crate::domain::Domain;
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

use super::partial::with_other_unnamed;
use super::watch::{entering, watched};
use super::{Broken, at_most, equal, measure};

mod extremes;
mod metres;
mod metric;

pub use metric::{DistanceClaims, check_metric};

/// Finite, not negative.
pub const FINITE: &str = "distance.finite: distance is finite and not negative";
/// Pure.
pub const PURE: &str = "distance.pure: the same state and target have the same distance, bit for bit";
/// Zero when met.
pub const ZERO_MET: &str = "distance.zero-met: the distance to a target that is met is 0 up to the tolerances";
/// Positive when not met.
pub const POSITIVE: &str = "distance.positive: the distance to a target that is not met is positive";
/// Unnamed parts.
pub const UNNAMED: &str = "distance.unnamed: what the target leaves open does not count";
/// A lower bound, where claimed.
pub const LOWER_BOUND: &str = "distance.lower-bound: a distance that claims to be a lower bound is at most the travel of a path that meets the target";
/// One distance below another.
pub const NOT_ABOVE: &str = "distance.not-above: the shorter of two related distances is not above the longer";

/// Small and large differences.
pub const RESOLVES: &str = "distance.resolves: half-way to where the robot should be is a third nearer at least, and so are most objects close to their targets, and closer";
/// Unit.
pub const METRES: &str = "distance.metres: the distance is in metres: half-way to where the robot should be about half of it is left, and what robot and objects travel counts within a factor of 100";
/// Symmetric, where claimed.
pub const SYMMETRIC: &str = "distance.symmetric: a distance that claims it is the same there and back";
/// Triangle inequality, where claimed.
pub const TRIANGLE: &str = "distance.triangle: a distance that claims it keeps the triangle inequality";

/// The laws of this file.
pub const LAWS: &[&str] =
    &[FINITE, PURE, ZERO_MET, POSITIVE, UNNAMED, LOWER_BOUND, NOT_ABOVE, RESOLVES, METRES, SYMMETRIC, TRIANGLE];

/// Rounding that is forgiven, metres per metre.
const SLACK: f64 = 1e-9;

/// All laws that bind every distance, for one state and target; `elsewhere` lends its values to the
/// components that the target leaves open.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_distance<D: Domain>(
    m: &D,
    distance: &dyn Distance<D>,
    from: &State<D>,
    to: &PartialState<D>,
    elsewhere: &State<D>,
) -> Result<(), Broken> {
    let about = || format!("check_distance(&{from:?}, &{to:?}, &{elsewhere:?})");
    let d = |s: &State<D>, t: &PartialState<D>| {
        entering("distance");
        distance.distance(m, s, t)
    };
    let check = || {
        let metres = d(from, to);
        measure(FINITE, metres)?;
        equal(PURE, &d(from, to), &metres)?;
        let slack = tolerances(m);
        at_most(ZERO_MET, d(&to.overlay(m, from), to), 0.0, slack)?;
        if to.is_met(m, from) {
            at_most(ZERO_MET, metres, 0.0, slack)?;
        } else if metres <= 0.0 {
            return Err(Broken::new(POSITIVE, format!("{metres:?}"), "a positive distance"));
        }
        equal(UNNAMED, &d(from, &with_other_unnamed(m, to, elsewhere)), &metres)
            .map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))?;
        for (i, there) in elsewhere.objects.iter().enumerate() {
            let id = ObjectId::new(i);
            let mut moved = from.clone();
            if to.object(id).is_none()
                && let Some(slot) = moved.objects.get_mut(i)
            {
                slot.clone_from(there);
                equal(UNNAMED, &d(&moved, to), &metres)
                    .map_err(|broken| broken.of(m.component_name(ComponentId::Object(id))))?;
            }
        }
        let trial = extremes::Trial { m, d: &d, from, to, elsewhere };
        trial.run()?;
        equal(PURE, &d(from, to), &metres).map_err(|broken| broken.of("asked again"))
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// What may remain when everything is within tolerance of its target.
fn tolerances<D: Domain>(m: &D) -> f64 {
    m.robot().tolerance() + m.objects().iter().map(ComponentSpace::tolerance).sum::<f64>()
}

/// A distance that claims to be a lower bound on travel: it is at most the length of `instances`, if they
/// lead from `from` to a state that meets `to`.
///
/// # Errors
/// [`LOWER_BOUND`] with both numbers of metres.
pub fn check_lower_bound<D: Domain>(
    m: &D,
    distance: &dyn Distance<D>,
    from: &State<D>,
    to: &PartialState<D>,
    instances: &[Instance<D>],
) -> Result<(), Broken> {
    let end = instances.last().map_or_else(|| from.clone(), |last| last.at(m, 1.0, from));
    if !to.is_met(m, &end) {
        return Ok(());
    }
    let metres = distance.distance(m, from, to);
    let travel: f64 = instances.iter().map(|instance| instance.motion.length()).sum();
    at_most(LOWER_BOUND, metres, travel, SLACK * (1.0 + travel) + tolerances(m))
        .map_err(|broken| broken.replayed_by(|| format!("check_lower_bound(&{from:?}, &{to:?}, {instances:?})")))
}

/// `shorter` is nowhere above `longer`: an exact tour is not above a greedy one.
///
/// # Errors
/// [`NOT_ABOVE`] with both distances.
pub fn check_not_above<D: Domain>(
    m: &D,
    shorter: &dyn Distance<D>,
    longer: &dyn Distance<D>,
    from: &State<D>,
    to: &PartialState<D>,
) -> Result<(), Broken> {
    let bound = longer.distance(m, from, to);
    at_most(NOT_ABOVE, shorter.distance(m, from, to), bound, SLACK * (1.0 + bound.abs()))
        .map_err(|broken| broken.replayed_by(|| format!("check_not_above(&{from:?}, &{to:?})")))
}
