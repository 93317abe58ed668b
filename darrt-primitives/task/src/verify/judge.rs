//! Replays a plan step by step.

mod chain;
mod changes;
mod limits;
mod moment;
mod remarks;

use std::collections::BTreeSet;
use std::sync::Arc;

use darrt_core::budget::Cancel;
use darrt_primitives::contract::{HandUse, HandWay, ObjectRule};
use nalgebra::Isometry3;

use super::approach::{Approach, Movers};
use super::drag;
use super::edge;
use super::goal;
use super::hand::{PushCore, SlideDirection, check_grip};
use super::hands::Hands;
use super::hold::{Hold, check_hold};
use super::margins::{MarginKind, Margins};
use super::mode::{Act, Mode, Permits};
use super::motion::{Segment, State};
use super::options::VerifyOptions;
use super::refusal::{Refusal, RefusalKind, Site};
use super::region::Region;
use super::robot::{Robot, world_from_robot};
use super::stage::{Hit, PairKind, Rule, Stage};
use super::steer;
use super::world::World;
use super::{Proof, near, start};
use crate::plan_file::{PlanFile, Step, Waypoint};
use crate::problem_file::Object;
use crate::robot::RobotFacts;
use remarks::Remarks;

/// Everything needed while a plan is replayed.
pub(super) struct Judge<'a> {
    plan: &'a PlanFile,
    options: &'a VerifyOptions,
    cancel: &'a Cancel,
    facts: &'a RobotFacts,
    hands: Hands,
    /// With the hand at work in the present step.
    robot: Arc<Robot>,
    world: World<'a>,
    stage: Stage,
    margins: Margins,
    remarks: Remarks,
    approach: Approach,
    /// By object.
    modes: Vec<Mode>,
    /// How the closed hand holds what it holds.
    hold: Option<Hold>,
    /// Poses of all links in the frame of the robot's root, overwritten whenever the arm moves.
    links: Vec<Isometry3<f64>>,
    world_from_robot: Isometry3<f64>,
    waypoints: usize,
    /// Numbers of the steps whose motion has been judged before.
    known: BTreeSet<u32>,
}

/// One step under judgement.
struct Trial<'a> {
    site: Site<'a>,
    step: &'a Step,
    act: Act,
    /// See [`Robot::extents`].
    extents: Vec<f64>,
    /// See [`Robot::travel_rates`].
    rates: Vec<f64>,
    core: Option<PushCore>,
    /// The tool at both ends of a straight line.
    line: Option<[Isometry3<f64>; 2]>,
    /// How the tool stands to an object that slides, before it slides.
    object_from_tool: Option<Isometry3<f64>>,
}

