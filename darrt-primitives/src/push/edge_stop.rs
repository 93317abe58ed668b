//! Where a push ends: at its target, or near the edge of the table.
//!
//! A push whose target lies on the support ends there. Otherwise it ends near the edge, with the
//! centre of the disc a chosen distance inside: near enough that the rim sticks out far enough to be
//! grasped, far enough that the disc does not tip.
//!
//! # Source
//! Section 4.1 of the paper: "the point on the edge of the support surface nearest the object's
//! position in c2".

use darrt_geom::SupportSurface;
use nalgebra::{Point2, Unit, Vector2};
use rand::RngExt as _;

use crate::error::{PrimitiveError, finite, positive, within};

/// Which point of the edge stands in for a target that is not on the support.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeRule {
    /// The point of the edge nearest to the target: the paper's rule.
    #[default]
    NearestEdgePoint,
    /// The point where the straight line from the object to the target meets the edge.
    LineCrossing,
}

/// How a disc has to stand at an edge so that its rim can be gripped; lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimReach {
    /// How far the fingertips reach in from the rim (default 0.030).
    pub insertion: f64,
    /// Free distance between fingertips and edge (default 0.010).
    pub clearance: f64,
    /// Least distance of the centre from the edge, so that the disc does not tip (default 0.030).
    pub tip_margin: f64,
}

impl Default for RimReach {
    /// Insertion 0.030, clearance 0.010, tip margin 0.030.
    fn default() -> Self {
        Self { insertion: 0.030, clearance: 0.010, tip_margin: 0.030 }
    }
}

impl RimReach {
    /// Distances of the centre inside the edge at which a disc of `radius` metres is stable and can
    /// be gripped: `[tip_margin, radius - insertion - clearance]`. `None` when no distance is both.
    ///
    /// # Errors
    /// When `radius` or `insertion` is not positive, or another length is negative or not finite.
    pub fn edge_distances(&self, radius: f64) -> Result<Option<EdgeDistances>, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        let insertion = positive("fingertip insertion", self.insertion)?;
        let clearance = within("edge clearance", self.clearance, 0.0, f64::MAX)?;
        let least = within("tip margin", self.tip_margin, 0.0, f64::MAX)?;
        let most = radius - insertion - clearance;
        Ok((least <= most).then_some(EdgeDistances { least, most }))
    }
}

/// A non-empty closed interval of distances inside an edge, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeDistances {
    least: f64,
    most: f64,
}

impl EdgeDistances {
    /// The interval `[least, most]`.
    ///
    /// # Errors
    /// When a bound is negative or not finite, or `least` is above `most`.
    pub fn new(least: f64, most: f64) -> Result<Self, PrimitiveError> {
        let most = finite("largest edge distance", most)?;
        let least = within("least edge distance", least, 0.0, most)?;
        Ok(Self { least, most })
    }

    /// The smallest admissible distance.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// The largest admissible distance.
    pub fn most(&self) -> f64 {
        self.most
    }

    /// The middle of the interval.
    pub fn middle(&self) -> f64 {
        0.5 * (self.least + self.most)
    }

    /// Is `distance` inside, up to `tolerance`?
    pub fn contains(&self, distance: f64, tolerance: f64) -> bool {
        (self.least - tolerance..=self.most + tolerance).contains(&distance)
    }

    /// A distance drawn uniformly from the interval.
    pub fn sample(&self, rng: &mut dyn rand::Rng) -> f64 {
        rng.random_range(self.least..=self.most)
    }
}

/// How pushes end on one support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeStop {
    /// What replaces a target off the support.
    pub rule: EdgeRule,
    /// A target at least this far inside the edge counts as lying on the support, metres.
    pub target_margin: f64,
    /// Distance of the centre inside the edge where an edge-limited push stops, metres.
    pub edge_distance: f64,
}

/// The end of a push.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PushEnd {
    /// Centre of the disc at the end, world x and y, metres.
    pub center: Point2<f64>,
    /// Did the edge stand in for the target?
    pub limited_by_edge: bool,
    /// Heading of the push.
    pub direction: Unit<Vector2<f64>>,
    /// Length of the push, metres.
    pub length: f64,
}

/// Why there is no push. An ordinary outcome of the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoPush {
    /// The object does not stand on the support.
    NotOnSupport,
    /// The object is already where the push would end, or nearer to the target.
    NothingToDo,
    /// The line to the target leaves the support along the edge, or the object stands too near to it
    /// to stop in time.
    NoRoomBeforeEdge,
    /// No point at the required distance from every edge could be found near the edge point.
    EdgeTooNarrow,
    /// The straight way to the end leaves the support (an indented table).
    LeavesSupport,
}

