//! What moves, from waypoint to waypoint.

use darrt_primitives::kinematics::limit::wrap_to_pi;
use darrt_primitives::manipulator::world_from_base;
use nalgebra::Isometry3;

use super::ViewerError;
use super::data::{self, HoldData, JointTrack, ObjectTrack, StartData, StepData, moves, rounded};
use super::scene::RobotModel;
use crate::clock::check::check;
use crate::clock::waypoint_times_s;
use crate::picture::{self, palette};
use crate::plan_file::timing::StepTiming;
use crate::plan_file::{ContactReason, PlanFile, Step, Waypoint};
use crate::problem_file::ProblemFile;

/// What part of its greatest speed a joint has while the plan is played; of a joint whose greatest speed is unknown: rad/s.
const JOINT_PACE: f64 = 0.35;
/// What goes from one waypoint to the next takes at least so long, seconds: each can be stopped at.
const SHORTEST_S: f64 = 0.01;
/// The same by a clock, which knows better.
const SHORTEST_BY_CLOCK_S: f64 = 0.001;
/// How fast the base drives (m/s) and turns (rad/s) then,
const BASE_PACE: [f64; 2] = [0.3, 0.6];
/// and how fast something is pushed at most, m/s.
const PUSH_PACE_M_PER_S: f64 = 0.1;

/// Where everything stands at one moment.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    pub(super) base: [f64; 3],
    /// By variable.
    pub(super) joints: Vec<f64>,
    /// By object.
    pub(super) objects: Vec<Isometry3<f64>>,
}

impl Moment {
    /// # Errors
    /// A joint or an object is missing.
    pub(super) fn read(
        waypoint: &Waypoint,
        robot: &RobotModel,
        problem: &ProblemFile,
        place: impl Fn() -> String,
    ) -> Result<Self, ViewerError> {
        let joints = robot.table().variables(&waypoint.joints);
        let joints = joints.map_err(|flaw| ViewerError::Joints { place: place(), flaw })?;
        let pose = |name: &str| {
            let missing = || ViewerError::Missing { place: place(), what: "object", name: name.to_owned() };
            waypoint.objects.get(name).map(|pose| Isometry3::from(*pose)).ok_or_else(missing)
        };
        let objects = problem.objects.iter().map(|object| pose(&object.name)).collect::<Result<_, _>>()?;
        Ok(Self { base: waypoint.base, joints, objects })
    }

    /// As the data's start.
    pub(super) fn data(&self) -> StartData {
        StartData {
            base: self.base.map(rounded),
            joints: self.joints.iter().copied().map(rounded).collect(),
            objects: self.objects.iter().map(data::pose).collect(),
        }
    }
}

/// A step with its waypoints read.
#[derive(Debug)]
pub(super) struct Act<'a> {
    pub(super) step: &'a Step,
    pub(super) kind: picture::Act,
    /// Which hand is at work, from 0.
    hand: usize,
    pub(super) moments: Vec<Moment>,
    pub(super) object: Option<usize>,
    pub(super) pushes: Option<usize>,
    pub(super) holds: Option<(usize, Isometry3<f64>)>,
    clock: Option<&'a StepTiming>,
}

/// The steps of a plan.
///
/// # Errors
/// A step names an object that the problem does not have or a primitive without a contract, has less than two waypoints, or
/// one of them lacks something.
pub(super) fn acts<'a>(plan: &'a PlanFile, robot: &RobotModel) -> Result<Vec<Act<'a>>, ViewerError> {
    // What is drawn need not be right: a clock that is none is not followed.
    let clock = plan.timing.as_ref().filter(|timing| check(plan, timing).is_ok());
    let tools = robot.tool_names();
    let act = |(index, step): (usize, &'a Step)| {
        let place = || format!("steps[{index}]");
        let find = |name: &str| {
            let missing = || ViewerError::Missing { place: place(), what: "object", name: name.to_owned() };
            plan.problem.objects.iter().position(|object| object.name == name).ok_or_else(missing)
        };
        let contract = plan.contracts.get(&step.primitive).ok_or_else(|| ViewerError::Missing {
            place: "contracts".to_owned(),
            what: "primitive",
            name: step.primitive.to_string(),
        })?;
        let waypoints = step.waypoints.iter().enumerate();
        let moments = waypoints.map(|(at, waypoint)| {
            Moment::read(waypoint, robot, &plan.problem, || format!("steps[{index}].waypoints[{at}]"))
        });
        let moments = moments.collect::<Result<Vec<_>, _>>()?;
        if moments.len() < 2 {
            return Err(ViewerError::Missing { place: place(), what: "waypoint", name: "second".to_owned() });
        }
        let hand = step.hand_among(&tools).map_err(|error| {
            let place = format!("steps[{index}].tool");
            ViewerError::Tool { place, error: Box::new(error) }
        })?;
        let holds = step.holds.as_ref();
        let holds = holds.map(|hold| Ok::<_, ViewerError>((find(&hold.object)?, hold.tool_from_object.into())));
        Ok(Act {
            step,
            kind: picture::Act::of(contract),
            hand,
            moments,
            object: step.object.as_deref().map(find).transpose()?,
            pushes: step.pushes.as_deref().map(find).transpose()?,
            holds: holds.transpose()?,
            clock: clock.and_then(|clock| clock.steps.get(index)),
        })
    };
    plan.steps.iter().enumerate().map(act).collect()
}

