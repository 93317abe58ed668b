//! The laws are tested, too: each rejects the implementors that break it, and passes their honest twins.
#![cfg(feature = "testing")]

use std::collections::BTreeSet;

use darrt_primitives::laws;
use darrt_primitives::testing::broken::cases;

/// With so many seeds every broken implementor must be rejected.
const SEEDS: u64 = 20;

#[test]
fn every_broken_implementor_is_rejected_by_its_law_and_the_honest_twin_passes() {
    let mut wrong = Vec::new();
    let mut twins = BTreeSet::new();
    for case in cases() {
        for seed in 0..SEEDS {
            match case.check_broken(seed) {
                Ok(()) => wrong.push(format!("{} passes with seed {seed}, but breaks {}", case.name, case.law)),
                Err(broken) if broken.law != case.law => {
                    wrong.push(format!("{} should break {} with seed {seed}, but\n{broken}", case.name, case.law));
                }
                Err(_) => continue,
            }
            break;
        }
        // Most cases of one kind have the same twin.
        let is_new = twins.insert(case.honest as usize);
        if let Err(broken) = if is_new { case.check_honest(1) } else { Ok(()) } {
            wrong.push(format!("the honest twin of {} breaks\n{broken}", case.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_law_catches_something() {
    let caught: BTreeSet<_> = cases().iter().map(|case| case.law).collect();
    let idle: Vec<_> = laws::all().filter(|law| !caught.contains(law)).collect();
    assert!(idle.is_empty(), "laws that catch nothing: {idle:#?}");
}

#[test]
fn the_broken_are_many_and_distinct() {
    let cases = cases();
    let names: BTreeSet<_> = cases.iter().map(|case| (case.name, case.law)).collect();
    assert!(cases.len() >= 75, "{}", cases.len());
    assert_eq!(names.len(), cases.len());
    assert!(cases.iter().all(|case| case.wrong.len() > 10));
}

#[test]
fn every_message_says_how_to_see_it_again() {
    for case in cases() {
        let Err(broken) = (case.broken)() else { continue };
        let text = broken.to_string();
        assert!(text.contains(broken.name()) && text.contains("found:") && text.contains("against:"), "{text}");
        assert!(text.contains("replay:"), "{text}");
    }
}
