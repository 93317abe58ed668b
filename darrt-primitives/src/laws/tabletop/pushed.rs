//! Objects that rest, and those that are pushed.

use darrt_core::laws::{Broken, at_most, ensure};
use darrt_core::state::ObjectId;
use darrt_geom::oracle::{PosedBody, nearest};
use nalgebra::{Isometry3, Point2, Vector3};

use super::{CONTACT, Look, RAY, STILL, SUPPORT, TOUCH, TURN, Trial};
use crate::laws::manipulator::same_pose;
use crate::manipulator::{LinkGroup, Manipulator};
use crate::push::slide::Slide;
use crate::tabletop::TabletopState;

/// Rounding that is forgiven in the way of a pushed object, metres and radians.
const ROUNDING: f64 = 1e-9;
/// Rounding of angles between poses, radians: an arc cosine near 1 loses half of the digits.
const LEAN: f64 = 1e-7;
/// How far the surface and the bottom of what stands on it may be apart, metres.
const ON_SURFACE_M: f64 = 1e-6;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn pushed(&self) -> Result<(), Broken> {
        for (i, start) in self.from.objects.iter().enumerate() {
            let id = ObjectId::new(i);
            if self.during.mode.support_of(id).is_none() {
                continue;
            }
            let moved: Vec<&Look<M>> = self.looks.iter().filter(|l| l.state.object(id) != Some(start)).collect();
            let Some(end) = self.end.object(id).filter(|end| !moved.is_empty() || *end != start) else { continue };
            let check = || {
                let at = moved.first().map_or(1.0, |look| look.t);
                let is_pushed = self.instance.object == Some(id) && self.during.mode.engaged() == Some(id);
                let text = || format!("moves from {:?}", start.translation.vector.as_slice());
                ensure(STILL, is_pushed, text, "at rest").map_err(|broken| broken.at(at))?;
                let states = moved.iter().map(|look| (look.t, &look.state)).chain([(1.0, &self.end)]);
                self.on_support(id, start, states)?;
                on_ray(id, start, end, &moved)?;
                self.held_by_the_fingers(id, &Slide::new(*start, *end))?;
                self.in_contact(id, end, &moved)?;
                self.touched(id, &self.end).map_err(|broken| broken.at(1.0))
            };
            check().map_err(|broken: Broken| broken.of(self.name(id)))?;
        }
        Ok(())
    }

    fn on_support<'s>(
        &self,
        id: ObjectId,
        start: &Isometry3<f64>,
        states: impl Iterator<Item = (f64, &'s TabletopState<M>)>,
    ) -> Result<(), Broken>
    where
        M: 's,
    {
        let surface = self.during.mode.support_of(id).and_then(|s| self.m.surface(s));
        let (Some(surface), Some(movable)) = (surface, self.m.movable(id)) else {
            return Err(Broken::new(SUPPORT, "no surface", "a surface of the domain"));
        };
        for (t, state) in states {
            let check = || {
                let Some(pose) = state.object(id) else { return Ok(()) };
                let lean = (pose.rotation * Vector3::z()).angle(&(start.rotation * Vector3::z()));
                at_most(SUPPORT, lean, 0.0, LEAN).map_err(|broken| broken.of("lean"))?;
                let height = pose.translation.z - movable.half_height_m - surface.height();
                at_most(SUPPORT, height.abs(), 0.0, ON_SURFACE_M).map_err(|broken| broken.of("height"))?;
                let at = Point2::new(pose.translation.x, pose.translation.y);
                let text = || format!("{:?}", at.coords.as_slice());
                ensure(SUPPORT, surface.contains(&at), text, "a place over the surface")
            };
            check().map_err(|broken: Broken| broken.at(t))?;
        }
        Ok(())
    }

    /// The way is no sharper than the closed form for two contacts a gap apart, of a disc that rests on its rim: with beta and
    /// alpha the angles of contacts and friction, R sin(beta) / R^2, or R sin(alpha) cos(alpha) / cos(beta) / R^2 if alpha is
    /// less than beta (Lynch and Mason 1996).
    fn held_by_the_fingers(&self, id: ObjectId, slide: &Slide) -> Result<(), Broken> {
        let Some(movable) = self.m.movable(id).filter(|_| slide.turn() != 0.0) else { return Ok(()) };
        let radius = movable.round_radius_m.unwrap_or(f64::INFINITY);
        let alpha = movable.friction.fingers.atan();
        let beta = (0.5 * self.during.mode.gap_m() / radius).min(1.0).asin();
        let offset = if alpha < beta { alpha.sin() * alpha.cos() / beta.cos() } else { beta.sin() };
        at_most(TURN, slide.curvature().abs(), offset / radius, ROUNDING).map_err(|broken| broken.of("curvature"))
    }

    /// The tool stands to the object as it does at the end.
    fn in_contact(&self, id: ObjectId, end: &Isometry3<f64>, moved: &[&Look<M>]) -> Result<(), Broken> {
        let at_end = end.inverse() * self.tool(&self.end);
        let first = moved.first().map_or(1.0, |look| look.t);
        // Where the object begins to move, the hand is at it already.
        let begin = self.looks.iter().rfind(|look| look.is_knot && look.t < first && look.t > f64::MIN_POSITIVE);
        for look in begin.into_iter().chain(moved.iter().copied()) {
            let Some(pose) = look.state.object(id) else { continue };
            let here = pose.inverse() * self.tool(&look.state);
            same_pose(CONTACT, &here, &at_end, self.tolerance(look)).map_err(|broken| broken.at(look.t))?;
        }
        Ok(())
    }

    /// Two finger links are within reach of the object.
    pub(super) fn touched(&self, id: ObjectId, state: &TabletopState<M>) -> Result<(), Broken> {
        let robot = self.m.manipulator();
        let mut poses = vec![Isometry3::identity(); robot.links().len()];
        // At the end the hand may already have opened again.
        robot.link_poses(&state.robot, self.during.mode.gap_m(), &mut poses);
        let (Some(movable), Some(pose)) = (self.m.movable(id), state.object(id)) else { return Ok(()) };
        let object = PosedBody { body: &movable.body, world_from_body: *pose };
        let mut distances: Vec<f64> = Vec::new();
        for (link, pose) in robot.links().iter().zip(&poses).filter(|(link, _)| link.group == LinkGroup::Finger) {
            let finger = PosedBody { body: &link.body, world_from_body: *pose };
            let found = nearest(&[finger, object], &|_, _| false);
            let found = found.map_err(|error| Broken::new(TOUCH, error.to_string(), "bodies that can be measured"))?;
            distances.extend(found.map(|finding| finding.distance));
        }
        distances.sort_by(f64::total_cmp);
        let second = distances.get(1).copied().unwrap_or(f64::INFINITY);
        at_most(TOUCH, second, 0.0, self.claims.touch_m).map_err(|broken| broken.of("second nearest finger link"))
    }
}

