//! `PATH(c1, c2, M, A)`: from one state to a target by random useful primitives. Whether it is free is not asked here.

use std::sync::Arc;

use rand::{Rng, RngExt};
use smallvec::SmallVec;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Primitive};
use crate::state::State;

/// What became of one primitive that was tried.
#[derive(Debug, Clone, PartialEq)]
pub enum Trial {
    /// It gave the instances `first .. last` of the path.
    Propagated {
        /// Index of its first instance.
        first: usize,
        /// One past its last instance.
        last: usize,
    },
    /// It found no way.
    Infeasible(Infeasible),
    /// It led nowhere, or back to a state that this path has already left, and was undone.
    NoProgress,
}

/// Why a path ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathEnd {
    /// The target is met.
    Met,
    /// No primitive is useful, or every useful one failed.
    Stuck,
    /// The bound on the number of primitives was reached.
    Depth,
}

/// A chain of instances and the record of how it came about.
#[derive(Debug)]
pub struct Path<D: Domain> {
    /// The instances in order, each with the index of the primitive that propagated it.
    pub instances: Vec<(u16, Arc<Instance<D>>)>,
    /// The states between them: `states[i]` is where `instances[i]` starts; one more at the end.
    pub states: Vec<State<D>>,
    /// Every primitive tried, in order.
    pub trials: SmallVec<[(u16, Trial); 8]>,
    /// Which primitives were ever useful.
    pub useful: SmallVec<[bool; 8]>,
    /// Why it ends.
    pub end: PathEnd,
}

/// PATH of Algorithm 1, as a loop. At most `max_depth` primitives are propagated.
///
/// A primitive that fails, or that leads back to where this path has been, is undone and another useful
/// one is drawn; the path ends when none is left.
pub fn path<D: Domain>(
    m: &D,
    primitives: &[Box<dyn Primitive<D>>],
    from: &State<D>,
    to: &PartialState<D>,
    max_depth: usize,
    rng: &mut dyn Rng,
) -> Path<D> {
    let mut path = Path {
        instances: Vec::new(),
        states: vec![from.clone()],
        trials: SmallVec::new(),
        useful: primitives.iter().map(|_| false).collect(),
        end: PathEnd::Depth,
    };
    let mut here = from.clone();
    for _ in 0..max_depth {
        if to.is_met(m, &here) {
            path.end = PathEnd::Met;
            return path;
        }
        let Some(next) = advance(m, primitives, &mut path, &here, to, rng) else {
            path.end = PathEnd::Stuck;
            return path;
        };
        here = next;
    }
    if to.is_met(m, &here) {
        path.end = PathEnd::Met;
    }
    path
}

/// Propagates one random useful primitive, or another if that fails. Returns where it leads.
fn advance<D: Domain>(
    m: &D,
    primitives: &[Box<dyn Primitive<D>>],
    path: &mut Path<D>,
    here: &State<D>,
    to: &PartialState<D>,
    rng: &mut dyn Rng,
) -> Option<State<D>> {
    let mut open: SmallVec<[usize; 8]> = SmallVec::new();
    for (index, primitive) in primitives.iter().enumerate() {
        if primitive.useful(m, here, to) {
            open.push(index);
            if let Some(flag) = path.useful.get_mut(index) {
                *flag = true;
            }
        }
    }
    while !open.is_empty() {
        let index = open.swap_remove(rng.random_range(0..open.len()));
        let Some(primitive) = primitives.get(index) else { continue };
        let id = u16::try_from(index).unwrap_or(u16::MAX);
        match primitive.propagate(m, here, to, rng) {
            Err(why) => path.trials.push((id, Trial::Infeasible(why))),
            Ok(instances) => {
                let first = path.instances.len();
                let mut end = here.clone();
                for instance in instances {
                    instance.motion.at_into(m, 1.0, &mut end);
                    path.instances.push((id, Arc::new(instance)));
                    path.states.push(end.clone());
                }
                // Everything before the new instances is where this path has been. A state that is not even
                // near itself has a component that is not a number.
                let been = path.states.get(..=first).unwrap_or_default();
                let is_lost = path.instances.len() == first || !end.is_near(m, &end);
                if is_lost || been.iter().any(|state| state.is_near(m, &end)) {
                    path.instances.truncate(first);
                    path.states.truncate(first + 1);
                    path.trials.push((id, Trial::NoProgress));
                } else {
                    path.trials.push((id, Trial::Propagated { first, last: path.instances.len() }));
                    return Some(end);
                }
            }
        }
    }
    None
}
