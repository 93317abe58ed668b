//! The robot as data: links, joints, limits and boxes, from the description built in or from a file.
//!
//! The closed-form inverse and the straight-line forward kinematics have the PR2's dimensions built in, so a description
//! is accepted only when its arms have them too; limits, boxes and everything else may differ.

mod error;

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use darrt_geom::Body;
use darrt_primitives::kinematics::{
    JointLimit, KinematicTree, MeshPlaces, RobotDescription, UrdfError, link_bodies, no_meshes,
};
use nalgebra::Isometry3;

use crate::arm::{Arm, ArmConfiguration, JOINT_NAMES, LimitKind, Side};
use crate::forward::{ArmChain, ArmPoses, Frame, world_from_base};
use crate::gripper;
use crate::postures::ArmPosture;
pub use error::ModelError;

/// The description built in.
pub const URDF: &str = include_str!("pr2.urdf");

/// Largest distance by which an arm of a description may differ from the built-in dimensions, m.
const SAME_POSE: f64 = 1e-6;

/// Every joint of the robot that has a meaning here.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeBody {
    /// Base on the floor: x, y (m), yaw (rad).
    pub base: [f64; 3],
    /// Torso height above its lowest position, m.
    pub torso_m: f64,
    /// Head pan and tilt, rad.
    pub head: [f64; 2],
    /// Arms, right first, rad.
    pub arms: [ArmConfiguration; 2],
    /// Finger angles, right gripper first, rad.
    pub finger_angles: [f64; 2],
}

impl WholeBody {
    /// The planner's resting state: base at the origin, torso at 0.2 m, head straight, both arms at the side, grippers
    /// at a gap of 0.08 m.
    pub fn at_rest() -> Self {
        Self {
            base: [0.0; 3],
            torso_m: 0.2,
            head: [0.0; 2],
            arms: Side::BOTH.map(|side| ArmPosture::Side.values(side)),
            finger_angles: [gripper::finger_angle(0.08); 2],
        }
    }
}

/// A link with geometry that hangs on one of the arm's frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArmBody {
    /// The frame; its pose is in [`ArmPoses`].
    pub frame: Frame,
    /// Index of the link in the tree; [`Pr2Model::body`] has its geometry.
    pub link: usize,
}

/// Indices of the variables and links of one arm.
#[derive(Debug, Clone)]
struct ArmIndices {
    joints: [usize; 7],
    /// Finger and tip joints that are variables of their own (all but one usually mimic).
    fingers: Vec<usize>,
    bodies: Vec<ArmBody>,
}

/// The PR2.
#[derive(Debug, Clone)]
pub struct Pr2Model {
    tree: KinematicTree,
    bodies: Vec<Option<Body>>,
    torso: usize,
    head: [usize; 2],
    arms: [ArmIndices; 2],
}

/// The built-in description, read once.
///
/// # Errors
/// None in practice: the description is part of the program and tested.
pub(crate) fn embedded_description() -> Result<Arc<RobotDescription>, UrdfError> {
    static READ: OnceLock<Arc<RobotDescription>> = OnceLock::new();
    if let Some(description) = READ.get() {
        return Ok(Arc::clone(description));
    }
    let description = Arc::new(RobotDescription::from_text(URDF)?);
    Ok(Arc::clone(READ.get_or_init(|| description)))
}

impl Pr2Model {
    /// The robot of the built-in description.
    ///
    /// # Errors
    /// None in practice: the description is part of the program and tested.
    pub fn embedded() -> Result<Self, ModelError> {
        Self::from_urdf(&*embedded_description()?, &no_meshes)
    }

    /// The robot of a URDF file; meshes are looked for at `meshes` and become their convex hulls.
    ///
    /// # Errors
    /// [`ModelError::Urdf`] when the file cannot be read or is no sound URDF; [`ModelError::InFile`] with everything that
    /// [`from_urdf`](Self::from_urdf) reports.
    pub fn from_file(path: &Path, meshes: &MeshPlaces) -> Result<Self, ModelError> {
        let within = |source| ModelError::InFile { path: path.to_path_buf(), source: Box::new(source) };
        Self::from_urdf(&RobotDescription::from_file(path)?, &meshes.paths()).map_err(within)
    }

    /// The robot of a description; `mesh_path` says where the file of a mesh is.
    ///
    /// # Errors
    /// [`ModelError::MissingJoint`], [`ModelError::MissingLink`] for names a PR2 must have;
    /// [`ModelError::OtherKinematics`] when a link of an arm stands elsewhere than the built-in dimensions say;
    /// [`ModelError::Urdf`] for geometry that cannot be used.
    pub fn from_urdf(
        robot: &RobotDescription,
        mesh_path: &dyn Fn(&str) -> Option<PathBuf>,
    ) -> Result<Self, ModelError> {
        let tree = KinematicTree::new(robot)?;
        let bodies = link_bodies(robot, &tree, mesh_path)?;
        let [right, left] = Side::BOTH.map(|side| arm_indices(&tree, &bodies, side));
        let model = Self {
            torso: variable(&tree, "torso_lift_joint")?,
            head: [variable(&tree, "head_pan_joint")?, variable(&tree, "head_tilt_joint")?],
            arms: [right?, left?],
            tree,
            bodies,
        };
        model.check_dimensions()?;
        Ok(model)
    }

    /// Links and joints.
    pub fn tree(&self) -> &KinematicTree {
        &self.tree
    }

    /// Geometry of every link, in link frames, in the order of the tree; `None` for a link without any.
    pub fn bodies(&self) -> &[Option<Body>] {
        &self.bodies
    }

