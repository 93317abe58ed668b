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

use crate::cost::ExecutionCost;
use crate::domain::Domain;
use crate::extend::{ExtendOptions, Extender};
use crate::motion::{Section, Spliced};
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::reroute::Reroute;
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
        extender: Extender { options: &whole, reroute: None, ..*extender },
        may_turn: extender.reroute,
        cost,
        start: plan.start(),
        legs: Vec::new(),
        left: attempts,
        has_gained: false,
    };
    smoother.legs = plan.steps().iter().map(|step| smoother.leg(step.clone())).collect();
    smoother.drop_detours(rng);
    smoother.cut_corners(rng);
    let Smoother { legs, has_gained, .. } = smoother;
    has_gained.then(|| Plan::new(plan.start().clone(), legs.into_iter().map(|leg| leg.step).collect()))
}

/// A step, the parts of instances that it is made of, and the seconds that it takes.
struct Leg<D: Domain> {
    step: Step<D>,
    sections: Vec<Section<D>>,
    seconds: f64,
}

impl<D: Domain> Clone for Leg<D> {
    fn clone(&self) -> Self {
        Self { step: self.step.clone(), sections: self.sections.clone(), seconds: self.seconds }
    }
}

impl<D: Domain> Leg<D> {
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

/// A place on the plan: so many metres behind the beginning of a leg; 0 metres behind the last leg is the end.
#[derive(Debug, Clone, Copy)]
struct Cut {
    leg: usize,
    metres: f64,
}

impl Cut {
    const fn before(leg: usize) -> Self {
        Self { leg, metres: 0.0 }
    }
}

struct Smoother<'a, D: Domain> {
    extender: Extender<'a, D>,
    /// Knows which motions may turn aside.
    may_turn: Option<&'a dyn Reroute<D>>,
    cost: &'a dyn ExecutionCost<D>,
    start: &'a State<D>,
    legs: Vec<Leg<D>>,
    /// Attempts that are left.
    left: usize,
    has_gained: bool,
}

