//! Grasps of a whole cup or block from the side, the hand horizontal.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;
use rand::RngExt as _;

use super::footprint::{Footprint, GRID_OPENINGS, Opening, fitting_openings, sample_opening};
use super::hold::{LINE_WIDTH_M, PadContact};
use super::{Grasp, GraspFamily, GraspKind, Grip, radial_and_tangent};
use crate::error::{PrimitiveError, finite, positive, within};

/// Horizontal grasps around an upright cylinder or box that fits between the fingers.
///
/// A cylinder can be gripped from any azimuth, a box from the two ends of each direction in which it
/// is narrow enough; the fingers either way round.
#[derive(Debug, Clone, PartialEq)]
pub struct SideGrasps {
    footprint: Footprint,
    past_axis: f64,
    offset_z: f64,
    /// Half the height over which the sides are upright.
    half_upright: f64,
    grip: Grip,
    openings: Vec<Opening>,
}

impl SideGrasps {
    /// Grasps of an object of the given `footprint` and `height`, metres.
    ///
    /// The fingertips reach `past_axis` beyond the object's vertical axis; the hand is `offset_z` above
    /// the object's centre.
    ///
    /// # Errors
    /// When a length is not positive, `past_axis` is not finite, `offset_z` beyond half the height, or
    /// the object wider than the open gap in every direction.
    pub fn new(
        footprint: Footprint,
        height: f64,
        past_axis: f64,
        offset_z: f64,
        grip: Grip,
    ) -> Result<Self, PrimitiveError> {
        let half = 0.5 * positive("object height", height)?;
        let openings = fitting_openings(&footprint, &grip, GRID_OPENINGS)?;
        Ok(Self {
            footprint,
            past_axis: finite("fingertip reach past the axis", past_axis)?,
            offset_z: within("grasp height above the centre", offset_z, -half, half)?,
            half_upright: half,
            grip,
            openings,
        })
    }

    /// The same for an object whose sides are upright only farther than `end` metres from its top and bottom, as those of a
    /// capsule.
    #[must_use]
    pub fn with_round_ends(mut self, end: f64) -> Self {
        self.half_upright -= end;
        self
    }

    /// The grasp with the fingers closing along `opening`, the wrist 90 degrees to the left or right of it.
    fn grasp(&self, opening: Opening, from_right: bool, flipped: bool) -> Grasp {
        let azimuth = opening.azimuth + if from_right { -FRAC_PI_2 } else { FRAC_PI_2 };
        let (outward, tangent) = radial_and_tangent(azimuth);
        let origin = (self.grip.tip_ahead - self.past_axis) * outward + self.offset_z * Vector3::z();
        // Unflipped: the tool's z axis (finger width) points up.
        let opening_axis = if flipped { tangent } else { -tangent };
        let kind = GraspKind::Side { azimuth, flipped };
        self.grip.grasp(origin, -outward, opening_axis, opening.width, kind)
    }
}

impl GraspFamily for SideGrasps {
    fn pads(&self, grasp: &Grasp) -> Option<PadContact> {
        let GraspKind::Side { azimuth, flipped } = grasp.kind else { return None };
        let [back, tip] = self.grip.pads_along();
        let axis = tip - self.past_axis;
        let across = self.footprint.across(azimuth + FRAC_PI_2);
        // Flat pads touch a round side along the line through its axis, or, where they do not come so far, on an edge.
        let short = (back - axis).max(axis - tip).max(0.0);
        let [from, to] = match across {
            None => [axis - LINE_WIDTH_M / 2.0, axis + LINE_WIDTH_M / 2.0],
            Some(size) => [back.max(axis - size / 2.0), tip.min(axis + size / 2.0)],
        };
        let askew_rad = across.map_or((short / (grasp.closed_gap_m / 2.0)).min(1.0).asin(), |_| 0.0);
        let offset = if flipped { self.offset_z } else { -self.offset_z };
        let half = self.grip.pad_width / 2.0;
        let [bottom, top] = [offset - self.half_upright, offset + self.half_upright];
        let flat = PadContact::flat([from, bottom.max(-half)], [to, top.min(half)]);
        Some(PadContact { askew_rad, ..flat })
    }

