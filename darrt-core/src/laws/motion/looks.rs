//! Looking along a motion: evenly, at random, on both sides of ends and knots, and closer where it moves fastest.

use rand::RngExt;

use super::{
    CLAMPED, CONTINUOUS, FINITE, KNOTS, LENGTH, MODE, MotionClaims, NAMED, PURE, START, TIGHT, TRAVEL, component_travel,
};
use crate::domain::Domain;
use crate::laws::feed::{is_number, rng_of};
use crate::laws::watch::entering;
use crate::laws::{Broken, alike, at_most, ensure, equal, measure};
use crate::motion::Motion;
use crate::space::ComponentSpace;
use crate::state::State;

/// How near to the ends and to the knots one looks.
const NEAR: [f64; 4] = [1e-9, 1e-6, 1e-4, 2e-3];
/// In how many of the fastest stretches jumps are looked for.
const STRETCHES: usize = 3;
/// A stretch as short as this holds no motion worth mentioning.
const INSTANT: f64 = 1e-12;
/// Farther than this nothing travels in an instant, metres.
const JUMP_M: f64 = 1e-6;
/// By what factor, and by how many metres besides, a length may exceed what is travelled.
const TOO_LONG: f64 = 100.0;
const ALLOWED_M: f64 = 10.0;
/// How far off the way between two knots the robot may be, of its length.
const STRAIGHT_SHARE: f64 = 1e-3;
/// Knots looked at, of those of a motion.
const KNOTS_SEEN: usize = 16;

