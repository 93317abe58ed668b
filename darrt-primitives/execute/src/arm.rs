//! The arm as a map from its joints to its hand: what small errors of base and joints do to it, and which small change of the
//! joints puts it elsewhere.

use darrt_primitives::kinematics::jacobian::KinematicChain;
use darrt_primitives::manipulator::world_from_base;
use darrt_task::robot::RobotFacts;
use nalgebra::{DMatrix, Isometry3, Matrix6, Point3, Vector6};

use crate::error::ExecuteError;
use crate::robot::Robot;

/// A hand this near to where it should be is there, metres and radians.
const REACHED: (f64, f64) = (1e-4, 1e-3);
/// Newton steps until then at most: a correction is small, four are usual.
const MOST_STEPS: u32 = 20;
/// Damping of the steps, metres per radian: keeps them small where the arm is stretched.
const DAMPING: f64 = 0.01;

/// What is computed from one place of the robot to the next.
#[derive(Debug)]
pub(crate) struct Arm {
    chain: KinematicChain,
    /// By joint of the arm: its column in the Jacobian of the chain.
    columns: Vec<usize>,
}

impl Arm {
    pub(crate) fn new(robot: &Robot, facts: &RobotFacts) -> Result<Self, ExecuteError> {
        let missing = |what, name: &str| ExecuteError::NoSuchPart { what, name: name.to_owned() };
        let root = robot.tree.link_names().first().map_or("", |name| name.as_ref());
        let chain = KinematicChain::new(&robot.tree, root, &facts.tool_link);
        let chain = chain.map_err(|_| missing("link", &facts.tool_link))?;
        let column = |variable: &usize| chain.variables().iter().position(|own| own == variable);
        let names = robot.arm.iter().zip(&facts.arm_joints);
        let columns = names.map(|(variable, name)| column(variable).ok_or_else(|| missing("joint", name)));
        let columns = columns.collect::<Result<_, _>>()?;
        Ok(Self { chain, columns })
    }

    /// Where the tool frame is.
    pub(crate) fn world_from_tool(robot: &Robot, base: [f64; 3], joints: &[f64]) -> Isometry3<f64> {
        let mut links = Vec::new();
        robot.link_poses(&world_from_base(&base), joints, &mut links);
        links.get(robot.tool).copied().unwrap_or_else(Isometry3::identity)
    }

    /// By joint of the arm: how fast a point of the hand moves and the hand turns, in the world frame.
    fn jacobian(&self, robot: &Robot, links: &[Isometry3<f64>], point: &Point3<f64>) -> Vec<Vector6<f64>> {
        let mut all = vec![Vector6::zeros(); self.chain.variables().len()];
        let tool_from_world = links.get(robot.tool).map(Isometry3::inverse).unwrap_or_default();
        // The lengths are the tree's own.
        let written = self.chain.jacobian(&robot.tree, links, &(tool_from_world * point), &mut all);
        debug_assert!(written.is_ok(), "{written:?}");
        self.columns.iter().filter_map(|column| all.get(*column).copied()).collect()
    }

    /// What small errors of the base (x, y, yaw) and of the joints of the arm make of a point of the hand: rows are x, y (m) and
    /// yaw (rad).
    ///
    /// # Source
    /// The base as a rigid body in the plane; the joints by the geometric Jacobian (see [`KinematicChain::jacobian`]).
    pub(crate) fn error_of_hand(
        &self,
        robot: &Robot,
        base: [f64; 3],
        joints: &[f64],
        point: &Point3<f64>,
    ) -> DMatrix<f64> {
        let mut links = Vec::new();
        robot.link_poses(&world_from_base(&base), joints, &mut links);
        let columns = self.jacobian(robot, &links, point);
        let mut rows = DMatrix::zeros(3, 3 + columns.len());
        rows.view_mut((0, 0), (3, 3)).fill_with_identity();
        rows[(0, 2)] = -(point.y - base[1]);
        rows[(1, 2)] = point.x - base[0];
        for (index, column) in columns.iter().enumerate() {
            rows[(0, 3 + index)] = column[0];
            rows[(1, 3 + index)] = column[1];
            rows[(2, 3 + index)] = column[5];
        }
        rows
    }

