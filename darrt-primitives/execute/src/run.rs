//! One execution, in a world that may be off from what the plan knows: the plan as it is, or looking where everything is on the way.

use std::sync::Arc;

use darrt_core::budget::Cancel;
use darrt_geom::Scene;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::{ProblemFile, Symmetry};
use darrt_task::robot::RobotFacts;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Serialize;

use crate::arm::Arm;
use crate::course::Course;
use crate::error::ExecuteError;
use crate::goal::ObjectEnd;
use crate::noise::{Draws, NoiseModel};
use crate::performance::Performance;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::stage::{Owner, Scenery, TrueObject};
use crate::watch::{Departure, Event};

/// A plan ready to be executed any number of times.
#[derive(Debug)]
pub struct Execution<'a> {
    pub(crate) problem: &'a ProblemFile,
    pub(crate) plan: &'a PlanFile,
    pub(crate) facts: &'a RobotFacts,
    pub(crate) robot: Robot,
    pub(crate) arm: Arm,
    pub(crate) scenery: Scenery,
    pub(crate) scene: Scene,
    pub(crate) course: Arc<Course>,
    starts: Vec<Isometry3<f64>>,
    pub(crate) depths: Vec<f64>,
}

/// Who makes another plan when the one under way no longer fits.
///
/// # Example
/// ```
/// use darrt_core::budget::Cancel;
/// use darrt_core::observe::Silent;
/// use darrt_execute::Replan;
/// use darrt_task::file_robot::FileRobot;
/// use darrt_task::plan_file::PlanFile;
/// use darrt_task::planning::{PlanRequest, plan};
/// use darrt_task::problem_file::ProblemFile;
/// use darrt_task::registry::Registry;
///
/// /// Plans anew, whatever is left of the old plan.
/// struct Afresh(Registry<FileRobot>);
///
/// impl Replan for Afresh {
///     fn replan(&self, problem: &ProblemFile, _old: &PlanFile) -> Option<PlanFile> {
///         let request = PlanRequest::new(problem.clone(), 0);
///         plan(&self.0, &request, &Cancel::new(), &mut Silent).ok()?.plan
///     }
/// }
/// ```
pub trait Replan: Sync {
    /// A plan for `problem`, which is as the robot sees the world now, from `old` with what of it still fits; `None` if there is
    /// none. The same for the same arguments.
    fn replan(&self, problem: &ProblemFile, old: &PlanFile) -> Option<PlanFile>;
}

/// What a robot does about what it sees.
#[derive(Clone, Copy)]
pub enum Loop<'a> {
    /// Nothing: it does not look.
    Open,
    /// It looks before every contact and after every drive, corrects the arm, and has another plan made where that is not enough.
    Closed(&'a dyn Replan),
}

impl std::fmt::Debug for Loop<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if matches!(self, Self::Open) { "Open" } else { "Closed" })
    }
}

/// How one execution went.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Its number, from 0.
    pub run: u64,
    /// Is every object where it should be within the tolerance of the problem, and nothing else moved?
    pub is_success: bool,
    /// The same with 5 cm instead of the tolerance.
    pub is_near: bool,
    /// The first departure from the plan; in a run that succeeds all the same, a small one.
    pub departure: Option<Departure>,
    /// What ended the run before its plan did.
    pub stopped: Option<Departure>,
    /// Where the objects end.
    pub objects: Vec<ObjectEnd>,
    /// Where they were after every step.
    pub trail: Vec<StepEnd>,
    /// What was done about errors; `None` open loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feedback: Option<FeedbackCount>,
    /// Seconds that it took.
    pub seconds: f64,
}

/// What a robot that looks has done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct FeedbackCount {
    /// How often it looked.
    pub looks: usize,
    /// Contacts that were corrected.
    pub corrections: usize,
    /// Corrections that were too far for the arm.
    pub out_of_reach: usize,
    /// Plans that were made on the way.
    pub replans: usize,
    /// Times that another plan was wanted and none was found.
    pub failed_replans: usize,
    /// Times that it ran into something or was held up, and went back the way it had come.
    pub backed_off: usize,
}

/// Where the objects are after a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepEnd {
    /// The plan: 0 is the one that was to be executed, 1 the first that was made on the way.
    pub plan: usize,
    /// The step, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: String,
    /// By object, in the order of the problem: how far it is from where the plan has it, metres.
    pub off_m: Vec<f64>,
    /// By object: the angle between its axis and that of the plan, degrees.
    pub lean_deg: Vec<f64>,
}

