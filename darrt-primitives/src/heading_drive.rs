//! Drives of a base that moves along its heading only, as one with two driven wheels does: it turns on the spot, drives straight
//! ahead or back, and turns again.
//!
//! The corners of such a drive depend on its ends alone, and on the rest of a drive they are those of the whole: a drive that is
//! cut anywhere, and begun again from there, goes on as it would have.

use std::f64::consts::{FRAC_PI_2, PI};

use arrayvec::ArrayVec;
use darrt_core::space::so2::{turn, wrap};

/// Headings that differ by less than this, radians, are one, and a shift below this, metres, is none.
const SAME: f64 = 1e-9;

/// The heading in which the base drives from one pose to the other, ahead or back, whichever turns it less; `None` if it only
/// turns.
fn heading(from: &[f64; 3], to: &[f64; 3]) -> Option<f64> {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    if x.hypot(y) < SAME {
        return None;
    }
    // The same of the two for the way back, so that it is the same way.
    let ahead = y.atan2(x);
    let [first, second] =
        if ahead > -FRAC_PI_2 && ahead <= FRAC_PI_2 { [ahead, wrap(ahead + PI)] } else { [wrap(ahead + PI), ahead] };
    let turned = |heading: f64| turn(from[2], heading).abs() + turn(heading, to[2]).abs();
    Some(if turned(second) < turned(first) - SAME { second } else { first })
}

/// The poses between two poses of the base at which it changes from turning to driving and back.
pub fn corners(from: &[f64; 3], to: &[f64; 3]) -> ArrayVec<[f64; 3], 2> {
    let mut corners = ArrayVec::new();
    if let Some(heading) = heading(from, to) {
        for [x, y, yaw] in [*from, *to] {
            if turn(yaw, heading).abs() > SAME {
                corners.push([x, y, heading]);
            }
        }
    }
    corners
}

/// How far the base turns on the way, radians.
pub fn turned_rad(from: &[f64; 3], to: &[f64; 3]) -> f64 {
    match heading(from, to) {
        Some(heading) => turn(from[2], heading).abs() + turn(heading, to[2]).abs(),
        None => turn(from[2], to[2]).abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn way(from: &[f64; 3], to: &[f64; 3]) -> Vec<[f64; 3]> {
        std::iter::once(*from).chain(corners(from, to)).chain([*to]).collect()
    }

    /// How far a straight move is from one along the heading: sideways metres, and radians that it turns while it drives.
    fn off(a: &[f64; 3], b: &[f64; 3]) -> [f64; 2] {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let (sin, cos) = a[2].sin_cos();
        if x.hypot(y) < SAME { [0.0; 2] } else { [(cos * y - sin * x).abs(), turn(a[2], b[2]).abs()] }
    }

    #[test]
    fn it_never_moves_sideways_and_the_rest_of_a_drive_is_the_drive() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut backwards = 0;
        for _ in 0..2000 {
            let mut pose = || [rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0), rng.random_range(-PI..PI)];
            let (from, to) = (pose(), pose());
            let way_there = way(&from, &to);
            assert!(way_there.len() <= 4);
            for pair in way_there.windows(2) {
                assert!(off(&pair[0], &pair[1]).iter().all(|off| *off < 1e-8), "{from:?} {to:?}");
            }
            let turned: f64 = way_there.windows(2).map(|pair| turn(pair[0][2], pair[1][2]).abs()).sum();
            assert!((turned - turned_rad(&from, &to)).abs() < 1e-8);
            // Ahead or back, but never turning more than half a turn in all beyond what it must.
            assert!(turned <= PI + turn(from[2], to[2]).abs() + 1e-9);
            let straight = &way_there[way_there.len().saturating_sub(2).min(1)];
            backwards += usize::from(straight[2].cos() * (to[0] - from[0]) < 0.0);
            let mut back = way(&to, &from);
            back.reverse();
            assert!(way_there.iter().flatten().zip(back.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-8));
            for pair in way_there.windows(2) {
                let share = rng.random_range(0.01..0.99);
                let [a, b] = [pair[0], pair[1]];
                let middle =
                    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), wrap(a[2] + share * turn(a[2], b[2]))];
                let rest = way(&middle, &to);
                let left: Vec<_> = way_there.iter().skip_while(|at| **at != b).copied().collect();
                for (new, old) in rest[1..].iter().rev().zip(left.iter().rev()) {
                    let far = (new[0] - old[0]).hypot(new[1] - old[1]) + turn(new[2], old[2]).abs();
                    assert!(far < 1e-6, "{from:?} {to:?} from {middle:?}: {rest:?} is not the rest {left:?}");
                }
            }
        }
        assert!(backwards > 500, "it drives back where that turns it less: {backwards}");
    }

    #[test]
    fn what_is_straight_has_no_corner() {
        assert!(corners(&[1.0, 2.0, 0.5], &[1.0, 2.0, -2.0]).is_empty());
        assert!(corners(&[0.0, 0.0, 0.0], &[2.0, 0.0, 0.0]).is_empty());
        assert!(corners(&[2.0, 0.0, 0.0], &[0.0, 0.0, 0.0]).is_empty());
        assert_eq!(corners(&[0.0, 0.0, 0.0], &[0.0, 1.0, 0.0]).len(), 2);
    }
}
