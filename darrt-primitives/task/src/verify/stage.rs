//! All solids at their places, and which pairs may not touch.

mod enough;
mod plain;

use std::collections::BTreeMap;

use darrt_geom::Shape;
use nalgebra::{Isometry3, Point3, Vector3};

use super::approach::{Movers, Speeds};
use super::margins::{self, MarginKind, Margins, NEARLY_M, STRAY_M};
use super::region::Region;
use super::robot::{LinkSolid, Robot};
use super::schedule::{AHEAD_PARTS, Class, Due, Going, Pairs, ROUNDING_M, RULES, smaller};
use super::solid::{Placed, Solid, exact, gap_across, lower_bound};
use super::world::World;

/// Slack on top of the depth to which an object may press into what carries it, metres.
const LIFT_SLACK_M: f64 = 1e-4;

/// Part of the smallest distance seen so far below which a pair is looked at again, though it cannot touch yet. The smallest
/// clearance is known to within this part.
const SOUGHT: f64 = 0.5;

/// Part of the distance last measured down to which the direction across it is kept.
const FRESH: f64 = 0.5;

/// How a pair is treated during a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// They may not touch, and keep a margin.
    Apart(MarginKind),
    /// They may.
    Free,
    /// The first stands on the second: lifted a little it must be clear of it.
    Standing,
}

/// What a pair consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PairKind {
    /// A link and an object, by index.
    LinkObject { link: usize, object: usize },
    /// A link and a fixed body, by index.
    LinkFixed { link: usize, fixed: usize },
    /// An object and a fixed body, by index.
    ObjectFixed { object: usize, fixed: usize },
    /// Two objects, by index.
    Objects(usize, usize),
    /// Two links.
    Links,
}

#[derive(Debug)]
struct Pair {
    a: usize,
    b: usize,
    kind: PairKind,
    rule: Rule,
    /// Nearer than its margin the pair may be down to this distance, metres; infinite if it may not.
    may_m: f64,
    /// The direction across which the two were last found apart, world; zero if none is known.
    across: Vector3<f64>,
    /// How far apart they were then, metres.
    apart_m: f64,
}

/// Two solids that touch and may not.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hit {
    pub(super) names: (String, String),
    pub(super) place: Point3<f64>,
}

/// Two solids that are nearer to each other than their margin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TooNear {
    pub(super) names: (String, String),
    pub(super) place: Point3<f64>,
    distance_m: f64,
    margin_m: f64,
    /// Fraction of the step.
    pub(super) time: f64,
}

impl Hit {
    /// What is wrong.
    pub(super) fn words(&self) -> String {
        format!("{} and {} collide", self.names.0, self.names.1)
    }
}

impl TooNear {
    /// What is wrong.
    pub(super) fn words(&self) -> String {
        let ((a, b), [distance, margin]) =
            (&self.names, [self.distance_m, self.margin_m].map(|metres| metres * 1000.0));
        format!("{a} and {b} are {distance:.2} mm apart, at least {margin:.2} mm must be kept")
    }
}

/// The smallest distance seen between two bodies that may not touch. Between the states looked at none came nearer than half
/// of it, resolution apart.
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
    pairs: Vec<Pair>,
    /// By solid.
    movers: Vec<Movers>,
    classes: Vec<Class>,
    /// By solid of the robot: its link, its place there, and the centre of its ball there.
    mounts: Vec<(usize, Isometry3<f64>, Point3<f64>)>,
    world_from_robot: Isometry3<f64>,
    /// By link.
    robot_from_link: Vec<Isometry3<f64>>,
    /// How often everything was placed anew, and by solid of the robot when `centres` and `poses` last took note.
    moment: u64,
    noted: Vec<[u64; 2]>,
    links: usize,
    objects: usize,
    lift_m: f64,
    /// States looked at.
    pub(super) states: u64,
    /// Questions to the oracle.
    pub(super) exact_tests: u64,
    margins: Margins,
    /// By kind of margin: the smallest distances seen, of all steps.
    pub(super) smallest: [Option<SmallestClearance>; 5],
    /// By kind of margin: those of this step that are smaller than what is wanted.
    pub(super) smallest_of_step: [Option<SmallestClearance>; 5],
    /// By kind of margin: what is nearer is measured, metres.
    nearest_m: [f64; 5],
    /// Some pairs may be nearer than their margin.
    has_exceptions: bool,
    /// The first pair of this step that is nearer than its margin. It does not end the step: two that come too near may go on
    /// to collide, which is the worse fault.
    pub(super) too_near: Option<TooNear>,
}

