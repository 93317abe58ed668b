//! More manipulations for a roadmap, drawn where they promise most.
//!
//! A draw is one extension from a placement of the objects on the cheapest chain to a later one, or to the goal. What it may
//! gain is at most what the chain costs between the two, and on to where the next manipulation begins, less the cheapest
//! manipulation that is known. Draws that were made before make the next one between the same placements promise less.
//!
//! # Source
//! Gammell, Srinivasa and Barfoot, Informed RRT*, IROS 2014: only what may still improve the solution is worth looking at.

use rand::{Rng, RngExt};

use super::roadmap::{Id, Roadmap, START};
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::shorten::joined;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

/// What one draw makes of the hope for the next one between the same placements.
const HOPE_LEFT: f64 = 0.6;
/// How much less is hoped for where manipulations are to be left out: when the plan was made shorter that was tried.
const HOPE_OF_FEWER: f64 = 0.25;

/// Seconds below which a hope is none.
const LEAST_HOPE_S: f64 = 0.05;
/// Share of the draws that are made from where the robot really stands.
const FROM_THERE: f64 = 0.25;
/// Share of the others for which it stands towards what comes behind them; else towards what they replace.
const TOWARDS_NEXT: f64 = 0.5;
/// Share of the others for which it stands all the way there.
const ALL_THE_WAY: f64 = 0.75;

/// A draw: from one vertex of a chain to what another one leads to, both by their place in the chain.
#[derive(Debug, Clone, Copy)]
struct Draw {
    from: usize,
    to: usize,
}

/// What is hoped for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Hope {
    /// Less time.
    LessTime,
    /// More care: of the chain as it was judged only what costs seconds because care is given up is drawn anew.
    MoreCare,
}

