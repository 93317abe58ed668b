//! Goals for table-top problems: where objects shall be, whether the hand has let go of them, and where the robot shall be.

use darrt_core::domain::Domain;
use darrt_core::goal::Goal;
use darrt_core::partial::PartialState;
use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::turn;
use darrt_core::state::ObjectId;
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Vector3};
use rand::{Rng, RngExt};

use crate::kinematics::JointLimit;
use crate::manipulator::{Configuration, JointVector, Manipulator};
use crate::mobile_arm_space::{ARM, BASE};
use crate::mode::SurfaceId;
use crate::object_space::upright;
use crate::tabletop::{Tabletop, TabletopState};

/// Whether the object must be in the hand at the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grip {
    /// It rests and the hand has retreated from it.
    Released,
    /// The hand holds it.
    Held,
    /// Either.
    Any,
}

/// Where an object shall be.
#[derive(Debug, Clone, PartialEq)]
pub enum Whereabouts {
    /// Its centre within the tolerance of this point, upright.
    At(Vector3<f64>),
    /// Standing on a part of a support with its centre in the rectangle between two corners (world x, y).
    Within {
        /// The support.
        support: SurfaceId,
        /// The part of it, or all of it: where the centre must be besides.
        part: SupportSurface,
        /// Least x and y.
        min: Point2<f64>,
        /// Largest x and y.
        max: Point2<f64>,
    },
}

/// The goal for one object.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectGoal {
    /// Which object.
    pub object: ObjectId,
    /// Where.
    pub whereabouts: Whereabouts,
    /// How far its centre may be off in x and y, and in z, from the point or the rectangle, metres.
    pub tolerance_m: f64,
    /// Wanted yaw and its tolerance, radians; `None`: free.
    pub yaw: Option<(f64, f64)>,
    /// In the hand or not.
    pub grip: Grip,
}

/// How far an object that should be upright may lean, radians.
pub const UPRIGHT_TOLERANCE_RAD: f64 = 0.01;

/// How often a point of a region is drawn until it lies on the surface.
const DRAWS: usize = 100;

impl ObjectGoal {
    /// Is this goal met?
    pub fn is_met<M: Manipulator>(&self, state: &TabletopState<M>) -> bool {
        let Some(pose) = state.object(self.object) else { return false };
        let held = state.mode.held().is_some_and(|h| h.object == self.object);
        let resting = state.mode.support_of(self.object);
        let grip = match self.grip {
            Grip::Released => resting.is_some() && state.mode.engaged() != Some(self.object),
            Grip::Held => held,
            Grip::Any => true,
        };
        let is_there = match &self.whereabouts {
            Whereabouts::At(place) => (pose.translation.vector - place).norm() <= self.tolerance_m,
            Whereabouts::Within { support, part, min, max } => {
                let at = Point2::new(pose.translation.x, pose.translation.y);
                let nearest = at.coords.sup(&min.coords).inf(&max.coords);
                let is_between = (at.coords - nearest).norm() <= self.tolerance_m;
                resting == Some(*support) && is_between && part.contains(&at)
            }
        };
        let up = pose.rotation * Vector3::z();
        let yaw_ok =
            self.yaw.is_none_or(|(yaw, tolerance)| turn(pose.rotation.euler_angles().2, yaw).abs() <= tolerance);
        grip && is_there && yaw_ok && up.angle(&Vector3::z()) <= UPRIGHT_TOLERANCE_RAD
    }

    /// A pose that meets it.
    fn sample<M: Manipulator>(&self, m: &Tabletop<M>, rng: &mut dyn Rng) -> Option<Isometry3<f64>> {
        let yaw = match self.yaw {
            Some((yaw, _)) => yaw,
            None => rng.random_range(-std::f64::consts::PI..std::f64::consts::PI),
        };
        match &self.whereabouts {
            Whereabouts::At(place) => Some(upright(*place, yaw)),
            Whereabouts::Within { support, part, min, max } => {
                let mut draw = || Point2::new(rng.random_range(min.x..=max.x), rng.random_range(min.y..=max.y));
                let at = (0..DRAWS).map(|_| draw()).find(|at| part.contains(at))?;
                Some(m.objects().get(self.object.index())?.standing(m.surface(*support)?, &at, yaw))
            }
        }
    }
}

/// The goal for the robot: every part that is given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RobotGoal<J> {
    /// x, y and yaw of the base.
    pub base: Option<[f64; 3]>,
    /// Joints of the arm.
    pub arm: Option<J>,
    /// The pose of the tool in the world.
    pub world_from_tool: Option<Isometry3<f64>>,
    /// How far base, tool and sliding joints may be off, metres.
    pub tolerance_m: f64,
    /// How far yaw, tool and turning joints may be turned off, radians.
    pub tolerance_rad: f64,
}

/// How often a stance is drawn that brings the tool to a pose.
const STANCES: usize = 64;

