//! Spaces, domain, targets, distances, goal and samplers.

use std::sync::Arc;

use rand::RngExt;

use super::{Plan, rng_of_case};
use crate::distance::Distance;
use crate::domain::Domain;
use crate::goal::{AnyOf, Goal};
use crate::laws::everything::report::Row;
use crate::laws::everything::world::World;
use crate::laws::feed::count_of;
use crate::laws::watch::entering;
use crate::laws::{
    Broken, check_component_space, check_distance, check_domain, check_goal, check_nearest, check_partial,
    check_sampler, check_sampler_covers, check_sampler_learns, check_space_covers,
};
use crate::laws::{distance, domain, goal, nearest, partial, sampler, space};
use crate::sample::Sampler;
use crate::state::{ComponentId, ObjectId, State};

/// Samples that say whether a space or a sampler covers its range.
const DRAWS: u64 = 1024;
/// Pairs of modes that are looked at.
const MOST_PAIRS: usize = 4096;

pub(super) fn plans<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    let mut all = spaces(world);
    all.push(the_domain(world));
    all.push(targets(world));
    all.extend(distances(world));
    all.extend(the_goal(world));
    all.extend(samplers(world));
    all
}

fn spaces<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    let (m, cases) = (&world.m, world.subjects.effort.cases);
    let objects = (0..m.objects().len()).map(|i| ComponentId::Object(ObjectId::new(i)));
    std::iter::once(ComponentId::Robot)
        .chain(objects)
        .map(|component| {
            let subject = format!("space of {}", m.component_name(component));
            let case = move |world: &World<D>, number: u64, level: u8| {
                let mut rng = rng_of_case(number);
                let ts = [rng.random_range(0.0..=1.0), rng.random_range(0.0..=1.0)];
                let [a, b, c] = [(); 3].map(|()| world.any_state(&mut rng, level));
                let claims = &world.subjects.spaces;
                match component {
                    ComponentId::Robot => {
                        check_component_space(world.m.robot(), claims, [&a.robot, &b.robot, &c.robot], ts, number)
                    }
                    ComponentId::Object(id) => {
                        let (Some(space), Some(p), Some(q), Some(r)) =
                            (world.m.objects().get(id.index()), a.object(id), b.object(id), c.object(id))
                        else {
                            return Ok(());
                        };
                        check_component_space(space, claims, [p, q, r], ts, number)
                    }
                }
            };
            Plan::new(subject, space::LAWS.len(), cases, case).finally(move |world, row| {
                if count_of(&*world.m, &world.subjects.start, component) == 0 {
                    row.warn("shows no numbers (`ComponentSpace::numbers`): NaN, faces and corners are not fed");
                }
                if !world.subjects.fills {
                    return Ok(());
                }
                match component {
                    ComponentId::Robot => check_space_covers(world.m.robot(), DRAWS, world.seed),
                    ComponentId::Object(id) => {
                        let space = world.m.objects().get(id.index());
                        space.map_or(Ok(()), |space| check_space_covers(space, DRAWS, world.seed))
                    }
                }
            })
        })
        .collect()
}

fn the_domain<D: Domain>(world: &World<D>) -> Plan<D> {
    // Its spaces have rows of their own.
    let cases = world.subjects.effort.cases / 4 + 1;
    Plan::new("domain", domain::LAWS.len(), cases, |world: &World<D>, number, level| {
        let mut rng = rng_of_case(number);
        let [a, b, c] = [(); 3].map(|()| world.any_state(&mut rng, level));
        check_domain(&*world.m, &world.subjects.spaces, [&a, &b, &c], [0.3, 0.8], number)
    })
    .finally(|world, row| {
        let (m, modes) = (&*world.m, modes(world));
        let pairs = modes.iter().flat_map(|a| modes.iter().map(move |b| (a, b)));
        pairs.clone().take(MOST_PAIRS).try_for_each(|(mode, next)| domain::modes(m, mode, next))?;
        if modes.len() > 2 && pairs.into_iter().all(|(a, b)| m.may_go_on(a, b)) {
            row.warn(format!("may_go_on is true for all pairs of {} modes", modes.len()));
        }
        let mut rng = rng_of_case(world.seed);
        let reaches = |state: &State<D>| {
            let ids = (0..state.objects.len()).map(ObjectId::new);
            ids.filter_map(|id| Some(m.reach(&state.robot, id, state.object(id)?))).any(|metres| metres > 0.0)
        };
        if !m.objects().is_empty() && !(0..64).any(|_| reaches(&world.any_state(&mut rng, 0))) {
            row.warn("reach is 0 in 64 of 64 states: tours know nothing of the robot's ways");
        }
        Ok(())
    })
}

fn targets<D: Domain>(world: &World<D>) -> Plan<D> {
    Plan::new("targets", partial::LAWS.len(), world.subjects.effort.cases, |world: &World<D>, number, level| {
        let mut rng = rng_of_case(number);
        let [here, there] = [(); 2].map(|()| world.any_state(&mut rng, level));
        let [a, b] = [(); 2].map(|()| world.target(&here, &mut rng, level));
        check_partial(&*world.m, [&a, &b], &here, &there)
    })
}

/// The distances under test: that of the strategy, and those that were given.
fn distance_of<D: Domain>(world: &World<D>, index: usize) -> Option<&dyn Distance<D>> {
    let own = world.subjects.strategy.as_ref().map(|strategy| &*strategy.distance);
    let given = world.subjects.distances.iter().map(|distance| &**distance);
    own.into_iter().chain(given).nth(index)
}

