//! One run as one line of JSON.

use std::collections::BTreeMap;
use std::fmt;

use darrt_core::budget::Stop;
use darrt_core::observe::accounts::Bucket;
use serde::{Deserialize, Serialize};

use super::error::{BenchError, Unlike};
use super::machine::Machine;
use super::survival::Observation;
use darrt_task::picture::{Story, Travel};
use darrt_task::planning::PlanResult;
use darrt_task::program::Program;

/// The only accepted value of the key `format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RecordFormat {
    /// `"format": "darrt-run"`.
    #[serde(rename = "darrt-run")]
    DarrtRun,
}

/// The name of a run: unique in a benchmark.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key {
    /// Name of the problem.
    pub problem: String,
    /// Name of the variant.
    pub variant: String,
    /// The seed.
    pub seed: u64,
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}", self.problem, self.variant, self.seed)
    }
}

/// What must be the same for runs of one problem that are put together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Version of darrt.
    pub darrt: String,
    /// Short name of the problem's text.
    pub problem_digest: String,
    /// Wall-clock limit of the run, seconds.
    pub time_limit_s: f64,
    /// Limit of iterations.
    pub iteration_limit: Option<u64>,
}

impl Conditions {
    /// Refuses the run `run` of `file`, done under these conditions, if the others were done under `expected`.
    ///
    /// # Errors
    /// [`BenchError::Conditions`] with the first condition that differs.
    pub fn check(&self, expected: &Self, run: &Key, file: &str, remedy: &'static str) -> Result<(), BenchError> {
        let limit = |limit: Option<u64>| limit.map_or_else(|| "none".to_owned(), |limit| limit.to_string());
        let pairs = [
            ("darrt version", self.darrt.clone(), expected.darrt.clone()),
            ("a problem of digest", self.problem_digest.clone(), expected.problem_digest.clone()),
            ("the time limit", format!("{} s", self.time_limit_s), format!("{} s", expected.time_limit_s)),
            ("the iteration limit", limit(self.iteration_limit), limit(expected.iteration_limit)),
        ];
        match pairs.into_iter().find(|(_, found, expected)| found != expected) {
            None => Ok(()),
            Some((what, found, expected)) => {
                let (file, run) = (file.to_owned(), run.to_string());
                Err(Unlike { file, run, what, found, expected, remedy }.into())
            }
        }
    }
}

/// Seconds of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Search, shortening and verification together: until the accepted plan, or until it gave up.
    pub total: f64,
    /// Building and checking the problem, before all that.
    pub prepare: f64,
    /// Until the accepted plan was first found, not yet shortened or verified.
    pub first_plan: Option<f64>,
    /// Making that plan shorter.
    pub shortening: f64,
    /// In the verifier.
    pub verification: f64,
}

/// What one primitive did and cost in a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PrimitiveRecord {
    /// Its name.
    pub name: String,
    /// Seconds in its `propagate`.
    pub propagate_s: f64,
    /// Seconds spent on judging its motions.
    pub collision_s: f64,
    /// Seconds spent on ways around for its motions.
    pub local_repair_s: f64,
    /// How many extensions it ended in which way; ways that did not occur are left out.
    pub ends: BTreeMap<String, u64>,
}

