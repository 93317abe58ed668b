//! `[safety]`: how far robot and objects keep from what they need not touch.

use darrt_primitives::tabletop::SafetySettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[safety]`: distances that plans keep, metres, each at least 0.
///
/// The margins are what a plan keeps where the room allows; where it does not, a plan may come nearer, down to
/// `least_margin_m`. A pair that must be near (the hand or what it holds, against the object that it handles and against
/// what that object stands on) keeps `contact_margin_m` until it may touch. Start and goal may be nearer than a margin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Safety {
    /// Wanted distance of the robot from everything else.
    pub robot_margin_m: f64,
    /// Wanted distance of a held object from everything else.
    pub held_margin_m: f64,
    /// Wanted distance of a pushed object from everything but what it slides on and what pushes it.
    pub object_margin_m: f64,
    /// Least distance of every pair that need not be near.
    pub least_margin_m: f64,
    /// Least distance of a pair that must be near and does not touch.
    pub contact_margin_m: f64,
    /// How far inside the edge of a surface the centre of an object is set down or pushed, unless the goal lies nearer.
    pub edge_margin_m: f64,
}

impl Default for Safety {
    fn default() -> Self {
        let SafetySettings {
            robot_margin_m,
            held_margin_m,
            object_margin_m,
            least_margin_m,
            contact_margin_m,
            edge_margin_m,
        } = SafetySettings::default();
        Self { robot_margin_m, held_margin_m, object_margin_m, least_margin_m, contact_margin_m, edge_margin_m }
    }
}

impl Safety {
    /// The keys and their values.
    pub(crate) fn lengths(&self) -> [(&'static str, f64); 6] {
        [
            ("robot_margin_m", self.robot_margin_m),
            ("held_margin_m", self.held_margin_m),
            ("object_margin_m", self.object_margin_m),
            ("least_margin_m", self.least_margin_m),
            ("contact_margin_m", self.contact_margin_m),
            ("edge_margin_m", self.edge_margin_m),
        ]
    }

    /// The same for the planner.
    pub fn settings(&self) -> SafetySettings {
        SafetySettings {
            robot_margin_m: self.robot_margin_m,
            held_margin_m: self.held_margin_m,
            object_margin_m: self.object_margin_m,
            least_margin_m: self.least_margin_m,
            contact_margin_m: self.contact_margin_m,
            edge_margin_m: self.edge_margin_m,
        }
    }
}
