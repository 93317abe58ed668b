//! Laws of [`Sampler`].

use crate::domain::Domain;
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::random::{Purpose, stream};
use crate::sample::Sampler;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId};

mod learns;

pub use learns::check_sampler_learns;

use super::feed::values;
use super::watch::{drawing, watched};
use super::{Broken, alike, ensure};

/// Inside.
pub const INSIDE: &str =
    "sampler.inside: every named component of a sample lies in its space, and the groups are those of the robot";
/// Names something.
pub const NAMES: &str =
    "sampler.names: a sample names at least one component; towards anywhere nothing can be extended";
/// Seeded.
pub const SEEDED: &str = "sampler.seeded: the same generator gives the same sample";
/// Covers.
pub const COVERS: &str = "sampler.covers: every component that can move is named by some samples";

/// Covers the room.
pub const FILLS: &str =
    "sampler.fills: samples of a component come into every twelfth of where its space draws it, along every coordinate";

/// Learning.
pub const LEARNS: &str =
    "sampler.learns: what learns for one attempt keeps the laws whatever it has learnt, and no other learns from it";

/// The laws of this file.
pub const LAWS: &[&str] = &[INSIDE, NAMES, SEEDED, COVERS, FILLS, LEARNS];

/// How many samples each check draws: a fault in one of a thousand is then seen in the cases of one test.
const DRAWS: u64 = 16;
/// So many samples that name a component say whether they fill its space. That a twelfth stays empty by chance happens once in
/// 10^10 times; if half of them come from a goal, once in 10^5.
const ENOUGH: usize = 300;
/// So few samples can still not all be at the same place.
const FEW: usize = 40;
/// So many samples are drawn at least to see whether they fill the space.
const FILLING: u64 = 1024;
/// And so many at most, if a component is named rarely.
const MOST_FILLING: u64 = 4096;
/// Into how many parts of equal probability the space is cut along each coordinate.
const PARTS: usize = 12;
/// How many samples of the space itself say where they are.
const REFERENCE: u64 = 480;

/// All laws of a sampler, for one seed.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_sampler<D: Domain>(m: &D, sampler: &dyn Sampler<D>, goal: &dyn Goal<D>, seed: u64) -> Result<(), Broken> {
    let about = || format!("check_sampler({seed})");
    let draw = |i| {
        let rng = stream(seed, 0, i, Purpose::Sample);
        drawing("sample of the sampler", rng, |rng| sampler.sample(m, goal, rng))
    };
    let check = || {
        let first = draw(0)?;
        for i in 0..DRAWS {
            let sample = draw(i)?;
            ensure(NAMES, !sample.components().is_empty(), || format!("{sample:?}"), "a target that names something")?;
            inside(m, &sample, seed)?;
        }
        // A goal that cannot be sampled.
        let nowhere = crate::goal::AnyOf::new(Vec::new());
        for i in 0..DRAWS {
            let rng = stream(seed, 1, i, Purpose::Sample);
            let sample = drawing("sample of the sampler", rng, |rng| sampler.sample(m, &nowhere, rng))?;
            inside(m, &sample, seed).map_err(|broken| broken.of("for a goal without samples"))?;
        }
        alike(SEEDED, &draw(0)?, &first)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

fn inside<D: Domain>(m: &D, sample: &PartialState<D>, seed: u64) -> Result<(), Broken> {
    sample.check(m).map_err(|error| Broken::new(INSIDE, error.to_string(), "a target of the domain"))?;
    if let Some(robot) = sample.robot() {
        let text = || format!("{:?}", robot.groups);
        ensure(INSIDE, m.robot().groups().covers(robot.groups), text, "groups of the robot")?;
    }
    // Named groups alone need a configuration around them.
    let around = m.robot().sample(&mut stream(seed, 1, 0, Purpose::Sample));
    let robot = sample.robot_overlay(m, &around);
    ensure(INSIDE, m.robot().contains(&robot), || format!("{robot:?}"), "a configuration of the robot's space")
        .map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))
}

