//! Changes of a problem that make it easier: what is tried to find out what keeps a plan away.

use darrt_primitives::contract::{MovingPart, ObjectRule};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cause::{Cause, Place, Stage};
use crate::problem_file::{GraspFamily, LengthRange, Limits, Obstacle, PrimitiveName, ProblemFile, ShapeSpec};
use crate::registry::Registry;
use crate::robot::TaskRobot;

/// How much of an obstacle is left when it is made smaller.
const SMALLER: f64 = 0.8;
/// The least length that is tried of a straight way, metres.
const SHORT_M: f64 = 0.005;
/// Heights of the lift that are tried, metres, highest first.
const LIFTS_M: std::ops::RangeInclusive<u32> = 1..=20;
const LIFT_STEP_M: f64 = 0.05;
/// What carries a goal is lowered by whole steps, metres.
const LOWER_STEP_M: f64 = 0.05;
/// How much farther an object may lean: so many times as far, and at least so far, degrees.
const LEAN_TIMES: f64 = 2.0;
const LEAN_DEG: f64 = 5.0;
/// How much wider bounds and tolerances become, metres.
const WIDER_M: f64 = 2.0;
const LOOSER_M: f64 = 0.05;
/// Numbers at the ends of names are not told apart in groups of fewer obstacles.
const LEAST_GROUP: usize = 2;

/// One change of a problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "relaxation", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Relaxation {
    /// The hard limits of the joints instead of the soft ones.
    HardLimits,
    /// The lift of the trunk at another height.
    Lift {
        /// Metres.
        to_m: f64,
    },
    /// A primitive more.
    Allow {
        /// The primitive.
        primitive: PrimitiveName,
    },
    /// A family of grasps more.
    Grasp {
        /// The object.
        object: String,
        /// The family.
        family: GraspFamily,
    },
    /// The key of a straight way with a smaller least length.
    Shorter {
        /// The key.
        key: String,
        /// The least length, metres.
        least_m: f64,
    },
    /// A smaller least margin.
    LessMargin {
        /// Metres.
        to_m: f64,
    },
    /// A goal with a wider tolerance.
    Tolerance {
        /// The object.
        object: String,
        /// Metres.
        to_m: f64,
    },
    /// An object that may lean more.
    Lean {
        /// The object.
        object: String,
        /// Degrees.
        to_deg: f64,
    },
    /// Wider bounds of base and objects.
    WiderBounds {
        /// By so much on all sides, metres.
        by_m: f64,
    },
    /// What carries a goal is lower.
    Lower {
        /// The obstacle under the surface.
        obstacle: String,
        /// By so much, metres.
        by_m: f64,
    },
    /// An obstacle is smaller.
    Shrink {
        /// The obstacle.
        obstacle: String,
        /// Part of its size that is left.
        share: f64,
    },
    /// Obstacles are gone.
    Without {
        /// Their names.
        obstacles: Vec<String>,
    },
    /// An object without a goal is gone.
    WithoutObject {
        /// The object.
        object: String,
    },
    /// An object has no goal any more.
    WithoutGoal {
        /// The object; `null` for the robot.
        object: Option<String>,
    },
    /// A rule of the problem is gone.
    WithoutRule {
        /// Its index in the file.
        index: usize,
    },
    /// More iterations.
    MoreTime {
        /// How many.
        iterations: u64,
    },
}

