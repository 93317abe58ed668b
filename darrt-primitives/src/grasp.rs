//! Grasps: rigid poses of the hand relative to an object.
//!
//! A grasp family produces grasps of one object, both drawn at random and on a fixed grid. Whether a
//! grasp can be reached, and whether hand and table collide, is decided elsewhere.
//!
//! | family | object | file |
//! |---|---|---|
//! | [`rim::RimGrasps`] | plate sticking out over a table edge | [`rim`] |
//! | [`overhead::WallGrasps`] | bowl or cup, by its wall, from above | [`overhead`] |
//! | [`overhead::OverheadGrasps`] | small thing, as a whole, from above | [`overhead`] |
//! | [`side::SideGrasps`] | cup or block, as a whole, from the side | [`side`] |
//!
//! [`footprint::Footprint`] is the outline the last two close around. Whether a grasp can bear the weight is asked of
//! [`mod@hold`].
//!
//! Frames: the object frame sits at the centre of the object's shape, z up along the axis of a round
//! object. The tool frame has x along the direction the hand points and approaches, y along the
//! finger opening, z along the finger width; its origin lies midway between the fingers.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use self::hold::PadContact;
use crate::error::{PrimitiveError, positive, positive_below, within};
use crate::length_range::LengthRange;

pub mod footprint;
pub mod hold;
pub mod overhead;
pub mod rim;
pub mod side;

/// Which kind of grasp, with the parameters that tell grasps of one family apart.
///
/// Angles in radians. `flipped` is the same grasp with the two fingers exchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum GraspKind {
    /// One finger above, one below the rim of a plate.
    Rim {
        /// Direction from the plate's centre to the wrist, about the object's z.
        azimuth: f64,
        /// Downward pitch of the hand: positive when the wrist is higher than the rim.
        tilt: f64,
        /// Fingers exchanged.
        flipped: bool,
    },
    /// One finger inside, one outside the wall of a bowl, from above.
    Wall {
        /// Direction from the bowl's centre to the gripped piece of wall.
        azimuth: f64,
        /// Lean of the hand along the tangent: positive when the fingers point counter-clockwise.
        lean: f64,
        /// Fingers exchanged.
        flipped: bool,
    },
    /// Both fingers outside the object, from above.
    Overhead {
        /// Direction of the finger opening, about the object's z.
        azimuth: f64,
    },
    /// Both fingers outside the object, hand horizontal.
    Side {
        /// Direction from the object's centre to the wrist, about the object's z.
        azimuth: f64,
        /// Fingers exchanged.
        flipped: bool,
    },
}

/// A rigid hold of an object by a two-finger hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grasp {
    /// Tool pose in the object frame.
    pub object_from_tool: Isometry3<f64>,
    /// Finger gap while approaching and retreating, metres.
    pub open_gap_m: f64,
    /// Finger gap while holding, metres: the thickness of what is held.
    pub closed_gap_m: f64,
    /// Length of the straight approach along the tool's x axis.
    pub approach_m: LengthRange,
    /// What kind of grasp it is.
    pub kind: GraspKind,
}

impl Grasp {
    /// Tool pose in the object frame where the straight approach begins if it is as long as wanted.
    pub fn object_from_pregrasp(&self) -> Isometry3<f64> {
        self.object_from_tool * Translation3::new(-self.approach_m.wanted_m(), 0.0, 0.0)
    }

    /// Tool pose in the world for an object at `world_from_object`.
    pub fn world_from_tool(&self, world_from_object: &Isometry3<f64>) -> Isometry3<f64> {
        world_from_object * self.object_from_tool
    }

    /// Pregrasp tool pose in the world for an object at `world_from_object`.
    pub fn world_from_pregrasp(&self, world_from_object: &Isometry3<f64>) -> Isometry3<f64> {
        world_from_object * self.object_from_pregrasp()
    }

    /// Pose of the held object for a tool at `world_from_tool`.
    pub fn world_from_object(&self, world_from_tool: &Isometry3<f64>) -> Isometry3<f64> {
        world_from_tool * self.object_from_tool.inverse()
    }
}

/// A set of grasps of one object.
///
/// # Laws
/// - [`Self::grid`] is never empty and the same on every call.
/// - Every grasp has `closed_gap_m < open_gap_m`, both positive, a finite pose and a positive approach.
/// - No grasp has its tool farther from the origin of the object frame than [`Self::tool_reach_m`].
///
/// ```
/// use darrt_primitives::grasp::{Grasp, GraspFamily};
///
/// /// Exactly one grasp.
/// struct Only(Grasp);
///
/// impl GraspFamily for Only {
///     fn sample(&self, _rng: &mut dyn rand::Rng) -> Grasp {
///         self.0
///     }
///     fn grid(&self) -> Vec<Grasp> {
///         vec![self.0]
///     }
/// }
/// ```
pub trait GraspFamily: Send + Sync {
    /// A grasp drawn at random from the whole family.
    fn sample(&self, rng: &mut dyn rand::Rng) -> Grasp;

    /// A fixed selection that covers the family evenly, in a fixed order.
    fn grid(&self) -> Vec<Grasp>;

