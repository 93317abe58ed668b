//! Do samples fill the space?

use std::collections::BTreeSet;

use super::SAMPLE_FILLS;
use crate::laws::Broken;
use crate::laws::feed::{count, face, values, with};
use crate::laws::watch::{drawing, watched};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;

/// Into how many equal parts the range of a coordinate is cut.
const PARTS: usize = 16;
/// So many values may come again: places at which many samples lie. More are a lattice.
const MOST_AGAIN: usize = 16;
/// Into how many parts the ranges of two coordinates are cut, to see whether they are drawn one by the other; how many samples
/// are drawn for that, and how many are expected in a part that must not be empty.
const PAIR_PARTS: u32 = 10;
const PAIR_DRAWS: u64 = 3600;
const PAIR_EXPECTED: usize = 14;
/// Coordinates of which pairs are looked at.
const MOST_PAIRED: usize = 8;
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
            let mut sorted: Vec<u64> = all.iter().map(|q| value(q).to_bits()).collect();
            sorted.sort_unstable();
            let again: BTreeSet<u64> =
                sorted.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
            if again.len() > MOST_AGAIN {
                let found = format!("{} values come again in {draws} samples", again.len());
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
        corners(space, seed)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// Every two coordinates, if the space takes any values of them together: each of the parts into which their ranges are cut
/// holds a sample, if either of its sides holds so many that some are expected there. Otherwise one depends on the other, or a
/// corner is left out.
fn corners<S: ComponentSpace>(space: &S, seed: u64) -> Result<(), Broken> {
    let mut all = Vec::new();
    for i in 0..PAIR_DRAWS {
        all.push(drawing("sample", stream(seed, 6, i, Purpose::Sample), |rng| space.sample(rng))?);
    }
    let numbers: Vec<Vec<f64>> = all.iter().map(|q| values(space, q)).collect();
    let column = |i: usize| numbers.iter().map(move |q| q.get(i).copied().unwrap_or(0.0));
    let ranges: Vec<(usize, f64, f64)> = (0..numbers.first().map_or(0, Vec::len).min(MOST_PAIRED))
        .map(|i| (i, column(i).fold(f64::INFINITY, f64::min), column(i).fold(f64::NEG_INFINITY, f64::max)))
        .filter(|(i, low, high)| {
            high > low && column(*i).map(f64::to_bits).collect::<BTreeSet<_>>().len() > all.len() / 2
        })
        .collect();
    for (k, a) in ranges.iter().enumerate() {
        for b in ranges.iter().skip(k + 1) {
            let part = |q: &[f64], (i, low, high): &(usize, f64, f64)| {
                let share = (q.get(*i).copied().unwrap_or(*low) - low) / (high - low);
                (1..PAIR_PARTS).filter(|part| share >= f64::from(*part) / f64::from(PAIR_PARTS)).count()
            };
            let hit: Vec<(usize, usize)> = numbers.iter().map(|q| (part(q, a), part(q, b))).collect();
            let together: BTreeSet<_> = hit.iter().copied().collect();
            let parts = || (0..PAIR_PARTS).zip(0_usize..);
            for ((i, row), (j, side)) in parts().flat_map(|one| parts().map(move |other| (one, other))) {
                let in_row = hit.iter().filter(|(one, _)| *one == row).count();
                let in_side = hit.iter().filter(|(_, other)| *other == side).count();
                if together.contains(&(row, side)) || in_row * in_side < PAIR_EXPECTED * all.len() {
                    continue;
                }
                // The middle of the part, with all else as in some samples.
                let middle = |(_, low, high): &(usize, f64, f64), part: u32| {
                    low + (high - low) * (f64::from(part) + 0.5) / f64::from(PAIR_PARTS)
                };
                let (x, y) = (middle(a, i), middle(b, j));
                let is_taken = |q: &S::Config| space.contains(&with(space, &with(space, q, a.0, x), b.0, y));
                if all.iter().take(8).all(is_taken) {
                    let found = format!("none of {} samples near {x:?} and {y:?}", all.len());
                    let broken = Broken::new(SAMPLE_FILLS, found, "some: contains accepts them together");
                    return Err(broken.of(format_args!("coordinates {} and {}", a.0, b.0)));
                }
            }
        }
    }
    Ok(())
}
