//! Where the pads of the hand are in a grasp: at the object when it is closed, beside it when it is open.

use darrt_core::laws::{Broken, ensure};
use darrt_geom::body::Body;
use nalgebra::Point3;

use super::{CONTACT, OPEN, distance_of};
use crate::grasp::{Grasp, GraspKind};
use crate::manipulator::Hand;

/// How far a closed pad may be from the object, metres: soft pads, and shapes that are rounded.
const NEAR_M: f64 = 0.005;
/// Shares of the length of a pad, from the tip back, and of half its width, at which it is looked at.
const ALONG: [f64; 4] = [0.0, 0.3, 0.6, 1.0];
const ACROSS: [f64; 3] = [0.0, -1.0, 1.0];

pub(super) fn check(body: &Body, hand: &dyn Hand, grasp: &Grasp) -> Result<(), Broken> {
    for side in [1.0, -1.0] {
        let closed = points(hand, grasp, grasp.closed_gap_m, side);
        let gaps_m: Vec<_> = closed.iter().filter_map(|point| distance_of(body, point)).collect();
        let least_m = gaps_m.iter().copied().fold(f64::INFINITY, f64::min);
        let text = || format!("{least_m:?} m from the pad at {side:+} y with a gap of {:?} m", grasp.closed_gap_m);
        ensure(CONTACT, least_m <= NEAR_M, text, "0, within 5 mm")?;
        // A bowl may be modelled as a solid, with a finger in it.
        if matches!(grasp.kind, GraspKind::Wall { .. }) {
            continue;
        }
        let behind = points(hand, grasp, grasp.closed_gap_m + 2.0 * NEAR_M, side);
        let is_flush = behind.iter().any(|point| distance_of(body, point).is_some_and(|gap_m| gap_m > 0.0));
        let text = || format!("the pad at {side:+} y is all in the object with a gap of {:?} m", grasp.closed_gap_m);
        ensure(CONTACT, is_flush, text, "not deeper in it than 5 mm")?;
        let open = points(hand, grasp, grasp.open_gap_m, side);
        let is_free = open.iter().all(|point| distance_of(body, point).is_some_and(|gap_m| gap_m > 0.0));
        let text = || format!("the pad at {side:+} y in the object with a gap of {:?} m", grasp.open_gap_m);
        ensure(OPEN, is_free, text, "beside it")?;
    }
    Ok(())
}

/// Points of the inner face of a pad, in the frame of the object.
pub(super) fn points(hand: &dyn Hand, grasp: &Grasp, gap_m: f64, side: f64) -> Vec<Point3<f64>> {
    let tip_m = hand.tip_beyond_tool_m(gap_m);
    let at = |along: f64, across: f64| {
        let in_tool =
            Point3::new(tip_m - along * hand.pad_length_m(), side * 0.5 * gap_m, across * hand.tip_half_width_m());
        grasp.object_from_tool * in_tool
    };
    ALONG.iter().flat_map(|along| ACROSS.iter().map(move |across| (*along, *across))).map(|(x, z)| at(x, z)).collect()
}
