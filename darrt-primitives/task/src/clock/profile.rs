//! One number that goes from one speed to another in bounded speed, acceleration and jerk: the double-S profile.
//!
//! Formulas: L. Biagiotti, C. Melchiorri, *Trajectory Planning for Automatic Machines and Robots*, section 3.4. Acceleration is
//! zero at both ends. Where the peak speed is not the bound it is found by bisection, so that the length is met to rounding.

use super::limits::Bounds;

/// `[seconds, jerk]` of the pieces of a profile.
pub(crate) type Pieces = Vec<[f64; 2]>;

/// Seconds and length of a change of speed from `a` to `b`, both at least 0.
fn change(a: f64, b: f64, bounds: &Bounds) -> (f64, f64) {
    let by = (b - a).abs();
    let (most, jerk) = (bounds.acceleration, bounds.jerk);
    let seconds = if by >= most * most / jerk { by / most + most / jerk } else { 2.0 * (by / jerk).sqrt() };
    // Symmetric about its middle, so the mean speed is that of the ends.
    (seconds, seconds * (a + b) / 2.0)
}

/// The highest speed that can be reached from `from` within `length`, at most `bounds.velocity`.
pub(crate) fn reachable(from: f64, length: f64, bounds: &Bounds) -> f64 {
    let top = bounds.velocity.max(from);
    bisect(from, top, |speed| change(from, speed, bounds).1 <= length)
}

/// The largest number in `[low, high]` for which `is_fit` holds, which holds up to some number; `low` if none does.
fn bisect(mut low: f64, mut high: f64, is_fit: impl Fn(f64) -> bool) -> f64 {
    if is_fit(high) {
        return high;
    }
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        if is_fit(middle) { low = middle } else { high = middle }
    }
    low
}

/// The fastest profile of this length, > 0, from speed `from` to speed `to`, neither above the bound: its pieces.
///
/// A change of speed that the length is too short for makes it longer than that; see [`reachable`].
pub(crate) fn between(from: f64, to: f64, length: f64, bounds: &Bounds) -> Pieces {
    let least = from.max(to);
    let ends = |peak: f64| change(from, peak, bounds).1 + change(peak, to, bounds).1;
    let peak = bisect(least, bounds.velocity.max(least), |peak| ends(peak) <= length);
    let mut pieces = Pieces::new();
    ramp(from, peak, bounds, &mut pieces);
    let rest = length - ends(peak);
    if rest > 0.0 && peak > 0.0 {
        pieces.push([rest / peak, 0.0]);
    }
    ramp(peak, to, bounds, &mut pieces);
    pieces
}

/// Seconds of [`between`].
pub(crate) fn seconds(from: f64, to: f64, length: f64, bounds: &Bounds) -> f64 {
    between(from, to, length, bounds).iter().map(|[seconds, _]| seconds).sum()
}

fn ramp(from: f64, to: f64, bounds: &Bounds, pieces: &mut Pieces) {
    let by = (to - from).abs();
    if by <= 0.0 {
        return;
    }
    let (most, sign) = (bounds.acceleration, (to - from).signum());
    let (total, _) = change(from, to, bounds);
    let rise = if by >= most * most / bounds.jerk { most / bounds.jerk } else { total / 2.0 };
    // The jerk that meets the change of speed exactly; rounding apart it is the bound.
    let jerk = sign * by / (rise * (total - rise));
    pieces.push([rise, jerk]);
    if total - 2.0 * rise > 0.0 {
        pieces.push([total - 2.0 * rise, 0.0]);
    }
    pieces.push([rise, -jerk]);
}

/// Length gone, speed and acceleration at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Progress {
    /// The length gone.
    pub(crate) length: f64,
    /// Its speed.
    pub(crate) speed: f64,
    /// Its acceleration.
    pub(crate) acceleration: f64,
}

impl Progress {
    /// The same `t` seconds later at this jerk.
    #[must_use]
    pub(crate) fn after(self, t: f64, jerk: f64) -> Self {
        let Self { length, speed, acceleration } = self;
        Self {
            length: length + t * (speed + t * (acceleration / 2.0 + t * jerk / 6.0)),
            speed: speed + t * (acceleration + t * jerk / 2.0),
            acceleration: acceleration + t * jerk,
        }
    }
}

/// Where a profile from rest is after `t` seconds; from its end on where it ends, at rest.
pub(crate) fn progress(profile: &[[f64; 2]], t: f64) -> Progress {
    let mut here = Progress::default();
    let mut left = t.max(0.0);
    for &[seconds, jerk] in profile {
        if left < seconds {
            return here.after(left, jerk);
        }
        here = here.after(seconds, jerk);
        left -= seconds;
    }
    Progress { speed: 0.0, acceleration: 0.0, ..here }
}

