//! How long a straight line of the hand shall be: a wish, and the least that will do where there is no room for more.

use crate::error::{PrimitiveError, finite, within};

/// How often a length is halved before the least one is tried.
const MOST_HALVINGS: usize = 4;

/// Lengths that will do for a straight line of the hand, metres: as long as wanted where there is room, shorter where there
/// is not, never shorter than the least.
///
/// # Laws
/// `0 <= least_m <= wanted_m`, both finite; [`Self::tries`] descends from the one to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthRange {
    least_m: f64,
    wanted_m: f64,
}

impl LengthRange {
    /// From the least length to the wanted one, metres.
    ///
    /// # Errors
    /// When a length is negative or not finite, or `least_m` is above `wanted_m`.
    pub fn new(least_m: f64, wanted_m: f64) -> Result<Self, PrimitiveError> {
        let wanted_m = finite("wanted length", wanted_m)?;
        Ok(Self { least_m: within("least length", least_m, 0.0, wanted_m)?, wanted_m })
    }

    /// Of two lengths of the program itself, the least first.
    pub(crate) const fn constant(least_m: f64, wanted_m: f64) -> Self {
        Self { least_m, wanted_m }
    }

    /// The shortest that will do, metres.
    pub const fn least_m(self) -> f64 {
        self.least_m
    }

    /// The best length, metres.
    pub const fn wanted_m(self) -> f64 {
        self.wanted_m
    }

    /// The same with a wish of at most `most_m`, but not below the least.
    #[must_use]
    pub fn at_most(self, most_m: f64) -> Self {
        Self { wanted_m: self.wanted_m.min(most_m).max(self.least_m), ..self }
    }

    /// The lengths to try, longest first: the wanted one, then half as long each time, the least one last.
    pub fn tries(self) -> impl Iterator<Item = f64> {
        let halves = std::iter::successors(Some(self.wanted_m), |length| Some(length / 2.0));
        halves.take(1 + MOST_HALVINGS).take_while(move |length| *length > self.least_m).chain([self.least_m])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_range_has_finite_ends_in_order() {
        assert!(LengthRange::new(0.0, 0.0).is_ok());
        for (least_m, wanted_m) in [(-0.01, 0.1), (0.2, 0.1), (f64::NAN, 0.1), (0.1, f64::INFINITY)] {
            assert!(LengthRange::new(least_m, wanted_m).is_err(), "{least_m} {wanted_m}");
        }
    }

    #[test]
    fn a_tenth_of_a_metre_down_to_two_centimetres() {
        let tries: Vec<_> = LengthRange::new(0.02, 0.1).unwrap().tries().collect();
        assert_eq!(tries, [0.1, 0.05, 0.025, 0.02]);
        let only: Vec<_> = LengthRange::new(0.1, 0.1).unwrap().tries().collect();
        assert_eq!(only, [0.1]);
    }

    proptest! {
        #[test]
        fn tries_descend_from_the_wanted_length_to_the_least(least_m in 0.0..0.5_f64, more_m in 0.0..0.5_f64) {
            let range = LengthRange::new(least_m, least_m + more_m).unwrap();
            let tries: Vec<_> = range.tries().collect();
            prop_assert!(tries.len() <= 2 + MOST_HALVINGS);
            prop_assert_eq!((tries[0], tries[tries.len() - 1]), (range.wanted_m(), range.least_m()));
            prop_assert!(tries.windows(2).all(|pair| pair[0] > pair[1]));
        }

        #[test]
        fn a_smaller_wanted_length_stays_within_the_range(least_m in 0.0..0.5_f64, more_m in 0.0..0.5_f64, most_m in 0.0..1.0_f64) {
            let range = LengthRange::new(least_m, least_m + more_m).unwrap();
            let less = range.at_most(most_m);
            prop_assert_eq!(less.least_m(), range.least_m());
            prop_assert_eq!(less.wanted_m(), range.wanted_m().min(most_m).max(range.least_m()));
        }
    }
}