    /// The joints of the arm added to `joints` so that the tool is at `target`, beginning with `offset`; `None` if no such joints
    /// are found near, within the limits.
    ///
    /// # Source
    /// Damped least squares: Nakamura and Hanafusa, *Inverse kinematic solutions with singularity robustness for robot
    /// manipulator control* (1986).
    pub(crate) fn reach(
        &self,
        robot: &Robot,
        base: [f64; 3],
        joints: &[f64],
        target: &Isometry3<f64>,
        offset: &[f64],
    ) -> Option<Vec<f64>> {
        let (mut links, mut offset, root) = (Vec::new(), offset.to_vec(), world_from_base(&base));
        let mut now = joints.to_vec();
        for _ in 0..MOST_STEPS {
            for ((variable, offset), joints) in
                robot.arm.iter().zip(&mut offset).zip(robot.arm.iter().map(|v| joints.get(*v)))
            {
                let limit = robot.tree.variables().get(*variable)?.limit;
                let wanted = limit.clamp(joints? + *offset);
                *offset = wanted - joints?;
                *now.get_mut(*variable)? = wanted;
            }
            robot.link_poses(&root, &now, &mut links);
            let tool = links.get(robot.tool)?;
            let away = target.translation.vector - tool.translation.vector;
            let turn = (target.rotation * tool.rotation.inverse()).scaled_axis();
            if away.norm() <= REACHED.0 && turn.norm() <= REACHED.1 {
                return Some(offset);
            }
            let columns = self.jacobian(robot, &links, &tool.translation.vector.into());
            let error = Vector6::new(away.x, away.y, away.z, turn.x, turn.y, turn.z);
            let square =
                columns.iter().fold(Matrix6::identity() * (DAMPING * DAMPING), |sum, j| sum + j * j.transpose());
            let weighted = square.cholesky()?.solve(&error);
            offset.iter_mut().zip(&columns).for_each(|(offset, column)| *offset += column.dot(&weighted));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]

    use darrt_task::file_robot::FileRobot;
    use darrt_task::problem_file::Robot as RobotSettings;
    use darrt_task::robot::TaskRobot as _;
    use nalgebra::{DVector, Translation3, UnitQuaternion, Vector3};

    use super::*;

    const BASE: [f64; 3] = [0.3, -0.2, 0.7];

    fn arm() -> (Robot, Arm, Vec<f64>) {
        let settings: RobotSettings = toml::from_str("model = \"panda-arm\"\nbase = [0.0, 0.0, 0.0]").unwrap();
        let facts = FileRobot::facts(&settings).unwrap();
        let robot = Robot::new(&facts).unwrap();
        let arm = Arm::new(&robot, &facts).unwrap();
        let mut joints = robot.tree.neutral();
        for (variable, value) in robot.arm.iter().zip([0.2, 0.4, -0.3, -1.6, 0.3, 1.9, 0.5]) {
            joints[*variable] = value;
        }
        (robot, arm, joints)
    }

    #[test]
    fn small_errors_move_the_hand_as_the_matrix_says() {
        let (robot, arm, joints) = arm();
        let tool = Arm::world_from_tool(&robot, BASE, &joints);
        let point = Point3::from(tool.translation.vector);
        let matrix = arm.error_of_hand(&robot, BASE, &joints, &point);
        let step = 1e-6;
        for column in 0..matrix.ncols() {
            let (mut base, mut moved) = (BASE, joints.clone());
            match column.checked_sub(3) {
                None => base[column] += step,
                Some(joint) => moved[robot.arm[joint]] += step,
            }
            let now = Arm::world_from_tool(&robot, base, &moved);
            let way = (now.translation.vector - tool.translation.vector) / step;
            let turn = (now.rotation * tool.rotation.inverse()).scaled_axis() / step;
            let wanted = DVector::from_vec(vec![way.x, way.y, turn.z]);
            assert!((matrix.column(column) - wanted).norm() < 1e-4, "column {column}");
        }
    }

    #[test]
    fn a_hand_is_put_elsewhere_and_refuses_what_is_out_of_reach() {
        let (robot, arm, joints) = arm();
        let tool = Arm::world_from_tool(&robot, BASE, &joints);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.05);
        let target = Translation3::new(0.02, -0.03, 0.0) * tool;
        let target = Isometry3::from_parts(target.translation, turn * tool.rotation);
        let rest = vec![0.0; robot.arm.len()];
        let offset = arm.reach(&robot, BASE, &joints, &target, &rest).unwrap();
        let mut moved = joints.clone();
        robot.arm.iter().zip(&offset).for_each(|(variable, by)| moved[*variable] += by);
        let there = Arm::world_from_tool(&robot, BASE, &moved);
        assert!((there.translation.vector - target.translation.vector).norm() <= REACHED.0);
        assert!(there.rotation.angle_to(&target.rotation) <= REACHED.1);
        assert!(offset.iter().all(|by| by.abs() < 0.2), "{offset:?}");
        let far = Translation3::new(2.0, 0.0, 0.0) * tool;
        assert!(arm.reach(&robot, BASE, &joints, &far, &rest).is_none());
    }
}
