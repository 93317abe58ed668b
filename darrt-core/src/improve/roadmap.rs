//! The manipulations that are known, and the ways between them.
//!
//! A vertex is a manipulation: where the robot begins it, and where it stands afterwards. Two are linked where the second
//! begins on the leaf on which the first ends; what the way between them costs is guessed until somebody wants to take it,
//! and only the cheapest chain is judged.
//!
//! # Source
//! Dellin and Srinivasa, A unifying formalism for shortest path problems with expensive edge evaluations via lazy best-first
//! search over paths with edge selectors (`LazySP`), ICAPS 2016.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

use crate::cost::ExecutionCost;
use crate::domain::Domain;
use crate::extend::Extender;
use crate::plan::Step;
use crate::state::State;

use super::experience::{Experience, WaysAround};
use super::pieces::{is_one_leaf, pieces, states};

/// What is known of whether something is free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Nothing.
    Open,
    /// Where it is blocked it may turn aside.
    Supposed,
    /// Every motion is free.
    Free,
    /// Some motion is blocked and may not turn aside, or finds no way around.
    Blocked,
}

/// Index of a vertex.
pub(super) type Id = usize;

/// The vertex at which every chain begins: the start.
pub(super) const START: Id = 0;

/// Approach and change of leaf; without steps: the start, or an arrival in the goal.
pub(super) struct Manipulation<D: Domain> {
    pub(super) entry: State<D>,
    pub(super) steps: Vec<Step<D>>,
    pub(super) exit: State<D>,
    pub(super) seconds: f64,
    /// Those of them that stand for care that is given up.
    pub(super) careless_s: f64,
    pub(super) verdict: Verdict,
    pub(super) is_arrival: bool,
    links: Vec<Link<D>>,
    begins_on: usize,
    ends_on: usize,
}

/// From the exit of one manipulation to the entry of another.
struct Link<D: Domain> {
    to: Id,
    way: Way<D>,
    /// That which counts more, where there are two: the way that a plan takes may lead to and fro, and a straight one that is
    /// only guessed may be blocked.
    other: Option<Box<Way<D>>>,
}

/// A way from the exit of one manipulation to the entry of another.
pub(super) struct Way<D: Domain> {
    pub(super) seconds: f64,
    /// Those of them that stand for care that is given up.
    pub(super) careless_s: f64,
    pub(super) verdict: Verdict,
    /// `None`: it is guessed that there is one.
    pub(super) steps: Option<Vec<Step<D>>>,
    /// By step: is it blocked?
    pub(super) blocked: Vec<bool>,
}

/// An entry of the queue of [`Roadmap::costs`]: the cheapest is the greatest, of equal ones that of the lowest index.
struct Reached {
    seconds: f64,
    id: Id,
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.seconds.total_cmp(&self.seconds).then(other.id.cmp(&self.id))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

/// Manipulations and links; see the module.
pub(super) struct Roadmap<'a, D: Domain> {
    pub(super) extender: Extender<'a, D>,
    pub(super) cost: &'a dyn ExecutionCost<D>,
    pub(super) known: Vec<Manipulation<D>>,
    /// By leaf: a state of it.
    leaves: Vec<State<D>>,
    /// How often it has been tried to get from a leaf to another one, or to the goal.
    pub(super) tries: BTreeMap<(usize, Option<usize>), u32>,
    /// Of straight ways that are blocked.
    pub(super) around: Experience,
    /// Of all ways.
    pub(super) any: Experience,
    /// Of what is supposed.
    pub(super) ways_around: WaysAround,
}

impl<D: Domain> Manipulation<D> {
    /// The leaf on which it begins, and that on which it ends.
    pub(super) fn leaves(&self) -> [usize; 2] {
        [self.begins_on, self.ends_on]
    }
}

impl<D: Domain> Way<D> {
    /// Nothing is known of it but perhaps its steps.
    fn open(seconds: f64, steps: Option<Vec<Step<D>>>) -> Self {
        Self { seconds, careless_s: 0.0, verdict: Verdict::Open, steps, blocked: Vec::new() }
    }

    /// The seconds that it counts as, if ways around are found with this chance.
    fn counted_s(&self, chance: f64) -> f64 {
        match self.verdict {
            Verdict::Blocked => f64::INFINITY,
            Verdict::Supposed => self.seconds / chance,
            Verdict::Open | Verdict::Free => self.seconds,
        }
    }
}

impl<'a, D: Domain> Roadmap<'a, D> {
    /// Only the start.
    pub(super) fn new(extender: Extender<'a, D>, cost: &'a dyn ExecutionCost<D>, start: &State<D>) -> Self {
        let (around, any) = (Experience::of_ways_around(), Experience::of_ways());
        let (known, leaves, tries) = (Vec::new(), Vec::new(), BTreeMap::new());
        let ways_around = WaysAround::default();
        let mut roadmap = Self { extender, cost, known, leaves, tries, around, any, ways_around };
        roadmap.add(start.clone(), Vec::new(), start.clone(), false);
        roadmap
    }

