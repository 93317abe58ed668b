//! How far points travel.

use darrt_core::laws::{Broken, at_most, ensure, equal, measure};
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Point3, Vector3};

use super::{DURATION, TRAVEL, TRAVEL_HELD, TRAVEL_LINKS, TRAVEL_MEASURE, Trial};
use crate::laws::tabletop::corners;
use crate::manipulator::{Configuration, Manipulator};

/// Rounding that is forgiven, metres.
const SLACK_M: f64 = 1e-9;
/// Parameters at which points are looked at.
const LOOKS: [f64; 6] = [0.0, 0.02, 0.3, 0.5, 0.8, 1.0];
/// Length of the short motions, as a part of the way from one configuration to the other: there nothing is lost to
/// coming back, so a bound that is too small shows.
const SHORT: f64 = 0.01;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn travel(&self) -> Result<(), Broken> {
        let near = self.space.interpolate(self.a, self.b, SHORT);
        for end in [self.b, &near] {
            self.measures(end)?;
            self.bounds(end)?;
        }
        // One coordinate of the base and one joint at a time: nothing else pays for it.
        for (coordinate, value) in near.base.iter().enumerate() {
            let mut alone = *self.a;
            alone.base.iter_mut().skip(coordinate).take(1).for_each(|slot| *slot = *value);
            self.bounds(&alone)
                .and_then(|()| self.takes_time(&alone))
                .map_err(|broken| broken.of(format_args!("base coordinate {coordinate} alone")))?;
        }
        for joint in 0..self.a.arm.as_ref().len() {
            let mut alone = *self.a;
            if let (Some(slot), Some(value)) = (alone.arm.as_mut().get_mut(joint), near.arm.as_ref().get(joint)) {
                *slot = *value;
            }
            self.bounds(&alone)
                .and_then(|()| self.takes_time(&alone))
                .map_err(|broken| broken.of(format_args!("joint {joint} alone")))?;
        }
        Ok(())
    }

    /// From `a` to `end`, with an empty and a loaded hand.
    fn takes_time(&self, end: &Configuration<M::Joints>) -> Result<(), Broken> {
        let seconds = |a, b, is_loaded| self.robot.duration_s(a, b, is_loaded);
        let [empty, loaded] = [false, true].map(|is_loaded| seconds(self.a, end, is_loaded));
        for (found, is_loaded) in [(empty, false), (loaded, true)] {
            measure(DURATION, found)?;
            equal(DURATION, &seconds(self.a, end, is_loaded), &found).map_err(|broken| broken.of("asked again"))?;
            equal(DURATION, &seconds(self.a, self.a, is_loaded), &0.0).map_err(|broken| broken.of("to itself"))?;
        }
        at_most(DURATION, empty, loaded, SLACK_M).map_err(|broken| broken.of("loaded"))?;
        let moves = self.robot.travel_m(self.a, end, 0.0) > SLACK_M;
        ensure(DURATION, !moves || empty > 0.0, || format!("{empty:?} s"), "some time: the robot moves")
    }

    fn measures(&self, end: &Configuration<M::Joints>) -> Result<(), Broken> {
        let travel = |a, b, reach| self.robot.travel_m(a, b, reach);
        let [small, large] = self.claims.held_reach_m;
        let metres = travel(self.a, end, small);
        measure(TRAVEL_MEASURE, metres)?;
        equal(TRAVEL_MEASURE, &travel(self.a, self.a, large), &0.0).map_err(|broken| broken.of("to itself"))?;
        let backwards = (travel(end, self.a, small) - metres).abs();
        at_most(TRAVEL_MEASURE, backwards, 0.0, SLACK_M).map_err(|broken| broken.of("backwards"))?;
        let of_larger = travel(self.a, end, small.max(large));
        at_most(TRAVEL_MEASURE, metres, of_larger, SLACK_M).map_err(|broken| broken.of("larger held object"))
    }

    /// From `a` to `end`: between any two looks every point moves at most its share of the travel.
    pub(super) fn bounds(&self, end: &Configuration<M::Joints>) -> Result<(), Broken> {
        let looks: Vec<_> = LOOKS.iter().map(|t| (*t, self.space.interpolate(self.a, end, *t))).collect();
        let bound = self.robot.travel_m(self.a, end, 0.0);
        let mut of_each = vec![0.0; self.robot.links().len()];
        let poses: Vec<_> = looks.iter().map(|(t, q)| (*t, self.poses(q, self.gaps_m[1]))).collect();
        for (link, part) in self.robot.links().iter().enumerate() {
            let points: Vec<_> = corners(&part.body, &Isometry3::identity()).collect();
            let of_link: Vec<_> = poses.iter().filter_map(|(t, all)| Some((*t, *all.get(link)?))).collect();
            stays_within(TRAVEL, &of_link, &points, bound).map_err(|broken| broken.of(&part.body.name))?;
            self.robot.link_travel_m(self.a, end, 0.0, &mut of_each);
            let bound = of_each.get(link).copied().unwrap_or(0.0);
            stays_within(TRAVEL_LINKS, &of_link, &points, bound).map_err(|broken| broken.of(&part.body.name))?;
        }
        let tools: Vec<_> = looks.iter().map(|(t, q)| (*t, self.robot.world_from_tool(q))).collect();
        for reach in self.claims.held_reach_m {
            let ball: Vec<_> = directions().map(|d| Point3::from(d * reach)).collect();
            let bound = self.robot.travel_m(self.a, end, reach);
            let held = |broken: Broken| broken.of(format_args!("held object that reaches {reach:?} m"));
            stays_within(TRAVEL_HELD, &tools, &ball, bound).map_err(held)?;
            let bound = self.robot.link_travel_m(self.a, end, reach, &mut of_each);
            stays_within(TRAVEL_LINKS, &tools, &ball, bound).map_err(held)?;
        }
        Ok(())
    }
}

/// No point of `points` (in the moving frame) moves farther than `bound` times the difference of two parameters.
fn stays_within(
    law: &'static str,
    poses: &[(f64, Isometry3<f64>)],
    points: &[Point3<f64>],
    bound: f64,
) -> Result<(), Broken> {
    for (i, (t1, first)) in poses.iter().enumerate() {
        for (t2, second) in poses.iter().skip(i + 1) {
            let moved = points.iter().map(|p| (second * p - first * p).norm()).fold(0.0, f64::max);
            at_most(law, moved, bound * (t2 - t1), SLACK_M).map_err(|broken| broken.at(*t2))?;
        }
    }
    Ok(())
}

/// The axes and the diagonals between them, unit vectors.
pub(super) fn directions() -> impl Iterator<Item = Vector3<f64>> {
    let sides = [-1.0, 0.0, 1.0];
    let all = sides.into_iter().flat_map(move |x| sides.map(|y| (x, y)));
    all.flat_map(move |(x, y)| sides.map(|z| Vector3::new(x, y, z))).filter_map(|v| v.try_normalize(0.1))
}
