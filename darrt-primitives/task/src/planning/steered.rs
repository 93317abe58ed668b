//! Primitives that keep to the rules by which a person steers a plan.

use std::sync::Arc;

use darrt_core::motion::Instance;
use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use darrt_core::state::ObjectId;
use darrt_core::validity::{Blame, BlockKind};
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};
use nalgebra::Point3;
use rand::Rng;

use crate::problem_file::{Region, Steer};

/// What stands for a body in the way of a step that a rule forbids.
pub(crate) const STEER: &str = "`steer`";
/// The side of the hand is that of a point so far behind its tool frame, metres: at a grasp the frame itself is in the object.
const WRIST_M: f64 = 0.1;
/// A hand of which that is no farther beside the centre of an object is above it, metres.
const ABOVE_M: f64 = 0.01;

/// A primitive of which only those chains are proposed that keep to the rules.
pub(super) struct Steered<P> {
    pub(super) part: P,
    pub(super) rules: Arc<[Rule]>,
}

/// A rule, and the primitive that it is about; `None`: all of them.
pub(super) struct Rule {
    primitive: Option<PrimitiveId>,
    steer: Steer,
}

/// The rules about these primitives.
pub(super) fn rules(steers: &[Steer], primitives: &[PrimitiveId]) -> Arc<[Rule]> {
    let known = |steer: &Steer| match &steer.primitive {
        None => Some(None),
        Some(name) => primitives.iter().find(|id| id.name() == name.as_str()).map(|id| Some(*id)),
    };
    steers.iter().filter_map(|steer| Some(Rule { primitive: known(steer)?, steer: steer.clone() })).collect()
}

impl<M: Manipulator> Primitive<Tabletop<M>> for Steered<Box<dyn Primitive<Tabletop<M>>>> {
    fn id(&self) -> PrimitiveId {
        self.part.id()
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        self.part.useful(m, from, to)
    }

    fn approach(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> Option<f64> {
        self.part.approach(m, from, to)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let chain = self.part.propagate(m, from, to, rng)?;
        let mut here = from.clone();
        for instance in &chain {
            let after = instance.at(m, 1.0, &here);
            if let Some(contract) = m.contract(instance.primitive).copied().filter(Contract::manipulates)
                && let Some(broken) = self.broken(m, contract, instance, (&here, &after))
            {
                let place = here.robot.base;
                let (first, second) = (broken.as_str().into(), STEER.into());
                let blame = Blame { kind: BlockKind::Other, first, second, place: [place[0], place[1], 0.0] };
                return Err(Infeasible::Blocked(blame));
            }
            here = after;
        }
        Ok(chain)
    }
}

impl<P> Steered<P> {
    /// What of an instance a rule forbids.
    fn broken<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        contract: Contract,
        instance: &Instance<Tabletop<M>>,
        (before, after): (&TabletopState<M>, &TabletopState<M>),
    ) -> Option<String> {
        let id: ObjectId = instance.object?;
        let name = &*m.movable(id)?.body.name;
        let at = if contract.hand == HandUse::LetsGo { after } else { before };
        let wrist = m.manipulator().world_from_tool(&at.robot) * Point3::new(-WRIST_M, 0.0, 0.0);
        let hand = wrist.coords - at.object(id)?.translation.vector;
        let [x, y, _] = at.robot.base;
        let is_about = |rule: &&Rule| {
            rule.steer.object.as_deref().is_none_or(|object| object == name)
                && rule.primitive.is_none_or(|id| id == instance.primitive)
        };
        let is_broken = |Rule { steer: rule, .. }: &&Rule| {
            let side =
                |range: &[f64; 2]| hand.xy().norm() <= ABOVE_M || is_between(hand.y.atan2(hand.x).to_degrees(), *range);
            rule.forbid
                || rule.from_deg.as_ref().is_some_and(|range| !side(range))
                || rule.base.as_ref().is_some_and(|region| !holds(region, [x, y]))
                || rule.not_base.as_ref().is_some_and(|region| holds(region, [x, y]))
        };
        let mut rules = self.rules.iter().filter(is_about);
        rules.find(is_broken).map(|_| format!("{} of {name}", instance.primitive.name()))
    }
}

/// Is a direction in a range, counter-clockwise from its beginning? All in degrees.
fn is_between(direction: f64, [from, to]: [f64; 2]) -> bool {
    (direction - from).rem_euclid(360.0) <= to - from || to - from >= 360.0
}

fn holds(region: &Region, at: [f64; 2]) -> bool {
    (0..2).all(|axis| (region.min[axis]..=region.max[axis]).contains(&at[axis]))
}

#[cfg(test)]
mod tests {
    use super::is_between;

    #[test]
    fn ranges_go_counter_clockwise_and_over_the_seam() {
        assert!(is_between(90.0, [80.0, 100.0]) && !is_between(110.0, [80.0, 100.0]));
        assert!(is_between(-170.0, [170.0, 200.0]) && is_between(179.0, [170.0, 200.0]));
        assert!(is_between(0.0, [-10.0, 10.0]) && !is_between(180.0, [-10.0, 10.0]));
        assert!(is_between(123.0, [0.0, 360.0]));
    }
}