    /// How the closed pads lie on the object in a grasp of the family; `None` (the default): not known, and taken to hold
    /// whatever the object weighs.
    fn pads(&self, _grasp: &Grasp) -> Option<PadContact> {
        None
    }

    /// Does every grasp of the family need the rim to stick out over the edge of the support (all of kind
    /// [`GraspKind::Rim`])? Where it does not, none of them is drawn.
    fn needs_overhang(&self) -> bool {
        false
    }

    /// Bound on the distance of the tool from the origin of the object frame in every grasp of the family, metres, at least
    /// 0; infinite if it is not known.
    fn tool_reach_m(&self) -> f64 {
        f64::INFINITY
    }
}

/// The hand's side of a grasp: what is common to all grasps of a family. Lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grip {
    /// Finger gap while approaching (default 0.05).
    pub open_gap: f64,
    /// How far the fingertips reach ahead of the tool origin while holding (default 0.018).
    pub tip_ahead: f64,
    /// Length of the straight approach (default 0.02 to 0.10).
    pub approach: LengthRange,
    /// Length of a pad from the fingertip back (default 0.036).
    pub pad_length: f64,
    /// Width of a pad (default 0.0226).
    pub pad_width: f64,
}

impl Default for Grip {
    /// Open gap 0.05, fingertips 0.018 ahead of the tool, approach 0.02 to 0.10, pads 0.036 by 0.0226: a common parallel
    /// gripper.
    fn default() -> Self {
        let approach = LengthRange::constant(0.02, 0.10);
        Self { open_gap: 0.05, tip_ahead: 0.018, approach, pad_length: 0.036, pad_width: 0.0226 }
    }
}

impl Grip {
    /// Checks the lengths against the `thickness` to be held.
    ///
    /// # Errors
    /// When a length is not positive (`tip_ahead` may be zero) or `thickness` not below the open gap.
    fn check(&self, thickness: f64) -> Result<(), PrimitiveError> {
        positive("open finger gap", self.open_gap)?;
        positive("grasp approach", self.approach.wanted_m())?;
        positive("pad length", self.pad_length)?;
        positive("pad width", self.pad_width)?;
        within("fingertip ahead of the tool", self.tip_ahead, 0.0, f64::MAX)?;
        positive_below("held thickness", thickness, self.open_gap)?;
        Ok(())
    }

    /// Where the pads begin and end along the tool's x axis.
    fn pads_along(&self) -> [f64; 2] {
        [self.tip_ahead - self.pad_length, self.tip_ahead]
    }

    /// The grasp with the tool at `origin`, pointing along `pointing`, fingers opening along `opening`.
    fn grasp(
        &self,
        origin: Vector3<f64>,
        pointing: Vector3<f64>,
        opening: Vector3<f64>,
        closed_gap_m: f64,
        kind: GraspKind,
    ) -> Grasp {
        let axes = Matrix3::from_columns(&[pointing, opening, pointing.cross(&opening)]);
        let rotation = Rotation3::from_matrix_unchecked(axes);
        Grasp {
            object_from_tool: Isometry3::from_parts(origin.into(), UnitQuaternion::from_rotation_matrix(&rotation)),
            open_gap_m: self.open_gap,
            closed_gap_m,
            approach_m: self.approach,
            kind,
        }
    }
}

/// The horizontal unit vector at `azimuth`, and the one 90 degrees to its left.
fn radial_and_tangent(azimuth: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (sin, cos) = azimuth.sin_cos();
    (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0))
}

/// `count` azimuths spread evenly over the full turn, starting at 0.
fn azimuths(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| std::f64::consts::TAU * f64::from(i) / f64::from(count))
}

