//! What can keep a problem from being planned at all.

use darrt_geom::GeomError;

use crate::diagnosis::cause::Occupant;
use crate::export::UnknownPrimitive;
use crate::grasp_families::GraspFlaw;
use crate::plan_file::PlanFileError;
use crate::problem_file::ProblemFileError;
use crate::robot::RobotError;

/// A problem that cannot be planned, or a plan that cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanningError {
    /// The problem file.
    #[error(transparent)]
    Problem(#[from] ProblemFileError),
    /// The robot.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The plan has a step that cannot be written.
    #[error(transparent)]
    UnknownPrimitive(#[from] UnknownPrimitive),
    /// A shape or pose.
    #[error(transparent)]
    Geometry(#[from] GeomError),
    /// A number, the start or the goal, as the planner sees it.
    #[error(transparent)]
    Core(#[from] darrt_core::error::Error),
    /// A setting of the primitives.
    #[error(transparent)]
    Primitive(#[from] darrt_primitives::error::PrimitiveError),
    /// The plan file.
    #[error(transparent)]
    PlanFile(#[from] PlanFileError),
    /// A family of grasps does not fit its object.
    #[error("the grasps of `{object}` cannot be used: `object[{index}].{}`: {}", flaw.key, flaw.source)]
    Grasp {
        /// The object.
        object: String,
        /// Its index in the file.
        index: usize,
        /// The key at fault, and why.
        flaw: GraspFlaw,
    },
    /// A goal for an object that is not there.
    #[error("the goal names the object `{name}`, which the problem does not have")]
    UnknownObject {
        /// The name.
        name: String,
    },
    /// The object cannot be at its goal: something that stays there is in the way.
    #[error("the goal of `{object}` is blocked: at ({:.3}, {:.3}, {:.3}) it touches `{by}`{occupant}", at[0], at[1], at[2])]
    GoalBlocked {
        /// The object.
        object: String,
        /// What is in the way.
        by: String,
        /// Why it stays there.
        occupant: Occupant,
        /// Where the object would be, metres.
        at: [f64; 3],
    },
    /// A closed mesh lies between where the object starts and where it shall be.
    #[error(
        "the goal of `{object}` is enclosed by `{by}`: the mesh is closed, and of start and goal one is inside and the other is not"
    )]
    GoalEnclosed {
        /// The object.
        object: String,
        /// What is between.
        by: String,
        /// Where the object would be, metres.
        at: [f64; 3],
    },
    /// The base cannot stand where the goal of the robot wants it: something fixed is in the way.
    #[error(
        "`goal.robot.base` is blocked: at ({:.3}, {:.3}), turned by {:.3} rad, `{link}` is {:.0} mm in `{by}`",
        base[0], base[1], base[2], deep_m * 1000.0
    )]
    BaseGoalBlocked {
        /// A link that the base carries.
        link: String,
        /// What is in the way.
        by: String,
        /// Where the base would be: x, y in metres, yaw in radians.
        base: [f64; 3],
        /// How deep the one would be in the other, metres.
        deep_m: f64,
    },
    /// Something is wrong, and something else may be why.
    #[error("{error} ({doubts})")]
    Doubtful {
        /// What is wrong.
        #[source]
        error: Box<PlanningError>,
        /// What may be why, in words.
        doubts: String,
    },
    /// The primitives and grasps of the problem do not suffice for any of the goals of an object.
    #[error("the goal of `{object}` cannot be reached: {why}")]
    InfeasibleGoal {
        /// The object.
        object: String,
        /// What each of its goals lacks.
        why: String,
    },
    /// Nothing can do what a rule of the problem requires.
    #[error("`steer[{index}]` requires what no step can do: {why}")]
    InfeasibleRule {
        /// Which rule, from 0.
        index: usize,
        /// What is missing, by object.
        why: String,
    },
    /// Steps of an old plan that shall be kept cannot be.
    #[error("the first {keep} steps of the plan cannot be kept: {why}")]
    CannotKeep {
        /// How many.
        keep: usize,
        /// Why not.
        why: String,
    },
    /// Plans shall be improved without an end.
    #[error("plans can only be improved within a limit: give a time limit or a number of iterations")]
    NoLimit,
    /// A primitive needs another one that the problem leaves out.
    #[error("`{primitive}` is allowed but not `{needs}`, which it is made of")]
    MissingPrimitive {
        /// The primitive that is allowed.
        primitive: String,
        /// What it needs.
        needs: String,
    },
}

impl PlanningError {
    /// Is it proven that the problem, as it is written, has no plan? Else something of it cannot be used, or is not known.
    pub fn is_impossible(&self) -> bool {
        match self {
            Self::GoalBlocked { .. }
            | Self::GoalEnclosed { .. }
            | Self::BaseGoalBlocked { .. }
            | Self::InfeasibleGoal { .. }
            | Self::InfeasibleRule { .. } => true,
            Self::Doubtful { error, .. } => error.is_impossible(),
            _ => false,
        }
    }
}
