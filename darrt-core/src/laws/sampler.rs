//! Laws of [`Sampler`].

use crate::domain::Domain;
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::random::{Purpose, stream};
use crate::sample::Sampler;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId};

use super::{Broken, ensure, equal};

/// Inside.
pub const INSIDE: &str = "sampler.inside: every named component of a sample lies in its space";
/// Names something.
pub const NAMES: &str =
    "sampler.names: a sample names at least one component; towards anywhere nothing can be extended";
/// Seeded.
pub const SEEDED: &str = "sampler.seeded: the same generator gives the same sample";
/// Covers.
pub const COVERS: &str = "sampler.covers: every component that can move is named by some samples";

/// The laws of this file.
pub const LAWS: &[&str] = &[INSIDE, NAMES, SEEDED, COVERS];

/// All laws of a sampler, for one seed.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_sampler<D: Domain>(m: &D, sampler: &dyn Sampler<D>, goal: &dyn Goal<D>, seed: u64) -> Result<(), Broken> {
    let draw = |i| sampler.sample(m, goal, &mut stream(seed, 0, i, Purpose::Sample));
    let check = || {
        let sample = draw(0);
        let _ = draw(1);
        equal(SEEDED, &draw(0), &sample)?;
        ensure(NAMES, !sample.components().is_empty(), || format!("{sample:?}"), "a target that names something")?;
        inside(m, &sample, seed)
    };
    check().map_err(|broken| broken.replayed_by(|| format!("check_sampler({seed})")))
}

fn inside<D: Domain>(m: &D, sample: &PartialState<D>, seed: u64) -> Result<(), Broken> {
    sample.check(m).map_err(|error| Broken::new(INSIDE, error.to_string(), "a target of the domain"))?;
    // Named groups alone need a configuration around them.
    let around = m.robot().sample(&mut stream(seed, 1, 0, Purpose::Sample));
    let robot = sample.robot_overlay(m, &around);
    ensure(INSIDE, m.robot().contains(&robot), || format!("{robot:?}"), "a configuration of the robot's space")
        .map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))
}

/// In `draws` samples every component that can move is named at least once.
///
/// # Errors
/// [`COVERS`] with the component that is never named.
pub fn check_sampler_covers<D: Domain>(
    m: &D,
    sampler: &dyn Sampler<D>,
    goal: &dyn Goal<D>,
    draws: u64,
    seed: u64,
) -> Result<(), Broken> {
    let named = (0..draws).fold(ComponentSet::EMPTY, |set, i| {
        set.union(sampler.sample(m, goal, &mut stream(seed, 0, i, Purpose::Sample)).components())
    });
    let objects = m.objects().iter().enumerate().filter(|(_, space)| space.dimension() > 0);
    let robot = (m.robot().dimension() > 0).then_some(ComponentId::Robot);
    for component in robot.into_iter().chain(objects.map(|(i, _)| ComponentId::Object(ObjectId::new(i)))) {
        let text = || format!("not named in {draws} samples");
        ensure(COVERS, named.contains(component), text, "named by some").map_err(|broken| {
            let broken = broken.of(m.component_name(component));
            broken.replayed_by(|| format!("check_sampler_covers({draws}, {seed})"))
        })?;
    }
    Ok(())
}
