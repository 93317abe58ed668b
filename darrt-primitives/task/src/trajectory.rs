//! A timed plan as a controller takes it: sampled, by groups of joints, in the shapes of the messages of ROS.
//!
//! | question | file |
//! |---|---|
//! | at which times is it sampled? | here |
//! | which messages are there? | [`messages`] |
//! | how wide is the hand open? | [`width`] |
//! | one document with everything a driver needs | [`document`] |
//!
//! `docs/timed-plan.md` explains the files to readers without this code.

pub mod document;
pub mod messages;
pub mod width;

use crate::clock::{ClockError, Event, EventKind, Moment, TimedPlan};
use crate::plan_file::PlanFile;
use crate::robot::RobotFacts;
use messages::{
    GripperCommand, Header, JointTrajectory, JointTrajectoryPoint, MultiDofJointTrajectory,
    MultiDofJointTrajectoryPoint, RobotTrajectory, Seconds, Transform, Twist,
};
use width::HandWidth;

/// Samples nearer to each other than this become one, seconds: some controllers refuse points that are too near.
const NEAREST_S: f64 = 1e-3;

/// The joint of the base in messages about several degrees of freedom: the usual name of the virtual joint of a robot that
/// drives.
pub const BASE_JOINT: &str = "world_joint";
/// The names of the base's coordinates where they are given as joints of their own.
pub const BASE_JOINTS: [&str; 3] = ["base_x", "base_y", "base_yaw"];
/// The frame in which the base is given.
pub const WORLD: &str = "world";

/// A timed plan at the times at which it is written down.
#[derive(Debug)]
pub struct Sampled {
    timed: TimedPlan,
    samples: Vec<(f64, Moment)>,
    /// By hand.
    widths: Vec<HandWidth>,
}

/// The samples of some joints.
type Picked<'a> = &'a dyn Fn(&Moment) -> [Vec<f64>; 3];

impl Sampled {
    /// The plan every `period_s` seconds, and wherever its motion begins, ends or changes its jerk.
    ///
    /// # Errors
    /// [`ClockError`] when plan and robot do not fit together.
    pub fn new(plan: &PlanFile, facts: &RobotFacts, period_s: f64) -> Result<Self, ClockError> {
        let timed = TimedPlan::new(plan, facts)?;
        let widths = (0..facts.hands()).map(|hand| HandWidth::new(&facts.of_hand(hand))).collect::<Result<_, _>>()?;
        let end_s = timed.duration_s();
        let mut times = vec![0.0];
        let mut marks = timed.marks_s().into_iter().chain([end_s]).peekable();
        let mut tick = 1.0;
        while let Some(&mark) = marks.peek() {
            let next = tick * period_s;
            let last = times.last().copied().unwrap_or(0.0);
            if next < mark {
                if next - last >= NEAREST_S && mark - next >= NEAREST_S {
                    times.push(next);
                }
                tick += 1.0;
            } else {
                if mark - last >= NEAREST_S {
                    times.push(mark);
                }
                marks.next();
            }
        }
        // The end must be among them.
        if let Some(last) = times.last_mut()
            && end_s > 0.0
            && end_s - *last < NEAREST_S
        {
            *last = end_s;
        }
        let samples = times.into_iter().map(|t_s| (t_s, timed.at(t_s))).collect();
        Ok(Self { timed, samples, widths })
    }

    /// The plan on its clock.
    pub fn timed(&self) -> &TimedPlan {
        &self.timed
    }

    /// The samples: seconds from the start, growing, and the robot.
    pub fn samples(&self) -> &[(f64, Moment)] {
        &self.samples
    }

    /// The name of a variable of the robot's tree.
    pub fn name(&self, variable: usize) -> String {
        self.timed.tree().variables().get(variable).map_or_else(String::new, |v| v.name.to_string())
    }

    /// The joints of the arm, or of all arms.
    pub fn arm(&self) -> JointTrajectory {
        self.of(self.timed.arm())
    }

    /// By hand: the joint that opens it.
    pub fn grippers(&self) -> Vec<JointTrajectory> {
        self.timed.fingers().into_iter().map(|finger| self.of(&[finger])).collect()
    }

    /// The variables that a plan moves: those of the arms, then those that open the hands.
    pub fn moving(&self) -> Vec<usize> {
        self.timed.arm().iter().copied().chain(self.timed.fingers()).collect()
    }

    /// These variables of the robot's tree.
    fn of(&self, variables: &[usize]) -> JointTrajectory {
        let pick = |values: &[f64]| variables.iter().filter_map(|i| values.get(*i).copied()).collect::<Vec<_>>();
        let names = variables.iter().map(|variable| self.name(*variable)).collect();
        self.trajectory(names, &|m| [pick(&m.joints), pick(&m.joint_velocity), pick(&m.joint_acceleration)])
    }