impl<'a> Execution<'a> {
    /// Builds robot, room and clock of a plan.
    ///
    /// # Errors
    /// [`ExecuteError`] for a plan, a problem or a robot of which that cannot be done.
    pub fn new(plan: &'a PlanFile, facts: &'a RobotFacts) -> Result<Self, ExecuteError> {
        let problem = &plan.problem;
        let robot = Robot::new(facts)?;
        let geometry = problem.geometry()?;
        Ok(Self {
            problem,
            plan,
            facts,
            course: Arc::new(Course::new(plan, facts, &robot)?),
            arm: Arm::new(&robot, facts)?,
            scenery: Scenery::new(problem)?,
            robot,
            starts: geometry.objects.iter().map(|object| object.world_from_object).collect(),
            depths: geometry.objects.iter().map(|object| object.depth_below_origin).collect(),
            scene: geometry.scene,
        })
    }

    /// Seconds that the plan takes on its clock.
    pub fn duration_s(&self) -> f64 {
        self.course.timeline.duration_s()
    }

    /// Executes the plan once; `None` if it was cancelled meanwhile.
    ///
    /// # Laws
    /// The report depends on the plan, the noise, `seed`, `run` and what is done about errors alone.
    pub fn run(
        &self,
        noise: &NoiseModel,
        (seed, run): (u64, u64),
        control: Loop<'_>,
        cancel: &Cancel,
    ) -> Option<RunReport> {
        Some(self.performance(noise, (seed, run), control).perform(run, cancel)?.0)
    }

    /// The same run, with every moment of it.
    pub fn record(
        &self,
        noise: &NoiseModel,
        (seed, run): (u64, u64),
        control: Loop<'_>,
        cancel: &Cancel,
    ) -> Option<(RunReport, Recording)> {
        let (report, recording) = self.performance(noise, (seed, run), control).recorded().perform(run, cancel)?;
        Some((report, recording?))
    }

    /// The world at the start of a run.
    fn performance<'b>(&'b self, noise: &NoiseModel, (seed, run): (u64, u64), control: Loop<'b>) -> Performance<'b> {
        let mut draws = Draws::new(*noise, seed, run);
        let objects = self.starts.iter().zip(&self.problem.objects).map(|(pose, spec)| {
            let draw = draws.object();
            let [x, y, yaw] = draw.at;
            let mut pose = *pose;
            pose.translation.vector += Vector3::new(x, y, 0.0);
            pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw) * pose.rotation;
            TrueObject {
                world_from_object: pose,
                mass_kg: spec.mass_kg * draw.mass,
                table_friction: spec.friction.table * draw.table_friction,
                finger_friction: spec.friction.fingers * draw.finger_friction,
            }
        });
        let objects: Vec<_> = objects.collect();
        let mut biases = vec![0.0; self.robot.tree.variables().len()];
        for (variable, bias) in self.robot.arm.iter().zip(draws.joint_biases(self.robot.arm.len())) {
            if let Some(slot) = biases.get_mut(*variable) {
                *slot = bias;
            }
        }
        Performance::begin(self, &objects, biases, (noise, draws), control)
    }

    /// Is an object the same however it is turned?
    pub(crate) fn is_round(&self, object: usize) -> bool {
        self.problem.objects.get(object).is_some_and(|object| object.symmetry() == Symmetry::Z)
    }

    fn name(&self, owner: Owner) -> String {
        let name = match owner {
            Owner::Room(index) => self.scenery.names.get(index).cloned(),
            Owner::Object(index) => self.problem.objects.get(index).map(|object| object.name.clone()),
            Owner::Link(index) => self.robot.tree.link_names().get(index).map(ToString::to_string),
        };
        name.unwrap_or_else(|| "?".to_owned())
    }

    pub(crate) fn departure(
        &self,
        course: &Course,
        (plan, step): (usize, usize),
        time: f64,
        event: &Event,
    ) -> Departure {
        Departure {
            plan,
            step: step + 1,
            primitive: course.primitive(step),
            time,
            cause: event.cause,
            body: self.name(event.body),
            other: event.other.map(|other| self.name(other)),
            off_m: event.off_m,
            lean_deg: event.lean_deg,
            force_n: event.force_n,
        }
    }
}
