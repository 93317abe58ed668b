//! Grasps from above: a bowl by its wall, a small thing as a whole.

use std::f64::consts::{FRAC_PI_3, PI, TAU};

use nalgebra::Vector3;
use rand::RngExt as _;

use super::footprint::{Footprint, GRID_OPENINGS, Opening, fitting_openings, sample_opening};
use super::hold::{LINE_WIDTH_M, PadContact};
use super::{Grasp, GraspFamily, GraspKind, Grip, at_least_one, azimuths, radial_and_tangent};
use crate::error::{PrimitiveError, positive, positive_below, within};
use crate::push::limit_surface::PressureConstant;

/// The free parameters of a family of wall grasps. Lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct WallOptions {
    /// How far below the upper rim the fingertips end (default 0.03).
    pub depth: f64,
    /// How far inside the outer radius the middle between the fingers lies; `None` is the middle of
    /// the wall (default).
    pub inset: Option<f64>,
    /// Largest lean of the hand along the tangent, either way, radians (default 30 degrees).
    pub max_lean: f64,
    /// Leans of the grid, radians, each within the sampled range (default 0 and 20 degrees either way).
    pub grid_leans: Vec<f64>,
    /// Azimuths of the grid, evenly over the full turn (default 24).
    pub grid_azimuths: u32,
}

impl Default for WallOptions {
    /// Fingertips 0.03 below the rim, centred on the wall, leaning up to 30 degrees; 24 x 3 grid.
    fn default() -> Self {
        let leans = [0.0_f64, -20.0, 20.0].map(f64::to_radians);
        Self {
            depth: 0.03,
            inset: None,
            max_lean: 30.0_f64.to_radians(),
            grid_leans: leans.to_vec(),
            grid_azimuths: 24,
        }
    }
}

/// Grasps of a round bowl by its wall: one finger inside, one outside, the hand pointing down.
///
/// A bowl modelled as a solid cylinder must be ignored by the fingers when collisions are checked.
#[derive(Debug, Clone, PartialEq)]
pub struct WallGrasps {
    radius: f64,
    height: f64,
    wall: f64,
    grip: Grip,
    options: WallOptions,
}

impl WallGrasps {
    /// Grasps of a bowl of outer `radius`, `height` and `wall` thickness, metres.
    ///
    /// # Errors
    /// When a length is not positive, the wall is thicker than the open gap or not below the radius,
    /// the depth above the height, the inset not in `[0, radius]`, a lean outside its range (at most 60
    /// degrees), or the grid empty.
    pub fn new(radius: f64, height: f64, wall: f64, grip: Grip, options: WallOptions) -> Result<Self, PrimitiveError> {
        let radius = positive("bowl radius", radius)?;
        let height = positive("bowl height", height)?;
        let wall = positive_below("wall thickness", wall, radius)?;
        grip.check(wall)?;
        positive("fingertip depth", options.depth)?;
        within("fingertip depth", options.depth, 0.0, height)?;
        if let Some(inset) = options.inset {
            within("grip inset", inset, 0.0, radius)?;
        }
        let max = within("largest lean", options.max_lean, 0.0, FRAC_PI_3)?;
        at_least_one("azimuth grid", options.grid_azimuths)?;
        if options.grid_leans.is_empty() {
            return Err(PrimitiveError::Empty { name: "lean grid" });
        }
        for lean in &options.grid_leans {
            within("grid lean", *lean, -max, max)?;
        }
        Ok(Self { radius, height, wall, grip, options })
    }

    /// The grasp at `azimuth` with `lean` along the tangent, radians.
    ///
    /// The fingertips end `depth` below the rim for every lean; the tool origin is `tip_ahead` behind
    /// them. The finger axis is radial, the unflipped tool's y axis pointing inward.
    pub fn grasp(&self, azimuth: f64, lean: f64, flipped: bool) -> Grasp {
        let (outward, tangent) = radial_and_tangent(azimuth);
        let (sin, cos) = lean.sin_cos();
        let pointing = sin * tangent - cos * Vector3::z();
        let inset = self.options.inset.unwrap_or(0.5 * self.wall);
        let tips = (self.radius - inset) * outward + (0.5 * self.height - self.options.depth) * Vector3::z();
        let origin = tips - self.grip.tip_ahead * pointing;
        let opening = if flipped { outward } else { -outward };
        let kind = GraspKind::Wall { azimuth, lean, flipped };
        self.grip.grasp(origin, pointing, opening, self.wall, kind)
    }
}

