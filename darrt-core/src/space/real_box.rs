//! A bounded box in R^N: joints with limits, positions in a room.

use rand::{Rng, RngExt};

use super::{ComponentSpace, Place};
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
    /// [`Error::Parameter`] if a bound is not finite, `lower > upper` on some axis, or the diagonal overflows.
    pub fn new(lower: [f64; N], upper: [f64; N]) -> Result<Self, Error> {
        Self::weighted(lower, upper, [1.0; N])
    }

    /// A box whose distance is the Euclidean norm of `weight_i * (a_i - b_i)`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a bound is not finite, `lower > upper`, a weight is not positive, or the
    /// diagonal overflows.
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
        let space = Self { lower, upper, weight };
        // Also guards the width of every axis against overflow.
        let diagonal = space.distance(&lower, &upper);
        crate::error::in_range("diagonal of the box", diagonal, 0.0, f64::MAX, "finite")?;
        Ok(space)
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
        if t <= 0.0 {
            return *a;
        }
        if t >= 1.0 {
            return *b;
        }
        // Rounding must not leave the interval between the ends. (Not `clamp`, which panics on NaN.)
        std::array::from_fn(|i| (a[i] + (b[i] - a[i]) * t).max(a[i].min(b[i])).min(a[i].max(b[i])))
    }

    fn sample(&self, rng: &mut dyn Rng) -> [f64; N] {
        std::array::from_fn(|i| rng.random_range(self.lower[i]..=self.upper[i]))
    }

    /// The box is the support: all of it, or a tenth of its width along a random face.
    fn sample_at(&self, place: Place, rng: &mut dyn Rng) -> Option<[f64; N]> {
        const EDGE: f64 = 0.1;
        let mut q = self.sample(rng);
        if place == Place::SupportEdge && N > 0 {
            let i = rng.random_range(0..N);
            let bound = if rng.random_bool(0.5) { self.lower[i] } else { self.upper[i] };
            q[i] = bound + EDGE * (q[i] - bound);
        }
        self.contains(&q).then_some(q)
    }

    fn index_coordinates(&self, q: &[f64; N], mark: &mut dyn FnMut(u32, f64)) {
        q.iter().zip(&self.weight).for_each(|(x, w)| mark(0, w * x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};

    #[test]
    fn distance_is_weighted() {
        let space = RealBox::weighted([0.0; 2], [10.0; 2], [1.0, 2.0]).unwrap();
        assert_eq!(space.distance(&[0.0, 0.0], &[3.0, 2.0]), 5.0);
    }

    #[test]
    fn ends_are_kept_bit_for_bit_and_the_middle_stays_between() {
        let space = RealBox::new([-1e3; 2], [1e3; 2]).unwrap();
        let (a, b) = ([-0.0, 0.1], [999.9, 0.1]);
        assert!(space.interpolate(&a, &b, 0.0)[0].is_sign_negative());
        assert_eq!(space.interpolate(&a, &b, 1.0), b);
        for i in 0..=1000_u16 {
            let [x, y] = space.interpolate(&a, &b, f64::from(i) / 1000.0);
            assert!((0.0..=999.9).contains(&x) && y == 0.1);
        }
    }

    #[test]
    fn not_a_number_is_outside_and_does_no_harm() {
        let space = RealBox::new([0.0; 1], [1.0; 1]).unwrap();
        assert!(!space.contains(&[f64::NAN]));
        for t in [0.0, 0.5, 1.0, f64::NAN] {
            let _ = space.interpolate(&[f64::NAN], &[f64::NAN], t);
            let _ = space.interpolate(&[0.5], &[f64::INFINITY], t);
        }
    }

    #[test]
    fn samples_fill_the_box_and_a_box_of_one_point_gives_that_point() {
        let mut rng = stream(0, 0, 0, Purpose::Sample);
        let space = RealBox::new([-2.0, 5.0], [3.0, 5.0]).unwrap();
        let samples: Vec<_> = (0..1000).map(|_| space.sample(&mut rng)).collect();
        assert!(samples.iter().all(|q| space.contains(q) && q[1] == 5.0));
        assert!(samples.iter().any(|q| q[0] < -1.9) && samples.iter().any(|q| q[0] > 2.9));
    }
}
