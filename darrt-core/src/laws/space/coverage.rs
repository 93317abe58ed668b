//! Do samples fill the space?

use std::collections::BTreeSet;

use super::SAMPLE_FILLS;
use crate::laws::Broken;
use crate::laws::feed::{count, face, values};
use crate::laws::watch::{drawing, watched};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;

/// Into how many equal parts the range of a coordinate is cut.
const PARTS: usize = 16;
/// Spaces are looked at along at most this many coordinates.
const MOST: usize = 32;

/// Along every coordinate, each sixteenth of the range that `contains` accepts holds at least one of `draws` samples, and these
/// have more than a few values. The range is found from the samples themselves, by going outwards until `contains` says no.
///
/// Of even samplers, with 256 draws, one in a million is called uneven by chance; one that never draws a sixteenth is always
/// reported. A space that samples only some places on purpose (those on a table) need not keep this law.
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
            let distinct: BTreeSet<u64> = all.iter().map(|q| value(q).to_bits()).collect();
            if all.len() >= 16 * PARTS && distinct.len() < all.len() / 16 {
                let found = format!("{} values in {draws} samples", distinct.len());
                let broken = Broken::new(SAMPLE_FILLS, found, format!("values anywhere in [{low:?}, {high:?}]"));
                return Err(broken.of(format_args!("coordinate {coordinate}")));
            }
            if let Some(part) = hits.iter().position(|hit| *hit == 0) {
                let width = (high - low) / PARTS as f64;
                let from = low + width * part as f64;
                let found = format!("none of {draws} samples in [{from:?}, {:?}]", from + width);
                let broken =
                    Broken::new(SAMPLE_FILLS, found, format!("some in every sixteenth of [{low:?}, {high:?}]"));
                return Err(broken.of(format_args!("coordinate {coordinate}")));
            }
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}
