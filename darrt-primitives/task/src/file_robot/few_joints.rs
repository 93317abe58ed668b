//! An arm of fewer joints than six comes to few of the poses that are drawn for its hand: where its base must stand for one, and how
//! what is round is to be turned.
//!
//! The base is three joints more: a bearing, a distance, and a turn, from a vertical axis to the base. With all of them free the
//! chain brings the hand to a pose from some place of the base; with the bearing alone free, the hand to a pose that is turned
//! about that axis.

use std::f64::consts::TAU;

use darrt_core::random::{Purpose, stream};
use darrt_core::space::so2::wrap;
use darrt_primitives::action::turned::turned_about;
use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::urdf::{JointDescription, JointKind, LinkDescription};
use darrt_primitives::kinematics::{
    ChainInverse, InverseOptions, JointLimit, KinematicTree, KinematicsError, RobotDescription,
};
use darrt_primitives::manipulator::{JointVector as _, world_from_base};
use nalgebra::{Isometry3, Point2, Translation3, Unit, Vector3};
use rand::{Rng, RngExt};

use super::chain::ArmChain;
use crate::robot_file::amend::ANY_POSE;

/// Configurations that are kept to begin from.
const SEEN: usize = 4096;
/// How many of them are looked at for one descent, and how many descents are tried.
const WINDOW: usize = 128;
const TRIES: usize = 4;
/// What a radian of the hand counts, metres: it is about so long.
const HAND_M: f64 = 0.2;

/// A configuration of the arm, and its tool in the frame of the base.
#[derive(Debug, Clone, Copy)]
struct Seen {
    arm: Joints,
    base_from_tool: Isometry3<f64>,
}

/// Base and arm as one chain.
#[derive(Debug, Clone)]
pub(super) struct FewJoints {
    solver: ChainInverse,
    seen: Vec<Seen>,
}

impl FewJoints {
    /// `None` for an arm that needs none of it.
    ///
    /// # Errors
    /// As [`ChainInverse::new`].
    pub(super) fn new(chain: &ArmChain, limits: &[JointLimit]) -> Result<Option<Self>, KinematicsError> {
        if limits.len() >= ANY_POSE {
            return Ok(None);
        }
        let description = description(chain, limits);
        let lost = || KinematicsError::UnknownLink { name: TOOL.to_owned() };
        let tree = KinematicTree::new(&description).map_err(|_| lost())?;
        let options = InverseOptions { soft_limits: false, exact: true, ..InverseOptions::default() };
        let solver = ChainInverse::new(&tree, GROUND, TOOL, &Isometry3::identity(), options)?;
        let mut rng = stream(0, 7, 0, Purpose::Extend);
        let mut seen = Vec::with_capacity(SEEN);
        for _ in 0..SEEN {
            let values = limits.iter().map(|limit| {
                let [low, high] = finite(limit);
                rng.random_range(low..=high)
            });
            let Some(arm) = Joints::from_values(&values.collect::<Vec<_>>()) else { break };
            seen.push(Seen { arm, base_from_tool: chain.world_from_tool(&[0.0; 3], arm.as_ref()) });
        }
        Ok(Some(Self { solver, seen }))
    }

    /// A base from which the arm brings the tool to `world_from_tool`, drawn at random.
    pub(super) fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<[f64; 3]> {
        let at = world_from_tool.translation;
        let above_axis = Isometry3::from_parts(Translation3::new(0.0, 0.0, at.z), world_from_tool.rotation);
        let values = self.solver.inverse(&above_axis, rng)?;
        let [bearing, out_m, turn, ..] = values[..] else { return None };
        Some([at.x + out_m * bearing.cos(), at.y + out_m * bearing.sin(), wrap(bearing + turn)])
    }

    /// `world_from_tool`, turned about its own vertical so that the arm reaches it.
    pub(super) fn turned(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
    ) -> Option<Isometry3<f64>> {
        let centre = Point2::from(world_from_tool.translation.vector.xy());
        Some(turned_about(world_from_tool, &centre, self.turn(base, world_from_tool, &centre, rng)?))
    }

