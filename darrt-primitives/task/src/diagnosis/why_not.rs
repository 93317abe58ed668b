//! Why not so? A state of the robot, or a place of its hand, that a person has in mind is looked at as the planner would, and the
//! first thing that is wrong is told, by how much, and the nearest variant that is right.
//!
//! All is drawn from fixed seeds: the same question has the same answer. "From none of 96 bases" is what was counted.

use darrt_core::budget::Cancel;
use darrt_core::domain::Domain as _;
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::ObjectId;
use darrt_core::validity::Blame;
use darrt_geom::scene::Scene;
use darrt_geom::{Body, clearance};
use darrt_primitives::kinematics::urdf::JointKind;
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator};
use darrt_primitives::mode::Contacts;
use darrt_primitives::tabletop::{Tabletop, TabletopState};
use nalgebra::Isometry3;
use rand::RngExt as _;
use serde::Serialize;

use super::cause::Stage;
use super::hands::{BOUNDS, Look};
use crate::planning_error::PlanningError;
use crate::problem_file::ProblemFile;
use crate::registry::Registry;
use crate::robot::TaskRobot;
use crate::world::{self, Built};

mod hand;

/// A turn by a radian counts as so many metres.
const METRES_PER_RADIAN: f64 = 0.3;
/// How far away variants of a state are looked for, as shares of a metre and a radian: so many draws at each.
const SPREADS: [f64; 9] = [0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.4, 0.7, 1.0];
const DRAWS: u64 = 80;
/// Steps of bisection towards what was asked about.
const BISECTIONS: u32 = 8;

/// What a person has in mind.
#[derive(Debug, Clone, PartialEq)]
pub enum Idea {
    /// The robot stands there.
    State {
        /// x, y, yaw of the base, metres and radians; where the problem starts if none.
        base: Option<[f64; 3]>,
        /// The joints of the arm, radians and metres; as the problem starts if none.
        joints: Option<Vec<f64>>,
    },
    /// The hand is there.
    Hand {
        /// Pose of the tool frame in the world.
        world_from_tool: Isometry3<f64>,
        /// To take this object where it stands.
        takes: Option<String>,
    },
}

/// What was asked.
#[derive(Debug, Clone)]
pub struct WhyNotRequest {
    /// The problem.
    pub problem: ProblemFile,
    /// What a person has in mind.
    pub idea: Idea,
}

/// What is wrong with an idea.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wrong {
    /// A joint is beyond a limit.
    Limit,
    /// The base is out of its bounds.
    Bounds,
    /// The base meets something.
    Base,
    /// The robot meets something.
    Robot,
    /// The hand alone meets something.
    Hand,
    /// The place of the hand is no grasp of the object.
    Grasp,
    /// The grasp, or what Pick does around it, comes to an end: see the stage.
    Pick(Stage),
    /// The arm reaches the place from no base tried.
    Reach,
}

/// The first thing that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// What it is.
    pub wrong: Wrong,
    /// The joint, or the bodies, that it is about.
    pub names: Vec<String>,
    /// By how much, in metres for what lies or overlaps, radians for joints that turn; none where it cannot be said.
    pub by: Option<f64>,
    /// Is that an angle?
    pub is_angle: bool,
    /// Bases that were tried.
    pub bases: u64,
}

/// A variant that is right.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Variant {
    /// x, y, yaw of the base.
    pub base: [f64; 3],
    /// The joints of the arm.
    pub joints: Vec<f64>,
    /// The place of the hand: x, y, z, roll, pitch, yaw.
    pub tool: [f64; 6],
    /// How far the hand (for a state: the base) is from where it was wanted, metres,
    pub away_m: f64,
    /// and turned, radians.
    pub turned_rad: f64,
    /// For a state: how far the joint that moves most does, radians or metres.
    pub joint_most: f64,
}

/// The answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WhyNot {
    /// The problem.
    pub problem: String,
    /// What is wrong first; none if nothing is.
    pub fault: Option<Fault>,
    /// The nearest right variant that was found; what was asked about itself if nothing is wrong.
    pub variant: Option<Variant>,
}

/// An idea that is none for this problem.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WhyNotError {
    /// The problem cannot be built.
    #[error(transparent)]
    Planning(#[from] PlanningError),
    /// The arm has another number of joints.
    #[error("{found} joints are given, the arm has {expected}")]
    Joints {
        /// How many are given.
        found: usize,
        /// How many it has.
        expected: usize,
    },
    /// There is no such object.
    #[error("the problem has no object `{name}`; it has {}", available.join(", "))]
    NoObject {
        /// The name.
        name: String,
        /// Those that there are.
        available: Vec<String>,
    },
}

