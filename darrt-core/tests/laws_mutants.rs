//! Shipped implementors with one answer changed: how many of these mutants the laws kill. What survives is listed in
//! `docs/mutation-check.md` with the reason.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::fmt;
use std::sync::Arc;

use darrt_core::distance::{Distance, GreedyVisit};
use darrt_core::laws::everything::Effort;
use darrt_core::laws::{SpaceClaims, Subjects, check_component_space, check_everything, check_space_covers};
use darrt_core::partial::PartialState;
use darrt_core::plan::Plan;
use darrt_core::prelude::*;
use darrt_core::problem::Problem;
use darrt_core::random::{Purpose, stream};
use darrt_core::sample::{RandomSubset, Sampler};
use darrt_core::space::{RealBox, Se2};
use darrt_core::testing::puck::{Carry, Judge, Pick, Place, PuckWorld, Push, Setup, Transit, paper_strategy};
use darrt_core::verify::{Refusal, Verified, Verifier};
use rand::Rng;

/// One mutant: whose, what was changed, and whether anything was noticed.
type Mutant = (&'static str, &'static str, Box<dyn Fn() -> bool>);

/// Mutants that no law can kill, because they are right as well: for each the reason is in the page.
const EQUAL: [(&str, &str); 5] = [
    ("Push", "nothing may touch"),
    ("Push", "the length is twice as long"),
    ("Push", "another primitive"),
    ("Push", "no approach"),
    ("RealBox", "the distance is the sum of the axes"),
];

fn problem() -> Problem<PuckWorld> {
    let setup = Setup::new([4.0, 3.0], 0.15).robot_at([0.6, 0.6]);
    let setup = setup.graspable_puck("red", 0.12, [1.2, 1.2]).puck("blue", 0.12, [3.0, 2.2]);
    setup.wall("wall", [1.9, 0.0], [2.1, 1.0]).puck_goal(0, [1.2, 2.2]).problem().unwrap()
}

fn subjects(problem: &Problem<PuckWorld>) -> Subjects<PuckWorld> {
    let effort = Effort { cases: 32, calls: 4096, iterations: 40, apart_ms: 0, ..Effort::default() };
    Subjects::of(problem).strategy(paper_strategy().unwrap()).oracle(is_free).effort(effort)
}

/// Everything is on the floor, and a millimetre from everything else.
fn is_free(m: &PuckWorld, state: &State<PuckWorld>) -> bool {
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let to_wall = |p: &[f64; 2]| apart(p, &[p[0].clamp(1.9, 2.1), p[1].clamp(0.0, 1.0)]);
    let (robot, pucks) = (&state.robot, &state.objects);
    let fits = m.robot().contains(robot) && m.objects().iter().zip(pucks).all(|(space, at)| space.contains(at));
    fits && to_wall(robot) >= m.robot_radius() + 1e-3 - 1e-9
        && pucks.iter().all(|at| to_wall(at) >= 0.121 - 1e-9 && apart(at, robot) >= m.robot_radius() + 0.121 - 1e-9)
        && apart(&pucks[0], &pucks[1]) >= 0.241 - 1e-9
}

/// Is any law broken, or anything warned of that is not with the shipped ones?
fn notices(change: impl FnOnce(Subjects<PuckWorld>) -> Subjects<PuckWorld>) -> bool {
    let problem = problem();
    match check_everything(problem.shared_domain(), change(subjects(&problem))) {
        Err(_) => true,
        Ok(report) => report
            .warnings()
            .any(|(_, text)| ["false in", "no way", "refused every"].iter().any(|hint| text.contains(hint))),
    }
}

#[test]
fn without_a_change_nothing_is_noticed() {
    let problem = problem();
    let report = check_everything(problem.shared_domain(), subjects(&problem));
    assert!(report.is_ok() && !notices(|all| all), "{report:?}");
}

#[test]
fn the_laws_kill_nineteen_of_twenty_mutants() {
    let all: Vec<Mutant> = [primitives(), validities(), spaces(), others()].into_iter().flatten().collect();
    let is_equal = |(whose, what, _): &&Mutant| EQUAL.contains(&(*whose, *what));
    let survivors: Vec<_> = all.iter().filter(|mutant| !(mutant.2)()).collect();
    let unknown: Vec<_> =
        survivors.iter().filter(|mutant| !is_equal(mutant)).map(|(who, what, _)| (who, what)).collect();
    let killed = all.len() - survivors.len();
    println!(
        "{killed} of {} killed; survivors: {:?}",
        all.len(),
        survivors.iter().map(|m| (m.0, m.1)).collect::<Vec<_>>()
    );
    assert!(all.len() >= 90, "{}", all.len());
    assert!(unknown.is_empty(), "survivors without a reason: {unknown:?}");
    assert!(20 * killed >= 19 * all.len(), "{killed} of {}", all.len());
}

