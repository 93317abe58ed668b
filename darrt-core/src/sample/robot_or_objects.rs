//! Either the robot or objects, never both: the paper's choice (section 4.2).

use rand::{Rng, RngExt};

use super::{Sampler, movable, random_group, with_random_object, with_random_robot};
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::goal::Goal;
use crate::partial::PartialState;

/// Names objects with probability `object_share`, else the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotOrObjects {
    object_share: f64,
    group_share: f64,
}

impl RobotOrObjects {
    /// `object_share` in `[0, 1]`: how often objects are named instead of the robot. `group_share` in
    /// `[0, 1]`: how often a robot sample names one group (base or arm) alone instead of all of them.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a share outside `[0, 1]`.
    pub fn new(object_share: f64, group_share: f64) -> Result<Self, Error> {
        Ok(Self {
            object_share: in_range("object_share", object_share, 0.0, 1.0, "in [0, 1]")?,
            group_share: in_range("group_share", group_share, 0.0, 1.0, "in [0, 1]")?,
        })
    }
}

impl<D: Domain> Sampler<D> for RobotOrObjects {
    fn sample(&self, m: &D, _: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let s = PartialState::anywhere(m);
        let objects = movable(m);
        if !objects.is_empty() && rng.random_bool(self.object_share) {
            // A random non-empty subset of the objects; with one object, that object.
            loop {
                let chosen: Vec<_> =
                    objects.iter().copied().filter(|_| objects.len() == 1 || rng.random_bool(0.5)).collect();
                if !chosen.is_empty() {
                    return chosen.into_iter().fold(s, |s, id| with_random_object(m, s, id, rng));
                }
            }
        }
        if rng.random_bool(self.group_share) {
            let (config, groups) = random_group(m, rng);
            s.with_robot_groups(config, groups)
        } else {
            with_random_robot(m, s, rng)
        }
    }
}
