//! What becomes of the poses of the hand in which an object is taken, or set down: alone, with an arm, with a base.
//!
//! The questions are those of Pick and Place, asked one after the other, and every answer is counted, where those actions stop
//! at the first that is good.

use std::cell::Cell;
use std::collections::BTreeMap;

use darrt_core::budget::Cancel;
use darrt_core::domain::Domain as _;
use darrt_core::goal::Goal as _;
use darrt_core::primitive::Infeasible;
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::ObjectId;
use darrt_core::validity::{Blame, BlockKind};
use darrt_primitives::action::at_work::at_work;
use darrt_primitives::action::line::{follow, follow_in_room, moved, room_for_hand};
use darrt_primitives::action::pick::drawn_grasp;
use darrt_primitives::action::place::ON_SURFACE_M;
use darrt_primitives::action::stance::{Probe, Refused};
use darrt_primitives::action::turned::turned;
use darrt_primitives::goal::{Grip, TabletopGoal};
use darrt_primitives::grasp::rim::{rim_is_graspable, rim_overhangs};
use darrt_primitives::grasp::{Grasp, GraspFamily, GraspKind};
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator};
use darrt_primitives::mode::{Contacts, Held, TouchReason};
use darrt_primitives::object_space::upright;
use darrt_primitives::tabletop::{Movable, Tabletop, TabletopState};
use nalgebra::{Isometry3, Point2, Vector3};
use rand::{Rng, RngExt as _};

use super::cause::{Blocker, Hands, Place, Stage, StageCount};

/// So many poses in which the hand alone is free are looked at, and so many more if none of them is good and each ended where
/// another base or arm might have been better.
const FREE_HANDS: u64 = 24;
const MORE_HANDS: u64 = 240;
/// For each of them so many are drawn at most: most rim grasps meet the table.
const DRAWS: u64 = 16;
/// Bases that are tried for each of them, where the robot drives,
const BASES: usize = 48;
/// and for all of them.
const MOST_BASES: u64 = 6_000;
/// Configurations of the arm for each base.
const ARMS: usize = 4;
/// Of the hands that no base reaches so many are asked how far they are beyond.
const ASKED: usize = 4;
/// How far away it is looked for places that a base reaches, metres, in steps of, and to within.
const FARTHEST_M: f64 = 2.0;
const STRIDE_M: f64 = 0.1;
const WITHIN_M: f64 = 0.01;
/// So often the arm is asked for that at most.
const MOST_ASKED: u32 = 20_000;
/// What stands for a body where the base is out of its bounds.
pub(super) const BOUNDS: &str = "the bounds of the base";
/// Bodies that are named at most.
const NAMED: usize = 8;

/// A problem whose poses are asked about.
pub(super) struct Look<'a, M: Manipulator> {
    pub(super) m: &'a Tabletop<M>,
    pub(super) start: &'a TabletopState<M>,
    pub(super) goal: &'a TabletopGoal<M::Joints>,
    /// Is it enough to see whether something good is easily found?
    pub(super) is_quick: bool,
    /// Ends the tries.
    pub(super) cancel: &'a Cancel,
}

impl<M: Manipulator> Clone for Look<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Manipulator> Copy for Look<'_, M> {}

/// One pose of the hand, and what it does there.
pub(super) struct Case<'a> {
    pub(super) grasp: Grasp,
    pub(super) family: &'a dyn GraspFamily,
    /// Where the object is.
    pub(super) pose: Isometry3<f64>,
}

/// What was found for one place.
pub(super) struct Survey<'a> {
    pub(super) hands: Hands,
    /// What can be used, and where the robot then stands.
    pub(super) good: Vec<(Case<'a>, [f64; 3])>,
    /// The places of goals that were refused as such, and how far inside an edge they are.
    pub(super) off_support_m: Vec<f64>,
}

/// Where a pose came to an end, and at what.
struct End {
    stage: Stage,
    body: Option<String>,
}

impl End {
    fn at(stage: Stage) -> Self {
        Self { stage, body: None }
    }
}

