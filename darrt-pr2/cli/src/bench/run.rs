//! The workers: take the next run, plan, hand over the record.

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
use darrt_task::program::Program;

/// Runs `jobs` on `machine.jobs` threads and hands every record to `sink`, on the calling thread, as runs end. Runs that
/// `cancel` cuts short are dropped: they say nothing.
///
/// # Errors
/// [`BenchError::Planning`] for a problem that cannot be planned at all, or what `sink` refuses; the other runs are then
/// cancelled.
pub fn run(
    program: &dyn Program,
    set: &JobSet,
    jobs: &[Job],
    machine: &Machine,
    cancel: &Cancel,
    mut sink: impl FnMut(Record) -> Result<(), BenchError>,
) -> Result<(), BenchError> {
    let next = Mutex::new(jobs.iter().copied());
    let take = || next.lock().ok().and_then(|mut next| next.next());
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
    })
}

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
