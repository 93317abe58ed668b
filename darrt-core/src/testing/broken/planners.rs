//! Broken parts that show only when the whole plans.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use super::Case;
use super::bench::{Act, Bench, Rule, robot_at, sample, state};
use super::motions::{go, instance};
use super::samplers::Dice;
use crate::budget::{Budget, Stop};
use crate::distance::Euclidean;
use crate::extend::ExtendOptions;
use crate::goal::{Goal, Reach, Region};
use crate::laws::planner::{BALANCED, CANCEL, REPLAY, SEEDED, THREADS, VALID, VERIFIED};
use crate::laws::{Broken, check_accounts, check_cancel, check_planner};
use crate::motion::Waypoints;
use crate::observe::accounts::{Accounts, Bucket};
use crate::observe::{Event, Observer, Silent};
use crate::plan::Plan;
use crate::problem::{Parts, Problem};
use crate::sample::{Full, Sampler};
use crate::search::Strategy;
use crate::solve::{Outcome, SolveOptions, solve};
use crate::state::{ComponentSet, State};
use crate::validity::FreePrefix;
use crate::verify::{Refusal, Replay, Verified, Verifier};

/// The robot straight to its target.
const GO: Act = Act {
    useful: |m, from, to| !to.is_robot_met(m, from),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
};

/// The robot at 0.5 m, a wall at 1.2 m, and a goal before it.
fn parts() -> Parts<Bench> {
    let rule = Rule { wall: (1.2, 1.3), ..Rule::default() };
    Parts {
        domain: Bench::default(),
        start: state([0.5, 0.0]),
        goal: Box::new(Region::new(
            Box::new(|_, s: &State<Bench>| s.robot[0] < 0.02),
            Box::new(|_, _| Some(robot_at([0.01, 0.0]))),
        )),
        primitives: vec![Box::new(GO)],
        validity: Box::new(rule),
        verifier: Box::new(Replay::new(rule, 1e-2)),
    }
}

fn options() -> SolveOptions {
    let budget = Budget { iterations: Some(60), ..Budget::default() };
    SolveOptions { seed: 3, budget, restart_iterations: Some(15), threads: 1 }
}

fn check(change: impl FnOnce(&mut Parts<Bench>), sampler: Box<dyn Sampler<Bench>>) -> Result<(), Broken> {
    let mut parts = parts();
    change(&mut parts);
    let strategy = Strategy {
        sampler,
        distance: Box::new(Euclidean),
        extend: ExtendOptions::default(),
        local_repair: None,
        try_penalty_m: 0.0,
        shorten: crate::shorten::ShortenOptions::default(),
        improve: None,
    };
    match Problem::new(parts) {
        Ok(problem) => check_planner(&problem, &strategy, &options()),
        Err(error) => Err(Broken::new("planner.problem: the problem is well formed", error.to_string(), "no error")),
    }
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(|_| (), Box::new(Full)) }
}

pub(super) fn cases() -> Vec<Case> {
    [trees(), runs(), books()].concat()
}

fn trees() -> Vec<Case> {
    vec![
        case(
            "starts from where it was last",
            "the motion begins at the start of the problem, not at the node",
            REPLAY,
            || {
                let propagate: super::bench::Propagate = |m, from, to, _| {
                    let origin = state([0.5, 0.0]);
                    let end = State { robot: to.robot_overlay(m, &from.robot), ..origin.clone() };
                    let motion = Waypoints::new(vec![origin, end], &[8.0], from.mode.clone());
                    Ok(motion.into_iter().map(|motion| instance(motion, ComponentSet::ROBOT)).collect())
                };
                check(|parts| parts.primitives = vec![Box::new(Act { propagate, ..GO })], Box::new(Full))
            },
        ),
        case("all motions free", "a free prefix that was left at its default", VALID, || {
            check(
                |parts| {
                    parts.validity = Box::new(Rule {
                        free_prefix: |_, _, _, _| FreePrefix::FREE,
                        wall: (1.2, 1.3),
                        ..Rule::default()
                    });
                },
                Box::new(Full),
            )
        }),
    ]
}