impl Act<'_> {
    /// As data, without clearances.
    pub(super) fn data(&self, robot: &RobotModel) -> StepData {
        let base: Vec<_> = self.moments.iter().map(|moment| moment.base.map(rounded)).collect();
        let joint = |variable: usize| {
            let values = self.moments.iter().map(|moment| moment.joints.get(variable).copied().unwrap_or_default());
            JointTrack::of(variable, values)
        };
        let object = |object: usize| {
            // What is held follows from the hand.
            let is_held = self.holds.is_some_and(|(held, _)| held == object);
            let poses = self.moments.iter().filter_map(|moment| moment.objects.get(object));
            if is_held { None } else { ObjectTrack::of(object, poses) }
        };
        let contacts = self.step.allowed_contacts.iter();
        let hold =
            |(object, pose): &(usize, Isometry3<f64>)| HoldData { object: *object, tool_from_object: data::pose(pose) };
        StepData {
            name: self.step.primitive.to_string(),
            colour: palette::of(self.kind).to_owned(),
            times: self.times(robot),
            object: self.object,
            pushes: self.pushes,
            tool: (self.hand > 0).then(|| robot.tool(self.hand)),
            holds: self.holds.as_ref().map(hold),
            contacts: contacts.map(|pair| [pair.a.clone(), pair.b.clone(), reason(pair.reason).to_owned()]).collect(),
            base: if moves(&base) { base } else { Vec::new() },
            joints: (0..robot.tree.variables().len()).filter_map(joint).collect(),
            objects: (0..self.moments.first().map_or(0, |moment| moment.objects.len())).filter_map(object).collect(),
            clearance: Vec::new(),
        }
    }

    /// Seconds to each waypoint: by the plan's clock, or, if it has none, at an even, calm pace.
    pub(super) fn times(&self, robot: &RobotModel) -> Vec<f64> {
        let mut now = 0.0;
        if let Some(clock) = self.clock {
            let mut times = waypoint_times_s(clock, self.moments.len(), |from, to, at| self.share(robot, from, to, at));
            for time in times.iter_mut().skip(1) {
                now = time.max(now + SHORTEST_BY_CLOCK_S);
                *time = data::to(now, 1e3);
            }
            return times;
        }
        let mut times = vec![now];
        for pair in self.moments.windows(2) {
            if let [from, to] = pair {
                now += self.seconds(robot, from, to);
            }
            times.push(data::to(now, 1e3));
        }
        times
    }

    /// What part of the straight line between two waypoints is gone at a third.
    fn share(&self, robot: &RobotModel, from: usize, to: usize, at: usize) -> f64 {
        let (Some(a), Some(b), Some(p)) = (self.moments.get(from), self.moments.get(to), self.moments.get(at)) else {
            return 0.0;
        };
        let ways = |end: &Moment| {
            let joints = a.joints.iter().zip(&end.joints).zip(robot.tree.variables());
            let joints =
                joints.map(|((a, b), variable)| if variable.limit.is_unlimited() { wrap_to_pi(b - a) } else { b - a });
            let [x, y, yaw] = [0, 1, 2].map(|i| end.base[i] - a.base[i]);
            [x, y, wrap_to_pi(yaw)].into_iter().chain(joints).collect::<Vec<_>>()
        };
        let (whole, part) = (ways(b), ways(p));
        let farthest = whole.iter().zip(&part).max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
        farthest.map_or(0.0, |(whole, part)| if *whole == 0.0 { 0.0 } else { (part / whole).clamp(0.0, 1.0) })
    }

    fn seconds(&self, robot: &RobotModel, from: &Moment, to: &Moment) -> f64 {
        let joints = from.joints.iter().zip(&to.joints).zip(robot.tree.variables()).map(|((from, to), variable)| {
            let way = if variable.limit.is_unlimited() { wrap_to_pi(to - from) } else { to - from };
            let pace = if variable.max_velocity > 0.0 { JOINT_PACE * variable.max_velocity } else { JOINT_PACE };
            way.abs() / pace
        });
        let [x, y, yaw] = [0, 1, 2].map(|i| to.base[i] - from.base[i]);
        let base = x.hypot(y) / BASE_PACE[0] + wrap_to_pi(yaw).abs() / BASE_PACE[1];
        let pushed = self.pushes.and_then(|object| Some((from.objects.get(object)?, to.objects.get(object)?)));
        let pushed = pushed.map_or(0.0, |(a, b)| (b.translation.vector - a.translation.vector).norm());
        joints.fold(SHORTEST_S, f64::max).max(base).max(pushed / PUSH_PACE_M_PER_S)
    }

    /// Where everything stands `at` waypoints from the beginning, half way between two at 0.5. Writes the poses of the links.
    pub(super) fn at(&self, robot: &RobotModel, at: f64, world_from_link: &mut [Isometry3<f64>]) -> Option<Moment> {
        let last = self.moments.len().checked_sub(1)?;
        let below = at.floor().clamp(0.0, last as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between zero and a length")]
        let index = below as usize;
        let (from, part) = (self.moments.get(index)?, (at - below).clamp(0.0, 1.0));
        let to = self.moments.get((index + 1).min(last))?;
        let mut moment = from.clone();
        if part > 0.0 {
            for (slot, way) in moment.base.iter_mut().zip([0, 1, 2].map(|i| to.base[i] - from.base[i])).take(2) {
                *slot += part * way;
            }
            moment.base[2] += part * wrap_to_pi(to.base[2] - from.base[2]);
            let variables = robot.tree.variables();
            for ((slot, to), variable) in moment.joints.iter_mut().zip(&to.joints).zip(variables) {
                let way = to - *slot;
                *slot += part * if variable.limit.is_unlimited() { wrap_to_pi(way) } else { way };
            }
            for (slot, to) in moment.objects.iter_mut().zip(&to.objects) {
                *slot = slot.lerp_slerp(to, part);
            }
        }
        // The lengths are the tree's own.
        robot.tree.forward(&moment.joints, &world_from_base(&moment.base), world_from_link).ok()?;
        if let Some((object, tool_from_object)) = self.holds {
            *moment.objects.get_mut(object)? = world_from_link.get(robot.tool(self.hand))? * tool_from_object;
        }
        Some(moment)
    }
}