/// `count` when it is not zero.
fn at_least_one(name: &'static str, count: u32) -> Result<u32, PrimitiveError> {
    if count == 0 { Err(PrimitiveError::Empty { name }) } else { Ok(count) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    /// Every stock family, each with an object of its own.
    fn families() -> Vec<Box<dyn GraspFamily>> {
        let grip = Grip::default();
        let wide = Grip { open_gap: 0.09, ..grip };
        let block = footprint::Footprint::Box { size_x: 0.05, size_y: 0.2 };
        let cup = footprint::Footprint::Disc { radius: 0.04 };
        let (rim, wall) = (rim::RimOptions::default(), overhead::WallOptions::default());
        let (flat, sloping) = (rim::Rim::level(0.14, 0.02, 0.14), rim::Rim::sloping(0.14, 0.012, 0.25, 0.045, 0.005));
        let askew = rim::RimOptions { tilts: vec![0.24, 0.26], ..rim.clone() };
        vec![
            Box::new(rim::RimGrasps::new(flat.unwrap(), grip, rim).unwrap()),
            Box::new(rim::RimGrasps::new(sloping.unwrap(), grip, askew).unwrap()),
            Box::new(overhead::WallGrasps::new(0.075, 0.065, 0.005, grip, wall).unwrap()),
            Box::new(overhead::OverheadGrasps::new(block, 0.08, 0.03, wide).unwrap()),
            Box::new(overhead::OverheadGrasps::new(cup, 0.08, 0.03, wide).unwrap()),
            Box::new(side::SideGrasps::new(block, 0.08, 0.01, 0.0, wide).unwrap()),
            Box::new(side::SideGrasps::new(cup, 0.08, 0.01, 0.0, wide).unwrap()),
        ]
    }

    fn check_law(grasp: &Grasp) {
        assert!(0.0 < grasp.closed_gap_m && grasp.closed_gap_m < grasp.open_gap_m);
        assert!(grasp.approach_m.wanted_m() > 0.0);
        let matrix = grasp.object_from_tool.to_homogeneous();
        assert!(matrix.iter().all(|x| x.is_finite()));
        let turn = grasp.object_from_tool.rotation.to_rotation_matrix();
        assert!((turn.matrix().determinant() - 1.0).abs() < 1e-12);
        let back = grasp.object_from_pregrasp().inverse() * grasp.object_from_tool;
        let expected = Vector3::new(grasp.approach_m.wanted_m(), 0.0, 0.0);
        assert!((back.translation.vector - expected).norm() < 1e-12);
    }

    #[test]
    fn every_family_obeys_the_laws() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
        for family in families() {
            let grid = family.grid();
            let reach_m = family.tool_reach_m();
            let gap_m = |grasp: &Grasp| grasp.object_from_tool.translation.vector.norm();
            let farthest_m = grid.iter().map(gap_m).fold(0.0, f64::max);
            assert!(farthest_m <= reach_m + 1e-12 && reach_m < farthest_m + 0.02, "{farthest_m} {reach_m}");
            assert!(!grid.is_empty());
            assert_eq!(grid, family.grid());
            grid.iter().for_each(check_law);
            for (i, grasp) in grid.iter().enumerate() {
                assert!(!grid.iter().take(i).any(|other| other == grasp));
            }
            for _ in 0..50 {
                let grasp = family.sample(&mut rng);
                check_law(&grasp);
                assert!(gap_m(&grasp) <= reach_m + 1e-12, "{grasp:?}");
            }
        }
    }

    #[test]
    fn samples_repeat_with_the_seed() {
        for family in families() {
            let draw = |seed| family.sample(&mut Xoshiro256PlusPlus::seed_from_u64(seed));
            assert_eq!(draw(3), draw(3));
        }
    }

    #[test]
    fn object_and_tool_poses_are_inverse() {
        for family in families() {
            let world_from_object = Isometry3::new(Vector3::new(0.3, -1.0, 0.8), Vector3::z() * 0.7);
            for grasp in family.grid() {
                let back = grasp.world_from_object(&grasp.world_from_tool(&world_from_object));
                assert!((back.translation.vector - world_from_object.translation.vector).norm() < 1e-12);
                assert!(back.rotation.angle_to(&world_from_object.rotation) < 1e-7);
            }
        }
    }
    #[test]
    fn the_pregrasp_lies_straight_behind_the_hand() {
        let world_from_object = Isometry3::new(Vector3::new(0.3, -1.0, 0.8), Vector3::z() * 0.7);
        for grasp in families().iter().flat_map(|family| family.grid()) {
            let before = grasp.world_from_pregrasp(&world_from_object);
            let at = grasp.world_from_tool(&world_from_object);
            let ahead = at.translation.vector - before.translation.vector;
            assert!((ahead - at.rotation * Vector3::x() * grasp.approach_m.wanted_m()).norm() < 1e-12);
            assert!(before.rotation.angle_to(&at.rotation) < 1e-7);
        }
    }

    #[test]
    fn a_grip_that_cannot_be_is_refused_by_name() {
        type Change = fn(&mut Grip);
        let check = |change: Change, thickness| {
            let mut grip = Grip::default();
            change(&mut grip);
            grip.check(thickness).map_err(|why| why.to_string())
        };
        assert_eq!(check(|_| (), 0.02), Ok(()));
        assert_eq!(check(|g| g.tip_ahead = 0.0, 0.02), Ok(()), "the tool may end with the fingertips");
        let refused: [(Change, f64, &str); 8] = [
            (|g| g.open_gap = 0.0, 0.02, "open finger gap must be above 0, found 0"),
            (|g| g.open_gap = f64::INFINITY, 0.02, "open finger gap must be finite, found inf"),
            (|g| g.approach = LengthRange::new(0.0, 0.0).unwrap(), 0.02, "grasp approach must be above 0, found 0"),
            (|g| g.pad_length = 0.0, 0.02, "pad length must be above 0, found 0"),
            (|g| g.pad_width = f64::NAN, 0.02, "pad width must be finite, found NaN"),
            (|g| g.tip_ahead = f64::NAN, 0.02, "fingertip ahead of the tool must be finite, found NaN"),
            (|_| (), 0.0, "held thickness must be above 0, found 0"),
            (|_| (), 0.05, "held thickness must be below 0.05, found 0.05"),
        ];
        for (change, thickness, why) in refused {
            assert_eq!(check(change, thickness), Err(why.to_owned()));
        }
    }
}
