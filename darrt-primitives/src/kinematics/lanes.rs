//! Numbers side by side in one vector register: arithmetic, sine and cosine, arc tangent.
//!
//! A kernel that is written in [`Lanes`] is compiled by `pulp` for every kind of vector unit and chosen when the program
//! runs. Products and sums are kept apart (no fused ones) and nothing is taken from the platform's mathematical library,
//! so every processor, the one without a vector unit included, gives the same bits.
//!
//! The coefficients of the polynomials are own fits at Chebyshev nodes in 50 digits, rounded to `f64`.

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

/// Values in one row: what a batch works on at once.
pub const LANES: usize = 8;

/// One value per lane of a batch, aligned to a line of the cache.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Row(pub [f64; LANES]);

impl Row {
    /// The same value in every lane.
    pub const fn splat(value: f64) -> Self {
        Self([value; LANES])
    }
}

/// Largest angle, rad, whose sine and cosine are computed: beyond it (and for what is no number) both are NaN.
pub const LARGEST_ANGLE: f64 = 8e5;

/// `sin r = r + r^3 S(r^2)` for `|r| <= pi / 4`, to 2e-17.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_330_948,
    -0.000_198_412_698_367_585_28,
    2.755_731_610_252_864_6e-6,
    -2.505_113_184_004_412_4e-8,
    1.591_812_893_755_445_7e-10,
];
/// `cos r = 1 - r^2 / 2 + r^4 C(r^2)` for `|r| <= pi / 4`, to 1e-18.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_739_8,
    2.480_158_729_876_566e-5,
    -2.755_731_727_171_490_6e-7,
    2.087_614_626_530_06e-9,
    -1.138_263_220_199_036e-11,
];
/// `atan u = u + u^3 A(u^2)` for `|u| <= tan(pi / 8)`, to 6e-17.
const ARC_TANGENT: [f64; 10] = [
    -0.333_333_333_333_332_5,
    0.199_999_999_998_984_07,
    -0.142_857_142_660_966_2,
    0.111_111_096_365_343_53,
    -0.090_908_525_571_757_49,
    0.076_910_551_583_877_15,
    -0.066_496_136_952_342_56,
    0.057_363_321_655_555_98,
    -0.044_833_346_211_129_645,
    0.022_750_526_977_488_576,
];
/// A quarter turn in three parts, the first two of 33 bits: their products with a count below 2^20 are exact.
const QUARTER_TURN: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Added and taken away again it rounds to a whole number; in between the number stands in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// The bit of a number's sign.
const SIGN: u64 = 1 << 63;
/// `tan(pi / 8)`.
const EIGHTH_TANGENT: f64 = 0.414_213_562_373_095_03;

/// `N` registers of `f64` on which the same is done.
///
/// One operation waits for the one before it, so long chains of them (a polynomial) run faster on two registers side by
/// side than on one after the other.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd, const N: usize = 1> {
    simd: S,
    values: [S::f64s; N],
}

/// A yes or no for each lane.
#[derive(Debug, Clone, Copy)]
pub struct Mask<S: Simd, const N: usize = 1> {
    simd: S,
    values: [S::m64s; N],
}

/// How many registers a [`Row`] takes.
pub const fn registers<S: Simd>() -> usize {
    const { assert!(S::F64_LANES <= LANES && LANES.is_multiple_of(S::F64_LANES)) };
    LANES / S::F64_LANES
}

impl<S: Simd> Lanes<S> {
    /// The `register`-th part of a row, below [`registers`].
    #[inline(always)]
    pub fn load(simd: S, row: &Row, register: usize) -> Self {
        Self { simd, values: [S::as_simd_f64s(&row.0).0[register]] }
    }

    /// Writes the `register`-th part of a row, below [`registers`].
    #[inline(always)]
    pub fn store(self, row: &mut Row, register: usize) {
        S::as_mut_simd_f64s(&mut row.0).0[register] = self.values[0];
    }

    /// Both side by side.
    #[inline(always)]
    pub fn beside(self, other: Self) -> Lanes<S, 2> {
        Lanes { simd: self.simd, values: [self.values[0], other.values[0]] }
    }
}

impl<S: Simd> Lanes<S, 2> {
    /// One after the other.
    #[inline(always)]
    pub fn apart(self) -> [Lanes<S>; 2] {
        let Self { simd, values: [a, b] } = self;
        [Lanes { simd, values: [a] }, Lanes { simd, values: [b] }]
    }
}