/// Where [`Rule::Standing`] stands among the rules, behind the kinds of margin.
const STANDING: usize = MarginKind::ALL.len();

impl Stage {
    /// `support_m`: how deep an object may press into what carries it; `region`: where the plan takes place.
    pub(super) fn new(robot: &Robot, world: &World<'_>, support_m: f64, margins: Margins, region: &Region) -> Self {
        let links = robot.solids.len();
        let objects = world.movables.len();
        let first_fixed = links + objects;
        let mut solids: Vec<Solid> = robot.solids.iter().map(|s| s.solid.clone()).collect();
        solids.extend(world.movables.iter().map(|m| m.solid.clone()));
        solids.extend(world.fixed.iter().map(|(solid, _)| solid.clone()));
        let mut poses = vec![Isometry3::identity(); first_fixed];
        poses.extend(world.fixed.iter().map(|(_, pose)| *pose));
        let all = world.fixed.iter().enumerate();
        let near: Vec<_> = all.filter(|(_, (solid, pose))| !region.is_far(solid, pose)).map(|(f, _)| f).collect();
        let mut pairs = Vec::new();
        let mut add = |a, b, kind| {
            let (across, rule) = (Vector3::zeros(), Rule::Apart(MarginKind::Itself));
            pairs.push(Pair { a, b, kind, rule, may_m: f64::INFINITY, across, apart_m: 0.0 });
        };
        for (i, solid) in robot.solids.iter().enumerate() {
            (0..objects).for_each(|o| add(i, links + o, PairKind::LinkObject { link: solid.link, object: o }));
            let lowest_m = robot.lowest_m(i);
            for f in near.iter().map(|f| first_fixed + f) {
                // What the base carries at a height of its own never comes nearer to a plane that it drives on.
                if lowest_m.is_none_or(|lowest_m| !lies_below(&solids[f], &poses[f], lowest_m)) {
                    add(i, f, PairKind::LinkFixed { link: solid.link, fixed: f - first_fixed });
                }
            }
        }
        robot.self_pairs.iter().for_each(|&(a, b)| add(a, b, PairKind::Links));
        for o in 0..objects {
            for &f in &near {
                add(links + o, first_fixed + f, PairKind::ObjectFixed { object: o, fixed: f });
            }
            (o + 1..objects).for_each(|other| add(links + o, links + other, PairKind::Objects(o, other)));
        }
        Self {
            movers: vec![Movers::NONE; solids.len()],
            classes: Vec::new(),
            mounts: robot.solids.iter().map(mount).collect(),
            world_from_robot: Isometry3::identity(),
            robot_from_link: vec![Isometry3::identity(); robot.tree.link_count()],
            moment: 0,
            noted: vec![[0; 2]; links],
            centres: solids.iter().zip(&poses).map(|(solid, pose)| solid.world_centre(pose)).collect(),
            solids,
            poses,
            pairs,
            links,
            objects,
            lift_m: support_m + LIFT_SLACK_M,
            states: 0,
            exact_tests: 0,
            margins,
            smallest: Default::default(),
            smallest_of_step: Default::default(),
            nearest_m: [f64::INFINITY; 5],
            has_exceptions: false,
            too_near: None,
        }
    }

    /// Says what moves each of the robot's solids and each object from here on; call it before [`Stage::set_rules`].
    pub(super) fn set_movers(&mut self, of_link_solid: impl Fn(usize) -> Movers, of_object: impl Fn(usize) -> Movers) {
        for (solid, slot) in self.movers.iter_mut().enumerate() {
            let is_fixed = solid >= self.links + self.objects;
            *slot = match solid.checked_sub(self.links) {
                None => of_link_solid(solid),
                Some(object) if !is_fixed => of_object(object),
                Some(_) => Movers::NONE,
            };
        }
    }