    /// See [`Manipulator::turn_to_reach`](darrt_primitives::manipulator::Manipulator::turn_to_reach).
    pub(super) fn turn(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        centre: &Point2<f64>,
        rng: &mut dyn Rng,
    ) -> Option<f64> {
        let [x, y, yaw] = [base[0] - centre.x, base[1] - centre.y, base[2]];
        let (bearing, out_m) = (y.atan2(x), x.hypot(y));
        let turn = wrap(yaw - bearing);
        let mut limits: Vec<_> = self.solver.limits().to_vec();
        for (limit, value) in limits.iter_mut().skip(1).zip([out_m, turn]) {
            *limit = JointLimit::new(value, value);
        }
        let wanted = Translation3::new(-centre.x, -centre.y, 0.0) * world_from_tool;
        let axis_from_base = world_from_base(&[x, y, yaw]);
        let first = rng.random_range(0..self.seen.len().max(1));
        (0..TRIES).find_map(|attempt| {
            let window = self.seen.iter().cycle().skip(first + attempt * WINDOW).take(WINDOW);
            let aligned = window.map(|seen| {
                let tool = axis_from_base * seen.base_from_tool;
                let turn = turn_onto(&tool, &wanted);
                (seen, turn, apart_m(&turned_about(&tool, &Point2::origin(), turn), &wanted))
            });
            let (seen, ahead, _) = aligned.min_by(|a, b| a.2.total_cmp(&b.2))?;
            let start: Vec<_> =
                [bearing + ahead, out_m, turn].into_iter().chain(seen.arm.as_ref().iter().copied()).collect();
            let values = self.solver.inverse_from(&wanted, &start, &limits)?;
            // The chain has turned the base the other way round the axis.
            Some(wrap(bearing - values.first()?))
        })
    }
}

/// The turn about the z axis that brings `pose` nearest to `wanted`: in place, and in the axes of the hand.
fn turn_onto(pose: &Isometry3<f64>, wanted: &Isometry3<f64>) -> f64 {
    let flat = |pose: &Isometry3<f64>| {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| (HAND_M * (pose.rotation * axis)).xy());
        [pose.translation.vector.xy(), axes[0], axes[1], axes[2]]
    };
    let pairs = || flat(pose).into_iter().zip(flat(wanted));
    let cross: f64 = pairs().map(|(from, to)| from.perp(&to)).sum();
    let dot: f64 = pairs().map(|(from, to)| from.dot(&to)).sum();
    cross.atan2(dot)
}

fn apart_m(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + HAND_M * a.rotation.angle_to(&b.rotation)
}

fn finite(limit: &JointLimit) -> [f64; 2] {
    if limit.is_unlimited() { [-TAU / 2.0, TAU / 2.0] } else { [limit.lower, limit.upper] }
}

/// The links at the ends of the chain.
const GROUND: &str = "ground";
const TOOL: &str = "tool";

/// A joint of the chain.
struct Piece {
    kind: JointKind,
    at: Isometry3<f64>,
    axis: Unit<Vector3<f64>>,
    limit: JointLimit,
}

/// A description of base and arm as one chain.
fn description(chain: &ArmChain, limits: &[JointLimit]) -> RobotDescription {
    // As far as the tool may be from the base.
    let slides = chain.joints.iter().zip(limits).filter(|(joint, _)| joint.slides);
    let slides_m: f64 = slides.map(|(_, limit)| limit.lower.abs().max(limit.upper.abs())).sum();
    let bones_m: f64 = chain.joints.iter().map(|joint| joint.before.translation.vector.norm()).sum();
    let out = JointLimit::new(0.0, bones_m + slides_m + chain.wrist_from_tool.translation.vector.norm());
    let piece = |kind, at, axis, limit| Piece { kind, at, axis, limit };
    let turn = || piece(JointKind::Turning, Isometry3::identity(), Vector3::z_axis(), JointLimit::UNLIMITED);
    let base = [turn(), piece(JointKind::Sliding, Isometry3::identity(), Vector3::x_axis(), out), turn()];
    let arm = chain.joints.iter().zip(limits).map(|(joint, limit)| {
        let kind = if joint.slides { JointKind::Sliding } else { JointKind::Turning };
        piece(kind, joint.before, joint.axis, *limit)
    });
    let tool = piece(JointKind::Fixed, chain.wrist_from_tool, Vector3::z_axis(), JointLimit::UNLIMITED);
    let link = |name: &str| LinkDescription { name: name.into(), collision: Vec::new(), has_visual: false };
    let mut description =
        RobotDescription { name: String::new(), links: vec![link(GROUND)], joints: Vec::new(), root: 0 };
    for (index, Piece { kind, at, axis, limit }) in base.into_iter().chain(arm).chain([tool]).enumerate() {
        let is_tool = kind == JointKind::Fixed;
        description.links.push(link(&if is_tool { TOOL.to_owned() } else { format!("link {index}") }));
        description.joints.push(JointDescription {
            name: format!("joint {index}").into(),
            kind,
            parent: index,
            child: index + 1,
            parent_from_child: at,
            axis,
            limit,
            soft_limit: limit,
            max_velocity: 0.0,
            max_effort: 0.0,
            mimic: None,
        });
    }
    description
}