impl<S: Simd, const N: usize> Lanes<S, N> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: [simd.splat_f64s(value); N] }
    }

    /// What it is computed with.
    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// Absolute value.
    #[inline(always)]
    #[must_use]
    pub fn abs(mut self) -> Self {
        let others = self.simd.splat_u64s(!SIGN);
        for value in &mut self.values {
            let bits = self.simd.and_u64s(self.simd.transmute_u64s_f64s(*value), others);
            *value = self.simd.transmute_f64s_u64s(bits);
        }
        self
    }

    /// Square root, correctly rounded; of a negative number NaN.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(mut self) -> Self {
        for value in &mut self.values {
            *value = self.simd.sqrt_f64s(*value);
        }
        self
    }

    /// This where `mask`, `other` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn or_where_not(mut self, mask: Mask<S, N>, other: Self) -> Self {
        for n in 0..N {
            self.values[n] = self.simd.select_f64s(mask.values[n], self.values[n], other.values[n]);
        }
        self
    }

    /// `self <= other`; false where either is no number.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> Mask<S, N> {
        let mut mask = Mask::all(self.simd);
        for n in 0..N {
            mask.values[n] = self.simd.less_than_or_equal_f64s(self.values[n], other.values[n]);
        }
        mask
    }

    /// `self < other`; false where either is no number.
    #[inline(always)]
    pub fn below(self, other: Self) -> Mask<S, N> {
        let mut mask = Mask::all(self.simd);
        for n in 0..N {
            mask.values[n] = self.simd.less_than_f64s(self.values[n], other.values[n]);
        }
        mask
    }

    /// The smaller of `self` and a bound; what is no number stays so.
    #[inline(always)]
    #[must_use]
    pub fn no_more_than(self, bound: f64) -> Self {
        let bound = self.of(bound);
        bound.or_where_not(bound.below(self), self)
    }

    /// The larger of `self` and a bound; what is no number stays so.
    #[inline(always)]
    #[must_use]
    pub fn no_less_than(self, bound: f64) -> Self {
        let bound = self.of(bound);
        bound.or_where_not(self.below(bound), self)
    }

    /// The magnitude of `self` with the sign bit of `sign`.
    #[inline(always)]
    #[must_use]
    pub fn copysign(self, sign: Self) -> Self {
        self.abs().times_sign_of(sign)
    }

    /// `self` with its sign turned where `sign` has its sign bit set.
    #[inline(always)]
    #[must_use]
    pub fn times_sign_of(mut self, sign: Self) -> Self {
        let bit = self.simd.splat_u64s(SIGN);
        for n in 0..N {
            let sign = self.simd.and_u64s(self.simd.transmute_u64s_f64s(sign.values[n]), bit);
            let bits = self.simd.xor_u64s(self.simd.transmute_u64s_f64s(self.values[n]), sign);
            self.values[n] = self.simd.transmute_f64s_u64s(bits);
        }
        self
    }

    /// Sine and cosine of angles in rad.
    ///
    /// Both are within 3e-16 of the truth for angles up to [`LARGEST_ANGLE`] on either side, and NaN beyond.
    ///
    /// # Source
    /// Reduction to the nearest quarter turn in three parts: Cody and Waite, *Software Manual for the Elementary
    /// Functions* (1980), chapter 8.
    #[inline(always)]
    pub fn sin_cos(self) -> (Self, Self) {
        let counted = self * std::f64::consts::FRAC_2_PI + ROUNDER;
        let quarters = counted - ROUNDER;
        let [first, second, third] = QUARTER_TURN;
        let rest = ((self - quarters * first) - quarters * second) - quarters * third;
        let is_fit = self.abs().at_most(self.of(LARGEST_ANGLE));
        let rest = rest.or_where_not(is_fit, self.of(f64::NAN));
        let square = rest * rest;
        let sine = rest + rest * square * polynomial6(square, &SINE);
        let cosine = self.of(1.0) - (square * 0.5 - square * square * polynomial6(square, &COSINE));
        // Odd quarters swap the two. The second lowest bit of the count is the sign of the sine, that of the count plus
        // one the sign of the cosine.
        let is_odd = counted.has_bit(1, 0);
        let now = cosine.or_where_not(is_odd, sine).negative_where(counted.has_bit(2, 0));
        (now, sine.or_where_not(is_odd, cosine).negative_where(counted.has_bit(2, 1)))
    }

    /// Is this bit set in the bits of the number plus `more`?
    #[inline(always)]
    fn has_bit(self, bit: u64, more: u64) -> Mask<S, N> {
        let (simd, mut mask) = (self.simd, Mask::all(self.simd));
        let (bit, more) = (simd.splat_u64s(bit), simd.splat_u64s(more));
        for n in 0..N {
            let bits = simd.add_u64s(simd.transmute_u64s_f64s(self.values[n]), more);
            mask.values[n] = simd.equal_u64s(simd.and_u64s(bits, bit), bit);
        }
        mask
    }

    #[inline(always)]
    fn negative_where(self, mask: Mask<S, N>) -> Self {
        self.times_sign_of(self.of(-0.0).or_where_not(mask, self.of(0.0)))
    }

    /// The angle of the direction `(x, self)` in rad, in `[-pi, pi]`: within 1e-15 of the truth, 0 or pi with the sign of
    /// `self` where `self` is zero.
    #[inline(always)]
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        let (high, wide) = (self.abs(), x.abs());
        let is_steep = wide.below(high);
        let most = high.or_where_not(is_steep, wide);
        let least = wide.or_where_not(is_steep, high);
        // Angles above pi / 8 are measured from pi / 4.
        let is_far = (most * EIGHTH_TANGENT).below(least);
        let over = (least - most).or_where_not(is_far, least);
        // Only at the origin the divisor would be zero.
        let under = (least + most).or_where_not(is_far, most.no_less_than(f64::MIN_POSITIVE));
        let ratio = over / under;
        let square = ratio * ratio;
        let small = ratio + ratio * square * polynomial10(square, &ARC_TANGENT);
        let in_octant = (small + std::f64::consts::FRAC_PI_4).or_where_not(is_far, small);
        let in_quadrant = (self.of(std::f64::consts::FRAC_PI_2) - in_octant).or_where_not(is_steep, in_octant);
        let is_behind = x.below(self.of(0.0));
        let in_half = (self.of(std::f64::consts::PI) - in_quadrant).or_where_not(is_behind, in_quadrant);
        in_half.copysign(self)
    }
}

