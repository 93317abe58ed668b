//! A space at its borders: what is no number, faces and corners, small differences.

use super::{
    DEAF, DIMENSION, NAN, NAN_FAR, PURE, RESOLVES, SpaceClaims, TOLERANCE_SMALL, index_coordinates, interpolation,
    metric, overlays,
};
use crate::laws::feed::{Spoilt, corner, count, face, is_number, rng_of, spoilt, values, with};
use crate::laws::watch::{drawing, entering};
use crate::laws::{Broken, alike, at_most, ensure};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;

/// A tolerance is at most this part of the way between samples that are far apart.
const TOLERANCE_SHARE: f64 = 4e-3;
/// Spaces smaller than this say nothing about their tolerance, metres.
const POINT_M: f64 = 1e-4;
/// Where along an interpolation small differences are looked at.
const SMALL: [f64; 4] = [1e-4, 1e-3, 1e-2, 0.1];

/// What is no number is not in the space, and near nothing.
pub(super) fn not_a_number<S: ComponentSpace>(space: &S, [a, b]: [&S::Config; 2]) -> Result<(), Broken> {
    for Spoilt { what, config: bad, .. } in spoilt(space, a, b) {
        let of = |broken: Broken| broken.of(&what);
        entering("contains");
        ensure(NAN, !space.contains(&bad), || format!("contains({bad:?})"), "not contained").map_err(of)?;
        let is_measured = space.dimension() > 0 && !is_fixed(space, a, &bad);
        if !is_measured || !values(space, &bad).iter().any(|x| x.is_nan()) && count(space, a) > 0 {
            continue;
        }
        for (p, q) in [(a, &bad), (&bad, a), (&bad, &bad)] {
            entering("distance");
            let metres = space.distance(p, q);
            // NaN itself is a good answer: no comparison with it is true.
            let is_near = metres <= space.tolerance();
            ensure(NAN_FAR, !is_near, || format!("{metres:?} m to {bad:?}"), "not within the tolerance").map_err(of)?;
        }
        // They only have to come back.
        entering("interpolate");
        let _ = space.interpolate(a, &bad, 0.5);
        entering("overlay");
        let _ = space.overlay(a, &bad, space.groups());
        entering("index_coordinates");
        space.index_coordinates(&bad, &mut |_, _| {});
    }
    entering("interpolate");
    for t in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.5, 1.5] {
        let _ = space.interpolate(a, b, t);
    }
    Ok(())
}

/// Do `q` and `bad` differ only in coordinates that can have no other value than that of `q`? Nobody need measure these.
fn is_fixed<S: ComponentSpace>(space: &S, q: &S::Config, bad: &S::Config) -> bool {
    let all = values(space, q).into_iter().zip(values(space, bad)).enumerate();
    let mut differing = all.filter(|(_, (x, y))| x != y).map(|(i, _)| i).peekable();
    let stays = |i: usize| [false, true].iter().all(|is_upper| face(space, q, i, *is_upper) == *q);
    differing.peek().is_some() && differing.all(stays)
}

/// The laws that hold anywhere hold in the corners as well.
pub(super) fn corners<S: ComponentSpace>(
    space: &S,
    claims: &SpaceClaims,
    [a, b, c]: [&S::Config; 3],
    seed: u64,
) -> Result<(), Broken> {
    let mut rng = rng_of(&(a, b, c, seed));
    let (x, y) = (corner(space, a, &mut rng), corner(space, b, &mut rng));
    let of = |broken: Broken| broken.of("in a corner");
    for [p, q, r] in [[&x, &y, c], [&x, b, &y], [&x, &x, b]] {
        metric(space, claims, [p, q, r]).map_err(of)?;
        interpolation(space, claims, [p, q], [0.3, 0.8]).map_err(of)?;
        overlays(space, [p, q, r]).map_err(of)?;
        index_coordinates(space, claims, [p, q]).map_err(of)?;
    }
    Ok(())
}

