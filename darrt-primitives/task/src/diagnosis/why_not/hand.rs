//! A place of the hand, alone or to take something.

use std::cmp::Ordering;

use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_primitives::action::stance::Probe;
use darrt_primitives::grasp::{Grasp, GraspFamily};
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator};
use darrt_primitives::mode::Contacts;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::{Asked, BISECTIONS, Fault, METRES_PER_RADIAN, Variant, Wrong};
use crate::diagnosis::cause::Stage;
use crate::diagnosis::hands::Case;

/// Bases that are tried for a place of the hand, where the robot drives, and of the arm for each.
const BASES: u64 = 96;
const ARMS: usize = 4;
/// How far away variants of a place of the hand are looked for: metres, radians about the vertical.
const SHIFTS_M: [f64; 12] = [0.01, 0.02, 0.03, 0.05, 0.08, 0.12, 0.18, 0.25, 0.35, 0.5, 0.7, 1.0];
const TURNS_RAD: [f64; 6] = [0.0, 0.2, -0.2, 0.5, -0.5, 1.0];
/// A place of the hand is that of a grasp to within,
const SAME_M: f64 = 0.005;
const SAME_RAD: f64 = 0.035;
/// Grasps of each family that are looked at besides an even selection, and of those that are near so many with an arm.
const GRASPS: u64 = 400;
const NEAR_GRASPS: usize = 60;

