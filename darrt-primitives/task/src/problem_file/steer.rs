//! Rules by which a person steers a plan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{PrimitiveName, Region};

/// `[[steer]]`: a rule for those steps of the plan that take, set down or slide an object. Every step that the rule is about keeps
/// to all of its keys; with `forbid`, none does; with `require`, at least one does, and the others may do as they like. Every other
/// plan is refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Steer {
    /// The rule is about steps with this object; with any, if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// The rule is about steps of this primitive; of any, if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub primitive: Option<PrimitiveName>,
    /// There is no step that keeps to the other keys.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub forbid: bool,
    /// There is at least one step that keeps to the other keys.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub require: bool,
    /// The surface that the object stands on where it is taken or begins to be pushed, or where it is set down.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
    /// From which side the hand is at the object, seen from its centre: a range of directions in the world, counter-clockwise from
    /// the first to the second, degrees from the x axis, -360 to 360. Asked where the hand takes or begins to push the object, and
    /// where it lets go of it; a hand right above the object is on every side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_deg: Option<[f64; 2]>,
    /// Where the centre of the base stands in such a step: x and y, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<Region>,
    /// Where it does not stand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_base: Option<Region>,
}
