//! One call that checks all that somebody brought: domain, spaces, goal, primitives, validity, verifier, distances, samplers,
//! and the planner with all of them.
//!
//! | question | file |
//! |---|---|
//! | what is checked, and with what claims? | [`subjects`] |
//! | which states and targets are shown? | `world` |
//! | what is a row of the table? | `rows` |
//! | what is said at the end? | [`report`] |
//! | how are failing cases kept? | `saved` |

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::domain::Domain;

pub mod report;
mod rows;
mod saved;
pub mod subjects;
mod world;

pub use report::{Report, Row, Verdict};
pub use subjects::{Effort, Subjects};

use world::World;

/// Checks every law of everything in `subjects`, each kind of subject on a thread of its own, so that a call that hangs is
/// reported like any other broken law. Same subjects and same seed: same report.
///
/// # Errors
/// The report, if a law is broken; printed, it is a table of one line for each subject, followed by the broken laws with the
/// smallest case that shows each, and how to see it again.
///
/// # Example
/// All of a puck problem (feature `testing`):
/// ```
/// # #[cfg(feature = "testing")] {
/// use darrt_core::laws::{Subjects, check_everything};
/// use darrt_core::testing::puck::{paper_strategy, problems};
///
/// let problem = problems::open().unwrap();
/// let subjects = Subjects::of(&problem).strategy(paper_strategy().unwrap()).cases(8);
/// println!("{}", check_everything(problem.shared_domain(), subjects).unwrap());
/// # }
/// ```
pub fn check_everything<D: Domain>(domain: impl Into<Arc<D>>, subjects: Subjects<D>) -> Result<Report, Box<Report>> {
    let domain = domain.into();
    let report = round(&domain, &Arc::new(subjects), 0);
    if report.holds() { Ok(report) } else { Err(Box::new(report)) }
}

/// The same, again and again with other seeds until `budget` is used up or a law is broken: for faults that show in one case
/// of thousands. The table says how rare a fault would have been found. How many rounds there are depends on the clock; what
/// each of them does, on the seed alone.
///
/// # Errors
/// As [`check_everything`].
pub fn check_thoroughly<D: Domain>(
    domain: impl Into<Arc<D>>,
    subjects: Subjects<D>,
    budget: Duration,
) -> Result<Report, Box<Report>> {
    let (domain, subjects, began) = (domain.into(), Arc::new(subjects), Instant::now());
    let mut report = round(&domain, &subjects, 0);
    let mut number = 0;
    while report.holds() && began.elapsed() < budget {
        number += 1;
        report.merge(round(&domain, &subjects, number));
    }
    if report.holds() { Ok(report) } else { Err(Box::new(report)) }
}

/// Once everything, with the seed of this round.
fn round<D: Domain>(domain: &Arc<D>, subjects: &Arc<Subjects<D>>, number: u64) -> Report {
    let mut report = Report::new(subjects.effort.seed.wrapping_add(number));
    let made = World::new(domain, subjects, number);
    match made {
        Ok(world) => rows::all(&Arc::new(world), &mut report),
        Err(broken) => report.push(Row::broken("the start", broken)),
    }
    report
}
