//! How deep the tips are, and how the pads lie on the object.

use darrt_core::laws::{Broken, at_most, ensure};
use darrt_geom::body::Body;
use nalgebra::Point3;

use super::pads::points;
use super::{DEPTH, FLUSH, PADS, distance_of};
use crate::grasp::{Grasp, GraspFamily, GraspKind};
use crate::laws::tabletop::corners;
use crate::manipulator::Hand;

/// How far tips may be below the bottom, metres: rounding.
const BELOW_M: f64 = 1e-6;
/// How much wider than closed the hand is when its pads are looked at from outside, metres.
const BESIDE_M: f64 = 0.01;
/// What a family says of how askew its pads are may be off by this, radians.
const ASKEW_RAD: f64 = 0.053;
/// By what factor, and how many metres, the patches may be larger than the pads of the hand: families know hands of their own.
const LARGER: f64 = 3.0;
const LARGER_M: f64 = 0.02;

/// From above the tips do not get into what the object stands on.
pub(super) fn depth(body: &Body, hand: &dyn Hand, grasp: &Grasp) -> Result<(), Broken> {
    if !matches!(grasp.kind, GraspKind::Overhead { .. } | GraspKind::Wall { .. }) {
        return Ok(());
    }
    let bottom = corners(body, &nalgebra::Isometry3::identity()).map(|point| point.z).fold(f64::INFINITY, f64::min);
    for gap_m in [grasp.open_gap_m, grasp.closed_gap_m] {
        let tip = grasp.object_from_tool * Point3::new(hand.tip_beyond_tool_m(gap_m), 0.0, 0.0);
        at_most(DEPTH, bottom, tip.z, BELOW_M).map_err(|broken| broken.of("the tips, m above the middle"))?;
    }
    Ok(())
}

/// What the family tells of the pads.
pub(super) fn told(family: &dyn GraspFamily, hand: &dyn Hand, grasp: &Grasp) -> Result<(), Broken> {
    let Some(pads) = family.pads(grasp) else { return Ok(()) };
    let again = family.pads(grasp);
    ensure(PADS, format!("{again:?}") == format!("{:?}", Some(pads)), || format!("{again:?}"), "what it said before")?;
    let (length_m, half_m) = (hand.pad_length_m(), hand.tip_half_width_m());
    let tip_m = hand.tip_beyond_tool_m(grasp.closed_gap_m);
    let [x, z] = pads.middle_m;
    let [along, across] = pads.size_m;
    let fits = (tip_m - LARGER * length_m - LARGER_M..=tip_m + LARGER_M).contains(&x)
        && z.abs() <= LARGER * half_m + LARGER_M
        && (0.0..=LARGER * length_m + LARGER_M).contains(&along)
        && (0.0..=2.0 * LARGER * half_m + LARGER_M).contains(&across)
        && (0.0..=LARGER * length_m + LARGER_M).contains(&pads.spin_arm_m)
        && (0.0..=std::f64::consts::FRAC_PI_2).contains(&pads.askew_rad);
    let text = || format!("{pads:?} of pads of {length_m:?} by {:?} m", 2.0 * half_m);
    ensure(PADS, fits, text, "finite, not negative, about as large as the pads")
}

/// Both sides of a pad are as far from the object, but for the tilt that the family tells.
pub(super) fn flush(family: &dyn GraspFamily, body: &Body, hand: &dyn Hand, grasp: &Grasp) -> Result<(), Broken> {
    let is_whole = matches!(grasp.kind, GraspKind::Overhead { .. } | GraspKind::Side { .. });
    let Some(pads) = family.pads(grasp).filter(|_| is_whole) else { return Ok(()) };
    let half_m = hand.tip_half_width_m();
    for side in [1.0, -1.0] {
        let all = points(hand, grasp, grasp.closed_gap_m + BESIDE_M, side);
        // At the tip: the middle, and both sides of the pad.
        let Some([_, low, high]) = all.first_chunk::<3>() else { continue };
        let (Some(low), Some(high)) = (distance_of(body, low), distance_of(body, high)) else { continue };
        let found = ((high - low) / (2.0 * half_m)).atan().abs();
        at_most(FLUSH, found, pads.askew_rad.abs(), ASKEW_RAD)
            .map_err(|broken| broken.of(format_args!("the pad at {side:+} y, radians askew")))?;
    }
    Ok(())
}
