//! Primitives.

use std::fmt;
use std::sync::Arc;

use darrt_core::partial::PartialState;
use darrt_core::prelude::*;
use darrt_core::testing::puck::{Carry, Pick, Place, PuckWorld, Push, Transit};
use rand::Rng;

use super::{Mutant, all_pucks, notices};

type Instanced = fn(&PuckWorld, &State<PuckWorld>, Vec<Instance<PuckWorld>>) -> Vec<Instance<PuckWorld>>;
type Answer = fn(bool, &PuckWorld, &State<PuckWorld>, &PartialState<PuckWorld>) -> bool;

#[derive(Clone, Copy)]
struct Changes {
    useful: Answer,
    approach: fn(Option<f64>) -> Option<f64>,
    instances: Instanced,
    fails: bool,
}

const NONE: Changes =
    Changes { useful: |found, _, _, _| found, approach: |found| found, instances: |_, _, all| all, fails: false };

struct Changed<P> {
    inner: P,
    by: Changes,
}

impl<P: Primitive<PuckWorld>> Primitive<PuckWorld> for Changed<P> {
    fn id(&self) -> PrimitiveId {
        self.inner.id()
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        (self.by.useful)(self.inner.useful(m, from, to), m, from, to)
    }

    fn approach(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> Option<f64> {
        (self.by.approach)(self.inner.approach(m, from, to))
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let found = self.inner.propagate(m, from, to, rng)?;
        if self.by.fails { Err(Infeasible::Unreachable) } else { Ok((self.by.instances)(m, from, found)) }
    }
}

/// A motion at another parameter, of another length.
struct Bent {
    inner: Arc<Instance<PuckWorld>>,
    at: fn(f64) -> f64,
    length: f64,
}

impl Motion<PuckWorld> for Bent {
    fn length(&self) -> f64 {
        self.inner.motion.length() * self.length
    }

    fn at_into(&self, m: &PuckWorld, t: f64, out: &mut State<PuckWorld>) {
        self.inner.motion.at_into(m, (self.at)(t.clamp(0.0, 1.0)), out);
    }
}

impl fmt::Debug for Bent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Bent")
    }
}

fn bent(instance: Instance<PuckWorld>, at: fn(f64) -> f64, length: f64) -> Instance<PuckWorld> {
    let (primitive, contacts, moves) = (instance.primitive, instance.contacts, instance.moves);
    let (object, reversible) = (instance.object, instance.reversible);
    let motion = Box::new(Bent { inner: Arc::new(instance), at, length });
    Instance { primitive, motion, contacts, moves, object, reversible }
}

/// Does something to the last instance.
macro_rules! last {
    ($change:expr) => {
        Changes {
            instances: |_, _, mut all| {
                let change: fn(Instance<PuckWorld>) -> Instance<PuckWorld> = $change;
                let last = all.pop().map(change);
                all.into_iter().chain(last).collect()
            },
            ..NONE
        }
    };
}

fn changes() -> Vec<(&'static str, Changes)> {
    vec![
        ("useful is negated", Changes { useful: |found, _, _, _| !found, ..NONE }),
        ("always useful", Changes { useful: |_, _, _, _| true, ..NONE }),
        ("never useful", Changes { useful: |_, _, _, _| false, ..NONE }),
        ("always infeasible", Changes { fails: true, ..NONE }),
        ("the first instance is dropped", Changes { instances: |_, _, all| all.into_iter().skip(1).collect(), ..NONE }),
        ("the instances are reversed", Changes { instances: |_, _, all| all.into_iter().rev().collect(), ..NONE }),
        ("no instances", Changes { instances: |_, _, _| Vec::new(), ..NONE }),
        ("the length is half as long", last!(|i| bent(i, |t| t, 0.5))),
        ("the length is twice as long", last!(|i| bent(i, |t| t, 2.0))),
        ("the length has another sign", last!(|i| bent(i, |t| t, -1.0))),
        ("runs backwards", last!(|i| bent(i, |t| 1.0 - t, 1.0))),
        ("starts one step in", last!(|i| bent(i, |t| 0.01 + 0.99 * t, 1.0))),
        ("runs unevenly", last!(|i| bent(i, |t| t * t, 1.0))),
        ("jumps at the end", last!(|i| bent(i, |t| if t < 1.0 { 0.99 * t } else { 1.0 }, 1.0))),
        ("goes in steps", last!(|i| bent(i, |t| (t * 100.0).floor() / 100.0, 1.0))),
        ("nothing may touch", last!(|i| Instance { contacts: ComponentSet::EMPTY, ..i })),
        ("everything may touch", last!(|i| Instance { contacts: all_pucks(), ..i })),
        ("moves nothing", last!(|i| Instance { moves: ComponentSet::EMPTY, ..i })),
        ("moves everything", last!(|i| Instance { moves: all_pucks(), ..i })),
        ("moves the robot alone", last!(|i| Instance { moves: ComponentSet::ROBOT, ..i })),
        ("names no object", last!(|i| Instance { object: None, ..i })),
        ("names an object too many", last!(|i| Instance { object: Some(ObjectId::new(9)), ..i })),
        (
            "names the other object",
            last!(|i| Instance { object: i.object.map(|id| ObjectId::new(1 - id.index())), ..i }),
        ),
        ("reversible is negated", last!(|i| Instance { reversible: !i.reversible, ..i })),
        ("another primitive", last!(|i| Instance { primitive: PrimitiveId::new(10, "Other"), ..i })),
        ("no approach", Changes { approach: |_| None, ..NONE }),
        ("a longer approach", Changes { approach: |found| found.map(|x| 1.5 * x + 1.0), ..NONE }),
        ("an approach of another sign", Changes { approach: |found| found.map(|x| -x - 0.1), ..NONE }),
    ]
}

pub(super) fn all() -> Vec<Mutant> {
    let others = || -> Vec<Box<dyn Primitive<PuckWorld>>> {
        vec![Box::new(Transit), Box::new(Pick), Box::new(Carry), Box::new(Place)]
    };
    let of_push = changes().into_iter().map(move |(what, by)| -> Mutant {
        let run = move || {
            notices(|all| {
                let mut changed = others();
                changed.push(Box::new(Changed { inner: Push, by }));
                all.primitives(changed)
            })
        };
        ("Push", what, Box::new(run))
    });
    let of_transit = changes().into_iter().filter_map(|(what, by)| -> Option<Mutant> {
        // These make no difference to a transit, or none that is wrong.
        let idle = [
            "nothing may touch",
            "moves the robot alone",
            "names no object",
            "names the other object",
            "reversible is negated",
            "another primitive",
            "the length is twice as long",
            "the instances are reversed",
        ];
        if idle.contains(&what) || what.contains("approach") {
            return None;
        }
        let run = move || {
            notices(|all| {
                let changed: Vec<Box<dyn Primitive<PuckWorld>>> = vec![
                    Box::new(Changed { inner: Transit, by }),
                    Box::new(Push),
                    Box::new(Pick),
                    Box::new(Carry),
                    Box::new(Place),
                ];
                all.primitives(changed)
            })
        };
        Some(("Transit", what, Box::new(run)))
    });
    of_push.chain(of_transit).collect()
}
