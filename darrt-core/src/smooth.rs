//! Less travel between states that a plan goes through.
//!
//! One rewrite does it all: cut the plan at two places, extend from the state at the first to the whole state at the second,
//! and put what arrives there, bit for bit, in the place of what lay between. Within one attachment that is a shortcut. Between
//! two moves of one kind it merges them. Where the objects stand at the second cut as at the first it drops a detour, or a
//! push and the push back. The rest of the plan stays as it is, and at its end only the goal counts.
//!
//! What is new is judged with the most [care](crate::validity::Validity::most_care) where it may turn aside: a shortcut that would
//! give up a margin that plans keep where they can is none. The verifier judges the whole.

use std::sync::Arc;

use rand::{Rng, RngExt};

use crate::cost::{ExecutionCost, arrival_seconds};
use crate::domain::Domain;
use crate::extend::{ExtendOptions, Extender};
use crate::local_repair::LocalRepair;
use crate::motion::{Section, Spliced};
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::shorten::joined;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Seconds below which a gain is none.
const LEAST_GAIN_S: f64 = 1e-9;
/// Steps in which two moves and what they lead to may become one move and that.
const NEAR: usize = 3;

/// A plan to the goal that takes fewer seconds than `plan` and no more steps, if one was found in so many `attempts`, an
/// extension each, and before the extender is interrupted. Not verified. The motions of `plan` must have been judged.
///
/// # Laws
/// Never more steps or seconds; pure but for `rng` and the interrupt.
///
/// # Source
/// Geraerts and Overmars, Creating high-quality paths for motion planning, 2007: shortcuts between random states of a path.
/// Here the shortcut is whatever the primitives propagate, so it may also move objects.
pub fn smooth<D: Domain>(
    extender: &Extender<'_, D>,
    cost: &dyn ExecutionCost<D>,
    plan: &Plan<D>,
    attempts: usize,
    rng: &mut dyn Rng,
) -> Option<Plan<D>> {
    // A shortcut goes the whole way, also where the search takes short steps; it is judged once it is known to be one. One
    // that needs a way around is none.
    let whole = ExtendOptions { step_m: None, defer: true, ..*extender.options };
    let mut smoother = Smoother {
        extender: Extender { options: &whole, local_repair: None, ..*extender },
        may_turn: extender.local_repair,
        cost,
        start: plan.start(),
        timed_steps: Vec::new(),
        left: attempts,
        has_gained: false,
    };
    smoother.timed_steps = plan.steps().iter().map(|step| smoother.timed_step(step.clone())).collect();
    smoother.drop_loops();
    smoother.drop_detours(rng);
    smoother.cut_corners(rng);
    let Smoother { timed_steps, has_gained, .. } = smoother;
    has_gained
        .then(|| Plan::new(plan.start().clone(), timed_steps.into_iter().map(|timed_step| timed_step.step).collect()))
}

/// A step, the parts of instances that it is made of, and the seconds that it takes.
struct TimedStep<D: Domain> {
    step: Step<D>,
    sections: Vec<Section<D>>,
    seconds: f64,
}

impl<D: Domain> Clone for TimedStep<D> {
    fn clone(&self) -> Self {
        Self { step: self.step.clone(), sections: self.sections.clone(), seconds: self.seconds }
    }
}

impl<D: Domain> TimedStep<D> {
    fn length(&self) -> f64 {
        self.step.instance.motion.length() * self.step.until
    }

    fn end(&self, m: &D, like: &State<D>) -> State<D> {
        self.step.instance.at(m, self.step.until, like)
    }

    /// May it be left, or joined, on the way? A push may not: it is one motion in one direction.
    fn may_be_cut(&self) -> bool {
        self.step.instance.reversible
    }

