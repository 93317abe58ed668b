//! The laws are tested, too: each rejects the implementors that break it, with every seed, and passes their honest twins.
#![cfg(feature = "testing")]

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{Builder, available_parallelism, scope};

use darrt_core::laws;
use darrt_core::testing::broken::{Case, cases};

/// With so many seeds every broken implementor must be rejected.
const SEEDS: u64 = 20;
/// And so many leave its honest twin alone.
const HONEST_SEEDS: u64 = 4;

/// Why a case is not rejected as it should be, or its twin is.
fn faults(case: &Case, twins: &Mutex<BTreeSet<usize>>) -> Vec<String> {
    let mut faults = Vec::new();
    for seed in 0..SEEDS {
        match case.check_broken(seed) {
            Ok(()) => faults.push(format!("{} passes with seed {seed}, but breaks {}", case.name, case.law)),
            Err(broken) if broken.law != case.law => {
                faults.push(format!("{} should break {} with seed {seed}, but\n{broken}", case.name, case.law));
            }
            Err(_) => continue,
        }
        break;
    }
    // Most cases of one kind have the same twin.
    let is_new = twins.lock().is_ok_and(|mut twins| twins.insert(case.honest as usize));
    let seeds = if is_new { HONEST_SEEDS } else { 0 };
    for seed in 0..seeds {
        if let Err(broken) = case.check_honest(seed) {
            faults.push(format!("the honest twin of {} breaks with seed {seed}\n{broken}", case.name));
            break;
        }
    }
    faults
}

#[test]
fn every_broken_implementor_is_rejected_by_its_law_and_the_honest_twin_passes() {
    let (cases, twins, next) = (cases(), Mutex::default(), AtomicUsize::new(0));
    let work = || -> Vec<String> {
        let taken = std::iter::from_fn(|| cases.get(next.fetch_add(1, Ordering::Relaxed)));
        taken.flat_map(|case| faults(case, &twins)).collect()
    };
    let threads = available_parallelism().map_or(1, usize::from);
    let all: Vec<String> = scope(|scope| {
        // Named like the threads of tests: some of the broken tell from this whether they run on threads of the planner.
        let named = || Builder::new().name("cases".to_owned()).spawn_scoped(scope, work).unwrap();
        let workers: Vec<_> = (0..threads).map(|_| named()).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n\n"));
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
    assert!(cases.len() >= 140, "{}", cases.len());
    assert_eq!(names.len(), cases.len());
    assert!(cases.iter().all(|case| case.wrong.len() > 10));
}

#[test]
fn every_message_says_how_to_see_it_again() {
    for case in cases() {
        let Err(broken) = case.check_broken(1) else { continue };
        let text = broken.to_string();
        assert!(text.contains(broken.name()) && text.contains("found:") && text.contains("against:"), "{text}");
        let is_book = [laws::planner::BALANCED, laws::planner::CANCEL].contains(&broken.law);
        assert!(is_book || text.contains("replay:"), "{text}");
    }
}
