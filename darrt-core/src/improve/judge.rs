//! The cheapest chain of a roadmap whose motions are all known to be free.
//!
//! Only what lies on the cheapest chain is judged, and what comes out may make another chain the cheapest. A straight way that
//! is blocked is first supposed to have a way around; that is looked for when the chain is wanted.

use rand::Rng;

use super::roadmap::{Id, Roadmap, Verdict, Way};
use crate::budget::Stop;
use crate::domain::Domain;
use crate::lazy_validation::validate_step;
use crate::partial::PartialState;
use crate::plan::Step;
use crate::shorten::joined;
use crate::state::{ComponentId, ObjectId, State};

/// What the first degree of [care](crate::validity::Validity::most_care) is worth that a motion gives up, seconds.
const CARE_S: f64 = 6.0;

/// What so many degrees are worth, seconds: every further one as much more as the first.
fn worth_s(lost: usize) -> f64 {
    CARE_S * 0.5 * (lost * (lost + 1)) as f64
}

impl<D: Domain> Roadmap<'_, D> {
    /// Finds the ways of the cheapest chain, and supposes that what is blocked on them finds a way around. `None` if there is
    /// no chain, or nobody waits for one any more.
    pub(super) fn suppose_cheapest(&mut self, rng: &mut dyn Rng) -> Option<()> {
        self.judge_cheapest(false, rng).map(|_| ())
    }

    /// The cheapest chain of which every motion is free, as far as can be told. `None` as in
    /// [`suppose_cheapest`](Self::suppose_cheapest).
    pub(super) fn free_cheapest(&mut self, rng: &mut dyn Rng) -> Option<Vec<Id>> {
        self.judge_cheapest(true, rng)
    }

    /// Every turn of the loop tells more of one way or manipulation, of which there are finitely many.
    fn judge_cheapest(&mut self, all: bool, rng: &mut dyn Rng) -> Option<Vec<Id>> {
        loop {
            if self.extender.interrupt.stop() == Some(Stop::Cancelled) {
                return None;
            }
            let chain = self.cheapest()?;
            let pairs = chain.iter().copied().zip(chain.iter().copied().skip(1));
            let is_open = |verdict: Verdict| verdict == Verdict::Open || (all && verdict == Verdict::Supposed);
            let is_open_way = |(a, b): &(Id, Id)| self.way_of(*a, *b).is_some_and(|way| is_open(way.verdict));
            let is_open_vertex = |id: &&Id| self.known.get(**id).is_some_and(|known| known.verdict == Verdict::Open);
            // What needs no way around first: it may rule the chain out, and takes less time.
            let open = pairs.clone().find(|(a, b)| self.way_of(*a, *b).is_some_and(|way| way.verdict == Verdict::Open));
            if let Some((a, b)) = open {
                self.judge_way(a, b, rng);
            } else if let Some(id) = chain.iter().find(is_open_vertex).filter(|_| all) {
                self.judge_manipulation(*id);
            } else if let Some((a, b)) = pairs.clone().find(is_open_way) {
                self.go_around(a, b, rng);
            } else {
                return Some(chain);
            }
        }
    }

    fn judge_manipulation(&mut self, id: Id) {
        let Some(known) = self.known.get(id) else { return };
        let lost = self.care_lost(&known.entry, &known.steps);
        let Some(known) = self.known.get_mut(id) else { return };
        match lost {
            Some(lost) => {
                known.careless_s = worth_s(lost);
                known.seconds += known.careless_s;
                known.verdict = Verdict::Free;
            }
            None => known.verdict = Verdict::Blocked,
        }
    }

    /// How much less care than there can be the steps are free with; `None` if they are not free at all.
    fn care_lost(&self, here: &State<D>, steps: &[Step<D>]) -> Option<usize> {
        let (m, validity) = (self.m(), self.extender.problem.validity());
        let most = validity.most_care();
        let mut here = here.clone();
        let mut kept = most;
        for step in steps {
            let is_free = |care: &usize| {
                let free = validity.free_prefix_with(*care, m, &step.instance, &here);
                free.blame.is_none() || free.fraction >= step.until
            };
            kept = (0..=kept).rev().find(is_free)?;
            step.instance.motion.at_into(m, step.until, &mut here);
        }
        Some(most - kept)
    }

    fn may_turn(&self, step: &Step<D>) -> bool {
        self.extender
            .local_repair
            .is_some_and(|local_repair| local_repair.is_free_to_turn(self.extender.problem.domain(), &step.instance))
    }

    /// Finds a way that is guessed, and judges one that is known.
    fn judge_way(&mut self, a: Id, b: Id, rng: &mut dyn Rng) {
        let Some(exit) = self.known.get(a).map(|known| known.exit.clone()) else { return };
        let Some(way) = self.way_of(a, b) else { return };
        let way = match way.steps.clone() {
            Some(steps) => self.judged(a, b, exit, steps),
            None => self.way(a, b, rng).map(|steps| self.way_by(a, b, steps)),
        };
        self.know(a, b, way);
    }

    /// The way by `steps`, judged; `None` if it is blocked where it may not turn aside.
    fn judged(&mut self, a: Id, b: Id, mut here: State<D>, steps: Vec<Step<D>>) -> Option<Way<D>> {
        let (m, validity) = (self.m(), self.extender.problem.validity());
        let (mut seconds, mut verdict) = (self.arrival_s(a, b), Verdict::Free);
        let mut blocked = Vec::with_capacity(steps.len());
        for step in &steps {
            let turns = self.may_turn(step);
            let straight_s = self.cost.seconds(m, &step.instance, &here, step.until);
            let care = if turns { validity.most_care() } else { 0 };
            let free = validity.free_prefix_with(care, m, &step.instance, &here);
            let is_blocked = free.blame.is_some() && free.fraction < step.until;
            blocked.push(is_blocked);
            if !is_blocked {
                seconds += straight_s;
                self.any.learn(straight_s, straight_s);
            } else if turns {
                seconds += straight_s * self.around.ratio();
                verdict = Verdict::Supposed;
            } else {
                return None;
            }
            step.instance.motion.at_into(m, step.until, &mut here);
        }
        Some(Way { seconds, careless_s: 0.0, verdict, steps: Some(steps), blocked })
    }

    /// Looks for ways around what is blocked.
    fn go_around(&mut self, a: Id, b: Id, rng: &mut dyn Rng) {
        let Some((exit, [_, leaf])) = self.known.get(a).map(|known| (known.exit.clone(), known.leaves())) else {
            return;
        };
        let Some(way) = self.way_of(a, b) else { return };
        let (steps, blocked) = (way.steps.clone().unwrap_or_default(), way.blocked.clone());
        let around = self.around(exit, steps, &blocked, rng);
        self.ways_around.count(leaf, around.is_some());
        let arrival_s = self.arrival_s(a, b);
        let way = around.map(|(takes_s, careless_s, steps)| Way {
            seconds: takes_s + arrival_s + careless_s,
            careless_s,
            verdict: Verdict::Free,
            steps: Some(steps),
            blocked: Vec::new(),
        });
        self.know(a, b, way);
    }

    /// The steps with ways around what is blocked, their seconds, and what the care costs that they give up.
    fn around(
        &mut self,
        mut here: State<D>,
        mut steps: Vec<Step<D>>,
        blocked: &[bool],
        rng: &mut dyn Rng,
    ) -> Option<(f64, f64, Vec<Step<D>>)> {
        let m = self.m();
        let (mut seconds, mut careless_s) = (0.0, 0.0);
        for (step, is_blocked) in steps.iter_mut().zip(blocked) {
            let straight_s = self.cost.seconds(m, &step.instance, &here, step.until);
            let mut takes_s = straight_s;
            if *is_blocked {
                let (around, lost) = validate_step(&self.extender, &here, step.clone(), rng).ok()?;
                *step = around;
                takes_s = self.cost.seconds(m, &step.instance, &here, step.until);
                self.around.learn(straight_s, takes_s);
                self.any.learn(straight_s, takes_s);
                careless_s += worth_s(lost);
            }
            seconds += takes_s;
            step.instance.motion.at_into(m, step.until, &mut here);
        }
        Some((seconds, careless_s, steps))
    }

    /// A way from the exit of `a` to the entry of `b`.
    fn way(&self, a: Id, b: Id, rng: &mut dyn Rng) -> Option<Vec<Step<D>>> {
        let (a, b) = (self.known.get(a)?, self.known.get(b)?);
        if self.is_there(&a.exit, &b.entry) || (b.is_arrival && self.is_goal(&a.exit)) {
            return Some(Vec::new());
        }
        let mut reached = self.extender.extend(&a.exit, &self.target(&b.entry), rng).reached;
        // Nothing comes behind an arrival: any state of the goal will do.
        if let Some(end) = reached.iter().position(|reached| b.is_arrival && self.is_goal(&reached.state)) {
            reached.truncate(end + 1);
            return Some(joined(reached));
        }
        let is_there = reached.last().is_some_and(|last| self.is_there(&last.state, &b.entry));
        is_there.then(|| joined(reached))
    }

    /// May what begins at `entry` go on from `end`?
    fn is_there(&self, end: &State<D>, entry: &State<D>) -> bool {
        end.robot == entry.robot && end.objects == entry.objects && self.m().may_go_on(&end.mode, &entry.mode)
    }

    /// The robot as in `like`, and all that is not carried where it is there.
    fn target(&self, like: &State<D>) -> PartialState<D> {
        let m = self.m();
        let carried = m.carried(&like.mode);
        let named = like.objects.iter().enumerate().map(|(i, at)| (ObjectId::new(i), at));
        let named = named.filter(|(id, _)| !carried.contains(ComponentId::Object(*id)));
        let target = PartialState::anywhere(m).with_robot(m, like.robot.clone());
        named.fold(target, |target, (id, at)| target.with_object(id, at.clone()))
    }
}
