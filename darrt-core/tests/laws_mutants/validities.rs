//! Validities.

use std::sync::Arc;

use darrt_core::prelude::*;
use darrt_core::testing::puck::PuckWorld;

use super::{Mutant, all_pucks, notices};

type Check = fn(&dyn Validity<PuckWorld>, &PuckWorld, &State<PuckWorld>, &ComponentSet) -> Result<(), Blame>;
type Prefix = fn(FreePrefix) -> FreePrefix;

struct Rule {
    inner: Arc<dyn Validity<PuckWorld>>,
    check: Check,
    prefix: Prefix,
}

impl Validity<PuckWorld> for Rule {
    fn check(&self, m: &PuckWorld, state: &State<PuckWorld>, contacts: &ComponentSet) -> Result<(), Blame> {
        (self.check)(&*self.inner, m, state, contacts)
    }

    fn free_prefix(&self, m: &PuckWorld, instance: &Instance<PuckWorld>, from: &State<PuckWorld>) -> FreePrefix {
        (self.prefix)(self.inner.free_prefix(m, instance, from))
    }
}

fn clearance() -> Arc<dyn Validity<PuckWorld>> {
    let wall = darrt_core::testing::puck::Outline::Rectangle { lower: [1.9, 0.0], upper: [2.1, 1.0] };
    let wall = darrt_core::testing::puck::Obstacle { name: "wall".into(), outline: wall };
    Arc::new(darrt_core::testing::puck::Clearance::new(vec![wall]))
}

fn forgives(found: Result<(), Blame>, kind: BlockKind) -> Result<(), Blame> {
    found.or_else(|blame| if blame.kind == kind { Ok(()) } else { Err(blame) })
}

pub(super) fn all() -> Vec<Mutant> {
    let honest: Check = |inner, m, state, contacts| inner.check(m, state, contacts);
    let checks: Vec<(&'static str, Check)> = vec![
        ("everything is valid", |_, _, _, _| Ok(())),
        ("limits are forgiven", |inner, m, state, c| forgives(inner.check(m, state, c), BlockKind::Limits)),
        ("the wall is forgiven", |inner, m, state, c| forgives(inner.check(m, state, c), BlockKind::RobotFixed)),
        ("pucks in the wall are forgiven", |inner, m, s, c| forgives(inner.check(m, s, c), BlockKind::ObjectFixed)),
        ("pucks are forgiven", |inner, m, state, c| forgives(inner.check(m, state, c), BlockKind::RobotObject)),
        ("pucks in pucks are forgiven", |inner, m, s, c| forgives(inner.check(m, s, c), BlockKind::ObjectObject)),
        ("contacts are ignored", |inner, m, state, _| inner.check(m, state, &ComponentSet::EMPTY)),
        ("contacts are everything", |inner, m, state, _| inner.check(m, state, &all_pucks())),
        ("any contact is everything", |inner, m, state, c| {
            inner.check(m, state, if c.is_empty() { c } else { return Ok(()) })
        }),
        ("the kind is another", |inner, m, state, c| {
            inner.check(m, state, c).map_err(|blame| Blame { kind: BlockKind::ObjectObject, ..blame })
        }),
        ("the names are exchanged", |inner, m, state, c| {
            let swap = |blame: Blame| Blame { first: blame.second.clone(), second: blame.first.clone(), ..blame };
            inner.check(m, state, c).map_err(swap)
        }),
        ("the first name is the robot's", |inner, m, state, c| {
            inner.check(m, state, c).map_err(|blame| Blame { first: "robot".into(), ..blame })
        }),
    ];
    let prefixes: Vec<(&'static str, Prefix)> = vec![
        ("every motion is free", |_| FreePrefix::FREE),
        ("the prefix is a tenth longer", |free| FreePrefix { fraction: (1.1 * free.fraction).min(0.999), ..free }),
        ("the prefix is half as long", |free| match free.blame {
            Some(_) => FreePrefix { fraction: 0.5 * free.fraction, ..free },
            None => free,
        }),
        ("the blame is dropped", |free| FreePrefix { blame: None, ..free }),
        ("the place is no number", |mut free| {
            free.blame.iter_mut().for_each(|blame| blame.place[0] = f64::NAN);
            free
        }),
        ("another body is blamed", |mut free| {
            free.blame.iter_mut().for_each(|blame| blame.second = "nobody".into());
            free
        }),
        ("free motions end early", |free| match free.blame {
            Some(_) => free,
            None => FreePrefix { fraction: 0.99, blame: None },
        }),
    ];
    let rules = checks.into_iter().map(|(what, check)| (what, check, (|free| free) as Prefix));
    let rules = rules.chain(prefixes.into_iter().map(move |(what, prefix)| (what, honest, prefix)));
    rules
        .map(|(what, check, prefix)| -> Mutant {
            (
                "Clearance",
                what,
                Box::new(move || notices(|all| all.validity(Rule { inner: clearance(), check, prefix }))),
            )
        })
        .collect()
}
