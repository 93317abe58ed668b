//! Replays a plan step by step.

use nalgebra::{Isometry3, Point2, Vector2};

use super::goal;
use super::hand::{PushCore, check_grip};
use super::mode::{Act, Mode, Permits, drives};
use super::motion::{Changes, Segment, State};
use super::options::VerifyOptions;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::{Robot, Role};
use super::stage::{Hit, PairKind, Rule, Stage};
use super::world::World;
use super::{Proof, start};
use crate::plan_file::{PlanFile, Step, Waypoint};
use crate::problem_file::PrimitiveName;

/// A pushed object that goes less than this in a segment stands still, metres.
const STANDS_M: f64 = 1e-9;

/// Everything needed while a plan is replayed.
pub(super) struct Judge<'a> {
    plan: &'a PlanFile,
    options: &'a VerifyOptions,
    robot: Robot,
    world: World<'a>,
    stage: Stage,
    /// By object.
    modes: Vec<Mode>,
    /// Poses of all links, overwritten at every state.
    links: Vec<Isometry3<f64>>,
    waypoints: usize,
}

/// One step under judgement.
struct Trial<'a> {
    site: Site,
    step: &'a Step,
    act: Act,
    /// See [`Robot::travel_rates`].
    rates: Vec<f64>,
    core: Option<PushCore>,
    /// The tool at both ends of a straight line.
    line: Option<[Isometry3<f64>; 2]>,
}

/// One segment of a step.
#[derive(Clone, Copy)]
struct Place {
    /// From 0.
    index: usize,
    count: usize,
}

impl Place {
    fn time(self, s: f64) -> f64 {
        (self.index as f64 + s) / self.count as f64
    }

    fn is_first(self) -> bool {
        self.index == 0
    }

    fn is_last(self) -> bool {
        self.index + 1 == self.count
    }
}

impl<'a> Judge<'a> {
    pub(super) fn new(plan: &'a PlanFile, options: &'a VerifyOptions) -> Result<Self, Refusal> {
        let name = format!("problem `{}` in the plan", plan.problem.name);
        plan.problem.validate(&name).map_err(|e| Refusal::whole(RefusalKind::Problem, e.to_string()))?;
        let robot = Robot::new(&plan.problem)?;
        let world = World::new(&plan.problem)?;
        let stage = Stage::new(&robot, &world, options.support_m);
        let modes = world.movables.iter().map(|m| Mode::Resting { surface: m.start_surface }).collect();
        Ok(Self { plan, options, robot, world, stage, modes, links: Vec::new(), waypoints: 0 })
    }

    /// The whole plan.
    pub(super) fn run(mut self) -> Result<Proof, Refusal> {
        let mut here = self.start()?;
        let mut last = &self.plan.start;
        for (number, step) in (1..).zip(&self.plan.steps) {
            let site = Site { step: number, primitive: step.primitive };
            here = self.step(site, step, last, here)?;
            last = step.waypoints.last().unwrap_or(last);
        }
        goal::check(&self.plan.problem, &self.world, &here, &self.modes)?;
        Ok(Proof {
            steps: self.plan.steps.len(),
            waypoints: self.waypoints,
            states: self.stage.states,
            exact_tests: self.stage.exact_tests,
            smallest_clearance: self.stage.smallest,
        })
    }

    fn start(&mut self) -> Result<State, Refusal> {
        let refuse = |kind, message: String| Refusal::whole(kind, format!("the start: {message}"));
        let state = State::read(&self.plan.start, &self.robot, &self.world)
            .map_err(|flaw| refuse(RefusalKind::Malformed, flaw))?;
        start::check(&state, &self.plan.problem, &self.robot, &self.world, self.options)?;
        self.check_limits(&state).map_err(|(kind, flaw)| refuse(kind, flaw))?;
        let (world, modes) = (&self.world, &self.modes);
        self.stage.set_rules(|pair| match (pair, pair_object(pair).and_then(|o| modes.get(o))) {
            (PairKind::ObjectFixed { fixed, .. }, Some(Mode::Resting { surface }))
                if world.carries(*surface, fixed) =>
            {
                Rule::Standing
            }
            _ => Rule::Apart,
        });
        self.robot.link_poses(&state.base, &state.joints, &mut self.links);
        self.stage.place(&self.robot, &self.links, &state.objects);
        self.stage.check(0, 0.0).map_err(|hit| {
            let words = format!("{} and {} collide", hit.names.0, hit.names.1);
            refuse(RefusalKind::Collision, words).about(&hit.names.0, &hit.names.1).at(&hit.place)
        })?;
        Ok(state)
    }

