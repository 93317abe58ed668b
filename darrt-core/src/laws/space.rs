//! Laws of [`ComponentSpace`].

use std::fmt::Debug;

use crate::random::{Purpose, stream};
use crate::space::{ComponentSpace, GroupSet};

use super::watch::{drawing, entering, watched};
use super::{Broken, alike, at_most, ensure, equal, identical, measure};

mod coverage;
mod extremes;
mod places;

pub use coverage::check_space_covers;

/// The configurations handed to a check must lie in the space.
pub const GIVEN: &str = "space.given: the configurations given to the check lie in the space";
/// Metric: finite, not negative.
pub const FINITE: &str = "space.finite: distance is finite and not negative";
/// Metric: zero to itself.
pub const SELF: &str = "space.self: distance(a, a) is 0";
/// Metric: symmetric.
pub const SYMMETRIC: &str = "space.symmetric: distance(a, b) is distance(b, a)";
/// Metric: triangle inequality.
pub const TRIANGLE: &str = "space.triangle: distance(a, c) is at most distance(a, b) + distance(b, c)";
/// Metric: not zero everywhere.
pub const SEPARATES: &str = "space.separates: samples of a space with degrees of freedom are not all at distance 0";
/// The tolerance is a positive number.
pub const TOLERANCE: &str = "space.tolerance: tolerance is finite and positive";
/// Interpolation: ends.
pub const ENDS: &str = "space.ends: interpolate(a, b, 0) is a and interpolate(a, b, 1) is b, bit for bit";
/// Interpolation: inside.
pub const INSIDE: &str = "space.inside: interpolation between two configurations of the space stays in it";
/// Interpolation: rest.
pub const REST: &str = "space.rest: interpolation between equal configurations stays there";
/// Interpolation: monotone.
pub const MONOTONE: &str = "space.monotone: the distance of the interpolation from its beginning never shrinks";
/// Interpolation: even speed.
pub const EVEN: &str = "space.even: between t1 and t2 the interpolation travels at most |t2 - t1| of the distance";
/// Sampling: inside.
pub const SAMPLE_INSIDE: &str = "space.sample-inside: samples lie in the space";
/// Sampling: seeded.
pub const SAMPLE_SEEDED: &str = "space.sample-seeded: the same generator gives the same sample";
/// Sampling: covering.
pub const SAMPLE_COVERS: &str = "space.sample-covers: samples come near every configuration of the space";
/// Index coordinates: a lower bound.
pub const COORDINATES: &str = "space.index-coordinates: over the coordinates of any groups, those of two configurations lie no farther apart than the overlay of these groups";
/// Index coordinates: alike.
pub const COORDINATES_ALIKE: &str = "space.index-coordinates-alike: those of every configuration have the same groups in the same order, groups of the space";
/// Overlay: all and none.
pub const OVERLAY_ENDS: &str = "space.overlay-ends: overlay of all groups is the target, of no group the beginning";
/// Overlay: groups are independent.
pub const OVERLAY_GROUPS: &str = "space.overlay-groups: overlaying group after group is overlaying them at once, in any order, and each can be undone alone";
/// Overlay: inside.
pub const OVERLAY_INSIDE: &str = "space.overlay-inside: an overlay of two configurations of the space lies in it";

/// What is no number.
pub const NAN: &str = "space.nan: nothing that is NaN or infinite lies in the space";
/// What is no number is near nothing.
pub const NAN_FAR: &str = "space.nan-far: nothing that is NaN is within tolerance of anything";
/// Pure.
pub const PURE: &str = "space.pure: the same question has the same answer, bit for bit, whenever it is asked";
/// Degrees of freedom.
pub const DIMENSION: &str =
    "space.dimension: a space whose samples differ has a degree of freedom, and at most as many as it has numbers";
/// The tolerance is small.
pub const TOLERANCE_SMALL: &str =
    "space.tolerance-small: the tolerance is at most four thousandths of the way between samples";