fn runs() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    thread_local! {
        static VERDICTS: Cell<u32> = const { Cell::new(0) };
    }
    struct Moody;
    impl Verifier<Bench> for Moody {
        fn verify(
            &self,
            _: &Bench,
            _: &State<Bench>,
            _: &dyn Goal<Bench>,
            _: &Plan<Bench>,
        ) -> Result<Verified, Refusal> {
            // The first runs are to agree with each other; the law's own question comes last.
            let is_first = VERDICTS.replace(VERDICTS.get() + 1) < 3;
            let refusal = || Refusal { step: None, at: 0.0, reason: "not today".to_owned() };
            if is_first { Ok(Verified::default()) } else { Err(refusal()) }
        }
    }
    vec![
        case("global sequence", "the sampler counts over all runs", SEEDED, || {
            check(|_| (), Box::new(Dice(|_, _| robot_at([golden(CALLS.fetch_add(1, Ordering::Relaxed)), 0.0]))))
        }),
        case(
            "one generator per thread",
            "the sampler keeps its state with the thread that it runs on",
            THREADS,
            || {
                check(
                    |_| (),
                    Box::new(Dice(|_, rng| {
                        // Threads that the planner starts have no name; the one that calls it has.
                        let [x, heading] = sample(rng);
                        if thread::current().name().is_some() {
                            robot_at([x, heading])
                        } else {
                            robot_at([x / 2.0, heading])
                        }
                    })),
                )
            },
        ),
        case("moody verifier", "accepts a plan, and refuses it when asked again", VERIFIED, || {
            VERDICTS.set(0);
            check(
                |parts| {
                    parts.verifier = Box::new(Moody);
                    parts.goal = Box::new(Reach::new(robot_at([0.7, 0.0])));
                },
                Box::new(Dice(|_, _| robot_at([0.7, 0.0]))),
            )
        }),
    ]
}

/// Member `i` of a sequence that fills the rail evenly and never repeats.
fn golden(i: u32) -> f64 {
    (f64::from(i) * 0.618_033_988_749_895).fract() * super::bench::RAIL_M
}

fn books() -> Vec<Case> {
    vec![
        Case {
            name: "one bucket too few",
            wrong: "an extension is counted for the primitives that were tried only",
            law: BALANCED,
            broken: || books_of(&[Bucket::Accepted]),
            honest: || books_of(&[Bucket::Accepted, Bucket::NotUseful]),
        },
        Case {
            name: "deaf solver",
            wrong: "tells the observer, but does not listen to what it answers",
            law: CANCEL,
            broken: || {
                cancelled(|problem, strategy, options, observer| solve(problem, strategy, options, &mut Deaf(observer)))
            },
            honest: || cancelled(solve),
        },
        Case {
            name: "quiet solver",
            wrong: "stops when it is cancelled, but reports that the iterations were used up",
            law: CANCEL,
            broken: || {
                cancelled(|problem, strategy, options, observer| Outcome {
                    stop: Stop::IterationLimit,
                    ..solve(problem, strategy, options, observer)
                })
            },
            honest: || cancelled(solve),
        },
    ]
}

fn books_of(buckets: &[Bucket]) -> Result<(), Broken> {
    let mut accounts = Accounts::new(vec!["Transit", "Push"]);
    accounts.count(buckets, 2, true, None);
    check_accounts(&accounts, 1, 2)
}

/// [`solve`], or something like it.
type Solve = fn(&Problem<Bench>, &Strategy<Bench>, &SolveOptions, &mut dyn Observer) -> Outcome<Bench>;

fn cancelled(run: Solve) -> Result<(), Broken> {
    let mut parts = parts();
    parts.goal = Box::new(Reach::new(robot_at([3.5, 0.0])));
    let strategy = Strategy {
        sampler: Box::new(Full),
        distance: Box::new(Euclidean),
        extend: ExtendOptions::default(),
        local_repair: None,
        try_penalty_m: 0.0,
        shorten: crate::shorten::ShortenOptions::default(),
        improve: None,
    };
    let problem = Problem::new(parts)
        .map_err(|error| Broken::new("planner.problem: the problem is well formed", error.to_string(), "no error"))?;
    check_cancel(&|options, observer| run(&problem, &strategy, options, observer), &options(), 1)
}

/// Passes events on and drops the answers.
struct Deaf<'a>(&'a mut dyn Observer);

impl Observer for Deaf<'_> {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        let _ = self.0.on_event(event);
        Silent.on_event(event)
    }
}