    /// Judges one step from the state `here`, described by the waypoint `last`; returns where it ends.
    fn step(&mut self, site: Site, step: &'a Step, last: &Waypoint, here: State) -> Result<State, Refusal> {
        if !self.plan.problem.allows(site.primitive) {
            let text = format!("{} is not among the primitives of the problem", site.primitive);
            return Err(site.refusal(0.0, RefusalKind::Primitive, text));
        }
        let [first, _, ..] = &step.waypoints[..] else {
            let text = format!("has {} waypoints, a step has at least 2", step.waypoints.len());
            return Err(site.refusal(0.0, RefusalKind::Malformed, text));
        };
        if first != last {
            let text = format!("does not start where the step before ended: {}", difference(last, first));
            return Err(site.refusal(0.0, RefusalKind::Chain, text));
        }
        let act = Act::new(site, step, &self.world, &self.modes)?;
        let permits = Permits::new(site, step, &act, &self.robot, &self.world, &self.modes)?;
        let (world, modes) = (&self.world, &self.modes);
        self.stage.set_rules(|pair| permits.rule(pair, &act, world, modes));
        let states = self.states(site, step, here)?;
        let trial = self.trial(site, step, act, &states)?;
        let count = states.len() - 1;
        for (index, pair) in states.windows(2).enumerate() {
            if let [from, to] = pair {
                self.segment(&trial, Place { index, count }, from, to)?;
            }
        }
        self.waypoints += step.waypoints.len();
        let end = states.into_iter().next_back();
        let end = end.ok_or_else(|| site.refusal(0.0, RefusalKind::Malformed, "has no waypoints"))?;
        self.finish(&trial, &end)?;
        Ok(end)
    }

    /// The states at the waypoints, each within limits and bounds.
    fn states(&self, site: Site, step: &Step, here: State) -> Result<Vec<State>, Refusal> {
        let count = step.waypoints.len().max(2) - 1;
        let mut states = vec![here];
        for (index, waypoint) in step.waypoints.iter().enumerate().skip(1) {
            let time = index as f64 / count as f64;
            let refuse = |kind, message: String| site.refusal(time, kind, message);
            let state = State::read(waypoint, &self.robot, &self.world)
                .map_err(|flaw| refuse(RefusalKind::Malformed, format!("waypoint {index}: {flaw}")))?;
            self.check_limits(&state).map_err(|(kind, flaw)| refuse(kind, flaw))?;
            states.push(state);
        }
        Ok(states)
    }

