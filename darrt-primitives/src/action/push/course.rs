//! Which way an object is pushed: straight to its end, or along an arc where the straight way is blocked.

use darrt_core::primitive::Infeasible;
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Unit, Vector2};
use rand::{Rng, RngExt};

use super::hand::Pushable;
use crate::manipulator::Manipulator;
use crate::push::edge_stop::{EdgeStop, NoPush};
use crate::push::slide::Slide;
use crate::tabletop::{Tabletop, TabletopState};

/// How far before what is in its way the object stops, metres.
const STOP_BEFORE_M: f64 = 0.01;
/// Part of the largest curvature that is used: the rest is left to rounding.
const CURVATURE_SHARE: f64 = 0.9;
/// Arcs that turn by less than this are as good as straight, radians.
const LEAST_HALF_TURN_RAD: f64 = 0.02;
/// How far apart the places of an arc are at most that are asked for the edge, metres.
const EDGE_STEP_M: f64 = 0.002;

/// The way of one push.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    /// The way of the object.
    pub(super) slide: Slide,
    /// In which direction it sets out.
    pub(super) heading: Unit<Vector2<f64>>,
    /// How much of it the arm must follow, metres.
    pub(super) least_m: f64,
    /// Does it go all the way to its end, or stop before something?
    pub(super) is_whole: bool,
}

/// Where a push towards `target` ends; at an edge at a distance drawn at random, the least one where any other would end
/// before `settle_m`.
///
/// # Errors
/// [`Infeasible::NoProgress`], [`Infeasible::OffSupport`].
pub(super) fn end_of_push<M: Manipulator>(
    m: &Tabletop<M>,
    pushable: &Pushable<'_>,
    target: &Isometry3<f64>,
    settle_m: f64,
    rng: &mut dyn Rng,
) -> Result<Point2<f64>, Infeasible> {
    let settings = &m.settings().push;
    let [least, most] = Pushable::edge_distances_m(m);
    let edge_distance = if least < most { rng.random_range(least..=most) } else { least };
    let target = Point2::new(target.translation.x, target.translation.y);
    let target_margin = m.edge_margin_m(pushable.object, pushable.on, &target);
    let center = pushable.center();
    let end_at = |edge_distance| {
        let stop = EdgeStop { rule: settings.edge_rule, target_margin, edge_distance };
        stop.center_at_end(pushable.surface, &center, &target)
    };
    let mut end = end_at(edge_distance);
    if end.is_ok_and(|(end, limited_by_edge)| limited_by_edge && (end - center).norm() < settle_m) {
        end = end_at(least);
    }
    end.map(|(end, _)| end)
        .map_err(|why| if why == NoPush::NothingToDo { Infeasible::NoProgress } else { Infeasible::OffSupport })
}

impl Course {
    /// Straight to `end`; not all the way if something stands in the object's way, but at least as far as settles what its
    /// place may be off. With this [care](darrt_core::validity::Validity::most_care). This costs next to nothing and needs no arm.
    ///
    /// # Errors
    /// [`Infeasible::NoProgress`], [`Infeasible::OffSupport`] where it would leave the surface, [`Infeasible::Blocked`].
    pub(super) fn straight<M: Manipulator>(
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        pushable: &Pushable<'_>,
        end: &Point2<f64>,
        settle_m: f64,
        care: usize,
    ) -> Result<Self, Infeasible> {
        let slide = Slide::along_arc(*pushable.pose, &end.coords, 0.0);
        let length_m = slide.length_m();
        let heading = slide.heading().ok_or(Infeasible::NoProgress)?;
        let to_edge = pushable.surface.first_crossing(&pushable.center(), &heading);
        if to_edge.is_some_and(|edge| edge.distance < length_m) {
            return Err(Infeasible::OffSupport);
        }
        let least_m = settle_m.min(length_m);
        let whole = Self { slide, heading, least_m, is_whole: true };
        let (free_m, Some(blame)) = m.collision_scene().free_slide(from, pushable.object, &slide, care) else {
            return Ok(whole);
        };
        let stop_m = free_m - STOP_BEFORE_M;
        if stop_m < least_m {
            return Err(Infeasible::Blocked(blame));
        }
        Ok(Self { slide: slide.until(stop_m / length_m), is_whole: false, ..whole })
    }

    /// All the way to `end` along arcs on both sides of the straight way: as sharp as the fingers hold the object, and half as
    /// sharp. Those that are free, and keep to the surface; first those that turn counter-clockwise if `side` is 1, clockwise
    /// if it is -1.
    pub(super) fn arcs<M: Manipulator>(
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        pushable: &Pushable<'_>,
        end: &Point2<f64>,
        care: usize,
        side: f64,
    ) -> impl Iterator<Item = Self> {
        let half_turn = pushable.most_half_turn(m, (end - pushable.center()).norm());
        let turns = [1.0, -1.0, 0.5, -0.5].map(|share| 2.0 * side * share * half_turn);
        turns.into_iter().filter(move |_| half_turn >= LEAST_HALF_TURN_RAD).filter_map(move |turn| {
            let slide = Slide::along_arc(*pushable.pose, &end.coords, turn);
            let heading = slide.heading()?;
            let stays = stays_on(pushable.surface, &slide, m.settings().safety.edge_margin_m);
            let is_free = stays && m.collision_scene().free_slide(from, pushable.object, &slide, care).1.is_none();
            is_free.then(|| Self { slide, heading, least_m: slide.length_m(), is_whole: true })
        })
    }
}

impl Pushable<'_> {
    /// By how much the heading of an arc may differ from that of the straight way to its end `chord_m` away, radians.
    pub(in crate::action) fn most_half_turn<M: Manipulator>(&self, m: &Tabletop<M>, chord_m: f64) -> f64 {
        let sine = 0.5 * CURVATURE_SHARE * self.max_curvature() * chord_m;
        sine.min(1.0).asin().min(0.5 * m.settings().push.max_turn_rad)
    }
}

/// Does the centre stay `margin_m` inside the edge all the way, or as far inside as the nearer of its two ends?
fn stays_on(surface: &SupportSurface, slide: &Slide, margin_m: f64) -> bool {
    let depth_m = |share| surface.depth(&Point2::from(slide.at(share).translation.vector.xy()));
    let length_m = slide.length_m();
    let needed_m = margin_m.min(depth_m(0.0)).min(depth_m(1.0)).max(0.0);
    let mut gone_m = 0.0;
    while gone_m < length_m {
        let spare_m = depth_m(gone_m / length_m) - needed_m;
        if spare_m < -EDGE_STEP_M {
            return false;
        }
        // The depth changes by no more than the way.
        gone_m += spare_m.max(EDGE_STEP_M);
    }
    true
}