impl<M: Manipulator> Asked<'_, M> {
    /// The hand alone, anywhere.
    pub(super) fn hand(&self, tool: &Isometry3<f64>) -> (Option<Fault>, Option<Variant>) {
        match self.reached(tool) {
            Ok(q) => (None, Some(self.of_hand(tool, &q))),
            Err(fault) => {
                let nearest = self.nearest_hand(tool);
                (Some(fault), nearest.map(|q| self.of_hand(tool, &q)))
            }
        }
    }

    fn of_hand(&self, wanted: &Isometry3<f64>, q: &Configuration<M::Joints>) -> Variant {
        let tool = self.m().manipulator().world_from_tool(q);
        let (away_m, turned_rad) = apart(wanted, &tool);
        Variant { away_m, turned_rad, ..self.variant(q) }
    }

    /// A state with a hand there in which nothing is wrong; else what is wrong with the one of the first hand that came farthest.
    fn reached(&self, tool: &Isometry3<f64>) -> Result<Configuration<M::Joints>, Fault> {
        let first = self.reached_with(0, tool);
        let mut others = 1..self.m().manipulator().hands();
        first.or_else(|fault| others.find_map(|hand| self.reached_with(hand, tool).ok()).ok_or(fault))
    }

    /// The same for one of the hands.
    fn reached_with(&self, hand: usize, tool: &Isometry3<f64>) -> Result<Configuration<M::Joints>, Fault> {
        let m = self.m();
        let mut start = self.look.start.clone();
        start.robot.arm = start.robot.arm.with_hand_at_work(hand);
        let start = &start;
        let (robot, none) = (m.manipulator(), Contacts::default());
        let probe = Probe::new(m, start, start.mode.clone());
        probe.check_hand(tool, &none).map_err(|blame| {
            // The links of the hand where it would be.
            let mut links = vec![Isometry3::identity(); robot.links().len()];
            robot.link_poses(&start.robot, start.mode.gap_m(), &mut links);
            let moved = tool * robot.world_from_tool(&start.robot).inverse();
            for pose in &mut links {
                *pose = moved * *pose;
            }
            self.overlap(Wrong::Hand, &blame, &links, start)
        })?;
        let bases = if m.settings().drives.contains(&true) { BASES } else { 1 };
        let mut farthest = Fault { wrong: Wrong::Reach, names: Vec::new(), by: None, is_angle: false, bases };
        let rank = |fault: &Fault| match fault.wrong {
            Wrong::Reach => 0,
            Wrong::Bounds => 1,
            Wrong::Base => 2,
            _ => 3,
        };
        for draw in 0..bases {
            let rng = &mut stream(0, 7, draw, Purpose::Attempt);
            let base = if bases > 1 { robot.base_for_hand(hand, tool, rng) } else { start.robot.base };
            if !robot.may_reach_with(hand, &base, tool) {
                continue;
            }
            for _ in 0..ARMS {
                let Some(arm) = robot.inverse_from(&start.robot.arm, &base, tool, rng) else { break };
                let q = Configuration { base, arm };
                match self.state_fault(&q) {
                    None => return Ok(q),
                    Some(fault) if rank(&fault) > rank(&farthest) => farthest = Fault { bases, ..fault },
                    Some(_) => {}
                }
            }
        }
        Err(farthest)
    }

    /// The nearest place of the hand found in which nothing is wrong: farther and farther away to all sides.
    fn nearest_hand(&self, tool: &Isometry3<f64>) -> Option<Configuration<M::Joints>> {
        let mut variants: Vec<(f64, Isometry3<f64>)> = Vec::new();
        for turn in TURNS_RAD {
            let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn) * tool.rotation;
            for shift in std::iter::once(0.0).chain(SHIFTS_M) {
                for side in SIDES.iter().take(if shift > 0.0 { SIDES.len() } else { 1 }) {
                    let way = Vector3::from(*side).normalize() * shift;
                    let pose = Isometry3::from_parts(Translation3::from(tool.translation.vector + way), turned);
                    variants.push((shift + METRES_PER_RADIAN * turn.abs(), pose));
                }
            }
        }
        // The sort is stable: of equally near ones the first stays the first.
        variants.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal));
        let (pose, found) = variants.iter().skip(1).find_map(|(_, pose)| Some((*pose, self.reached(pose).ok()?)))?;
        // Back towards what was asked about, as far as it is right.
        let mut best = found;
        let (mut wrong, mut right) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(wrong, right);
            match self.reached(&tool.lerp_slerp(&pose, middle)) {
                Ok(q) => (best, right) = (q, middle),
                Err(_) => wrong = middle,
            }
        }
        Some(best)
    }

    /// The hand where it is to take an object that stands where the problem starts.
    pub(super) fn grasp(&self, tool: &Isometry3<f64>, id: ObjectId) -> (Option<Fault>, Option<Variant>) {
        let start = self.look.start;
        let (Some(movable), Some(pose)) = (self.m().movable(id), start.object(id)) else { return (None, None) };
        let object_from_tool = pose.inv_mul(tool);
        // All grasps that hold, the nearest first.
        let mut grasps: Vec<(f64, Grasp, &dyn GraspFamily)> = Vec::new();
        for (index, family) in (0..).zip(&movable.grasps) {
            let drawn = (0..GRASPS).map(|draw| family.sample(&mut stream(0, index, draw, Purpose::Goal)));
            for mut grasp in family.grid().into_iter().chain(drawn) {
                grasp.open_gap_m = grasp.open_gap_m.min(self.m().manipulator().hand().max_gap_m());
                if self.m().hold(0, movable, &**family, &grasp).is_ok() {
                    let (away_m, turned_rad) = apart(&object_from_tool, &grasp.object_from_tool);
                    grasps.push((away_m + METRES_PER_RADIAN * turned_rad, grasp, &**family));
                }
            }
        }
        grasps.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal));
        let name = || vec![movable.body.name.to_string()];
        let Some((_, nearest, family)) = grasps.first() else {
            let stage = Wrong::Pick(Stage::Hold);
            return (Some(Fault { wrong: stage, names: name(), by: None, is_angle: false, bases: 0 }), None);
        };
        let (away_m, turned_rad) = apart(&object_from_tool, &nearest.object_from_tool);
        let try_grasp = |grasp: &Grasp, family: &dyn GraspFamily| {
            self.look.takes(start, id, &Case { grasp: *grasp, family, pose: *pose })
        };
        let fault = if away_m > SAME_M || turned_rad > SAME_RAD {
            let is_angle = away_m <= SAME_M;
            let by = Some(if is_angle { turned_rad } else { away_m });
            Some(Fault { wrong: Wrong::Grasp, names: name(), by, is_angle, bases: 0 })
        } else {
            try_grasp(nearest, *family).err().map(|(stage, body, bases)| {
                let names = name().into_iter().chain(body).collect();
                Fault { wrong: Wrong::Pick(stage), names, by: None, is_angle: false, bases }
            })
        };
        let right = grasps.iter().take(NEAR_GRASPS).chain(grasps.iter().skip(NEAR_GRASPS).step_by(8)).find_map(
            |(_, grasp, family)| {
                let q = try_grasp(grasp, *family).ok()?;
                Some(self.of_hand(tool, &q))
            },
        );
        (fault, right)
    }
}

/// How far apart two poses are: metres, radians.
fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    ((a.translation.vector - b.translation.vector).norm(), a.rotation.angle_to(&b.rotation))
}

/// Up, down, level to eight sides, and between.
const SIDES: [[f64; 3]; 18] = [
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, -1.0],
];