fn on_ray<M: Manipulator>(
    id: ObjectId,
    start: &Isometry3<f64>,
    end: &Isometry3<f64>,
    moved: &[&Look<M>],
) -> Result<(), Broken> {
    let slide = Slide::new(*start, *end);
    let length = slide.length_m();
    ensure(RAY, length > 0.0, || "ends where it began".to_owned(), "an end ahead").map_err(|b| b.at(1.0))?;
    let mut done = 0.0;
    for look in moved {
        let Some(pose) = look.state.object(id) else { continue };
        // How much of the way is done: the chord to a part of an arc is as long as the sine of half its turn.
        let way = (pose.translation.vector - start.translation.vector).norm();
        let half = slide.turn() / 2.0;
        let whole = (end.translation.vector - start.translation.vector).norm();
        let share = if half == 0.0 { way / whole } else { (way / whole * half.sin()).clamp(-1.0, 1.0).asin() / half };
        let there = slide.at(share);
        let check = at_most(RAY, (pose.translation.vector - there.translation.vector).norm(), 0.0, ROUNDING)
            .map_err(|broken| broken.of("off the ray"))
            .and_then(|()| {
                at_most(RAY, pose.rotation.angle_to(&there.rotation), 0.0, LEAN).map_err(|broken| broken.of("turn"))
            })
            .and_then(|()| at_most(RAY, done, share * length, ROUNDING).map_err(|broken| broken.of("backwards")))
            .and_then(|()| at_most(RAY, share, 1.0, ROUNDING).map_err(|broken| broken.of("too far")));
        check.map_err(|broken| broken.at(look.t))?;
        done = share * length;
    }
    Ok(())
}
