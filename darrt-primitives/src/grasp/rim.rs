//! Grasps of a plate by its rim, where it sticks out over a table edge.
//!
//! A plate that lies flat on a table cannot be grasped: one finger would have to be inside the table.
//! Over an edge one finger goes below the rim and one above, the hand pointing at the plate's centre, tilted as the rim is:
//! pads that are not flush with it turn the plate as soon as the table lets go of it.

use std::f64::consts::{FRAC_PI_4, TAU};

use darrt_geom::SupportSurface;
use nalgebra::{Point2, Vector2, Vector3};
use rand::RngExt as _;

use super::hold::{FLUSH_RAD, PadContact};
use super::{Grasp, GraspFamily, GraspKind, Grip, at_least_one, azimuths, radial_and_tangent};
use crate::error::{PrimitiveError, positive, positive_below, within};

/// Slack for plates that stand exactly at the limit, metres.
const ROUNDING: f64 = 1e-9;

/// The part of a plate that the pads close on: a ring of even thickness that rises outward. Its outer end is square to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rim {
    /// Radius of the plate, metres.
    radius: f64,
    /// Height of the uppermost point above the plate's centre, metres.
    top: f64,
    /// Rise outward, radians.
    slope: f64,
    /// From its outer end inward along its faces, metres.
    width: f64,
    /// Metres.
    thickness: f64,
}

impl Rim {
    /// The rim of a flat disc of `radius` and `height` that reaches `width` inward, metres.
    ///
    /// # Errors
    /// When a length is not positive, or `width` is above the radius.
    pub fn level(radius: f64, height: f64, width: f64) -> Result<Self, PrimitiveError> {
        let height = positive("plate thickness", height)?;
        Self::sloping(radius, height / 2.0, 0.0, width, height)
    }

    /// A rim that rises outward by `slope` radians in `[0, pi/4]`, the uppermost point of the plate being `top` above its
    /// centre; metres. Its lower edge is farthest from the centre, at `radius`.
    ///
    /// # Errors
    /// When a length is not positive, `slope` is out of range, or `width` above the radius.
    pub fn sloping(radius: f64, top: f64, slope: f64, width: f64, thickness: f64) -> Result<Self, PrimitiveError> {
        let radius = positive("plate radius", radius)?;
        positive("rim width", width)?;
        Ok(Self {
            radius,
            top: positive("plate top", top)?,
            slope: within("rim slope", slope, 0.0, FRAC_PI_4)?,
            width: within("rim width", width, 0.0, radius)?,
            thickness: positive("rim thickness", thickness)?,
        })
    }

    /// The middle of the outer end, as seen along the azimuth `outward`.
    fn outer_end(&self, outward: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = self.slope.sin_cos();
        let half = self.thickness / 2.0;
        (self.radius - half * sin) * outward + (self.top - half * cos) * Vector3::z()
    }
}

/// The free parameters of a family of rim grasps.
#[derive(Debug, Clone, PartialEq)]
pub struct RimOptions {
    /// How far the fingertips reach in from the rim, along it, metres (default 0.040: pads of 0.036 lie on it whole).
    pub insertion: f64,
    /// Tilts of the hand, radians, positive when the wrist is higher than the rim; each within [`FLUSH_RAD`] of the slope of
    /// the rim, which is the only one by default (when empty). Samples are drawn from the least to the largest.
    pub tilts: Vec<f64>,
    /// Azimuths of the grid, evenly over the full turn (default 24).
    pub grid_azimuths: u32,
}

impl Default for RimOptions {
    /// Insertion 0.040; flush; grid of 24 azimuths.
    fn default() -> Self {
        Self { insertion: 0.040, tilts: Vec::new(), grid_azimuths: 24 }
    }
}

/// Rim grasps of one plate: any azimuth, fingers either way round.
#[derive(Debug, Clone, PartialEq)]
pub struct RimGrasps {
    rim: Rim,
    grip: Grip,
    options: RimOptions,
}

impl RimGrasps {
    /// Grasps of a plate by its `rim`.
    ///
    /// # Errors
    /// When the rim is thicker than the open gap, the insertion not below the radius, a tilt more than [`FLUSH_RAD`] from
    /// the slope, or the grid empty.
    pub fn new(rim: Rim, grip: Grip, mut options: RimOptions) -> Result<Self, PrimitiveError> {
        grip.check(rim.thickness)?;
        positive_below("fingertip insertion", options.insertion, rim.radius)?;
        at_least_one("azimuth grid", options.grid_azimuths)?;
        for tilt in &options.tilts {
            within("tilt of the hand", *tilt, rim.slope - FLUSH_RAD - ROUNDING, rim.slope + FLUSH_RAD + ROUNDING)?;
        }
        if options.tilts.is_empty() {
            options.tilts.push(rim.slope);
        }
        Ok(Self { rim, grip, options })
    }

