//! The verifier: judges a plan file by replaying it, without the planner and without the primitives.
//!
//! It shares with the planner the robot description, the general kinematic tree, the shapes of the problem and the table
//! of self-collision pairs; poses, collisions, contacts and the rules of the primitives it works out by itself. Every
//! checked state is one at a finer resolution than the planner's waypoints, with exact shapes.
//!
//! | question | file |
//! |---|---|
//! | in which order is what checked? | `judge` |
//! | what may a step do, what may it touch? | `mode` |
//! | what lies between two waypoints? | `motion` |
//! | what is so far from all of it that nobody need look? | `region` |
//! | which solids may not touch, do they? | `stage`, `solid`; looked at plainly: `stage::plain` |
//! | how far do they keep from each other? | `margins`, `near` |
//! | what is right and still odd? | `judge::remarks`, `warning` |
//! | when must a pair be looked at again? | `approach` |
//! | which hand is at work? | `hands` |
//! | is an object gripped, pushed as pushes go, or dragged from above? | `hand`, `drag` |
//! | over which of the surfaces that lie flush is an object? | `flush` |
//! | does the grip bear the weight, also as the object leans? | `hold`, `surface` |
//! | does it keep to what a person wants? | `steer` |
//! | is it left far enough from an edge? | `edge` |
//! | does the plan start and end where it must? | `start`, `goal` |
//! | can the robot follow its clock? | `clock` |
//!
//! `docs/plan-format.md` states the rules for readers of plans.

mod approach;
mod clock;
mod drag;
mod edge;
mod flush;
mod goal;
mod hand;
mod hands;
mod hold;
mod judge;
mod margins;
mod mode;
mod motion;
mod near;
mod options;
mod refusal;
mod region;
mod robot;
mod schedule;
mod solid;
mod stage;
mod start;
mod steer;
mod surface;
mod warning;
mod world;

pub use options::VerifyOptions;
pub use refusal::{Refusal, RefusalKind};
pub use stage::SmallestClearance;
pub use warning::{Warning, WarningKind};

use std::collections::BTreeSet;

use darrt_core::budget::Cancel;

use crate::plan_file::PlanFile;
use crate::robot::{RobotFacts, TaskRobot};

/// What was checked on the way to "yes".
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// Steps of the plan.
    pub steps: usize,
    /// Waypoints of all steps.
    pub waypoints: usize,
    /// States checked for collisions.
    pub states: u64,
    /// Pairs of solids that were near enough to need the exact test.
    pub exact_tests: u64,
    /// The smallest distance seen between two bodies that need not be near; `None` if none came near.
    pub smallest_clearance: Option<SmallestClearance>,
    /// The same of two bodies that must be near and may not touch: hand or handled object, against that object and what
    /// carries it.
    pub smallest_intended: Option<SmallestClearance>,
    /// Seconds that the plan takes by its clock, which was judged too; `None` for a plan without one.
    pub duration_s: Option<f64>,
    /// What a careful engineer would ask about, in the order of the steps.
    pub warnings: Vec<Warning>,
}

/// Replays `plan` with the default [`VerifyOptions`].
///
/// # Errors
/// The first [`Refusal`] found: step by step, in a step its form and limits first, then its states in the order of time.
pub fn verify(plan: &PlanFile, robot: &RobotFacts) -> Result<Proof, Refusal> {
    verify_with(plan, robot, &VerifyOptions::default())
}

/// Replays `plan` at the resolution and with the tolerances of `options`.
///
/// # Errors
/// As [`verify`]; also when an option is out of its range.
pub fn verify_with(plan: &PlanFile, robot: &RobotFacts, options: &VerifyOptions) -> Result<Proof, Refusal> {
    verify_unless(plan, robot, options, &Cancel::new())
}

/// [`verify_with`], given up as soon as `cancel` is called.
///
/// # Errors
/// As [`verify_with`]; [`RefusalKind::Cancelled`] if it was given up.
pub fn verify_unless(
    plan: &PlanFile,
    robot: &RobotFacts,
    options: &VerifyOptions,
    cancel: &Cancel,
) -> Result<Proof, Refusal> {
    if let Some((name, value)) = options.flaw() {
        let text = format!("the verifier's option `{name}` is {value}, which is out of its range");
        return Err(Refusal::whole(RefusalKind::Malformed, text));
    }
    let proof = judge::Judge::new(plan, robot, options, cancel)?.run()?;
    match &plan.timing {
        Some(timing) => {
            clock::check(plan, timing, robot, options, cancel)?;
            Ok(Proof { duration_s: Some(timing.duration_s), ..proof })
        }
        None => Ok(proof),
    }
}

/// Judges only the clock of a plan whose waypoints have been accepted: the limits of the robot, the pace of the hand, waits, and
/// the curve where corners are rounded. A plan without a clock has nothing to judge.
///
/// # Errors
/// As [`verify_unless`].
pub fn verify_clock(
    plan: &PlanFile,
    robot: &RobotFacts,
    options: &VerifyOptions,
    cancel: &Cancel,
) -> Result<(), Refusal> {
    let timing = plan.timing.as_ref();
    timing.map_or(Ok(()), |timing| clock::check(plan, timing, robot, options, cancel))
}

/// By step of the plan: which of the rules with `require` of its problem it fulfils, by their places in the list.
pub(crate) fn rules_met(plan: &PlanFile, robot: &RobotFacts) -> Result<Vec<BTreeSet<usize>>, Refusal> {
    steer::met_by_step(plan, robot)
}

/// [`verify_with`] for a plan of the robot `M`, as its problem describes it.
///
/// # Errors
/// As [`verify_with`]; [`RefusalKind::Problem`] if there is no such robot.
pub fn verify_for<M: TaskRobot>(plan: &PlanFile, options: &VerifyOptions) -> Result<Proof, Refusal> {
    let robot = M::facts(&plan.problem.robot).map_err(|error| {
        let text = format!("the robot of the problem cannot be built: {error}");
        Refusal::whole(RefusalKind::Problem, text)
    })?;
    verify_with(plan, &robot, options)
}