impl<S: Simd, const N: usize> Mask<S, N> {
    /// Every lane yes.
    #[inline(always)]
    pub fn all(simd: S) -> Self {
        let zero = simd.splat_u64s(0);
        Self { simd, values: [simd.equal_u64s(zero, zero); N] }
    }

    /// Both.
    #[inline(always)]
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        for n in 0..N {
            self.values[n] = self.simd.and_m64s(self.values[n], other.values[n]);
        }
        self
    }

    /// One or both.
    #[inline(always)]
    #[must_use]
    pub fn or(mut self, other: Self) -> Self {
        for n in 0..N {
            self.values[n] = self.simd.or_m64s(self.values[n], other.values[n]);
        }
        self
    }

    /// Is no lane yes?
    #[inline(always)]
    pub fn is_none(self) -> bool {
        let mut is_none = true;
        for value in self.values {
            is_none &= self.simd.first_true_m64s(value) >= S::F64_LANES;
        }
        is_none
    }

    /// 1 for yes, 0 for no.
    #[inline(always)]
    pub fn ones(self) -> Lanes<S, N> {
        Lanes::splat(self.simd, 1.0).or_where_not(self, Lanes::splat(self.simd, 0.0))
    }
}

/// `c0 + c1 z + ... + c5 z^5`, in an order that is short in time.
#[inline(always)]
fn polynomial6<S: Simd, const N: usize>(z: Lanes<S, N>, c: &[f64; 6]) -> Lanes<S, N> {
    let z2 = z * z;
    (z * c[1] + c[0]) + z2 * ((z * c[3] + c[2]) + z2 * (z * c[5] + c[4]))
}

/// `c0 + c1 z + ... + c9 z^9`.
#[inline(always)]
fn polynomial10<S: Simd, const N: usize>(z: Lanes<S, N>, c: &[f64; 10]) -> Lanes<S, N> {
    let z2 = z * z;
    let z4 = z2 * z2;
    let low = (z * c[1] + c[0]) + z2 * (z * c[3] + c[2]);
    let middle = (z * c[5] + c[4]) + z2 * (z * c[7] + c[6]);
    low + z4 * (middle + z4 * (z * c[9] + c[8]))
}

macro_rules! operator {
    ($trait:ident, $method:ident, $simd:ident) => {
        impl<S: Simd, const N: usize> $trait for Lanes<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for n in 0..N {
                    self.values[n] = self.simd.$simd(self.values[n], other.values[n]);
                }
                self
            }
        }

        impl<S: Simd, const N: usize> $trait<f64> for Lanes<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.of(other))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd, const N: usize> Neg for Lanes<S, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.times_sign_of(self.of(-0.0))
    }
}

#[cfg(test)]
mod tests;