#[cfg(test)]
mod tests {
    use super::super::FileRobot;
    use super::super::load::Loaded;
    use super::*;
    use crate::problem_file::Limits;
    use crate::robot_file::Source;
    use darrt_primitives::laws::{ManipulatorClaims, ReachClaims, check_manipulator, check_reaches};
    use darrt_primitives::manipulator::{Configuration, Manipulator as _};
    use rand::SeedableRng as _;
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn robots() -> [FileRobot; 3] {
        [
            (
                include_str!("../../tests/data/few-joints/scara.toml"),
                include_str!("../../tests/data/few-joints/scara.urdf"),
            ),
            (
                include_str!("../../tests/data/few-joints/desk-arm-5.toml"),
                include_str!("../../tests/data/few-joints/desk-arm-5.urdf"),
            ),
            (
                include_str!("../../tests/data/few-joints/desk-arm-4.toml"),
                include_str!("../../tests/data/few-joints/desk-arm-4.urdf"),
            ),
        ]
        .map(|(text, urdf)| {
            let loaded = Loaded::new(Source::from_text(text, "the robot").unwrap(), Some(urdf)).unwrap();
            loaded.robot(Limits::Soft, [0.3, -0.2, 0.7]).unwrap()
        })
    }

    /// Hand poses of random configurations, seen from elsewhere.
    fn poses(robot: &FileRobot, rng: &mut Xoshiro256PlusPlus) -> Vec<Isometry3<f64>> {
        let pose = |rng: &mut Xoshiro256PlusPlus| {
            let values: Vec<_> = robot.limits.iter().map(|limit| rng.random_range(limit.lower..limit.upper)).collect();
            let base = [rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0), rng.random_range(-3.0..3.0)];
            robot.world_from_tool(&Configuration { base, arm: Joints::from_values(&values).unwrap() })
        };
        (0..200).map(|_| pose(rng)).collect()
    }

    #[test]
    fn from_the_base_that_is_drawn_the_arm_comes_to_the_pose() {
        for robot in robots() {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
            let few = robot.first.few.as_ref().unwrap();
            let mut found = 0;
            for pose in poses(&robot, &mut rng) {
                let Some(base) = few.base_for(&pose, &mut rng) else { continue };
                assert!(robot.may_reach(&base, &pose));
                let Some(arm) = robot.inverse(&base, &pose, &mut rng) else { continue };
                let reached = robot.world_from_tool(&Configuration { base, arm });
                assert!((reached.translation.vector - pose.translation.vector).norm() < 1e-9);
                found += 1;
            }
            assert!(found >= 190, "{found} of 200");
        }
    }

    /// Among them those of ties and turns, which say little of an arm of six joints.
    #[test]
    fn they_keep_the_laws_of_robots() {
        for robot in robots() {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
            let mut drawn = || {
                let value = |limit: &JointLimit| rng.random_range(limit.lower..=limit.upper);
                let values: Vec<_> = robot.limits.iter().map(value).collect();
                Configuration { base: [0.3, -0.2, 0.7], arm: Joints::from_values(&values).unwrap() }
            };
            for seed in 0..4 {
                let (a, b) = (drawn(), drawn());
                check_manipulator(&robot, [&a, &b], [0.01, 0.03], seed, &ManipulatorClaims::default()).unwrap();
            }
            let all: Vec<_> = (0..40).map(|_| drawn()).collect();
            let claims = ReachClaims { inverse: 0.5, base: 0.2, turned: 0.9 };
            check_reaches(&robot, &all, 0, &claims).unwrap();
        }
    }

    #[test]
    fn what_is_turned_as_the_arm_wants_it_is_reached() {
        for robot in robots() {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
            let few = robot.first.few.as_ref().unwrap();
            let base = [0.3, -0.2, 0.7];
            let (mut found, mut as_drawn) = (0, 0);
            for _ in 0..200 {
                let values: Vec<_> =
                    robot.limits.iter().map(|limit| rng.random_range(limit.lower..limit.upper)).collect();
                let pose = robot.world_from_tool(&Configuration { base, arm: Joints::from_values(&values).unwrap() });
                // What the hand holds is ahead of it, and was turned by chance.
                let ahead = pose * nalgebra::Point3::new(0.1, 0.0, 0.0);
                let centre = Point2::new(ahead.x, ahead.y);
                let about = |angle: f64| {
                    let middle = Translation3::new(centre.x, centre.y, 0.0);
                    middle * nalgebra::UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle) * middle.inverse()
                };
                let drawn = about(rng.random_range(-3.0..3.0)) * pose;
                as_drawn += u32::from(robot.inverse(&base, &drawn, &mut rng).is_some());
                let Some(turn) = few.turn(&base, &drawn, &centre, &mut rng) else { continue };
                found += u32::from(robot.inverse(&base, &(about(turn) * drawn), &mut rng).is_some());
            }
            assert!(found >= 190, "{found} of 200, {as_drawn} as they were drawn");
            println!("{found} of 200, {as_drawn} as they were drawn");
        }
    }
}