/// In `draws` samples every component that can move is named at least once; and in 1024 or more, those of components named often
/// enough fill where the component's own space draws it.
///
/// # Errors
/// [`COVERS`] with the component that is never named, [`FILLS`] with the part of its space that is left out.
pub fn check_sampler_covers<D: Domain>(
    m: &D,
    sampler: &dyn Sampler<D>,
    goal: &dyn Goal<D>,
    draws: u64,
    seed: u64,
) -> Result<(), Broken> {
    let about = || format!("check_sampler_covers({draws}, {seed})");
    let check = || {
        let mut samples = Vec::new();
        for i in 0..draws.max(FILLING) {
            let rng = stream(seed, 0, i, Purpose::Sample);
            samples.push(drawing("sample of the sampler", rng, |rng| sampler.sample(m, goal, rng))?);
        }
        // Of what is named rarely, more.
        let is_rare = |samples: &[PartialState<D>], id| {
            let named = samples.iter().filter(|sample| sample.object(id).is_some()).count();
            (1..ENOUGH).contains(&named)
        };
        let ids: Vec<_> = (0..m.objects().len()).map(ObjectId::new).collect();
        let mut i = draws.max(FILLING);
        while i < MOST_FILLING && ids.iter().any(|id| is_rare(&samples, *id)) {
            for _ in 0..FILLING {
                let rng = stream(seed, 0, i, Purpose::Sample);
                samples.push(drawing("sample of the sampler", rng, |rng| sampler.sample(m, goal, rng))?);
                i += 1;
            }
        }
        let count = usize::try_from(draws).unwrap_or(usize::MAX);
        let named = samples.iter().take(count).fold(ComponentSet::EMPTY, |set, sample| set.union(sample.components()));
        let objects = m.objects().iter().enumerate().filter(|(_, space)| space.dimension() > 0);
        let robot = (m.robot().dimension() > 0).then_some(ComponentId::Robot);
        for component in robot.into_iter().chain(objects.map(|(i, _)| ComponentId::Object(ObjectId::new(i)))) {
            let of = |broken: Broken| broken.of(m.component_name(component));
            let text = || format!("not named in {draws} samples");
            ensure(COVERS, named.contains(component), text, "named by some").map_err(of)?;
            match component {
                ComponentId::Robot => {
                    let all = m.robot().groups();
                    let whole = samples.iter().filter_map(|sample| sample.robot()).filter(|r| r.groups == all);
                    fills(m.robot(), whole.map(|robot| &robot.config), seed).map_err(of)?;
                }
                ComponentId::Object(id) => {
                    let Some(space) = m.objects().get(id.index()) else { continue };
                    fills(space, samples.iter().filter_map(|sample| sample.object(id)), seed).map_err(of)?;
                }
            }
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// Every twelfth of the space's own samples, along every coordinate, and by the distance from two of them, has some of `found`.
fn fills<'a, S: ComponentSpace>(
    space: &S,
    found: impl Iterator<Item = &'a S::Config>,
    seed: u64,
) -> Result<(), Broken> {
    let found: Vec<_> = found.collect();
    if found.len() < ENOUGH {
        let is_one_place = found.len() >= FEW && found.iter().all(|q| Some(q) == found.first());
        let text = || format!("{} samples at the same place", found.len());
        return ensure(FILLS, !is_one_place, text, "at different ones: it can move");
    }
    let mut own = Vec::new();
    for i in 0..REFERENCE {
        own.push(drawing("sample", stream(seed, 2, i, Purpose::Sample), |rng| space.sample(rng))?);
    }
    let count = own.first().map_or(0, |q| values(space, q).len());
    let by_value = |i: usize, q: &S::Config| values(space, q).get(i).copied().unwrap_or(0.0);
    let by_distance = |i: usize, q: &S::Config| own.get(i).map_or(0.0, |probe| space.distance(probe, q));
    for i in 0..count + 2 {
        let measure = |q: &S::Config| if i < count { by_value(i, q) } else { by_distance(i - count, q) };
        let mut reference: Vec<f64> = own.iter().map(measure).collect();
        reference.sort_by(f64::total_cmp);
        let part = |k: usize| reference.get(k * (reference.len() - 1) / PARTS).copied().unwrap_or(0.0);
        for k in 0..PARTS {
            let (low, high) = (part(k), part(k + 1));
            if high <= low {
                continue;
            }
            let is_hit = found.iter().any(|q| (low..=high).contains(&measure(q)));
            let what = if i < count { format!("coordinate {i}") } else { "distance from a sample".to_owned() };
            let text = || format!("none of {} samples has its {what} in [{low:?}, {high:?}]", found.len());
            ensure(FILLS, is_hit, text, "some: the space draws a twelfth of its own there")?;
        }
    }
    corners(&own, &found, &by_value, count)
}

/// So many of the space's own samples make a part of two coordinates large enough to be looked at, if as many samples as this
/// are expected in it. That none is by chance happens once in 10^13 times; if half of them come from a goal, once in 10^6.
const LARGE: usize = 24;
const EXPECTED: usize = 30;

/// Every two coordinates, each cut into three parts of equal probability: where the space draws many of its own, the sampler
/// draws some.
fn corners<C>(own: &[C], found: &[&C], value: &dyn Fn(usize, &C) -> f64, count: usize) -> Result<(), Broken> {
    let cuts: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let mut all: Vec<f64> = own.iter().map(|q| value(i, q)).collect();
            all.sort_by(f64::total_cmp);
            [1, 2].map(|k| all.get(k * all.len() / 3).copied().unwrap_or(0.0))
        })
        .collect();
    let part = |q: &C, i: usize| cuts.get(i).map_or(0, |cuts| cuts.iter().filter(|cut| value(i, q) > **cut).count());
    for (i, j) in (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))) {
        for (x, y) in (0..3).flat_map(|x| (0..3).map(move |y| (x, y))) {
            let is_in = |q: &C| part(q, i) == x && part(q, j) == y;
            let drawn = own.iter().filter(|q| is_in(q)).count();
            let is_large = drawn >= LARGE && drawn * found.len() >= EXPECTED * own.len();
            let text = || format!("none of {} samples in part {x} of coordinate {i} and part {y} of {j}", found.len());
            ensure(
                FILLS,
                !is_large || found.iter().any(|q| is_in(q)),
                text,
                "some: the space draws many of its own there",
            )?;
        }
    }
    Ok(())
}
