//! `SAMPLE(M)`: partially specified configurations (paper section 4.2).

use rand::{Rng, RngExt};

use crate::domain::Domain;
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::space::{ComponentSpace, GroupSet};
use crate::state::{ObjectId, RobotConfig, State};

pub mod full;
pub mod goal_biased;
pub mod guided;
pub mod placed;
pub mod random_subset;
pub mod robot_or_objects;

pub use full::Full;
pub use goal_biased::GoalBiased;
pub use guided::Guided;
pub use placed::Placed;
pub use random_subset::RandomSubset;
pub use robot_or_objects::RobotOrObjects;

/// Draws the targets that the tree is extended towards.
///
/// # Laws
/// Pure but for `rng`, and for what it has learnt: the same generator gives the same sample.
///
/// # Example
/// ```
/// use darrt_core::prelude::*;
/// use darrt_core::sample::Sampler;
/// use rand::{Rng, RngExt};
///
/// /// One object somewhere, and nothing else: the robot may be anywhere.
/// struct OneObject;
///
/// impl<D: Domain> Sampler<D> for OneObject {
///     fn sample(&self, m: &D, _: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
///         let anywhere = PartialState::anywhere(m);
///         if m.objects().is_empty() {
///             return anywhere;
///         }
///         let index = rng.random_range(0..m.objects().len());
///         let at = m.objects()[index].sample(rng);
///         anywhere.with_object(ObjectId::new(index), at)
///     }
/// }
/// ```
pub trait Sampler<D: Domain>: Send + Sync {
    /// A target; every named component lies in its space.
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D>;

    /// For a sampler that learns: one that knows nothing yet, for one attempt alone. Attempts must not learn from each
    /// other, because which runs first depends on the threads. `None`: it does not learn.
    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        None
    }

    /// An extension towards `to` was blocked at `stopped`.
    fn learn_block(&mut self, _m: &D, _stopped: &State<D>, _to: &PartialState<D>) {}
}

/// `s` with a random configuration for the whole robot.
fn with_random_robot<D: Domain>(m: &D, s: PartialState<D>, rng: &mut dyn Rng) -> PartialState<D> {
    let config = m.robot().sample(rng);
    s.with_robot(m, config)
}

/// `s` with a random configuration for one object.
fn with_random_object<D: Domain>(m: &D, s: PartialState<D>, id: ObjectId, rng: &mut dyn Rng) -> PartialState<D> {
    match m.objects().get(id.index()) {
        Some(space) => s.with_object(id, space.sample(rng)),
        None => s,
    }
}

/// The objects that can move at all.
fn movable<D: Domain>(m: &D) -> Vec<ObjectId> {
    let ids = m.objects().iter().enumerate().filter(|(_, space)| space.dimension() > 0);
    ids.map(|(i, _)| ObjectId::new(i)).collect()
}

/// One group of the robot, drawn uniformly, with a configuration to take it from.
fn random_group<D: Domain>(m: &D, rng: &mut dyn Rng) -> (RobotConfig<D>, GroupSet) {
    let config = m.robot().sample(rng);
    let present: Vec<u32> = (0..32).filter(|i| m.robot().groups().contains(*i)).collect();
    if present.is_empty() {
        return (config, m.robot().groups());
    }
    let pick = rng.random_range(0..present.len());
    (config, present.get(pick).map_or(m.robot().groups(), |i| GroupSet::only(*i)))
}
