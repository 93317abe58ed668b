//! What goes otherwise than planned, as it happens: the first departure is the cause of what follows.

use darrt_primitives::contract::{Contract, HandUse};
use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::Serialize;

use crate::goal::lean_deg;
use crate::stage::{Contact, Owner, STEP_S, Stage};
use crate::timeline::TimedStep;

/// How far an object that should rest may be moved by a step before that counts, metres and degrees.
const REST: (f64, f64) = (0.005, 5.0);
/// How far an object may move in the hand, metres and degrees.
const IN_HAND: (f64, f64) = (0.01, 5.0);
/// An object farther than this from where the hand should have it is not in the hand, metres.
const LOST_M: f64 = 0.10;
/// How much farther from the plan than before a push or a place may leave an object, metres and degrees.
const LEFT: (f64, f64) = (0.01, 3.0);
/// How deep the robot may seem to be in the room before it counts as run into it, metres: the plan may touch.
const BUMP_M: f64 = 0.001;
/// A hand so far from where the arm has it is held up, metres: a controller gives up there.
const HELD_UP_M: f64 = 0.02;
/// Forces are told from knocks by their mean over so long, s.
const FORCE_MEAN_S: f64 = 0.05;
/// What what is held presses on the room with while the hand carries it, N: more is running into something.
const HELD_HIT_N: f64 = 2.0;

/// What went wrong first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The robot ran into something that stands fast.
    Bumped,
    /// The hand was held up by something on which it pressed with all that the arm has.
    Pressed,
    /// Something that should have rested was moved.
    Moved,
    /// The hand closed and does not have the object.
    Missed,
    /// The object turned or slid in the hand while that closed on it or lifted it.
    Settled,
    /// The object turned or slid in the hand while it was carried.
    Slipped,
    /// What is carried ran into something.
    Hit,
    /// The object left the hand.
    Dropped,
    /// A push left the object elsewhere.
    Pushed,
    /// A place left the object elsewhere.
    Placed,
    /// Small differences that added up, none of them large.
    Added,
}

impl Cause {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Bumped => "the robot ran into the room",
            Self::Pressed => "held up, pressing on",
            Self::Moved => "moved though it should rest",
            Self::Missed => "missed by the closing hand",
            Self::Settled => "turned or slid when gripped",
            Self::Slipped => "turned or slid in the hand",
            Self::Hit => "ran into something in the hand",
            Self::Dropped => "lost from the hand",
            Self::Pushed => "pushed elsewhere",
            Self::Placed => "set down elsewhere",
            Self::Added => "small errors added up",
        }
    }
}

/// Where an execution first parts from its plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Departure {
    /// The plan: 0 is the one that was to be executed, 1 the first that was made on the way.
    pub plan: usize,
    /// The step, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: String,
    /// When in the step, 0 to 1.
    pub time: f64,
    /// What happened.
    pub cause: Cause,
    /// The object, or the part of the robot.
    pub body: String,
    /// What it met, if something.
    pub other: Option<String>,
    /// How far it moved or is off, or how deep the robot went in, metres.
    pub off_m: f64,
    /// How far its axis leans from where it should point, degrees.
    pub lean_deg: f64,
    /// With what force, where that is the cause, N.
    pub force_n: f64,
}

/// What [`Watch`] tells: who by index, names are for later.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Event {
    pub(crate) cause: Cause,
    pub(crate) body: Owner,
    pub(crate) other: Option<Owner>,
    pub(crate) off_m: f64,
    pub(crate) lean_deg: f64,
    pub(crate) force_n: f64,
}

impl Event {
    fn new(cause: Cause, body: Owner, off_m: f64, lean_deg: f64) -> Self {
        Self { cause, body, other: None, off_m, lean_deg, force_n: 0.0 }
    }

    /// Does the execution end with it?
    pub(crate) const fn is_final(&self) -> bool {
        matches!(self.cause, Cause::Bumped | Cause::Pressed)
    }
}

/// Compares the world with the plan from step to step.
#[derive(Debug)]
pub(crate) struct Watch {
    floor: Option<usize>,
    is_base: Vec<bool>,
    hand: Vec<usize>,
    tool: usize,
    /// By object: where it stood when the step began.
    began: Vec<Isometry3<f64>>,
    /// By object: how far it was from the plan then.
    off: Vec<f64>,
    /// By object: where it is in the hand since the hand has settled.
    in_hand: Vec<Option<Isometry3<f64>>>,
    /// By object: mean force of the room on it.
    borne: Vec<f64>,
}

impl Watch {
    pub(crate) fn new(stage: &Stage<'_>, count: usize, floor: Option<usize>) -> Self {
        let robot = stage.robot();
        Self {
            floor,
            is_base: robot.is_base.clone(),
            hand: robot.hand.links.clone(),
            tool: robot.tool,
            began: (0..count).map(|object| stage.object(object)).collect(),
            off: vec![0.0; count],
            in_hand: vec![None; count],
            borne: vec![0.0; count],
        }
    }

    /// A step begins: `planned` is where the plan has the objects.
    pub(crate) fn begin(&mut self, stage: &Stage<'_>, planned: &[Isometry3<f64>]) {
        for (object, planned) in planned.iter().enumerate() {
            let pose = stage.object(object);
            if let (Some(began), Some(off)) = (self.began.get_mut(object), self.off.get_mut(object)) {
                (*began, *off) = (pose, (pose.translation.vector - planned.translation.vector).norm());
            }
        }
    }

