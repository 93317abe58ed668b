//! The states and targets that are shown: where the start leads by the primitives themselves, anywhere else, and simpler and
//! simpler for a case that fails.

use std::sync::Arc;

use rand::RngExt;

use super::subjects::Subjects;
use crate::distance::GreedyVisit;
use crate::domain::Domain;
use crate::extend::ExtendOptions;
use crate::laws::Broken;
use crate::laws::feed::elsewhere;
use crate::laws::watch::{PANICS, asking, drawing, entering, guarded, or_abandon, watched};
use crate::partial::PartialState;
use crate::problem::Problem;
use crate::random::{Purpose, Stream, stream};
use crate::sample::{GoalBiased, RandomSubset};
use crate::search::{Darrt, Strategy};
use crate::space::{ComponentSpace, GroupSet};
use crate::state::{ObjectId, State};

/// Walks from the start, and how many steps each has at most.
const WALKS: u64 = 12;
const STEPS: u64 = 6;
/// How many times as many iterations as the planner is checked with the search for states takes, and how many it finds at most.
pub(super) const GROWTH: u64 = 20;
const MOST_NODES: usize = 512;
/// How often a state anywhere is drawn until one is valid.
const TRIES: usize = 12;
/// At this level a case is as simple as it gets; at 0 it is as it was drawn.
pub(super) const SIMPLEST: u8 = 5;

/// Without a strategy of one's own.
pub(super) fn default_strategy<D: Domain>() -> Option<Strategy<D>> {
    Some(Strategy {
        sampler: Box::new(GoalBiased::new(RandomSubset, 0.2).ok()?),
        distance: Box::new(GreedyVisit),
        extend: ExtendOptions::default(),
        local_repair: None,
        try_penalty_m: 0.0,
        shorten: crate::shorten::ShortenOptions::default(),
        improve: None,
    })
}

/// What all rows share.
pub(super) struct World<D: Domain> {
    pub(super) m: Arc<D>,
    pub(super) subjects: Arc<Subjects<D>>,
    /// States to which the primitives lead from the start, the start first.
    pub(super) pool: Vec<State<D>>,
    pub(super) seed: u64,
}

impl<D: Domain> World<D> {
    /// Walks through the space by the primitives themselves.
    pub(super) fn new(m: &Arc<D>, subjects: &Arc<Subjects<D>>, round: u64) -> Result<Self, Broken> {
        let (m, subjects) = (Arc::clone(m), Arc::clone(subjects));
        let seed = subjects.effort.seed.wrapping_add(round);
        or_abandon(move || {
            let about = || "check_everything(..), while it walks from the start".to_owned();
            watched(&about, || {
                let start = subjects.start.clone();
                let mut world = Self { m: Arc::clone(&m), subjects: Arc::clone(&subjects), pool: vec![start], seed };
                for walk in 0..WALKS {
                    world.walk(walk)?;
                }
                world.grow();
                Ok(world)
            })
        })
    }

    /// A search leads to modes that no random walk comes to. What goes wrong in it is found out, and told, by the rows.
    fn grow(&mut self) {
        let iterations = GROWTH * self.subjects.effort.iterations;
        let Some(Ok(problem)) = self.problem().filter(|_| iterations > 0) else { return };
        let Some(strategy) = self.subjects.strategy.clone().or_else(|| default_strategy().map(Arc::new)) else {
            return;
        };
        let grown = guarded(PANICS, || {
            let mut search = Darrt::new(&problem, &strategy, self.seed, 0, MOST_NODES);
            for _ in 0..iterations {
                entering("an iteration of the search");
                let step = search.step();
                if step.solution.is_some() || step.stop.is_some() {
                    break;
                }
            }
            search.tree().iter().map(|(_, node)| node.state.clone()).collect::<Vec<_>>()
        });
        self.pool.extend(grown.unwrap_or_default());
    }

    fn walk(&mut self, walk: u64) -> Result<(), Broken> {
        let mut rng = stream(self.seed, 11, walk, Purpose::Attempt);
        let mut here = self.subjects.start.clone();
        for step in 0..STEPS {
            let to = self.target(&here, &mut rng, 0);
            let mut useful = Vec::new();
            for primitive in self.subjects.primitives.iter() {
                let about = || format!("useful of {}, from &{here:?} to &{to:?}", primitive.name());
                entering("useful");
                if asking(about, || primitive.useful(&self.m, &here, &to)) {
                    useful.push(primitive);
                }
            }
            if useful.is_empty() {
                continue;
            }
            let primitive = useful.swap_remove(rng.random_range(0..useful.len()));
            let draws = stream(self.seed, 12 + walk, step, Purpose::Extend);
            let about = || format!("propagate of {}, from &{here:?} to &{to:?}, step {step}", primitive.name());
            let call = || drawing("propagate", draws, |rng| primitive.propagate(&self.m, &here, &to, rng));
            let found = asking(about, call)?;
            for instance in found.into_iter().flatten() {
                entering("free_prefix");
                let validity = self.subjects.validity.as_ref();
                if validity.is_some_and(|v| v.free_prefix(&self.m, &instance, &here).blame.is_some()) {
                    break;
                }
                here = instance.at(&self.m, 1.0, &here);
                self.pool.push(here.clone());
            }
        }
        Ok(())
    }

