//! Names of what a program registers: primitives, samplers, distances. Which ones there are is the registry's matter.

use std::borrow::{Borrow, Cow};
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

macro_rules! name {
    ($(#[$doc:meta])* $name:ident: $($(#[$entry_doc:meta])* $entry:ident = $text:literal),+) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
        #[serde(transparent)]
        pub struct $name(Cow<'static, str>);

        impl $name {
            $($(#[$entry_doc])* pub const $entry: Self = Self::new($text);)+

            /// The name of something that a program registers.
            pub const fn new(name: &'static str) -> Self {
                Self(Cow::Borrowed(name))
            }

            /// The name as files spell it.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl From<String> for $name {
            fn from(name: String) -> Self {
                Self(Cow::Owned(name))
            }
        }

        impl Borrow<str> for $name {
            fn borrow(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(&self.0)
            }
        }
    };
}

name!(
    /// The name of a primitive. The paper's eight (section 5.1) are spelt exactly as in the paper.
    PrimitiveName:
    /// The arm moves in a straight line in joint space.
    ARM_TRANSIT = "Arm-Transit",
    /// The gripper moves in a straight line in Cartesian space.
    STRAIGHT_LINE_ARM_TRANSIT = "Straight-Line-Arm-Transit",
    /// The arm moves a held object in a straight line in joint space.
    ARM_RIGID_TRANSFER = "Arm-Rigid-Transfer",
    /// The base moves, nothing is held.
    BASE_TRANSIT = "Base-Transit",
    /// The base moves a held object.
    BASE_RIGID_TRANSFER = "Base-Rigid-Transfer",
    /// The gripper takes an object and lifts it.
    PICK = "Pick",
    /// The gripper sets a held object down and lets go.
    PLACE = "Place",
    /// The gripper pushes a round object over its support surface.
    PUSH = "Push"
);

impl PrimitiveName {
    /// The paper's eight, in the order of the paper.
    pub const PAPER: [Self; 8] = [
        Self::ARM_TRANSIT,
        Self::STRAIGHT_LINE_ARM_TRANSIT,
        Self::ARM_RIGID_TRANSFER,
        Self::BASE_TRANSIT,
        Self::BASE_RIGID_TRANSFER,
        Self::PICK,
        Self::PLACE,
        Self::PUSH,
    ];
}

name!(
    /// How a sample of the space chooses the components that it specifies.
    SamplerName:
    /// Either the robot or the objects (the paper, section 4.2).
    ROBOT_OR_OBJECTS = "robot-or-objects",
    /// A random subset of all components.
    RANDOM_SUBSET = "random-subset",
    /// All components.
    FULL = "full"
);

impl Default for SamplerName {
    fn default() -> Self {
        Self::ROBOT_OR_OBJECTS
    }
}

name!(
    /// How far a tree node is from a sample.
    DistanceName:
    /// The robot visits the objects greedily, nearest first (the paper, section 4.3).
    GREEDY = "greedy",
    /// The sum of the component distances.
    EUCLIDEAN = "euclidean",
    /// The robot visits the objects in the best order.
    EXACT_TOUR = "exact-tour"
);

impl Default for DistanceName {
    fn default() -> Self {
        Self::GREEDY
    }
}

name!(
    /// What improving a plan saves, besides steps.
    CostName:
    /// Seconds of execution at the robot's speeds.
    EXECUTION_TIME = "execution-time"
);

impl Default for CostName {
    fn default() -> Self {
        Self::EXECUTION_TIME
    }
}