    /// The parts up to `metres` of its travel, and from there on; `None` if that is one of its ends.
    fn split(&self, metres: f64) -> Option<[Vec<Section<D>>; 2]> {
        let mut before = Vec::new();
        let mut left_m = metres;
        for (i, section) in self.sections.iter().enumerate() {
            let length_m = section.length();
            if left_m >= length_m {
                left_m -= length_m;
                before.push(section.clone());
                continue;
            }
            let cut = section.from + (section.to - section.from) * (left_m / length_m);
            let mut after = Vec::new();
            if cut > section.from {
                before.push(Section { to: cut, ..section.clone() });
            }
            after.push(Section { from: cut.max(section.from), ..section.clone() });
            after.extend(self.sections.iter().skip(i + 1).cloned());
            return Some([before, after]);
        }
        None
    }
}

/// A place on the plan: so many metres behind the beginning of a step; 0 metres behind the last step is the end.
#[derive(Debug, Clone, Copy)]
struct Cut {
    timed_step: usize,
    metres: f64,
}

impl Cut {
    const fn before(timed_step: usize) -> Self {
        Self { timed_step, metres: 0.0 }
    }
}

struct Smoother<'a, D: Domain> {
    extender: Extender<'a, D>,
    /// Knows which motions may turn aside.
    may_turn: Option<&'a dyn LocalRepair<D>>,
    cost: &'a dyn ExecutionCost<D>,
    start: &'a State<D>,
    timed_steps: Vec<TimedStep<D>>,
    /// Attempts that are left.
    left: usize,
    has_gained: bool,
}