/// The distance tells apart what is not the same: it grows from the first step on, without plateau or threshold.
pub(super) fn resolution<S: ComponentSpace>(
    space: &S,
    claims: &SpaceClaims,
    [a, b]: [&S::Config; 2],
) -> Result<(), Broken> {
    let whole = space.distance(a, b);
    for t in SMALL.into_iter().chain([0.5, 0.9]) {
        let here = space.interpolate(a, b, t);
        let (found, left) = (space.distance(a, &here), space.distance(&here, b));
        if claims.even && claims.triangle {
            let slack = claims.slack_at(whole);
            let text = |metres: f64, share: f64| {
                Broken::new(RESOLVES, format!("{metres:?} m"), format!("{share:?} of {whole:?} m")).at(t).within(slack)
            };
            if found.is_nan() || found < t * whole - slack {
                return Err(text(found, t));
            }
            if left.is_nan() || left < (1.0 - t) * whole - slack {
                return Err(text(left, 1.0 - t).of("to the end"));
            }
        } else {
            let moves = here == *a || whole <= POINT_M || found > 0.0;
            ensure(RESOLVES, moves, || format!("0 m from {a:?} to {here:?}"), "a positive distance")
                .map_err(|broken| broken.at(t))?;
        }
    }
    Ok(())
}

/// Along every coordinate that can change by more than rounding, something is at a distance.
pub(super) fn hears<S: ComponentSpace>(space: &S, a: &S::Config) -> Result<(), Broken> {
    if space.dimension() == 0 {
        return Ok(());
    }
    for (i, x) in values(space, a).into_iter().enumerate().take(MOST_HEARD) {
        let [low, high] = [false, true].map(|is_upper| face(space, a, i, is_upper));
        let value = |q: &S::Config| values(space, q).get(i).copied().unwrap_or(x);
        // An angle may be the same at both ends, but not in between.
        let middle = with(space, a, i, 0.5 * (value(&low) + value(&high)));
        // Where the range has no end, a step says as much.
        let steps = STEPS_HEARD.map(|step| with(space, a, i, x + step));
        let others: Vec<S::Config> = [low, high, middle].into_iter().chain(steps).collect();
        let changes = others.iter().any(|q| (value(q) - x).abs() > HEARD && space.contains(q));
        let is_heard = others.iter().any(|q| space.contains(q) && space.distance(a, q) > 0.0);
        let text = || format!("0 m from {a:?} to each of {others:?}");
        ensure(DEAF, is_heard || !changes, text, "a positive distance to one of them")
            .map_err(|broken| broken.of(format_args!("coordinate {i}")))?;
    }
    Ok(())
}

/// Changes of a coordinate that must be heard are larger than this: a quaternion may be bent by less.
const HEARD: f64 = 0.02;
/// Steps along a coordinate that are listened to besides the ends of its range.
const STEPS_HEARD: [f64; 4] = [-3.0, -0.3, 0.3, 3.0];
/// So many coordinates are listened to.
const MOST_HEARD: usize = 24;

/// How far one goes towards samples, of the way there, to see in which direction that is; and by how much of its length a
/// direction must leave all others to count as another one.
const AHEAD: f64 = 1e-5;
const ASIDE: f64 = 0.05;