    /// The grasp at `azimuth` with `tilt`, radians.
    ///
    /// The tool x axis points at the plate's axis and down by the tilt. A flush hand has its tool origin in the middle plane
    /// of the rim, `insertion - tip_ahead` inside its end. Parallel pads close on a rim that is askew only until the end of
    /// one and the end of the rim on the other touch: such a hand closes less far and stands between these contacts.
    pub fn grasp(&self, azimuth: f64, tilt: f64, flipped: bool) -> Grasp {
        let (outward, _) = radial_and_tangent(azimuth);
        let directions = |tilt: f64| {
            let (sin, cos) = tilt.sin_cos();
            (-cos * outward - sin * Vector3::z(), cos * Vector3::z() - sin * outward)
        };
        let (inward, _) = directions(self.rim.slope);
        let (pointing, above) = directions(tilt);
        let [upper, lower] = self.pad_distances(tilt - self.rim.slope);
        let inside = self.rim.outer_end(&outward) + (self.options.insertion - self.grip.tip_ahead) * inward;
        let origin = inside + (upper - lower) / 2.0 * above;
        let sign = if flipped { 1.0 } else { -1.0 };
        let kind = GraspKind::Rim { azimuth, tilt, flipped };
        let grasp = self.grip.grasp(origin, pointing, sign * above, upper + lower, kind);
        Grasp { open_gap_m: upper + lower + (self.grip.open_gap - self.rim.thickness), ..grasp }
    }

    /// Distances of the pads, above and below, from the line along the hand through the middle of the rim, when they touch
    /// it and the hand is tilted against it by `askew`; metres. The pads reach `tip_ahead` beyond the tool and farther back
    /// than the rim.
    fn pad_distances(&self, askew: f64) -> [f64; 2] {
        let half = self.rim.thickness / 2.0;
        // Steeper than this the pads would no longer meet the faces but the end of the rim.
        let (sin, cos) = (askew.abs().sin(), askew.cos().max(0.2));
        let at_tip = self.grip.tip_ahead * sin / cos + half / cos;
        let at_rim = (self.options.insertion - self.grip.tip_ahead).max(0.0) * sin + half * cos;
        if askew >= 0.0 { [at_tip, at_rim] } else { [at_rim, at_tip] }
    }

    /// The tilts of the options, least and largest.
    fn tilt_range(&self) -> [f64; 2] {
        let tilts = &self.options.tilts;
        tilts.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], tilt| [low.min(*tilt), high.max(*tilt)])
    }
}

impl GraspFamily for RimGrasps {
    fn pads(&self, grasp: &Grasp) -> Option<PadContact> {
        let GraspKind::Rim { tilt, .. } = grasp.kind else { return None };
        let [back, tip] = self.grip.pads_along();
        let end = tip - self.options.insertion;
        let half = self.grip.pad_width / 2.0;
        let flat = PadContact::flat([back.max(end), -half], [tip.min(end + self.rim.width), half]);
        Some(PadContact { askew_rad: (tilt - self.rim.slope).abs(), ..flat })
    }

    fn needs_overhang(&self) -> bool {
        true
    }

    fn tool_reach_m(&self) -> f64 {
        let [low, high] = self.tilt_range();
        let askew = (low - self.rim.slope).abs().max((high - self.rim.slope).abs());
        // The tool is half the difference of the pads' distances from the middle of the rim.
        let [upper, lower] = self.pad_distances(askew);
        let flush = self.grasp(0.0, self.rim.slope, false);
        flush.object_from_tool.translation.vector.norm() + (upper - lower).abs() / 2.0
    }

    fn sample(&self, rng: &mut dyn rand::Rng) -> Grasp {
        let azimuth = rng.random_range(0.0..TAU);
        let [low, high] = self.tilt_range();
        self.grasp(azimuth, rng.random_range(low..=high), rng.random_bool(0.5))
    }

    fn grid(&self) -> Vec<Grasp> {
        let tilts = &self.options.tilts;
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
    let swallowed = surface.vertices().any(|vertex| {
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
    let mut least = outside;
    for edge in surface.edges() {
        if segments_cross(a, b, &edge.start, &edge.end) {
            return None;
        }
        least = least.min(point_segment_distance(&edge.start, a, b));
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

#[cfg(test)]
mod tests;