impl GraspFamily for WallGrasps {
    /// The outer pad lies along a line, the inner one, in the hollow, on its two edges: across, only the inner pressure can
    /// shift, and both pads resist turning at least as a line does.
    fn pads(&self, grasp: &Grasp) -> Option<PadContact> {
        let GraspKind::Wall { lean, .. } = grasp.kind else { return None };
        let [back, tip] = self.grip.pads_along();
        let from = back.max(tip - self.options.depth / lean.cos());
        let half_width = self.grip.pad_width / 4.0;
        let flat = PadContact::flat([from, -half_width], [tip, half_width]);
        let [length, _] = flat.size_m;
        Some(PadContact { spin_arm_m: PressureConstant::line(length).map_or(0.0, PressureConstant::meters), ..flat })
    }

    fn sample(&self, rng: &mut dyn rand::Rng) -> Grasp {
        let azimuth = rng.random_range(0.0..TAU);
        let lean = rng.random_range(-self.options.max_lean..=self.options.max_lean);
        self.grasp(azimuth, lean, rng.random_bool(0.5))
    }

    fn tool_reach_m(&self) -> f64 {
        let inset = self.options.inset.unwrap_or(0.5 * self.wall);
        (self.radius - inset).hypot(0.5 * self.height - self.options.depth) + self.grip.tip_ahead
    }

    fn grid(&self) -> Vec<Grasp> {
        let leans = &self.options.grid_leans;
        azimuths(self.options.grid_azimuths)
            .flat_map(|azimuth| leans.iter().map(move |lean| (azimuth, *lean)))
            .flat_map(|(azimuth, lean)| [false, true].map(|f| self.grasp(azimuth, lean, f)))
            .collect()
    }
}

/// Grasps of a whole small object from straight above.
#[derive(Debug, Clone, PartialEq)]
pub struct OverheadGrasps {
    footprint: Footprint,
    tool_height: f64,
    depth: f64,
    /// Between which depths below the top the sides are upright.
    upright: [f64; 2],
    grip: Grip,
    openings: Vec<Opening>,
}

impl OverheadGrasps {
    /// Grasps of an object of the given `footprint` and `height`, fingertips `depth` below its top, metres.
    ///
    /// # Errors
    /// When a length is not positive, `depth` is above `height`, or the object is wider than the open
    /// gap in every direction.
    pub fn new(footprint: Footprint, height: f64, depth: f64, grip: Grip) -> Result<Self, PrimitiveError> {
        let height = positive("object height", height)?;
        positive("fingertip depth", depth)?;
        within("fingertip depth", depth, 0.0, height)?;
        let openings = fitting_openings(&footprint, &grip, GRID_OPENINGS)?;
        let tool_height = 0.5 * height - depth + grip.tip_ahead;
        Ok(Self { footprint, tool_height, depth, upright: [0.0, height], grip, openings })
    }

    /// The same for an object whose sides are upright only farther than `end` metres from its top and bottom, as those of a
    /// capsule.
    #[must_use]
    pub fn with_round_ends(mut self, end: f64) -> Self {
        let [top, bottom] = self.upright;
        self.upright = [top + end, bottom - end];
        self
    }

    /// The grasp with the tool's y axis at the azimuth of `opening`, or turned half a turn.
    fn grasp(&self, opening: Opening, turned: bool) -> Grasp {
        let azimuth = opening.azimuth + if turned { PI } else { 0.0 };
        let (radial, _) = radial_and_tangent(azimuth);
        let origin = self.tool_height * Vector3::z();
        let kind = GraspKind::Overhead { azimuth };
        self.grip.grasp(origin, -Vector3::z(), radial, opening.width, kind)
    }
}

impl GraspFamily for OverheadGrasps {
    fn pads(&self, grasp: &Grasp) -> Option<PadContact> {
        let GraspKind::Overhead { azimuth } = grasp.kind else { return None };
        let [back, tip] = self.grip.pads_along();
        let [from, to] = self.upright.map(|depth| tip - (self.depth - depth));
        let half = self.footprint.across(azimuth).map_or(LINE_WIDTH_M, |size| size.min(self.grip.pad_width)) / 2.0;
        Some(PadContact::flat([from.max(back), -half], [to.min(tip), half]))
    }

    fn sample(&self, rng: &mut dyn rand::Rng) -> Grasp {
        let opening = sample_opening(&self.footprint, &self.openings, rng);
        self.grasp(opening, rng.random_bool(0.5))
    }

    fn tool_reach_m(&self) -> f64 {
        self.tool_height.abs()
    }

    fn grid(&self) -> Vec<Grasp> {
        self.openings.iter().flat_map(|opening| [false, true].map(|turned| self.grasp(*opening, turned))).collect()
    }
}

#[cfg(test)]
mod tests;
