//! Proptest strategies for the configurations, states, targets and tasks of any domain.
//!
//! Everything is drawn through [`ComponentSpace::sample`] and shrinks towards one fixed sample, few named
//! components and small seeds, so that a failure ends as a short case.
//!
//! # Example
//! A law test in ten lines:
//! ```
//! use darrt_core::laws::check_primitive;
//! use darrt_core::testing::puck::{Puck, PuckWorld, Mode, Transit};
//! use darrt_core::testing::strategies::{config, tasks};
//! use proptest::proptest;
//!
//! # fn main() -> Result<(), darrt_core::error::Error> {
//! let red = Puck { name: "red".into(), radius_m: 0.12, is_graspable: true };
//! let m = PuckWorld::new([4.0, 3.0], 0.15, vec![red])?;
//! proptest!(config(16, None), |((from, to, seed) in tasks(&m, Mode::resting(1)))| {
//!     check_primitive(&m, &Transit, &from, &to, seed)?;
//! });
//! # Ok(())
//! # }
//! ```

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

use crate::domain::Domain;
use crate::laws::primitive::PrimitiveClaims;
use crate::partial::PartialState;
use crate::random::{Purpose, stream};
use crate::space::{ComponentSpace, GroupSet};
use crate::state::{ObjectId, State};
use crate::validity::Validity;

/// The value of `PROPTEST_CASES` at which [`config`] gives exactly the cases that a test asks for.
pub const NOMINAL_CASES: u32 = 64;

/// `cases` cases. The environment variable `PROPTEST_CASES` scales all tests alike: at
/// [`NOMINAL_CASES`] it changes nothing, at 640 there are ten times as many. Failing cases are written to
/// the file `regressions` (relative to the crate) and tried first from then on.
pub fn config(cases: u32, regressions: Option<&'static str>) -> ProptestConfig {
    let standard = ProptestConfig::default();
    let is_asked = std::env::var_os("PROPTEST_CASES").is_some();
    let scaled = cases.saturating_mul(standard.cases) / NOMINAL_CASES;
    ProptestConfig {
        cases: if is_asked { scaled.max(1) } else { cases },
        failure_persistence: regressions.map(|path| Box::new(FileFailurePersistence::Direct(path)) as _),
        ..standard
    }
}

/// Repeats `round`, which runs a property and says how often there was something to look at, until `enough` were seen, at
/// most 16 times; says how many there were.
///
/// Primitives succeed from few of the states that a strategy draws. One round may see fewer than a test asks for by chance
/// alone; sixteen do so only where the property shows nothing.
///
/// ```
/// use std::cell::Cell;
/// use darrt_core::testing::strategies::{config, seeds, seen};
/// use proptest::proptest;
///
/// let seldom = seen(3, || {
///     let found = Cell::new(0);
///     proptest!(config(16, None), |(seed in seeds())| found.set(found.get() + u32::from(seed % 8 == 0)));
///     found.get()
/// });
/// assert!(seldom >= 3);
/// ```
pub fn seen(enough: u32, mut round: impl FnMut() -> u32) -> u32 {
    let mut seen = 0;
    for _ in 0..16 {
        seen += round();
        if seen >= enough {
            break;
        }
    }
    seen
}

/// Seeds; they shrink to 0.
pub fn seeds() -> impl Strategy<Value = u64> {
    prop_oneof![3 => 0_u64..1000, 1 => any::<u64>()]
}

/// Parameters in `[0, 1]`, the ends among them.
pub fn parameters() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => Just(1.0), 1 => Just(0.5), 6 => 0.0..=1.0_f64]
}

/// Configurations of a space: samples, samples drawn close to one fixed sample, and that sample itself.
pub fn configs<S: ComponentSpace>(space: &S) -> impl Strategy<Value = S::Config> + Clone {
    let home = space.sample(&mut stream(0, 0, 0, Purpose::Sample));
    // A pull of 0 shrinks the case: it is the fixed sample.
    let closeness = prop_oneof![1 => Just(0_u8), 2 => 1..16_u8, 6 => Just(16_u8)];
    (any::<u64>(), closeness).prop_map(move |(seed, pull)| {
        let far = space.sample(&mut stream(seed, 0, 0, Purpose::Sample));
        match pull {
            0 => home.clone(),
            16 => far,
            _ => space.interpolate(&home, &far, f64::from(pull) / 16.0),
        }
    })
}