impl<D: Domain> Smoother<'_, D> {
    fn leg(&self, step: Step<D>) -> Leg<D> {
        let section = Section { instance: Arc::clone(&step.instance), from: 0.0, to: step.until };
        self.timed(step, vec![section])
    }

    fn timed(&self, step: Step<D>, sections: Vec<Section<D>>) -> Leg<D> {
        let m = self.extender.problem.domain();
        let from = step.instance.at(m, 0.0, self.start);
        let seconds = self.cost.seconds(m, &step.instance, &from, step.until);
        Leg { step, sections, seconds }
    }

    /// The step that runs `sections`, called, touching and moving what `like` does.
    fn through(&self, sections: Vec<Section<D>>, like: &Step<D>) -> Option<Leg<D>> {
        if let [Section { instance, from: 0.0, to }] = sections.as_slice() {
            let step = Step { instance: Arc::clone(instance), until: *to, primitive: like.primitive };
            return Some(self.timed(step, sections));
        }
        let spliced = Spliced::instance(sections.clone(), &like.instance)?;
        let step = Step { instance: Arc::new(spliced), until: 1.0, primitive: like.primitive };
        Some(self.timed(step, sections))
    }

    /// Between the ends of steps at which the objects stand alike, or within one transfer; the farthest apart first. Also
    /// between those so near that a move and what it leads to lie between them.
    fn drop_detours(&mut self, rng: &mut dyn Rng) {
        let mut span = self.legs.len();
        while span >= 2 {
            let mut first = 0;
            while first + span <= self.legs.len() {
                if !self.goes_on() {
                    return;
                }
                let (from, to) = (Cut::before(first), Cut::before(first + span));
                let stands = self.state_before(from.leg).objects == self.state_before(to.leg).objects;
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
            span = (span - 1).min(self.legs.len());
        }
    }

    /// The middle of the leg behind a cut, if it moves the robot alone.
    fn free_behind(&self, Cut { leg, .. }: Cut) -> Option<Cut> {
        let next = self.legs.get(leg).filter(|next| next.may_be_cut() && next.length() > 0.0)?;
        let is_robot_alone = next.step.instance.moves.is_subset_of(ComponentSet::ROBOT);
        is_robot_alone.then(|| Cut { leg, metres: next.length() / 2.0 })
    }

    /// The objects that go along with the robot all the way between two cuts, if all legs there move the same.
    fn carried(&self, from: Cut, to: Cut) -> Vec<ObjectId> {
        let end = if to.metres > 0.0 { to.leg + 1 } else { to.leg };
        let legs = self.legs.get(from.leg..end).unwrap_or_default();
        let Some(moves) = legs.first().map(|first| first.step.instance.moves) else { return Vec::new() };
        let is_one_transfer = legs.iter().all(|leg| leg.may_be_cut() && leg.step.instance.moves == moves);
        let ids = (0..self.start.objects.len()).map(ObjectId::new);
        ids.filter(|id| is_one_transfer && moves.contains(ComponentId::Object(*id))).collect()
    }

    /// Between places drawn by travel, near ones more often than far ones.
    fn cut_corners(&mut self, rng: &mut dyn Rng) {
        while self.goes_on() {
            let total_m = length(&self.legs);
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
        for (i, leg) in self.legs.iter().enumerate() {
            let length_m = leg.length();
            if left_m < length_m {
                let stays = leg.may_be_cut() && rng.random_bool(0.5);
                let nearest = Cut::before(if left_m < length_m / 2.0 { i } else { i + 1 });
                return if stays { Cut { leg: i, metres: left_m } } else { nearest };
            }
            left_m -= length_m;
        }
        Cut::before(self.legs.len())
    }

    fn state_before(&self, leg: usize) -> State<D> {
        let before = leg.checked_sub(1).and_then(|before| self.legs.get(before));
        before.map_or_else(|| self.start.clone(), |leg| leg.end(self.extender.problem.domain(), self.start))
    }

    /// One attempt to go another way from `from` to `to`; was it better?
    fn replace(&mut self, from: Cut, to: Cut, rng: &mut dyn Rng) -> bool {
        self.left = self.left.saturating_sub(1);
        let Some(legs) = self.rewritten(from, to, rng) else { return false };
        let is_better = legs.len() <= self.legs.len() && seconds(&legs) < seconds(&self.legs) - LEAST_GAIN_S;
        if is_better {
            self.legs = legs;
            self.has_gained = true;
        }
        is_better
    }

    /// All legs, those between the cuts new; `None` if the new ones do not arrive, or are no shorter.
    fn rewritten(&self, from: Cut, to: Cut, rng: &mut dyn Rng) -> Option<Vec<Leg<D>>> {
        if from.leg > to.leg || (from.leg == to.leg && from.metres >= to.metres) {
            return None;
        }
        let m = self.extender.problem.domain();
        let (before, _) = self.parts_of(from);
        let (until, after) = self.parts_of(to);
        let here = before.as_ref().map_or_else(|| self.state_before(from.leg), |leg| leg.end(m, self.start));
        let there = until.as_ref().map_or_else(|| self.state_before(to.leg), |leg| leg.end(m, self.start));
        let is_end = to.leg >= self.legs.len();
        // What is carried follows the robot: named, it would be set down.
        let named = (0..there.objects.len()).map(ObjectId::new).filter(|id| !self.carried(from, to).contains(id));
        let named = named.filter_map(|id| Some((id, there.object(id)?.clone())));
        let target = PartialState::anywhere(m).with_robot(m, there.robot.clone());
        let target = named.fold(target, |target, (id, at)| target.with_object(id, at));
        let old = self.legs.get(from.leg..to.leg)?;
        // What the cuts leave of their legs is not replaced.
        let kept_s = before.as_ref().map_or(0.0, |leg| leg.seconds);
        let old_s = seconds(old) + until.as_ref().map_or(0.0, |leg| leg.seconds) - kept_s;
        let arrives = |state: &State<D>| *state == there || is_end && self.is_goal(state);
        let new = self.way(&here, &target, arrives, old_s, rng)?;

        // The neighbours may be of the same kind as what is new.
        let first = from.leg.saturating_sub(1);
        let last = to.leg + usize::from(after.is_some());
        let behind = (last + 1).min(self.legs.len());
        let window = self.legs.get(first..from.leg)?.iter().cloned().chain(before).chain(new).chain(after);
        let window = self.woven(window.chain(self.legs.get(last..behind)?.iter().cloned()));
        let rest = self.legs.get(behind..)?.iter().cloned();
        Some(self.legs.get(..first)?.iter().cloned().chain(window).chain(rest).collect())
    }

    /// What the cut leg does before the cut and after it; `None` for nothing, and for a cut between two legs.
    fn parts_of(&self, cut: Cut) -> (Option<Leg<D>>, Option<Leg<D>>) {
        let leg = self.legs.get(cut.leg).filter(|_| cut.metres > 0.0);
        let parts = leg.and_then(|leg| Some((leg, leg.split(cut.metres)?)));
        let Some((leg, [before, after])) = parts else { return (None, None) };
        (self.through(before, &leg.step), self.through(after, &leg.step))
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
    ) -> Option<Vec<Leg<D>>> {
        if arrives(here) {
            return Some(Vec::new());
        }
        let mut reached = self.extender.extend(here, target, rng).reached;
        let last = reached.iter().position(|reached| arrives(&reached.state))?;
        reached.truncate(last + 1);
        let legs: Vec<_> = joined(reached).into_iter().map(|step| self.leg(step)).collect();
        // Joined to its neighbours it may take one start and stop less on either side.
        let pays = seconds(&legs) < old_s + 2.0 * self.cost.step_s();
        (pays && self.is_free(here, &legs)).then_some(legs)
    }

    fn is_free(&self, here: &State<D>, legs: &[Leg<D>]) -> bool {
        let (m, validity) = (self.extender.problem.domain(), self.extender.problem.validity());
        let mut here = here.clone();
        legs.iter().all(|Leg { step, .. }| {
            let turns = self.may_turn.is_some_and(|reroute| reroute.is_free_to_turn(m, &step.instance));
            let care = if turns { validity.most_care() } else { 0 };
            let free = validity.free_prefix_with(care, m, &step.instance, &here);
            step.instance.motion.at_into(m, step.until, &mut here);
            free.blame.is_none() || free.fraction >= step.until
        })
    }

    /// The same legs, those of one kind that follow on each other as one.
    fn woven(&self, legs: impl Iterator<Item = Leg<D>>) -> Vec<Leg<D>> {
        let mut woven: Vec<Leg<D>> = Vec::new();
        for leg in legs {
            match woven.last().and_then(|last| self.union(last, &leg)) {
                Some(union) => {
                    woven.pop();
                    woven.push(union);
                }
                None => woven.push(leg),
            }
        }
        woven
    }

    /// Both as one, if they are of one kind, in one mode, and free as one.
    fn union(&self, a: &Leg<D>, b: &Leg<D>) -> Option<Leg<D>> {
        let m = self.extender.problem.domain();
        let (p, q) = (&*a.step.instance, &*b.step.instance);
        let is_one_kind = p.primitive == q.primitive && p.moves == q.moves && a.may_be_cut() && b.may_be_cut();
        let like = touching_more(a, b).filter(|_| is_one_kind)?;
        let mode_of = |leg: &Leg<D>, share: f64| leg.step.instance.at(m, share * leg.step.until, self.start).mode;
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
fn touching_more<'a, D: Domain>(a: &'a Leg<D>, b: &'a Leg<D>) -> Option<&'a Leg<D>> {
    let contacts = |leg: &'a Leg<D>| &leg.step.instance.contacts;
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
fn length<D: Domain>(legs: &[Leg<D>]) -> f64 {
    legs.iter().map(Leg::length).sum()
}

/// Seconds of execution.
fn seconds<D: Domain>(legs: &[Leg<D>]) -> f64 {
    legs.iter().map(|leg| leg.seconds).sum()
}