    pub(super) fn m(&self) -> &'a D {
        self.extender.problem.domain()
    }

    pub(super) fn is_goal(&self, state: &State<D>) -> bool {
        self.extender.problem.goal().is_satisfied(self.m(), state)
    }

    /// Takes in the manipulations of a chain that begins at `here`, the exit of `from` if it is one, up to the goal if it
    /// gets there.
    pub(super) fn add_chain(&mut self, from: Option<Id>, here: &State<D>, steps: &[Step<D>]) {
        let m = self.m();
        let mut states = states(m, here, steps);
        let goal = states.iter().position(|state| self.is_goal(state));
        let steps = goal.map_or(steps, |end| steps.get(..end).unwrap_or(steps));
        states.truncate(steps.len() + 1);
        let (mut at, mut begun) = (from, 0);
        for piece in pieces(m, steps, &states) {
            let (Some(entry), Some(exit)) = (states.get(piece.entry), states.get(piece.until)) else { break };
            let part = |from, to| steps.get(from..to).unwrap_or_default().to_vec();
            let lead = part(piece.from, piece.entry);
            let id = self.add(entry.clone(), part(piece.entry, piece.until), exit.clone(), false);
            if let Some(at) = at {
                self.lead(at, id, lead);
            }
            (at, begun) = (Some(id), piece.until);
        }
        if let Some(end) = goal.and_then(|_| states.last()) {
            let lead = steps.get(begun..).unwrap_or_default().to_vec();
            let id = self.add(end.clone(), Vec::new(), end.clone(), true);
            if let Some(at) = at {
                self.lead(at, id, lead);
            }
        }
    }

    /// Seconds of a chain of steps.
    pub(super) fn seconds(&self, here: &State<D>, steps: &[Step<D>]) -> f64 {
        let m = self.m();
        let mut here = here.clone();
        let mut seconds = 0.0;
        for step in steps {
            seconds += self.cost.seconds(m, &step.instance, &here, step.until);
            step.instance.motion.at_into(m, step.until, &mut here);
        }
        seconds
    }

    fn leaf_of(&mut self, state: &State<D>) -> usize {
        let m = self.m();
        let known = self.leaves.iter().position(|leaf| is_one_leaf(m, leaf, state));
        known.unwrap_or_else(|| {
            self.leaves.push(state.clone());
            self.leaves.len() - 1
        })
    }

    /// A new vertex, with guessed links from and to those on its leaves.
    fn add(&mut self, entry: State<D>, steps: Vec<Step<D>>, exit: State<D>, is_arrival: bool) -> Id {
        let (begins_on, ends_on) = (self.leaf_of(&entry), self.leaf_of(&exit));
        let id = self.known.len();
        let guessed_s = |from: &State<D>, at: &State<D>, end: &State<D>| {
            let m = self.extender.problem.domain();
            self.any.ratio() * self.cost.between(m, from, at) + self.cost.arrival(m, from, at, end)
        };
        let link = |to: Id, seconds: f64| Link { to, way: Way::open(seconds, None), other: None };
        let behind = self.known.iter().enumerate().skip(1).filter(|(_, next)| next.begins_on == ends_on);
        let onward = behind.map(|(to, next)| {
            // To arrive the robot need not go where it did on another plan.
            link(to, if next.is_arrival { 0.0 } else { guessed_s(&exit, &next.entry, &next.exit) })
        });
        let links = onward.collect();
        let before = self.known.iter().enumerate().filter(|(_, last)| last.ends_on == begins_on && !last.is_arrival);
        let to_it: Vec<_> = before.map(|(at, last)| (at, link(id, guessed_s(&last.exit, &entry, &exit)))).collect();
        for (at, link) in to_it {
            if let Some(last) = self.known.get_mut(at) {
                last.links.push(link);
            }
        }
        let seconds = self.seconds(&entry, &steps);
        let (careless_s, verdict) = (0.0, if steps.is_empty() { Verdict::Free } else { Verdict::Open });
        self.known.push(Manipulation {
            entry,
            steps,
            exit,
            seconds,
            careless_s,
            verdict,
            is_arrival,
            links,
            begins_on,
            ends_on,
        });
        id
    }

    /// The way from `a` to `b` by `steps`, of which nothing is known.
    pub(super) fn way_by(&self, a: Id, b: Id, steps: Vec<Step<D>>) -> Way<D> {
        let seconds = self.known.get(a).map_or(0.0, |a| self.seconds(&a.exit, &steps));
        Way::open(seconds + self.arrival_s(a, b), Some(steps))
    }

    /// A chain goes from `a` to `b` by `steps`: that way, or, if it seems that there is a quicker one, first that.
    fn lead(&mut self, a: Id, b: Id, steps: Vec<Step<D>>) {
        let way = self.way_by(a, b, steps);
        if let Some(link) = self.link_mut(a, b) {
            if way.seconds <= link.way.seconds {
                link.way = way;
            } else {
                link.other = Some(Box::new(way));
            }
        }
    }

    /// More is known of the way that is taken from `a` to `b`; `None`: it is blocked.
    pub(super) fn know(&mut self, a: Id, b: Id, way: Option<Way<D>>) {
        if let Some(link) = self.link_mut(a, b) {
            match way {
                Some(way) => link.way = way,
                None => link.way.verdict = Verdict::Blocked,
            }
        }
        self.settle(a, b);
    }

    /// Of two ways from `a` to `b` that is taken which counts less.
    fn settle(&mut self, a: Id, b: Id) {
        let Some(chance) = self.known.get(a).map(|a| self.ways_around.chance(a.ends_on)) else { return };
        let Some(link) = self.link_mut(a, b) else { return };
        if let Some(other) = link.other.as_mut().filter(|other| other.counted_s(chance) < link.way.counted_s(chance)) {
            std::mem::swap(&mut link.way, other);
        }
    }

    /// Seconds that `b` costs more because the robot comes from `a`.
    pub(super) fn arrival_s(&self, a: Id, b: Id) -> f64 {
        let (Some(a), Some(b)) = (self.known.get(a), self.known.get(b)) else { return 0.0 };
        self.cost.arrival(self.m(), &a.exit, &b.entry, &b.exit)
    }

    /// The way that is taken to cost least.
    pub(super) fn way_of(&self, a: Id, b: Id) -> Option<&Way<D>> {
        self.known.get(a)?.links.iter().find(|link| link.to == b).map(|link| &link.way)
    }

    fn link_mut(&mut self, a: Id, b: Id) -> Option<&mut Link<D>> {
        self.known.get_mut(a)?.links.iter_mut().find(|link| link.to == b)
    }

    /// By vertex: the seconds until its exit on the cheapest chain from the start over what is not blocked, and the vertex
    /// before it. Infinite where there is none. What is only supposed counts the more, the less often ways around were found:
    /// else one after the other is looked for, in vain, while a plan that is free waits.
    fn costs(&self) -> Vec<(f64, Id)> {
        let mut best = vec![(f64::INFINITY, START); self.known.len()];
        if let Some(start) = best.first_mut() {
            start.0 = 0.0;
        }
        let mut open = BinaryHeap::from([Reached { seconds: 0.0, id: START }]);
        while let Some(Reached { seconds, id }) = open.pop() {
            if best.get(id).is_none_or(|known| known.0 < seconds) {
                continue;
            }
            let Some(here) = self.known.get(id) else { continue };
            let here_chance = self.ways_around.chance(here.ends_on);
            for link in &here.links {
                let next = self.known.get(link.to).filter(|next| next.verdict != Verdict::Blocked);
                let Some(next) = next else { continue };
                let through = seconds + link.way.counted_s(here_chance) + next.seconds;
                if let Some(slot) = best.get_mut(link.to)
                    && through < slot.0
                {
                    *slot = (through, id);
                    open.push(Reached { seconds: through, id: link.to });
                }
            }
        }
        best
    }

    /// The arrival with the cheapest chain.
    fn best_arrival(&self, costs: &[(f64, Id)]) -> Option<Id> {
        let arrivals = self.known.iter().enumerate().filter(|(_, known)| known.is_arrival);
        let timed =
            arrivals.filter_map(|(id, _)| Some((id, costs.get(id)?.0))).filter(|(_, seconds)| seconds.is_finite());
        timed.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).map(|(id, _)| id)
    }

    /// The cheapest chain from the start to an arrival; see [`Roadmap::costs`].
    pub(super) fn cheapest(&self) -> Option<Vec<Id>> {
        let costs = self.costs();
        chain_to(&costs, self.best_arrival(&costs)?)
    }

    /// What the care costs that a chain gives up, as far as it has been judged, seconds.
    pub(super) fn careless_s(&self, chain: &[Id]) -> f64 {
        let pairs = chain.iter().zip(chain.iter().skip(1));
        let of = |(a, b): (&Id, &Id)| {
            let link_s = self.way_of(*a, *b).map_or(0.0, |way| way.careless_s);
            link_s + self.known.get(*b).map_or(0.0, |known| known.careless_s)
        };
        pairs.map(of).sum()
    }

    /// What a chain of vertices does, as far as its ways are known.
    pub(super) fn steps(&self, chain: &[Id]) -> Option<Vec<Step<D>>> {
        let mut steps = Vec::new();
        for (a, b) in chain.iter().zip(chain.iter().skip(1)) {
            steps.extend(self.way_of(*a, *b)?.steps.as_ref()?.iter().cloned());
            steps.extend(self.known.get(*b)?.steps.iter().cloned());
        }
        Some(steps)
    }
}

/// The chain from the start to `last`, by what [`Roadmap::costs`] says.
fn chain_to(costs: &[(f64, Id)], last: Id) -> Option<Vec<Id>> {
    let mut chain = vec![last];
    let mut at = last;
    while at != START {
        at = costs.get(at)?.1;
        chain.push(at);
    }
    chain.reverse();
    Some(chain)
}