/// Pushes shorter than this are not made, metres.
const LEAST_PUSH: f64 = 1e-6;
/// Accuracy of the stop's distance from the edge, metres.
const ACCURACY: f64 = 1e-9;
/// Least sine between the push line and the edge it meets; below it the stop point is ill defined.
const LEAST_CROSSING_SINE: f64 = 0.01;

impl EdgeStop {
    /// Where a straight push of a disc from `from` toward `target` ends; world x and y, metres.
    ///
    /// Pure geometry of the support: no obstacle, no robot.
    ///
    /// # Errors
    /// The reason why there is no push.
    pub fn end_of_push(
        &self,
        surface: &SupportSurface,
        from: &Point2<f64>,
        target: &Point2<f64>,
    ) -> Result<PushEnd, NoPush> {
        let (center, limited_by_edge) = self.center_at_end(surface, from, target)?;
        straight_push(surface, from, center, limited_by_edge)
    }

    /// Where the centre of a disc ends that is pushed from `from` toward `target`, whichever way it goes, and whether the edge
    /// stands in for the target; world x and y, metres.
    ///
    /// # Errors
    /// The reason why there is no push, straight or not.
    pub fn center_at_end(
        &self,
        surface: &SupportSurface,
        from: &Point2<f64>,
        target: &Point2<f64>,
    ) -> Result<(Point2<f64>, bool), NoPush> {
        if !surface.contains(from) {
            return Err(NoPush::NotOnSupport);
        }
        if surface.depth(target) >= self.target_margin {
            return Ok((*target, false));
        }
        let center = match self.rule {
            EdgeRule::NearestEdgePoint => self.beside_nearest_edge(surface, target)?,
            EdgeRule::LineCrossing => self.before_crossing(surface, from, target)?,
        };
        if (center - target).norm() >= (from - target).norm() {
            return Err(NoPush::NothingToDo);
        }
        Ok((center, true))
    }

    /// The stop beside the edge point nearest to `target`.
    ///
    /// One step inward suffices on a straight edge. Near a corner the result can be too close to the
    /// other edge, so the step is repeated from there; at a right angle twice, at sharper corners the
    /// steps shrink geometrically.
    fn beside_nearest_edge(&self, surface: &SupportSurface, target: &Point2<f64>) -> Result<Point2<f64>, NoPush> {
        const TRIES: usize = 64;
        let mut center = *target;
        for _ in 0..TRIES {
            let edge = surface.nearest_edge_point(&center);
            center = edge.point - self.edge_distance * edge.outward.into_inner();
            if surface.depth(&center) >= self.edge_distance - ACCURACY {
                return Ok(center);
            }
        }
        Err(NoPush::EdgeTooNarrow)
    }

    /// The last point before the edge on the line from `from` to `target` that keeps the distance.
    fn before_crossing(
        &self,
        surface: &SupportSurface,
        from: &Point2<f64>,
        target: &Point2<f64>,
    ) -> Result<Point2<f64>, NoPush> {
        const TRIES: usize = 10_000;
        let direction = Unit::try_new(target - from, LEAST_PUSH).ok_or(NoPush::NothingToDo)?;
        let crossing = surface.first_crossing(from, &direction).ok_or(NoPush::NoRoomBeforeEdge)?;
        let sine = direction.dot(&crossing.outward);
        if sine < LEAST_CROSSING_SINE {
            return Err(NoPush::NoRoomBeforeEdge);
        }
        // Exact for the crossed edge; the loop then gives way to any other edge. The depth changes
        // by at most the step, so no admissible point is passed over.
        let mut along = (crossing.point - from).dot(&direction) - self.edge_distance / sine;
        for _ in 0..TRIES {
            if along < LEAST_PUSH {
                break;
            }
            let center = from + along * direction.into_inner();
            let missing = self.edge_distance - surface.depth(&center);
            if missing <= ACCURACY {
                return Ok(center);
            }
            along -= missing;
        }
        Err(NoPush::NoRoomBeforeEdge)
    }
}

/// The push from `from` straight to `center`, when it exists and stays on the support.
fn straight_push(
    surface: &SupportSurface,
    from: &Point2<f64>,
    center: Point2<f64>,
    limited_by_edge: bool,
) -> Result<PushEnd, NoPush> {
    let (direction, length) = Unit::try_new_and_get(center - from, LEAST_PUSH).ok_or(NoPush::NothingToDo)?;
    let free = surface.first_crossing(from, &direction).map_or(f64::INFINITY, |edge| (edge.point - from).norm());
    if free < length {
        return Err(NoPush::LeavesSupport);
    }
    Ok(PushEnd { center, limited_by_edge, direction, length })
}

#[cfg(test)]
mod tests;
