//! The workers: take the next run, plan, hand over the record.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::mpsc;
use std::time::SystemTime;

use darrt_core::budget::{Cancel, Stop};
use darrt_core::observe::{Event, Observer};

use super::error::BenchError;
use super::job::{Job, JobSet};
use super::kept;
use super::machine::Machine;
use super::record::Record;
use darrt_task::planning::PlanResult;
use darrt_task::planning_error::PlanningError;
use darrt_task::program::Program;

/// Runs `jobs` on `machine.jobs` threads and hands every record to `sink`, on the calling thread, as runs end. Runs that
/// `cancel` cuts short are dropped: they say nothing.
///
/// Returned is what is proven to have no plan, with the proof: it has no runs, and the other problems do not wait for it.
///
/// # Errors
/// [`BenchError::Planning`] for a problem that cannot be planned for another reason, or what `sink` refuses; the other runs
/// are then cancelled.
pub fn run(
    program: &dyn Program,
    set: &JobSet,
    jobs: &[Job],
    machine: &Machine,
    cancel: &Cancel,
    mut sink: impl FnMut(Record) -> Result<(), BenchError>,
) -> Result<Impossible, BenchError> {
    let next = Mutex::new(jobs.iter().copied());
    let impossible = Mutex::new(Impossible::new());
    let is_left_out =
        |job: &Job| impossible.lock().is_ok_and(|proofs| proofs.contains_key(&(job.problem, job.variant)));
    let take = || next.lock().ok().and_then(|mut next| next.find(|job| !is_left_out(job)));
    let leave_out = |job: Job, proof| {
        if let Ok(mut proofs) = impossible.lock() {
            proofs.insert((job.problem, job.variant), proof);
        }
    };
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..machine.jobs.max(1) {
            let sender = sender.clone();
            scope.spawn(move || {
                while !cancel.is_cancelled() {
                    let Some(job) = take() else { return };
                    match one(program, set, job, machine, cancel) {
                        Ok(None) => {}
                        Ok(Some(record)) => drop(sender.send(Ok(record))),
                        Err(BenchError::Planning { source, .. }) if source.is_impossible() => {
                            leave_out(job, *source);
                        }
                        Err(error) => drop(sender.send(Err(error))),
                    }
                }
            });
        }
        drop(sender);
        let mut result = Ok(());
        for outcome in receiver {
            let kept = outcome.and_then(&mut sink);
            if kept.is_err() && result.is_ok() {
                cancel.cancel();
                result = kept;
            }
        }
        result
    })?;
    Ok(impossible.into_inner().unwrap_or_default())
}

/// What is proven to have no plan, by the indices of problem and variant in the set of jobs.
pub type Impossible = BTreeMap<(usize, usize), PlanningError>;

/// One run; `None` if it was cancelled.
fn one(
    program: &dyn Program,
    set: &JobSet,
    job: Job,
    machine: &Machine,
    cancel: &Cancel,
) -> Result<Option<Record>, BenchError> {
    let (Some(request), Some(conditions)) = (set.request(job), set.conditions(job.problem)) else { return Ok(None) };
    let key = set.key(job);
    let started = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let mut attempts = Attempts::default();
    let result: PlanResult = program
        .plan(&request, cancel, &mut attempts)
        .map_err(|source| BenchError::Planning { problem: key.problem.clone(), source: Box::new(source) })?;
    let page = match set.keep() {
        Some(folder) => kept::keep(program, folder, (&key, &conditions.problem_digest), &result)?,
        None => None,
    };
    let paper = request.problem.paper.as_ref().map(|paper| paper.planning_time_s);
    let record = Record::of(program, key, conditions, &result, attempts.ended, (machine.clone(), started), paper);
    Ok(record.map(|record| Record { page, ..record }))
}

/// Counts the iterations of each attempt; for one thread, on which attempts do not overlap.
#[derive(Debug, Default)]
struct Attempts {
    iterations: u64,
    ended: Vec<u64>,
}

impl Observer for Attempts {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Iteration { .. } => self.iterations += 1,
            Event::AttemptEnded { stop, .. } if *stop != Stop::Overtaken => {
                self.ended.push(std::mem::take(&mut self.iterations));
            }
            _ => {}
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::job::Subject;
    use crate::bench::shard::Shard;
    use crate::bench::variant::Variant;

    /// Three quick problems that end by their count of iterations: outcomes that do not depend on the machine.
    fn set() -> JobSet {
        let subjects = vec![Subject::open(&darrt_pr2::registry(), "bowl").unwrap()];
        let variants = vec![Variant::named("default").unwrap(), Variant::named("no-shortening").unwrap()];
        JobSet::new(subjects, variants, 0..3, None, Some(4)).unwrap()
    }

    fn machine(jobs: usize) -> Machine {
        Machine { host: String::new(), cpu: String::new(), cores: 1, jobs, build: String::new() }
    }

    #[test]
    fn the_outcomes_do_not_depend_on_how_many_run_at_once() {
        let set = set();
        let jobs: Vec<_> = set.jobs(Shard::WHOLE).collect();
        let outcomes = |count| {
            let mut records = Vec::new();
            run(&darrt_pr2::registry(), &set, &jobs, &machine(count), &Cancel::new(), |record| {
                assert!(record.solved || record.iterations == 4);
                assert_eq!(record.attempts, [record.iterations]);
                let ends = record.primitives.iter().map(|p| p.ends.values().sum::<u64>());
                assert!(ends.clone().all(|sum| sum == record.iterations), "balanced: {:?}", ends.collect::<Vec<_>>());
                assert_eq!(record.seconds.first_plan.is_some(), record.solved);
                records.push((record.key(), record.solved, record.stop, record.iterations, record.nodes));
                Ok(())
            })
            .unwrap();
            records.sort();
            records
        };
        let one = outcomes(1);
        assert_eq!(one.len(), 6);
        assert_eq!(outcomes(3), one);
    }

    #[test]
    fn a_problem_that_is_proven_to_have_no_plan_is_left_out_and_the_others_are_run() {
        let registry = darrt_pr2::registry();
        let hopeless = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/everyday/heavy-plate.toml");
        let subjects = [hopeless, "bowl"].map(|name| Subject::open(&registry, name).unwrap());
        let variants = vec![Variant::named("default").unwrap()];
        let set = JobSet::new(subjects.to_vec(), variants, 0..3, None, Some(4)).unwrap();
        let jobs: Vec<_> = set.jobs(Shard::WHOLE).collect();
        for workers in [1, 3] {
            let mut run_of = Vec::new();
            let proofs = run(&registry, &set, &jobs, &machine(workers), &Cancel::new(), |record| {
                run_of.push(record.problem);
                Ok(())
            })
            .unwrap();
            assert_eq!(run_of, ["bowl"; 3]);
            assert!(proofs.keys().eq(&[(0, 0)]) && proofs[&(0, 0)].is_impossible());
        }
    }

    #[test]
    fn a_cancelled_run_leaves_no_record_and_an_error_ends_all() {
        let set = set();
        let jobs: Vec<_> = set.jobs(Shard::WHOLE).collect();
        let cancel = Cancel::new();
        cancel.cancel();
        run(&darrt_pr2::registry(), &set, &jobs, &machine(2), &cancel, |_| panic!("nothing was run")).unwrap();
        let mut seen = 0;
        let error = run(&darrt_pr2::registry(), &set, &jobs, &machine(1), &Cancel::new(), |record| {
            seen += 1;
            Err(BenchError::SameName { name: record.problem })
        });
        assert!(error.is_err());
        assert!(seen < jobs.len(), "the others were cancelled");
    }
}