    /// Looks at forces and depths after one time step.
    pub(crate) fn touch(&mut self, stage: &Stage<'_>, step: &TimedStep, is_held: bool) -> Option<Event> {
        let mut from_room = vec![0.0; self.borne.len()];
        let mut bump: Option<Event> = None;
        let mut strongest: Option<(f64, Owner)> = None;
        for Contact { pair, depth_m, force } in stage.contacts() {
            match pair {
                (other, Owner::Link(link)) if self.hand.contains(&link) => {
                    let stronger = Some((force.norm(), other));
                    strongest =
                        if strongest.is_none_or(|(most, _)| force.norm() > most) { stronger } else { strongest };
                }
                (Owner::Room(body), Owner::Link(link)) => {
                    let is_wheel = Some(body) == self.floor && self.is_base.get(link) == Some(&true);
                    if depth_m > BUMP_M && !is_wheel && bump.is_none_or(|event| event.off_m < depth_m) {
                        let event = Event::new(Cause::Bumped, pair.1, depth_m, 0.0);
                        bump = Some(Event { other: Some(pair.0), ..event });
                    }
                }
                (Owner::Room(_), Owner::Object(object)) => {
                    if let Some(sum) = from_room.get_mut(object) {
                        *sum += force.norm();
                    }
                }
                _ => {}
            }
        }
        let share = STEP_S / FORCE_MEAN_S;
        for (mean, now) in self.borne.iter_mut().zip(&from_room) {
            *mean += share * (now - *mean);
        }
        bump.or_else(|| self.held_up(stage, strongest)).or_else(|| self.hit(step, is_held))
    }

    fn held_up(&self, stage: &Stage<'_>, strongest: Option<(f64, Owner)>) -> Option<Event> {
        let lag_m = stage.lag_m();
        let (force_n, other) = strongest.unzip();
        let event = Event::new(Cause::Pressed, Owner::Link(self.tool), lag_m, 0.0);
        (lag_m > HELD_UP_M).then(|| Event { other, force_n: force_n.unwrap_or(0.0), ..event })
    }

    /// Does what is carried press on the room, where it is neither lifted nor set down?
    fn hit(&self, step: &TimedStep, is_held: bool) -> Option<Event> {
        let (object, _) = step.holds.filter(|_| is_held && step.contract.hand == HandUse::Carries)?;
        let force_n = *self.borne.get(object)?;
        (force_n > HELD_HIT_N).then(|| Event { force_n, ..Event::new(Cause::Hit, Owner::Object(object), 0.0, 0.0) })
    }

    /// Looks at where the objects are. `is_held`: should the step's object be in the hand by now?
    pub(crate) fn look(&mut self, stage: &Stage<'_>, step: &TimedStep, is_held: bool) -> Option<Event> {
        if let Some((object, tool_from_object)) = step.holds.filter(|_| is_held)
            && let Some(event) = self.in_hand(stage, object, &tool_from_object, step.contract)
        {
            return Some(event);
        }
        (0..self.began.len()).find_map(|object| {
            let is_handled = step.pushes == Some(object) || step.holds.is_some_and(|(held, _)| held == object);
            if is_handled {
                return None;
            }
            let (began, now) = (self.began.get(object)?, stage.object(object));
            let off_m = (now.translation.vector - began.translation.vector).norm();
            let lean = lean_deg(&now, began);
            let is_off = off_m > REST.0 || lean > REST.1;
            is_off.then(|| Event::new(Cause::Moved, Owner::Object(object), off_m, lean))
        })
    }

    fn in_hand(
        &mut self,
        stage: &Stage<'_>,
        object: usize,
        planned: &Isometry3<f64>,
        contract: Contract,
    ) -> Option<Event> {
        let tool_from_object = stage.world_from_tool().inverse() * stage.object(object);
        let off = |from: &Isometry3<f64>| {
            let metres = (tool_from_object.translation.vector - from.translation.vector).norm();
            (metres, lean_deg(&tool_from_object, from))
        };
        let since = self.in_hand.get_mut(object)?;
        let Some(before) = since else {
            // The hand has just closed.
            *since = Some(tool_from_object);
            let (metres, lean) = off(planned);
            let is_lost = metres > LOST_M || stage.is_closed();
            let event = |cause| Event::new(cause, Owner::Object(object), metres, lean);
            if is_lost {
                return Some(event(Cause::Missed));
            }
            return (lean > IN_HAND.1).then(|| event(Cause::Settled));
        };
        let (metres, lean) = off(before);
        let event = |cause| Some(Event::new(cause, Owner::Object(object), metres, lean));
        if metres > LOST_M || stage.is_closed() {
            return event(Cause::Dropped);
        }
        let cause = if contract.hand == HandUse::Takes { Cause::Settled } else { Cause::Slipped };
        if metres > IN_HAND.0 || lean > IN_HAND.1 { event(cause) } else { None }
    }

    /// A step is over: `planned` is where the plan has the objects now.
    pub(crate) fn end(&mut self, stage: &Stage<'_>, step: &TimedStep) -> Option<Event> {
        let cause = match (step.pushes, step.contract.hand) {
            (Some(object), _) => Some((object, Cause::Pushed)),
            (None, HandUse::LetsGo) => step.holds.map(|(object, _)| (object, Cause::Placed)),
            _ => None,
        };
        let (object, cause) = cause?;
        if let Some(slot) = self.in_hand.get_mut(object) {
            *slot = None;
        }
        let (now, planned) = (stage.object(object), step.ends.get(object)?);
        let off_m = (now.translation.vector - planned.translation.vector).norm();
        let lean = lean_deg(&now, planned);
        let is_off = off_m > self.off.get(object)? + LEFT.0 || lean > LEFT.1;
        is_off.then(|| Event::new(cause, Owner::Object(object), off_m, lean))
    }
}
