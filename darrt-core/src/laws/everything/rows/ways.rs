//! What a strategy adds to the motions of the primitives: ways around what blocks them, and what they cost.

use std::sync::Arc;

use super::{Plan, Tally, rng_of_case};
use crate::domain::Domain;
use crate::laws::everything::report::Row;
use crate::laws::everything::world::World;
use crate::laws::watch::{drawing, entering};
use crate::laws::{Broken, MotionClaims, check_cost, check_local_repair, cost, local_repair, motion};
use crate::motion::Instance;
use crate::random::{Purpose, stream};
use crate::state::State;

/// Motions looked at in each case.
const MOTIONS: usize = 4;

pub(super) fn plans<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    [the_reroute(world), the_cost(world)].into_iter().flatten().collect()
}

/// A motion, where it begins, and whether something is in its way.
type Tried<D> = (Instance<D>, State<D>, bool);

/// Motions that the primitives propose, each with the state in which it begins; behind one that is blocked none.
fn motions<D: Domain>(world: &World<D>, number: u64, level: u8) -> Result<Vec<Tried<D>>, Broken> {
    let (m, subjects) = (&*world.m, &world.subjects);
    let mut rng = rng_of_case(number);
    let from = world.state(&mut rng, level);
    let to = world.target(&from, &mut rng, level);
    let mut all = Vec::new();
    for primitive in subjects.primitives.iter() {
        entering("useful");
        if all.len() >= MOTIONS || !primitive.useful(m, &from, &to) {
            continue;
        }
        let draws = stream(number, 0, 0, Purpose::Extend);
        let found = drawing("propagate", draws, |rng| primitive.propagate(m, &from, &to, rng))?;
        let mut here = from.clone();
        for instance in found.into_iter().flatten() {
            let next = instance.at(m, 1.0, &here);
            entering("free_prefix");
            let is_blocked =
                subjects.validity.as_ref().is_some_and(|v| v.free_prefix(m, &instance, &here).blame.is_some());
            all.push((instance, here, is_blocked));
            if is_blocked {
                break;
            }
            here = next;
        }
    }
    Ok(all)
}

fn the_reroute<D: Domain>(world: &World<D>) -> Option<Plan<D>> {
    world.subjects.strategy.as_ref()?.local_repair.as_ref()?;
    world.subjects.validity.as_ref().filter(|_| !world.subjects.primitives.is_empty())?;
    let tally = Arc::new(Tally::default());
    let counted = Arc::clone(&tally);
    let case = move |world: &World<D>, number: u64, level: u8| {
        let (m, subjects) = (&*world.m, &world.subjects);
        let Some(local_repair) = subjects.strategy.as_ref().and_then(|strategy| strategy.local_repair.as_deref())
        else {
            return Ok(());
        };
        let Some(validity) = subjects.validity.as_deref() else { return Ok(()) };
        let travel = |m: &D, a: &_, b: &_| match &subjects.travel {
            Some(travel) => travel(m, a, b),
            None => motion::component_travel(m, a, b),
        };
        let claims = MotionClaims { travel: &travel, ..MotionClaims::default() };
        for (instance, from, is_blocked) in motions(world, number, level)? {
            entering("is_free_to_turn");
            // Ways around are looked for where something is in the way; what may not turn must refuse anywhere.
            if local_repair.is_free_to_turn(m, &instance) && !is_blocked {
                continue;
            }
            Tally::count(&counted.tried);
            if check_local_repair(m, local_repair, validity, (&instance, &from), number, &claims)? {
                Tally::count(&counted.reached);
            }
        }
        Ok(())
    };
    let once = move |_: &World<D>, row: &mut Row| {
        let [tried, found] = [&tally.tried, &tally.reached].map(Tally::get);
        if found == 0 {
            row.warn(format!("found a way around for none of {tried} motions"));
        }
        Ok(())
    };
    let cases = world.subjects.effort.cases / 4 + 1;
    Some(Plan::new("local_repair", local_repair::LAWS.len() + motion::LAWS.len(), cases, case).finally(once))
}

fn the_cost<D: Domain>(world: &World<D>) -> Option<Plan<D>> {
    world.subjects.strategy.as_ref()?.improve.as_ref()?;
    if world.subjects.primitives.is_empty() {
        return None;
    }
    let tally = Arc::new(Tally::default());
    let counted = Arc::clone(&tally);
    let case = move |world: &World<D>, number: u64, level: u8| {
        let Some(improve) = world.subjects.strategy.as_ref().and_then(|strategy| strategy.improve.as_ref()) else {
            return Ok(());
        };
        for (instance, from, _) in motions(world, number, level)? {
            Tally::count(&counted.tried);
            check_cost(&*world.m, &*improve.cost, &instance, &from)?;
        }
        Ok(())
    };
    let once = move |_: &World<D>, row: &mut Row| {
        let none = Tally::get(&tally.tried) == 0;
        if none {
            row.warn("no motion was proposed: nothing could be looked at");
        }
        Ok(())
    };
    let cases = world.subjects.effort.cases / 2 + 1;
    Some(Plan::new("execution cost", cost::LAWS.len(), cases, case).finally(once))
}