impl Trial<'_> {
    /// May states at which no pair need be looked at be left out? In a push and on a straight line every state is looked at.
    fn skips(&self) -> bool {
        self.core.is_none() && self.line.is_none()
    }
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
    pub(super) fn new(
        plan: &'a PlanFile,
        facts: &'a RobotFacts,
        options: &'a VerifyOptions,
        cancel: &'a Cancel,
    ) -> Result<Self, Refusal> {
        let name = format!("problem `{}` in the plan", plan.problem.name);
        plan.problem.validate(&name).map_err(|e| Refusal::whole(RefusalKind::Problem, e.to_string()))?;
        let hands = Hands::new(facts)?;
        let robot = Arc::clone(&hands.first);
        let world = World::new(&plan.problem)?;
        let margins = Margins::of(&plan.problem);
        let region = if options.is_plain { Region::everywhere() } else { Region::of(plan, &hands, &world) };
        let stage = Stage::new(&robot, &world, options.support_m, margins, &region);
        let approach = Approach::new(&hands)
            .ok_or_else(|| Refusal::whole(RefusalKind::Problem, "more joints move than any robot of this kind has"))?;
        let modes = world.movables.iter().map(|m| Mode::Resting { surface: m.start_surface }).collect();
        Ok(Self {
            plan,
            options,
            cancel,
            facts,
            hands,
            robot,
            world,
            stage,
            margins,
            remarks: Remarks::default(),
            approach,
            modes,
            hold: None,
            links: Vec::new(),
            world_from_robot: Isometry3::identity(),
            waypoints: 0,
            known: BTreeSet::new(),
        })
    }

    /// Numbers of steps that an accepted plan has too, with the same states before and after them: what lies between is not looked
    /// at again, but by the plain judge.
    pub(super) fn knowing(mut self, known: impl IntoIterator<Item = u32>) -> Self {
        self.known.extend(known.into_iter().filter(|_| !self.options.is_plain));
        self
    }

    /// The whole plan.
    pub(super) fn run(mut self) -> Result<Proof, Refusal> {
        let mut here = self.start()?;
        let mut last = &self.plan.start;
        let (rules, mut met) = (&self.plan.problem.steers, BTreeSet::new());
        for (number, step) in (1..).zip(&self.plan.steps) {
            let site = self.site(number, step)?;
            let before = (!rules.is_empty()).then(|| here.clone());
            here = self.step(site, step, last, here)?;
            if let Some(before) = before {
                steer::check(rules, site, step, (&self.world, &self.robot), (&before, &here), &mut met)?;
            }
            last = step.waypoints.last().unwrap_or(last);
        }
        // What is only the beginning of a plan may do later what is required.
        if self.plan.partial.is_none() {
            steer::check_whole(rules, &met)?;
        }
        goal::check(
            &self.plan.problem,
            self.plan.partial.as_ref(),
            &self.world,
            (&self.hands, self.facts),
            &here,
            &self.modes,
        )?;
        let warnings = self.warnings(&here);
        let [robot, held, object, itself, near] = self.stage.smallest;
        let unintended = [robot, held, object, itself].into_iter().flatten();
        Ok(Proof {
            steps: self.plan.steps.len(),
            waypoints: self.waypoints,
            states: self.stage.states,
            exact_tests: self.stage.exact_tests,
            smallest_clearance: unintended.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)),
            smallest_intended: near,
            duration_s: None,
            warnings,
        })
    }

    /// The step with this number, from 1, and what it keeps to.
    fn site(&self, number: u32, step: &'a Step) -> Result<Site<'a>, Refusal> {
        let primitive = &step.primitive;
        let contract = self.plan.contracts.get(primitive).copied().ok_or_else(|| {
            let text = format!("`contracts` says nothing of {primitive}, a primitive of the plan");
            Refusal::whole(RefusalKind::Primitive, text)
        })?;
        let site = Site { step: number, primitive, contract };
        match contract.flaw() {
            Some(why) => {
                Err(site.refusal(0.0, RefusalKind::Primitive, format!("its contract contradicts itself: {why}")))
            }
            None => Ok(site),
        }
    }

    fn start(&mut self) -> Result<State, Refusal> {
        let refuse = |kind, message: String| Refusal::whole(kind, format!("the start: {message}"));
        let state = State::read(&self.plan.start, &self.robot, &self.world)
            .map_err(|flaw| refuse(RefusalKind::Malformed, flaw))?;
        start::check(&state, &self.plan.problem, (&self.robot, self.facts), &self.world, self.options)?;
        self.check_limits(&state).map_err(|(kind, flaw)| refuse(kind, flaw))?;
        let (world, modes) = (&self.world, &self.modes);
        self.stage.set_movers(|_| Movers::NONE, |_| Movers::NONE);
        self.stage.set_rules(|pair| match pair {
            PairKind::ObjectFixed { object, fixed } => match modes.get(object) {
                Some(Mode::Resting { surface }) if world.carries(object, *surface, fixed) => Rule::Standing,
                _ => Rule::Apart(MarginKind::Object),
            },
            PairKind::Objects(..) => Rule::Apart(MarginKind::Object),
            PairKind::LinkObject { .. } | PairKind::LinkFixed { .. } => Rule::Apart(MarginKind::Robot),
            PairKind::Links => Rule::Apart(MarginKind::Itself),
        });
        self.robot.link_poses(&state.joints, &mut self.links);
        self.world_from_robot = world_from_robot(&state.base);
        self.stage.place(&self.world_from_robot, &self.links, &state.objects, 0);
        let mut near = self.stage.accept_near();
        near.extend(near::at_goals(&self.plan.problem, &self.world, &state.objects, &mut self.stage));
        self.remarks.note_near(&near, self.plan.problem.safety.least_margin_m);
        self.look(0, 0.0).map_err(|hit| {
            refuse(RefusalKind::Collision, hit.words()).about(&hit.names.0, &hit.names.1).at(&hit.place)
        })?;
        Ok(state)
    }

    /// Judges one step from the state `here`, described by the waypoint `last`; returns where it ends.
    fn step(&mut self, site: Site<'a>, step: &'a Step, last: &Waypoint, here: State) -> Result<State, Refusal> {
        if !self.plan.problem.allows(site.primitive) {
            let text = format!("{} is not among the primitives of the problem", site.primitive);
            return Err(site.refusal(0.0, RefusalKind::Primitive, text));
        }
        let [first, _, ..] = &step.waypoints[..] else {
            let text = format!("has {} waypoints, a step has at least 2", step.waypoints.len());
            return Err(site.refusal(0.0, RefusalKind::Malformed, text));
        };
        if first != last {
            let text = format!("does not start where the step before ended: {}", chain::difference(last, first));
            return Err(site.refusal(0.0, RefusalKind::Chain, text));
        }
        self.robot = Arc::clone(self.hands.of_step(site, step, self.facts)?);
        let act = Act::new(site, step, (&self.hands, &self.robot), &self.world, &self.modes)?;
        let permits = Permits::new(site, step, &act, &self.robot, &self.world, &self.modes)?;
        let (world, modes) = (&self.world, &self.modes);
        let (tool, approach) = (self.approach.of_link(self.robot.tool), &self.approach);
        let of_object = |object| match (act.pushed, act.holding.map(|holding| holding.object)) {
            (Some(pushed), _) if pushed == object => Movers::PUSH,
            (_, Some(held)) if held == object => tool,
            _ => Movers::NONE,
        };
        let of_solid = |solid: usize| self.robot.solids.get(solid).map_or(Movers::NONE, |s| approach.of_link(s.link));
        self.stage.set_movers(of_solid, of_object);
        self.stage.set_rules(|pair| permits.rule(pair, &act, &self.robot, world, modes));
        self.stage.begin_step();
        let states = self.states(site, step, here)?;
        let trial = self.trial(site, step, act, &states)?;
        let count = states.len() - 1;
        // What is taken is held from then on as the hand is found to hold it.
        let is_known = self.known.contains(&site.step) && site.contract.hand != HandUse::Takes;
        if is_known {
            self.pass(&states);
        } else {
            for (index, pair) in states.windows(2).enumerate() {
                if let [from, to] = pair {
                    self.segment(&trial, Place { index, count }, from, to)?;
                }
            }
        }
        if let Some(near) = self.stage.too_near.take() {
            let refusal = site.refusal(near.time, RefusalKind::Margin, near.words());
            return Err(refusal.about(&near.names.0, &near.names.1).at(&near.place));
        }
        self.waypoints += step.waypoints.len();
        let (Some(start), Some(end)) = (states.first(), states.last()) else {
            return Err(site.refusal(0.0, RefusalKind::Malformed, "has no waypoints"));
        };
        let end = end.clone();
        self.finish(&trial, start, &end)?;
        self.remark(&trial, &states);
        Ok(end)
    }

    /// Goes to the last of these states without a look at anything; nothing is known of any pair there.
    fn pass(&mut self, states: &[State]) {
        let Some(last) = states.last() else { return };
        self.world_from_robot = world_from_robot(&last.base);
        self.robot.arm_link_poses(&last.joints, &mut self.links);
        self.stage.forget();
    }

    /// The states at the waypoints, each within limits and bounds.
    fn states(&self, site: Site<'_>, step: &Step, here: State) -> Result<Vec<State>, Refusal> {
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

    fn trial(&mut self, site: Site<'a>, step: &'a Step, act: Act, states: &[State]) -> Result<Trial<'a>, Refusal> {
        let held_m = act.holding.map_or(0.0, |holding| {
            let reach = self.world.movables.get(holding.object).map_or(0.0, |m| m.solid.reach());
            holding.tool_from_object.translation.vector.norm() + reach
        });
        let core = match act.pushed.and_then(|object| self.world.movables.get(object)) {
            Some(movable) => Some(
                self.core(site.contract.object, movable.spec)
                    .map_err(|flaw| site.refusal(0.0, RefusalKind::Push, flaw))?,
            ),
            None => None,
        };
        let mut line = None;
        if site.contract.way == HandWay::Straight
            && let (Some(first), Some(last)) = (states.first(), states.last())
        {
            let mut tool = |state: &State| {
                self.robot.arm_link_poses(&state.joints, &mut self.links);
                world_from_robot(&state.base) * self.links[self.robot.tool]
            };
            // The first one last: the step goes on from there.
            let end = tool(last);
            line = Some([tool(first), end]);
        }
        let object_from_tool = match (states.first(), act.pushed) {
            (Some(first), Some(object)) => {
                self.robot.arm_link_poses(&first.joints, &mut self.links);
                let tool = world_from_robot(&first.base) * self.links[self.robot.tool];
                first.objects.get(object).map(|pose| pose.inverse() * tool)
            }
            _ => None,
        };
        let extents = self.robot.extents(held_m);
        let rates = self.robot.travel_rates(&extents);
        Ok(Trial { site, step, act, extents, rates, core, line, object_from_tool })
    }

    /// What fingers must not reach of an object that slides by this rule, or why it cannot.
    fn core(&self, rule: ObjectRule, object: &Object) -> Result<PushCore, String> {
        let skin_m = self.options.push_contact_m;
        match rule {
            ObjectRule::Dragged => {
                drag::check_strength(object, &self.robot)?;
                PushCore::of(object, skin_m, skin_m)
            }
            ObjectRule::Pushed | ObjectRule::Rests => PushCore::new(object, skin_m, self.robot.strength.push_force_n),
        }
    }

    fn segment(&mut self, trial: &Trial<'a>, place: Place, from: &State, to: &State) -> Result<(), Refusal> {
        let segment = Segment::new(from, to, &self.robot);
        self.check_changes(trial, place, &segment)?;
        let slide = trial.act.pushed.and_then(|object| segment.slide(object));
        let (by_travel, part_m) = segment.parts(&trial.rates, self.options);
        let pushed = trial.act.pushed.and_then(|object| Some((object, self.world.movables.get(object)?.solid.reach())));
        let speeds = self.approach.speeds(&segment, &trial.extents, pushed);
        let parts = self.stage.least_parts(&speeds, by_travel);
        let travel_m = part_m * by_travel as f64 / parts as f64;
        self.stage.set_speeds(&speeds, parts, trial.skips());
        let arm_moves = from.joints != to.joints;
        let turn_rad = segment.joints.iter().map(|joint| joint.abs()).sum();
        let mut now = from.clone();
        let mut i = usize::from(!place.is_first());
        let mut gone = 1;
        while i <= parts {
            let s = i as f64 / parts as f64;
            let time = place.time(s);
            if self.cancel.is_cancelled() {
                return Err(trial.site.refusal(time, RefusalKind::Cancelled, "was being judged when it was cancelled"));
            }
            segment.robot_at(s, &mut now);
            self.world_from_robot = world_from_robot(&now.base);
            // Other joints than the arm's do not change.
            if arm_moves {
                self.robot.arm_link_poses(&now.joints, &mut self.links);
            }
            self.move_objects(trial, &segment, s, &mut now);
            if i == 0 || i == parts {
                self.check_rigid(trial, time, &now, if i == 0 { from } else { to })?;
            }
            if i == parts && slide.is_some() {
                self.check_turned_along(trial, time, &now)?;
            }
            self.stage.place(&self.world_from_robot, &self.links, &now.objects, gone);
            let way = slide.map(|slide| SlideDirection { heading: slide.heading(s), curvature: slide.curvature() });
            self.check_state(trial, time, &now, way)?;
            // OPTIMIZATION: states at which nothing would be looked at need not be made. The end always is.
            let next = (i + 1 + self.idle_parts(trial, &now, (travel_m, turn_rad), parts)).min(parts.max(i + 1));
            gone = next - i;
            i = next;
        }
        if place.is_first()
            && trial.site.contract.hand == HandUse::Takes
            && let Some(holding) = trial.act.holding
        {
            let (site, time) = (trial.site, place.time(1.0));
            check_grip(site, time, &self.robot, &self.stage, holding.object, self.options)?;
            if let Some(movable) = self.world.movables.get(holding.object) {
                let (object, tool) = ((holding.object, movable.spec), self.world_from_tool());
                self.hold = Some(check_hold(site, time, &self.robot, &self.stage, object, &tool)?);
            }
        }
        Ok(())
    }

    /// What the step leaves behind.
    fn finish(&mut self, trial: &Trial<'a>, start: &State, end: &State) -> Result<(), Refusal> {
        if let Some(object) = trial.act.pushed
            && let (Some(Mode::Resting { surface }), Some(pose)) = (self.modes.get_mut(object), end.objects.get(object))
            && start.objects.get(object) != Some(pose)
        {
            if let Some(now) = self.world.under(object, *surface, &pose.translation.vector.xy().into()) {
                *surface = now;
            }
            let surface = *surface;
            self.check_edge(trial.site, object, surface, pose)?;
        }
        let Some(holding) = trial.act.holding else { return Ok(()) };
        let mode = match (trial.site.contract.hand, &trial.step.holds) {
            (HandUse::LetsGo, _) => {
                let Some(pose) = end.objects.get(holding.object) else { return Ok(()) };
                let (slack, upright) = (self.options.support_m, self.options.upright_rad);
                let surface = self.world.standing(holding.object, pose, slack, upright).map_err(|flaw| {
                    let name = self.world.object_name(holding.object);
                    let place = pose.translation.vector.into();
                    trial.site.refusal(1.0, RefusalKind::Support, format!("{name} is let go, but {flaw}")).at(&place)
                })?;
                self.hold = None;
                self.check_edge(trial.site, holding.object, surface, pose)?;
                Mode::Resting { surface }
            }
            (_, Some(hold)) => Mode::Held { hand: self.robot.which, tool_from_object: hold.tool_from_object },
            (_, None) => return Ok(()),
        };
        if let Some(slot) = self.modes.get_mut(holding.object) {
            *slot = mode;
        }
        Ok(())
    }
}

impl Judge<'_> {
    /// Looks at all pairs of solids as they are now.
    fn look(&mut self, step: u32, time: f64) -> Result<(), Hit> {
        if self.options.is_plain { self.stage.check_plain(step, time) } else { self.stage.check(step, time) }
    }

    /// What is left standing is far enough from the edge.
    fn check_edge(&self, site: Site<'_>, object: usize, surface: usize, pose: &Isometry3<f64>) -> Result<(), Refusal> {
        let flaw = edge::flaw(&self.plan.problem, &self.world, object, surface, pose, self.options);
        let refuse = |flaw: String| {
            let plane = self.world.surface(surface).map_or("", |surface| surface.name());
            let refusal = site.refusal(1.0, RefusalKind::Edge, flaw).about(self.world.object_name(object), plane);
            Err(refusal.at(&pose.translation.vector.into()))
        };
        flaw.map_or(Ok(()), refuse)
    }
}
