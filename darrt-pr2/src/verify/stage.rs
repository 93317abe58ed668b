//! All solids at their places, and which pairs may not touch.

use nalgebra::{Isometry3, Point3};

use super::robot::Robot;
use super::solid::{Placed, Solid, exact, lower_bound};
use super::world::World;

/// Slack on top of the depth to which an object may press into what carries it, metres.
const LIFT_SLACK_M: f64 = 1e-4;

/// How far measured distances and travels may be off, metres.
const ROUNDING_M: f64 = 1e-6;

/// How a pair is treated during a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// They may not touch.
    Apart,
    /// They may.
    Free,
    /// The first stands on the second: lifted a little it must be clear of it.
    Standing,
}

/// What a pair consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PairKind {
    /// A link and an object, by index.
    LinkObject {
        link: usize,
        object: usize,
    },
    /// An object and a fixed body, by index.
    ObjectFixed {
        object: usize,
        fixed: usize,
    },
    Other,
}

#[derive(Debug)]
struct Pair {
    a: usize,
    b: usize,
    kind: PairKind,
    rule: Rule,
    /// Their distance when last measured, plus twice what [`Stage::travelled_m`] was then.
    reserve_m: f64,
}

/// Two solids that touch and may not.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hit {
    pub(super) names: (String, String),
    pub(super) place: Point3<f64>,
}

/// The smallest distance seen between two bodies that may not touch.
#[derive(Debug, Clone, PartialEq)]
pub struct SmallestClearance {
    /// Metres.
    pub distance_m: f64,
    /// The two bodies.
    pub bodies: (String, String),
    /// The step, from 1; 0 at the start of the plan.
    pub step: u32,
    /// Fraction of the step.
    pub time: f64,
}

/// All solids: those of the robot, the objects, the fixed bodies, in this order.
#[derive(Debug)]
pub(super) struct Stage {
    solids: Vec<Solid>,
    poses: Vec<Isometry3<f64>>,
    /// World centres of the balls around the solids.
    centres: Vec<Point3<f64>>,
    has_moved: Vec<bool>,
    pairs: Vec<Pair>,
    links: usize,
    lift_m: f64,
    /// Bound on how far any solid has moved since the beginning, metres.
    travelled_m: f64,
    /// States looked at.
    pub(super) states: u64,
    /// Questions to the oracle.
    pub(super) exact_tests: u64,
    pub(super) smallest: Option<SmallestClearance>,
}

impl Stage {
    /// `support_m`: how deep an object may press into what carries it.
    pub(super) fn new(robot: &Robot, world: &World<'_>, support_m: f64) -> Self {
        let links = robot.solids.len();
        let objects = world.movables.len();
        let first_fixed = links + objects;
        let mut solids: Vec<Solid> = robot.solids.iter().map(|s| s.solid.clone()).collect();
        solids.extend(world.movables.iter().map(|m| m.solid.clone()));
        solids.extend(world.fixed.iter().map(|(solid, _)| solid.clone()));
        let mut poses = vec![Isometry3::identity(); first_fixed];
        poses.extend(world.fixed.iter().map(|(_, pose)| *pose));
        let mut pairs = Vec::new();
        let mut add = |a, b, kind| pairs.push(Pair { a, b, kind, rule: Rule::Apart, reserve_m: f64::NEG_INFINITY });
        for (i, solid) in robot.solids.iter().enumerate() {
            (0..objects).for_each(|o| add(i, links + o, PairKind::LinkObject { link: solid.link, object: o }));
            (first_fixed..solids.len()).for_each(|f| add(i, f, PairKind::Other));
        }
        robot.self_pairs.iter().for_each(|&(a, b)| add(a, b, PairKind::Other));
        for o in 0..objects {
            for f in 0..world.fixed.len() {
                add(links + o, first_fixed + f, PairKind::ObjectFixed { object: o, fixed: f });
            }
            (o + 1..objects).for_each(|other| add(links + o, links + other, PairKind::Other));
        }
        Self {
            has_moved: vec![true; solids.len()],
            centres: solids.iter().zip(&poses).map(|(solid, pose)| solid.world_centre(pose)).collect(),
            solids,
            poses,
            pairs,
            links,
            lift_m: support_m + LIFT_SLACK_M,
            travelled_m: 0.0,
            states: 0,
            exact_tests: 0,
            smallest: None,
        }
    }

