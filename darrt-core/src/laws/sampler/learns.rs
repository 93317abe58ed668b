//! A sampler that learns.

use super::{DRAWS, LEARNS, inside};
use crate::domain::Domain;
use crate::goal::Goal;
use crate::laws::feed::elsewhere;
use crate::laws::watch::{drawing, entering, watched};
use crate::laws::{Broken, alike};
use crate::partial::PartialState;
use crate::random::{Purpose, stream};
use crate::sample::Sampler;
use crate::state::State;

/// How often it is told of a block.
const BLOCKS: u64 = 16;

/// What a sampler hands out for one attempt: it keeps the laws of a sampler before and after it has learnt of blocks, in states
/// around `from`, and the next one knows nothing of that.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_sampler_learns<D: Domain>(
    m: &D,
    sampler: &dyn Sampler<D>,
    goal: &dyn Goal<D>,
    from: &State<D>,
    seed: u64,
) -> Result<(), Broken> {
    let about = || format!("check_sampler_learns(&{from:?}, {seed})");
    let check = || {
        let fresh = || {
            entering("for_one_attempt");
            sampler.for_one_attempt()
        };
        let Some(mut own) = fresh() else { return Ok(()) };
        let before = draws(m, &*own, goal, seed)?;
        for i in 0..BLOCKS {
            let mut rng = stream(seed, 2, i, Purpose::Attempt);
            let stopped = elsewhere(m, from, &mut rng);
            let all = PartialState::of_state(m, &elsewhere(m, from, &mut rng));
            let (robot, objects) = parts(m, &all);
            entering("learn_block");
            for to in [&all, &robot, &objects] {
                own.learn_block(m, &stopped, to);
            }
        }
        draws(m, &*own, goal, seed).map_err(|broken| broken.of("after it has learnt"))?;
        let Some(other) = fresh() else { return Err(Broken::new(LEARNS, "none the second time", "another one")) };
        let after = draws(m, &*other, goal, seed)?;
        alike(LEARNS, &after, &before).map_err(|broken| broken.of("another attempt"))
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// The same target for the robot alone, and for the objects alone.
fn parts<D: Domain>(m: &D, all: &PartialState<D>) -> (PartialState<D>, PartialState<D>) {
    let nowhere = PartialState::anywhere(m);
    let robot = match all.robot() {
        Some(target) => nowhere.clone().with_robot_groups(target.config.clone(), target.groups),
        None => nowhere.clone(),
    };
    (robot, all.objects().fold(nowhere, |target, (id, at)| target.with_object(id, at.clone())))
}

fn draws<D: Domain>(
    m: &D,
    sampler: &dyn Sampler<D>,
    goal: &dyn Goal<D>,
    seed: u64,
) -> Result<Vec<PartialState<D>>, Broken> {
    let draw = |i| {
        let rng = stream(seed, 3, i, Purpose::Sample);
        drawing("sample of the sampler", rng, |rng| sampler.sample(m, goal, rng))
    };
    let all = (0..DRAWS).map(draw).collect::<Result<Vec<_>, Broken>>()?;
    for sample in &all {
        inside(m, sample, seed).map_err(|broken| Broken { law: LEARNS, ..broken })?;
    }
    alike(LEARNS, &draw(0)?, all.first().unwrap_or(&PartialState::anywhere(m)))
        .map_err(|broken| broken.of("asked again"))?;
    Ok(all)
}
