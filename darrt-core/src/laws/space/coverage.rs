//! Do samples fill the space?

use super::SAMPLE_FILLS;
use crate::laws::Broken;
use crate::laws::feed::{count, face, values};
use crate::laws::watch::{drawing, watched};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;

/// Into how many equal parts the range of a coordinate is cut.
const PARTS: usize = 4;
/// Spaces are looked at along at most this many coordinates.
const MOST: usize = 32;

/// Along every coordinate, each quarter of the range that `contains` accepts holds at least one of `draws` samples. The range
/// is found from the samples themselves, by going outwards until `contains` says no.
///
/// With 256 draws a quarter of the space that holds a fiftieth of all samples is missed once in 170 spaces; one that holds
/// none is always reported. A space that samples only some places on purpose (those on a table) need not keep this law.
///
/// # Errors
/// [`SAMPLE_FILLS`] with the coordinate and the part that stays empty.
pub fn check_space_covers<S: ComponentSpace>(space: &S, draws: u64, seed: u64) -> Result<(), Broken> {
    let about = || format!("check_space_covers({draws}, {seed})");
    let check = || {
        let mut all = Vec::new();
        for i in 0..draws {
            all.push(drawing("sample", stream(seed, 5, i, Purpose::Sample), |rng| space.sample(rng))?);
        }
        let Some(first) = all.first() else { return Ok(()) };
        for coordinate in 0..count(space, first).min(MOST) {
            let value = |q: &S::Config| values(space, q).get(coordinate).copied().unwrap_or(0.0);
            let ends = |is_upper: bool| all.iter().take(8).map(move |q| face(space, q, coordinate, is_upper));
            let low = ends(false).map(|q| value(&q)).fold(f64::INFINITY, f64::min);
            let high = ends(true).map(|q| value(&q)).fold(f64::NEG_INFINITY, f64::max);
            // Where nothing is free there is nothing to fill; nor where `contains` knows no bound.
            let is_bounded = all.iter().take(8).all(|q| {
                let (below, above) = (face(space, q, coordinate, false), face(space, q, coordinate, true));
                value(&below) < value(q) || value(&above) > value(q)
            });
            if !is_bounded || !(high - low).is_finite() || high - low <= 0.0 {
                continue;
            }
            let mut hits = [0_u64; PARTS];
            for q in &all {
                let share = ((value(q) - low) / (high - low)).clamp(0.0, 1.0);
                // At most PARTS - 1, and not negative.
                let part = (1..PARTS).filter(|part| share >= *part as f64 / PARTS as f64).count();
                hits.iter_mut().skip(part).take(1).for_each(|hit| *hit += 1);
            }
            if let Some(part) = hits.iter().position(|hit| *hit == 0) {
                let width = (high - low) / PARTS as f64;
                let from = low + width * part as f64;
                let found = format!("none of {draws} samples in [{from:?}, {:?}]", from + width);
                let broken = Broken::new(SAMPLE_FILLS, found, format!("some in every quarter of [{low:?}, {high:?}]"));
                return Err(broken.of(format_args!("coordinate {coordinate}")));
            }
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}