    /// Decides anew how each pair is treated; the next check looks at all of them.
    pub(super) fn set_rules(&mut self, rule: impl Fn(PairKind) -> Rule) {
        for pair in &mut self.pairs {
            pair.rule = rule(pair.kind);
            pair.reserve_m = f64::NEG_INFINITY;
        }
        self.has_moved.fill(true);
    }

    /// Puts links and objects at their places, and remembers which of them that moved: none by more than `travel_m`.
    pub(super) fn place(&mut self, robot: &Robot, links: &[Isometry3<f64>], objects: &[Isometry3<f64>], travel_m: f64) {
        self.travelled_m += travel_m;
        let of_links =
            robot.solids.iter().map(|s| links.get(s.link).map_or(s.link_from_solid, |l| l * s.link_from_solid));
        let all = of_links.chain(objects.iter().copied());
        let places = self.poses.iter_mut().zip(&mut self.centres).zip(&mut self.has_moved).zip(&self.solids);
        for ((((pose, centre), moved), solid), new) in places.zip(all) {
            if *pose != new {
                *moved = true;
                *pose = new;
                *centre = solid.world_centre(pose);
            }
        }
    }

    /// Looks at every pair of which one has moved since the last call.
    pub(super) fn check(&mut self, step: u32, time: f64) -> Result<(), Hit> {
        self.states += 1;
        for pair in &mut self.pairs {
            let (a, b) = (pair.a, pair.b);
            if pair.rule == Rule::Free || !(self.has_moved[a] || self.has_moved[b]) {
                continue;
            }
            // OPTIMIZATION: two solids that were far apart a moment ago still are; both may have moved.
            let nearest = self.smallest.as_ref().map_or(f64::INFINITY, |s| s.distance_m);
            let since_m = 2.0 * self.travelled_m;
            let needed_m = if pair.rule == Rule::Apart { nearest } else { 0.0 };
            if pair.reserve_m - since_m > needed_m + ROUNDING_M {
                continue;
            }
            let (solid_a, solid_b) = (&self.solids[a], &self.solids[b]);
            let mut lifted = self.poses[a];
            let mut placed_a = Placed { solid: solid_a, world_from_solid: &self.poses[a], centre: self.centres[a] };
            if pair.rule == Rule::Standing {
                lifted.translation.z += self.lift_m;
                placed_a.world_from_solid = &lifted;
                placed_a.centre.z += self.lift_m;
            }
            let placed_b = Placed { solid: solid_b, world_from_solid: &self.poses[b], centre: self.centres[b] };
            let bound = lower_bound(&placed_a, &placed_b);
            let (pose_a, pose_b) = (placed_a.world_from_solid, placed_b.world_from_solid);
            let is_counted = pair.rule == Rule::Apart && bound < nearest;
            if bound > 0.0 && !is_counted {
                pair.reserve_m = bound + since_m;
                continue;
            }
            self.exact_tests += 1;
            let names = || (solid_a.name().to_owned(), solid_b.name().to_owned());
            // A pose that the oracle refuses counts as a collision.
            let Ok(answer) = exact(solid_a, pose_a, solid_b, pose_b) else {
                return Err(Hit { names: names(), place: Point3::from(pose_a.translation.vector) });
            };
            if answer.intersects {
                return Err(Hit { names: names(), place: answer.place });
            }
            pair.reserve_m = answer.distance + since_m;
            if is_counted && answer.distance < nearest {
                self.smallest = Some(SmallestClearance { distance_m: answer.distance, bodies: names(), step, time });
            }
        }
        self.has_moved.fill(false);
        Ok(())
    }

    /// The solid and the pose of an object.
    pub(super) fn object(&self, object: usize) -> (&Solid, &Isometry3<f64>) {
        (&self.solids[self.links + object], &self.poses[self.links + object])
    }

    /// The solid and the pose of one of the robot's solids.
    pub(super) fn link_solid(&self, index: usize) -> (&Solid, &Isometry3<f64>) {
        (&self.solids[index], &self.poses[index])
    }
}