/// How good the plan is. What older records do not hold is absent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanQuality {
    /// Steps.
    pub steps: usize,
    /// Seconds of execution, as [`ExecutionTime`](darrt_primitives::execution_time::ExecutionTime) counts them.
    #[serde(default)]
    pub execution_s: Option<f64>,
    /// Way of the base, metres.
    pub base_m: f64,
    /// Turns of the base, degrees.
    #[serde(default)]
    pub turn_deg: Option<f64>,
    /// Turns of all joints of the arm together, radians.
    #[serde(default)]
    pub arm_rad: Option<f64>,
    /// Way of the hand as seen from the base, metres.
    pub hand_m: f64,
    /// Way of the objects, metres.
    pub object_m: f64,
    /// Where two bodies that may not touch are nearest, metres.
    #[serde(default)]
    pub clearance_m: Option<f64>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Says what the line is; always `darrt-run`.
    pub format: RecordFormat,
    /// Name of the problem.
    pub problem: String,
    /// Name of the variant.
    pub variant: String,
    /// The seed.
    pub seed: u64,
    /// What must be the same for comparable runs.
    pub conditions: Conditions,
    /// Mean planning time that the paper reports for the problem, seconds.
    pub paper_s: Option<f64>,
    /// Was a plan found and accepted?
    pub solved: bool,
    /// Why it stopped.
    pub stop: String,
    /// Times.
    pub seconds: Seconds,
    /// Iterations over all attempts.
    pub iterations: u64,
    /// Nodes of the largest tree.
    pub nodes: u64,
    /// Attempts begun anew.
    pub restarts: u64,
    /// Iterations of each attempt. All but the last of a solved run were given up: they are censored.
    pub attempts: Vec<u64>,
    /// Plans that the verifier refused.
    pub refused: u64,
    /// The plan, if there is one.
    pub plan: Option<PlanQuality>,
    /// Metres from the goal to the nearest state; absent if that is not known.
    pub nearest_to_goal_m: Option<f64>,
    /// What each primitive did.
    pub primitives: Vec<PrimitiveRecord>,
    /// Where it ran.
    pub machine: Machine,
    /// When it began, seconds since 1970.
    pub started_unix_s: u64,
    /// The name of the page of its plan, if plans are kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<String>,
}

impl Record {
    /// The record of a finished run; `None` for one that was cancelled, which says nothing.
    pub fn of(
        program: &dyn Program,
        key: Key,
        conditions: Conditions,
        result: &PlanResult,
        attempts: Vec<u64>,
        (machine, started_unix_s): (Machine, u64),
        paper_s: Option<f64>,
    ) -> Option<Self> {
        if result.stop == Stop::Cancelled {
            return None;
        }
        let seconds = Seconds {
            total: result.elapsed.as_secs_f64(),
            prepare: result.times.prepare_s,
            first_plan: result.times.first_plan_s,
            shortening: result.times.shortening_s,
            verification: result.times.verification_s,
        };
        Some(Self {
            format: RecordFormat::DarrtRun,
            problem: key.problem,
            variant: key.variant,
            seed: key.seed,
            conditions,
            paper_s,
            solved: result.plan.is_some(),
            stop: result.stop.to_string(),
            seconds,
            iterations: result.iterations,
            nodes: result.nodes as u64,
            restarts: result.restarts,
            attempts,
            refused: result.accounts.refused,
            plan: quality(program, result),
            nearest_to_goal_m: Some(result.nearest_to_goal).filter(|metres| metres.is_finite()),
            primitives: primitives(result),
            machine,
            started_unix_s,
            page: None,
        })
    }

    /// Its name.
    pub fn key(&self) -> Key {
        Key { problem: self.problem.clone(), variant: self.variant.clone(), seed: self.seed }
    }

    /// Was it solved within the time limit? A plan that was found in time but verified after it came too late: the runs
    /// without a plan were not given that time either.
    pub fn is_in_time(&self) -> bool {
        self.solved && self.seconds.total <= self.conditions.time_limit_s
    }

    /// Seconds until solved; a run that was not solved in time is censored at the limit, or where it ended before.
    pub fn time(&self) -> Observation {
        Observation { value: self.seconds.total.min(self.conditions.time_limit_s), is_event: self.is_in_time() }
    }
}

fn quality(program: &dyn Program, result: &PlanResult) -> Option<PlanQuality> {
    let plan = result.plan.as_ref()?;
    let story = Story::of_plan(plan, &program.facts(&plan.problem).ok()?).ok()?;
    let travel = story.steps.iter().fold(Travel::default(), |sum, step| sum.plus(&Travel::of(&story, step)));
    let nearest = result.proof.as_ref().and_then(|proof| proof.smallest_clearance.as_ref());
    Some(PlanQuality {
        steps: story.steps.len(),
        execution_s: result.execution_s,
        base_m: travel.base_m,
        turn_deg: Some(travel.base_turn.to_degrees()),
        arm_rad: Some(travel.arm_turn),
        hand_m: travel.hand_m,
        object_m: travel.object_m,
        clearance_m: nearest.map(|nearest| nearest.distance_m),
    })
}