    /// Everything may be elsewhere than it was: at the next rules nothing is known of any pair.
    pub(super) fn forget(&mut self) {
        self.classes.clear();
    }

    /// Decides anew how each pair is treated; the next check looks at all those that are treated or moved in another way now
    /// (what is taken or let go may jump by what a file may be off), and of the others at those that could be near.
    pub(super) fn set_rules(&mut self, rule: impl Fn(PairKind) -> Rule) {
        let mut known = vec![(Movers::NONE, f64::NEG_INFINITY); self.pairs.len()];
        for class in std::mem::take(&mut self.classes) {
            for due in class.pairs.iter().flat_map(|pairs| &pairs.dues) {
                known[due.pair] = (class.between, due.reserve_m - class.going.travelled_m);
            }
        }
        let mut dues: BTreeMap<Movers, [Vec<Due>; RULES]> = BTreeMap::new();
        for ((index, pair), (moved, known_m)) in self.pairs.iter_mut().enumerate().zip(known) {
            let before = std::mem::replace(&mut pair.rule, rule(pair.kind));
            let between = self.movers[pair.a].between(self.movers[pair.b]);
            let dues = dues.entry(between).or_default();
            let reserve_m = if (pair.rule, between) == (before, moved) { known_m } else { f64::NEG_INFINITY };
            let due = Due { reserve_m, pair: index };
            match pair.rule {
                Rule::Free => {}
                Rule::Apart(kind) => dues[kind.index()].push(due),
                Rule::Standing => dues[STANDING].push(due),
            }
        }
        let class = |(between, dues): (Movers, [Vec<Due>; RULES])| Class {
            between,
            pairs: dues.map(Pairs::new),
            ..Class::default()
        };
        self.classes = dues.into_iter().map(class).collect();
    }

    /// Says how fast things move in the segment that begins here, which has `parts` equal parts. `skips`: states at which
    /// nothing need be looked at are left out ([`Stage::idle_parts`]).
    pub(super) fn set_speeds(&mut self, speeds: &Speeds, parts: usize, skips: bool) {
        for class in &mut self.classes {
            let part_m = speeds.of(class.between) / parts.max(1) as f64;
            class.going.part_m = part_m;
            class.going.ahead_m = if skips { AHEAD_PARTS * part_m } else { 0.0 };
            class.due_m = f64::NEG_INFINITY;
        }
    }

    /// Puts links and objects at their places, `parts` parts of the segment farther on. `robot_from_link` stands by link;
    /// there are as many as the robot has.
    pub(super) fn place(
        &mut self,
        world_from_robot: &Isometry3<f64>,
        robot_from_link: &[Isometry3<f64>],
        objects: &[Isometry3<f64>],
        parts: usize,
    ) {
        for class in &mut self.classes {
            class.going.travelled_m += class.going.part_m * parts as f64;
        }
        self.moment += 1;
        self.world_from_robot = *world_from_robot;
        self.robot_from_link.copy_from_slice(robot_from_link);
        for (object, pose) in objects.iter().enumerate() {
            self.put(self.links + object, *pose);
        }
    }

    fn put(&mut self, solid: usize, world_from_solid: Isometry3<f64>) {
        self.centres[solid] = self.solids[solid].world_centre(&world_from_solid);
        self.poses[solid] = world_from_solid;
    }

    /// World centre of the ball around a solid.
    #[inline]
    fn centre(&mut self, solid: usize) -> Point3<f64> {
        // OPTIMIZATION: of most solids nobody asks at most states, and of most others only for this.
        if let Some([noted, _]) = self.noted.get_mut(solid)
            && *noted != self.moment
        {
            *noted = self.moment;
            let (link, _, centre) = &self.mounts[solid];
            self.centres[solid] = self.world_from_robot * (self.robot_from_link[*link] * centre);
        }
        self.centres[solid]
    }

    /// Takes note of where a solid of the robot is now.
    fn note(&mut self, solid: usize) {
        if self.noted.get(solid).is_some_and(|[_, noted]| *noted != self.moment) {
            self.noted[solid] = [self.moment; 2];
            self.put(solid, self.world_from_link_solid(solid));
        }
    }

