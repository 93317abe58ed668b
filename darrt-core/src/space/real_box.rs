//! A bounded box in R^N: joints with limits, positions in a room.

use rand::{Rng, RngExt};

use super::ComponentSpace;
use crate::error::Error;

/// `[lower_i, upper_i]` for `i < N`, with metres of travel per unit of each coordinate as weights.
#[derive(Debug, Clone, PartialEq)]
pub struct RealBox<const N: usize> {
    lower: [f64; N],
    upper: [f64; N],
    weight: [f64; N],
}

impl<const N: usize> RealBox<N> {
    /// A box with weight 1 on every axis.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a bound is not finite or `lower > upper` on some axis.
    pub fn new(lower: [f64; N], upper: [f64; N]) -> Result<Self, Error> {
        Self::weighted(lower, upper, [1.0; N])
    }

    /// A box whose distance is the Euclidean norm of `weight_i * (a_i - b_i)`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a bound is not finite, `lower > upper`, or a weight is not positive.
    pub fn weighted(lower: [f64; N], upper: [f64; N], weight: [f64; N]) -> Result<Self, Error> {
        for (i, ((l, u), w)) in lower.iter().zip(&upper).zip(&weight).enumerate() {
            crate::error::in_range(
                &format!("lower bound of axis {i}"),
                *l,
                f64::MIN,
                *u,
                "finite and at most the upper bound",
            )?;
            crate::error::in_range(&format!("upper bound of axis {i}"), *u, f64::MIN, f64::MAX, "finite")?;
            crate::error::in_range(
                &format!("weight of axis {i}"),
                *w,
                f64::MIN_POSITIVE,
                f64::MAX,
                "finite and positive",
            )?;
        }
        Ok(Self { lower, upper, weight })
    }

    /// Lower bounds.
    pub fn lower(&self) -> &[f64; N] {
        &self.lower
    }

    /// Upper bounds.
    pub fn upper(&self) -> &[f64; N] {
        &self.upper
    }
}

impl<const N: usize> ComponentSpace for RealBox<N> {
    type Config = [f64; N];

    fn dimension(&self) -> usize {
        N
    }

    fn contains(&self, q: &[f64; N]) -> bool {
        q.iter().zip(&self.lower).zip(&self.upper).all(|((x, l), u)| x >= l && x <= u)
    }

    fn distance(&self, a: &[f64; N], b: &[f64; N]) -> f64 {
        let squares = a.iter().zip(b).zip(&self.weight).map(|((x, y), w)| (w * (x - y)).powi(2));
        squares.sum::<f64>().sqrt()
    }

    fn interpolate(&self, a: &[f64; N], b: &[f64; N], t: f64) -> [f64; N] {
        if t >= 1.0 {
            return *b;
        }
        // Clamped: rounding must not leave the interval between the ends.
        std::array::from_fn(|i| (a[i] + (b[i] - a[i]) * t).clamp(a[i].min(b[i]), a[i].max(b[i])))
    }

    fn sample(&self, rng: &mut dyn Rng) -> [f64; N] {
        std::array::from_fn(|i| rng.random_range(self.lower[i]..=self.upper[i]))
    }
}
