//! Where the time of planning goes: primitives, collision checks, ways around, verification, the way to the first plan.
//!
//! Every part of a problem that is timed is wrapped; the wrapped part does the same, bit for bit. The times are sums over
//! all threads. When the first plan was found is exact for one thread, and for several it is that of any of them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use darrt_core::budget::{Budget, Clock};
use darrt_core::goal::Goal;
use darrt_core::local_repair::{LocalRepair, NoWay};
use darrt_core::motion::Instance;
use darrt_core::observe::{Event, Observer};
use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use darrt_core::state::State;
use darrt_core::validity::{Blame, FreePrefix, Validity};
use rand::Rng;

use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::mode::Contacts;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

/// Seconds spent on one primitive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PrimitiveSeconds {
    /// In its `propagate`: grasps, contacts, inverse kinematics.
    pub propagate_s: f64,
    /// Judging its motions.
    pub collision_s: f64,
    /// Looking for ways around for its blocked motions.
    pub local_repair_s: f64,
}

/// Where the time of one call of [`plan`](crate::planning::plan) went.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Times {
    /// Building and checking the problem, before the search.
    pub prepare_s: f64,
    /// From the beginning of the search to the plan that was accepted in the end, before it was made shorter and
    /// verified; `None` if none was.
    pub first_plan_s: Option<f64>,
    /// Making that plan shorter; when plans are improved, the whole search after the first one.
    pub shortening_s: f64,
    /// In the verifier, refused plans included.
    pub verification_s: f64,
    /// By the name of the primitive, of shortening too. What is missing to the whole is sampling, the nearest node and
    /// the tree.
    pub primitives: BTreeMap<&'static str, PrimitiveSeconds>,
}

/// A state in the goal: when it was found, and how long the verifier had worked before.
#[derive(Debug, Clone, Copy)]
struct Hit {
    at: Duration,
    verified_before: Duration,
}

#[derive(Debug, Default)]
struct Sums {
    primitives: BTreeMap<&'static str, PrimitiveSeconds>,
    verification: Duration,
    hit: Option<Hit>,
}

/// Takes the times; shared by all that is timed.
#[derive(Debug)]
pub(crate) struct Profile {
    clock: Clock,
    sums: Mutex<Sums>,
}

impl Profile {
    /// Starts.
    pub(crate) fn start() -> Arc<Self> {
        Arc::new(Self { clock: Clock::start(&Budget::default()), sums: Mutex::default() })
    }

    /// Time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        self.clock.elapsed()
    }

    /// Runs `work` and hands its time to `add`.
    fn timed<T>(&self, work: impl FnOnce() -> T, add: impl FnOnce(&mut Sums, Duration)) -> T {
        let before = self.elapsed();
        let result = work();
        let spent = self.elapsed().saturating_sub(before);
        self.with(|sums| add(sums, spent));
        result
    }

    fn with<T>(&self, change: impl FnOnce(&mut Sums) -> T) -> T {
        change(&mut self.sums.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Runs the verifier.
    pub(crate) fn verification<T>(&self, work: impl FnOnce() -> T) -> T {
        self.timed(work, |sums, spent| sums.verification += spent)
    }

    fn note_goal_reached(&self) {
        let at = self.elapsed();
        self.with(|sums| {
            let verified_before = sums.verification;
            sums.hit.get_or_insert(Hit { at, verified_before });
        });
    }

    /// All times of a search that began `prepared` after the start and took `searched`.
    pub(crate) fn times(&self, prepared: Duration, searched: Duration, is_solved: bool) -> Times {
        self.with(|sums| {
            let hit = sums.hit.filter(|_| is_solved);
            let shortening = hit.map_or(Duration::ZERO, |hit| {
                let verified = sums.verification.saturating_sub(hit.verified_before);
                (prepared + searched).saturating_sub(hit.at).saturating_sub(verified)
            });
            Times {
                prepare_s: prepared.as_secs_f64(),
                first_plan_s: hit.map(|hit| hit.at.saturating_sub(prepared).as_secs_f64()),
                shortening_s: shortening.as_secs_f64(),
                verification_s: sums.verification.as_secs_f64(),
                primitives: sums.primitives.clone(),
            }
        })
    }
}

/// A part with its stopwatch.
pub(crate) struct Timed<P> {
    pub(crate) part: P,
    pub(crate) watch: Arc<Profile>,
}

impl<M: Manipulator> Primitive<Tabletop<M>> for Timed<Box<dyn Primitive<Tabletop<M>>>> {
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
        let add = |sums: &mut Sums, spent: Duration| {
            sums.primitives.entry(self.part.name()).or_default().propagate_s += spent.as_secs_f64();
        };
        self.watch.timed(|| self.part.propagate(m, from, to, rng), add)
    }
}

impl<M: Manipulator, V: Validity<Tabletop<M>>> Validity<Tabletop<M>> for Timed<V> {
    fn check(&self, m: &Tabletop<M>, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        self.part.check(m, state, contacts)
    }

    fn without_robot(&self) -> Option<Arc<dyn Validity<Tabletop<M>>>> {
        self.part.without_robot()
    }

