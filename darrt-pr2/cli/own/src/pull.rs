//! Pull: two fingers come down behind the rim of a round object, as seen from the robot, and draw it towards the robot.

use darrt_core::prelude::*;
use darrt_primitives::action::push::{hand_behind, straight_way};
use darrt_primitives::action::slide::slide;
use darrt_primitives::contact::HandStance;
use darrt_primitives::contract::{Contract, HandUse, HandWay, MovingPart, ObjectRule};
use darrt_primitives::tabletop::{Tabletop, TabletopState};
use darrt_primitives::target_query::{object_to_push, objects_to_push};
use darrt_task::registry::TaskPrimitive;
use darrt_task::robot::TaskRobot;
use rand::{Rng, RngExt};

pub struct Pull {
    id: PrimitiveId,
    settings: PullSettings,
}

/// `[primitive.Pull]` in problem files.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PullSettings {
    /// How far the base stands at least on the side to which the object comes, metres.
    ahead_m: f64,
}

impl Default for PullSettings {
    fn default() -> Self {
        Self { ahead_m: 0.3 }
    }
}

impl<M: TaskRobot> TaskPrimitive<M> for Pull {
    const NAME: &'static str = "Pull";
    const CONTRACT: Contract =
        Contract { object: ObjectRule::Pushed, ..Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Own) };
    const NEEDS: &'static [&'static str] = &["Arm-Transit", "Straight-Line-Arm-Transit"];
    type Settings = PullSettings;

    fn new(id: PrimitiveId, settings: PullSettings) -> Result<Self, String> {
        if (0.0..=2.0).contains(&settings.ahead_m) {
            return Ok(Self { id, settings });
        }
        Err(format!("`ahead_m` is {}, must be in [0, 2]", settings.ahead_m))
    }
}

impl<M: TaskRobot> Primitive<Tabletop<M>> for Pull {
    fn id(&self) -> PrimitiveId {
        self.id
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        objects_to_push(m, from, to).next().is_some()
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let (object, target) = object_to_push(m, from, to, rng)?;
        let way = straight_way(m, from, object, target, rng)?;
        let stance = HandStance { twin: rng.random_bool(0.5), ..HandStance::default() };
        let hand = hand_behind(m, from, (object, &way), &stance, self.id)?;
        let at = way.slide.from().translation.vector;
        let is_ahead = |base: &[f64; 3]| (base[0] - at.x) * hand.ahead.x + (base[1] - at.y) * hand.ahead.y;
        slide(m, from, &hand, &way, |q| is_ahead(&q.base) >= self.settings.ahead_m, rng)
    }
}
