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
    width: HandWidth,
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
        let width = HandWidth::new(facts)?;
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
        Ok(Self { timed, samples, width })
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

    /// The arm's joints.
    pub fn arm(&self) -> JointTrajectory {
        self.of(self.timed.arm())
    }

    /// The joint that opens the hand.
    pub fn gripper(&self) -> JointTrajectory {
        self.of(&[self.timed.finger()])
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
        let moves = |variable: &usize| self.timed.arm().contains(variable) || *variable == self.timed.finger();
        let Some((_, first)) = self.samples.first() else { return Vec::new() };
        let standing = (0..first.joints.len()).filter(|variable| !moves(variable));
        standing.filter_map(|i| Some((self.name(i), *first.joints.get(i)?))).collect()
    }

    /// The whole robot as one message: arm and fingers as joints, the base as a joint of several degrees of freedom.
    pub fn robot(&self) -> RobotTrajectory {
        let mut moving = self.timed.arm().to_vec();
        moving.push(self.timed.finger());
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
            joint_trajectory: self.of(&moving),
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

    /// What the hand is told in an event; `None` if it is told nothing.
    pub fn command(&self, event: &Event) -> Option<GripperCommand> {
        let EventKind::Fingers { to, force_n, .. } = event.kind else { return None };
        let mut joints = self.timed.at(event.time_s).joints;
        *joints.get_mut(self.timed.finger())? = to;
        Some(GripperCommand { position: self.width.gap_m(&joints), max_effort: force_n.unwrap_or(NO_LIMIT) })
    }
}

/// What a command to a gripper says where its effort is not limited.
pub const NO_LIMIT: f64 = -1.0;