/// When a profile from rest has gone this length, seconds; when it ends for more than it goes.
pub(crate) fn time_of(profile: &[[f64; 2]], length: f64) -> f64 {
    let mut here = Progress::default();
    let mut begin = 0.0;
    for &[seconds, jerk] in profile {
        if here.after(seconds, jerk).length >= length {
            // The first time: lengths never shrink.
            return begin + seconds - bisect(0.0, seconds, |left| here.after(seconds - left, jerk).length >= length);
        }
        here = here.after(seconds, jerk);
        begin += seconds;
    }
    begin
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};

    fn random(rng: &mut impl rand::Rng) -> (f64, f64, f64, Bounds) {
        let mut number = |low: f64, high: f64| 10_f64.powf(rng.random_range(low..high));
        let bounds = Bounds::new(number(-2.0, 1.0), number(-2.0, 2.0), number(-1.0, 3.0));
        let length = number(-4.0, 2.0);
        let from = bounds.velocity * rng.random_range(0.0..1.0);
        let reach = reachable(from, length, &bounds);
        // Slowing down is speeding up backwards.
        (from, from + (reach - from) * rng.random_range(0.0..1.0), length, bounds)
    }

    #[test]
    fn ends_length_and_bounds_are_met() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
        for case in 0..5000 {
            let (from, to, length, bounds) = random(&mut rng);
            let (from, to) = if case % 2 == 0 { (from, to) } else { (to, from) };
            let mut here = Progress { speed: from, ..Progress::default() };
            for [seconds, jerk] in between(from, to, length, &bounds) {
                assert!(seconds >= 0.0 && jerk.abs() <= bounds.jerk * (1.0 + 1e-6), "{jerk} {bounds:?}");
                for part in [0.25, 0.5, 0.75, 1.0] {
                    let at = here.after(part * seconds, jerk);
                    assert!(at.acceleration.abs() <= bounds.acceleration * (1.0 + 1e-6), "{at:?} {bounds:?}");
                    assert!(at.speed <= bounds.velocity * (1.0 + 1e-9) && at.speed >= -1e-9, "{at:?} {bounds:?}");
                }
                here = here.after(seconds, jerk);
            }
            assert!((here.length - length).abs() <= 1e-9 * (1.0 + length), "{case}: {here:?} {length}");
            assert!((here.speed - to).abs() < 1e-9 * (1.0 + to), "{here:?} {to}");
            assert!(here.acceleration.abs() < 1e-6 * bounds.acceleration, "{here:?}");
        }
    }

    #[test]
    fn known_cases() {
        // Speed 1, acceleration 1, jerk 1, length 4: 2 s up, 2 s at full speed, 2 s down.
        let unit = Bounds::new(1.0, 1.0, 1.0);
        assert!((seconds(0.0, 0.0, 4.0, &unit) - 6.0).abs() < 1e-12);
        // Only jerk counts: the length is j t^3 / 32.
        let jerk = Bounds::new(1e6, 1e6, 32.0);
        assert!((seconds(0.0, 0.0, 8.0, &jerk) - 2.0).abs() < 1e-9);
        // Nearly no jerk limit: the trapezoid.
        let sharp = Bounds::new(0.5, 2.0, 1e9);
        assert!((seconds(0.0, 0.0, 1.0, &sharp) - 2.25).abs() < 1e-6);
        assert!((reachable(0.0, 1.0, &Bounds::new(10.0, 2.0, 1e9)) - 2.0).abs() < 1e-6);
    }

    #[test]
    fn times_and_lengths_are_inverse() {
        let profile = between(0.0, 0.0, 3.0, &Bounds::new(1.0, 2.0, 5.0));
        for i in 0..=30 {
            let length = f64::from(i) * 0.1;
            assert!((progress(&profile, time_of(&profile, length)).length - length).abs() < 1e-9, "{length}");
        }
        assert_eq!(time_of(&profile, 4.0), profile.iter().map(|[seconds, _]| seconds).sum::<f64>());
    }

    #[test]
    fn progress_ends_at_rest_at_the_end() {
        let bounds = Bounds::new(1.0, 2.0, 5.0);
        let profile = between(0.0, 0.0, 3.0, &bounds);
        let end = progress(&profile, 1e9);
        assert!((end.length - 3.0).abs() < 1e-9 && end.speed == 0.0 && end.acceleration == 0.0);
        assert_eq!(progress(&profile, -1.0), Progress::default());
        let mut last = 0.0;
        for i in 0..1000 {
            let at = progress(&profile, f64::from(i) * 0.005);
            assert!(at.length >= last - 1e-12);
            last = at.length;
        }
    }
}
