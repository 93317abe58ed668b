//! A manipulation that becomes two: the objects are left somewhere on the way, and from there the robot takes them on from where
//! it stands for what comes next.
//!
//! Only the cost knows whether that pays ([`ExecutionCost::arrival`](crate::cost::ExecutionCost::arrival)): it takes longer.

use rand::{Rng, RngExt};

use super::roadmap::{Id, Roadmap};
use crate::domain::Domain;
use crate::shorten::joined;
use crate::state::State;

impl<D: Domain> Roadmap<'_, D> {
    /// The manipulations of a chain after which the robot arrives at a cost, each between the one before and the one after it.
    pub(super) fn costly_arrivals(&self, chain: &[Id]) -> Vec<[Id; 3]> {
        let triples = chain.iter().zip(chain.iter().skip(1)).zip(chain.iter().skip(2)).map(|((a, b), c)| [*a, *b, *c]);
        triples.filter(|[_, at, next]| self.arrival_s(*at, *next) > 0.0).collect()
    }

    /// Tries to make two of one of these manipulations.
    pub(super) fn stop_over(&mut self, costly: &[[Id; 3]], rng: &mut dyn Rng) -> Option<()> {
        if costly.is_empty() {
            return None;
        }
        let [before, at, next] = *costly.get(rng.random_range(0..costly.len()))?;
        let [before, at, next] = [self.known.get(before)?, self.known.get(at)?, self.known.get(next)?];
        let m = self.m();
        if !m.carried(&at.entry.mode).is_empty() || !m.carried(&at.exit.mode).is_empty() {
            return None;
        }
        let by = self.cost.stopover(m, &before.exit, &at.exit, rng)?;
        let (first, last) = (at.entry.clone(), self.placement(&at.exit));
        let stands = next.entry.clone();
        let to_it = self.extender.extend(&first, &by, rng);
        let left = to_it.reached.last().filter(|_| to_it.is_met)?.state.objects.clone();
        let second = State { objects: left, ..stands };
        let from_it = self.extender.extend(&second, &last, rng);
        if from_it.is_met {
            self.add_chain(None, &first, &joined(to_it.reached));
            self.add_chain(None, &second, &joined(from_it.reached));
        }
        Some(())
    }
}
