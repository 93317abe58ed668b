//! The guide "Is my primitive right?" shows code that compiles, a test that runs, and messages that the kit
//! really prints.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::laws::{PrimitiveClaims, Tried, check_primitive, try_primitive};
use darrt_core::laws::{Report, Subjects, check_everything};
use darrt_core::partial::PartialState;
use darrt_core::state::{ObjectId, State};
use darrt_core::testing::puck::{Clearance, Mode, Puck, PuckWorld, paper_strategy, problems};
use darrt_core::testing::strategies::{config, tasks_from, valid_states};
use proptest::prelude::*;

#[allow(unreachable_pub, reason = "the guide shows it as users write it")]
#[path = "guide/nudge.rs"]
mod nudge;
#[allow(unreachable_pub, reason = "the guide shows it as users write it")]
#[path = "guide/nudge_broken.rs"]
mod nudge_broken;

use nudge::Nudge;

// The ten lines of the guide.
include!("guide/law.rs");

/// The user's oracle of the guide: here one that knows no obstacles but the puck.
fn free(m: &PuckWorld, state: &State<PuckWorld>) -> bool {
    use darrt_core::domain::Domain;
    use darrt_core::space::ComponentSpace;
    m.robot().contains(&state.robot) && m.gap(state, ObjectId::new(0)) >= 0.0
}

// The ten lines that check everything.
include!("guide/everything.rs");

const GUIDE: &str = include_str!("../docs/is-my-primitive-right.md");

/// The task of the guide: a puck that is a sixteenth of a metre from its target.
fn task() -> (PuckWorld, State<PuckWorld>, PartialState<PuckWorld>) {
    let red = Puck { name: "red".into(), radius_m: 0.12, is_graspable: false };
    let m = PuckWorld::new([4.0, 3.0], 0.15, vec![red]).unwrap();
    let from = State { robot: [1.0, 1.0], objects: [[2.0, 1.0]].into_iter().collect(), mode: Mode::resting(1) };
    let to = PartialState::anywhere(&m).with_object(ObjectId::new(0), [2.0625, 1.0]);
    (m, from, to)
}

#[test]
fn the_guide_shows_the_code_that_is_tested() {
    for shown in [include_str!("guide/nudge.rs"), include_str!("guide/law.rs"), include_str!("guide/everything.rs")] {
        assert!(GUIDE.contains(&format!("```rust\n{shown}```")), "the guide does not show:\n{shown}");
        assert!(shown.lines().count() <= 60);
    }
    let (right, wrong) = (include_str!("guide/nudge.rs"), include_str!("guide/nudge_broken.rs"));
    let differing: Vec<_> = right.lines().zip(wrong.lines()).filter(|(a, b)| a != b).collect();
    assert_eq!((differing.len(), right.lines().count()), (1, wrong.lines().count()));
    let [(before, after)] = differing[..] else { panic!("{differing:?}") };
    assert!(GUIDE.contains(&format!("```diff\n-{before}\n+{after}\n```")), "the guide shows another line than {after}");
}

#[test]
fn the_guide_shows_what_the_kit_prints() {
    let (m, from, to) = task();
    let tried = try_primitive(&m, &Nudge, &from, &to, 0, &PrimitiveClaims::default());
    assert!(matches!(tried, Ok(Tried::Propagated(_))));
    let broken = check_primitive(&m, &nudge_broken::Nudge, &from, &to, 0).unwrap_err();
    let printed = format!("```text\n{broken}\n```");
    assert!(GUIDE.contains(&printed), "the guide does not show:\n{printed}");
}

#[test]
fn random_tasks_find_the_broken_line_by_themselves() {
    let (m, _, _) = task();
    let free = Clearance::default();
    let tasks = tasks_from(&m, valid_states(&m, Mode::resting(1), &free));
    let runs = ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() };
    let rng = proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha);
    let found = proptest::test_runner::TestRunner::new_with_rng(runs, rng).run(&tasks, |(from, to, seed)| {
        check_primitive(&m, &nudge_broken::Nudge, &from, &to, seed)?;
        Ok(())
    });
    let text = found.unwrap_err().to_string();
    assert!(text.contains("primitive.progress"), "{text}");
}
