//! The validity on motions that the primitives propose, the oracle, and the planner with verifier and all.

use std::sync::Arc;

use rand::RngExt;

use super::{Plan, Tally, rng_of_case};
use crate::budget::Budget;
use crate::distance::GreedyVisit;
use crate::domain::Domain;
use crate::extend::ExtendOptions;
use crate::laws::everything::report::Row;
use crate::laws::everything::world::World;
use crate::laws::watch::{drawing, entering};
use crate::laws::{Broken, check_by_oracle, check_planner, check_validity, planner, validity, verifier};
use crate::random::{Purpose, stream};
use crate::sample::{GoalBiased, RandomSubset};
use crate::search::Strategy;
use crate::solve::SolveOptions;

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
                counted.count(&counted.tried);
                // What comes behind a blocked motion is never asked.
                if validity.free_prefix(m, &instance, &here).blame.is_some() {
                    counted.count(&counted.hit);
                    break;
                }
                here = next;
            }
        }
        Ok(())
    };
    let once = move |_: &World<D>, row: &mut Row| {
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

fn default_strategy<D: Domain>() -> Option<Strategy<D>> {
    Some(Strategy {
        sampler: Box::new(GoalBiased::new(RandomSubset, 0.2).ok()?),
        distance: Box::new(GreedyVisit),
        extend: ExtendOptions::default(),
        reroute: None,
        try_penalty_m: 0.0,
        shorten: crate::shorten::ShortenOptions::default(),
        improve: None,
    })
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
    let laws = planner::LAWS.len() + verifier::LAWS.len();
    Some(Plan::new("planner and verifier", laws, (world.subjects.effort.cases / 32).max(1), case))
}