impl Relaxation {
    /// All single changes that can be made to a problem, the smallest first; those of obstacles before those of the goal.
    pub fn all<M: TaskRobot>(registry: &Registry<M>, problem: &ProblemFile) -> Vec<Self> {
        let mut all = Vec::new();
        if problem.robot.limits == Limits::Soft {
            all.push(Self::HardLimits);
        }
        all.extend(lifts::<M>(problem).map(|to_m| Self::Lift { to_m }));
        let missing = registry.contracts().into_keys().filter(|name| !problem.allows(name));
        all.extend(missing.map(|primitive| Self::Allow { primitive }));
        for object in problem.objects.iter().filter(|object| problem.has_goal(&object.name)) {
            let families = [GraspFamily::Rim, GraspFamily::Overhead, GraspFamily::Side];
            let missing = families.into_iter().filter(|family| !object.grasps.contains(family));
            all.extend(missing.map(|family| Self::Grasp { object: object.name.clone(), family }));
        }
        for key in ["place.approach_m", "push.approach_m", "push.standoff_m", "push.retreat_m", "place.retreat_m"] {
            all.push(Self::Shorter { key: key.to_owned(), least_m: SHORT_M });
        }
        all.push(Self::LessMargin { to_m: problem.safety.least_margin_m / 2.0 });
        let with_goal = problem.goal.by_object();
        all.extend(with_goal.iter().map(|(name, _)| Self::Tolerance { object: (*name).to_owned(), to_m: LOOSER_M }));
        let upright = problem.objects.iter().filter(|object| problem.has_goal(&object.name));
        all.extend(upright.map(|object| {
            let to_deg = (LEAN_TIMES * object.max_tilt_deg()).clamp(LEAN_DEG, 180.0);
            Self::Lean { object: object.name.clone(), to_deg }
        }));
        all.push(Self::WiderBounds { by_m: WIDER_M });
        all.extend((0..problem.steers.len()).map(|index| Self::WithoutRule { index }));
        let loose: Vec<_> = loose_obstacles(problem).collect();
        all.extend(loose.iter().map(|obstacle| Self::Shrink { obstacle: obstacle.name.clone(), share: SMALLER }));
        all.extend(loose.iter().map(|obstacle| Self::Without { obstacles: vec![obstacle.name.clone()] }));
        let free = problem.objects.iter().filter(|object| !problem.has_goal(&object.name));
        all.extend(free.map(|object| Self::WithoutObject { object: object.name.clone() }));
        let parts = with_goal.len() + usize::from(problem.goal.robot.is_some());
        if parts > 1 {
            all.extend(with_goal.iter().map(|(name, _)| Self::WithoutGoal { object: Some((*name).to_owned()) }));
            all.extend(problem.goal.robot.iter().map(|_| Self::WithoutGoal { object: None }));
        }
        all.retain(|relaxation| relaxation.applied(problem).is_some_and(|relaxed| relaxed != *problem));
        all
    }

    /// Obstacles that could be gone together: those whose names differ in a number at the end alone, and all of them.
    pub fn groups(problem: &ProblemFile) -> Vec<Self> {
        let mut stems: Vec<(&str, Vec<String>)> = Vec::new();
        for obstacle in loose_obstacles(problem) {
            let stem = obstacle.name.trim_end_matches(|c: char| c.is_ascii_digit());
            match stems.iter_mut().find(|(other, _)| *other == stem) {
                Some((_, names)) => names.push(obstacle.name.clone()),
                None => stems.push((stem, vec![obstacle.name.clone()])),
            }
        }
        let every: Vec<_> = loose_obstacles(problem).map(|obstacle| obstacle.name.clone()).collect();
        let mut groups: Vec<_> = stems.into_iter().map(|(_, names)| names).chain([every]).collect();
        groups.retain(|names| names.len() >= LEAST_GROUP);
        groups.dedup();
        groups.into_iter().map(|obstacles| Self::Without { obstacles }).collect()
    }

    /// Those that might do away with these causes, of [`Relaxation::all`] and [`Relaxation::groups`].
    pub(super) fn against<M: TaskRobot>(registry: &Registry<M>, problem: &ProblemFile, causes: &[Cause]) -> Vec<Self> {
        let blockers: Vec<&str> = causes.iter().flat_map(bodies_of).collect();
        let stages: Vec<Stage> = causes.iter().filter_map(stage_of).collect();
        let has = |stage: Stage| stages.contains(&stage);
        let is_far = has(Stage::Reach) || has(Stage::Line) || has(Stage::Arm) || has(Stage::Stand);
        let contracts = registry.contracts();
        let is_about = |relaxation: &Self| match relaxation {
            Self::HardLimits | Self::Lift { .. } => is_far,
            Self::Shorter { key, .. } => has(Stage::Approach) && key == "place.approach_m",
            Self::Without { obstacles } => obstacles.iter().any(|name| blockers.contains(&name.as_str())),
            Self::WithoutObject { object } => blockers.contains(&object.as_str()),
            Self::Allow { primitive } => contracts.get(primitive).is_some_and(|contract| {
                contract.object != ObjectRule::Rests || (contract.moves == MovingPart::Base && is_far)
            }),
            Self::Grasp { .. } => has(Stage::Hand) || has(Stage::Overhang) || has(Stage::Arm),
            Self::WiderBounds { .. } => blockers.contains(&super::hands::BOUNDS),
            Self::LessMargin { .. } => has(Stage::Room) || has(Stage::Hand) || has(Stage::Approach),
            _ => false,
        };
        let all = Self::all(registry, problem).into_iter().chain(Self::groups(problem));
        let lower = causes.iter().flat_map(|cause| Self::lowered(problem, cause));
        all.filter(|relaxation| is_about(relaxation)).chain(lower).collect()
    }

