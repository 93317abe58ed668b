//! What neither arm nor base changes of the pose of the hand.
//!
//! Six joints take a hand to any pose. Joints that all turn about the vertical, or slide, leave it tilted as it is; and where none of
//! them goes up, at one height.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Unit, Vector3};

use crate::contact::HandStance;

/// How far a pose may be from what ties the hand, metres and radians: rounding, many times.
const ROUNDING: f64 = 1e-6;

/// The ties of a hand; by default none.
///
/// # Example
/// The hand of an arm of three vertical axes lies level, 0.8 m above the floor.
/// ```
/// use darrt_primitives::hand_ties::HandTies;
/// use nalgebra::{Isometry3, Vector3};
///
/// let ties = HandTies { up_in_tool: Some(Vector3::z_axis()), height_m: Some(0.8) };
/// assert!(ties.allow(&Isometry3::new(Vector3::new(0.3, 0.1, 0.8), Vector3::z() * 1.2)));
/// assert!(!ties.allow(&Isometry3::new(Vector3::new(0.3, 0.1, 0.9), Vector3::zeros())), "it does not rise");
/// assert!(!ties.allow(&Isometry3::new(Vector3::new(0.3, 0.1, 0.8), Vector3::y())), "nor tilt");
/// assert_eq!(ties.lifts(), false);
/// assert!((ties.pushing(false).unwrap().unwrap().lean - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HandTies {
    /// Which way is up in the tool frame, where it is always the same.
    pub up_in_tool: Option<Unit<Vector3<f64>>>,
    /// How high the origin of the tool frame is above the floor, metres, where that is always the same.
    pub height_m: Option<f64>,
}

/// Which way is up in the tool frame, a unit vector.
pub fn up_in_tool(world_from_tool: &Isometry3<f64>) -> Vector3<f64> {
    world_from_tool.rotation.inverse() * Vector3::z()
}

impl HandTies {
    /// May the hand be there, as far as its ties say?
    pub fn allow(&self, world_from_tool: &Isometry3<f64>) -> bool {
        let is_so_high = self.height_m.is_none_or(|tied| (world_from_tool.translation.z - tied).abs() <= ROUNDING);
        is_so_high && self.allow_tilt(world_from_tool)
    }

    /// The same of its tilt alone, wherever it is: also of a grasp, `object_from_tool`, of an object that stands upright.
    pub fn allow_tilt(&self, world_from_tool: &Isometry3<f64>) -> bool {
        let up = up_in_tool(world_from_tool);
        self.up_in_tool.is_none_or(|tied| (up - tied.into_inner()).norm() <= ROUNDING)
    }

    /// Can what is in the hand be lifted?
    pub fn lifts(&self) -> bool {
        self.height_m.is_none()
    }

    /// How a hand that is always tilted alike stands to push: `None` for one that is not; `Some(None)` for one that cannot push,
    /// because its fingers are not side by side or point upwards. `twin`: for a hand that may stand either way round.
    pub fn pushing(&self, twin: bool) -> Option<Option<HandStance>> {
        let up = self.up_in_tool?.into_inner();
        // The tool points along x, which is down for a hand that does not lean; z is up or down for a level one.
        if up.y.abs() > ROUNDING || up.x > ROUNDING {
            return Some(None);
        }
        let lean = up.z.abs().atan2(-up.x).min(FRAC_PI_2);
        let twin = if up.z.abs() <= ROUNDING { twin } else { up.z < 0.0 };
        Some(Some(HandStance { twin, lean }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Fingertips, PushHeights, RimContact};
    use nalgebra::{Point2, Vector2};

    /// What is said of the stance is what the hand behind an object does.
    #[test]
    fn the_stance_is_that_of_the_tilt() {
        let contact = RimContact::new(0.1, 0.08, Fingertips { beyond_tool: 0.03, half_width: 0.01 }).unwrap();
        let heights = PushHeights { tips: 0.01, top: 0.05 };
        let direction = Unit::new_normalize(Vector2::new(0.6, 0.8));
        for lean in [0.0_f64, 0.4, 1.0, std::f64::consts::FRAC_PI_2] {
            for twin in [false, true] {
                let stance = HandStance { twin, lean };
                let pose = contact.world_from_tool(&Point2::origin(), &direction, 0.7, &heights, &stance).unwrap();
                let up_in_tool = Some(Unit::new_normalize(up_in_tool(&pose)));
                let ties = HandTies { up_in_tool, height_m: Some(pose.translation.z) };
                assert!(ties.allow(&pose));
                let found = ties.pushing(twin).unwrap().unwrap();
                assert!((found.lean - lean).abs() < 1e-9 && found.twin == twin, "{found:?} {stance:?}");
                if lean > 0.0 {
                    assert_eq!(ties.pushing(!twin).unwrap().unwrap().twin, twin, "the other way round it cannot stand");
                }
            }
        }
        let tied = |up: Vector3<f64>| HandTies { up_in_tool: Some(Unit::new_normalize(up)), height_m: None };
        assert_eq!(tied(Vector3::new(0.0, 1.0, 0.0)).pushing(false), Some(None), "fingers above each other");
        assert_eq!(tied(Vector3::new(1.0, 0.0, 0.0)).pushing(false), Some(None), "it points up");
        assert_eq!(HandTies::default().pushing(false), None);
        assert!(HandTies::default().lifts());
    }
}