/// The body of `blame` that is neither the robot nor what it handles.
pub(super) fn culprit<M: Manipulator>(m: &Tabletop<M>, object: ObjectId, blame: &Blame) -> String {
    if blame.kind == BlockKind::RobotItself {
        return "the robot itself".to_owned();
    }
    let own = m.movable(object).map(|movable| &*movable.body.name);
    let is_other = |name: &str| {
        let is_link = m.manipulator().links().iter().any(|link| &*link.body.name == name);
        !is_link && Some(name) != own
    };
    let name = [&blame.second, &blame.first].into_iter().find(|name| is_other(name)).unwrap_or(&blame.second);
    name.to_string()
}

/// Counts by body as a list, most first.
pub(super) fn ranked(counts: BTreeMap<String, u64>) -> Vec<Blocker> {
    let mut all: Vec<_> = counts.into_iter().map(|(body, count)| Blocker { body, count }).collect();
    all.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.body.cmp(&b.body)));
    all.truncate(NAMED);
    all
}

impl<'a, M: Manipulator> Look<'a, M> {
    /// What becomes of the hands that take the object where it is in `state`.
    pub(super) fn taking(&self, state: &TabletopState<M>, id: ObjectId, place: Place) -> Survey<'a> {
        let here = state.object(id).copied();
        self.survey(state, id, place, |_, case, ends| ends.of_taking(case), |_| here)
    }

    /// What becomes of the hands that bring the object to one of its goals, the other objects standing as in `state`.
    pub(super) fn arriving(&self, state: &TabletopState<M>, id: ObjectId) -> Survey<'a> {
        let groups = self.goal.groups().iter().filter(|group| group.iter().any(|goal| goal.object == id));
        let alone = TabletopGoal::new(groups.cloned().collect());
        let is_in_hand = alone.groups().iter().flatten().all(|goal| goal.grip == Grip::Held);
        let may_be_in_hand = alone.groups().iter().flatten().any(|goal| goal.grip != Grip::Released);
        let of_case = |_: &Self, case: &Case<'_>, ends: &mut Ends<'_, '_, M>| {
            let is_in_air = || self.m.surface_under(id, &case.pose, ON_SURFACE_M).is_none();
            if is_in_hand || (may_be_in_hand && is_in_air()) {
                ends.of_holding(case)
            } else {
                ends.of_setting_down(case)
            }
        };
        self.survey(state, id, Place::Goal, of_case, |rng| alone.sample(self.m, rng)?.object(id).copied())
    }

    fn survey(
        &self,
        state: &TabletopState<M>,
        id: ObjectId,
        place: Place,
        of_case: impl Fn(&Self, &Case<'_>, &mut Ends<'_, '_, M>) -> Result<Configuration<M::Joints>, End>,
        pose: impl Fn(&mut dyn Rng) -> Option<Isometry3<f64>>,
    ) -> Survey<'a> {
        let mut ends = BTreeMap::<Stage, (u64, BTreeMap<String, u64>)>::new();
        let (mut good, mut off_support_m, mut unreached) = (Vec::new(), Vec::new(), Vec::new());
        let (mut tried, mut free, mut bases) = (0, 0, 0);
        let movable = self.m.movable(id);
        let mut wanted = FREE_HANDS;
        while let Some(movable) = movable
            .filter(|_| tried < DRAWS * wanted && free < wanted && bases < MOST_BASES && !self.cancel.is_cancelled())
        {
            let rng = &mut stream(0, 0, tried, Purpose::Attempt);
            tried += 1;
            // Any hand will do.
            let state = &*at_work(self.m, state, rng);
            let end = match (draw(self.m, state.robot.arm.hand_at_work(), movable, rng), pose(rng)) {
                (Some((grasp, family)), Some(pose)) => {
                    let case = Case { grasp, family, pose };
                    let mut asked = Ends { look: self, state, id, movable, rng, bases: 0 };
                    let end = of_case(self, &case, &mut asked);
                    bases += asked.bases;
                    match end {
                        Ok(q) => {
                            good.push((case, q.base));
                            free += 1;
                            continue;
                        }
                        Err(end) => {
                            if end.stage == Stage::Support {
                                off_support_m.push(self.inside_m(id, &case.pose));
                            }
                            if [Stage::Reach, Stage::Stand].contains(&end.stage) && unreached.len() < ASKED {
                                unreached.push(case.grasp.world_from_tool(&case.pose));
                            }
                            end
                        }
                    }
                }
                (None, _) => End::at(Stage::Hold),
                (_, None) => End::at(Stage::Support),
            };
            free += u64::from(end.stage > Stage::Approach);
            if free == FREE_HANDS && good.is_empty() && !self.is_quick {
                wanted = MORE_HANDS;
            }
            let (count, bodies) = ends.entry(end.stage).or_default();
            *count += 1;
            if let Some(body) = end.body {
                *bodies.entry(body).or_default() += 1;
            }
        }
        let last = ends.last_key_value().map(|(stage, _)| *stage);
        let is_far = good.is_empty() && last.is_some_and(|last| [Stage::Reach, Stage::Stand].contains(&last));
        let beyond_m = is_far.then(|| self.beyond_m(state, &unreached)).flatten();
        let blockers = ends.last_key_value().map(|(_, (_, bodies))| ranked(bodies.clone())).unwrap_or_default();
        let ends = ends.iter().map(|(stage, (count, _))| StageCount { stage: *stage, count: *count }).collect();
        let object = movable.map_or_else(String::new, |movable| movable.body.name.to_string());
        let hands = Hands { object, place, tried, good: good.len() as u64, ends, blockers, bases, beyond_m };
        Survey { hands, good, off_support_m }
    }

    /// The robot at `case` where it takes the object where it is in `state`; else the stage at which that ends, what is in the way
    /// there, and how many bases were tried.
    pub(super) fn takes(
        &self,
        state: &TabletopState<M>,
        id: ObjectId,
        case: &Case<'_>,
    ) -> Result<Configuration<M::Joints>, (Stage, Option<String>, u64)> {
        let Some(movable) = self.m.movable(id) else { return Err((Stage::Hold, None, 0)) };
        let rng = &mut stream(0, 8, 0, Purpose::Attempt);
        let mut ends = Ends { look: self, state, id, movable, rng, bases: 0 };
        let found = ends.of_taking(case);
        found.map_err(|end| (end.stage, end.body, ends.bases))
    }

    /// Does `case` set the object down at its goal, in some of `tries` draws of bases? The last end if not.
    pub(super) fn sets_down(
        &self,
        state: &TabletopState<M>,
        id: ObjectId,
        case: &Case<'_>,
        i: u64,
    ) -> Result<(), Option<String>> {
        let Some(movable) = self.m.movable(id) else { return Err(None) };
        let rng = &mut stream(0, 1, i, Purpose::Attempt);
        let mut ends = Ends { look: self, state, id, movable, rng, bases: 0 };
        ends.of_setting_down(case).map(drop).map_err(|end| end.body)
    }

    /// A place of the object's goals.
    pub(super) fn goal_pose(&self, id: ObjectId, draw: u64) -> Option<Isometry3<f64>> {
        let groups = self.goal.groups().iter().filter(|group| group.iter().any(|goal| goal.object == id));
        let alone = TabletopGoal::new(groups.cloned().collect());
        alone.sample(self.m, &mut stream(0, 5, draw, Purpose::Attempt))?.object(id).copied()
    }

    /// How far inside the edges of what it may stand on the object is at `pose`, metres; negative beside them all.
    fn inside_m(&self, id: ObjectId, pose: &Isometry3<f64>) -> f64 {
        let at = Point2::from(pose.translation.vector.xy());
        let surfaces = self.m.movable(id).into_iter().flat_map(|movable| &movable.surfaces);
        surfaces
            .filter_map(|id| self.m.surface(*id))
            .map(|surface| surface.depth(&at))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// How far the nearest of these hands is from a place where a base that is free reaches it; `None` if none was found.
    pub(super) fn beyond_m(&self, state: &TabletopState<M>, hands: &[Isometry3<f64>]) -> Option<f64> {
        let slanted = std::f64::consts::FRAC_1_SQRT_2;
        let sides = [(1.0, 0.0), (slanted, slanted), (0.0, 1.0), (-slanted, slanted)];
        let level = sides.into_iter().flat_map(|(x, y)| [Vector3::new(x, y, 0.0), Vector3::new(-x, -y, 0.0)]);
        let directions: Vec<_> = [-Vector3::z(), Vector3::z()].into_iter().chain(level).collect();
        let left = Cell::new(MOST_ASKED);
        let mut best = None::<f64>;
        for (index, hand) in hands.iter().enumerate().take_while(|_| !self.cancel.is_cancelled()) {
            for (side, direction) in directions.iter().enumerate() {
                let reaches = |far_m: f64| {
                    let rng = &mut stream(0, 2 + side as u64, index as u64, Purpose::Attempt);
                    self.is_reached(state, &moved(hand, direction, far_m), rng, &left)
                };
                let most_m = best.unwrap_or(FARTHEST_M);
                let strides = (1..).map(|i| f64::from(i) * STRIDE_M).take_while(|far_m| *far_m < most_m + STRIDE_M);
                let Some(mut far_m) = strides.into_iter().find(|far_m| reaches(*far_m)) else { continue };
                let mut near_m = far_m - STRIDE_M;
                while far_m - near_m > WITHIN_M {
                    let middle_m = near_m.midpoint(far_m);
                    if reaches(middle_m) { far_m = middle_m } else { near_m = middle_m }
                }
                best = Some(best.map_or(far_m, |best| best.min(far_m)));
            }
        }
        // Who has not asked everywhere does not know the nearest.
        best.filter(|_| left.get() > 0)
    }

    /// How many bases are tried for a hand.
    fn bases(&self) -> usize {
        if self.m.settings().drives.contains(&true) { BASES } else { 1 }
    }

    /// Does a base reach `tool`? `left`: how often the arm may still be asked.
    fn is_reached(&self, state: &TabletopState<M>, tool: &Isometry3<f64>, rng: &mut dyn Rng, left: &Cell<u32>) -> bool {
        let robot = self.m.manipulator();
        let state = &*at_work(self.m, state, rng);
        let hand = state.robot.arm.hand_at_work();
        (0..self.bases()).any(|_| {
            let base = self.base_for(state, tool, rng);
            let q = Configuration { base, arm: state.robot.arm };
            robot.may_reach_with(hand, &base, tool)
                && self.m.robot().base().contains(&base)
                && self.m.collision_scene().is_base_clear(robot, &q)
                && (0..ARMS).any(|_| {
                    left.set(left.get().saturating_sub(1));
                    left.get() > 0 && robot.inverse_from(&state.robot.arm, &base, tool, rng).is_some()
                })
        })
    }

    /// A base from which the arm may reach; the present one where it cannot drive.
    fn base_for(&self, state: &TabletopState<M>, tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        // The hand is taken to be empty before, and full behind.
        if self.m.settings().drives.contains(&true) {
            self.m.manipulator().base_for_hand(state.robot.arm.hand_at_work(), tool, rng)
        } else {
            state.robot.base
        }
    }
}

