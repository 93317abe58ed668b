//! Many executions of one plan, on all cores, in an order that the number of cores does not change.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use darrt_core::budget::Cancel;
use serde::Serialize;

use crate::noise::NoiseModel;
use crate::run::{Execution, Loop, RunReport};
use crate::watch::Cause;

/// What many runs came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Runs {
    /// In the order of their numbers.
    pub runs: Vec<RunReport>,
    /// Were all done, or was it interrupted?
    pub is_complete: bool,
}

/// Why runs failed, and how often.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailureCount {
    /// The plan: 0 is the one that was to be executed, 1 the first that was made on the way.
    pub plan: usize,
    /// The step in which they parted from it, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: String,
    /// What happened first.
    pub cause: Cause,
    /// To what, and with what.
    pub bodies: String,
    /// How many.
    pub count: usize,
}

/// Executes a plan `count` times on so many threads. `done` hears of every run as it ends, in no certain order.
///
/// # Laws
/// The reports do not depend on `threads`.
pub fn execute(
    execution: &Execution<'_>,
    noise: &NoiseModel,
    control: Loop<'_>,
    (seed, count): (u64, u64),
    threads: usize,
    cancel: &Cancel,
    done: &(dyn Fn(&RunReport) + Sync),
) -> Runs {
    let next = AtomicU64::new(0);
    let all = Mutex::new(BTreeMap::new());
    let work = || {
        loop {
            let run = next.fetch_add(1, Ordering::Relaxed);
            if run >= count {
                return;
            }
            let Some(report) = execution.run(noise, (seed, run), control, cancel) else { return };
            done(&report);
            if let Ok(mut all) = all.lock() {
                all.insert(run, report);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.max(1) {
            scope.spawn(work);
        }
        work();
    });
    let runs: Vec<_> = all.into_inner().unwrap_or_default().into_values().collect();
    Runs { is_complete: runs.len() as u64 == count, runs }
}

impl Runs {
    /// How many ended within the tolerance of the problem.
    pub fn successes(&self) -> usize {
        self.runs.iter().filter(|run| run.is_success).count()
    }

    /// How many ended within 5 cm.
    pub fn near(&self) -> usize {
        self.runs.iter().filter(|run| run.is_near).count()
    }

    /// The failures by step and cause, the most frequent first.
    pub fn failures(&self) -> Vec<FailureCount> {
        let mut counts: BTreeMap<(usize, usize, Cause, String), (String, usize)> = BTreeMap::new();
        for departure in self.runs.iter().filter(|run| !run.is_success).filter_map(|run| run.departure.as_ref()) {
            let other = departure.other.as_ref().map_or_else(String::new, |other| format!(", {other}"));
            let key = (departure.plan, departure.step, departure.cause, format!("{}{other}", departure.body));
            counts.entry(key).or_insert_with(|| (departure.primitive.clone(), 0)).1 += 1;
        }
        let counts = counts.into_iter().map(|((plan, step, cause, bodies), (primitive, count))| FailureCount {
            plan,
            step,
            primitive,
            cause,
            bodies,
            count,
        });
        let mut counts: Vec<_> = counts.collect();
        counts.sort_by_key(|failure| std::cmp::Reverse(failure.count));
        counts
    }
}
