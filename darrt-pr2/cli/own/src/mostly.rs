//! A sampler: four in five samples name one object, the others the whole robot.

use darrt_core::domain::Domain;
use darrt_core::goal::Goal;
use darrt_core::partial::PartialState;
use darrt_core::sample::Sampler;
use darrt_core::space::ComponentSpace;
use darrt_core::state::ObjectId;
use rand::{Rng, RngExt};

pub struct MostlyObjects;

impl<D: Domain> Sampler<D> for MostlyObjects {
    fn sample(&self, m: &D, _: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let objects = m.objects();
        let anywhere = PartialState::anywhere(m);
        if rng.random_bool(0.8) {
            let index = rng.random_range(0..objects.len().max(1));
            if let Some(space) = objects.get(index) {
                let config = space.sample(rng);
                return anywhere.with_object(ObjectId::new(index), config);
            }
        }
        let config = m.robot().sample(rng);
        anywhere.with_robot(m, config)
    }
}