fn primitives(result: &PlanResult) -> Vec<PrimitiveRecord> {
    let one = |(name, counts): (&'static str, &[u64; Bucket::ALL.len()])| {
        let times = result.times.primitives.get(name).copied().unwrap_or_default();
        let ends = Bucket::ALL.into_iter().zip(counts).filter(|(_, count)| **count > 0);
        PrimitiveRecord {
            name: name.to_owned(),
            propagate_s: times.propagate_s,
            collision_s: times.collision_s,
            local_repair_s: times.local_repair_s,
            ends: ends.map(|(bucket, count)| (bucket.heading().to_owned(), *count)).collect(),
        }
    };
    result.accounts.rows().map(one).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A run that was solved, or not, after `seconds`.
    pub(crate) fn sample(problem: &str, variant: &str, seed: u64, seconds: f64, solved: bool) -> Record {
        Record {
            format: RecordFormat::DarrtRun,
            problem: problem.to_owned(),
            variant: variant.to_owned(),
            seed,
            conditions: Conditions {
                darrt: "0.1.0".to_owned(),
                problem_digest: "d".to_owned(),
                time_limit_s: 60.0,
                iteration_limit: None,
            },
            paper_s: Some(66.0),
            solved,
            stop: if solved { "solved" } else { "time limit reached" }.to_owned(),
            seconds: Seconds {
                total: seconds,
                prepare: 0.01,
                first_plan: solved.then_some(seconds * 0.7),
                shortening: if solved { seconds * 0.2 } else { 0.0 },
                verification: if solved { seconds * 0.1 } else { 0.0 },
            },
            iterations: seed.saturating_add(100),
            nodes: 50,
            restarts: 0,
            attempts: vec![seed.saturating_add(100)],
            refused: 0,
            plan: solved.then_some(PlanQuality {
                steps: 5,
                execution_s: Some(30.0),
                base_m: 1.0,
                turn_deg: Some(90.0),
                arm_rad: Some(4.0),
                hand_m: 2.0,
                object_m: 3.0,
                clearance_m: Some(0.02),
            }),
            nearest_to_goal_m: (!solved).then_some(0.5),
            primitives: vec![PrimitiveRecord {
                name: "Pick".to_owned(),
                propagate_s: seconds * 0.3,
                collision_s: seconds * 0.2,
                local_repair_s: 0.0,
                ends: BTreeMap::from([("accepted".to_owned(), 3), ("no grasp".to_owned(), seed.saturating_add(97))]),
            }],
            machine: Machine {
                host: "host".to_owned(),
                cpu: "CPU".to_owned(),
                cores: 2,
                jobs: 1,
                build: "b".to_owned(),
            },
            started_unix_s: seed.saturating_add(1_700_000_000),
            page: None,
        }
    }

    #[test]
    fn what_is_solved_too_late_is_censored_at_the_limit() {
        let time = |seconds, solved| sample("bowl", "default", 0, seconds, solved).time();
        let at = |value, is_event| Observation { value, is_event };
        assert_eq!((time(60.0, true), time(60.1, true)), (at(60.0, true), at(60.0, false)));
        assert_eq!((time(12.0, false), time(60.2, false)), (at(12.0, false), at(60.0, false)));
    }

    #[test]
    fn a_record_survives_the_way_through_json() {
        for solved in [true, false] {
            let record = sample("bowl", "default", u64::MAX, 0.1 + 0.2, solved);
            let line = serde_json::to_string(&record).unwrap();
            assert!(!line.contains('\n'));
            assert_eq!(serde_json::from_str::<Record>(&line).unwrap(), record);
        }
        assert!(serde_json::from_str::<Record>("{\"format\":\"darrt-plan\"}").is_err());
    }
}