    /// The carriers of a goal that is out of reach, lower by as much as it is beyond.
    pub(super) fn lowered(problem: &ProblemFile, cause: &Cause) -> Vec<Self> {
        let Cause::NoHand { hands } = cause else { return Vec::new() };
        let (Some(beyond_m), Some(Stage::Reach)) = (hands.beyond_m, hands.last_stage()) else { return Vec::new() };
        let by_m = (beyond_m / LOWER_STEP_M).ceil() * LOWER_STEP_M;
        let surfaces = match hands.place {
            Place::Goal => {
                let goals = problem.goal.objects.iter().filter(|goal| goal.object == hands.object);
                goals.filter_map(|goal| goal.on.clone()).collect()
            }
            _ => problem.object(&hands.object).map(|object| object.on.clone()).into_iter().collect::<Vec<_>>(),
        };
        let carriers = surfaces.iter().filter_map(|name| problem.surface(name)?.top_of.clone());
        carriers.map(|obstacle| Self::Lower { obstacle, by_m }).collect()
    }

    /// The changed problem; `None` where it would be no problem any more.
    pub fn applied(&self, problem: &ProblemFile) -> Option<ProblemFile> {
        let mut changed = problem.clone();
        self.apply(&mut changed)?;
        changed.validate(&problem.name).ok()?;
        Some(changed)
    }

    fn apply(&self, problem: &mut ProblemFile) -> Option<()> {
        match self {
            Self::HardLimits => problem.robot.limits = Limits::Hard,
            Self::Lift { to_m } => problem.robot.torso_m = Some(*to_m),
            Self::Allow { primitive } => problem.primitives.push(primitive.clone()),
            Self::Grasp { object, family } => {
                problem.objects.iter_mut().find(|other| other.name == *object)?.grasps.push(*family);
            }
            Self::Shorter { key, least_m } => {
                let range = way(problem, key)?;
                if *least_m >= range.least_m {
                    return None;
                }
                *range = LengthRange::new(*least_m, range.wanted_m);
            }
            Self::LessMargin { to_m } => {
                problem.safety.least_margin_m = *to_m;
                problem.safety.contact_margin_m = problem.safety.contact_margin_m.min(*to_m);
            }
            Self::Tolerance { object, to_m } => {
                let goals = problem.goal.objects.iter_mut().filter(|goal| goal.object == *object);
                goals.for_each(|goal| goal.tolerance_m = goal.tolerance_m.max(*to_m));
            }
            Self::Lean { object, to_deg } => {
                let object = problem.objects.iter_mut().find(|other| other.name == *object)?;
                if *to_deg <= object.max_tilt_deg() {
                    return None;
                }
                object.max_tilt_deg = Some(*to_deg);
            }
            Self::WiderBounds { by_m } => {
                let bounds = &mut problem.bounds;
                for range in [
                    &mut bounds.base_x,
                    &mut bounds.base_y,
                    &mut bounds.object_x,
                    &mut bounds.object_y,
                    &mut bounds.object_z,
                ] {
                    *range = [range[0] - by_m, range[1] + by_m];
                }
            }
            Self::Lower { obstacle, by_m } => {
                let obstacle = problem.obstacles.iter_mut().find(|other| other.name == *obstacle)?;
                *obstacle.at.get_mut(2)? -= by_m;
            }
            Self::Shrink { obstacle, share } => {
                let obstacle = problem.obstacles.iter_mut().find(|other| other.name == *obstacle)?;
                shrink(&mut obstacle.shape, *share)?;
            }
            Self::Without { obstacles } => problem.obstacles.retain(|other| !obstacles.contains(&other.name)),
            Self::WithoutObject { object } => problem.objects.retain(|other| other.name != *object),
            Self::WithoutGoal { object: Some(object) } => problem.goal.objects.retain(|goal| goal.object != *object),
            Self::WithoutGoal { object: None } => problem.goal.robot = None,
            Self::WithoutRule { index } => {
                if *index >= problem.steers.len() {
                    return None;
                }
                problem.steers.remove(*index);
            }
            Self::MoreTime { iterations } => problem.budget.iterations = Some(*iterations),
        }
        Some(())
    }
}

