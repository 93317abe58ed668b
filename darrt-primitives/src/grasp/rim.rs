//! Grasps of a plate by its rim, where it sticks out over a table edge.
//!
//! A plate that lies flat on a table cannot be grasped: one finger would have to be inside the table.
//! Over an edge one finger goes below the rim and one above, the hand pointing at the plate's centre.
//! A tilt (wrist higher than the rim) lets the plate be set down where a level hand would collide.

use std::f64::consts::{FRAC_PI_2, TAU};

use darrt_geom::SupportSurface;
use nalgebra::{Point2, Vector2, Vector3};
use rand::RngExt as _;

use super::{Grasp, GraspFamily, GraspKind, Grip, at_least_one, azimuths, radial_and_tangent};
use crate::error::{PrimitiveError, positive, positive_below, within};
use crate::push::{Friction, GRAVITY};

/// Slack for plates that stand exactly at the limit, metres.
const ROUNDING: f64 = 1e-9;

/// The free parameters of a family of rim grasps.
#[derive(Debug, Clone, PartialEq)]
pub struct RimOptions {
    /// How far the fingertips reach in from the rim, metres (default 0.030).
    pub insertion: f64,
    /// Smallest tilt that is sampled, radians (default 0).
    pub min_tilt: f64,
    /// Largest tilt that is sampled, radians (default 45 degrees).
    pub max_tilt: f64,
    /// Tilts of the grid, radians, each within the sampled range (default 0, 30, 45 degrees).
    pub grid_tilts: Vec<f64>,
    /// Azimuths of the grid, evenly over the full turn (default 24).
    pub grid_azimuths: u32,
}

impl Default for RimOptions {
    /// Insertion 0.030; tilt 0 to 45 degrees; grid of 24 azimuths and tilts 0, 30, 45 degrees.
    fn default() -> Self {
        let tilts = [0.0_f64, 30.0, 45.0].map(f64::to_radians);
        Self {
            insertion: 0.030,
            min_tilt: 0.0,
            max_tilt: 45.0_f64.to_radians(),
            grid_tilts: tilts.to_vec(),
            grid_azimuths: 24,
        }
    }
}

/// Rim grasps of one plate: any azimuth, a range of tilts, fingers either way round.
#[derive(Debug, Clone, PartialEq)]
pub struct RimGrasps {
    radius: f64,
    height: f64,
    grip: Grip,
    options: RimOptions,
}

impl RimGrasps {
    /// Grasps of a plate, a cylinder of `radius` and `height` metres.
    ///
    /// # Errors
    /// When a length is not positive, the plate is thicker than the open gap, the insertion not below
    /// the radius, a tilt outside its range (at most 90 degrees either way), or the grid empty.
    pub fn new(radius: f64, height: f64, grip: Grip, options: RimOptions) -> Result<Self, PrimitiveError> {
        let radius = positive("plate radius", radius)?;
        grip.check(height)?;
        positive_below("fingertip insertion", options.insertion, radius)?;
        let max = within("largest tilt", options.max_tilt, -FRAC_PI_2, FRAC_PI_2)?;
        let min = within("smallest tilt", options.min_tilt, -FRAC_PI_2, max)?;
        at_least_one("azimuth grid", options.grid_azimuths)?;
        if options.grid_tilts.is_empty() {
            return Err(PrimitiveError::Empty { name: "tilt grid" });
        }
        for tilt in &options.grid_tilts {
            within("grid tilt", *tilt, min, max)?;
        }
        Ok(Self { radius, height, grip, options })
    }