/// A grasp of the object that holds it, if there is one.
fn draw<'a, M: Manipulator>(
    m: &Tabletop<M>,
    hand: usize,
    movable: &'a Movable,
    rng: &mut dyn Rng,
) -> Option<(Grasp, &'a dyn GraspFamily)> {
    let count = movable.grasps.len();
    let family = movable.grasps.get(if count > 0 { rng.random_range(0..count) } else { 0 })?;
    let mut grasp = drawn_grasp(m, hand, &**family, rng)?;
    grasp.open_gap_m = grasp.open_gap_m.min(m.manipulator().hand_of(hand).max_gap_m());
    m.hold(hand, movable, &**family, &grasp).ok()?;
    Some((grasp, &**family))
}

/// Asks about one pose of the hand.
struct Ends<'b, 'a, M: Manipulator> {
    look: &'b Look<'a, M>,
    state: &'b TabletopState<M>,
    id: ObjectId,
    movable: &'a Movable,
    rng: &'b mut dyn Rng,
    /// Bases tried.
    bases: u64,
}

impl<M: Manipulator> Ends<'_, '_, M> {
    fn m(&self) -> &Tabletop<M> {
        self.look.m
    }

    fn blamed(&self, stage: Stage, blame: Option<Blame>) -> End {
        End { stage, body: blame.map(|blame| culprit(self.look.m, self.id, &blame)) }
    }

