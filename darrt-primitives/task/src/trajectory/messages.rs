//! Messages of ROS as data: the fields of `trajectory_msgs`, `moveit_msgs`, `control_msgs` and `geometry_msgs` by their names.

use serde::Serialize;

/// `builtin_interfaces/Duration`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Seconds {
    /// Whole seconds.
    pub sec: u32,
    /// Billionths of a second besides.
    pub nanosec: u32,
}

impl Seconds {
    /// So many seconds, to a billionth; negative ones and what is no number are none, and more than fit are the most that do.
    pub fn from_s(seconds: f64) -> Self {
        let nanos = (seconds.clamp(0.0, f64::from(u32::MAX)) * 1e9).round();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped; a NaN becomes zero")]
        let nanos = nanos as u64;
        let part = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
        Self { sec: part(nanos / 1_000_000_000), nanosec: part(nanos % 1_000_000_000) }
    }

    /// As one number.
    pub fn as_s(self) -> f64 {
        f64::from(self.sec) + f64::from(self.nanosec) * 1e-9
    }
}

/// `std_msgs/Header`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Header {
    /// When it is meant to begin; zero: when it is received.
    pub stamp: Seconds,
    /// In which frame poses are.
    pub frame_id: String,
}

impl Header {
    /// For something that begins when it is received.
    pub fn in_frame(frame: &str) -> Self {
        Self { stamp: Seconds { sec: 0, nanosec: 0 }, frame_id: frame.to_owned() }
    }
}

/// `trajectory_msgs/JointTrajectory`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointTrajectory {
    /// See [`Header`].
    pub header: Header,
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// In order of time.
    pub points: Vec<JointTrajectoryPoint>,
}

/// `trajectory_msgs/JointTrajectoryPoint`; values in the order of the joints' names, rad or m.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointTrajectoryPoint {
    /// Positions; those of joints that turn without end go on beyond a turn.
    pub positions: Vec<f64>,
    /// Velocities.
    pub velocities: Vec<f64>,
    /// Accelerations.
    pub accelerations: Vec<f64>,
    /// Efforts: never given.
    pub effort: Vec<f64>,
    /// Time from the start of the plan.
    pub time_from_start: Seconds,
}

/// `trajectory_msgs/MultiDOFJointTrajectory`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MultiDofJointTrajectory {
    /// See [`Header`].
    pub header: Header,
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// In order of time.
    pub points: Vec<MultiDofJointTrajectoryPoint>,
}

/// `trajectory_msgs/MultiDOFJointTrajectoryPoint`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MultiDofJointTrajectoryPoint {
    /// Poses, by joint.
    pub transforms: Vec<Transform>,
    /// Velocities in the frame of the header.
    pub velocities: Vec<Twist>,
    /// Accelerations in the frame of the header.
    pub accelerations: Vec<Twist>,
    /// Time from the start of the plan.
    pub time_from_start: Seconds,
}

/// `geometry_msgs/Vector3`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Vector {
    /// x.
    pub x: f64,
    /// y.
    pub y: f64,
    /// z.
    pub z: f64,
}

/// `geometry_msgs/Quaternion`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Turn {
    /// x.
    pub x: f64,
    /// y.
    pub y: f64,
    /// z.
    pub z: f64,
    /// w.
    pub w: f64,
}

/// `geometry_msgs/Transform`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Transform {
    /// Metres.
    pub translation: Vector,
    /// Of length 1.
    pub rotation: Turn,
}

impl Transform {
    /// At x, y on the floor, turned by yaw.
    pub fn on_floor([x, y, yaw]: &[f64; 3]) -> Self {
        let (sin, cos) = (yaw / 2.0).sin_cos();
        Self { translation: Vector { x: *x, y: *y, z: 0.0 }, rotation: Turn { x: 0.0, y: 0.0, z: sin, w: cos } }
    }
}

impl From<&nalgebra::Isometry3<f64>> for Transform {
    fn from(pose: &nalgebra::Isometry3<f64>) -> Self {
        let (t, q) = (pose.translation.vector, pose.rotation.quaternion());
        Self { translation: Vector { x: t.x, y: t.y, z: t.z }, rotation: Turn { x: q.i, y: q.j, z: q.k, w: q.w } }
    }
}

/// `geometry_msgs/Twist`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Twist {
    /// m/s, or m/s^2.
    pub linear: Vector,
    /// rad/s, or rad/s^2.
    pub angular: Vector,
}

impl Twist {
    /// Along x and y, and about z.
    pub fn on_floor([x, y, turn]: [f64; 3]) -> Self {
        Self { linear: Vector { x, y, z: 0.0 }, angular: Vector { x: 0.0, y: 0.0, z: turn } }
    }
}

/// `moveit_msgs/RobotTrajectory`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotTrajectory {
    /// Joints of one degree of freedom.
    pub joint_trajectory: JointTrajectory,
    /// Joints of several.
    pub multi_dof_joint_trajectory: MultiDofJointTrajectory,
}

/// `control_msgs/GripperCommand`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GripperCommand {
    /// Gap between the pads, metres.
    pub position: f64,
    /// Force of each finger, newton; negative where it is not limited.
    pub max_effort: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_split_exactly() {
        assert_eq!(Seconds::from_s(1.5), Seconds { sec: 1, nanosec: 500_000_000 });
        assert_eq!(Seconds::from_s(0.999_999_999_9), Seconds { sec: 1, nanosec: 0 });
        assert_eq!(Seconds::from_s(-1.0), Seconds { sec: 0, nanosec: 0 });
        assert_eq!(Seconds::from_s(f64::NAN), Seconds { sec: 0, nanosec: 0 });
        assert_eq!(Seconds::from_s(1e300).sec, u32::MAX);
        assert!((Seconds::from_s(12.345_678_9).as_s() - 12.345_678_9).abs() < 1e-9);
    }
}
