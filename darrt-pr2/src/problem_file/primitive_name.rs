//! The paper's eight primitives by name.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A primitive of the paper; files spell it exactly as the paper does.
///
/// # Source
/// Section 5.1 of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
pub enum PrimitiveName {
    /// The arm moves in a straight line in joint space.
    #[serde(rename = "Arm-Transit")]
    ArmTransit,
    /// The gripper moves in a straight line in Cartesian space.
    #[serde(rename = "Straight-Line-Arm-Transit")]
    StraightLineArmTransit,
    /// The arm moves a held object in a straight line in joint space.
    #[serde(rename = "Arm-Rigid-Transfer")]
    ArmRigidTransfer,
    /// The base moves, nothing is held.
    #[serde(rename = "Base-Transit")]
    BaseTransit,
    /// The base moves a held object.
    #[serde(rename = "Base-Rigid-Transfer")]
    BaseRigidTransfer,
    /// The gripper takes an object and lifts it.
    #[serde(rename = "Pick")]
    Pick,
    /// The gripper sets a held object down and lets go.
    #[serde(rename = "Place")]
    Place,
    /// The gripper pushes a round object over its support surface.
    #[serde(rename = "Push")]
    Push,
}

impl PrimitiveName {
    /// All eight, in the order of the paper.
    pub const ALL: [Self; 8] = [
        Self::ArmTransit,
        Self::StraightLineArmTransit,
        Self::ArmRigidTransfer,
        Self::BaseTransit,
        Self::BaseRigidTransfer,
        Self::Pick,
        Self::Place,
        Self::Push,
    ];

    /// The name as the paper and the files spell it.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::ArmTransit => "Arm-Transit",
            Self::StraightLineArmTransit => "Straight-Line-Arm-Transit",
            Self::ArmRigidTransfer => "Arm-Rigid-Transfer",
            Self::BaseTransit => "Base-Transit",
            Self::BaseRigidTransfer => "Base-Rigid-Transfer",
            Self::Pick => "Pick",
            Self::Place => "Place",
            Self::Push => "Push",
        }
    }
}

impl fmt::Display for PrimitiveName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_names_equal_the_names_in_files() {
        for name in PrimitiveName::ALL {
            let text = serde_json::to_string(&name).unwrap();
            assert_eq!(text, format!("\"{name}\""));
        }
    }
}
