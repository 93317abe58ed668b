//! How near to an edge an object may be left: at least the margin of the settings, unless its goal lies nearer.

use darrt_core::state::ObjectId;
use nalgebra::Point2;

use crate::manipulator::Manipulator;
use crate::mode::SurfaceId;
use crate::tabletop::Tabletop;

/// Rounding that is forgiven in a place and in its distance from an edge, metres.
const ROUNDING_M: f64 = 1e-6;

/// A place that a goal names and that lies nearer to an edge than objects are left elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Brink {
    /// Of which surface.
    pub surface: SurfaceId,
    /// Corners of the place, world x and y, metres; the same one twice for a single point.
    pub min: Point2<f64>,
    /// See [`Brink::min`].
    pub max: Point2<f64>,
    /// How far inside the edge an object must stay there, metres; less than the margin.
    pub margin_m: f64,
}

impl Brink {
    fn covers(&self, surface: SurfaceId, at: &Point2<f64>) -> bool {
        let is_between = |value: f64, low: f64, high: f64| (low - ROUNDING_M..=high + ROUNDING_M).contains(&value);
        surface == self.surface && is_between(at.x, self.min.x, self.max.x) && is_between(at.y, self.min.y, self.max.y)
    }
}

impl<M: Manipulator> Tabletop<M> {
    /// How far inside the edge of `surface` the centre of `object` must be to be left at `at` (world x and y), metres.
    pub fn edge_margin_m(&self, object: ObjectId, surface: SurfaceId, at: &Point2<f64>) -> f64 {
        let brinks = self.movable(object).map_or(&[][..], |movable| &movable.brinks);
        let forced = brinks.iter().filter(|brink| brink.covers(surface, at)).map(|brink| brink.margin_m);
        forced.fold(self.settings().safety.edge_margin_m, f64::min)
    }

    /// May `object` be left on `surface` with its centre over `at`?
    pub fn keeps_from_edge(&self, object: ObjectId, surface: SurfaceId, at: &Point2<f64>) -> bool {
        let margin_m = self.edge_margin_m(object, surface, at);
        self.surface(surface).is_some_and(|plane| plane.depth(at) >= margin_m - ROUNDING_M)
    }
}
