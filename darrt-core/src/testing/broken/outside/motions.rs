//! Broken motions.

use std::fmt;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::SystemTime;

use super::super::bench::{Bench, Tag};
use super::super::motions::{Reel, instance, random_state};
use super::super::{Case, inputs};
use super::CASES;
use crate::laws::motion::{CONTINUOUS, FINITE, FRAME, KNOTS, MODE, MotionClaims, PURE, TRAVEL};
use crate::laws::watch::PANICS;
use crate::laws::{Broken, check_instance};
use crate::motion::Motion;
use crate::state::{ComponentSet, State};

/// What a motion does to the state that it starts from, at a parameter in `[0, 1]`.
type At = fn(f64, &mut State<Bench>);

/// From any state: a motion made of knots, a length and what it does to that state.
struct Film {
    from: State<Bench>,
    reel: Reel,
    knots: &'static [f64],
}

impl Motion<Bench> for Film {
    fn length(&self) -> f64 {
        self.reel.length_m
    }

    fn knots(&self) -> &[f64] {
        self.knots
    }

    fn at_into(&self, _: &Bench, t: f64, out: &mut State<Bench>) {
        out.clone_from(&self.from);
        (self.reel.at)(if t.is_nan() { t } else { t.clamp(0.0, 1.0) }, out);
    }
}

impl fmt::Debug for Film {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Film from {:?}", self.from)
    }
}

fn check_all(length_m: f64, knots: &'static [f64], at: At) -> Result<(), Broken> {
    for i in 0..CASES / 4 {
        let mut from = random_state(&mut inputs(i));
        from.robot = [0.5, 0.1];
        let film = Film { from: from.clone(), reel: Reel { length_m, at }, knots };
        let instance = instance(film, ComponentSet::ROBOT);
        check_instance(&Bench::default(), &instance, &from, &[0.25, 0.5, 0.75], &MotionClaims::default())?;
    }
    Ok(())
}

fn check(at: At) -> Result<(), Broken> {
    check_all(1.0, &[0.5], at)
}

/// One metre forward.
fn forward(t: f64, out: &mut State<Bench>) {
    out.robot[0] += t;
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(forward) }
}

pub(super) fn cases() -> Vec<Case> {
    [excursions(), others()].concat()
}

fn excursions() -> Vec<Case> {
    vec![
        case("excursion", "a metre away between 0.3 and 0.45, where nobody looks", TRAVEL, || {
            check(|t, out| out.robot[0] += t + if (0.3..0.45).contains(&t) { 1.0 } else { 0.0 })
        }),
        case("short excursion", "away for a two hundredth of the motion", TRAVEL, || {
            check(|t, out| out.robot[0] += t + if (0.612..0.617).contains(&t) { 1.0 } else { 0.0 })
        }),
        case("jump in the last thousandth", "the last step is made at once", TRAVEL, || {
            check(|t, out| out.robot[0] += if t > 0.9995 { t } else { 0.95 * t })
        }),
        case("jump in the last millionth", "the end is set, not reached", TRAVEL, || {
            check(|t, out| out.robot[0] += if t >= 1.0 { 1.0 } else { 0.999 * t })
        }),
        case("jump at a knot", "the second segment begins a centimetre before the end of the first", TRAVEL, || {
            check(|t, out| out.robot[0] += 0.9 * if t < 0.5 { t } else { t - 0.01 })
        }),
        case("long and jumpy", "a length without measure allows every jump", CONTINUOUS, || {
            check_all(1e14, &[], |t, out| out.robot[0] += t + if t > 0.37 { 0.5 } else { 0.0 })
        }),
        case("staircase", "goes in a thousand steps, as the drives are commanded", TRAVEL, || {
            check(|t, out| out.robot[0] += (t * 1000.0).floor() / 1000.0)
        }),
        case("wrong way round at the end", "the heading snaps to the target at the very end", TRAVEL, || {
            check(|t, out| {
                forward(t, out);
                out.robot[1] += if t >= 1.0 { 0.01 } else { 0.0 };
            })
        }),
    ]
}

fn others() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("no number on the way", "a direction of no length half-way", FINITE, || {
            check(|t, out| out.robot[0] += if (0.45..0.55).contains(&t) { f64::NAN } else { t })
        }),
        case("knots in disorder", "knots are listed segment by segment, the last segment first", KNOTS, || {
            check_all(1.0, &[0.6, 0.2, 0.8], forward)
        }),
        case("knots in metres", "knots are told in metres of travel", KNOTS, || {
            check_all(1.0, &[0.0, 0.7, 1.4], forward)
        }),
        case("knots of nothing", "0 / 0 for a segment without length", KNOTS, || {
            check_all(1.0, &[0.0, f64::NAN, 1.0], forward)
        }),
        case("grasps for a moment", "the mode is another one between 0.4 and 0.5", MODE, || {
            check(|t, out| {
                forward(t, out);
                out.mode = Tag::new(u32::from((0.4..0.5).contains(&t)));
            })
        }),
        case("nudges a bystander in passing", "a cart shifts between 0.6 and 0.65 and comes back", FRAME, || {
            check(|t, out| {
                forward(t, out);
                out.objects[1][1] += if (0.6..0.65).contains(&t) { 1e-9 } else { 0.0 };
            })
        }),
        case("vibrates", "a dither by the time of day", PURE, || {
            check(|t, out| {
                let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.subsec_nanos());
                out.robot[0] += t + if t > 0.0 && t < 1.0 { f64::from(now % 1000) * 1e-13 } else { 0.0 };
            })
        }),
        case("counts its frames", "every tenth question gets the state before", PURE, || {
            check(|t, out| {
                let is_late = CALLS.fetch_add(1, Ordering::Relaxed) % 10 == 9;
                out.robot[0] += if is_late && t > 0.0 && t < 1.0 { t - 1e-12 } else { t };
            })
        }),
        case("table look-up", "an index made of the parameter, also of NaN", PANICS, || {
            check(|t, out| {
                assert!((0.0..=1.0).contains(&t), "parameter out of range");
                forward(t, out);
            })
        }),
    ]
}