/// Small differences count.
pub const RESOLVES: &str = "space.resolves: the distance grows from the first step on: no threshold, steps or plateau";
/// Every coordinate counts.
pub const DEAF: &str = "space.deaf: two configurations that differ in one coordinate only are not at distance 0";
/// Special places: inside.
pub const PLACE_INSIDE: &str = "space.place-inside: what sample_at draws lies in the space";
/// Special places: seeded.
pub const PLACE_SEEDED: &str = "space.place-seeded: the same generator gives the same sample at a place";
/// Samples at places differ.
pub const PLACE_VARIED: &str = "space.place-varied: sample_at does not always draw the same where the space can move";
/// Sampling: the whole range.
pub const SAMPLE_FILLS: &str =
    "space.sample-fills: samples fill the range that contains accepts, along every coordinate";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    GIVEN,
    NAN,
    NAN_FAR,
    PURE,
    DIMENSION,
    TOLERANCE_SMALL,
    RESOLVES,
    DEAF,
    PLACE_INSIDE,
    PLACE_SEEDED,
    PLACE_VARIED,
    SAMPLE_FILLS,
    FINITE,
    SELF,
    SYMMETRIC,
    TRIANGLE,
    SEPARATES,
    TOLERANCE,
    ENDS,
    INSIDE,
    REST,
    MONOTONE,
    EVEN,
    SAMPLE_INSIDE,
    SAMPLE_SEEDED,
    SAMPLE_COVERS,
    COORDINATES,
    COORDINATES_ALIKE,
    OVERLAY_ENDS,
    OVERLAY_GROUPS,
    OVERLAY_INSIDE,
];

/// What a space claims beyond the laws that bind every space, and how exact its arithmetic is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceClaims {
    /// Its distance keeps the triangle inequality.
    pub triangle: bool,
    /// Its interpolation is the shortest way at even speed, as motions along it need.
    pub even: bool,
    /// Every coordinate counts in its distance: not so if turns about an axis of symmetry are free.
    pub hears_all: bool,
    /// Rounding that is forgiven, metres per metre (and metres near zero).
    pub slack: f64,
}

impl Default for SpaceClaims {
    fn default() -> Self {
        Self { triangle: true, even: true, hears_all: true, slack: 1e-7 }
    }
}

impl SpaceClaims {
    fn slack_at(&self, metres: f64) -> f64 {
        self.slack * (1.0 + metres.abs())
    }
}

