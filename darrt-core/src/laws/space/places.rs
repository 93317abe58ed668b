//! Samples at special places.

use super::{PLACE_INSIDE, PLACE_SEEDED, PLACE_VARIED};
use crate::laws::watch::drawing;
use crate::laws::{Broken, alike, ensure};
use crate::random::{Purpose, stream};
use crate::space::{ComponentSpace, Place};

/// How many are drawn at each place.
const DRAWS: u64 = 16;

/// What is drawn at a place lies in the space, and is drawn with the caller's generator.
pub(super) fn places<S: ComponentSpace>(space: &S, seed: u64) -> Result<(), Broken> {
    for (place, name) in [(Place::OnSupport, "on a support"), (Place::SupportEdge, "at an edge")] {
        let draw = |i| {
            let rng = stream(seed, 4, i, Purpose::Sample);
            drawing("sample_at", rng, |rng| space.sample_at(place, rng)).map_err(|broken| broken.of(name))
        };
        let mut differs = false;
        let first = draw(0)?;
        for i in 0..DRAWS {
            let found = draw(i)?;
            if let Some(q) = &found {
                ensure(PLACE_INSIDE, space.contains(q), || format!("{q:?}"), "a configuration of the space")
                    .map_err(|broken| broken.of(name))?;
            }
            differs |= found != first;
            alike(PLACE_SEEDED, &draw(i)?, &found).map_err(|broken| broken.of(name))?;
        }
        let is_told = first.is_some() && space.dimension() > 0;
        ensure(PLACE_VARIED, differs || !is_told, || format!("{DRAWS} times {first:?}"), "different ones")
            .map_err(|broken| broken.of(name))?;
    }
    Ok(())
}
