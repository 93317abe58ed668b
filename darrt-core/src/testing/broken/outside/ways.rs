//! Broken ways around, broken costs, and domains that say the wrong things of modes and of the robot.

use std::sync::atomic::{AtomicU64, Ordering};

use rand::{Rng, RngExt};

use super::super::bench::{Act, Bench, Rule, Tag, cart, robot_at, sample};
use super::super::motions::{drag, go, instance, random_state};
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::cost::{ExecutionCost, TravelCost};
use crate::laws::cost::{BETWEEN, FINITE, GROWS, PURE as COST_PURE, STEP};
use crate::laws::domain::{CARRIED, MAY_GO_ON, PURE, WITHOUT_ROBOT};
use crate::laws::local_repair::{ENDS, FREE, PURE as TURNS_PURE, REFUSES, SAME, SEEDED, TURNS};
use crate::laws::{
    Broken, MotionClaims, PrimitiveClaims, SpaceClaims, check_cost, check_domain, check_local_repair, try_primitive,
};
use crate::local_repair::{LocalRepair, NoWay};
use crate::motion::{Instance, Waypoints};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, State};
use crate::validity::Validity;

static CALLS: AtomicU64 = AtomicU64::new(0);

fn counted() -> u64 {
    CALLS.fetch_add(1, Ordering::Relaxed)
}

type AroundFn = fn(&Bench, &Instance<Bench>, &State<Bench>, &mut dyn Rng) -> Option<Instance<Bench>>;

/// A way around made of functions.
#[derive(Clone, Copy)]
struct Around {
    turns: fn(&Instance<Bench>) -> bool,
    refuses: NoWay,
    way: AroundFn,
}

const HONEST: Around = Around {
    turns: |motion| motion.object.is_none(),
    refuses: NoWay::WithAnyCare,
    way: |m, motion, from, rng| over(m, motion, from, rng, |_, _| ()),
};

impl LocalRepair<Bench> for Around {
    fn is_free_to_turn(&self, _: &Bench, motion: &Instance<Bench>) -> bool {
        (self.turns)(motion)
    }

    fn repair(
        &self,
        m: &Bench,
        _: &dyn Validity<Bench>,
        _: usize,
        motion: &Instance<Bench>,
        from: &State<Bench>,
        rng: &mut dyn Rng,
    ) -> Result<Instance<Bench>, NoWay> {
        if !(self.turns)(motion) {
            return Err(self.refuses);
        }
        (self.way)(m, motion, from, rng).ok_or(NoWay::WithThisCare)
    }
}

/// Over a place between the ends, with the robot looking elsewhere; middle and end after `change`.
fn over(
    m: &Bench,
    motion: &Instance<Bench>,
    from: &State<Bench>,
    rng: &mut dyn Rng,
    change: fn(&mut State<Bench>, &mut State<Bench>),
) -> Option<Instance<Bench>> {
    let (start, mut end) = (motion.at(m, 0.0, from), motion.at(m, 1.0, from));
    let mut middle = motion.at(m, 0.5, from);
    middle.robot[1] = rng.random_range(-3.0..3.0);
    change(&mut middle, &mut end);
    let segments = [(&start, &middle), (&middle, &end)].map(|(a, b)| m.robot.distance(&a.robot, &b.robot) + 1e-12);
    let way = Waypoints::new(vec![start.clone(), middle, end], &segments, start.mode)?;
    Some(Instance { contacts: motion.contacts, ..instance(way, motion.moves) })
}

/// A drive before the wall, and a cart that is dragged.
fn around(local_repair: &Around) -> Result<(), Broken> {
    let (m, rule) = (Bench::default(), Rule::default());
    for i in 0..CASES / 8 {
        let mut rng = inputs(i);
        let mut from = random_state(&mut rng);
        from.robot[0] = rng.random_range(0.0..0.4);
        from.objects.iter_mut().for_each(|cart| cart[0] = 2.0 + 0.4 * cart[0]);
        let drive = go(&m, &from, [from.robot[0] + 0.4, rng.random_range(-3.0..3.0)]);
        let dragged = drag(&from, 3.0).map(|motion| Instance { reversible: false, ..motion });
        for motion in std::iter::once(drive).chain(dragged) {
            check_local_repair(&m, local_repair, &rule, (&motion, &from), seed() + i, &MotionClaims::default())?;
        }
    }
    Ok(())
}