    pub(super) fn is_valid(&self, state: &State<D>) -> bool {
        entering("check");
        let validity = self.subjects.validity.as_ref();
        validity.is_none_or(|v| v.check(&self.m, state, &D::Contacts::default()).is_ok())
    }

    /// A state: one that the walks have reached, or the same with components anywhere, if it is still valid.
    pub(super) fn state(&self, rng: &mut Stream, level: u8) -> State<D> {
        let known = self.pool.get(rng.random_range(0..self.pool.len())).unwrap_or(&self.subjects.start);
        // What is held goes with the hand: only in the mode of the start may everything be anywhere.
        let is_free = known.mode == self.subjects.start.mode;
        let mut state = known.clone();
        if is_free && rng.random_bool(0.75) {
            for i in 0..TRIES {
                let there = elsewhere(&*self.m, known, rng);
                // Harder to please: only the robot.
                let there = if i < TRIES / 2 { there } else { State { robot: there.robot, ..known.clone() } };
                if self.is_valid(&there) {
                    state = there;
                    break;
                }
            }
        }
        if is_free { self.simpler(state, level) } else { state }
    }

    /// Any state, valid or not.
    pub(super) fn any_state(&self, rng: &mut Stream, level: u8) -> State<D> {
        let known = self.pool.get(rng.random_range(0..self.pool.len())).unwrap_or(&self.subjects.start);
        let there = elsewhere(&*self.m, known, rng);
        self.simpler(if rng.random_bool(0.8) { there } else { known.clone() }, level)
    }

    /// Nearer to the start, and rounded, the more the higher the level.
    fn simpler(&self, state: State<D>, level: u8) -> State<D> {
        if level == 0 {
            return state;
        }
        let home = &self.subjects.start;
        let mut simple = state;
        simple.robot = simpler(self.m.robot(), &home.robot, &simple.robot, level);
        for ((slot, space), home) in simple.objects.iter_mut().zip(self.m.objects()).zip(&home.objects) {
            *slot = simpler(space, home, slot, level);
        }
        simple
    }

    /// A target: the goal's, or random components anywhere, some of them where they are already.
    pub(super) fn target(&self, from: &State<D>, rng: &mut Stream, level: u8) -> PartialState<D> {
        if let Some(goal) = self.subjects.goal.as_ref().filter(|_| rng.random_bool(0.2)) {
            entering("sample of the goal");
            if let Some(target) = goal.sample(&self.m, rng) {
                return target;
            }
        }
        let aim = self.simpler(elsewhere(&*self.m, from, rng), level);
        let named: u64 = match rng.random_range(0..4_u8) {
            0 => 1,
            1 => 2 << rng.random_range(0..self.m.objects().len().max(1)).min(62),
            2 => rng.random(),
            _ => u64::MAX,
        };
        let mut target = PartialState::anywhere(&*self.m);
        if named & 1 == 1 {
            let all = self.m.robot().groups();
            let groups: Vec<GroupSet> = (0..32).filter(|i| all.contains(*i)).map(GroupSet::only).collect();
            let one = groups.get(rng.random_range(0..groups.len().max(1))).copied();
            let groups = if rng.random_bool(0.5) { all } else { one.unwrap_or(all) };
            target = target.with_robot_groups(aim.robot.clone(), groups);
        }
        for (i, at) in aim.objects.iter().enumerate() {
            let id = ObjectId::new(i);
            let is_met = rng.random_bool(0.2);
            if named >> (i + 1).min(63) & 1 == 1 {
                let at = if is_met { from.object(id).unwrap_or(at) } else { at };
                target = target.with_object(id, at.clone());
            }
        }
        target
    }

    /// The problem that the parts make, if all are there.
    pub(super) fn problem(&self) -> Option<Result<Problem<D>, crate::error::Error>> {
        let subjects = &self.subjects;
        let (goal, validity) = (subjects.goal.clone()?, subjects.validity.clone()?);
        let verifier = subjects.verifier.clone()?;
        if subjects.primitives.is_empty() {
            return None;
        }
        let (m, start) = (Arc::clone(&self.m), subjects.start.clone());
        Some(Problem::of_shared(m, start, (goal, Arc::clone(&subjects.primitives), validity, verifier)))
    }
}

/// Between home and `q`, and with few digits, if that is still in the space.
fn simpler<S: ComponentSpace>(space: &S, home: &S::Config, q: &S::Config, level: u8) -> S::Config {
    let share = match level {
        1 => 1.0,
        2 => 0.5,
        3 => 0.25,
        4 => 1.0 / 16.0,
        _ => 0.0,
    };
    let near = space.interpolate(home, q, share);
    let mut round = near.clone();
    space.numbers(&mut round, &mut |x| *x = (*x * 16.0).round() / 16.0);
    if space.contains(&round) { round } else { near }
}