    /// The grasp at `azimuth` with `tilt`, radians.
    ///
    /// The tool x axis points at the plate's axis and down by the tilt. A level hand has its tool origin in the plate's
    /// middle plane, `insertion - tip_ahead` inside the rim. Parallel pads close on a tilted plate only until the end of
    /// one and the rim of the plate on the other touch: a tilted hand closes less far and stands between these contacts.
    pub fn grasp(&self, azimuth: f64, tilt: f64, flipped: bool) -> Grasp {
        let (outward, _) = radial_and_tangent(azimuth);
        let (sin, cos) = tilt.sin_cos();
        let pointing = -cos * outward - sin * Vector3::z();
        let above = cos * Vector3::z() - sin * outward;
        let [upper, lower] = self.pad_distances(tilt);
        let rim = (self.radius - self.options.insertion + self.grip.tip_ahead) * outward;
        let origin = rim + (upper - lower) / 2.0 * above;
        let sign = if flipped { 1.0 } else { -1.0 };
        let kind = GraspKind::Rim { azimuth, tilt, flipped };
        let grasp = self.grip.grasp(origin, pointing, sign * above, upper + lower, kind);
        Grasp { open_gap_m: upper + lower + (self.grip.open_gap - self.height), ..grasp }
    }

    /// Distances of the pads, above and below, from the line along the hand through the middle of the plate, when they
    /// touch it; metres. The pads reach `tip_ahead` beyond the tool and farther back than the rim.
    fn pad_distances(&self, tilt: f64) -> [f64; 2] {
        let half = self.height / 2.0;
        // Steeper than this the pads would no longer meet the faces but the rim.
        let (sin, cos) = (tilt.abs().sin(), tilt.cos().max(0.2));
        let at_tip = self.grip.tip_ahead * sin / cos + half / cos;
        let at_rim = (self.options.insertion - self.grip.tip_ahead).max(0.0) * sin + half * cos;
        if tilt >= 0.0 { [at_tip, at_rim] } else { [at_rim, at_tip] }
    }
}

impl GraspFamily for RimGrasps {
    fn needs_overhang(&self) -> bool {
        true
    }

    fn tool_reach_m(&self) -> f64 {
        let Self { radius, height, grip, options } = self;
        let steepest = options.min_tilt.abs().max(options.max_tilt.abs());
        // Neither pad is farther from the line along the hand than this, and the tool is half as far at most.
        let [at_tip, _] = self.pad_distances(steepest);
        let at_rim = (options.insertion - grip.tip_ahead).max(0.0).hypot(height / 2.0);
        radius - options.insertion + grip.tip_ahead + at_tip.max(at_rim) / 2.0
    }

    fn sample(&self, rng: &mut dyn rand::Rng) -> Grasp {
        let azimuth = rng.random_range(0.0..TAU);
        let tilt = rng.random_range(self.options.min_tilt..=self.options.max_tilt);
        self.grasp(azimuth, tilt, rng.random_bool(0.5))
    }

    fn grid(&self) -> Vec<Grasp> {
        let tilts = &self.options.grid_tilts;
        azimuths(self.options.grid_azimuths)
            .flat_map(|azimuth| tilts.iter().map(move |tilt| (azimuth, *tilt)))
            .flat_map(|(azimuth, tilt)| [false, true].map(|f| self.grasp(azimuth, tilt, f)))
            .collect()
    }
}

/// Free distance between a support and the lower fingertip of a level rim grasp, metres.
///
/// The fingertip is the strip of width 2 `half_width` that reaches in from the rim to
/// `radius - insertion` from the plate's centre, on the side `azimuth` (world axes). `None` when any
/// of it is over the support. Independent of the height of the support and of the tilt: a hand whose
/// wrist is higher than the rim needs less overhang than a level one, a hand whose wrist is lower more.
pub fn fingertip_edge_distance(
    surface: &SupportSurface,
    center: &Point2<f64>,
    radius: f64,
    azimuth: f64,
    insertion: f64,
    half_width: f64,
) -> Option<f64> {
    let outward = Vector2::new(azimuth.cos(), azimuth.sin());
    let aside = half_width * Vector2::new(-outward.y, outward.x);
    let tip = center + (radius - insertion) * outward;
    let rim = center + radius * outward;
    let corners = [tip + aside, tip - aside, rim - aside, rim + aside];
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    let outline = ends
        .map(|(a, b)| segment_distance(surface, a, b))
        .try_fold(f64::INFINITY, |least, side| Some(least.min(side?)))?;
    // A support smaller than a fingertip could lie wholly inside the strip.
    let swallowed = surface.vertices().iter().any(|vertex| {
        let at = vertex - tip;
        (0.0..=insertion).contains(&at.dot(&outward)) && at.perp(&outward).abs() < half_width
    });
    (!swallowed).then_some(outline)
}