/// Why two bodies may touch, as plan files say it.
const fn reason(reason: ContactReason) -> &'static str {
    match reason {
        ContactReason::Push => "push",
        ContactReason::Grasp => "grasp",
        ContactReason::Retreat => "retreat",
        ContactReason::Support => "support",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{LEFT_TOOL, both_hands, facts, left_handed};
    use crate::viewer::of_plan;

    #[test]
    fn what_the_second_hand_holds_goes_with_its_tool() {
        let plan = left_handed();
        let robot = RobotModel::of(&both_hands(&plan.problem)).unwrap();
        let tool = robot.tree.link_index(LEFT_TOOL).unwrap();
        let data = of_plan(&plan, "", &robot).unwrap();
        assert_eq!((data.robot.tools.len(), data.robot.tools[1]), (2, tool));
        assert!(data.steps.iter().all(|step| step.tool == Some(tool)));
        let mut links = vec![Isometry3::identity(); robot.tree.link_count()];
        for act in acts(&plan, &robot).unwrap().iter().filter(|act| act.holds.is_some()) {
            let (object, _) = act.holds.unwrap();
            // At a waypoint the file says the same.
            let moment = act.at(&robot, 1.0, &mut links).unwrap();
            let off = moment.objects[object].translation.vector - act.moments[1].objects[object].translation.vector;
            assert!(off.norm() < 1e-6, "{off}");
        }
        // Of a robot with one hand nothing is said of tools.
        let mut alone = plan.clone();
        alone.steps.iter_mut().for_each(|step| step.tool = None);
        let data = of_plan(&alone, "", &RobotModel::of(&facts(&plan.problem)).unwrap()).unwrap();
        let text = serde_json::to_string(&data).unwrap();
        assert!(!text.contains("\"tools\"") && data.robot.tool == tool && data.steps.iter().all(|s| s.tool.is_none()));
        let mut lie = plan;
        lie.steps[2].tool = Some("hook".to_owned());
        let error = of_plan(&lie, "", &robot).unwrap_err().to_string();
        assert!(error.contains("`steps[2].tool`") && error.contains(LEFT_TOOL), "{error}");
    }
}
