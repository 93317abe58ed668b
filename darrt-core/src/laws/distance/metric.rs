//! What a distance may claim beyond the laws that bind every one.

use super::{SYMMETRIC, TRIANGLE};
use crate::distance::Distance;
use crate::domain::Domain;
use crate::laws::watch::{entering, watched};
use crate::laws::{Broken, at_most};
use crate::partial::PartialState;
use crate::state::State;

/// Properties of a metric that a distance claims. Tours have neither: on the way back they begin elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DistanceClaims {
    /// As far from `a` to all of `b` as from `b` to all of `a`.
    pub symmetric: bool,
    /// From `a` to all of `c` not farther than over `b`.
    pub triangle: bool,
}

/// Rounding that is forgiven, metres per metre.
const SLACK: f64 = 1e-9;

/// The claimed properties, for three states.
///
/// # Errors
/// [`SYMMETRIC`] or [`TRIANGLE`] with the distances.
pub fn check_metric<D: Domain>(
    m: &D,
    distance: &dyn Distance<D>,
    claims: DistanceClaims,
    states: [&State<D>; 3],
) -> Result<(), Broken> {
    let about = || format!("check_metric({claims:?}, &{states:?})");
    let d = |a: &State<D>, b: &State<D>| {
        entering("distance");
        distance.distance(m, a, &PartialState::of_state(m, b))
    };
    let [a, b, c] = states;
    let check = || {
        if claims.symmetric {
            let (there, back) = (d(a, b), d(b, a));
            if (there - back).abs().is_nan() || (there - back).abs() > SLACK * (1.0 + there) {
                return Err(Broken::new(SYMMETRIC, format!("{there:?}"), format!("{back:?}")));
            }
        }
        if claims.triangle {
            let over = d(a, b) + d(b, c);
            at_most(TRIANGLE, d(a, c), over, SLACK * (1.0 + over))?;
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}