    fn free_prefix(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>) -> FreePrefix {
        self.free_prefix_with(0, m, instance, from)
    }

    fn most_care(&self) -> usize {
        self.part.most_care()
    }

    fn check_with(
        &self,
        care: usize,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        contacts: &Contacts,
    ) -> Result<(), Blame> {
        self.part.check_with(care, m, state, contacts)
    }

    fn free_prefix_with(
        &self,
        care: usize,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        from: &TabletopState<M>,
    ) -> FreePrefix {
        let add = |sums: &mut Sums, spent: Duration| {
            sums.primitives.entry(instance.primitive.name()).or_default().collision_s += spent.as_secs_f64();
        };
        self.watch.timed(|| self.part.free_prefix_with(care, m, instance, from), add)
    }
}

impl<M: Manipulator> LocalRepair<Tabletop<M>> for Timed<Box<dyn LocalRepair<Tabletop<M>>>> {
    fn is_free_to_turn(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>) -> bool {
        self.part.is_free_to_turn(m, instance)
    }

    fn repair(
        &self,
        m: &Tabletop<M>,
        validity: &dyn Validity<Tabletop<M>>,
        care: usize,
        instance: &Instance<Tabletop<M>>,
        from: &TabletopState<M>,
        rng: &mut dyn Rng,
    ) -> Result<Instance<Tabletop<M>>, NoWay> {
        let add = |sums: &mut Sums, spent: Duration| {
            sums.primitives.entry(instance.primitive.name()).or_default().local_repair_s += spent.as_secs_f64();
        };
        self.watch.timed(|| self.part.repair(m, validity, care, instance, from, rng), add)
    }
}

impl<M: Manipulator, G: Goal<Tabletop<M>>> Goal<Tabletop<M>> for Timed<G> {
    fn is_satisfied(&self, m: &Tabletop<M>, state: &State<Tabletop<M>>) -> bool {
        let is_satisfied = self.part.is_satisfied(m, state);
        if is_satisfied {
            self.watch.note_goal_reached();
        }
        is_satisfied
    }

    fn sample(&self, m: &Tabletop<M>, rng: &mut dyn Rng) -> Option<PartialState<Tabletop<M>>> {
        self.part.sample(m, rng)
    }

    fn parts_met(&self, m: &Tabletop<M>, state: &State<Tabletop<M>>) -> usize {
        self.part.parts_met(m, state)
    }
}

/// Hands on what happens and counts the plans; after a refusal the next plan counts as the first.
pub(crate) struct Watched<'a> {
    pub(crate) observer: &'a mut dyn Observer,
    pub(crate) watch: Arc<Profile>,
    /// Plans found.
    pub(crate) plans: u64,
}

impl Observer for Watched<'_> {
    fn on_event(&mut self, event: &Event<'_>) -> std::ops::ControlFlow<()> {
        if matches!(event, Event::Refused { .. }) {
            self.watch.with(|sums| sums.hit = None);
        }
        self.plans += u64::from(matches!(event, Event::Solved { .. }));
        self.observer.on_event(event)
    }
}

#[cfg(test)]
mod tests {
    use darrt_core::observe::Silent;

    use super::*;
    use crate::planning::PlanRequest;
    use crate::testing::{builtin, planned};

    #[test]
    fn the_parts_fit_into_the_whole() {
        let result = planned(&PlanRequest::new(builtin("bowl").unwrap(), 0));
        let (times, whole) = (&result.times, result.elapsed.as_secs_f64());
        assert!(result.plan.is_some() && times.prepare_s > 0.0 && times.verification_s > 0.0);
        let in_primitives: f64 =
            times.primitives.values().map(|p| p.propagate_s + p.collision_s + p.local_repair_s).sum();
        assert!(in_primitives > 0.0 && in_primitives + times.verification_s <= whole, "{times:?} {whole}");
        assert!(times.first_plan_s.unwrap() + times.shortening_s <= whole, "{times:?} {whole}");
        let names: Vec<_> = result.accounts.rows().map(|(name, _)| name).collect();
        assert!(times.primitives.keys().all(|name| names.contains(name)), "{times:?}");
        assert!(times.primitives["Pick"].propagate_s > 0.0);
    }

    #[test]
    fn a_refused_plan_is_not_the_first() {
        let watch = Profile::start();
        let mut observer = Watched { observer: &mut Silent, watch: Arc::clone(&watch), plans: 0 };
        let first_plan = || watch.times(Duration::ZERO, watch.elapsed(), true).first_plan_s;
        watch.note_goal_reached();
        let before = first_plan().unwrap();
        watch.note_goal_reached();
        assert_eq!(first_plan(), Some(before), "the first time counts");
        let _ = observer.on_event(&Event::Refused { attempt: 0, reason: "" });
        assert_eq!(first_plan(), None);
        watch.note_goal_reached();
        assert!(first_plan().unwrap() >= before);
        assert_eq!(watch.times(Duration::ZERO, watch.elapsed(), false).first_plan_s, None);
    }
}