/// Many samples: how wide the space is, whether its dimension fits, and whether its tolerance is small.
pub(super) fn extent<S: ComponentSpace>(space: &S, a: &S::Config, seed: u64) -> Result<(), Broken> {
    let mut widest: f64 = 0.0;
    let mut differs = false;
    for i in 0..16 {
        let q = drawing("sample", stream(seed, 2, i, Purpose::Sample), |rng| space.sample(rng))?;
        differs |= q != *a && is_number(&q);
        widest = widest.max(space.distance(a, &q));
    }
    let text = || format!("dimension 0, but {}", if widest > 0.0 { "samples differ" } else { "not all equal" });
    ensure(DIMENSION, space.dimension() > 0 || !differs, text, "at least 1: samples differ")?;
    let count = count(space, a);
    let text = || format!("dimension {} of {count} numbers", space.dimension());
    ensure(DIMENSION, count == 0 || space.dimension() <= count, text, "at most as many as there are numbers")?;
    let free = directions(space, a, seed)?;
    let text = || format!("dimension {}, but it goes on in {free} directions", space.dimension());
    ensure(DIMENSION, space.dimension() >= free, text, "at least as many as there are directions")?;
    if widest > POINT_M {
        at_most(TOLERANCE_SMALL, space.tolerance(), TOLERANCE_SHARE * widest, 0.0)?;
    }
    Ok(())
}

/// How many of the ways to samples are independent where they begin.
fn directions<S: ComponentSpace>(space: &S, a: &S::Config, seed: u64) -> Result<usize, Broken> {
    let start = values(space, a);
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for i in 0..4 * start.len().min(MOST_HEARD) as u64 {
        let q = drawing("sample", stream(seed, 3, i, Purpose::Sample), |rng| space.sample(rng))?;
        let ahead = values(space, &space.interpolate(a, &q, AHEAD));
        let mut way: Vec<f64> = ahead.iter().zip(&start).map(|(x, y)| x - y).collect();
        let length = |way: &[f64]| way.iter().map(|x| x * x).sum::<f64>().sqrt();
        let whole = length(&way);
        // An angle may jump from one end of its range to the other.
        if whole.is_nan() || whole > 1e3 * AHEAD * (1.0 + length(&start)) || whole <= 0.0 {
            continue;
        }
        for x in &mut way {
            *x /= whole;
        }
        for known in &basis {
            let along: f64 = way.iter().zip(known).map(|(x, y)| x * y).sum();
            way.iter_mut().zip(known).for_each(|(x, y)| *x -= along * y);
        }
        let rest = length(&way);
        if rest > ASIDE {
            for x in &mut way {
                *x /= rest;
            }
            basis.push(way);
        }
    }
    Ok(basis.len())
}

/// Answers to a handful of questions, to be asked again later.
pub(super) fn answers<S: ComponentSpace>(
    space: &S,
    [a, b]: [&S::Config; 2],
    t: f64,
    seed: u64,
) -> Result<Vec<(&'static str, String)>, Broken> {
    let mut all = Vec::new();
    let mut say = |call: &'static str, answer: &dyn Fn() -> String| {
        entering(call);
        all.push((call, answer()));
    };
    let half = space.groups();
    say("dimension", &|| format!("{:?}", space.dimension()));
    say("tolerance", &|| format!("{:?}", space.tolerance()));
    say("groups", &|| format!("{half:?}"));
    say("contains", &|| format!("{:?}", space.contains(a)));
    say("distance", &|| format!("{:?}", space.distance(a, b)));
    say("interpolate", &|| format!("{:?}", space.interpolate(a, b, t)));
    say("interpolate half-way", &|| format!("{:?}", space.interpolate(b, a, 0.5)));
    say("overlay", &|| format!("{:?}", space.overlay(a, b, half)));
    say("index_coordinates", &|| {
        let mut marks = Vec::new();
        space.index_coordinates(a, &mut |group, x| marks.push((group, x)));
        format!("{marks:?}")
    });
    let sample = drawing("sample", stream(seed, 3, 0, Purpose::Sample), |rng| space.sample(rng))?;
    all.push(("sample", format!("{sample:?}")));
    Ok(all)
}

/// The same answers as before.
pub(super) fn unchanged(before: &[(&'static str, String)], now: &[(&'static str, String)]) -> Result<(), Broken> {
    for ((call, was), (_, is)) in before.iter().zip(now) {
        alike(PURE, is, was).map_err(|broken| broken.of(call))?;
    }
    Ok(())
}