/// Where a motion is looked at: ascending, in `[0, 1]`, the ends among them.
pub(super) fn all<D: Domain>(motion: &dyn Motion<D>, from: &State<D>, ts: &[f64], dense: u32) -> Vec<f64> {
    let mut rng = rng_of(&(from, ts));
    let mut all: Vec<f64> = ts.to_vec();
    all.extend((0..=dense.max(1)).map(|i| f64::from(i) / f64::from(dense.max(1))));
    all.extend((0..dense / 2).map(|_| rng.random_range(0.0..1.0)));
    all.extend(NEAR.iter().flat_map(|near| [*near, 1.0 - near]));
    for knot in motion.knots().iter().take(KNOTS_SEEN) {
        all.extend([knot - 1e-7, *knot, knot + 1e-7]);
    }
    all.retain(|t| (0.0..=1.0).contains(t));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// One motion under test.
pub(super) struct Trial<'a, 'c, D: Domain> {
    pub(super) m: &'a D,
    pub(super) motion: &'a dyn Motion<D>,
    pub(super) from: &'a State<D>,
    pub(super) claims: &'a MotionClaims<'c, D>,
}

impl<D: Domain> Trial<'_, '_, D> {
    fn at(&self, t: f64, garbage: &State<D>) -> State<D> {
        entering("at_into");
        let mut out = garbage.clone();
        self.motion.at_into(self.m, t, &mut out);
        out
    }

    pub(super) fn run(&self, ts: &[f64]) -> Result<(), Broken> {
        entering("length");
        measure(LENGTH, self.motion.length())?;
        self.knots()?;
        let (start, end) = (self.at(0.0, self.from), self.at(1.0, self.from));
        ensure(FINITE, is_number(&start), || format!("{start:?}"), "numbers").map_err(|broken| broken.at(0.0))?;
        equal(START, &start, self.from).map_err(|broken| broken.at(0.0))?;
        self.straight(&end)?;
        let looks = all(self.motion, self.from, ts, self.claims.looks);
        let states = self.along(&looks, &end)?;
        self.jumps(&looks, &states)?;
        self.tight(&states)?;
        self.again(&looks, &states, &start)?;
        equal(CLAMPED, &self.at(-1.0, &end), &start).map_err(|broken| broken.at(-1.0))?;
        equal(CLAMPED, &self.at(2.0, &start), &end).map_err(|broken| broken.at(2.0))?;
        // Whatever it makes of that, it comes back.
        let _ = self.at(f64::NAN, &start);
        Ok(())
    }

    fn knots(&self) -> Result<(), Broken> {
        let knots = self.motion.knots();
        let holds = knots.iter().all(|t| (0.0..=1.0).contains(t)) && knots.is_sorted();
        ensure(KNOTS, holds, || format!("{knots:?}"), "ascending, in [0, 1]")
    }

    /// Between two knots the robot is on the way that its space interpolates.
    fn straight(&self, end: &State<D>) -> Result<(), Broken> {
        let (robot, knots) = (self.m.robot(), self.motion.knots());
        for pair in knots.windows(2).take(KNOTS_SEEN) {
            let [since, until] = [pair[0], pair[1]];
            if until - since <= INSTANT {
                continue;
            }
            let [a, b] = [since, until].map(|t| self.at(t, end).robot);
            let whole = robot.distance(&a, &b);
            for share in [0.2, 0.5, 0.7] {
                let t = since + share * (until - since);
                let q = self.at(t, end).robot;
                let along = robot.interpolate(&a, &b, share);
                let off = robot.distance(&q, &along);
                let bound = self.claims.slack_m + STRAIGHT_SHARE * whole;
                at_most(KNOTS, off, bound, 0.0).map_err(|broken| broken.at(t).of("off the way between two knots"))?;
            }
        }
        Ok(())
    }

    /// From look to look.
    fn along(&self, looks: &[f64], end: &State<D>) -> Result<Vec<State<D>>, Broken> {
        let mut states: Vec<State<D>> = Vec::new();
        for (i, t) in looks.iter().enumerate() {
            let here = self.at(*t, self.from);
            let law = |law, holds, found: &dyn Fn() -> String, against| {
                ensure(law, holds, found, against).map_err(|broken: Broken| broken.at(*t))
            };
            law(FINITE, here == here.clone(), &|| format!("{here:?}"), "numbers")?;
            // Whatever was written before, and in whatever order it is asked.
            equal(PURE, &self.at(*t, end), &here).map_err(|broken| broken.at(*t))?;
            equal(NAMED, &here.objects.len(), &self.from.objects.len()).map_err(|broken| broken.at(*t))?;
            if let (Some(there), Some(t0)) = (states.last(), i.checked_sub(1).and_then(|before| looks.get(before))) {
                let bound = self.motion.length() * (t - t0);
                at_most(TRAVEL, (self.claims.travel)(self.m, there, &here), bound, self.claims.slack_m)
                    .map_err(|broken| broken.at(*t))?;
                if *t0 > 0.0 && *t < 1.0 {
                    equal(MODE, &here.mode, &there.mode).map_err(|broken| broken.at(*t))?;
                }
            }
            states.push(here);
        }
        Ok(states)
    }

    /// A bound that is far too large holds as well, and makes whoever relies on it look a thousand times as often.
    fn tight(&self, states: &[State<D>]) -> Result<(), Broken> {
        let metres: f64 = states.windows(2).map(|pair| (self.claims.travel)(self.m, &pair[0], &pair[1])).sum();
        let length = self.motion.length();
        let text = || format!("length {length:?} m, {metres:?} m travelled");
        ensure(
            TIGHT,
            length.is_nan() || length <= TOO_LONG * metres + ALLOWED_M,
            text,
            "at most a hundred times as long",
        )
    }

    /// Halves the fastest stretches again and again, always towards the faster half.
    fn jumps(&self, looks: &[f64], states: &[State<D>]) -> Result<(), Broken> {
        let speed = |i: usize| {
            let (Some([t0, t1]), Some([p, q])) = (looks.get(i..i + 2), states.get(i..i + 2)) else { return 0.0 };
            component_travel(self.m, p, q) / (t1 - t0)
        };
        let mut fastest: Vec<(usize, f64)> = (0..looks.len().saturating_sub(1)).map(|i| (i, speed(i))).collect();
        fastest.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (i, _) in fastest.into_iter().take(STRETCHES) {
            let (Some([t0, t1]), Some([p, q])) = (looks.get(i..i + 2), states.get(i..i + 2)) else { continue };
            self.closer((*t0, p.clone()), (*t1, q.clone()))?;
        }
        Ok(())
    }

    fn closer(&self, mut low: (f64, State<D>), mut high: (f64, State<D>)) -> Result<(), Broken> {
        while high.0 - low.0 > INSTANT {
            let t = 0.5 * (low.0 + high.0);
            if t <= low.0 || t >= high.0 {
                break;
            }
            let here = (t, self.at(t, self.from));
            let [first, second] = [(&low, &here), (&here, &high)].map(|(a, b)| component_travel(self.m, &a.1, &b.1));
            *(if first >= second { &mut high } else { &mut low }) = here;
        }
        let metres = component_travel(self.m, &low.1, &high.1);
        let bound = self.motion.length() * (high.0 - low.0);
        at_most(TRAVEL, metres, bound, self.claims.slack_m.max(JUMP_M)).map_err(|broken| broken.at(high.0))?;
        let text = || format!("{metres:?} m between {:?} and {:?}", low.0, high.0);
        ensure(CONTINUOUS, metres <= JUMP_M, text, "at most a micrometre").map_err(|broken| broken.at(high.0))
    }

    /// In another order, after all the other questions.
    fn again(&self, looks: &[f64], states: &[State<D>], start: &State<D>) -> Result<(), Broken> {
        let mut rng = rng_of(&(self.from, looks));
        for _ in 0..8 {
            let i = rng.random_range(0..looks.len().max(1));
            if let (Some(t), Some(state)) = (looks.get(i), states.get(i)) {
                alike(PURE, &self.at(*t, start), state).map_err(|broken| broken.at(*t))?;
            }
        }
        Ok(())
    }
}