    /// The one that is asked about.
    fn hand(&self) -> usize {
        self.state.robot.arm.hand_at_work()
    }

    /// Whether the object itself meets something where it is in `state`, and what.
    fn no_room(&self, state: &TabletopState<M>) -> Option<End> {
        let (m, contacts) = (self.look.m, Contacts::default());
        let blame = m.collision_scene().without_robot().check(m.manipulator(), state, &contacts).err()?;
        let own = &self.movable.body.name;
        (blame.first == *own || blame.second == *own).then(|| self.blamed(Stage::Room, Some(blame)))
    }

    fn refused(&self, stage: Stage, refused: &Refused<M>) -> End {
        match refused.why(self.look.m) {
            Infeasible::Blocked(blame) => self.blamed(stage, Some(blame)),
            _ => End::at(stage),
        }
    }

    /// Where the hand that takes the object ends; the robot if it does not.
    fn of_taking(&mut self, case: &Case<'_>) -> Result<Configuration<M::Joints>, End> {
        let (m, id, grasp) = (self.look.m, self.id, &case.grasp);
        self.check_overhang(case)?;
        let tool = grasp.world_from_tool(&self.turned(case, &case.pose));
        let beside = self.state.mode.engaged_with(id).and_then(|mode| mode.opened_to(grasp.open_gap_m));
        let Some(beside) = beside else { return Err(End::at(Stage::Hold)) };
        let open = straddling(id, grasp);
        let mut probe = Probe::new(m, self.state, beside.clone());
        probe.check_hand(&tool, &open).map_err(|blame| self.blamed(Stage::Hand, Some(blame)))?;
        let (back, none) = (tool.rotation * -Vector3::x(), Contacts::default());
        let room = room_for_hand(m, grasp.approach_m, &tool, &back, |at, care| probe.is_hand_clear(at, &none, care))
            .map_err(|at| self.blamed(Stage::Approach, probe.check_hand(&at, &none).err()))?;
        let held = self.held(case);
        let lifted = held.and_then(|held| beside.attached(held, grasp.closed_gap_m));
        let Some(lifted) = lifted else { return Err(End::at(Stage::Hold)) };
        let mut above = Probe::new(m, self.state, lifted);
        let [least_m, best_m] = self.movable.lift_m;
        self.stand(&tool, |this, q| {
            this.check(&mut probe, q, &open)?;
            follow_in_room(m, q, &tool, &back, room, |q| probe.check_all(q, &none, 0))
                .map_err(|why| this.refused(Stage::Line, &why))?;
            let up = follow(m, &q.base, &q.arm, &tool, &(Vector3::z() * best_m));
            let Some(arm) = up.arms.last().copied().filter(|_| up.reached_m() >= least_m) else {
                return Err(End::at(Stage::Line));
            };
            above
                .check_all(&Configuration { base: q.base, arm }, &none, 0)
                .map_err(|why| this.refused(Stage::Line, &why))
        })
    }