impl<D: Domain> Roadmap<'_, D> {
    /// The draw that promises most, and, where the cost asks for one, a stopover besides; `false` if there is none.
    pub(super) fn draw(&mut self, hope: Hope, rng: &mut dyn Rng) -> bool {
        let Some(chain) = self.cheapest() else { return false };
        if hope == Hope::LessTime {
            self.stop_over(&chain, rng);
        }
        let Some(draw) = self.most_promising(&chain, hope) else { return false };
        let Some(key) = self.key(&chain, draw) else { return false };
        *self.tries.entry(key).or_default() += 1;
        self.extend(&chain, draw, rng);
        true
    }

    /// The leaves of a draw: that from which it is made, and that to which it leads, if not to the goal.
    fn key(&self, chain: &[Id], draw: Draw) -> Option<(usize, Option<usize>)> {
        let [from, to] = [draw.from, draw.to].map(|at| chain.get(at).and_then(|id| self.known.get(*id)));
        let (from, to) = (from?, to?);
        Some((from.leaves()[1], (!to.is_arrival).then(|| to.leaves()[1])))
    }

    fn most_promising(&self, chain: &[Id], hope: Hope) -> Option<Draw> {
        let counts = |seconds: f64, careless_s: f64| match hope {
            Hope::LessTime => seconds,
            Hope::MoreCare => careless_s,
        };
        // By place in the chain: the seconds up to its exit, and on to where the next one begins.
        let (mut until_s, mut onward_s) = (vec![0.0], Vec::new());
        let mut least_s = f64::INFINITY;
        let mut seconds = 0.0;
        for (a, b) in chain.iter().zip(chain.iter().skip(1)) {
            let next = self.known.get(*b)?;
            let (way, next_s) = (self.way_of(*a, *b)?, counts(next.seconds, next.careless_s));
            seconds += counts(way.seconds, way.careless_s);
            onward_s.push(seconds);
            seconds += next_s;
            until_s.push(seconds);
            if !next.is_arrival {
                least_s = least_s.min(next_s);
            }
        }
        onward_s.push(seconds);
        let least_s = if least_s.is_finite() { least_s } else { 0.0 };
        let mut best: Option<(f64, Draw)> = None;
        for (from, begun_s) in until_s.iter().enumerate() {
            // How many manipulations it would replace by one extension.
            let mut replaced = 0_u32;
            for (to, ended_s) in onward_s.iter().enumerate().skip(from + 1) {
                let end = self.known.get(*chain.get(to)?)?;
                // Nobody can ask for a grasp: what leads to one is drawn together with what comes of it.
                if !end.is_arrival && !self.m().carried(&end.exit.mode).is_empty() {
                    continue;
                }
                let tries = self.tries.get(&self.key(chain, Draw { from, to })?).copied().unwrap_or(0);
                let hope = HOPE_LEFT.powi(i32::try_from(tries).unwrap_or(i32::MAX));
                let hope = if replaced > 0 { hope * HOPE_OF_FEWER } else { hope };
                let hope_s = (ended_s - begun_s - least_s) * hope;
                if hope_s > LEAST_HOPE_S && best.is_none_or(|best| hope_s > best.0) {
                    best = Some((hope_s, Draw { from, to }));
                }
                replaced += 1;
            }
        }
        best.map(|(_, draw)| draw)
    }

    /// Makes the draw, and takes in what it leads to if that is what was wanted.
    fn extend(&mut self, chain: &[Id], draw: Draw, rng: &mut dyn Rng) -> Option<()> {
        let problem = self.extender.problem;
        let from = *chain.get(draw.from)?;
        let end = self.known.get(*chain.get(draw.to)?)?;
        let target =
            if end.is_arrival { problem.goal().sample(problem.domain(), rng)? } else { self.placement(&end.exit) };
        let (is_goal, hint) = (end.is_arrival, self.hinted(chain, draw, rng));
        let here = hint.clone().map_or_else(|| self.known.get(from).map(|known| known.exit.clone()), Some)?;
        let extension = self.extender.extend(&here, &target, rng);
        let arrives = extension.reached.iter().any(|reached| self.is_goal(&reached.state));
        if arrives || (extension.is_met && !is_goal) {
            let from = hint.is_none().then_some(from);
            self.add_chain(from, &here, &joined(extension.reached));
        }
        Some(())
    }

    /// A state to draw from in which the robot stands elsewhere: somewhere on the straight line to where it stands for the
    /// next manipulation, or for the one behind the draw. `None`: it shall stand where it does; so it does where something is
    /// carried.
    fn hinted(&self, chain: &[Id], draw: Draw, rng: &mut dyn Rng) -> Option<State<D>> {
        let m = self.m();
        let here = &self.known.get(*chain.get(draw.from)?)?.exit;
        let next = self.known.get(*chain.get(draw.from + 1)?)?;
        if !m.carried(&here.mode).is_empty() || next.is_arrival || rng.random_bool(FROM_THERE) {
            return None;
        }
        let behind = chain.get(draw.to + 1).and_then(|id| self.known.get(*id));
        let towards = behind.filter(|_| rng.random_bool(TOWARDS_NEXT)).unwrap_or(next);
        let share = if rng.random_bool(ALL_THE_WAY) { 1.0 } else { rng.random_range(0.0..1.0) };
        // The hand is free there.
        let robot = m.robot().interpolate(&here.robot, &towards.entry.robot, share);
        Some(State { robot, ..next.entry.clone() })
    }

    /// The objects that have been moved by then, where they are.
    pub(super) fn placement(&self, at: &State<D>) -> PartialState<D> {
        let m = self.m();
        let start = self.known.get(START).map(|start| &start.exit);
        let ids = (0..at.objects.len()).map(ObjectId::new);
        let moved = ids.filter(|id| {
            let is_carried = m.carried(&at.mode).contains(ComponentId::Object(*id));
            !is_carried && at.object(*id) != start.and_then(|start| start.object(*id))
        });
        let named = moved.filter_map(|id| Some((id, at.object(id)?.clone())));
        named.fold(PartialState::anywhere(m), |target, (id, at)| target.with_object(id, at))
    }
}
