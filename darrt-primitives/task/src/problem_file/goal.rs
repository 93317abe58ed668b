//! Goals: where the objects and the robot shall end.

use darrt_geom::SupportSurface;
use nalgebra::{Isometry3, Point2, Translation3, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[goal]`: a list of goals for single objects, and one for the robot.
///
/// Goals of different objects must all hold; several goals of one object are alternatives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Goal {
    /// Where objects shall end; at least one goal, of an object or of the robot.
    #[serde(default, rename = "object", skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectGoal>,
    /// Where the robot shall be at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotGoal>,
}

/// `[goal.robot]`: where the robot shall be at the end. Every key that is given must hold; at least one of `base`, `joints` and
/// `tool` is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotGoal {
    /// x, y (m) and yaw (rad) of the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<[f64; 3]>,
    /// Joints of the arm that manipulates, from shoulder to wrist (rad or m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<f64>>,
    /// The pose of the tool in the world.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<ToolGoal>,
    /// How far base and tool may be off (m), > 0.
    #[serde(default = "default_tolerance")]
    pub tolerance_m: f64,
    /// How far base, tool and joints may be turned off (rad), > 0.
    #[serde(default = "default_yaw_tolerance")]
    pub tolerance_rad: f64,
}

/// `tool = { position = [x, y, z], rpy = [r, p, y] }`: a pose of the tool in the world, x out of the hand, y the opening axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToolGoal {
    /// Its origin (m).
    pub position: [f64; 3],
    /// Roll, pitch and yaw (rad), about the fixed axes x, y, z in this order.
    pub rpy: [f64; 3],
}

impl ToolGoal {
    /// The pose.
    pub fn world_from_tool(&self) -> Isometry3<f64> {
        let [roll, pitch, yaw] = self.rpy;
        let [x, y, z] = self.position;
        Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
    }
}

impl Goal {
    /// The alternatives of each object that has a goal, in the order in which the file names the objects.
    pub fn by_object(&self) -> Vec<(&str, Vec<&ObjectGoal>)> {
        let mut groups: Vec<(&str, Vec<&ObjectGoal>)> = Vec::new();
        for goal in &self.objects {
            match groups.iter_mut().find(|(name, _)| *name == goal.object) {
                Some((_, alternatives)) => alternatives.push(goal),
                None => groups.push((&goal.object, vec![goal])),
            }
        }
        groups
    }
}

/// Whether the object must be in the hand at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GoalState {
    /// The object stands on a surface and the hand has let go.
    Released,
    /// The hand holds the object.
    Held,
    /// Either.
    Any,
}

/// An axis-aligned rectangle in the plane of a surface, world x and y in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Smallest x and y.
    pub min: [f64; 2],
    /// Largest x and y.
    pub max: [f64; 2],
}

impl Region {
    /// All of any surface.
    pub(crate) const WHOLE: Self = Self { min: [f64::NEG_INFINITY; 2], max: [f64::INFINITY; 2] };

    /// The smallest rectangle around the part of it that may lie on a surface; `None` if it lies beside it.
    pub fn over(&self, surface: &SupportSurface) -> Option<Self> {
        let (low, high) = surface.bounds();
        let min = [self.min[0].max(low.x), self.min[1].max(low.y)];
        let max = [self.max[0].min(high.x), self.max[1].min(high.y)];
        (min[0] <= max[0] && min[1] <= max[1]).then_some(Self { min, max })
    }

    /// Points of a finite one, evenly spread, `count` along each side.
    pub fn places(&self, count: u32) -> impl Iterator<Item = Point2<f64>> + '_ {
        let share = move |index: u32| f64::from(index) / f64::from(count.max(2) - 1);
        let at = move |axis: usize, share: f64| self.min[axis] + (self.max[axis] - self.min[axis]) * share;
        (0..count).flat_map(move |i| (0..count).map(move |j| Point2::new(at(0, share(i)), at(1, share(j)))))
    }
}

/// `[[goal.object]]`: where one object shall end.
///
/// Exactly one of: `on` with `at`, `on` with `region`, `on` alone, which means anywhere on it, or `position`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectGoal {
    /// The object.
    pub object: String,
    /// The surface on which the object shall stand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// Where its centre shall be on the surface: world x, y in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 2]>,
    /// Where on the surface its centre may be, instead of one point; anywhere on it when neither is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Region>,
    /// Where its centre shall be in the world (m), off every surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// How far the centre may be from the goal (m), > 0.
    #[serde(default = "default_tolerance")]
    pub tolerance_m: f64,
    /// Wanted yaw (rad); free when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw: Option<f64>,
    /// How far the yaw may be from the wanted one (rad), > 0.
    #[serde(default = "default_yaw_tolerance")]
    pub yaw_tolerance: f64,
    /// Whether the object must be in the hand; by default `released` on a surface and `held` at a `position`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<GoalState>,
}

/// The place of a goal, the keys `on`, `at`, `region` and `position` made exclusive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GoalTarget<'a> {
    /// The centre stands over one point of a surface (world x, y).
    On {
        /// Name of the surface.
        surface: &'a str,
        /// World x, y of the centre.
        at: [f64; 2],
    },
    /// The centre stands over a rectangle of a surface, which may be larger than the surface.
    Within {
        /// Name of the surface.
        surface: &'a str,
        /// The rectangle.
        region: &'a Region,
    },
    /// The centre is at a point of the world.
    At {
        /// World x, y, z of the centre.
        position: [f64; 3],
    },
}

impl ObjectGoal {
    /// The place of the goal; `None` when the keys contradict each other, which validation refuses.
    pub fn target(&self) -> Option<GoalTarget<'_>> {
        match (self.on.as_deref(), self.at, &self.region, self.position) {
            (Some(surface), Some(at), None, None) => Some(GoalTarget::On { surface, at }),
            (Some(surface), None, Some(region), None) => Some(GoalTarget::Within { surface, region }),
            (Some(surface), None, None, None) => Some(GoalTarget::Within { surface, region: &Region::WHOLE }),
            (None, None, None, Some(position)) => Some(GoalTarget::At { position }),
            _ => None,
        }
    }

    /// Whether the object must be in the hand.
    pub const fn state(&self) -> GoalState {
        match self.state {
            Some(state) => state,
            None if self.position.is_some() => GoalState::Held,
            None => GoalState::Released,
        }
    }

    /// Fills in what depends on other keys.
    pub(crate) fn normalise(&mut self) {
        self.state = Some(self.state());
    }
}

fn default_tolerance() -> f64 {
    0.01
}

fn default_yaw_tolerance() -> f64 {
    0.05
}
