//! Settings of primitives and planner.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::length_range::LengthRange;
use super::name::{DistanceName, SamplerName};

/// Where a push toward a place beyond the edge of the surface ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EdgeRule {
    /// At the edge point nearest to that place (the paper's words, section 4.1).
    #[default]
    NearestEdgePoint,
    /// Where the straight line to that place crosses the edge (what the authors' later software does).
    LineCrossing,
}

/// `[push]`: parameters of the primitive Push, metres.
///
/// The fingers are open across the direction of the push and touch the object at two points behind its centre. A push is
/// long enough for both to touch wherever the object is within `position_error_m`, unless its end is nearer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Push {
    /// Gap between the two fingers, 0 to 0.09; less where an object is too narrow for it.
    pub gap_m: f64,
    /// Least height of the fingertips above the surface; a third of the object's height, if that is more.
    pub fingertip_clearance_m: f64,
    /// Leans of the hand from the vertical, degrees, 0 to 75: the fingertips ahead, the wrist trailing. Tried in this order.
    pub leans_deg: Vec<f64>,
    /// How far behind the contact the hand comes down; at least the position error, or it may come down on the object.
    pub standoff_m: LengthRange,
    /// Length of the straight way down before the push.
    pub approach_m: LengthRange,
    /// Length of the straight way back along the hand from an object, before the hand does anything else.
    pub retreat_m: LengthRange,
    /// How far to any side an object may be from where it is thought to be.
    pub position_error_m: f64,
    /// How far an object may turn in one push, degrees, 0 to 120: where a straight push is blocked the hand pushes along an
    /// arc, as sharp as the fingers hold the object. 0: straight pushes only, as in the paper.
    pub max_turn_deg: f64,
    /// Where a push toward a place beyond the edge ends.
    pub edge_rule: EdgeRule,
    /// How far inside the edge the centre of the object may stop, `[least, most]`.
    pub edge_distance_m: [f64; 2],
}

impl Default for Push {
    fn default() -> Self {
        Self {
            gap_m: 0.088,
            fingertip_clearance_m: 0.005,
            leans_deg: vec![0.0, 35.0, 60.0],
            standoff_m: LengthRange::new(0.03, 0.05),
            approach_m: LengthRange::new(0.02, 0.10),
            retreat_m: LengthRange::new(0.03, 0.10),
            position_error_m: 0.01,
            max_turn_deg: 60.0,
            edge_rule: EdgeRule::NearestEdgePoint,
            edge_distance_m: [0.03, 0.08],
        }
    }
}

/// `[place]`: parameters of the primitive Place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Place {
    /// Directions of the last straight motion in the world frame; each has a downward part, the length is ignored.
    pub approach_directions: Vec<[f64; 3]>,
    /// Length of the last straight motion (m).
    pub approach_m: LengthRange,
    /// Length of the straight way of the empty hand back along itself (m).
    pub retreat_m: LengthRange,
}

impl Default for Place {
    fn default() -> Self {
        Self {
            approach_directions: vec![[0.0, 0.0, -1.0]],
            approach_m: LengthRange::new(0.02, 0.10),
            retreat_m: LengthRange::new(0.03, 0.10),
        }
    }
}

/// `[sampling]`: how the space is sampled. Shares are probabilities, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Sampling {
    /// Which components a sample specifies.
    pub sampler: SamplerName,
    /// Share of samples that specify objects instead of the robot (for `robot-or-objects`).
    pub object_share: f64,
    /// Share of samples drawn from the goal.
    pub goal_bias: f64,
    /// Share of the sampled objects that are put near the edge of a surface instead, also in samples from the goal; at
    /// most 0.9, so that goals are sampled too.
    pub edge_share: f64,
    /// Share of robot samples that move only the base and keep the arm.
    pub base_only_share: f64,
    /// Which distance picks the tree node.
    pub distance: DistanceName,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            sampler: SamplerName::ROBOT_OR_OBJECTS,
            object_share: 0.5,
            goal_bias: 0.2,
            edge_share: 0.3,
            base_only_share: 0.0,
            distance: DistanceName::GREEDY,
        }
    }
}

/// `[transit]`: how the arm travels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Transit {
    /// Names of postures that the arm may travel through between manipulations.
    pub postures: Vec<String>,
}

impl Default for Transit {
    fn default() -> Self {
        Self { postures: ["side", "up", "untucked", "above_and_to_side"].map(str::to_owned).to_vec() }
    }
}

/// `[budget]`: when planning stops and when it starts over.
///
/// A count that is left out does not limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Budget {
    /// Wall-clock limit in seconds, > 0.
    pub time_limit_s: f64,
    /// Most iterations in total.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iterations: Option<u64>,
    /// Most tree nodes before the tree is given up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<u64>,
    /// Iterations after which the planner starts over with a new tree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restart_iterations: Option<u64>,
}

impl Default for Budget {
    fn default() -> Self {
        Self { time_limit_s: 60.0, iterations: None, nodes: None, restart_iterations: None }
    }
}

/// `[paper]`: the figures that the paper reports for the problem (its Table 1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaperFigures {
    /// Mean planning time of ten trials in seconds, on the authors' machine.
    pub planning_time_s: f64,
    /// Time after which the authors' planner started over, in seconds.
    pub restart_time_s: f64,
    /// Successful and attempted executions on the robot, where the paper reports them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub executions: Option<[u32; 2]>,
}