    fn trial(&mut self, site: Site, step: &'a Step, act: Act, states: &[State]) -> Result<Trial<'a>, Refusal> {
        let held_m = act.holding.map_or(0.0, |holding| {
            let reach = self.world.movables.get(holding.object).map_or(0.0, |m| m.solid.reach());
            holding.tool_from_object.translation.vector.norm() + reach
        });
        let core = match act.pushed.and_then(|object| self.world.movables.get(object)) {
            Some(movable) => Some(
                PushCore::new(movable.spec, self.options.push_contact_m)
                    .map_err(|flaw| site.refusal(0.0, RefusalKind::Push, flaw))?,
            ),
            None => None,
        };
        let mut line = None;
        if site.primitive == PrimitiveName::StraightLineArmTransit
            && let (Some(first), Some(last)) = (states.first(), states.last())
        {
            let mut tool = |state: &State| {
                self.robot.link_poses(&state.base, &state.joints, &mut self.links);
                self.links[self.robot.tool]
            };
            line = Some([tool(first), tool(last)]);
        }
        Ok(Trial { site, step, act, rates: self.robot.travel_rates(held_m), core, line })
    }

    fn segment(&mut self, trial: &Trial<'a>, place: Place, from: &State, to: &State) -> Result<(), Refusal> {
        let segment = Segment::new(from, to, &self.robot);
        self.check_changes(trial, place, &segment)?;
        let way = trial.act.pushed.and_then(|object| pushed_way(&segment, object));
        let parts = segment.parts(&trial.rates, self.options);
        let mut now = from.clone();
        let first = usize::from(!place.is_first());
        for i in first..=parts {
            let s = i as f64 / parts as f64;
            let time = place.time(s);
            segment.robot_at(s, &mut now);
            self.robot.link_poses(&now.base, &now.joints, &mut self.links);
            self.move_objects(trial, &segment, s, &mut now)?;
            if i == 0 || i == parts {
                self.check_rigid(trial, time, &now, if i == 0 { from } else { to })?;
            }
            self.stage.place(&self.robot, &self.links, &now.objects);
            self.check_state(trial, time, &now, way)?;
        }
        if place.is_first()
            && trial.site.primitive == PrimitiveName::Pick
            && let Some(holding) = trial.act.holding
        {
            check_grip(trial.site, place.time(1.0), &self.robot, &self.stage, holding.object, self.options)?;
        }
        Ok(())
    }

    /// Puts the objects where they are at `s`: held ones by the hand, pushed ones along their way.
    fn move_objects(&self, trial: &Trial<'a>, segment: &Segment<'_>, s: f64, now: &mut State) -> Result<(), Refusal> {
        if let Some(holding) = trial.act.holding
            && let Some(pose) = now.objects.get_mut(holding.object)
        {
            *pose = self.links[self.robot.tool] * holding.tool_from_object;
        }
        if let Some(object) = trial.act.pushed
            && let (Some(pose), Some(slid)) = (now.objects.get_mut(object), segment.slid(object, s))
        {
            *pose = slid;
        }
        Ok(())
    }

    /// At a waypoint the file must put a held object where the hand has it.
    fn check_rigid(&self, trial: &Trial<'a>, time: f64, now: &State, waypoint: &State) -> Result<(), Refusal> {
        let Some(holding) = trial.act.holding else { return Ok(()) };
        let (Some(here), Some(written)) = (now.objects.get(holding.object), waypoint.objects.get(holding.object))
        else {
            return Ok(());
        };
        let distance = (here.translation.vector - written.translation.vector).norm();
        let angle = here.rotation.angle_to(&written.rotation);
        if distance <= self.options.rigid_m && angle <= self.options.rigid_rad {
            return Ok(());
        }
        let name = self.world.object_name(holding.object);
        let text = format!("{name} is {distance:.6} m and {angle:.6} rad from where the hand holds it");
        Err(trial.site.refusal(time, RefusalKind::Grasp, text).at(&written.translation.vector.into()))
    }

    /// Everything about one state of a step.
    fn check_state(
        &mut self,
        trial: &Trial<'a>,
        time: f64,
        now: &State,
        way: Option<Vector2<f64>>,
    ) -> Result<(), Refusal> {
        let site = trial.site;
        if let (Some(core), Some(object)) = (&trial.core, trial.act.pushed) {
            core.check_depth(site, time, &self.robot, &self.stage, object)?;
            self.check_on_surface(site, time, object, now)?;
            if let Some(way) = way {
                core.check_contact(site, time, &self.robot, &self.stage, object, &way, self.options)?;
            }
        }
        if let Some(holding) = trial.act.holding {
            self.check_object_bounds(holding.object, now)
                .map_err(|text| site.refusal(time, RefusalKind::Bounds, text))?;
        }
        if let Some([start, end]) = &trial.line {
            self.check_line(site, time, start, end)?;
        }
        self.stage.check(site.step, time).map_err(|hit| {
            let Hit { names: (a, b), place } = hit;
            site.refusal(time, RefusalKind::Collision, format!("{a} and {b} collide")).about(&a, &b).at(&place)
        })
    }

    /// A pushed object does not leave its surface.
    fn check_on_surface(&self, site: Site, time: f64, object: usize, now: &State) -> Result<(), Refusal> {
        let (Some(Mode::Resting { surface }), Some(pose)) = (self.modes.get(object), now.objects.get(object)) else {
            return Ok(());
        };
        let Some(surface) = self.world.surface(*surface) else { return Ok(()) };
        let inside = surface.depth(&Point2::from(pose.translation.vector.xy()));
        if inside >= 0.0 {
            return Ok(());
        }
        let (name, plane) = (self.world.object_name(object), surface.name());
        let text = format!("the centre of {name} is {:.4} m beside `{plane}`", -inside);
        Err(site.refusal(time, RefusalKind::Support, text).about(name, plane).at(&pose.translation.vector.into()))
    }

    fn check_line(&self, site: Site, time: f64, start: &Isometry3<f64>, end: &Isometry3<f64>) -> Result<(), Refusal> {
        let tool = &self.links[self.robot.tool];
        let (from, way) = (start.translation.vector, end.translation.vector - start.translation.vector);
        let gone = tool.translation.vector - from;
        let share = if way.norm() > 0.0 { (gone.dot(&way) / way.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
        let beside = (gone - way * share).norm();
        let turned = tool.rotation.angle_to(&start.rotation);
        if beside <= self.options.line_m && turned <= self.options.line_rad {
            return Ok(());
        }
        let text = format!(
            "the tool is {beside:.4} m beside its straight line and turned by {turned:.4} rad, at most {} m and {:.4} rad \
             are straight",
            self.options.line_m, self.options.line_rad
        );
        Err(site.refusal(time, RefusalKind::StraightLine, text).at(&tool.translation.vector.into()))
    }

    /// Joint limits of a waypoint, bounds of base and objects.
    fn check_limits(&self, state: &State) -> Result<(), (RefusalKind, String)> {
        let slack = self.options.rounding;
        for (i, (value, limit)) in state.joints.iter().zip(&self.robot.limits).enumerate() {
            if *value < limit.lower - slack || *value > limit.upper + slack {
                let (name, low, high) = (self.robot.joint_name(i), limit.lower, limit.upper);
                return Err((RefusalKind::Joints, format!("`{name}` is {value}, its limits are [{low}, {high}]")));
            }
        }
        let bounds = &self.plan.problem.bounds;
        for (axis, value, [low, high]) in [("x", state.base[0], bounds.base_x), ("y", state.base[1], bounds.base_y)] {
            if value < low - slack || value > high + slack {
                return Err((
                    RefusalKind::Bounds,
                    format!("the base's {axis} is {value}, its bounds are [{low}, {high}]"),
                ));
            }
        }
        (0..state.objects.len())
            .try_for_each(|object| self.check_object_bounds(object, state))
            .map_err(|text| (RefusalKind::Bounds, text))
    }

    fn check_object_bounds(&self, object: usize, state: &State) -> Result<(), String> {
        let Some(pose) = state.objects.get(object) else { return Ok(()) };
        let (bounds, slack) = (&self.plan.problem.bounds, self.options.rounding);
        let ranges = [("x", bounds.object_x), ("y", bounds.object_y), ("z", bounds.object_z)];
        for ((axis, [low, high]), value) in ranges.into_iter().zip(pose.translation.vector.iter()) {
            if *value < low - slack || *value > high + slack {
                let name = self.world.object_name(object);
                return Err(format!("the {axis} of {name} is {value}, its bounds are [{low}, {high}]"));
            }
        }
        Ok(())
    }

    /// Only what the step moves differs between the ends of a segment.
    fn check_changes(&self, trial: &Trial<'a>, place: Place, segment: &Segment<'_>) -> Result<(), Refusal> {
        let site = trial.site;
        let stray = |text: String| Err(site.refusal(place.time(0.0), RefusalKind::Stray, text));
        if let Some(what) = segment.half_turn(&self.robot) {
            let text = format!("{what} turns by half a turn, so that neither way is the shorter one");
            return Err(site.refusal(place.time(0.0), RefusalKind::Joints, text));
        }
        let changes = segment.changes(&self.robot);
        if let Some(joint) = changes.parked {
            return stray(format!("`{}` moves, but must stand still", self.robot.joint_name(joint)));
        }
        if changes.base && !drives(site.primitive) {
            return stray(format!("the base moves in {}", site.primitive));
        }
        if changes.arm && drives(site.primitive) {
            let joint = segment.joints.iter().zip(&self.robot.roles).position(|(d, r)| *d != 0.0 && *r == Role::Arm);
            let name = joint.map_or("the arm", |joint| self.robot.joint_name(joint));
            return stray(format!("`{name}` moves in {}", site.primitive));
        }
        self.check_finger(trial, place, changes)?;
        for (object, (a, b)) in segment.from.objects.iter().zip(&segment.to.objects).enumerate() {
            let is_held = trial.act.holding.is_some_and(|holding| holding.object == object);
            if a == b || is_held {
                continue;
            }
            let name = self.world.object_name(object);
            if trial.act.pushed != Some(object) {
                return stray(format!("{name} moves, but the step does not move it"));
            }
            let slack = self.options.rounding;
            let risen = (a.translation.z - b.translation.z).abs();
            if risen > slack || a.rotation.angle_to(&b.rotation) > slack.max(1e-7) {
                let text = format!("{name} is pushed and must neither rise nor turn; it rises {risen:.6} m");
                return Err(site.refusal(place.time(1.0), RefusalKind::Push, text));
            }
            if changes.finger != 0.0 {
                return stray(format!("{name} is pushed by the opening hand"));
            }
        }
        Ok(())
    }

    /// The hand opens and closes alone, at the ends of steps, and only where it must while something is held.
    fn check_finger(&self, trial: &Trial<'a>, place: Place, changes: Changes) -> Result<(), Refusal> {
        let refuse =
            |text: &str| Err(trial.site.refusal(place.time(0.0), RefusalKind::Gripper, format!("the hand {text}")));
        let opens = changes.finger;
        if opens != 0.0 && (changes.arm || changes.base) {
            return refuse("opens or closes while arm or base move");
        }
        match trial.site.primitive {
            PrimitiveName::Pick if place.is_first() && opens >= 0.0 => {
                refuse("must close between the first two waypoints of Pick")
            }
            PrimitiveName::Pick if !place.is_first() && opens != 0.0 => refuse("opens or closes after it has picked"),
            PrimitiveName::Place if place.is_last() && opens <= 0.0 => {
                refuse("must open between the last two waypoints of Place")
            }
            PrimitiveName::Place if !place.is_last() && opens != 0.0 => refuse("opens or closes before it has placed"),
            PrimitiveName::Pick | PrimitiveName::Place => Ok(()),
            _ if opens != 0.0 && trial.act.holding.is_some() => refuse("opens or closes on what it carries"),
            _ if opens != 0.0 && !place.is_first() && !place.is_last() => {
                refuse("opens or closes in the middle of a step")
            }
            _ => Ok(()),
        }
    }

    /// What the step leaves behind.
    fn finish(&mut self, trial: &Trial<'a>, end: &State) -> Result<(), Refusal> {
        let Some(holding) = trial.act.holding else { return Ok(()) };
        let mode = match (trial.site.primitive, &trial.step.holds) {
            (PrimitiveName::Place, _) => {
                let Some(pose) = end.objects.get(holding.object) else { return Ok(()) };
                let (slack, upright) = (self.options.support_m, self.options.upright_rad);
                let surface = self.world.standing(holding.object, pose, slack, upright).map_err(|flaw| {
                    let name = self.world.object_name(holding.object);
                    let place = pose.translation.vector.into();
                    trial.site.refusal(1.0, RefusalKind::Support, format!("{name} is let go, but {flaw}")).at(&place)
                })?;
                Mode::Resting { surface }
            }
            (_, Some(hold)) => Mode::Held { tool_from_object: hold.tool_from_object },
            (_, None) => return Ok(()),
        };
        if let Some(slot) = self.modes.get_mut(holding.object) {
            *slot = mode;
        }
        Ok(())
    }
}

/// The object of a pair, if it has one.
fn pair_object(pair: PairKind) -> Option<usize> {
    match pair {
        PairKind::LinkObject { object, .. } | PairKind::ObjectFixed { object, .. } => Some(object),
        PairKind::Other => None,
    }
}

/// The way of a pushed object over the surface; `None` while it stands.
fn pushed_way(segment: &Segment<'_>, object: usize) -> Option<Vector2<f64>> {
    let (from, to) = (segment.from.objects.get(object)?, segment.to.objects.get(object)?);
    let way = to.translation.vector.xy() - from.translation.vector.xy();
    (way.norm() > STANDS_M).then_some(way)
}

/// The first thing in which two waypoints differ, in words.
fn difference(a: &Waypoint, b: &Waypoint) -> String {
    if a.base != b.base {
        return format!("the base was at {:?} and is at {:?}", a.base, b.base);
    }
    if let Some((name, value)) = b.joints.iter().find(|(name, value)| a.joints.get(*name) != Some(*value)) {
        let before = a.joints.get(name).map_or_else(|| "missing".to_owned(), f64::to_string);
        return format!("`{name}` was {before} and is {value}");
    }
    if let Some((name, pose)) = b.objects.iter().find(|(name, pose)| a.objects.get(*name) != Some(*pose)) {
        let before = a.objects.get(name).map_or_else(|| "missing".to_owned(), |p| format!("{:?}", p.position));
        return format!("{name} was at {before} and is at {:?}", pose.position);
    }
    "something is missing".to_owned()
}