/// Looks at an idea.
///
/// # Errors
/// [`WhyNotError`] when the problem cannot be built, or the idea is none for it.
pub fn why_not<M: TaskRobot>(registry: &Registry<M>, request: &WhyNotRequest) -> Result<WhyNot, WhyNotError> {
    let file = &request.problem;
    let (robot, arm) = M::build(&file.robot).map_err(PlanningError::from)?;
    let facts = M::facts(&file.robot).map_err(PlanningError::from)?;
    let slides = |name: &str| {
        facts.description.joints.iter().any(|joint| *joint.name == *name && joint.kind == JointKind::Sliding)
    };
    let joints: Vec<_> = facts.all_arm_joints().into_iter().map(|name| (name.to_owned(), slides(name))).collect();
    let Built { world, start, goal, scene, .. } = world::build_with(registry, file, robot, arm)?;
    let cancel = &Cancel::new();
    let look = Look { m: &world, start: &start, goal: &goal, is_quick: true, cancel };
    let asked = Asked { look, scene: &scene, joints: &joints };
    let (fault, variant) = match &request.idea {
        Idea::State { base, joints } => {
            let arm = match joints {
                Some(joints) => {
                    let expected = start.robot.arm.as_ref().len();
                    let values = M::Joints::from_values(joints).filter(|values| values.as_ref().len() == expected);
                    values.ok_or(WhyNotError::Joints { found: joints.len(), expected })?
                }
                None => start.robot.arm,
            };
            asked.state(Configuration { base: base.unwrap_or(start.robot.base), arm })
        }
        Idea::Hand { world_from_tool, takes: None } => asked.hand(world_from_tool),
        Idea::Hand { world_from_tool, takes: Some(name) } => {
            let index = world.movables().iter().position(|movable| *movable.body.name == **name);
            let available = || world.movables().iter().map(|movable| movable.body.name.to_string()).collect();
            let index = index.ok_or_else(|| WhyNotError::NoObject { name: name.clone(), available: available() })?;
            asked.grasp(world_from_tool, ObjectId::new(index))
        }
    };
    Ok(WhyNot { problem: file.name.clone(), fault, variant })
}

/// What is asked about, and in which words.
struct Asked<'a, M: Manipulator> {
    look: Look<'a, M>,
    scene: &'a Scene,
    /// The joints of the arms by name; do they slide?
    joints: &'a [(String, bool)],
}