/// States in `mode`, components anywhere in their spaces; not necessarily free of collisions.
pub fn states<D: Domain>(m: &D, mode: D::Mode) -> impl Strategy<Value = State<D>> + Clone {
    let objects: Vec<_> = m.objects().iter().map(configs).collect();
    (configs(m.robot()), objects).prop_map(move |(robot, objects)| State {
        robot,
        objects: objects.into_iter().collect(),
        mode: mode.clone(),
    })
}

/// States in `mode` that `validity` accepts.
pub fn valid_states<'a, D: Domain>(
    m: &'a D,
    mode: D::Mode,
    validity: &'a dyn Validity<D>,
) -> impl Strategy<Value = State<D>> + Clone + 'a {
    let accepts = move |state: &State<D>| validity.check(m, state, &D::Contacts::default()).is_ok();
    states(m, mode).prop_filter("a valid state", accepts)
}

/// Which of up to 64 things are chosen; shrinks to none.
fn chosen() -> impl Strategy<Value = u64> + Clone {
    prop_oneof![2 => any::<u64>(), 1 => Just(0_u64), 1 => Just(u64::MAX), 2 => (0..8_u32).prop_map(|i| 1 << i)]
}

/// Targets: random subsets of the components (none and all among them), the robot in random groups.
pub fn targets<D: Domain>(m: &D) -> impl Strategy<Value = PartialState<D>> + Clone {
    let objects: Vec<_> = m.objects().iter().map(configs).collect();
    (chosen(), chosen(), configs(m.robot()), objects).prop_map(move |(named, groups, robot, objects)| {
        let target = PartialState::anywhere(m);
        let target = if named & 1 == 0 { target } else { target.with_robot_groups(robot, some_groups(m, groups)) };
        objects.into_iter().enumerate().fold(target, |target, (i, config)| {
            let is_named = named >> (i + 1).min(63) & 1 == 1;
            if is_named { target.with_object(ObjectId::new(i), config) } else { target }
        })
    })
}

/// The groups of the robot that `bits` chooses; all of them for no bits.
fn some_groups<D: Domain>(m: &D, bits: u64) -> GroupSet {
    let all = m.robot().groups();
    let some = (0..32).filter(|i| bits >> i & 1 == 1).map(GroupSet::only);
    let some = some.fold(GroupSet::NONE, GroupSet::union).intersection(all);
    if some.is_empty() { all } else { some }
}

/// A start in `mode`, a target and a seed. In some targets a part is already met.
pub fn tasks<D: Domain>(m: &D, mode: D::Mode) -> impl Strategy<Value = (State<D>, PartialState<D>, u64)> + Clone {
    tasks_from(m, states(m, mode))
}

/// Like [`tasks`], with starts drawn from `starts`: states in several modes, or only valid ones.
pub fn tasks_from<D: Domain>(
    m: &D,
    starts: impl Strategy<Value = State<D>> + Clone,
) -> impl Strategy<Value = (State<D>, PartialState<D>, u64)> + Clone {
    (starts, targets(m), seeds_cloned(), chosen()).prop_map(move |(from, to, seed, met)| {
        // Chosen components that the target names are put where the state has them.
        let to = (0..m.objects().len()).map(ObjectId::new).fold(to, |to, id| {
            let is_met = met >> (id.index() + 1).min(63) & 1 == 1 && to.object(id).is_some();
            match from.object(id).filter(|_| is_met) {
                Some(config) => to.with_object(id, config.clone()),
                None => to,
            }
        });
        (from, to, seed)
    })
}

fn seeds_cloned() -> impl Strategy<Value = u64> + Clone {
    0_u64..10_000
}

/// Parameters at which a law looks at motions, for [`PrimitiveClaims::ts`]: sorted, the ends left out.
pub fn looks() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(0.0..=1.0_f64, 1..8)
}

/// The default claims at other parameters.
pub fn claims_at<D: Domain>(ts: &[f64]) -> PrimitiveClaims<'_, D> {
    PrimitiveClaims { ts, ..PrimitiveClaims::default() }
}