    /// Where the hand that sets the object down ends; the robot if it does not.
    fn of_setting_down(&mut self, case: &Case<'_>) -> Result<Configuration<M::Joints>, End> {
        let (m, id) = (self.look.m, self.id);
        let Some(surface) = m.surface_under(id, &case.pose, ON_SURFACE_M) else {
            return Err(End::at(Stage::Support));
        };
        if !m.keeps_from_edge(id, surface, &Point2::from(case.pose.translation.vector.xy())) {
            return Err(End::at(Stage::Support));
        }
        let Some(holding) =
            self.held(case).and_then(|held| self.state.mode.engaged_with(id)?.attached(held, case.grasp.closed_gap_m))
        else {
            return Err(End::at(Stage::Hold));
        };
        let open_m = case.grasp.closed_gap_m + m.settings().place.release_opening_m;
        let released = holding.released_on(surface, open_m.min(m.manipulator().hand_of(self.hand()).max_gap_m()));
        let Some(released) = released else { return Err(End::at(Stage::Hold)) };
        let standing = m.surface(surface).map_or(case.pose.translation.z, |s| s.height() + self.movable.half_height_m);
        let (yaw, at) = (case.pose.rotation.euler_angles().2, case.pose.translation.vector);
        let pose = self.turned(case, &upright(Vector3::new(at.x, at.y, standing), yaw));
        let tool = case.grasp.world_from_tool(&pose);
        let (mut before, mut after) = (Probe::new(m, self.state, holding), Probe::new(m, self.state, released));
        before.place(id, &pose);
        after.place(id, &pose);
        let letting_go = Contacts { fingers: Some((id, TouchReason::Grasp)), support: Some((id, surface)) };
        for probe in [&before, &after] {
            probe.check_hand(&tool, &letting_go).map_err(|blame| {
                self.no_room(after.state()).unwrap_or_else(|| self.blamed(Stage::Hand, Some(blame)))
            })?;
        }
        let none = Contacts::default();
        let directions = &m.settings().place.approach_directions;
        let down = directions.get(self.rng.random_range(0..directions.len().max(1))).copied().unwrap_or(-Vector3::z());
        let tool_from_object = case.grasp.object_from_tool.inverse();
        let room = room_for_hand(m, m.settings().place.approach_m, &tool, &-down, |at, care| {
            before.place(id, &(at * tool_from_object));
            before.is_hand_clear(at, &none, care)
        });
        let room = room.map_err(|at| self.blamed(Stage::Approach, before.check_hand(&at, &none).err()))?;
        self.stand(&tool, |this, q| {
            this.check(&mut after, q, &letting_go)?;
            let line = follow_in_room(m, q, &tool, &-down, room, |q| before.check_all(q, &none, 0));
            line.map(drop).map_err(|why| this.refused(Stage::Line, &why))
        })
    }