// Primitives.

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

fn all_pucks() -> ComponentSet {
    (0..2).fold(ComponentSet::ROBOT, |set, i| set.with(ComponentId::Object(ObjectId::new(i))))
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

fn primitives() -> Vec<Mutant> {
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

// Validities.

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

fn validities() -> Vec<Mutant> {
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

// Spaces.

/// A stock space with some answers changed.
struct Warped<S: ComponentSpace> {
    inner: S,
    contains: fn(&S, &S::Config) -> bool,
    distance: fn(&S, &S::Config, &S::Config) -> f64,
    interpolate: fn(&S, &S::Config, &S::Config, f64) -> S::Config,
    sample: fn(&S, &mut dyn Rng) -> S::Config,
    dimension: usize,
    tolerance: f64,
}

impl<S: ComponentSpace> Warped<S> {
    fn new(inner: S) -> Self {
        let (dimension, tolerance) = (inner.dimension(), inner.tolerance());
        Self {
            inner,
            contains: S::contains,
            distance: S::distance,
            interpolate: S::interpolate,
            sample: S::sample,
            dimension,
            tolerance,
        }
    }
}

impl<S: ComponentSpace> ComponentSpace for Warped<S> {
    type Config = S::Config;

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn contains(&self, q: &S::Config) -> bool {
        (self.contains)(&self.inner, q)
    }

    fn distance(&self, a: &S::Config, b: &S::Config) -> f64 {
        (self.distance)(&self.inner, a, b)
    }

    fn interpolate(&self, a: &S::Config, b: &S::Config, t: f64) -> S::Config {
        (self.interpolate)(&self.inner, a, b, t)
    }

    fn sample(&self, rng: &mut dyn Rng) -> S::Config {
        (self.sample)(&self.inner, rng)
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

/// Is any law of a space broken, for samples of the shipped one?
fn is_off<S: ComponentSpace>(make: fn() -> S, change: fn(&mut Warped<S>)) -> bool {
    let mut space = Warped::new(make());
    change(&mut space);
    let honest = make();
    let check = |i: u64| {
        let [a, b, c] = [0, 1, 2].map(|k| honest.sample(&mut stream(i, k, 0, Purpose::Sample)));
        check_component_space(&space, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.8], i)
    };
    (0..64).any(|i| check(i).is_err()) || check_space_covers(&space, 512, 0).is_err()
}

fn square() -> RealBox<2> {
    RealBox::new([0.0, 0.0], [2.0, 1.0]).unwrap()
}

fn plane() -> Se2 {
    Se2::new([0.0, 0.0], [2.0, 1.0], 0.5).unwrap()
}

fn spaces() -> Vec<Mutant> {
    type OnSquare = (&'static str, fn(&mut Warped<RealBox<2>>));
    type OnPlane = (&'static str, fn(&mut Warped<Se2>));
    let of_square: Vec<OnSquare> = vec![
        ("contains is negated", |s| s.contains = |s, q| !s.contains(q)),
        ("contains forgets an axis", |s| s.contains = |_, q| (0.0..=2.0).contains(&q[0])),
        ("contains forgets the lower bound", |s| s.contains = |_, q| q[0] <= 2.0 && q[1] <= 1.0),
        ("contains everything", |s| s.contains = |_, _| true),
        ("contains less", |s| s.contains = |s, q| s.contains(q) && q[0] < 1.9),
        ("the distance forgets an axis", |s| s.distance = |_, a, b| (a[0] - b[0]).abs()),
        ("the distance forgets its root", |s| s.distance = |s, a, b| s.distance(a, b).powi(2)),
        ("the distance is the sum of the axes", |s| s.distance = |_, a, b| (a[0] - b[0]).abs() + (a[1] - b[1]).abs()),
        ("the distance adds where it subtracts", |s| s.distance = |_, a, b| (a[0] + b[0]).hypot(a[1] - b[1])),
        ("the distance has a sign", |s| s.distance = |_, a, b| a[0] - b[0] + a[1] - b[1]),
        ("the distance is one too much", |s| s.distance = |s, a, b| s.distance(a, b) + 1.0),
        ("the distance is 0", |s| s.distance = |_, _, _| 0.0),
        ("interpolates to the other end", |s| s.interpolate = |s, a, b, t| s.interpolate(b, a, t)),
        ("interpolates too far", |s| s.interpolate = |s, a, b, t| s.interpolate(a, b, 1.1 * t)),
        ("interpolates not far enough", |s| s.interpolate = |s, a, b, t| s.interpolate(a, b, 0.9 * t)),
        ("interpolates unevenly", |s| s.interpolate = |s, a, b, t| s.interpolate(a, b, t * t)),
        ("interpolates one axis", |s| s.interpolate = |s, a, b, t| [s.interpolate(a, b, t)[0], b[1]]),
        ("stays at the start", |s| s.interpolate = |_, a, _, _| *a),
        ("samples the lower half", |s| s.sample = |s, rng| s.sample(rng).map(|x| 0.5 * x)),
        ("samples a point", |s| s.sample = |_, _| [0.5, 0.5]),
        ("samples a line", |s| s.sample = |s, rng| [s.sample(rng)[0], 0.5]),
        ("samples beyond the bound", |s| s.sample = |s, rng| s.sample(rng).map(|x| 1.01 * x)),
        ("no dimension", |s| s.dimension = 0),
        ("the tolerance is a metre", |s| s.tolerance = 1.0),
        ("the tolerance is 0", |s| s.tolerance = 0.0),
    ];
    let of_plane: Vec<OnPlane> = vec![
        ("the distance forgets the heading", |s| s.distance = |_, a, b| (a[0] - b[0]).hypot(a[1] - b[1])),
        ("the heading is not wrapped", |s| {
            s.distance = |_, a, b| (a[0] - b[0]).hypot(a[1] - b[1]) + 0.5 * (a[2] - b[2]).abs();
        }),
        ("the heading goes the long way", |s| {
            s.interpolate = |s, a, b, t| {
                let [x, y, yaw] = s.interpolate(a, b, t);
                [x, y, if t > 0.0 && t < 1.0 { a[2] + (b[2] - a[2]) * t } else { yaw }]
            };
        }),
        ("contains any heading", |s| s.contains = |s, q| s.contains(&[q[0], q[1], 0.0])),
        ("samples half of the headings", |s| s.sample = |s, rng| s.sample(rng).map(f64::abs)),
    ];
    let square_mutants = of_square
        .into_iter()
        .map(|(what, change)| -> Mutant { ("RealBox", what, Box::new(move || is_off(square, change))) });
    let plane_mutants =
        of_plane.into_iter().map(|(what, change)| -> Mutant { ("Se2", what, Box::new(move || is_off(plane, change))) });
    square_mutants.chain(plane_mutants).collect()
}

// Goals, samplers, distances, verifiers.

struct Aim {
    test: fn(bool) -> bool,
    draw: fn(PartialState<PuckWorld>) -> Option<PartialState<PuckWorld>>,
}

impl Goal<PuckWorld> for Aim {
    fn is_satisfied(&self, m: &PuckWorld, state: &State<PuckWorld>) -> bool {
        (self.test)(problem().goal().is_satisfied(m, state))
    }

    fn sample(&self, m: &PuckWorld, rng: &mut dyn Rng) -> Option<PartialState<PuckWorld>> {
        (self.draw)(problem().goal().sample(m, rng)?)
    }
}

struct Draw(fn(&PuckWorld, PartialState<PuckWorld>, &mut dyn Rng) -> PartialState<PuckWorld>);

impl Sampler<PuckWorld> for Draw {
    fn sample(&self, m: &PuckWorld, goal: &dyn Goal<PuckWorld>, rng: &mut dyn Rng) -> PartialState<PuckWorld> {
        let sample = RandomSubset.sample(m, goal, rng);
        (self.0)(m, sample, rng)
    }
}

struct Metres(fn(f64, &PuckWorld, &State<PuckWorld>, &PartialState<PuckWorld>) -> f64);

impl Distance<PuckWorld> for Metres {
    fn distance(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> f64 {
        (self.0)(GreedyVisit.distance(m, from, to), m, from, to)
    }
}

type Verdict = fn(&Judge, &PuckWorld, &State<PuckWorld>, &dyn Goal<PuckWorld>, &Plan<PuckWorld>) -> bool;

struct Court(Verdict);

impl Verifier<PuckWorld> for Court {
    fn verify(
        &self,
        m: &PuckWorld,
        start: &State<PuckWorld>,
        goal: &dyn Goal<PuckWorld>,
        plan: &Plan<PuckWorld>,
    ) -> Result<Verified, Refusal> {
        let wall = darrt_core::testing::puck::Outline::Rectangle { lower: [1.9, 0.0], upper: [2.1, 1.0] };
        let wall = darrt_core::testing::puck::Obstacle { name: "wall".into(), outline: wall };
        let is_right = (self.0)(&Judge::new(vec![wall]), m, start, goal, plan);
        let refusal = || Refusal { step: None, at: 0.0, reason: "wrong".to_owned() };
        if is_right { Ok(Verified::default()) } else { Err(refusal()) }
    }
}

fn others() -> Vec<Mutant> {
    let mut all: Vec<Mutant> = Vec::new();
    let goals: Vec<(&'static str, Aim)> = vec![
        ("is negated", Aim { test: |found| !found, draw: Some }),
        ("is always satisfied", Aim { test: |_| true, draw: Some }),
        ("is never satisfied", Aim { test: |_| false, draw: Some }),
        (
            "samples another place",
            Aim { test: |found| found, draw: |target| Some(target.with_object(ObjectId::new(0), [1.2, 2.3])) },
        ),
        (
            "samples a place outside",
            Aim { test: |found| found, draw: |target| Some(target.with_object(ObjectId::new(0), [1.2, 9.0])) },
        ),
    ];
    for (what, Aim { test, draw }) in goals {
        all.push(("Reach", what, Box::new(move || notices(|all| all.goal(Aim { test, draw })))));
    }
    let samplers: Vec<(&'static str, Draw)> =
        vec![
            (
                "names nothing now and then",
                Draw(|m, s, rng| if rand::RngExt::random_bool(rng, 0.01) { PartialState::anywhere(m) } else { s }),
            ),
            (
                "never names the robot",
                Draw(|m, s, _| {
                    let objects = s.objects().fold(PartialState::anywhere(m), |all, (id, at)| all.with_object(id, *at));
                    if objects.components().is_empty() {
                        objects.with_object(ObjectId::new(0), [1.0, 1.0])
                    } else {
                        objects
                    }
                }),
            ),
            (
                "outside now and then",
                Draw(|_, s, rng| {
                    if rand::RngExt::random_bool(rng, 0.01) { s.with_object(ObjectId::new(1), [9.0, 1.0]) } else { s }
                }),
            ),
            (
                "half of the room",
                Draw(|_, s, _| match s.object(ObjectId::new(0)).copied() {
                    Some([x, y]) => s.with_object(ObjectId::new(0), [0.5 * x + 0.06, y]),
                    None => s,
                }),
            ),
        ];
    for (what, Draw(draw)) in samplers {
        all.push(("RandomSubset", what, Box::new(move || notices(|all| all.sampler(Draw(draw))))));
    }
    let distances: Vec<(&'static str, Metres)> = vec![
        ("is 0", Metres(|_, _, _, _| 0.0)),
        ("has another sign", Metres(|metres, _, _, _| -metres)),
        ("is one too much", Metres(|metres, _, _, _| metres + 1.0)),
        ("is at most one", Metres(|metres, _, _, _| metres.min(1.0))),
        ("is the rest", Metres(|metres, _, _, _| 1.0 / metres)),
        (
            "forgets the objects",
            Metres(|_, m, from, to| m.robot().distance(&from.robot, &to.robot_overlay(m, &from.robot))),
        ),
        ("forgets the robot", Metres(|metres, m, from, to| if to.are_objects_met(m, from) { 0.0 } else { metres })),
        ("counts everything", Metres(|metres, _, from, _| metres + from.objects[1][0])),
        ("is rounded", Metres(|metres, _, _, _| (metres * 2.0).floor() / 2.0)),
    ];
    for (what, Metres(metres)) in distances {
        all.push(("GreedyVisit", what, Box::new(move || notices(|all| all.distance(Metres(metres))))));
    }
    let verdicts: Vec<(&'static str, Verdict)> = vec![
        ("accepts everything", |_, _, _, _, _| true),
        ("refuses everything", |_, _, _, _, _| false),
        ("forgets the goal", |judge, m, start, _, plan| {
            let any = darrt_core::goal::Region::<PuckWorld>::new(Box::new(|_, _| true), Box::new(|_, _| None));
            judge.verify(m, start, &any, plan).is_ok()
        }),
        ("forgets the start", |judge, m, _, goal, plan| judge.verify(m, plan.start(), goal, plan).is_ok()),
        ("forgets the first step", |judge, m, start, goal, plan| {
            let rest: Vec<_> = plan.steps().iter().skip(1).cloned().collect();
            let start = if plan.steps().is_empty() { start.clone() } else { plan.at(m, 0, 1.0).unwrap() };
            judge.verify(m, &start, goal, &Plan::new(start.clone(), rest)).is_ok()
        }),
        ("looks at the end alone", |_, m, _, goal, plan| goal.is_satisfied(m, &plan.end(m))),
    ];
    for (what, verdict) in verdicts {
        all.push(("Judge", what, Box::new(move || notices(|all| all.verifier(Court(verdict))))));
    }
    all
}
