//! Where links and tool are: the moving joints in a row, and for every link the joint that carries it.

use arrayvec::ArrayVec;
use darrt_primitives::joints::MAX_JOINTS;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::kinematics::tree::LinkMotion;
use darrt_primitives::manipulator::world_from_base;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// What the value of a joint comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Driver {
    /// A joint of an arm, by its index among those of the robot.
    Arm(usize),
    /// The joint that opens a hand, by the number of the hand.
    Finger(usize),
    /// It stands at this value.
    Rests(f64),
}

/// The values of the joints that open the hands.
pub(super) type Fingers = [f64; 2];

impl Driver {
    /// The value, for these joints of the robot.
    pub(super) fn value(&self, arm: &[f64], fingers: Fingers) -> f64 {
        match *self {
            Self::Arm(index) => arm.get(index).copied().unwrap_or(0.0),
            Self::Finger(hand) => fingers.get(hand).copied().unwrap_or(0.0),
            Self::Rests(value) => value,
        }
    }
}

/// Which of the robot's joints are those of one arm, in its order: as many from the first on as the arms share, then those from
/// `from` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Own {
    shared: usize,
    from: usize,
    count: usize,
}

impl Own {
    /// Of the first arm, which has the first so many.
    pub(super) fn first(count: usize) -> Self {
        Self { shared: count, from: count, count }
    }

    /// Of an arm of `count` joints that shares so many with the first, which has `from`.
    pub(super) fn second(shared: usize, from: usize, count: usize) -> Self {
        Self { shared, from, count }
    }

    /// The index among the robot's joints of a joint of the arm.
    pub(super) fn index(&self, joint: usize) -> usize {
        if joint < self.shared { joint } else { self.from + joint - self.shared }
    }

    /// The indices of all of them.
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.count).map(|joint| self.index(joint))
    }

    /// The values of the arm's joints of those of the robot; `place` has room for them.
    pub(super) fn of<'a>(&self, all: &'a [f64], place: &'a mut Values) -> &'a [f64] {
        if self.shared == self.count {
            return all.get(..self.count).unwrap_or(all);
        }
        place.clear();
        // There are no more joints than places: a robot of more is refused when it is read.
        self.indices().filter_map(|joint| all.get(joint)).take(MAX_JOINTS).for_each(|value| place.push(*value));
        place
    }
}

/// A value for each joint of an arm or of a robot.
pub(super) type Values = ArrayVec<f64, MAX_JOINTS>;

/// One moving joint below what carries it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joint {
    /// Its frame at value 0, in the frame of what carries it.
    pub(super) before: Isometry3<f64>,
    /// In its own frame.
    pub(super) axis: Unit<Vector3<f64>>,
    pub(super) slides: bool,
}

impl Joint {
    fn moved(&self, value: f64) -> Isometry3<f64> {
        if self.slides {
            let offset = self.before.rotation * (self.axis.into_inner() * value);
            return Isometry3::from_parts(
                Translation3::from(self.before.translation.vector + offset),
                self.before.rotation,
            );
        }
        let turn = UnitQuaternion::from_axis_angle(&self.axis, value);
        Isometry3::from_parts(self.before.translation, self.before.rotation * turn)
    }
}

/// A joint between a link and what carries it that a hand's opening or, by way of a joint that follows, an arm moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) joint: Joint,
    pub(super) driver: Driver,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

/// Where a link is.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// 0: rigid to the base; k: carried by joint k of the arm that it belongs to, counted from 1.
    pub(super) anchor: usize,
    pub(super) steps: Vec<Step>,
    /// Below the last of the steps.
    pub(super) offset: Isometry3<f64>,
}

impl Place {
    /// The link's pose in the frame of what carries it, for these joints of the robot.
    pub(super) fn in_anchor(&self, arm: &[f64], fingers: Fingers) -> Isometry3<f64> {
        let mut pose: Option<Isometry3<f64>> = None;
        for step in &self.steps {
            let moved = step.joint.moved(step.multiplier * step.driver.value(arm, fingers) + step.offset);
            pose = Some(pose.map_or(moved, |pose| pose * moved));
        }
        pose.map_or(self.offset, |pose| pose * self.offset)
    }
}