impl<J: JointVector> RobotGoal<J> {
    fn is_met<M: Manipulator<Joints = J>>(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> bool {
        let q = &state.robot;
        let base = self.base.is_none_or(|[x, y, yaw]| {
            (q.base[0] - x).hypot(q.base[1] - y) <= self.tolerance_m && turn(q.base[2], yaw).abs() <= self.tolerance_rad
        });
        // A sliding joint that is off by as much as a turning one may be is off by less than the hand may be.
        let off = |a: f64, b: f64, limit: &JointLimit| if limit.is_unlimited() { turn(a, b) } else { a - b }.abs();
        let limits = m.manipulator().limits();
        let arm = self.arm.as_ref().is_none_or(|arm| {
            let mut joints = q.arm.as_ref().iter().zip(arm.as_ref()).zip(limits);
            joints.all(|((a, b), limit)| off(*a, *b, limit) <= self.tolerance_rad)
        });
        let tool = self.world_from_tool.as_ref().is_none_or(|wanted| {
            let is_there = |tool: Isometry3<f64>| {
                (tool.translation.vector - wanted.translation.vector).norm() <= self.tolerance_m
                    && tool.rotation.angle_to(&wanted.rotation) <= self.tolerance_rad
            };
            // Any of its hands.
            let of_hand = |hand| Configuration { arm: q.arm.with_hand_at_work(hand), ..*q };
            (0..m.manipulator().hands()).any(|hand| is_there(m.manipulator().world_from_tool(&of_hand(hand))))
        });
        base && arm && tool
    }

    /// `target` with the robot where it meets the goal; `None` if no stance was found.
    fn added_to<M: Manipulator<Joints = J>>(
        &self,
        m: &Tabletop<M>,
        target: PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Option<PartialState<Tabletop<M>>> {
        let robot = m.manipulator();
        if let Some(tool) = &self.world_from_tool {
            let hands = robot.hands();
            // Joints that do not move the hand may be anywhere.
            let others = m.settings().postures.first().unwrap_or(m.robot().zeros());
            let stance = (0..STANCES).find_map(|_| {
                let hand = if hands > 1 { rng.random_range(0..hands) } else { 0 };
                let now = others.with_hand_at_work(hand);
                let base = self.base.unwrap_or_else(|| robot.base_for_hand(hand, tool, rng));
                let arm = self.arm.or_else(|| robot.inverse_from(&now, &base, tool, rng))?;
                let stance = Configuration { base, arm };
                m.robot().contains(&stance).then_some(stance)
            })?;
            return Some(target.with_robot_groups(stance, BASE.union(ARM)));
        }
        let groups = match (self.base, self.arm) {
            (Some(_), Some(_)) => BASE.union(ARM),
            (Some(_), None) => BASE,
            (None, Some(_)) => ARM,
            (None, None) => return Some(target),
        };
        let config = Configuration { base: self.base.unwrap_or_default(), arm: self.arm.unwrap_or(*m.robot().zeros()) };
        Some(target.with_robot_groups(config, groups))
    }
}

/// Every group of alternatives must have one that is met, and the robot be where it shall be.
#[derive(Debug, Clone, PartialEq)]
pub struct TabletopGoal<J> {
    groups: Vec<Vec<ObjectGoal>>,
    robot: Option<RobotGoal<J>>,
}

impl<J> TabletopGoal<J> {
    /// The conjunction of `groups`, each a list of alternatives.
    pub fn new(groups: Vec<Vec<ObjectGoal>>) -> Self {
        Self { groups, robot: None }
    }

    /// The same, and the robot where `robot` says.
    #[must_use]
    pub fn with_robot(self, robot: Option<RobotGoal<J>>) -> Self {
        Self { robot, ..self }
    }

    /// Where the robot must be, if that is asked for.
    pub fn robot(&self) -> Option<&RobotGoal<J>> {
        self.robot.as_ref()
    }

    /// Of every group one must be met.
    pub fn groups(&self) -> &[Vec<ObjectGoal>] {
        &self.groups
    }
}

impl<J: JointVector> TabletopGoal<J> {
    /// The goals for the objects alone.
    #[must_use]
    pub fn of_objects(&self) -> Self {
        Self { groups: self.groups.clone(), robot: None }
    }

    /// The goal for the robot alone, if there is one.
    pub fn of_robot(&self) -> Option<Self> {
        self.robot.is_some().then(|| Self { groups: Vec::new(), robot: self.robot.clone() })
    }

    /// Is the robot where it shall be?
    pub fn is_robot_met<M: Manipulator<Joints = J>>(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> bool {
        self.robot.as_ref().is_none_or(|goal| goal.is_met(m, state))
    }
}

impl<M: Manipulator> Goal<Tabletop<M>> for TabletopGoal<M::Joints> {
    fn is_satisfied(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> bool {
        self.groups.iter().all(|alternatives| alternatives.iter().any(|goal| goal.is_met(state)))
            && self.is_robot_met(m, state)
    }

    /// The groups of which one alternative is met, and the robot.
    fn parts_met(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> usize {
        let groups = self.groups.iter().filter(|alternatives| alternatives.iter().any(|goal| goal.is_met(state)));
        groups.count() + usize::from(self.robot.as_ref().is_some_and(|goal| goal.is_met(m, state)))
    }

    fn sample(&self, m: &Tabletop<M>, rng: &mut dyn Rng) -> Option<PartialState<Tabletop<M>>> {
        let mut target = PartialState::anywhere(m);
        for alternatives in &self.groups {
            if alternatives.is_empty() {
                return None;
            }
            let goal = alternatives.get(rng.random_range(0..alternatives.len()))?;
            target = target.with_object(goal.object, goal.sample(m, rng)?);
        }
        match &self.robot {
            Some(goal) => goal.added_to(m, target, rng),
            None => Some(target),
        }
    }
}