fn ways() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || around(&HONEST) };
    vec![
        case("ends beside the end", "the end is computed anew, and differs in the last digits", ENDS, || {
            around(&Around { way: |m, i, s, rng| over(m, i, s, rng, |_, end| end.robot[0] += 1e-9), ..HONEST })
        }),
        case("ends in another mode", "the mode of the start is kept to the end", ENDS, || {
            around(&Around { way: |m, i, s, rng| over(m, i, s, rng, |_, end| end.mode = Tag::new(7)), ..HONEST })
        }),
        case("touches everything on the way", "contacts are everything, so that a way is found", SAME, || {
            around(&Around {
                way: |m, i, s, rng| {
                    let way = over(m, i, s, rng, |_, _| ())?;
                    Some(Instance { contacts: ComponentSet::ROBOT.with(ComponentId::Object(cart())), ..way })
                },
                ..HONEST
            })
        }),
        case("declares a cart", "moves is copied from a drag", SAME, || {
            around(&Around {
                way: |m, i, s, rng| {
                    let way = over(m, i, s, rng, |_, _| ())?;
                    Some(Instance { moves: way.moves.with(ComponentId::Object(cart())), ..way })
                },
                ..HONEST
            })
        }),
        case("everything may turn", "also a push, which then pushes around corners", TURNS, || {
            around(&Around { turns: |_| true, ..HONEST })
        }),
        case("turns every other time", "a flag that is toggled when it is read", TURNS_PURE, || {
            around(&Around { turns: |_| counted().is_multiple_of(2), ..HONEST })
        }),
        case("way by a generator of its own", "the search is seeded by the number of the call", SEEDED, || {
            around(&Around {
                way: |m, i, s, _| over(m, i, s, &mut stream(counted(), 0, 0, Purpose::Extend), |_, _| ()),
                ..HONEST
            })
        }),
        case("perhaps with less care", "says of a push that there may be a way with less care", REFUSES, || {
            around(&Around { refuses: NoWay::WithThisCare, ..HONEST })
        }),
        case("through the wall", "looks at the places between which it goes, and not at the way", FREE, || {
            around(&Around { way: |m, i, s, rng| over(m, i, s, rng, |middle, _| middle.robot[0] = 2.0), ..HONEST })
        }),
    ]
}

/// A cost made of functions.
#[derive(Clone, Copy)]
struct Price {
    seconds: fn(&Instance<Bench>, f64) -> f64,
    between: fn(f64) -> f64,
    step_s: f64,
}

const FAIR: Price =
    Price { seconds: |motion, until| 0.1 + motion.motion.length() * until, between: f64::abs, step_s: 0.1 };

impl ExecutionCost<Bench> for Price {
    fn seconds(&self, _: &Bench, motion: &Instance<Bench>, _: &State<Bench>, until: f64) -> f64 {
        (self.seconds)(motion, until)
    }

    fn step_s(&self) -> f64 {
        self.step_s
    }

    fn between(&self, _: &Bench, from: &State<Bench>, to: &State<Bench>) -> f64 {
        (self.between)(to.robot[0] - from.robot[0])
    }
}

fn cost(cost: &dyn ExecutionCost<Bench>) -> Result<(), Broken> {
    let m = Bench::default();
    for i in 0..CASES / 4 {
        let mut rng = inputs(i);
        let from = random_state(&mut rng);
        let there = if i.is_multiple_of(8) { from.robot } else { sample(&mut rng) };
        check_cost(&m, cost, &go(&m, &from, there), &from)?;
    }
    Ok(())
}