    fn world_from_link_solid(&self, solid: usize) -> Isometry3<f64> {
        let (link, link_from_solid, _) = &self.mounts[solid];
        self.world_from_robot * (self.robot_from_link[*link] * link_from_solid)
    }

    /// Looks at every pair that could touch, or be nearer than any other was, since it was last looked at.
    pub(super) fn check(&mut self, step: u32, time: f64) -> Result<(), Hit> {
        self.states += 1;
        let mut classes = std::mem::take(&mut self.classes);
        let result = classes.iter_mut().try_for_each(|class| self.check_class(class, step, time));
        self.classes = classes;
        result
    }

    fn check_class(&mut self, class: &mut Class, step: u32, time: f64) -> Result<(), Hit> {
        // OPTIMIZATION: mostly none is due.
        if class.going.travelled_m < class.due_m {
            return Ok(());
        }
        let Class { pairs, going, due_m, .. } = class;
        *due_m = f64::INFINITY;
        for (rule, pairs) in pairs.iter_mut().enumerate() {
            if !pairs.dues.is_empty() {
                *due_m = due_m.min(self.check_pairs(*going, pairs, rule, step, time)?);
            }
        }
        Ok(())
    }

    /// Looks at those of the `pairs` of a class that are due, and finds out when the next one is: when the class has moved so
    /// far, metres.
    fn check_pairs(&mut self, going: Going, pairs: &mut Pairs, rule: usize, step: u32, time: f64) -> Result<f64, Hit> {
        let Going { travelled_m, part_m, ahead_m } = going;
        let of_interest_m = |stage: &Self| stage.of_interest_m(rule);
        // A pair is due when its reserve is no more than this.
        let due_m = |enough_m: f64| travelled_m + enough_m + ahead_m + ROUNDING_M;
        let first_due_m = due_m(of_interest_m(self));
        if travelled_m >= pairs.sorted_until_m || first_due_m >= pairs.least_m[1] {
            pairs.sort(travelled_m, first_due_m);
        }
        let mut least_m = f64::INFINITY;
        for due in &mut pairs.dues[..pairs.near] {
            let enough_m = of_interest_m(self);
            // Not one that was looked at before, if neither has moved to the other since.
            if due.reserve_m <= due_m(enough_m) && (part_m > 0.0 || due.reserve_m == f64::NEG_INFINITY) {
                let sought_m = enough_m + AHEAD_PARTS * part_m;
                due.reserve_m = travelled_m + self.look(due.pair, sought_m, step, time)?;
            }
            least_m = smaller(least_m, due.reserve_m);
        }
        pairs.least_m[0] = least_m;
        if part_m <= 0.0 {
            return Ok(f64::INFINITY);
        }
        Ok(travelled_m + (pairs.least_m() - due_m(of_interest_m(self))))
    }

