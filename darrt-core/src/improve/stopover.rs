//! A manipulation that becomes two: the objects are left somewhere on the way, and from there the robot takes them on from where
//! it stands for what comes next.
//!
//! Only the cost knows whether that pays ([`ExecutionCost::arrival`](crate::cost::ExecutionCost::arrival)): it takes longer.

use rand::{Rng, RngExt};

use super::roadmap::{Id, Roadmap};
use crate::domain::Domain;
use crate::shorten::joined;

impl<D: Domain> Roadmap<'_, D> {
    /// The manipulations of a chain of which it may pay to make two, each between the one before and the one after it.
    fn costly_arrivals(&self, chain: &[Id]) -> Vec<[Id; 3]> {
        let triples = chain.iter().zip(chain.iter().skip(1)).zip(chain.iter().skip(2)).map(|((a, b), c)| [*a, *b, *c]);
        triples.filter(|[_, at, next]| self.may_pay(*at, *next)).collect()
    }

    /// Does arriving at `next` from `at` cost more than a second manipulation, which takes about as long as the first? What is
    /// carried is not left on the way.
    fn may_pay(&self, at: Id, next: Id) -> bool {
        let is_empty = |mode: &D::Mode| self.m().carried(mode).is_empty();
        self.known.get(at).is_some_and(|known| {
            is_empty(&known.entry.mode) && is_empty(&known.exit.mode) && self.arrival_s(at, next) > known.seconds
        })
    }

    /// Tries to make two of one of the manipulations of a chain.
    pub(super) fn stop_over(&mut self, chain: &[Id], rng: &mut dyn Rng) -> Option<()> {
        let costly = self.costly_arrivals(chain);
        if costly.is_empty() {
            return None;
        }
        let [before, at, next] = *costly.get(rng.random_range(0..costly.len()))?;
        let costs_s = self.arrival_s(at, next);
        let [before, at, next] = [self.known.get(before)?, self.known.get(at)?, self.known.get(next)?];
        let m = self.m();
        let by = self.cost.stopover(m, &before.exit, &at.exit, rng)?;
        let (first, last) = (at.entry.clone(), self.placement(&at.exit));
        // The second half first, as if the first had gone well: mostly that cannot be done from where the robot stands.
        let beside = by.overlay(m, &next.entry);
        let onward = self.extender.extend(&beside, &last, rng);
        let end = &onward.reached.last().filter(|_| onward.is_met)?.state;
        if self.cost.arrival(m, end, &next.entry, &next.exit) >= costs_s {
            return None;
        }
        let to_it = self.extender.extend(&first, &by, rng);
        let mut second = beside.clone();
        second.objects.clone_from(&to_it.reached.last().filter(|_| to_it.is_met)?.state.objects);
        let from_it = if second.objects == beside.objects { onward } else { self.extender.extend(&second, &last, rng) };
        if from_it.is_met {
            self.add_chain(None, &first, &joined(to_it.reached));
            self.add_chain(None, &second, &joined(from_it.reached));
        }
        Some(())
    }
}