fn distances<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    let cases = world.subjects.effort.cases;
    let count = usize::from(world.subjects.strategy.is_some()) + world.subjects.distances.len();
    (0..count)
        .map(|index| {
            let case = move |world: &World<D>, number: u64, level: u8| {
                let Some(distance) = distance_of(world, index) else { return Ok(()) };
                let mut rng = rng_of_case(number);
                let m = &*world.m;
                let [from, elsewhere] = [(); 2].map(|()| world.any_state(&mut rng, level));
                let to = world.target(&from, &mut rng, level);
                check_distance(m, distance, &from, &to, &elsewhere)?;
                check_distance(m, distance, &to.overlay(m, &from), &to, &elsewhere)?;
                let states: Vec<State<D>> = (0..8).map(|_| world.any_state(&mut rng, level)).collect();
                let twice = states.iter().chain(&states).cloned();
                check_nearest(m, distance, &nearest::tree_of(m, &from, twice), &to)
            };
            let name = if index == 0 { "distance".to_owned() } else { format!("distance {index}") };
            Plan::new(name, distance::LAWS.len() + nearest::LAWS.len(), cases, case)
        })
        .collect()
}

fn the_goal<D: Domain>(world: &World<D>) -> Option<Plan<D>> {
    let goal = Arc::clone(world.subjects.goal.as_ref()?);
    let cases = world.subjects.effort.cases;
    let case = {
        let goal = Arc::clone(&goal);
        move |world: &World<D>, number: u64, level: u8| {
            let mut rng = rng_of_case(number);
            let mut from = world.any_state(&mut rng, level);
            // The law asks for a mode that the goal accepts; if there is none, the start must do.
            if let Some(mode) = accepted(world, &*goal) {
                from.mode = mode;
            }
            check_goal(&*world.m, &*goal, &from, number)
        }
    };
    let once = move |world: &World<D>, row: &mut Row| {
        let (m, subjects) = (&*world.m, &world.subjects);
        if accepted(world, &*goal).is_none() {
            row.warn("no mode that was come to satisfies it; give a state in the goal with `in_goal`, if there is one");
        }
        entering("is_satisfied");
        if goal.is_satisfied(m, &subjects.start) {
            row.warn("satisfied at the start: nothing has to be planned");
        }
        let modes = modes(world);
        let satisfied = |mode: &D::Mode| {
            let mut rng = rng_of_case(world.seed);
            let target = goal.sample(m, &mut rng);
            target.is_some_and(|target| {
                let met = target.overlay(m, &State { mode: mode.clone(), ..subjects.start.clone() });
                goal.is_satisfied(m, &met)
            })
        };
        if modes.len() > 1 && modes.iter().all(satisfied) {
            row.warn(format!("satisfied in each of {} modes, also when something is still held", modes.len()));
        }
        Ok(())
    };
    Some(Plan::new("goal", goal::LAWS.len(), cases, case).finally(once))
}

/// The modes that the walks have come to.
fn modes<D: Domain>(world: &World<D>) -> Vec<D::Mode> {
    let mut modes: Vec<D::Mode> = Vec::new();
    for state in &world.pool {
        if !modes.contains(&state.mode) {
            modes.push(state.mode.clone());
        }
    }
    modes
}

/// A mode in which a sample of the goal satisfies it.
fn accepted<D: Domain>(world: &World<D>, goal: &dyn Goal<D>) -> Option<D::Mode> {
    let m = &*world.m;
    let target = goal.sample(m, &mut rng_of_case(world.seed))?;
    let given = world.subjects.in_goal.as_ref().map(|state| state.mode.clone());
    given.into_iter().chain(modes(world)).find(|mode| {
        let met = target.overlay(m, &State { mode: mode.clone(), ..world.subjects.start.clone() });
        goal.is_satisfied(m, &met)
    })
}

/// The samplers under test: that of the strategy, and those that were given.
fn sampler_of<D: Domain>(world: &World<D>, index: usize) -> Option<&dyn Sampler<D>> {
    let own = world.subjects.strategy.as_ref().map(|strategy| &*strategy.sampler);
    let given = world.subjects.samplers.iter().map(|sampler| &**sampler);
    own.into_iter().chain(given).nth(index)
}

fn samplers<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    let cases = world.subjects.effort.cases;
    let count = usize::from(world.subjects.strategy.is_some()) + world.subjects.samplers.len();
    let goal_of = |world: &World<D>| {
        let none: Arc<dyn Goal<D>> = Arc::new(AnyOf::new(Vec::new()));
        world.subjects.goal.clone().unwrap_or(none)
    };
    (0..count)
        .map(|index| {
            let case = move |world: &World<D>, number: u64, _: u8| {
                let Some(sampler) = sampler_of(world, index) else { return Ok(()) };
                check_sampler(&*world.m, sampler, &*goal_of(world), number)
            };
            let once = move |world: &World<D>, _: &mut Row| -> Result<(), Broken> {
                let Some(sampler) = sampler_of(world, index) else { return Ok(()) };
                check_sampler_covers(&*world.m, sampler, &*goal_of(world), DRAWS, world.seed)?;
                check_sampler_learns(&*world.m, sampler, &*goal_of(world), &world.subjects.start, world.seed)
            };
            let name = if index == 0 { "sampler".to_owned() } else { format!("sampler {index}") };
            Plan::new(name, sampler::LAWS.len(), cases, case).finally(once)
        })
        .collect()
}