/// Frames of base and joints: the base first.
pub(super) type Frames = ArrayVec<Isometry3<f64>, { MAX_JOINTS + 1 }>;

/// The joints of an arm, in a row.
#[derive(Debug, Clone)]
pub(super) struct ArmChain {
    pub(super) joints: Vec<Joint>,
    /// From the last joint's frame.
    pub(super) wrist_from_tool: Isometry3<f64>,
}

impl ArmChain {
    /// The tool in the world.
    pub(super) fn world_from_tool(&self, base: &[f64; 3], arm: &[f64]) -> Isometry3<f64> {
        let world_from_base = world_from_base(base);
        let wrist =
            self.joints.iter().zip(arm).fold(world_from_base, |pose, (joint, value)| pose * joint.moved(*value));
        wrist * self.wrist_from_tool
    }

    /// The frames of base and joints in the world.
    pub(super) fn frames(&self, base: &[f64; 3], arm: &[f64]) -> Frames {
        let mut pose = world_from_base(base);
        let mut frames = Frames::new();
        frames.push(pose);
        for (joint, value) in self.joints.iter().zip(arm) {
            pose *= joint.moved(*value);
            // There are no more joints than places: a longer arm is refused when it is read.
            let _ = frames.try_push(pose);
        }
        frames
    }
}

/// A tree with the meaning of its variables, as one arm sees it.
pub(super) struct Layout<'a> {
    pub(super) tree: &'a KinematicTree,
    /// By variable.
    pub(super) drivers: &'a [Driver],
    /// The links that the joints of the arm move, from the base outwards.
    pub(super) arm_links: Vec<usize>,
}

impl Layout<'_> {
    /// The joints of the arm; `tool` is rigid to the last of them.
    pub(super) fn chain(&self, tool: usize) -> Option<ArmChain> {
        let mut joints = Vec::new();
        for (place, link) in self.arm_links.iter().enumerate() {
            let parent = self.tree.parent(*link)?;
            let above = self.place_above(parent, place)?;
            let before = above.in_anchor(&[], Fingers::default()) * self.tree.parent_from_link(*link)?;
            let (axis, slides) = match self.tree.motion(*link)? {
                LinkMotion::Turning { axis, .. } => (*axis, false),
                LinkMotion::Sliding { axis, .. } => (*axis, true),
                LinkMotion::Fixed => return None,
            };
            joints.push(Joint { before, axis, slides });
        }
        let tool = self.place(tool)?;
        Some(ArmChain { joints, wrist_from_tool: tool.in_anchor(&[], Fingers::default()) })
    }

    /// Where a link is.
    pub(super) fn place(&self, link: usize) -> Option<Place> {
        self.place_above(link, self.arm_links.len())
    }

    /// Where a link is that hangs on the base or on one of the first `joints` joints of the arm.
    fn place_above(&self, link: usize, joints: usize) -> Option<Place> {
        let mut path = Vec::new();
        let mut at = link;
        let anchor = loop {
            if let Some(place) = self.arm_links.iter().take(joints).position(|moved| *moved == at) {
                break place + 1;
            }
            let Some(parent) = self.tree.parent(at) else { break 0 };
            path.push(at);
            at = parent;
        };
        let mut steps = Vec::new();
        let mut offset = Isometry3::identity();
        for link in path.into_iter().rev() {
            offset *= self.tree.parent_from_link(link)?;
            let (axis, drive, slides) = match self.tree.motion(link)? {
                LinkMotion::Fixed => continue,
                LinkMotion::Turning { axis, drive } => (*axis, *drive, false),
                LinkMotion::Sliding { axis, drive } => (*axis, *drive, true),
            };
            let joint = Joint { before: offset, axis, slides };
            let driver = *self.drivers.get(drive.variable)?;
            if let Driver::Rests(value) = driver {
                offset = joint.moved(drive.multiplier * value + drive.offset);
                continue;
            }
            steps.push(Step { joint, driver, multiplier: drive.multiplier, offset: drive.offset });
            offset = Isometry3::identity();
        }
        Some(Place { anchor, steps, offset })
    }
}
