//! Random streams keyed by (seed, attempt, iteration, purpose), so that a run repeats bit for bit however
//! many threads share the work.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// The generator behind every stream.
pub type Stream = Xoshiro256PlusPlus;

/// What a stream is for; streams of different purpose never share numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Drawing samples.
    Sample,
    /// Choosing and propagating primitives.
    Extend,
    /// Things drawn once per attempt.
    Attempt,
    /// Looking for a shorter plan.
    Shorten,
    /// Drawing a state of the goal.
    Goal,
    /// Looking for a plan that takes less time.
    Improve,
    /// Seeds of further trees.
    Further,
}

/// The generator for one purpose in one iteration of one attempt.
///
/// # Source
/// The mixing function is that of Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014.
pub fn stream(seed: u64, attempt: u64, iteration: u64, purpose: Purpose) -> Stream {
    let mut key = mix(seed.wrapping_add(0x9E37_79B9_7F4A_7C15));
    for part in [attempt, iteration, purpose as u64] {
        key = mix(key ^ part.wrapping_mul(0xD1B5_4A32_D192_ED03).wrapping_add(0x9E37_79B9_7F4A_7C15));
    }
    Stream::seed_from_u64(key)
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    #[test]
    fn streams_repeat_and_differ_in_every_key() {
        let first = |seed, attempt, iteration, purpose| -> u64 { stream(seed, attempt, iteration, purpose).random() };
        let reference = first(1, 2, 3, Purpose::Sample);
        assert_eq!(reference, first(1, 2, 3, Purpose::Sample));
        for other in [
            first(0, 2, 3, Purpose::Sample),
            first(1, 3, 2, Purpose::Sample),
            first(1, 2, 4, Purpose::Sample),
            first(1, 2, 3, Purpose::Extend),
            first(2, 1, 3, Purpose::Sample),
        ] {
            assert_ne!(reference, other);
        }
    }

    #[test]
    fn first_draws_over_iterations_are_uniform() {
        let hits = (0..20_000).filter(|i| stream(7, 0, *i, Purpose::Sample).random_bool(0.2)).count();
        assert!((3_800..4_200).contains(&hits), "{hits}");
    }
}
