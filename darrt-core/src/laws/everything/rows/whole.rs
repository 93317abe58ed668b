//! The validity on motions that the primitives propose, the oracle, and the planner with verifier and all.

use std::ops::ControlFlow;
use std::sync::Arc;

use rand::RngExt;

use super::{Plan, Tally, rng_of_case};
use crate::budget::Budget;
use crate::domain::Domain;
use crate::laws::everything::report::Row;
use crate::laws::everything::world::{GROWTH, World, default_strategy};
use crate::laws::feed::elsewhere;
use crate::laws::planner::Heart;
use crate::laws::watch::{drawing, entering};
use crate::laws::{Broken, check_by_oracle, check_planner, check_validity, planner, validity, verifier};
use crate::observe::{Event, Observer};
use crate::partial::PartialState;
use crate::random::{Purpose, stream};
use crate::solve::{SolveOptions, solve};
use crate::state::{ComponentId, ObjectId, State};
use crate::validity::BlockKind;

/// Motions looked at in each case.
const MOTIONS: usize = 3;
/// States that are shown to the oracle in each case, besides those that are made of them.
const STATES: usize = 24;

pub(super) fn plans<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    [the_validity(world), the_oracle(world), the_planner(world)].into_iter().flatten().collect()
}

fn the_validity<D: Domain>(world: &World<D>) -> Option<Plan<D>> {
    world.subjects.validity.as_ref().filter(|_| !world.subjects.primitives.is_empty())?;
    let tally = Arc::new(Tally::default());
    let counted = Arc::clone(&tally);
    let case = move |world: &World<D>, number: u64, level: u8| {
        let (m, subjects) = (&*world.m, &world.subjects);
        let Some(validity) = &subjects.validity else { return Ok(()) };
        let mut rng = rng_of_case(number);
        let from = world.state(&mut rng, level);
        let to = world.target(&from, &mut rng, level);
        let mut seen = 0;
        for primitive in subjects.primitives.iter() {
            entering("useful");
            if seen >= MOTIONS || !primitive.useful(m, &from, &to) {
                continue;
            }
            let draws = stream(number, 0, 0, Purpose::Extend);
            let found = drawing("propagate", draws, |rng| primitive.propagate(m, &from, &to, rng))?;
            let mut here = from.clone();
            for instance in found.into_iter().flatten() {
                let next = instance.at(m, 1.0, &here);
                let instance = Arc::new(instance);
                check_validity(m, &**validity, &instance, &here, &subjects.validity_claims, number)?;
                seen += 1;
                Tally::count(&counted.tried);
                // What comes behind a blocked motion is never asked.
                if validity.free_prefix(m, &instance, &here).blame.is_some() {
                    Tally::count(&counted.hit);
                    break;
                }
                here = next;
            }
        }
        Ok(())
    };
    let once = move |world: &World<D>, row: &mut Row| {
        held(world)?;
        let [tried, blocked] = [&tally.tried, &tally.hit].map(Tally::get);
        match (tried, blocked) {
            (0, _) => row.warn("no motion was proposed: only its laws about states could be looked at"),
            (_, 0) => row.warn(format!("none of {tried} motions was blocked")),
            _ if tried == blocked => row.warn(format!("all of {tried} motions were blocked")),
            _ => {}
        }
        Ok(())
    };
    let cases = world.subjects.effort.cases;
    Some(Plan::new("validity", validity::LAWS.len(), cases, case).finally(once))
}

/// How many places are looked at, and how many of those in something fixed are tried, for what is held.
const PLACES: u64 = 4096;
const TRIED: usize = 96;

/// An object is brought by the primitives, from states in other modes than that of the start, to places where at rest it would
/// be in something fixed: the end of such a motion is not free.
fn held<D: Domain>(world: &World<D>) -> Result<(), Broken> {
    let (m, subjects) = (&*world.m, &world.subjects);
    let Some(validity) = &subjects.validity else { return Ok(()) };
    let none = D::Contacts::default();
    let others: Vec<_> = world.pool.iter().filter(|state| state.mode != subjects.start.mode).collect();
    let mut tried = 0;
    for i in 0..PLACES {
        let mut rng = rng_of_case(world.seed.wrapping_add(i));
        let Some(from) = others.get(rng.random_range(0..others.len().max(1))) else { return Ok(()) };
        let id = ObjectId::new(rng.random_range(0..m.objects().len().max(1)));
        let aim = elsewhere(m, &subjects.start, &mut rng);
        let Some(place) = aim.object(id) else { return Ok(()) };
        // The others are where they will be; from where it was nothing is in the way.
        let mut resting = State { objects: from.objects.clone(), ..subjects.start.clone() };
        resting.objects.iter_mut().skip(id.index()).take(1).for_each(|slot| slot.clone_from(place));
        entering("check");
        let Err(blame) = validity.check(m, &resting, &none) else { continue };
        let name = m.component_name(ComponentId::Object(id));
        let is_its = *blame.first == *name || *blame.second == *name;
        if !is_its || !matches!(blame.kind, BlockKind::ObjectFixed | BlockKind::ObjectObject) {
            continue;
        }
        let to = PartialState::anywhere(m).with_object(id, place.clone());
        for primitive in subjects.primitives.iter() {
            entering("useful");
            if !primitive.useful(m, from, &to) {
                continue;
            }
            tried += 1;
            let draws = stream(world.seed, 25, i, Purpose::Extend);
            let found = drawing("propagate", draws, |rng| primitive.propagate(m, from, &to, rng))?;
            let mut here = (*from).clone();
            for instance in found.into_iter().flatten() {
                let end = instance.at(m, 1.0, &here);
                let arrives = end.object(id) == Some(place) && here.object(id) != Some(place);
                // Let go there it is at rest, and other rules look at it as well.
                let during = State { mode: instance.at(m, 0.5, &here).mode, ..end.clone() };
                if arrives && during.mode == from.mode && validity.check(m, &during, &instance.contacts).is_ok() {
                    let broken = Broken::new(validity::HELD, format!("free: {during:?}"), format!("at rest: {blame}"));
                    return Err(broken.of(format_args!("{}, instance {:?}", primitive.name(), instance.primitive)));
                }
                here = end;
            }
        }
        if tried >= TRIED {
            break;
        }
    }
    Ok(())
}

