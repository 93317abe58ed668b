//! What a command line needs of a [`Registry`], whatever its robot.

use std::collections::BTreeMap;

use darrt_core::budget::Cancel;
use darrt_core::observe::Observer;
use darrt_primitives::contract::Contract;

use crate::diagnosis::explain::{ExplainRequest, Explanation, explain};
use crate::diagnosis::why_not::{WhyNot, WhyNotError, WhyNotRequest, why_not};
use crate::diagnosis::{Diagnosis, diagnose};
use crate::file_robot::{FileRobot, shipped};
use crate::planning::{PlanRequest, PlanResult, plan};
use crate::planning_error::PlanningError;
use crate::problem_file::collection::Collection;
use crate::problem_file::{PrimitiveName, ProblemFile, ProblemFileError};
use crate::registry::Registry;
use crate::replan::{ReplanRequest, Replanned, replan};
use crate::robot::{RobotError, RobotFacts, TaskRobot};

/// A robot with its primitives and problems, ready to be asked.
///
/// A [`Registry`] is one for its own kind of robot, [`Robots`] for several.
///
/// # Example
/// What a command of one's own does with it.
/// ```
/// use darrt_core::budget::Cancel;
/// use darrt_core::observe::Silent;
/// use darrt_task::file_robot::FileRobot;
/// use darrt_task::planning::PlanRequest;
/// use darrt_task::program::Program;
/// use darrt_task::registry::Registry;
///
/// /// Steps of the plans of a problem by seed.
/// fn steps(program: &dyn Program, problem: &str) -> Result<Vec<Option<usize>>, Box<dyn std::error::Error>> {
///     let problem = program.open(problem)?;
///     let plan = |seed| program.plan(&PlanRequest::new(problem.clone(), seed), &Cancel::new(), &mut Silent);
///     (0..10).map(|seed| Ok(plan(seed)?.plan.map(|found| found.steps.len()))).collect()
/// }
///
/// let program = Registry::<FileRobot>::new();
/// assert!(Program::contracts(&program).len() >= 8, "the paper's primitives");
/// assert!(steps(&program, "no-such-problem").is_err());
/// ```
pub trait Program: Send + Sync {
    /// The problems inside.
    fn problems(&self) -> &Collection;

    /// Opens what a person names on a command line: a problem of the collection, else a file. Its names are checked.
    ///
    /// # Errors
    /// As [`Collection::open`] and [`Registry::check`].
    fn open(&self, name_or_path: &str) -> Result<ProblemFile, ProblemFileError> {
        let problem = self.problems().open(name_or_path)?;
        self.check(&problem, name_or_path)?;
        Ok(problem)
    }

    /// Checks what only a program can know of a problem, which errors call `source_name`.
    ///
    /// # Errors
    /// As [`Registry::check`].
    fn check(&self, problem: &ProblemFile, source_name: &str) -> Result<(), ProblemFileError>;

    /// The primitives by name, each with its contract.
    fn contracts(&self) -> BTreeMap<PrimitiveName, Contract>;

    /// The robot of a problem as data.
    ///
    /// # Errors
    /// [`RobotError`] with the key at fault.
    fn facts(&self, problem: &ProblemFile) -> Result<RobotFacts, RobotError>;

    /// The problem with another robot than its own: a name or a robot file. Also what was changed besides, in words.
    ///
    /// # Errors
    /// [`RobotError`] when there is no such robot, or it does not fit the problem.
    fn with_robot(&self, problem: ProblemFile, robot: &str) -> Result<(ProblemFile, Vec<String>), RobotError>;

    /// Plans; see [`plan`].
    ///
    /// # Errors
    /// As [`plan`].
    fn plan(
        &self,
        request: &PlanRequest,
        cancel: &Cancel,
        observer: &mut dyn Observer,
    ) -> Result<PlanResult, PlanningError>;

    /// Plans from an old plan; see [`replan`].
    ///
    /// # Errors
    /// As [`replan`].
    fn replan(
        &self,
        request: &ReplanRequest,
        cancel: &Cancel,
        observer: &mut dyn Observer,
    ) -> Result<Replanned, PlanningError>;

    /// Why a search found no plan; see [`diagnose`].
    ///
    /// # Errors
    /// As [`plan`].
    fn diagnose(&self, request: &PlanRequest, result: &PlanResult, cancel: &Cancel)
    -> Result<Diagnosis, PlanningError>;

    /// With which changes a problem has a plan; see [`explain`].
    ///
    /// # Errors
    /// As [`explain`].
    fn explain(&self, request: &ExplainRequest, cancel: &Cancel) -> Result<Explanation, PlanningError>;

    /// What is wrong with an idea; see [`why_not`].
    ///
    /// # Errors
    /// As [`why_not`].
    fn why_not(&self, request: &WhyNotRequest) -> Result<WhyNot, WhyNotError>;
}