    /// How many parts of this segment may pass before [`Stage::check`] would look at any pair again.
    pub(super) fn idle_parts(&self) -> f64 {
        let moving = self.classes.iter().filter(|class| class.going.part_m > 0.0);
        let parts = moving.map(|class| {
            let spare_m =
                class.pairs.iter().enumerate().map(|(rule, pairs)| pairs.least_m() - self.of_interest_m(rule));
            let spare_m = spare_m.fold(f64::INFINITY, f64::min);
            (spare_m - class.going.travelled_m - ROUNDING_M) / class.going.part_m
        });
        parts.fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// Pairs under this rule that are nearer than this are looked at, metres.
    fn of_interest_m(&self, rule: usize) -> f64 {
        let least_m = self.margins.least_m.get(rule).copied().unwrap_or(0.0);
        self.nearest_m.get(rule).map_or(0.0, |nearest| (SOUGHT * nearest).max(least_m))
    }

    /// Looks at one pair: a lower bound of its distance that is above its margin and, if it may be the smallest so far, exact.
    fn look(&mut self, index: usize, enough_m: f64, step: u32, time: f64) -> Result<f64, Hit> {
        let Pair { a, b, rule, may_m, .. } = self.pairs[index];
        let kind = match rule {
            Rule::Apart(kind) => Some(kind.index()),
            _ => None,
        };
        let nearest = kind.map_or(f64::NEG_INFINITY, |kind| self.nearest_m[kind]);
        let least_m = kind.map_or(0.0, |kind| self.margins.least_m[kind].min(may_m));
        let is_counted = |bound: f64| bound < nearest;
        let is_clear =
            |bound: f64, enough_m: f64| bound > 0.0 && bound >= least_m && !is_counted(bound) && bound >= enough_m;
        // OPTIMIZATION: the balls mostly suffice. That around a half space is infinite.
        let [mut centre_a, centre_b] = [a, b].map(|solid| self.centre(solid));
        if rule == Rule::Standing {
            centre_a.z += self.lift_m;
        }
        let balls = (centre_a - centre_b).norm() - self.solids[a].radius - self.solids[b].radius;
        if is_clear(balls, enough_m) {
            return Ok(balls);
        }
        for solid in [a, b] {
            self.note(solid);
        }
        let pair = &self.pairs[index];
        let (solid_a, solid_b) = (&self.solids[a], &self.solids[b]);
        let mut lifted = self.poses[a];
        let mut placed_a = Placed { solid: solid_a, world_from_solid: &self.poses[a], centre: self.centres[a] };
        if rule == Rule::Standing {
            lifted.translation.z += self.lift_m;
            placed_a.world_from_solid = &lifted;
            placed_a.centre.z += self.lift_m;
        }
        let placed_b = Placed { solid: solid_b, world_from_solid: &self.poses[b], centre: self.centres[b] };
        let mut bound = lower_bound(&placed_a, &placed_b);
        if is_clear(bound, enough_m) {
            return Ok(bound);
        }
        if pair.across != Vector3::zeros() {
            // OPTIMIZATION: what kept the two apart a moment ago mostly still does.
            bound = bound.max(gap_across(&placed_a, &placed_b, &pair.across));
            if is_clear(bound, enough_m.min(FRESH * pair.apart_m)) {
                return Ok(bound);
            }
        }
        let (pose_a, pose_b) = (placed_a.world_from_solid, placed_b.world_from_solid);
        self.exact_tests += 1;
        let names = || (solid_a.name().to_owned(), solid_b.name().to_owned());
        // A pose that the oracle refuses counts as a collision.
        let Ok(answer) = exact(solid_a, pose_a, solid_b, pose_b) else {
            return Err(Hit { names: names(), place: Point3::from(pose_a.translation.vector) });
        };
        if answer.intersects {
            return Err(Hit { names: names(), place: answer.place });
        }
        if answer.distance < least_m - margins::ROUNDING_M && self.too_near.is_none() {
            let (names, place, distance_m) = (names(), answer.place, answer.distance);
            self.too_near = Some(TooNear { names, place, distance_m, margin_m: least_m, time });
        }
        if let Some(kind) = kind
            && is_counted(bound)
            && answer.distance < nearest
        {
            let found = SmallestClearance { distance_m: answer.distance, bodies: names(), step, time };
            self.nearest_m[kind] = answer.distance;
            self.note_clearance(kind, found);
        }
        let pair = &mut self.pairs[index];
        (pair.across, pair.apart_m) = (answer.across, answer.lower);
        Ok(answer.lower.max(bound))
    }

    fn note_clearance(&mut self, kind: usize, found: SmallestClearance) {
        if self.smallest[kind].as_ref().is_none_or(|known| found.distance_m < known.distance_m) {
            self.smallest[kind] = Some(found.clone());
        }
        if found.distance_m < self.margins.wanted_m[kind] {
            self.smallest_of_step[kind] = Some(found);
        }
    }

    /// Another step begins: what is nearer than is wanted in it, or nearer than anything before, is found out.
    pub(super) fn begin_step(&mut self) {
        self.smallest_of_step = Default::default();
        for (kind, nearest) in self.nearest_m.iter_mut().enumerate() {
            let known = self.smallest[kind].as_ref().map_or(f64::INFINITY, |smallest| smallest.distance_m);
            *nearest = known.max(self.margins.wanted_m[kind]);
        }
    }

    /// Pairs that are nearer than their margin where they stand now, but apart, may be nearly as near from here on.
    pub(super) fn accept_near(&mut self) -> Vec<margins::Placed> {
        let mut found = Vec::new();
        for index in 0..self.pairs.len() {
            let Pair { a, b, rule: Rule::Apart(kind), .. } = self.pairs[index] else { continue };
            let [pose_a, pose_b] = [a, b].map(|solid| self.world_from(solid));
            if let Some(distance_m) = self.accept_pair(index, kind, (&pose_a, &pose_b)) {
                found.push(margins::Placed::new(&self.solids[a], &self.solids[b], distance_m, false));
            }
        }
        found
    }

    /// The same for an object at `world_from_object`, against the fixed bodies but for those that `carries` it, and against
    /// the other objects at `others`.
    pub(super) fn accept_at(
        &mut self,
        object: usize,
        world_from_object: &Isometry3<f64>,
        carries: impl Fn(usize) -> bool,
        others: &[Isometry3<f64>],
    ) -> Vec<margins::Placed> {
        let mut found = Vec::new();
        for index in 0..self.pairs.len() {
            let Pair { a, b, kind, .. } = self.pairs[index];
            let pose_b = match kind {
                PairKind::ObjectFixed { object: own, fixed } if own == object && !carries(fixed) => self.poses[b],
                PairKind::Objects(own, other) | PairKind::Objects(other, own) if own == object => others[other],
                _ => continue,
            };
            // Of two objects either may be the first.
            let own_is_first = a == self.links + object;
            let poses = if own_is_first { (world_from_object, &pose_b) } else { (&pose_b, world_from_object) };
            if let Some(distance_m) = self.accept_pair(index, MarginKind::Object, poses) {
                found.push(margins::Placed::new(&self.solids[a], &self.solids[b], distance_m, true));
            }
        }
        found
    }

    /// If the pair is nearer than its margin at these poses but apart: its distance in metres.
    fn accept_pair(
        &mut self,
        index: usize,
        kind: MarginKind,
        (pose_a, pose_b): (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<f64> {
        let Pair { a, b, .. } = self.pairs[index];
        let least_m = self.margins.least_m[kind.index()];
        let (solid_a, solid_b) = (&self.solids[a], &self.solids[b]);
        let placed = |solid, world_from_solid| {
            let centre = Solid::world_centre(solid, world_from_solid);
            Placed { solid, world_from_solid, centre }
        };
        if lower_bound(&placed(solid_a, pose_a), &placed(solid_b, pose_b)) >= least_m + NEARLY_M {
            return None;
        }
        let answer = exact(solid_a, pose_a, solid_b, pose_b).ok()?;
        if answer.intersects || answer.distance >= least_m + NEARLY_M {
            return None;
        }
        self.has_exceptions = true;
        let pair = &mut self.pairs[index];
        pair.may_m = pair.may_m.min((answer.distance - STRAY_M).max(0.0));
        (answer.distance < least_m - margins::ROUNDING_M).then_some(answer.distance)
    }

    /// Where a solid is now.
    fn world_from(&self, solid: usize) -> Isometry3<f64> {
        if solid < self.links { self.world_from_link_solid(solid) } else { self.poses[solid] }
    }

    /// The solid and the pose of an object.
    pub(super) fn object(&self, object: usize) -> (&Solid, &Isometry3<f64>) {
        (&self.solids[self.links + object], &self.poses[self.links + object])
    }

    /// The solid and the pose of one of the robot's solids.
    pub(super) fn link_solid(&self, index: usize) -> (&Solid, Isometry3<f64>) {
        (&self.solids[index], self.world_from_link_solid(index))
    }
}

/// How far a wheel may press into the floor that it stands on, metres: what rounding may do.
const FLOOR_SLACK_M: f64 = 1e-9;

/// Is the solid a half space under a level plane, no higher than `height_m`?
fn lies_below(solid: &Solid, pose: &Isometry3<f64>, height_m: f64) -> bool {
    let Some(Shape::HalfSpace { normal, .. }) = solid.shape() else { return false };
    let normal = pose.rotation * normal.into_inner();
    normal == Vector3::z() && pose.translation.z <= height_m + FLOOR_SLACK_M
}

/// Where a solid of the robot sits: its link, its pose there, and the centre of its ball there.
fn mount(solid: &LinkSolid) -> (usize, Isometry3<f64>, Point3<f64>) {
    (solid.link, solid.link_from_solid, solid.solid.world_centre(&solid.link_from_solid))
}