    /// Geometry of one link.
    pub fn body(&self, link: usize) -> Option<&Body> {
        self.bodies.get(link).and_then(Option::as_ref)
    }

    /// The links of one arm that have geometry, from the shoulder to the fingertips.
    pub fn arm_bodies(&self, side: Side) -> &[ArmBody] {
        &self.arms[side.index()].bodies
    }

    /// The links with geometry that belong to neither arm: base, torso, head. Tree order.
    pub fn trunk_links(&self) -> impl Iterator<Item = usize> + '_ {
        let on_arm = |link| self.arms.iter().any(|arm| arm.bodies.iter().any(|b| b.link == link));
        (0..self.bodies.len()).filter(move |&link| self.body(link).is_some() && !on_arm(link))
    }

    /// One arm with the limits of this description.
    ///
    /// # Errors
    /// [`ModelError::Torso`] when `torso_m` is out of range.
    pub fn arm(&self, side: Side, torso_m: f64, kind: LimitKind) -> Result<Arm, ModelError> {
        Arm::with_limits(side, torso_m, self.limits(side, kind))
    }

    /// Joint limits of one arm.
    pub fn limits(&self, side: Side, kind: LimitKind) -> [JointLimit; 7] {
        self.arms[side.index()].joints.map(|joint| {
            let variable = self.tree.variables().get(joint);
            variable.map_or(JointLimit::UNLIMITED, |v| match kind {
                LimitKind::Soft => v.soft_limit,
                LimitKind::Hard => v.limit,
            })
        })
    }

    /// The tree's joint values for a state of the whole body; joints without a name here stay at zero (within limits).
    pub fn joint_values(&self, state: &WholeBody) -> Vec<f64> {
        let mut values = self.tree.neutral();
        let mut set = |variable: usize, value: f64| {
            if let Some(slot) = values.get_mut(variable) {
                *slot = value;
            }
        };
        set(self.torso, state.torso_m);
        for (variable, value) in self.head.iter().zip(state.head) {
            set(*variable, value);
        }
        for ((indices, q), angle) in self.arms.iter().zip(&state.arms).zip(state.finger_angles) {
            for (variable, value) in indices.joints.iter().zip(q) {
                set(*variable, *value);
            }
            for variable in &indices.fingers {
                set(*variable, angle);
            }
        }
        values
    }

    /// World pose of every link of the tree.
    pub fn link_poses(&self, state: &WholeBody) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.tree.link_count()];
        // Both lengths are the tree's own.
        let written = self.tree.forward(&self.joint_values(state), &world_from_base(&state.base), &mut poses);
        debug_assert!(written.is_ok(), "{written:?}");
        poses
    }

    /// Compares every arm link of the description with the built-in dimensions.
    fn check_dimensions(&self) -> Result<(), ModelError> {
        let mut state = WholeBody::at_rest();
        let stretched = [0.0; 7];
        let bent = [0.4, 0.5, -0.6, -0.7, 0.8, -0.9, 1.0];
        for (q, angle) in [(stretched, 0.0), (bent, 0.3)] {
            (state.arms, state.finger_angles) = ([q; 2], [angle; 2]);
            let poses = self.link_poses(&state);
            for side in Side::BOTH {
                let mut expected = ArmPoses::default();
                ArmChain::new(side, state.torso_m).world_from_links(&state.base, &q, angle, &mut expected);
                for frame in Frame::ALL {
                    for name in frame.links() {
                        self.check_link(&format!("{}_{name}", side.prefix()), &poses, expected.pose(frame))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn check_link(&self, name: &str, poses: &[Isometry3<f64>], expected: &Isometry3<f64>) -> Result<(), ModelError> {
        let missing = || ModelError::MissingLink { name: name.to_owned() };
        let pose = self.tree.link_index(name).and_then(|i| poses.get(i)).ok_or_else(missing)?;
        let distance = (pose.translation.vector - expected.translation.vector).norm();
        let angle = pose.rotation.angle_to(&expected.rotation);
        if distance <= SAME_POSE && angle <= SAME_POSE {
            return Ok(());
        }
        Err(ModelError::OtherKinematics { link: name.to_owned(), distance, angle, bound: SAME_POSE })
    }
}

fn variable(tree: &KinematicTree, name: &str) -> Result<usize, ModelError> {
    tree.variable_index(name).ok_or_else(|| ModelError::MissingJoint { name: name.to_owned() })
}

fn arm_indices(tree: &KinematicTree, bodies: &[Option<Body>], side: Side) -> Result<ArmIndices, ModelError> {
    let prefix = side.prefix();
    let mut joints = [0; 7];
    for (slot, name) in joints.iter_mut().zip(JOINT_NAMES) {
        *slot = variable(tree, &format!("{prefix}_{name}_joint"))?;
    }
    let fingers = ["l_finger", "r_finger", "l_finger_tip", "r_finger_tip"];
    let finger = |name: &str| tree.variable_index(&format!("{prefix}_gripper_{name}_joint"));
    let has_body = |link: &usize| bodies.get(*link).is_some_and(Option::is_some);
    let of_frame = |frame: Frame| {
        let links = frame.links().iter().filter_map(move |name| tree.link_index(&format!("{prefix}_{name}")));
        links.filter(has_body).map(move |link| ArmBody { frame, link })
    };
    Ok(ArmIndices {
        joints,
        fingers: fingers.into_iter().filter_map(finger).collect(),
        bodies: Frame::ALL.into_iter().flat_map(of_frame).collect(),
    })
}

#[cfg(test)]
mod tests;