/// A program's own robot, and those that come as files: whichever a problem names.
#[derive(Debug)]
pub struct Robots<M: TaskRobot> {
    own: Registry<M>,
    files: Registry<FileRobot>,
}

impl<M: TaskRobot> Robots<M> {
    /// `own` as it is; robots of files with the paper's primitives. The problems are those of `own`.
    pub fn new(own: Registry<M>) -> Self {
        Self { own, files: Registry::new() }
    }

    /// The same, robots of files with what this registry knows.
    #[must_use]
    pub fn with_files(self, files: Registry<FileRobot>) -> Self {
        Self { files, ..self }
    }

    fn of(&self, problem: &ProblemFile) -> &dyn Program {
        let robot = &problem.robot;
        let is_shipped = robot.model.as_ref().is_some_and(|name| shipped::all().iter().any(|r| r.name == name));
        if robot.file.is_some() || is_shipped { &self.files } else { &self.own }
    }
}

impl<M: TaskRobot> Program for Robots<M> {
    fn problems(&self) -> &Collection {
        self.own.problems()
    }

    fn check(&self, problem: &ProblemFile, source_name: &str) -> Result<(), ProblemFileError> {
        self.of(problem).check(problem, source_name)
    }

    fn contracts(&self) -> BTreeMap<PrimitiveName, Contract> {
        let mut contracts = Registry::contracts(&self.files);
        contracts.extend(Registry::contracts(&self.own));
        contracts
    }

    fn facts(&self, problem: &ProblemFile) -> Result<RobotFacts, RobotError> {
        self.of(problem).facts(problem)
    }

    fn with_robot(&self, problem: ProblemFile, robot: &str) -> Result<(ProblemFile, Vec<String>), RobotError> {
        if M::models().iter().any(|model| model == robot) {
            return self.own.with_robot(problem, robot);
        }
        self.files.with_robot(problem, robot)
    }

    fn plan(
        &self,
        request: &PlanRequest,
        cancel: &Cancel,
        observer: &mut dyn Observer,
    ) -> Result<PlanResult, PlanningError> {
        self.of(&request.problem).plan(request, cancel, observer)
    }

    fn replan(
        &self,
        request: &ReplanRequest,
        cancel: &Cancel,
        observer: &mut dyn Observer,
    ) -> Result<Replanned, PlanningError> {
        self.of(&request.plan.problem).replan(request, cancel, observer)
    }

    fn diagnose(
        &self,
        request: &PlanRequest,
        result: &PlanResult,
        cancel: &Cancel,
    ) -> Result<Diagnosis, PlanningError> {
        self.of(&request.problem).diagnose(request, result, cancel)
    }

    fn explain(&self, request: &ExplainRequest, cancel: &Cancel) -> Result<Explanation, PlanningError> {
        self.of(&request.plan.problem).explain(request, cancel)
    }

    fn why_not(&self, request: &WhyNotRequest) -> Result<WhyNot, WhyNotError> {
        self.of(&request.problem).why_not(request)
    }
}

impl<M: TaskRobot> Program for Registry<M> {
    fn problems(&self) -> &Collection {
        Self::problems(self)
    }

    fn check(&self, problem: &ProblemFile, source_name: &str) -> Result<(), ProblemFileError> {
        Self::check(self, problem, source_name)
    }

    fn contracts(&self) -> BTreeMap<PrimitiveName, Contract> {
        Self::contracts(self)
    }

    fn with_robot(&self, problem: ProblemFile, robot: &str) -> Result<(ProblemFile, Vec<String>), RobotError> {
        let contracts = Self::contracts(self);
        M::with_robot(problem, robot, &|name| contracts.get(name).copied())
    }

    fn facts(&self, problem: &ProblemFile) -> Result<RobotFacts, RobotError> {
        M::facts(&problem.robot)
    }

    fn plan(
        &self,
        request: &PlanRequest,
        cancel: &Cancel,
        observer: &mut dyn Observer,
    ) -> Result<PlanResult, PlanningError> {
        plan(self, request, cancel, observer)
    }

    fn replan(
        &self,
        request: &ReplanRequest,
        cancel: &Cancel,
        observer: &mut dyn Observer,
    ) -> Result<Replanned, PlanningError> {
        replan(self, request, cancel, observer)
    }

    fn diagnose(
        &self,
        request: &PlanRequest,
        result: &PlanResult,
        cancel: &Cancel,
    ) -> Result<Diagnosis, PlanningError> {
        diagnose(self, request, result, cancel)
    }

    fn explain(&self, request: &ExplainRequest, cancel: &Cancel) -> Result<Explanation, PlanningError> {
        explain(self, request, cancel)
    }

    fn why_not(&self, request: &WhyNotRequest) -> Result<WhyNot, WhyNotError> {
        why_not(self, request)
    }
}