/// All laws of a space, for three configurations, two parameters in `[0, 1]` and a seed.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_component_space<S: ComponentSpace>(
    space: &S,
    claims: &SpaceClaims,
    configs: [&S::Config; 3],
    ts: [f64; 2],
    seed: u64,
) -> Result<(), Broken> {
    let [a, b, c] = configs;
    let about = || format!("check_component_space({claims:?}, [&{a:?}, &{b:?}, &{c:?}], {ts:?}, {seed})");
    let check = || {
        for q in configs {
            entering("contains");
            ensure(GIVEN, space.contains(q), || format!("{q:?}"), "a configuration of the space")?;
        }
        let before = extremes::answers(space, [a, b], ts[0], seed)?;
        metric(space, claims, configs)?;
        interpolation(space, claims, [a, b], ts)?;
        samples(space, seed)?;
        overlays(space, [a, b, c])?;
        index_coordinates(space, claims, [a, b])?;
        extremes::resolution(space, claims, [a, b])?;
        if claims.hears_all {
            extremes::hears(space, a)?;
        }
        extremes::extent(space, a, seed)?;
        places::places(space, seed)?;
        extremes::not_a_number(space, [a, b])?;
        extremes::corners(space, claims, configs, seed)?;
        extremes::unchanged(&before, &extremes::answers(space, [a, b], ts[0], seed)?)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

fn coordinates_of<S: ComponentSpace>(space: &S, q: &S::Config) -> Vec<(u32, f64)> {
    let mut all = Vec::new();
    space.index_coordinates(q, &mut |group, x| all.push((group, x)));
    all
}

fn index_coordinates<S: ComponentSpace>(
    space: &S,
    claims: &SpaceClaims,
    [a, b]: [&S::Config; 2],
) -> Result<(), Broken> {
    let (of_a, of_b) = (coordinates_of(space, a), coordinates_of(space, b));
    let groups = |all: &[(u32, f64)]| all.iter().map(|(group, _)| *group).collect::<Vec<_>>();
    equal(COORDINATES_ALIKE, &groups(&of_a), &groups(&of_b))?;
    let stray = of_a.iter().find(|(group, _)| !space.groups().contains(*group));
    let text = || format!("a coordinate of {stray:?}, the space has {:?}", space.groups());
    ensure(COORDINATES_ALIKE, stray.is_none(), text, "one of its groups")?;
    let single = (0..32).map(GroupSet::only).filter(|group| space.groups().covers(*group));
    for named in single.chain([space.groups()]) {
        let pairs = of_a.iter().zip(&of_b).filter(|((group, _), _)| named.contains(*group));
        let apart = pairs.map(|((_, x), (_, y))| (x - y).powi(2)).sum::<f64>().sqrt();
        let metres = space.distance(a, &space.overlay(a, b, named));
        at_most(COORDINATES, apart, metres, claims.slack_at(metres) * 1e-3)?;
    }
    Ok(())
}

fn metric<S: ComponentSpace>(space: &S, claims: &SpaceClaims, [a, b, c]: [&S::Config; 3]) -> Result<(), Broken> {
    let tolerance = space.tolerance();
    ensure(TOLERANCE, tolerance.is_finite() && tolerance > 0.0, || format!("{tolerance:?}"), "finite and positive")?;
    entering("distance");
    let d = |p, q| {
        let metres = space.distance(p, q);
        measure(FINITE, metres).map(|()| metres)
    };
    for q in [a, b, c] {
        let metres = d(q, q)?;
        ensure(SELF, metres == 0.0, || format!("{metres:?} for {q:?}"), "0.0")?;
    }
    let (ab, ba) = (d(a, b)?, d(b, a)?);
    at_most(SYMMETRIC, (ab - ba).abs(), 0.0, claims.slack_at(ab) * 1e-3).map_err(|broken| Broken {
        left: format!("{ab:?}").into(),
        right: format!("{ba:?}").into(),
        ..broken
    })?;
    if claims.triangle {
        let (ac, bc) = (d(a, c)?, d(b, c)?);
        at_most(TRIANGLE, ac, ab + bc, claims.slack_at(ab + bc))?;
    }
    Ok(())
}

fn interpolation<S: ComponentSpace>(
    space: &S,
    claims: &SpaceClaims,
    [a, b]: [&S::Config; 2],
    ts: [f64; 2],
) -> Result<(), Broken> {
    entering("interpolate");
    identical(ENDS, &space.interpolate(a, b, 0.0), a).map_err(|broken| broken.at(0.0))?;
    identical(ENDS, &space.interpolate(a, b, 1.0), b).map_err(|broken| broken.at(1.0))?;
    let length = space.distance(a, b);
    let slack = claims.slack_at(length);
    let [early, late] = [ts[0].min(ts[1]), ts[0].max(ts[1])];
    let mut before: Option<(f64, S::Config, f64)> = None;
    let mut looks = [0.0, NEAR_END, 1e2 * NEAR_END, early, late, 1.0 - 1e2 * NEAR_END, 1.0 - NEAR_END, 1.0];
    looks.sort_by(f64::total_cmp);
    for t in looks {
        let here = space.interpolate(a, b, t);
        ensure(INSIDE, space.contains(&here), || format!("{here:?}"), "a configuration of the space")
            .map_err(|broken| broken.at(t))?;
        let from_a = space.distance(a, &here);
        if let Some((t0, there, its)) = &before {
            at_most(MONOTONE, *its, from_a, slack).map_err(|broken| broken.at(t))?;
            if claims.even {
                at_most(EVEN, space.distance(there, &here), length * (t - t0), slack).map_err(|broken| broken.at(t))?;
            }
        }
        before = Some((t, here, from_a));
        let still = space.interpolate(a, a, t);
        at_most(REST, space.distance(a, &still), space.tolerance(), slack).map_err(|broken| broken.at(t))?;
    }
    Ok(())
}

/// How near to its ends an interpolation is looked at.
const NEAR_END: f64 = 1e-5;

/// How many samples each check draws: a fault in one of a thousand is then seen in the cases of one test.
const SAMPLES: u64 = 64;

fn samples<S: ComponentSpace>(space: &S, seed: u64) -> Result<(), Broken> {
    let draw = |i| drawing("sample", stream(seed, 0, i, Purpose::Sample), |rng| space.sample(rng));
    let first = draw(0)?;
    let mut widest: f64 = 0.0;
    for i in 0..SAMPLES {
        let q = draw(i)?;
        ensure(SAMPLE_INSIDE, space.contains(&q), || format!("{q:?}"), "a configuration of the space")?;
        widest = widest.max(space.distance(&first, &q));
    }
    alike(SAMPLE_SEEDED, &draw(0)?, &first)?;
    let separates = space.dimension() == 0 || widest > 0.0;
    ensure(SEPARATES, separates, || format!("{SAMPLES} samples, all at distance 0"), "a positive distance")
}

/// The groups that `space` has, one by one.
pub(super) fn groups_of<S: ComponentSpace>(space: &S) -> impl Iterator<Item = GroupSet> {
    let groups = space.groups();
    (0..32).filter(move |i| groups.contains(*i)).map(GroupSet::only)
}

fn overlays<S: ComponentSpace>(space: &S, [a, b, c]: [&S::Config; 3]) -> Result<(), Broken> {
    entering("overlay");
    identical(OVERLAY_ENDS, &space.overlay(a, b, space.groups()), b)?;
    if !space.groups().is_empty() {
        identical(OVERLAY_ENDS, &space.overlay(a, b, GroupSet::NONE), a)?;
    }
    let mut step_by_step = a.clone();
    let mut so_far = GroupSet::NONE;
    for group in groups_of(space) {
        let one = space.overlay(a, b, group);
        ensure(OVERLAY_INSIDE, space.contains(&one), || format!("{one:?}"), "a configuration of the space")?;
        identical(OVERLAY_GROUPS, &space.overlay(&one, a, group), a)?;
        // What c had there before does not matter once b is laid over it.
        let covered = space.overlay(&space.overlay(a, c, group), b, group);
        identical(OVERLAY_GROUPS, &covered, &one)?;
        // What one group takes over is none of another's: the order makes no difference.
        for other in groups_of(space).filter(|other| *other != group) {
            let other_first = space.overlay(&space.overlay(a, c, other), b, group);
            identical(OVERLAY_GROUPS, &space.overlay(&one, c, other), &other_first)?;
        }
        so_far = so_far.union(group);
        step_by_step = space.overlay(&step_by_step, b, group);
        identical(OVERLAY_GROUPS, &step_by_step, &space.overlay(a, b, so_far))?;
    }
    Ok(())
}

/// At least one of `draws` samples comes nearer than `within_m` to `target`: a sampler that leaves out a
/// part of the space is found by targets there.
///
/// # Errors
/// [`SAMPLE_COVERS`] with the least distance found.
pub fn check_covering<S: ComponentSpace>(
    space: &S,
    target: &S::Config,
    within_m: f64,
    draws: u64,
    seed: u64,
) -> Result<(), Broken> {
    let about = || replay_covering(target, within_m, draws, seed);
    let check = || {
        let mut least = f64::INFINITY;
        for i in 0..draws {
            let q = drawing("sample", stream(seed, 0, i, Purpose::Sample), |rng| space.sample(rng))?;
            least = least.min(space.distance(&q, target));
        }
        at_most(SAMPLE_COVERS, least, within_m, 0.0)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// Answers of a space to a handful of questions, printed: what [`PURE`] holds over the time of a whole check.
pub(super) fn answers_of<S: ComponentSpace>(space: &S, configs: [&S::Config; 2]) -> Result<Vec<String>, Broken> {
    let all = extremes::answers(space, configs, 0.3, 0)?;
    Ok(all.into_iter().map(|(call, answer)| format!("{call}: {answer}")).collect())
}

fn replay_covering(target: &impl Debug, within_m: f64, draws: u64, seed: u64) -> String {
    format!("check_covering(&{target:?}, {within_m:?}, {draws}, {seed})")
}