/// Heights of the lift higher than the present one that the robot can have, the highest alone.
fn lifts<M: TaskRobot>(problem: &ProblemFile) -> impl Iterator<Item = f64> {
    let heights = LIFTS_M.rev().map(|i| f64::from(i) * LIFT_STEP_M);
    let can_have = |to_m: &f64| {
        let mut robot = problem.robot.clone();
        robot.torso_m = Some(*to_m);
        M::facts(&robot).is_ok() && M::build(&robot).is_ok()
    };
    let now_m = problem.robot.torso_m;
    heights.into_iter().find(can_have).filter(|to_m| now_m.is_none_or(|now_m| *to_m > now_m)).into_iter()
}

/// The obstacles on which nothing depends.
fn loose_obstacles(problem: &ProblemFile) -> impl Iterator<Item = &Obstacle> {
    problem.obstacles.iter().filter(|obstacle| {
        let carries = |body: Option<&str>| body == Some(obstacle.name.as_str());
        !problem.surfaces.iter().any(|surface| carries(surface.carrying_body()))
    })
}

fn way<'a>(problem: &'a mut ProblemFile, key: &str) -> Option<&'a mut LengthRange> {
    Some(match key {
        "place.approach_m" => &mut problem.place.approach_m,
        "place.retreat_m" => &mut problem.place.retreat_m,
        "push.approach_m" => &mut problem.push.approach_m,
        "push.standoff_m" => &mut problem.push.standoff_m,
        "push.retreat_m" => &mut problem.push.retreat_m,
        _ => return None,
    })
}

/// Makes a shape smaller about its origin; `None` for shapes of which that cannot be said.
fn shrink(shape: &mut ShapeSpec, share: f64) -> Option<()> {
    match shape {
        ShapeSpec::Box { size } => size.iter_mut().for_each(|length| *length *= share),
        ShapeSpec::Cylinder { radius, height } => (*radius, *height) = (*radius * share, *height * share),
        ShapeSpec::Sphere { radius } => *radius *= share,
        ShapeSpec::Mesh { scale, .. } => *scale *= share,
        _ => return None,
    }
    Some(())
}

/// The bodies that a cause names.
fn bodies_of(cause: &Cause) -> Vec<&str> {
    let blockers = match cause {
        Cause::NoHand { hands } => &hands.blockers,
        Cause::NoCommonGrasp { blockers, .. } => blockers,
        Cause::NoPush { pushes, edges } => {
            let edges = edges.iter().flat_map(|edge| &edge.hands.blockers);
            return pushes.blockers.iter().chain(edges).map(|blocker| blocker.body.as_str()).collect();
        }
        Cause::CutOff { floor, .. } => &floor.walls,
        Cause::Behind { others, .. } => others,
        _ => return Vec::new(),
    };
    blockers.iter().map(|blocker| blocker.body.as_str()).collect()
}

/// The stage at which the hands of a cause end.
fn stage_of(cause: &Cause) -> Option<Stage> {
    match cause {
        Cause::NoHand { hands } => hands.last_stage(),
        Cause::NoPush { edges, .. } => {
            edges.iter().filter_map(|edge| edge.hands.last_stage()).max().or(Some(Stage::Overhang))
        }
        _ => None,
    }
}
