//! What is to be run: problems x variants x seeds, in a fixed order.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::digest::digest;
use super::error::BenchError;
use super::record::{Conditions, Key};
use super::shard::Shard;
use super::variant::Variant;
use darrt_task::planning::PlanRequest;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::text_file;

/// A problem of a benchmark.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The problem.
    pub problem: ProblemFile,
    /// Short name of its text.
    pub digest: String,
}

impl Subject {
    /// A built-in problem or a file, as on the command line.
    ///
    /// # Errors
    /// As [`Program::open`].
    pub fn open(program: &dyn Program, name_or_path: &str) -> Result<Self, BenchError> {
        let problem = program.open(name_or_path)?;
        let text = match program.problems().find(name_or_path) {
            Some(built_in) => built_in.text.to_owned(),
            None => text_file::read(name_or_path.as_ref(), darrt_task::problem_file::read::MAX_BYTES)?,
        };
        Ok(Self { problem, digest: digest(text.as_bytes()) })
    }
}

/// One run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Job {
    /// Index of the problem.
    pub problem: usize,
    /// Index of the variant.
    pub variant: usize,
    /// Seed of every random choice.
    pub seed: u64,
}

/// All runs of a benchmark.
#[derive(Debug, Clone)]
pub struct JobSet {
    subjects: Vec<Subject>,
    variants: Vec<Variant>,
    seeds: Range<u64>,
    time_limit: Option<Duration>,
    iterations: Option<u64>,
    /// Where plans are kept.
    keep: Option<PathBuf>,
}

impl JobSet {
    /// Every problem with every variant and every seed; a variant that is named twice is run once.
    ///
    /// `time_limit` and `iterations` bound each run; `None`: as the problem says.
    ///
    /// # Errors
    /// [`BenchError::SameName`] for two different problems of one name.
    pub fn new(
        subjects: Vec<Subject>,
        variants: Vec<Variant>,
        seeds: Range<u64>,
        time_limit: Option<Duration>,
        iterations: Option<u64>,
    ) -> Result<Self, BenchError> {
        let mut set = Self { subjects: Vec::new(), variants: Vec::new(), seeds, time_limit, iterations, keep: None };
        for subject in subjects {
            match set.subjects.iter().find(|other| other.problem.name == subject.problem.name) {
                Some(other) if other.digest == subject.digest => {}
                Some(_) => return Err(BenchError::SameName { name: subject.problem.name }),
                None => set.subjects.push(subject),
            }
        }
        for variant in variants {
            if !set.variants.contains(&variant) {
                set.variants.push(variant);
            }
        }
        Ok(set)
    }

    /// The same, whose plans are kept in this folder.
    #[must_use]
    pub fn keeping(self, folder: PathBuf) -> Self {
        Self { keep: Some(folder), ..self }
    }

    /// Where plans are kept, if they are.
    pub fn keep(&self) -> Option<&Path> {
        self.keep.as_deref()
    }

    /// The problems.
    pub fn subjects(&self) -> &[Subject] {
        &self.subjects
    }

    /// The runs of one share. Seed after seed, so that whatever is done is about the same of everything.
    pub fn jobs(&self, shard: Shard) -> impl Iterator<Item = Job> + '_ {
        let variants = self.variants.len();
        let places = (0..self.subjects.len()).flat_map(move |problem| (0..variants).map(move |v| (problem, v)));
        self.seeds.clone().enumerate().flat_map(move |(round, seed)| {
            let dealt = places.clone().enumerate().filter(move |(place, _)| shard.takes(round as u64, *place as u64));
            dealt.map(move |(_, (problem, variant))| Job { problem, variant, seed })
        })
    }

    /// The name of a run.
    pub fn key(&self, job: Job) -> Key {
        let problem = self.subjects.get(job.problem).map_or_else(String::new, |s| s.problem.name.clone());
        let variant = self.variants.get(job.variant).map_or_else(String::new, |v| v.name.to_owned());
        Key { problem, variant, seed: job.seed }
    }

    /// What has to be the same for all runs of a problem that are put together.
    pub fn conditions(&self, problem: usize) -> Option<Conditions> {
        let subject = self.subjects.get(problem)?;
        let budget = &subject.problem.budget;
        Some(Conditions {
            darrt: env!("CARGO_PKG_VERSION").to_owned(),
            problem_digest: subject.digest.clone(),
            time_limit_s: self.time_limit.map_or(budget.time_limit_s, |limit| limit.as_secs_f64()),
            iteration_limit: self.iterations.or(budget.iterations),
        })
    }

    /// The planning request of a run.
    pub fn request(&self, job: Job) -> Option<PlanRequest> {
        let subject = self.subjects.get(job.problem)?;
        let mut request = PlanRequest::new(subject.problem.clone(), job.seed);
        self.variants.get(job.variant)?.apply(&mut request);
        request.time_limit = self.time_limit;
        request.iterations = self.iterations;
        Some(request)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::variant::VARIANTS;

    fn set(problems: &[&str], variants: usize, seeds: Range<u64>) -> JobSet {
        let subjects = problems.iter().map(|name| Subject::open(&darrt_pr2::registry(), name).unwrap()).collect();
        JobSet::new(subjects, VARIANTS[..variants].to_vec(), seeds, None, None).unwrap()
    }

    #[test]
    fn shares_are_disjoint_equal_and_make_up_the_whole() {
        let set = set(&["bowl", "plate1", "plate2"], 4, 3..20);
        let whole: Vec<_> = set.jobs(Shard::WHOLE).collect();
        assert_eq!(whole.len(), 3 * 4 * 17);
        for count in [1, 2, 3, 4, 5, 12] {
            let shares: Vec<Vec<Job>> =
                (1..=count).map(|index| set.jobs(format!("{index}/{count}").parse().unwrap()).collect()).collect();
            for job in &whole {
                assert_eq!(shares.iter().flatten().filter(|other| *other == job).count(), 1, "{job:?}");
            }
            assert_eq!(shares.iter().map(Vec::len).sum::<usize>(), whole.len());
            for share in &shares {
                assert!(share.len().abs_diff(whole.len() / count) <= 17, "{count}: {}", share.len());
                for problem in 0..3 {
                    assert!(share.iter().any(|job| job.problem == problem), "{count} shares: problem {problem}");
                }
            }
        }
    }

    #[test]
    fn names_are_canonical_and_nothing_is_there_twice() {
        let set = set(&["Plate3 (No Place)", "plate3-no-place"], 1, 0..2);
        let keys: Vec<_> = set.jobs(Shard::WHOLE).map(|job| set.key(job).to_string()).collect();
        assert_eq!(keys, ["plate3-no-place/default/0", "plate3-no-place/default/1"]);
        let mut other = Subject::open(&darrt_pr2::registry(), "bowl").unwrap();
        other.digest = "other".to_owned();
        let subjects = vec![Subject::open(&darrt_pr2::registry(), "bowl").unwrap(), other];
        let error = JobSet::new(subjects, VARIANTS.to_vec(), 0..1, None, None).unwrap_err();
        assert!(error.to_string().contains("two problems are named `bowl`"));
    }
}
