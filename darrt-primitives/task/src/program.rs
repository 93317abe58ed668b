//! What a command line needs of a [`Registry`], whatever its robot.

use std::collections::BTreeMap;

use darrt_core::budget::Cancel;
use darrt_core::observe::Observer;
use darrt_primitives::contract::Contract;

use crate::diagnosis::explain::{ExplainRequest, Explanation, explain};
use crate::diagnosis::{Diagnosis, diagnose};
use crate::planning::{PlanRequest, PlanResult, plan};
use crate::planning_error::PlanningError;
use crate::problem_file::collection::Collection;
use crate::problem_file::{PrimitiveName, ProblemFile, ProblemFileError};
use crate::registry::Registry;
use crate::replan::{ReplanRequest, Replanned, replan};
use crate::robot::{RobotError, RobotFacts, TaskRobot};

/// A robot with its primitives and problems, ready to be asked.
pub trait Program: Send + Sync {
    /// The problems inside.
    fn problems(&self) -> &Collection;

    /// Opens what a person names on a command line: a problem of the collection, else a file. Its names are checked.
    ///
    /// # Errors
    /// As [`Collection::open`] and [`Registry::check`].
    fn open(&self, name_or_path: &str) -> Result<ProblemFile, ProblemFileError>;

    /// The primitives by name, each with its contract.
    fn contracts(&self) -> BTreeMap<PrimitiveName, Contract>;

    /// The robot of a problem as data.
    ///
    /// # Errors
    /// [`RobotError`] with the key at fault.
    fn facts(&self, problem: &ProblemFile) -> Result<RobotFacts, RobotError>;

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
    fn diagnose(&self, request: &PlanRequest, result: &PlanResult) -> Result<Diagnosis, PlanningError>;

    /// With which changes a problem has a plan; see [`explain`].
    ///
    /// # Errors
    /// As [`explain`].
    fn explain(&self, request: &ExplainRequest, cancel: &Cancel) -> Result<Explanation, PlanningError>;
}

impl<M: TaskRobot> Program for Registry<M> {
    fn problems(&self) -> &Collection {
        Self::problems(self)
    }

    fn open(&self, name_or_path: &str) -> Result<ProblemFile, ProblemFileError> {
        let problem = Self::problems(self).open(name_or_path)?;
        self.check(&problem, name_or_path)?;
        Ok(problem)
    }

    fn contracts(&self) -> BTreeMap<PrimitiveName, Contract> {
        Self::contracts(self)
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

    fn diagnose(&self, request: &PlanRequest, result: &PlanResult) -> Result<Diagnosis, PlanningError> {
        diagnose(self, request, result)
    }

    fn explain(&self, request: &ExplainRequest, cancel: &Cancel) -> Result<Explanation, PlanningError> {
        explain(self, request, cancel)
    }
}
