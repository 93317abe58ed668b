//! Broken primitives: what is done too much.

use std::sync::atomic::{AtomicU32, Ordering};

use rand::{Rng, RngExt};

use super::super::bench::{Act, Bench, Propagate, Tag, cart, cart_at, robot_at, sample};
use super::super::motions::{go, instance, random_state};
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::laws::primitive::{AT_HAND, HARM, IDS, MOVES, NAME, PANICS, PROGRESS, REVERSIBLE};
use crate::laws::{Broken, PrimitiveClaims, try_primitive};
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// The honest robot: straight to its target.
const GO: Act = Act {
    useful: |m, from, to| to.are_objects_met(m, from) && !to.is_robot_met(m, from),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
};

/// An honest push of cart 0, from the side on which it is pushed, to the position that is asked for.
const PUSH: Act = Act {
    useful: |_, from, to| way(from, to).is_some(),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| pushed(m, from, to, |_, _| ()),
};

/// Position of cart 0, and where it should be.
fn way(from: &State<Bench>, to: &PartialState<Bench>) -> Option<(f64, f64)> {
    let (at, target) = (from.object(cart())?, to.object(cart())?);
    // Not a number is no way either.
    ((at[0] - target[0]).abs() > 1e-9).then_some((at[0], target[0]))
}

/// Behind the cart, and on; `change` may alter what is found, given the state behind the cart.
fn pushed(
    m: &Bench,
    from: &State<Bench>,
    to: &PartialState<Bench>,
    change: impl FnOnce(&State<Bench>, &mut Instance<Bench>),
) -> Result<Instances<Bench>, Infeasible> {
    let (at, target) = way(from, to).ok_or(Infeasible::NoProgress)?;
    let behind = at - 0.05 * (target - at).signum();
    let approach = Instance { object: Some(cart()), ..go(m, from, [behind, from.robot[1]]) };
    let touching = State { robot: [behind, from.robot[1]], ..from.clone() };
    let mut end = touching.clone();
    end.robot[0] += target - at;
    end.objects[0][0] = target;
    let motion = Waypoints::new(vec![touching.clone(), end], &[(target - at).abs() + 1e-12], from.mode.clone());
    let moves = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
    let mut push = instance(motion.ok_or(Infeasible::NoContact)?, moves);
    push.object = Some(cart());
    push.reversible = false;
    change(&touching, &mut push);
    Ok(vec![approach, push])
}

fn check_that(primitive: &dyn Primitive<Bench>) -> Result<(), Broken> {
    let m = Bench::default();
    for i in 0..CASES {
        let mut rng = inputs(i);
        let from = random_state(&mut rng);
        let place = |rng: &mut dyn Rng, id: usize, at: &State<Bench>| {
            let [x, _] = sample(rng);
            [x, at.objects[id][1]]
        };
        let first = cart_at(place(&mut rng, 0, &from));
        // The other cart is where it should be.
        let both = first.clone().with_object(ObjectId::new(1), from.objects[1]);
        for to in [robot_at(sample(&mut rng)), first, both] {
            try_primitive(&m, primitive, &from, &to, seed() + i, &PrimitiveClaims::default())?;
        }
    }
    Ok(())
}

fn check(act: Act) -> Result<(), Broken> {
    check_that(&act)
}

fn pushing(propagate: Propagate) -> Result<(), Broken> {
    check(Act { propagate, ..PUSH })
}

fn going(propagate: Propagate) -> Result<(), Broken> {
    check(Act { propagate, ..GO })
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(GO).and_then(|()| check(PUSH)) }
}

pub(super) fn cases() -> Vec<Case> {
    [ends(), claims(), answers()].concat()
}

