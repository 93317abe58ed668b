//! PATH and EXTENDTOWARDS on the puck domain: they end within their bounds, what they return is chained and valid, and
//! the accounts balance; every primitive keeps its laws.
#![no_main]

use arbitrary::Arbitrary;
use darrt_core::extend::{ExtendOptions, extend_towards};
use darrt_core::laws::{check_accounts, check_primitive};
use darrt_core::observe::accounts::Accounts;
use darrt_core::partial::PartialState;
use darrt_core::path::{PathEnd, Trial, path};
use darrt_core::primitive::Primitive;
use darrt_core::problem::Problem;
use darrt_core::random::{Purpose, stream};
use darrt_core::search::Darrt;
use darrt_core::state::State;
use darrt_core::testing::puck::{PuckWorld, paper_strategy};
use darrt_fuzz::puck::{StateSketch, TargetSketch, primitives, problem, world};
use libfuzzer_sys::fuzz_target;

#[derive(Debug, Arbitrary)]
struct Case {
    pucks: u8,
    state: StateSketch,
    target: TargetSketch,
    depth: u8,
    spacing: u8,
    seed: u64,
}

fuzz_target!(|case: Case| {
    let m = world(case.pucks);
    let from = case.state.state(&m);
    let to = case.target.target(&m, &from);
    let depth = usize::from(case.depth % 32) + 1;
    let primitives = primitives();
    path_ends(&m, &primitives, &from, &to, depth, case.seed);
    for primitive in &primitives {
        check_primitive(&m, &**primitive, &from, &to, case.seed).unwrap_or_else(|broken| panic!("{broken}"));
    }
    if let Some(problem) = problem(&m, &from, &to) {
        let options = ExtendOptions {
            spacing_m: 0.01 * f64::from(case.spacing.max(1)),
            max_depth: depth,
            ..ExtendOptions::default()
        };
        extension_is_valid(&problem, &options, &to, case.seed);
        search_balances(&problem, case.seed);
    }
});

fn path_ends(
    m: &PuckWorld,
    primitives: &[Box<dyn Primitive<PuckWorld>>],
    from: &State<PuckWorld>,
    to: &PartialState<PuckWorld>,
    depth: usize,
    seed: u64,
) {
    let path = path(m, primitives, from, to, depth, &mut stream(seed, 0, 0, Purpose::Extend));
    let propagated = path.trials.iter().filter(|(_, trial)| matches!(trial, Trial::Propagated { .. })).count();
    assert!(propagated <= depth && path.trials.len() <= depth * primitives.len(), "{path:?}");
    assert_eq!(path.states.len(), path.instances.len() + 1);
    assert_eq!(path.states[0], *from);
    for ((_, instance), ends) in path.instances.iter().zip(path.states.windows(2)) {
        assert_eq!(instance.at(m, 0.0, from), ends[0], "{instance:?}");
        assert_eq!(instance.at(m, 1.0, from), ends[1], "{instance:?}");
    }
    let is_met = path.states.last().is_some_and(|last| to.is_met(m, last));
    assert_eq!(path.end == PathEnd::Met, is_met, "{path:?}");
}

fn extension_is_valid(problem: &Problem<PuckWorld>, options: &ExtendOptions, to: &PartialState<PuckWorld>, seed: u64) {
    let (m, from) = (problem.domain(), problem.start());
    let extension = extend_towards(problem, options, from, to, &mut stream(seed, 0, 0, Purpose::Extend));
    for reached in &extension.reached {
        assert!(reached.t > 0.0 && reached.t <= 1.0);
        assert_eq!(reached.instance.at(m, reached.t, from), reached.state);
        let valid = problem.validity().check(m, &reached.state, &reached.instance.contacts);
        assert!(valid.is_ok(), "{valid:?} at {reached:?}");
    }
    if extension.is_met {
        assert!(to.is_met(m, extension.reached.last().map_or(from, |last| &last.state)));
        assert!(extension.blame.is_none());
    }
    let names = problem.primitives().iter().map(|primitive| primitive.name()).collect();
    let mut accounts = Accounts::new(names);
    accounts.count(&extension.buckets, extension.reached.len(), extension.is_met, extension.blame.as_ref());
    check_accounts(&accounts, 1, extension.reached.len() as u64).unwrap_or_else(|broken| panic!("{broken}"));
}

fn search_balances(problem: &Problem<PuckWorld>, seed: u64) {
    let strategy = paper_strategy().expect("the paper's numbers are in range");
    let mut darrt = Darrt::new(problem, &strategy, seed, 0, 200);
    for _ in 0..8 {
        darrt.step();
    }
    let added = darrt.tree().len() as u64 - 1;
    check_accounts(darrt.accounts(), darrt.iteration(), added).unwrap_or_else(|broken| panic!("{broken}"));
}