fn costs() -> Vec<Case> {
    let honest = || cost(&FAIR).and_then(|()| cost(&TravelCost::default()));
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest };
    vec![
        case("a discount", "what is saved elsewhere is subtracted, also from next to nothing", FINITE, || {
            cost(&Price { seconds: |i, until| i.motion.length() * until - 0.05, step_s: 0.0, ..FAIR })
        }),
        case("speed of nothing", "divides by the time of a motion of no length", FINITE, || {
            cost(&Price {
                seconds: |i, until| i.motion.length() * until * (i.motion.length() / i.motion.length()),
                step_s: 0.0,
                ..FAIR
            })
        }),
        case("speed at the start", "the part that is done divides, and where a motion begins it is 0", FINITE, || {
            cost(&Price { seconds: |i, until| 0.1 + i.motion.length() * until * until / until, ..FAIR })
        }),
        case("signed guess", "the way between two places without its absolute value", FINITE, || {
            cost(&Price { between: |metres| metres, ..FAIR })
        }),
        case("a dearer clock", "the price goes up with every question", COST_PURE, || {
            cost(&Price { seconds: |i, until| 0.1 + i.motion.length() * until + 1e-9 * counted() as f64, ..FAIR })
        }),
        case("what is left", "counts the rest of a motion that is cut short, not its beginning", GROWS, || {
            cost(&Price { seconds: |i, until| 0.1 + i.motion.length() * (1.0 - until), ..FAIR })
        }),
        case("all of it", "a part of a motion costs as much as the whole", GROWS, || {
            cost(&Price { seconds: |i, _| 0.1 + i.motion.length(), ..FAIR })
        }),
        case("for nothing", "a cost that was never filled in", GROWS, || {
            cost(&Price { seconds: |_, _| 0.0, step_s: 0.0, ..FAIR })
        }),
        case("a step apart", "the time of a step is told, but is not in the seconds", STEP, || {
            cost(&Price { seconds: |i, until| i.motion.length() * until, step_s: 0.5, ..FAIR })
        }),
        case("guess in milliseconds", "the guess is in another unit than the seconds", BETWEEN, || {
            cost(&Price { between: |metres| 1000.0 * metres.abs(), ..FAIR })
        }),
    ]
}

/// States in several modes.
fn domain(m: &Bench) -> Result<(), Broken> {
    for i in 0..CASES / 4 {
        let mut rng = inputs(i);
        let [a, b, c] = [0, 1, 2].map(|tag| State { mode: Tag::new(tag), ..random_state(&mut rng) });
        check_domain(m, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.8], seed() + i)?;
    }
    Ok(())
}

/// What is carried in mode 1.
fn held(mode: &Tag) -> ComponentSet {
    if mode.number() == 1 { ComponentSet::EMPTY.with(ComponentId::Object(cart())) } else { ComponentSet::EMPTY }
}

/// A primitive that begins in mode 1.
fn carries(propagate: super::super::bench::Propagate) -> Result<(), Broken> {
    let m = Bench { carried: held, ..Bench::default() };
    let act = Act { useful: |m, from, to| !to.is_met(m, from), approach: |_, _, _| None, propagate };
    for i in 0..CASES / 8 {
        let mut rng = inputs(i);
        let mut from = State { mode: Tag::new(1), ..random_state(&mut rng) };
        from.robot[0] = rng.random_range(1.0..2.0);
        from.objects[cart().index()][0] = from.robot[0];
        let to = robot_at([3.0, from.robot[1]]);
        try_primitive(&m, &act, &from, &to, seed() + i, &PrimitiveClaims::default())?;
    }
    Ok(())
}

fn domains() -> Vec<Case> {
    let honest = || {
        let without_robot = |m: &Bench| Some(m.clone());
        domain(&Bench { carried: held, without_robot, ..Bench::default() })?;
        carries(|_, from, _, _| Ok(drag(from, 3.0).into_iter().collect()))
    };
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest };
    vec![
        case("goes on every other time", "a flag that is toggled when it is read", PURE, || {
            domain(&Bench { may_go_on: |a, b| a == b || counted().is_multiple_of(2), ..Bench::default() })
        }),
        case("goes on whatever is held", "one mode is as good as the next", MAY_GO_ON, || {
            domain(&Bench { may_go_on: |_, _| true, carried: held, ..Bench::default() })
        }),
        case("carries the robot", "everything that moves is carried, the robot included", CARRIED, || {
            domain(&Bench { carried: |mode| held(mode).union(ComponentSet::ROBOT), ..Bench::default() })
        }),
        case("drives off without it", "the cart in the hand is left where it is", CARRIED, || {
            carries(|m, from, _, _| Ok(vec![go(m, from, [3.0, from.robot[1]])]))
        }),
        case("a smaller room", "the room without the robot is that of another model", WITHOUT_ROBOT, || {
            let without_robot = |m: &Bench| {
                let mut bare = m.clone();
                bare.robot.sample = |rng| [rng.random_range(0.0..=2.0), 0.0];
                Some(bare)
            };
            domain(&Bench { without_robot, ..Bench::default() })
        }),
        case("other ways without the robot", "without the robot nothing is far away", WITHOUT_ROBOT, || {
            domain(&Bench {
                without_robot: |m| Some(Bench { travel_between: |_, _| 0.0, ..m.clone() }),
                ..Bench::default()
            })
        }),
    ]
}

pub(super) fn cases() -> Vec<Case> {
    [ways(), costs(), domains()].concat()
}