fn ends() -> Vec<Case> {
    vec![
        case("two nanometres", "a step so small that only the comparison notices", PROGRESS, || {
            going(|m, from, to, _| {
                let target = to.robot_overlay(m, &from.robot);
                let metres = m.robot.distance(&from.robot, &target);
                Ok(vec![go(m, from, m.robot.interpolate(&from.robot, &target, 2e-9 / metres))])
            })
        }),
        case("moves a bystander and says so", "pushes the other cart along, and declares it", MOVES, || {
            pushing(|m, from, to, _| {
                pushed(m, from, to, |touching, push| {
                    let mut end = push.at(m, 1.0, touching);
                    let metres = end.objects[0][0] - touching.objects[0][0];
                    end.objects[1][0] = (end.objects[1][0] + metres).clamp(0.0, 4.0);
                    let motion = Waypoints::new(vec![touching.clone(), end], &[metres.abs() + 1e-12], Tag::default());
                    push.moves = push.moves.with(ComponentId::Object(ObjectId::new(1)));
                    push.motion = motion.map_or_else(|| unreachable!("two states"), Box::new);
                })
            })
        }),
        case("declares everything", "moves is everything, to be on the safe side", MOVES, || {
            going(|m, from, to, _| {
                let target = to.robot_overlay(m, &from.robot);
                let all = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
                let all = all.with(ComponentId::Object(ObjectId::new(1)));
                Ok(vec![Instance { moves: all, ..go(m, from, target) }])
            })
        }),
        case("throws away what was met", "brings one cart to its target, and the other out of its way", HARM, || {
            pushing(|m, from, to, _| {
                let mut all = pushed(m, from, to, |_, _| ())?;
                let end = all.iter().fold(from.clone(), |at, instance| instance.at(m, 1.0, &at));
                let mut cleared = end.clone();
                cleared.objects[1][0] = if end.objects[1][0] > 2.0 { 0.5 } else { 3.5 };
                let metres = (cleared.objects[1][0] - end.objects[1][0]).abs() + 1e-12;
                let motion = Waypoints::new(vec![end, cleared], &[metres], Tag::default());
                let other = ComponentId::Object(ObjectId::new(1));
                let clears = instance(motion.ok_or(Infeasible::NoProgress)?, ComponentSet::EMPTY.with(other));
                all.push(Instance { object: Some(ObjectId::new(1)), reversible: false, ..clears });
                Ok(all)
            })
        }),
        case("arrives with a full hand", "a transit ends in the mode of a grasp, far from every cart", AT_HAND, || {
            going(|m, from, to, _| {
                let end = State { robot: to.robot_overlay(m, &from.robot), mode: Tag::new(1), ..from.clone() };
                let metres = m.robot.distance(&from.robot, &end.robot);
                let motion = Waypoints::new(vec![from.clone(), end], &[metres], from.mode.clone());
                Ok(motion.into_iter().map(|motion| instance(motion, ComponentSet::ROBOT)).collect())
            })
        }),
        case("grasps from afar", "closes the hand on a cart at the other end of the rail", AT_HAND, || {
            check(Act {
                useful: |_, from, to| from.mode.number() == 0 && way(from, to).is_some(),
                approach: |_, _, _| None,
                propagate: |_, from, _, _| {
                    let end = State { mode: Tag::new(1), ..from.clone() };
                    let motion = Waypoints::new(vec![from.clone(), end], &[0.0], from.mode.clone());
                    let motion = motion.ok_or(Infeasible::NoGrasp)?;
                    Ok(vec![Instance { object: Some(cart()), ..instance(motion, ComponentSet::EMPTY) }])
                },
            })
        }),
    ]
}

fn claims() -> Vec<Case> {
    vec![
        case("a push that may be undone", "copied from a carry, with the claim to be reversible", REVERSIBLE, || {
            pushing(|m, from, to, _| pushed(m, from, to, |_, push| push.reversible = true))
        }),
        case("half of the way and a claim", "a short push that says it may run backwards", REVERSIBLE, || {
            pushing(|m, from, to, _| {
                let (at, target) = way(from, to).ok_or(Infeasible::NoProgress)?;
                let nearer = to.clone().with_object(cart(), [0.5 * (at + target), from.objects[0][1]]);
                pushed(m, from, &nearer, |_, push| push.reversible = true)
            })
        }),
    ]
}

fn answers() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);

    /// A primitive that calls itself something else each time.
    struct Nameless;
    impl Primitive<Bench> for Nameless {
        fn id(&self) -> PrimitiveId {
            PrimitiveId::new(0, ["Go", "Went", "Gone"][CALLS.fetch_add(1, Ordering::Relaxed) as usize % 3])
        }

        fn useful(&self, m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> bool {
            (GO.useful)(m, from, to)
        }

        fn propagate(
            &self,
            m: &Bench,
            from: &State<Bench>,
            to: &PartialState<Bench>,
            rng: &mut dyn Rng,
        ) -> Result<Instances<Bench>, Infeasible> {
            (GO.propagate)(m, from, to, rng)
        }
    }

    vec![
        case(
            "an index that is another's",
            "copied with the file: the name is right, and the number is not",
            IDS,
            || {
                going(|m, from, to, rng| {
                    let primitive = PrimitiveId::new(21, "Act");
                    (GO.propagate)(m, from, to, rng)
                        .map(|all| all.into_iter().map(|i| Instance { primitive, ..i }).collect())
                })
            },
        ),
        case("two of one index", "the next free number was taken", IDS, || {
            going(|m, from, to, rng| {
                let primitive = PrimitiveId::new(20, "Roll");
                (GO.propagate)(m, from, to, rng)
                    .map(|all| all.into_iter().map(|i| Instance { primitive, ..i }).collect())
            })
        }),
        case("another name each time", "the name tells the state of a counter", NAME, || check_that(&Nameless)),
        case("unwraps a comparison", "sorts by distance, and panics where there is none to compare", PANICS, || {
            check(Act {
                useful: |m, from, to| {
                    let target = to.robot_overlay(m, &from.robot);
                    let metres = m.robot.distance(&from.robot, &target);
                    metres.partial_cmp(&0.0).map_or_else(|| unreachable!("a distance"), std::cmp::Ordering::is_gt)
                        && (GO.useful)(m, from, to)
                },
                ..GO
            })
        }),
        case("index of a cell", "looks up the cell of the target in a table that is one too short", PANICS, || {
            const CELLS: [bool; 40] = [true; 40];
            check(Act {
                useful: |m, from, to| {
                    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "that is what is wrong")]
                    let cell = (to.robot_overlay(m, &from.robot)[0] * 10.0) as usize;
                    CELLS[cell] && (GO.useful)(m, from, to)
                },
                ..GO
            })
        }),
        case("panics now and then", "one draw in two hundred falls between two branches", PANICS, || {
            going(|m, from, to, rng| {
                assert!(!rng.random_bool(0.005), "neither left nor right");
                Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))])
            })
        }),
    ]
}
