//! How much a goal accepts, and how many of its parts.

use super::{ASKS, NEAR, PARTS, Trial};
use crate::domain::Domain;
use crate::laws::feed::{components, count_of, drift, moved, values, with};
use crate::laws::watch::{PANICS, entering, guarded};
use crate::laws::{Broken, ensure, equal};
use crate::partial::PartialState;
use crate::random::Stream;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// In how many places a component is tried.
const PLACES: usize = 16;
/// What part of the way to somewhere else is nearly there still.
const NEXT: f64 = 1e-3;
/// What part of the way to somewhere else is no longer near.
const AWAY: f64 = 0.15;

impl<D: Domain> Trial<'_, D> {
    /// A goal that always samples the same: one component after the other a little away from there, and at other values of one
    /// number after the other.
    pub(super) fn one_place(&self, target: &PartialState<D>, rng: &mut Stream) -> Result<(), Broken> {
        let met = target.overlay(self.m, self.from);
        for component in components(self.m, target.components()) {
            let of = |broken: Broken| broken.of(self.m.component_name(component));
            let others: Vec<_> = (0..PLACES).map(|_| moved(self.m, &met, component, rng)).collect();
            let away = others.iter().map(|other| {
                let mut away = met.clone();
                drift(self.m, &mut away, other, component, AWAY);
                away
            });
            let away: Vec<_> = away.filter(|away| !target.is_met(self.m, away)).collect();
            let is_near = !away.is_empty() && away.iter().all(|away| self.is_satisfied(away));
            let text = || format!("satisfied by {} of {} states that far away", away.len(), away.len());
            ensure(NEAR, !is_near, text, "not satisfied by some").map_err(of)?;
            // A goal that leaves some room around its sample may leave all of it along one coordinate.
            let is_loose = others.iter().any(|other| {
                let mut next = met.clone();
                drift(self.m, &mut next, other, component, NEXT);
                !target.is_met(self.m, &next) && self.is_satisfied(&next)
            });
            if is_loose {
                continue;
            }
            for coordinate in 0..count_of(self.m, &met, component) {
                let off = others.iter().filter_map(|other| self.with_number(&met, other, component, coordinate));
                let off: Vec<_> = off.filter(|off| !target.is_met(self.m, off)).collect();
                let is_deaf = off.len() > PLACES / 2 && off.iter().all(|off| self.is_satisfied(off));
                let text = || format!("satisfied with {} other values of coordinate {coordinate}", off.len());
                ensure(ASKS, !is_deaf, text, "not satisfied with some: a sample has always the same").map_err(of)?;
            }
        }
        Ok(())
    }

    /// `state` with one number of one component as in `other`, if that is still in its space.
    fn with_number(
        &self,
        state: &State<D>,
        other: &State<D>,
        component: ComponentId,
        coordinate: usize,
    ) -> Option<State<D>> {
        let mut at = state.clone();
        match component {
            ComponentId::Robot => {
                let space = self.m.robot();
                let value = *values(space, &other.robot).get(coordinate)?;
                at.robot = with(space, &state.robot, coordinate, value);
                space.contains(&at.robot).then_some(at)
            }
            ComponentId::Object(id) => {
                let space = self.m.objects().get(id.index())?;
                let value = *values(space, other.object(id)?).get(coordinate)?;
                let q = with(space, state.object(id)?, coordinate, value);
                let is_inside = space.contains(&q);
                *at.objects.get_mut(id.index())? = q;
                is_inside.then_some(at)
            }
        }
    }

    /// Parts met where everything is as the sample wants it, and elsewhere.
    pub(super) fn parts(&self, target: &PartialState<D>, rng: &mut Stream) -> Result<(), Broken> {
        let met = target.overlay(self.m, self.from);
        let count = |state: &State<D>| {
            entering("parts_met");
            guarded(PANICS, || self.goal.parts_met(self.m, state))
        };
        let most = count(&met)?;
        equal(PARTS, &count(&met)?, &most).map_err(|broken| broken.of("asked again"))?;
        ensure(PARTS, most > 0, || format!("{most} parts, though it is satisfied"), "at least one")?;
        let all = (0..self.m.objects().len())
            .fold(ComponentSet::ROBOT, |set, i| set.with(ComponentId::Object(ObjectId::new(i))));
        let (mut fewer, mut others) = (false, false);
        for _ in 0..PLACES {
            let away = components(self.m, all).into_iter().fold(met.clone(), |s, c| moved(self.m, &s, c, rng));
            let found = count(&away)?;
            ensure(
                PARTS,
                found <= most,
                || format!("{found} parts of {away:?}"),
                "at most as many as where it is satisfied",
            )?;
            others |= !self.is_satisfied(&away);
            fewer |= found < most;
        }
        let text = || format!("{most} parts in {PLACES} of {PLACES} states that do not satisfy it");
        ensure(PARTS, fewer || !others, text, "fewer in some")
    }
}
