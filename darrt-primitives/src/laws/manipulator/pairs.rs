//! Are all pairs of links named that can collide?

use darrt_core::laws::{Broken, ensure};
use darrt_geom::oracle::{PosedBody, intersections, nearest};
use nalgebra::Isometry3;

use super::{PAIRS, SELF_PAIRS, Trial, gap};
use crate::manipulator::{Configuration, Manipulator};

/// So many joints between two links make them more than neighbours.
const NEIGHBOURS: usize = 4;
/// A pair that overlaps in so many configurations always does.
const CONFIGURATIONS: usize = 12;
/// Links that are farther apart than this do not merely graze each other, metres.
const APART_M: f64 = 0.01;
/// A relative pose that changes by less has not changed, metres and radians.
const SAME: f64 = 1e-9;

impl<M: Manipulator> Trial<'_, M> {
    /// Links that overlap in one configuration and are apart in the other, with at least four joints between them, are a pair.
    /// Those with fewer are neighbours: around a wrist their shapes may overlap.
    pub(super) fn pairs(&self) -> Result<(), Broken> {
        let gap_m = self.gaps_m[0];
        let robot = self.robot;
        let at = |q: &Configuration<M::Joints>| self.poses(&Configuration { base: [0.0; 3], ..*q }, gap_m);
        let poses = [self.a, self.b].map(at);
        let by_joint = self.by_joint(&poses[0]);
        let is_asked = |i: usize, j: usize| {
            let pairs = robot.self_pairs();
            !pairs.contains(&(i, j)) && !pairs.contains(&(j, i)) && between(&by_joint, i, j) >= NEIGHBOURS
        };
        let bodies = poses.each_ref().map(|poses| {
            let links = robot.links().iter().zip(poses);
            links.map(|(link, pose)| PosedBody { body: &link.body, world_from_body: *pose }).collect::<Vec<_>>()
        });
        for (here, there) in [(0, 1), (1, 0)] {
            let [Some(here), Some(there)] = [here, there].map(|which| bodies.get(which)) else { return Ok(()) };
            let found = intersections(here, &|i, j| !is_asked(i, j));
            let found =
                found.map_err(|error| Broken::new(SELF_PAIRS, error.to_string(), "links that can be placed"))?;
            for hit in found {
                let only = |i: usize, j: usize| [i, j] != [hit.first, hit.second];
                let apart = nearest(there, &only).ok().flatten().map_or(0.0, |found| found.distance);
                let text = || {
                    let [a, b] = [hit.first, hit.second].map(|link| self.link_name(link));
                    format!("{a} and {b} overlap in one configuration, and are {apart:?} m apart in another")
                };
                ensure(
                    SELF_PAIRS,
                    apart <= APART_M,
                    text,
                    "a pair, or links with fewer than four joints between them",
                )?;
            }
        }
        Ok(())
    }

    /// No pair overlaps in each of many configurations: then every configuration would be in collision.
    pub(super) fn pairs_part(&self) -> Result<(), Broken> {
        let robot = self.robot;
        let mut rng = self.rng(7);
        let mut always: Vec<(usize, usize)> = robot.self_pairs().to_vec();
        for i in 0..CONFIGURATIONS {
            let q = match i {
                0 => *self.a,
                1 => *self.b,
                _ => self.anywhere(&mut rng),
            };
            let poses = self.poses(&Configuration { base: [0.0; 3], ..q }, self.hand_facts().max_gap_m() * 0.5);
            let bodies: Vec<_> = robot
                .links()
                .iter()
                .zip(&poses)
                .map(|(link, pose)| PosedBody { body: &link.body, world_from_body: *pose })
                .collect();
            let is_left = |i: usize, j: usize| always.contains(&(i, j)) || always.contains(&(j, i));
            let found = intersections(&bodies, &|i, j| !is_left(i, j));
            let found = found.map_err(|error| Broken::new(PAIRS, error.to_string(), "links that can be placed"))?;
            let hits: Vec<_> = found.iter().map(|hit| (hit.first, hit.second)).collect();
            always.retain(|(i, j)| hits.contains(&(*i, *j)) || hits.contains(&(*j, *i)));
            if always.is_empty() {
                return Ok(());
            }
        }
        let names: Vec<_> = always.iter().map(|(i, j)| [self.link_name(*i), self.link_name(*j)]).collect();
        Err(Broken::new(
            PAIRS,
            format!("{names:?} overlap in {CONFIGURATIONS} of {CONFIGURATIONS} configurations"),
            "apart in some",
        ))
    }

    /// The poses of all links, the base at the origin, with one joint after the other at its value in `b`; the first are
    /// those of `a`.
    fn by_joint(&self, at_a: &[Isometry3<f64>]) -> Vec<Vec<Isometry3<f64>>> {
        let mut all = vec![at_a.to_vec()];
        for (joint, value) in self.b.arm.as_ref().iter().enumerate() {
            let mut moved = Configuration { base: [0.0; 3], ..*self.a };
            moved.arm.as_mut().iter_mut().skip(joint).take(1).for_each(|slot| *slot = *value);
            all.push(self.poses(&moved, self.gaps_m[0]));
        }
        all
    }
}

/// How many joints move one link relative to the other.
fn between(by_joint: &[Vec<Isometry3<f64>>], i: usize, j: usize) -> usize {
    let relative = |poses: &Vec<Isometry3<f64>>| Some(poses.get(i)?.inverse() * poses.get(j)?);
    let Some(before) = by_joint.first().and_then(relative) else { return 0 };
    let after = by_joint.iter().skip(1).filter_map(relative);
    after.filter(|after| gap(&before, after) > SAME).count()
}