    /// The base as three joints.
    pub fn base(&self) -> JointTrajectory {
        let names = BASE_JOINTS.map(str::to_owned).to_vec();
        self.trajectory(names, &|m| [m.base.to_vec(), m.base_velocity.to_vec(), m.base_acceleration.to_vec()])
    }

    fn trajectory(&self, joint_names: Vec<String>, pick: Picked<'_>) -> JointTrajectory {
        let points = self.samples.iter().map(|(t_s, moment)| {
            let [positions, velocities, accelerations] = pick(moment);
            let time_from_start = Seconds::from_s(*t_s);
            JointTrajectoryPoint { positions, velocities, accelerations, effort: Vec::new(), time_from_start }
        });
        JointTrajectory { header: Header::in_frame(""), joint_names, points: points.collect() }
    }

    /// The joints that stand all along, with where they stand.
    pub fn standing(&self) -> Vec<(String, f64)> {
        let moving = self.moving();
        let Some((_, first)) = self.samples.first() else { return Vec::new() };
        let standing = (0..first.joints.len()).filter(|variable| !moving.contains(variable));
        standing.filter_map(|i| Some((self.name(i), *first.joints.get(i)?))).collect()
    }

    /// The whole robot as one message: arms and fingers as joints, the base as a joint of several degrees of freedom.
    pub fn robot(&self) -> RobotTrajectory {
        let points = self.samples.iter().map(|(t_s, moment)| {
            let [vx, vy, turn] = moment.base_velocity;
            let [ax, ay, spin] = moment.base_acceleration;
            MultiDofJointTrajectoryPoint {
                transforms: vec![Transform::on_floor(&moment.base)],
                velocities: vec![Twist::on_floor([vx, vy, turn])],
                accelerations: vec![Twist::on_floor([ax, ay, spin])],
                time_from_start: Seconds::from_s(*t_s),
            }
        });
        RobotTrajectory {
            joint_trajectory: self.of(&self.moving()),
            multi_dof_joint_trajectory: MultiDofJointTrajectory {
                header: Header::in_frame(WORLD),
                joint_names: vec![BASE_JOINT.to_owned()],
                points: points.collect(),
            },
        }
    }

    /// What happens besides motion.
    pub fn events(&self) -> Vec<Event> {
        self.timed.events()
    }

    /// What the hand at work is told in an event; `None` if it is told nothing.
    pub fn command(&self, event: &Event) -> Option<GripperCommand> {
        let EventKind::Fingers { to, force_n, .. } = event.kind else { return None };
        let mut joints = self.timed.at(event.time_s).joints;
        let hand = self.timed.hand(event.step);
        *joints.get_mut(*self.timed.fingers().get(hand)?)? = to;
        Some(GripperCommand {
            position: self.widths.get(hand)?.gap_m(&joints),
            max_effort: force_n.unwrap_or(NO_LIMIT),
        })
    }
}

/// What a command to a gripper says where its effort is not limited.
pub const NO_LIMIT: f64 = -1.0;

#[cfg(test)]
mod tests {
    use super::document::Document;
    use super::*;
    use crate::testing::{LEFT_TOOL, both_hands, facts, left_handed};

    #[test]
    fn both_arms_are_told_and_the_hand_at_work_by_its_tool() {
        let plan = left_handed();
        let sampled = Sampled::new(&plan, &both_hands(&plan.problem), 0.1).unwrap();
        let document = Document::new(&plan, &sampled);
        assert_eq!(document.groups["arm"].joint_names.len(), 14);
        let hands = ["gripper", "second_gripper"].map(|hand| document.groups[hand].joint_names.clone());
        assert_eq!(hands, [["r_gripper_l_finger_joint"], ["l_gripper_l_finger_joint"]]);
        assert!(document.standing.keys().all(|name| !name.contains("gripper") && !name.contains("wrist")));
        assert!(!document.gripper_commands.is_empty());
        assert!(document.gripper_commands.iter().all(|told| told.tool.as_deref() == Some(LEFT_TOOL)));
        assert_eq!(sampled.robot().joint_trajectory.joint_names.len(), 16);
        // As wide as the same plan of the left arm alone.
        let mut alone = plan.clone();
        alone.steps.iter_mut().for_each(|step| step.tool = None);
        let one = Document::new(&alone, &Sampled::new(&alone, &facts(&plan.problem), 0.1).unwrap());
        let widths = |document: &Document| -> Vec<f64> {
            document.gripper_commands.iter().map(|told| told.command.position).collect()
        };
        assert_eq!(widths(&document), widths(&one));
        assert_eq!(one.groups.keys().copied().collect::<Vec<_>>(), ["arm", "base", "gripper"]);
        assert!(!serde_json::to_string(&one).unwrap().contains("\"tool\""));
    }
}
