use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use pulp::{Arch, Scalar, WithSimd};

use super::*;

/// Sine, cosine, arc tangent of two rows.
struct Functions<'a>(&'a Row, &'a Row);

impl WithSimd for Functions<'_> {
    type Output = [Row; 3];

    fn with_simd<S: Simd>(self, simd: S) -> [Row; 3] {
        let mut out = [Row::splat(0.0); 3];
        for register in 0..registers::<S>() {
            let (a, b) = (Lanes::load(simd, self.0, register), Lanes::load(simd, self.1, register));
            let (sine, cosine) = a.sin_cos();
            for (value, row) in [sine, cosine, a.atan2(b)].into_iter().zip(&mut out) {
                value.store(row, register);
            }
        }
        out
    }
}

fn bits(rows: &[Row; 3]) -> Vec<u64> {
    rows.iter().flat_map(|row| row.0).map(f64::to_bits).collect()
}

/// Against the platform's functions, and with the same bits on the vector unit as without.
fn check(a: &Row, b: &Row) -> Result<(), TestCaseError> {
    let out = Arch::new().dispatch(Functions(a, b));
    prop_assert_eq!(bits(&out), bits(&Scalar.vectorize(Functions(a, b))));
    for lane in 0..LANES {
        let (angle, x) = (a.0[lane], b.0[lane]);
        prop_assert!((out[0].0[lane] - angle.sin()).abs() <= 3e-16, "sin {angle}: {}", out[0].0[lane]);
        prop_assert!((out[1].0[lane] - angle.cos()).abs() <= 3e-16, "cos {angle}: {}", out[1].0[lane]);
        prop_assert!((out[2].0[lane] - angle.atan2(x)).abs() <= 1e-15, "atan2 {angle} {x}: {}", out[2].0[lane]);
    }
    Ok(())
}

proptest! {
    #[test]
    fn functions_are_those_of_the_platform(
        a in prop::array::uniform8(-10.0_f64..10.0), b in prop::array::uniform8(-10.0_f64..10.0),
    ) {
        check(&Row(a), &Row(b))?;
    }

    #[test]
    fn large_and_tiny_values_are_right_too(
        a in prop::array::uniform8(-LARGEST_ANGLE..=LARGEST_ANGLE), exponents in prop::array::uniform8(-300.0_f64..5.0),
    ) {
        check(&Row(a), &Row(exponents.map(|e| 10.0_f64.powf(e))))?;
        check(&Row(exponents.map(|e| -(10.0_f64.powf(e)))), &Row(a))?;
    }

    #[test]
    fn near_the_quarter_turns_little_is_lost(counts in prop::array::uniform8(-400_000_i32..400_000), off in -1e-9_f64..1e-9) {
        check(&Row(counts.map(|n| f64::from(n) * FRAC_PI_2 + off)), &Row::splat(1.0))?;
    }
}

/// A fine walk over the turn: the bound that the documents state, measured.
#[test]
fn the_errors_stay_within_their_bounds_all_around() {
    for i in -40_000..40_000_i32 {
        let a: [f64; LANES] = std::array::from_fn(|lane| (f64::from(i) + lane as f64 / 8.0) * 1e-4);
        check(&Row(a), &Row(a.map(f64::cos))).unwrap();
    }
}

#[test]
fn what_has_no_angle_is_no_number() {
    let [sine, cosine, _] = Arch::new().dispatch(Functions(
        &Row([f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 8.1e5, -8.1e5, 1e300, -1e20, 8e5]),
        &Row::splat(1.0),
    ));
    for lane in 0..LANES {
        assert_eq!(sine.0[lane].is_nan(), lane < 7, "lane {lane}");
        assert_eq!(cosine.0[lane].is_nan(), lane < 7, "lane {lane}");
    }
}

#[test]
fn the_axes_have_the_angles_of_the_platform() {
    let y = [0.0, -0.0, 0.0, -0.0, 1.0, -1.0, 0.0, 3.0];
    let x = [1.0, 1.0, -1.0, -1.0, 0.0, 0.0, 0.0, f64::NAN];
    let angles = Arch::new().dispatch(Functions(&Row(y), &Row(x)))[2].0;
    for lane in 0..6 {
        assert_eq!(angles[lane].to_bits(), y[lane].atan2(x[lane]).to_bits(), "{} {}", y[lane], x[lane]);
    }
    assert_eq!(angles[2], PI);
    assert_eq!(angles[6], 0.0);
    assert!(angles[7].is_nan());
}