    fn sample(&self, rng: &mut dyn rand::Rng) -> Grasp {
        let opening = sample_opening(&self.footprint, &self.openings, rng);
        let from_right = rng.random_bool(0.5);
        self.grasp(opening, from_right, rng.random_bool(0.5))
    }

    fn tool_reach_m(&self) -> f64 {
        (self.grip.tip_ahead - self.past_axis).hypot(self.offset_z)
    }

    fn grid(&self) -> Vec<Grasp> {
        let ways = [(false, false), (false, true), (true, false), (true, true)];
        self.openings
            .iter()
            .flat_map(|opening| ways.map(|(right, flipped)| self.grasp(*opening, right, flipped)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    fn wide() -> Grip {
        Grip { open_gap: 0.09, ..Grip::default() }
    }

    #[test]
    fn a_cup_is_gripped_from_all_sides_at_its_axis() {
        let cup = SideGrasps::new(Footprint::Disc { radius: 0.04 }, 0.1, 0.01, 0.02, wide());
        let grid = cup.unwrap().grid();
        assert_eq!(grid.len(), 48);
        for grasp in grid {
            let tips = grasp.object_from_tool * Point3::new(0.018, 0.0, 0.0);
            assert!((tips.coords.xy().norm() - 0.01).abs() < 1e-12);
            assert!((tips.z - 0.02).abs() < 1e-12);
            let pointing = grasp.object_from_tool * Vector3::x();
            assert!(pointing.z.abs() < 1e-12);
            // Toward the object.
            let origin = grasp.object_from_pregrasp().translation.vector;
            assert!(pointing.dot(&origin) < 0.0);
            let up = grasp.object_from_tool * Vector3::z();
            let GraspKind::Side { azimuth, flipped } = grasp.kind else {
                panic!("{:?}", grasp.kind);
            };
            assert!((up.z - if flipped { -1.0 } else { 1.0 }).abs() < 1e-12);
            let (outward, _) = radial_and_tangent(azimuth);
            assert!((outward + pointing).norm() < 1e-12);
        }
    }

    #[test]
    fn a_block_is_gripped_at_its_two_ends() {
        let footprint = Footprint::Box { size_x: 0.05, size_y: 0.2 };
        let block = SideGrasps::new(footprint, 0.08, 0.01, 0.0, wide()).unwrap();
        assert_eq!(block.grid().len(), 4);
        for grasp in block.grid() {
            let opening = grasp.object_from_tool * Vector3::y();
            assert!((opening.x.abs() - 1.0).abs() < 1e-12);
            assert_eq!(grasp.closed_gap_m, 0.05);
        }
    }

    #[test]
    fn the_fingertips_end_beyond_the_axis_or_before_it_from_either_side() {
        let footprint = Footprint::Box { size_x: 0.05, size_y: 0.2 };
        for past_axis in [0.01, -0.02] {
            let grid = SideGrasps::new(footprint, 0.08, past_axis, 0.015, wide()).unwrap().grid();
            let mut wrists = Vec::new();
            for grasp in grid {
                let tips = grasp.object_from_tool * Point3::new(0.018, 0.0, 0.0);
                let pointing = grasp.object_from_tool * Vector3::x();
                // Between the pads is the middle of the box's narrow side.
                assert!((tips.coords - pointing * past_axis - Vector3::z() * 0.015).norm() < 1e-12);
                wrists.push(-pointing.y.round());
            }
            assert_eq!(wrists, [1.0, 1.0, -1.0, -1.0]);
        }
    }

    #[test]
    fn unusable_objects_are_refused() {
        let cup = |radius, height, past, offset| {
            SideGrasps::new(Footprint::Disc { radius }, height, past, offset, wide()).is_ok()
        };
        assert!(cup(0.04, 0.1, 0.01, 0.0));
        assert!(!cup(0.05, 0.1, 0.01, 0.0));
        assert!(!cup(0.04, 0.1, 0.01, 0.06));
        assert!(!cup(0.04, 0.1, f64::NAN, 0.0));
        assert!(!cup(0.04, -0.1, 0.01, 0.0));
    }
}