impl<M: Manipulator> Asked<'_, M> {
    fn m(&self) -> &Tabletop<M> {
        self.look.m
    }

    fn state(&self, q: Configuration<M::Joints>) -> (Option<Fault>, Option<Variant>) {
        let as_it_is = |near: &Configuration<M::Joints>| self.of_state(&q, near);
        match self.state_fault(&q) {
            None => (None, Some(as_it_is(&q))),
            fault => (fault, self.nearest_state(&q).as_ref().map(as_it_is)),
        }
    }

    /// The first thing wrong with a state, the others being as the problem starts.
    fn state_fault(&self, q: &Configuration<M::Joints>) -> Option<Fault> {
        let (m, robot) = (self.m(), self.m().manipulator());
        if let Some((joint, value)) = m.robot().first_outside(&q.arm) {
            let limit = m.robot().limits().get(joint);
            let by = limit.map(|limit| (limit.lower - value).max(value - limit.upper));
            let (name, slides) = self.joints.get(joint).cloned().unwrap_or_default();
            return Some(Fault { wrong: Wrong::Limit, names: vec![name], by, is_angle: !slides, bases: 0 });
        }
        if !m.robot().base().contains(&q.base) {
            let space = m.robot().base().position();
            let beyond = |axis: usize| {
                let (low, high) = (space.lower().get(axis), space.upper().get(axis));
                let value = q.base.get(axis).copied().unwrap_or_default();
                low.map_or(0.0, |low| low - value).max(high.map_or(0.0, |high| value - high))
            };
            let by = Some(beyond(0).max(beyond(1))).filter(|by| by.is_finite() && *by > 0.0);
            return Some(Fault { wrong: Wrong::Bounds, names: vec![BOUNDS.to_owned()], by, is_angle: false, bases: 0 });
        }
        if let Err(blame) = m.collision_scene().check_base(robot, q) {
            return Some(self.met(Wrong::Base, &blame, q, self.look.start));
        }
        let state = TabletopState::<M> { robot: *q, ..self.look.start.clone() };
        let found = m.collision_scene().check(robot, &state, &Contacts::default());
        found.err().map(|blame| self.met(Wrong::Robot, &blame, q, &state))
    }

    /// Two bodies that meet, and how far one reaches into the other, or into its margin.
    fn met(&self, wrong: Wrong, blame: &Blame, q: &Configuration<M::Joints>, state: &TabletopState<M>) -> Fault {
        let mut links = vec![Isometry3::identity(); self.m().manipulator().links().len()];
        self.m().manipulator().link_poses(q, state.mode.gap_m(), &mut links);
        self.overlap(wrong, blame, &links, state)
    }

    fn overlap(&self, wrong: Wrong, blame: &Blame, links: &[Isometry3<f64>], state: &TabletopState<M>) -> Fault {
        let find = |name: &str| self.body(name, links, state);
        let by = find(&blame.first).zip(find(&blame.second)).and_then(|((a, at_a), (b, at_b))| {
            let found = clearance::between(a, &at_a, b, &at_b).ok()?;
            // What keeps apart is too near: by how much depends on the pair, so only an overlap has a number.
            Some(-found.distance).filter(|depth| *depth > 0.0)
        });
        let names = [&blame.first, &blame.second].map(ToString::to_string).to_vec();
        Fault { wrong, names, by, is_angle: false, bases: 0 }
    }

    /// A body by its name, and where it is.
    fn body(&self, name: &str, links: &[Isometry3<f64>], state: &TabletopState<M>) -> Option<(&Body, Isometry3<f64>)> {
        let m = self.m();
        let link = m.manipulator().links().iter().zip(links).find(|(link, _)| *link.body.name == *name);
        let object = || m.movables().iter().zip(&state.objects).find(|(movable, _)| *movable.body.name == *name);
        let fixed = || self.scene.bodies().iter().find(|fixed| *fixed.body.name == *name);
        link.map(|(link, pose)| (&link.body, *pose))
            .or_else(|| object().map(|(movable, pose)| (&movable.body, *pose)))
            .or_else(|| fixed().map(|fixed| (&fixed.body, fixed.world_from_body)))
    }

    /// The nearest state found in which nothing is wrong: drawn farther and farther away, then brought back as far as it goes.
    fn nearest_state(&self, q: &Configuration<M::Joints>) -> Option<Configuration<M::Joints>> {
        let drives = self.m().settings().drives.contains(&true);
        for (round, spread) in (0..).zip(SPREADS) {
            let mut best: Option<(f64, Configuration<M::Joints>)> = None;
            for draw in 0..DRAWS {
                let rng = &mut stream(0, round, draw, Purpose::Attempt);
                let mut drawn = *q;
                let mut shift = |value: &mut f64| *value += spread * rng.random_range(-1.0..1.0);
                // The base alone, the arm alone, both.
                if draw % 3 != 1 && drives {
                    drawn.base.iter_mut().for_each(&mut shift);
                }
                if draw % 3 != 0 || !drives {
                    drawn.arm.as_mut().iter_mut().for_each(&mut shift);
                }
                self.within_limits(&mut drawn);
                if self.state_fault(&drawn).is_none() {
                    let near = self.back_towards(q, &drawn);
                    let far = self.of_state(q, &near);
                    let cost = far.away_m + METRES_PER_RADIAN * (far.turned_rad + far.joint_most);
                    if best.as_ref().is_none_or(|(known, _)| cost < *known) {
                        best = Some((cost, near));
                    }
                }
            }
            if best.is_some() {
                return best.map(|(_, near)| near);
            }
        }
        None
    }

    fn within_limits(&self, q: &mut Configuration<M::Joints>) {
        for (value, limit) in q.arm.as_mut().iter_mut().zip(self.m().robot().limits()) {
            if limit.lower.is_finite() && limit.upper.is_finite() {
                *value = value.clamp(limit.lower, limit.upper);
            }
        }
    }

    /// As near to `q` on the straight way from `far` as nothing is wrong all the while.
    fn back_towards(&self, q: &Configuration<M::Joints>, far: &Configuration<M::Joints>) -> Configuration<M::Joints> {
        let at = |share: f64| {
            let mut out = *far;
            let pairs = out.base.iter_mut().zip(&q.base).chain(out.arm.as_mut().iter_mut().zip(q.arm.as_ref()));
            pairs.for_each(|(value, wanted)| *value = wanted + share * (*value - wanted));
            self.within_limits(&mut out);
            out
        };
        let (mut wrong, mut right) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(wrong, right);
            if self.state_fault(&at(middle)).is_none() { right = middle } else { wrong = middle }
        }
        at(right)
    }

    fn of_state(&self, wanted: &Configuration<M::Joints>, q: &Configuration<M::Joints>) -> Variant {
        let [dx, dy, turn] = [0, 1, 2].map(|i| q.base.get(i).zip(wanted.base.get(i)).map_or(0.0, |(a, b)| a - b));
        let joints = q.arm.as_ref().iter().zip(wanted.arm.as_ref());
        let joint_most = joints.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        Variant { away_m: dx.hypot(dy), turned_rad: turn.abs(), joint_most, ..self.variant(q) }
    }

    fn variant(&self, q: &Configuration<M::Joints>) -> Variant {
        let tool = self.m().manipulator().world_from_tool(q);
        let (roll, pitch, yaw) = tool.rotation.euler_angles();
        let [x, y, z] = tool.translation.vector.into();
        Variant {
            base: q.base,
            joints: q.arm.as_ref().to_vec(),
            tool: [x, y, z, roll, pitch, yaw],
            away_m: 0.0,
            turned_rad: 0.0,
            joint_most: 0.0,
        }
    }
}