/// Does the rim at `azimuth` stick out over the edge far enough for the fingertips?
///
/// The fingertips, `insertion` metres in from the rim, must end at least `clearance` metres beside
/// the support. On a straight edge with the azimuth normal to it this is overhang >= insertion +
/// clearance. The plate's `center` and the azimuth are in world axes.
pub fn rim_is_graspable(
    surface: &SupportSurface,
    center: &Point2<f64>,
    radius: f64,
    azimuth: f64,
    insertion: f64,
    clearance: f64,
) -> bool {
    fingertip_edge_distance(surface, center, radius, azimuth, insertion, 0.0)
        .is_some_and(|distance| distance >= clearance - ROUNDING)
}

/// Can [`rim_is_graspable`] say yes for any azimuth? It never does where this says no: the fingertip would have to be
/// farther from the centre than the nearest edge, by the clearance.
pub fn rim_overhangs(
    surface: &SupportSurface,
    center: &Point2<f64>,
    radius: f64,
    insertion: f64,
    clearance: f64,
) -> bool {
    surface.depth(center) <= radius - insertion - clearance + ROUNDING
}

/// Distance between the segment `a`-`b` and the support, `None` when they touch.
fn segment_distance(surface: &SupportSurface, a: &Point2<f64>, b: &Point2<f64>) -> Option<f64> {
    let outside = (-surface.depth(a)).min(-surface.depth(b));
    if outside <= 0.0 {
        return None;
    }
    let vertices = surface.vertices();
    let mut least = outside;
    for (c, d) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
        if segments_cross(a, b, c, d) {
            return None;
        }
        least = least.min(point_segment_distance(c, a, b));
    }
    Some(least)
}

/// Do the open segments cross?
fn segments_cross(a: &Point2<f64>, b: &Point2<f64>, c: &Point2<f64>, d: &Point2<f64>) -> bool {
    let side = |p: &Point2<f64>, q: &Point2<f64>, r: &Point2<f64>| (q - p).perp(&(r - p));
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Distance of `p` from the segment `a`-`b` (which may be a point).
fn point_segment_distance(p: &Point2<f64>, a: &Point2<f64>, b: &Point2<f64>) -> f64 {
    let along = b - a;
    let length = along.norm_squared();
    let t = if length > 0.0 { ((p - a).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + t * along)).norm()
}

/// How well a rim grasp holds; a report, never a constraint of planning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimHold {
    /// Are the two pads and the rim in planar force closure: |tilt + slope| <= atan mu?
    pub force_closure: bool,
    /// Largest |tilt| of force closure on a flat rim, radians: atan mu.
    pub tilt_limit: f64,
    /// Moment of the plate's weight about the pads of a level hand, N m.
    pub moment: f64,
    /// Grip force whose couple over the pad length holds that moment, N.
    pub grip_force: f64,
}

/// How well the pads hold a plate of `mass` kilograms at a lever of `lever` metres (plate centre to
/// pad centre) with pads of `pad_length` metres.
///
/// # Errors
/// When a number is not finite and positive, or `tilt` is outside 90 degrees either way.
pub fn rim_hold(
    tilt: f64,
    friction: Friction,
    mass: f64,
    lever: f64,
    pad_length: f64,
) -> Result<RimHold, PrimitiveError> {
    let tilt = within("tilt", tilt, -FRAC_PI_2, FRAC_PI_2)?;
    let pad = positive("pad length", pad_length)?;
    let moment = positive("mass", mass)? * GRAVITY * positive("lever", lever)?;
    Ok(RimHold {
        force_closure: tilt.abs() <= friction.angle(),
        tilt_limit: friction.angle(),
        moment,
        grip_force: 2.0 * moment / pad,
    })
}

#[cfg(test)]
mod tests;
