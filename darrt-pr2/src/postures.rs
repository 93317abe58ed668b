//! Well-known postures of the arms.

use std::f64::consts::FRAC_PI_2;

use crate::arm::{ArmConfiguration, Side};

/// A named posture of one arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ArmPosture {
    /// Folded in front of the body, the stock posture for driving; the two arms differ. The left arm lies across the
    /// body and its boxes reach into those of the right shoulder.
    Tucked,
    /// In front of the body, hands up.
    Untucked,
    /// Beside the body, hand down: where the planner's arms start.
    Side,
    /// Beside the body, hand raised forward.
    AboveAndToSide,
    /// On the way to [`Tucked`](Self::Tucked).
    TuckApproach,
    /// Upper arm level, hand up.
    Up,
    /// Hanging beside the body.
    Rest,
    /// Hand straight down in front of the shoulder.
    TopDownHold,
    /// Elbow out to the side, hand straight down.
    ElbowOut,
}

impl ArmPosture {
    /// All postures.
    pub const ALL: [Self; 9] = [
        Self::Tucked,
        Self::Untucked,
        Self::Side,
        Self::AboveAndToSide,
        Self::TuckApproach,
        Self::Up,
        Self::Rest,
        Self::TopDownHold,
        Self::ElbowOut,
    ];

    /// The name used in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tucked => "tucked",
            Self::Untucked => "untucked",
            Self::Side => "side",
            Self::AboveAndToSide => "above_and_to_side",
            Self::TuckApproach => "tuck_approach",
            Self::Up => "up",
            Self::Rest => "rest",
            Self::TopDownHold => "top_down_hold",
            Self::ElbowOut => "elbow_out",
        }
    }

    /// The posture with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// Joint values, rad. The left arm mirrors the right one but for [`Tucked`](Self::Tucked).
    ///
    /// # Source
    /// The robot's stock tuck action and `MoveIt` configuration (tucked, untucked, tuck approach); `side` and
    /// `above_and_to_side` are constants common to public PR2 grasping code; the rest are our own.
    pub fn values(self, side: Side) -> ArmConfiguration {
        match (self, side) {
            (Self::Tucked, Side::Left) => {
                [0.060_24, 1.248_526, 1.789_070, -1.683_386, -1.734_341_7, -0.096_214_1, -0.086_440_7]
            }
            (_, Side::Right) => self.right(),
            (_, Side::Left) => mirrored(&self.right()),
        }
    }

    fn right(self) -> ArmConfiguration {
        match self {
            Self::Tucked => [-0.023_593, 1.107_28, -1.556_688_2, -2.124_408, -1.417_5, -1.841_7, 0.214_36],
            Self::Untucked => [-0.4, 1.0, 0.0, -2.05, 0.0, -0.1, 0.0],
            Self::Side => [-2.135, 0.803, -1.732, -1.905, -2.369, -1.68, 1.398],
            Self::AboveAndToSide => [-0.968, 0.729, -0.554, -1.891, -1.786, -1.127, 0.501],
            Self::TuckApproach => [0.039, 1.107_2, 0.0, -2.067, -1.231, -1.998, 0.369],
            Self::Up => [-0.4, 0.0, 0.0, -2.05, 0.0, -0.1, 0.0],
            Self::Rest => [-2.135, 1.296, -3.75, -0.15, 0.0, -0.1, 0.0],
            Self::TopDownHold => {
                [-0.677_170_21, -0.343_131_99, -1.2, -1.466_884_05, -1.242_232_29, -1.954_428_26, -2.222_541_25]
            }
            Self::ElbowOut => [-FRAC_PI_2, 0.0, -FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_2, 0.0],
        }
    }
}

/// The same posture of the other arm: pan and the three rolls change sign.
///
/// # Laws
/// The tool pose is mirrored at the plane y = 0; applied twice it changes nothing.
pub fn mirrored(q: &ArmConfiguration) -> ArmConfiguration {
    let [pan, lift, upper_roll, elbow, forearm_roll, wrist, wrist_roll] = *q;
    [-pan, lift, -upper_roll, elbow, -forearm_roll, wrist, -wrist_roll]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::ArmChain;
    use nalgebra::Vector3;

    /// Tool position and tool x axis in the base frame for the right arm, torso at 0.2 m.
    const TOOL: [(ArmPosture, [f64; 3], [f64; 3]); 9] = [
        (ArmPosture::Tucked, [0.0093, 0.0312, 0.7061], [-0.855, -0.271, -0.442]),
        (ArmPosture::Untucked, [0.4560, -0.4019, 1.0968], [0.376, -0.159, 0.913]),
        (ArmPosture::Side, [0.0629, -0.5752, 0.5649], [0.023, 0.004, -1.000]),
        (ArmPosture::AboveAndToSide, [0.5100, -0.4024, 0.9702], [0.816, 0.572, -0.081]),
        (ArmPosture::TuckApproach, [0.3192, -0.0190, 0.8661], [-0.519, 0.838, -0.165]),
        (ArmPosture::Up, [0.1835, -0.2867, 1.4262], [-0.504, 0.213, 0.837]),
        (ArmPosture::Rest, [-0.2384, -0.3867, 0.1117], [-0.155, 0.019, -0.988]),
        (ArmPosture::TopDownHold, [0.5021, -0.2500, 1.0654], [0.0, 0.0, -1.0]),
        (ArmPosture::ElbowOut, [0.2710, -0.6880, 0.8107], [0.0, 0.0, -1.0]),
    ];

    #[test]
    fn tools_stand_where_they_are_known_to() {
        for (posture, position, axis) in TOOL {
            let tool = ArmChain::new(Side::Right, 0.2).base_from_tool(&posture.values(Side::Right));
            assert!((tool.translation.vector - Vector3::from(position)).norm() < 1e-3, "{}", posture.name());
            assert!((tool * Vector3::x() - Vector3::from(axis)).norm() < 2e-3, "{}", posture.name());
        }
    }

    #[test]
    fn mirroring_mirrors_the_tool() {
        for posture in ArmPosture::ALL {
            let q = posture.values(Side::Right);
            let right = ArmChain::new(Side::Right, 0.2).base_from_tool(&q);
            let left = ArmChain::new(Side::Left, 0.2).base_from_tool(&mirrored(&q));
            let flip = |v: Vector3<f64>| Vector3::new(v.x, -v.y, v.z);
            assert!((left.translation.vector - flip(right.translation.vector)).norm() < 1e-15);
            assert!((left * Vector3::x() - flip(right * Vector3::x())).norm() < 1e-15);
            assert_eq!(mirrored(&mirrored(&q)), q);
            assert_eq!(ArmPosture::from_name(posture.name()), Some(posture));
        }
        assert_eq!(ArmPosture::from_name("none"), None);
    }
}