    /// Where the hand that holds the object in the air ends; the robot if it does not.
    fn of_holding(&mut self, case: &Case<'_>) -> Result<Configuration<M::Joints>, End> {
        let (m, id) = (self.look.m, self.id);
        let holding =
            self.held(case).and_then(|held| self.state.mode.engaged_with(id)?.attached(held, case.grasp.closed_gap_m));
        let Some(holding) = holding else { return Err(End::at(Stage::Hold)) };
        let tool = case.grasp.world_from_tool(&self.turned(case, &case.pose));
        let mut probe = Probe::new(m, self.state, holding);
        probe.place(id, &case.pose);
        let none = Contacts::default();
        probe.check_hand(&tool, &none).map_err(|blame| self.blamed(Stage::Hand, Some(blame)))?;
        self.stand(&tool, |this, q| this.check(&mut probe, q, &none))
    }

    /// Where the object is, turned as the arm wants it if it looks alike from all sides.
    fn turned(&mut self, case: &Case<'_>, pose: &Isometry3<f64>) -> Isometry3<f64> {
        turned(
            self.look.m,
            (self.id, self.hand()),
            &self.state.robot.base,
            pose,
            &case.grasp.object_from_tool,
            self.rng,
        )
    }

    fn check_overhang(&self, case: &Case<'_>) -> Result<(), End> {
        let lies_flat = || End::at(Stage::Overhang);
        let is_rim = case.family.needs_overhang();
        let Some(surface) = self.state.mode.support_of(self.id).and_then(|id| self.m().surface(id)) else {
            return Ok(());
        };
        let (rim, centre) = (&self.movable.rim, Point2::from(case.pose.translation.vector.xy()));
        let Some(radius_m) = self.movable.round_radius_m.filter(|_| is_rim) else { return Ok(()) };
        if !rim_overhangs(surface, &centre, radius_m, rim.insertion, rim.clearance) {
            return Err(lies_flat());
        }
        let GraspKind::Rim { azimuth, .. } = case.grasp.kind else { return Ok(()) };
        let azimuth = azimuth + case.pose.rotation.euler_angles().2;
        let fits = rim_is_graspable(surface, &centre, radius_m, azimuth, rim.insertion, rim.clearance);
        let under = self.state.mode.support_of(self.id).and_then(|id| self.m().supports().get(id.index()));
        let body = under.and_then(|support| support.bodies.first()).map(ToString::to_string);
        if fits { Ok(()) } else { Err(End { stage: Stage::Hand, body }) }
    }