fn the_oracle<D: Domain>(world: &World<D>) -> Option<Plan<D>> {
    world.subjects.oracle.as_ref().filter(|_| world.subjects.validity.is_some())?;
    let case = |world: &World<D>, number: u64, _: u8| {
        let (Some(free), Some(validity)) = (&world.subjects.oracle, &world.subjects.validity) else { return Ok(()) };
        let mut rng = rng_of_case(number);
        // Their own modes may let something touch: the oracle is asked where nothing may.
        let start = &world.subjects.start.mode;
        let mut states: Vec<_> = world.pool.iter().filter(|state| state.mode == *start).take(STATES / 2).collect();
        let any: Vec<_> = (0..STATES / 2).map(|_| world.any_state(&mut rng, 0)).collect();
        states.extend(any.iter().filter(|state| state.mode == *start));
        check_by_oracle(&*world.m, &**validity, &|m: &D, state: &_| free(m, state), &states, number)
    };
    Some(Plan::new("validity by oracle", 4, world.subjects.effort.cases / 8 + 1, case))
}

/// So many plans of a search are not all refused.
const MANY_REFUSED: u64 = 4;
/// How many times as many iterations as the planner is checked with each attempt of that search has.
const ATTEMPT: u64 = 3;

/// One plan that leads into something for so many cases.
const INTO: u64 = 2;

/// Counts the plans that the verifier refuses.
struct Refused {
    heart: Heart,
    count: u64,
}

impl Observer for Refused {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        self.count += u64::from(matches!(event, Event::Refused { .. }));
        self.heart.on_event(event)
    }
}

fn the_planner<D: Domain>(world: &World<D>) -> Option<Plan<D>> {
    let iterations = world.subjects.effort.iterations;
    if iterations == 0 {
        return None;
    }
    let problem = world.problem()?;
    let strategy = world.subjects.strategy.clone().or_else(|| default_strategy().map(Arc::new))?;
    let case = move |_: &World<D>, number: u64, _: u8| {
        let malformed = |error: &crate::error::Error| Broken::new(planner::PROBLEM, error.to_string(), "no error");
        let problem = problem.as_ref().map_err(malformed)?;
        let mut rng = rng_of_case(number);
        let restart = rng.random_bool(0.5).then_some(iterations / 3 + 1);
        let budget = Budget { iterations: Some(iterations), ..Budget::default() };
        let options = SolveOptions { seed: number, budget, restart_iterations: restart, threads: 1 };
        check_planner(problem, &strategy, &options)
    };
    let once = |world: &World<D>, row: &mut Row| {
        let strategy = world.subjects.strategy.clone().or_else(|| default_strategy().map(Arc::new));
        let (Some(Ok(problem)), Some(strategy)) = (world.problem(), strategy) else { return Ok(()) };
        let iterations = Some(GROWTH * world.subjects.effort.iterations);
        let budget = Budget { iterations, ..Budget::default() };
        // A plan that was refused keeps others from being found: the search begins anew, several times.
        let restart = Some(ATTEMPT * world.subjects.effort.iterations);
        let options = SolveOptions { seed: world.seed, budget, restart_iterations: restart, threads: 1 };
        let mut plans = Refused { heart: Heart::of_this_thread(), count: 0 };
        let outcome = solve(&problem, &strategy, &options, &mut plans);
        if let (None, Some(refusal)) = (&outcome.solution, &outcome.last_refusal) {
            if plans.count >= MANY_REFUSED {
                let found = format!("{} plans to the goal refused, the last one because {refusal}", plans.count);
                return Err(Broken::new(verifier::ACCEPTS, found, "one accepted"));
            }
            row.warn(format!("the verifier refused every plan that was found, the last one because {refusal}"));
        }
        let iterations = ATTEMPT * world.subjects.effort.iterations;
        let shown = usize::try_from(world.subjects.effort.cases / INTO).unwrap_or(usize::MAX);
        let doubts = verifier::each_primitive::ways_and_doubts(&problem, &strategy, world.seed, iterations, shown)?;
        for doubt in doubts {
            row.warn(doubt);
        }
        Ok(())
    };
    let laws = planner::LAWS.len() + verifier::LAWS.len();
    let cases = (world.subjects.effort.cases / 32).max(1);
    Some(Plan::new("planner and verifier", laws, cases, case).finally(once))
}
