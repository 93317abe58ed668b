//! Problems like a given one: what stands where, how large and how high it is, drawn at random from a seed.
//!
//! A planner that is tuned on six problems may know those six. A family has as many as are asked for: each is valid, its
//! start and goal are free, and the planner has solved it within [`ITERATIONS`], so that it is known to have a solution.
//! That leaves out what this planner cannot solve: a family tells how fast problems are solved, not which share of all
//! conceivable ones.
//!
//! | question | file |
//! |---|---|
//! | what is changed, and by how much? | [`change`] |

pub mod change;

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_core::random::{Purpose, stream};

use darrt_task::planning::PlanRequest;
use darrt_task::planning_error::PlanningError;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;

/// Iterations within which the planner must solve what is generated.
pub const ITERATIONS: u64 = 3000;
/// Changes that are tried before a family is given up.
pub const ATTEMPTS: u64 = 200;
/// Between the name of a family and the seed.
const MARK: &str = "-g";
/// So long that the count of iterations decides: the same problem on every machine.
const FOREVER: std::time::Duration = std::time::Duration::from_secs(100_000_000);

/// Why nothing was generated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// No change of the problem could be solved.
    #[error(
        "{problem}: none of {ATTEMPTS} changes (seed {seed}) has a plan within {ITERATIONS} iterations; the last: {last}"
    )]
    NoneSolved {
        /// The problem.
        problem: String,
        /// The seed.
        seed: u64,
        /// What was wrong with the last one.
        last: String,
    },
    /// It was asked to stop.
    #[error("interrupted")]
    Cancelled,
}

/// A problem of the family of `base`; the same base and seed give the same problem on every machine.
///
/// # Errors
/// [`GenerateError::NoneSolved`] when the planner solves none of [`ATTEMPTS`] changes; [`GenerateError::Cancelled`].
pub fn generate(
    program: &dyn Program,
    base: &ProblemFile,
    seed: u64,
    cancel: &Cancel,
) -> Result<ProblemFile, GenerateError> {
    let mut last = String::new();
    for attempt in 0..ATTEMPTS {
        let mut problem = change::changed(base, &mut stream(seed, attempt, 0, Purpose::Sample));
        problem.name = format!("{}{MARK}{seed}", base.name);
        problem.title = format!("{}, changed at random (seed {seed})", base.name);
        problem.description = format!("Like {}: places, sizes and heights are drawn at random.\n", base.name);
        problem.paper = None;
        match flaw(program, &problem, cancel) {
            None => return Ok(problem),
            Some(_) if cancel.is_cancelled() => return Err(GenerateError::Cancelled),
            Some(what) => last = what,
        }
    }
    Err(GenerateError::NoneSolved { problem: base.name.clone(), seed, last })
}

/// The name of the family that a problem was generated for, if it was.
pub fn family(name: &str) -> Option<&str> {
    let (family, seed) = name.rsplit_once(MARK)?;
    (!family.is_empty() && !seed.is_empty() && seed.bytes().all(|byte| byte.is_ascii_digit())).then_some(family)
}

/// Why a problem will not do.
fn flaw(program: &dyn Program, problem: &ProblemFile, cancel: &Cancel) -> Option<String> {
    if let Err(error) = problem.validate(&problem.name) {
        return Some(error.to_string());
    }
    let mut request = PlanRequest::new(problem.clone(), 0);
    request.iterations = Some(ITERATIONS);
    request.time_limit = Some(FOREVER);
    let solved: Result<bool, PlanningError> =
        program.plan(&request, cancel, &mut Silent).map(|result| result.plan.is_some());
    match solved {
        Ok(true) => None,
        Ok(false) => Some("no plan found".to_owned()),
        Err(error) => Some(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_pr2::problems::builtin;

    #[test]
    fn names_tell_the_family() {
        assert_eq!(family("plate3-no-place-g17"), Some("plate3-no-place"));
        assert_eq!(family("mine-go-g2"), Some("mine-go"));
        for name in ["plate3", "plate-g", "-g3", "plate-g3x", "big-goal"] {
            assert_eq!(family(name), None, "{name}");
        }
    }

    #[test]
    fn a_generated_problem_is_valid_different_and_the_same_again() {
        let base = builtin("bowl").unwrap();
        let [first, again, other] =
            [3, 3, 4].map(|seed| generate(&darrt_pr2::registry(), &base, seed, &Cancel::new()).unwrap());
        assert_eq!(first, again);
        assert_eq!((first.name.as_str(), other.name.as_str()), ("bowl-g3", "bowl-g4"));
        assert!(first.objects != base.objects && first.objects != other.objects);
        let text = first.to_toml().unwrap();
        assert_eq!(ProblemFile::from_toml(&text, "again").unwrap(), first);
        let result =
            Program::plan(&darrt_pr2::registry(), &PlanRequest::new(first, 0), &Cancel::new(), &mut Silent).unwrap();
        assert!(result.plan.is_some());
    }

    #[test]
    fn an_interrupt_is_no_lack_of_problems() {
        let cancel = Cancel::new();
        cancel.cancel();
        let error = generate(&darrt_pr2::registry(), &builtin("plate3").unwrap(), 0, &cancel).unwrap_err();
        assert!(matches!(error, GenerateError::Cancelled), "{error}");
    }
}