impl<D: Domain> Smoother<'_, D> {
    fn timed_step(&self, step: Step<D>) -> TimedStep<D> {
        let section = Section { instance: Arc::clone(&step.instance), from: 0.0, to: step.until };
        self.timed(step, vec![section])
    }

    fn timed(&self, step: Step<D>, sections: Vec<Section<D>>) -> TimedStep<D> {
        let m = self.extender.problem.domain();
        let from = step.instance.at(m, 0.0, self.start);
        let seconds = self.cost.seconds(m, &step.instance, &from, step.until);
        TimedStep { step, sections, seconds }
    }

    /// The step that runs `sections`, called, touching and moving what `like` does.
    fn through(&self, sections: Vec<Section<D>>, like: &Step<D>) -> Option<TimedStep<D>> {
        if let [Section { instance, from: 0.0, to }] = sections.as_slice() {
            let step = Step { instance: Arc::clone(instance), until: *to, primitive: like.primitive };
            return Some(self.timed(step, sections));
        }
        let spliced = Spliced::instance(sections.clone(), &like.instance)?;
        let step = Step { instance: Arc::new(spliced), until: 1.0, primitive: like.primitive };
        Some(self.timed(step, sections))
    }

    /// Leaves out what ends where it began: an approach and the retreat from it. Costs no attempt.
    fn drop_loops(&mut self) {
        let m = self.extender.problem.domain();
        let states: Vec<_> = (0..=self.timed_steps.len()).map(|i| self.state_before(i)).collect();
        let end = self.timed_steps.len();
        let is_as = |here: &State<D>, later: usize| {
            states.get(later).is_some_and(|there| {
                let is_alike = here.robot == there.robot && here.objects == there.objects;
                is_alike && if later == end { self.is_goal(here) } else { m.may_go_on(&here.mode, &there.mode) }
            })
        };
        let (mut kept, mut at) = (Vec::new(), 0);
        while let (Some(timed_step), Some(here)) = (self.timed_steps.get(at), states.get(at)) {
            if let Some(later) = (at + 1..=end).rev().find(|later| is_as(here, *later)) {
                at = later;
            } else {
                kept.push(timed_step.clone());
                at += 1;
            }
        }
        if kept.len() < end {
            self.timed_steps = self.woven(kept.into_iter());
            self.has_gained = true;
        }
    }

    /// Between the ends of steps at which the objects stand alike, or within one transfer; the farthest apart first. Also
    /// between those so near that a move and what it leads to lie between them.
    fn drop_detours(&mut self, rng: &mut dyn Rng) {
        let mut span = self.timed_steps.len();
        while span >= 2 {
            let mut first = 0;
            while first + span <= self.timed_steps.len() {
                if !self.goes_on() {
                    return;
                }
                let (from, to) = (Cut::before(first), Cut::before(first + span));
                let stands = self.state_before(from.timed_step).objects == self.state_before(to.timed_step).objects;
                // Behind a push the hand still stands at the object, where nothing but a push leads.
                let behind = self.free_behind(to);
                if stands || !self.carried(from, to).is_empty() {
                    let is_better = self.replace(from, to, rng);
                    if let Some(behind) = behind.filter(|_| stands && !is_better) {
                        self.replace(from, behind, rng);
                    }
                } else if span == NEAR {
                    self.replace(from, behind.unwrap_or(to), rng);
                }
                first += 1;
            }
            span = (span - 1).min(self.timed_steps.len());
        }
    }

    /// The middle of the step behind a cut, if it moves the robot alone.
    fn free_behind(&self, Cut { timed_step, .. }: Cut) -> Option<Cut> {
        let next = self.timed_steps.get(timed_step).filter(|next| next.may_be_cut() && next.length() > 0.0)?;
        let is_robot_alone = next.step.instance.moves.is_subset_of(ComponentSet::ROBOT);
        is_robot_alone.then(|| Cut { timed_step, metres: next.length() / 2.0 })
    }

    /// The objects that go along with the robot all the way between two cuts, if all steps there move the same.
    fn carried(&self, from: Cut, to: Cut) -> Vec<ObjectId> {
        let end = if to.metres > 0.0 { to.timed_step + 1 } else { to.timed_step };
        let timed_steps = self.timed_steps.get(from.timed_step..end).unwrap_or_default();
        let Some(moves) = timed_steps.first().map(|first| first.step.instance.moves) else { return Vec::new() };
        let is_one_transfer =
            timed_steps.iter().all(|timed_step| timed_step.may_be_cut() && timed_step.step.instance.moves == moves);
        let ids = (0..self.start.objects.len()).map(ObjectId::new);
        ids.filter(|id| is_one_transfer && moves.contains(ComponentId::Object(*id))).collect()
    }

    /// Between places drawn by travel, near ones more often than far ones.
    fn cut_corners(&mut self, rng: &mut dyn Rng) {
        while self.goes_on() {
            let total_m = length(&self.timed_steps);
            let from_m = rng.random_range(0.0..1.0) * total_m;
            let share: f64 = rng.random_range(0.0..1.0);
            let to_m = from_m + share * share * (total_m - from_m);
            let [from, to] = [from_m, to_m].map(|metres| self.cut_at(metres, rng));
            self.replace(from, to, rng);
        }
    }

    fn goes_on(&self) -> bool {
        self.left > 0 && self.extender.interrupt.stop().is_none()
    }

    /// The place after `metres` of the plan; an end of the step where it may not be cut, and sometimes elsewhere.
    fn cut_at(&self, metres: f64, rng: &mut dyn Rng) -> Cut {
        let mut left_m = metres;
        for (i, timed_step) in self.timed_steps.iter().enumerate() {
            let length_m = timed_step.length();
            if left_m < length_m {
                let stays = timed_step.may_be_cut() && rng.random_bool(0.5);
                let nearest = Cut::before(if left_m < length_m / 2.0 { i } else { i + 1 });
                return if stays { Cut { timed_step: i, metres: left_m } } else { nearest };
            }
            left_m -= length_m;
        }
        Cut::before(self.timed_steps.len())
    }

    fn state_before(&self, timed_step: usize) -> State<D> {
        let before = timed_step.checked_sub(1).and_then(|before| self.timed_steps.get(before));
        before
            .map_or_else(|| self.start.clone(), |timed_step| timed_step.end(self.extender.problem.domain(), self.start))
    }

    /// One attempt to go another way from `from` to `to`; was it better?
    fn replace(&mut self, from: Cut, to: Cut, rng: &mut dyn Rng) -> bool {
        self.left = self.left.saturating_sub(1);
        let Some(timed_steps) = self.rewritten(from, to, rng) else { return false };
        let is_better = timed_steps.len() <= self.timed_steps.len()
            && seconds(&timed_steps) < seconds(&self.timed_steps) - LEAST_GAIN_S
            && self.arrivals_s(&timed_steps) <= self.arrivals_s(&self.timed_steps);
        if is_better {
            self.timed_steps = timed_steps;
            self.has_gained = true;
        }
        is_better
    }

    fn arrivals_s(&self, timed_steps: &[TimedStep<D>]) -> f64 {
        let steps: Vec<_> = timed_steps.iter().map(|timed_step| timed_step.step.clone()).collect();
        arrival_seconds(self.cost, self.extender.problem.domain(), self.start, &steps)
    }

    /// All steps, those between the cuts new; `None` if the new ones do not arrive, or are no shorter.
    fn rewritten(&self, from: Cut, to: Cut, rng: &mut dyn Rng) -> Option<Vec<TimedStep<D>>> {
        if from.timed_step > to.timed_step || (from.timed_step == to.timed_step && from.metres >= to.metres) {
            return None;
        }
        let m = self.extender.problem.domain();
        let (before, _) = self.parts_of(from);
        let (until, after) = self.parts_of(to);
        let here = before
            .as_ref()
            .map_or_else(|| self.state_before(from.timed_step), |timed_step| timed_step.end(m, self.start));
        let there =
            until.as_ref().map_or_else(|| self.state_before(to.timed_step), |timed_step| timed_step.end(m, self.start));
        let is_end = to.timed_step >= self.timed_steps.len();
        // What is carried follows the robot: named, it would be set down.
        let named = (0..there.objects.len()).map(ObjectId::new).filter(|id| !self.carried(from, to).contains(id));
        let named = named.filter_map(|id| Some((id, there.object(id)?.clone())));
        let target = PartialState::anywhere(m).with_robot(m, there.robot.clone());
        let target = named.fold(target, |target, (id, at)| target.with_object(id, at));
        let old = self.timed_steps.get(from.timed_step..to.timed_step)?;
        // What the cuts leave of their steps is not replaced.
        let kept_s = before.as_ref().map_or(0.0, |timed_step| timed_step.seconds);
        let old_s = seconds(old) + until.as_ref().map_or(0.0, |timed_step| timed_step.seconds) - kept_s;
        let arrives = |state: &State<D>| *state == there || is_end && self.is_goal(state);
        let new = self.way(&here, &target, arrives, old_s, rng)?;

        // The neighbours may be of the same kind as what is new.
        let first = from.timed_step.saturating_sub(1);
        let last = to.timed_step + usize::from(after.is_some());
        let behind = (last + 1).min(self.timed_steps.len());
        let window =
            self.timed_steps.get(first..from.timed_step)?.iter().cloned().chain(before).chain(new).chain(after);
        let window = self.woven(window.chain(self.timed_steps.get(last..behind)?.iter().cloned()));
        let rest = self.timed_steps.get(behind..)?.iter().cloned();
        Some(self.timed_steps.get(..first)?.iter().cloned().chain(window).chain(rest).collect())
    }

    /// What the cut step does before the cut and after it; `None` for nothing, and for a cut between two steps.
    fn parts_of(&self, cut: Cut) -> (Option<TimedStep<D>>, Option<TimedStep<D>>) {
        let timed_step = self.timed_steps.get(cut.timed_step).filter(|_| cut.metres > 0.0);
        let parts = timed_step.and_then(|timed_step| Some((timed_step, timed_step.split(cut.metres)?)));
        let Some((timed_step, [before, after])) = parts else { return (None, None) };
        (self.through(before, &timed_step.step), self.through(after, &timed_step.step))
    }

    fn is_goal(&self, state: &State<D>) -> bool {
        self.extender.problem.goal().is_satisfied(self.extender.problem.domain(), state)
    }

    /// Legs from `here` towards `target`, up to the first state where `arrives` says so, if they take less than `old_s` and
    /// are free.
    fn way(
        &self,
        here: &State<D>,
        target: &PartialState<D>,
        arrives: impl Fn(&State<D>) -> bool,
        old_s: f64,
        rng: &mut dyn Rng,
    ) -> Option<Vec<TimedStep<D>>> {
        if arrives(here) {
            return Some(Vec::new());
        }
        let mut reached = self.extender.extend(here, target, rng).reached;
        let last = reached.iter().position(|reached| arrives(&reached.state))?;
        reached.truncate(last + 1);
        let timed_steps: Vec<_> = joined(reached).into_iter().map(|step| self.timed_step(step)).collect();
        // Joined to its neighbours it may take one start and stop less on either side.
        let pays = seconds(&timed_steps) < old_s + 2.0 * self.cost.step_s();
        (pays && self.is_free(here, &timed_steps)).then_some(timed_steps)
    }

    fn is_free(&self, here: &State<D>, timed_steps: &[TimedStep<D>]) -> bool {
        let (m, validity) = (self.extender.problem.domain(), self.extender.problem.validity());
        let mut here = here.clone();
        timed_steps.iter().all(|TimedStep { step, .. }| {
            let turns = self.may_turn.is_some_and(|local_repair| local_repair.is_free_to_turn(m, &step.instance));
            let care = if turns { validity.most_care() } else { 0 };
            let free = validity.free_prefix_with(care, m, &step.instance, &here);
            step.instance.motion.at_into(m, step.until, &mut here);
            free.blame.is_none() || free.fraction >= step.until
        })
    }

    /// The same steps, those of one kind that follow on each other as one.
    fn woven(&self, timed_steps: impl Iterator<Item = TimedStep<D>>) -> Vec<TimedStep<D>> {
        let mut woven: Vec<TimedStep<D>> = Vec::new();
        for timed_step in timed_steps {
            match woven.last().and_then(|last| self.union(last, &timed_step)) {
                Some(union) => {
                    woven.pop();
                    woven.push(union);
                }
                None => woven.push(timed_step),
            }
        }
        woven
    }

    /// Both as one, if they are of one kind, in one mode, and free as one.
    fn union(&self, a: &TimedStep<D>, b: &TimedStep<D>) -> Option<TimedStep<D>> {
        let m = self.extender.problem.domain();
        let (p, q) = (&*a.step.instance, &*b.step.instance);
        let is_one_kind = p.primitive == q.primitive && p.moves == q.moves && a.may_be_cut() && b.may_be_cut();
        let like = touching_more(a, b).filter(|_| is_one_kind)?;
        let mode_of = |timed_step: &TimedStep<D>, share: f64| {
            timed_step.step.instance.at(m, share * timed_step.step.until, self.start).mode
        };
        let junction = a.end(m, self.start);
        let is_one_mode = mode_of(a, 0.5) == junction.mode && junction.mode == mode_of(b, 0.5);
        let begins_there = b.step.instance.at(m, 0.0, self.start) == junction;
        if !is_one_mode || !begins_there {
            return None;
        }
        let union = self.through(a.sections.iter().chain(&b.sections).cloned().collect(), &like.step)?;
        let from = a.step.instance.at(m, 0.0, self.start);
        let free = self.extender.problem.validity().free_prefix(m, &union.step.instance, &from);
        (free.blame.is_none() && free.fraction >= 1.0).then_some(union)
    }
}

/// The one that may touch what the other may; `None` if neither is known to.
fn touching_more<'a, D: Domain>(a: &'a TimedStep<D>, b: &'a TimedStep<D>) -> Option<&'a TimedStep<D>> {
    let contacts = |timed_step: &'a TimedStep<D>| &timed_step.step.instance.contacts;
    let nothing = D::Contacts::default();
    if contacts(a) == contacts(b) || *contacts(a) == nothing {
        Some(b)
    } else if *contacts(b) == nothing {
        Some(a)
    } else {
        None
    }
}

/// Metres of travel.
fn length<D: Domain>(timed_steps: &[TimedStep<D>]) -> f64 {
    timed_steps.iter().map(TimedStep::length).sum()
}

/// Seconds of execution.
fn seconds<D: Domain>(timed_steps: &[TimedStep<D>]) -> f64 {
    timed_steps.iter().map(|timed_step| timed_step.seconds).sum()
}