    fn held(&self, case: &Case<'_>) -> Option<Held> {
        let hold = self.m().hold(self.hand(), self.movable, case.family, &case.grasp).ok()?;
        let tool_from_object = case.grasp.object_from_tool.inverse();
        Some(Held { object: self.id, tool_from_object, max_tilt_rad: hold.max_tilt_rad })
    }

    /// Is nothing in the way of the robot at `q`?
    fn check(&self, probe: &mut Probe<'_, M>, q: &Configuration<M::Joints>, contacts: &Contacts) -> Result<(), End> {
        probe.check_all(q, contacts, 0).map_err(|why| self.refused(Stage::Arm, &why))
    }

    /// The first base and arm with the hand at `tool` of which `good` says so; else the end that came farthest.
    fn stand(
        &mut self,
        tool: &Isometry3<f64>,
        mut good: impl FnMut(&Self, &Configuration<M::Joints>) -> Result<(), End>,
    ) -> Result<Configuration<M::Joints>, End> {
        let robot = self.look.m.manipulator();
        let mut farthest = End::at(Stage::Reach);
        let mut note = |end: End| {
            if end.stage > farthest.stage || (end.stage == farthest.stage && farthest.body.is_none()) {
                farthest = end;
            }
        };
        for _ in 0..self.look.bases() {
            let base = self.look.base_for(self.state, tool, self.rng);
            self.bases += 1;
            if !robot.may_reach_with(self.hand(), &base, tool) {
                continue;
            }
            let mut is_free = None;
            for _ in 0..ARMS {
                let Some(arm) = robot.inverse_from(&self.state.robot.arm, &base, tool, self.rng) else { break };
                let q = Configuration { base, arm };
                if !*is_free.get_or_insert_with(|| self.is_free(&q).map_err(&mut note).is_ok()) {
                    break;
                }
                match good(self, &q) {
                    Ok(()) => return Ok(q),
                    Err(end) => note(end),
                }
            }
        }
        Err(farthest)
    }

    /// May the base stand there?
    fn is_free(&self, q: &Configuration<M::Joints>) -> Result<(), End> {
        if !self.m().robot().base().contains(&q.base) {
            return Err(End { stage: Stage::Stand, body: Some(BOUNDS.to_owned()) });
        }
        let found = self.m().collision_scene().check_base(self.m().manipulator(), q);
        found.map_err(|blame| self.blamed(Stage::Stand, Some(blame)))
    }
}

/// What the open fingers may touch around the object: a bowl's inner finger stands inside the solid that stands for the bowl.
fn straddling(object: ObjectId, grasp: &Grasp) -> Contacts {
    match grasp.kind {
        GraspKind::Wall { .. } => Contacts { fingers: Some((object, TouchReason::Grasp)), support: None },
        _ => Contacts::default(),
    }
}
