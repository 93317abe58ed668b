//! The independent judge of a plan. Success cannot be claimed without it: a [`Solution`] can only be
//! built here, from a plan that a verifier has accepted.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use crate::domain::Domain;
use crate::goal::Goal;
use crate::plan::Plan;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};
use crate::validity::Validity;

/// Why a plan is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Index of the step at fault; `None` if the plan as a whole is.
    pub step: Option<usize>,
    /// Fraction of that step at which the fault was found.
    pub at: f64,
    /// What is wrong, with names, values and bounds.
    pub reason: String,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.step {
            Some(step) => write!(f, "step {} at {:.4}: {}", step + 1, self.at, self.reason),
            None => f.write_str(&self.reason),
        }
    }
}

/// What a verifier saw of a plan that it accepts.
#[derive(Debug, Clone, Default)]
pub struct Verified {
    /// The smallest distance, in metres, of two bodies that may not touch; `None` if it does not measure that.
    pub clearance_m: Option<f64>,
    /// Whatever else it wants to hand over with the plan, a proof for example. The planner does not look at it.
    pub evidence: Option<Arc<dyn Any + Send + Sync>>,
}

/// Judges plans, independently of the planner and of the primitives.
///
/// # Example
/// ```
/// use darrt_core::plan::Plan;
/// use darrt_core::prelude::*;
/// use darrt_core::verify::{Refusal, Verified, Verifier};
///
/// /// Another verifier's verdict, and no more than so many steps.
/// struct Short<V> {
///     inner: V,
///     steps: usize,
/// }
///
/// impl<D: Domain, V: Verifier<D>> Verifier<D> for Short<V> {
///     fn verify(&self, m: &D, start: &State<D>, goal: &dyn Goal<D>, plan: &Plan<D>) -> Result<Verified, Refusal> {
///         let found = plan.steps().len();
///         if found > self.steps {
///             let reason = format!("has {found} steps, {} are allowed", self.steps);
///             return Err(Refusal { step: None, at: 0.0, reason });
///         }
///         self.inner.verify(m, start, goal, plan)
///     }
/// }
/// ```
pub trait Verifier<D: Domain>: Send + Sync {
    /// Accepts, and says what it measured, or refuses. One that takes long should give up, with any refusal, when the search is
    /// cancelled.
    ///
    /// # Errors
    /// The first [`Refusal`] found.
    fn verify(&self, m: &D, start: &State<D>, goal: &dyn Goal<D>, plan: &Plan<D>) -> Result<Verified, Refusal>;
}

/// A plan that a verifier has accepted. There is no other way to make one.
pub struct Solution<D: Domain> {
    plan: Plan<D>,
    verified: Verified,
    found: Option<Plan<D>>,
}

impl<D: Domain> Clone for Solution<D> {
    fn clone(&self) -> Self {
        Self { plan: self.plan.clone(), verified: self.verified.clone(), found: self.found.clone() }
    }
}

// Not derived: that would ask the domain to be printable.
impl<D: Domain> fmt::Debug for Solution<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plan, verified, found } = self;
        f.debug_struct("Solution").field("plan", plan).field("verified", verified).field("found", found).finish()
    }
}

impl<D: Domain> Solution<D> {
    /// Has `plan` verified.
    ///
    /// # Errors
    /// The verifier's [`Refusal`].
    pub fn prove(
        m: &D,
        start: &State<D>,
        goal: &dyn Goal<D>,
        verifier: &dyn Verifier<D>,
        plan: Plan<D>,
    ) -> Result<Self, Refusal> {
        let verified = verifier.verify(m, start, goal, &plan)?;
        Ok(Self { plan, verified, found: None })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan<D> {
        &self.plan
    }

    /// The smallest distance that the verifier saw, metres; `None` if it does not measure it.
    pub fn clearance_m(&self) -> Option<f64> {
        self.verified.clearance_m
    }

    /// The plan that was found first, if this one was made from it. Its motions may not have been judged: where one is
    /// blocked, the way around is longer.
    pub fn found(&self) -> Option<&Plan<D>> {
        self.found.as_ref()
    }

    pub(crate) fn improved_from(self, found: Plan<D>) -> Self {
        Self { found: Some(found), ..self }
    }

    /// The plan, and all that the verifier said of it.
    pub fn into_parts(self) -> (Plan<D>, Verified) {
        (self.plan, self.verified)
    }
}

/// Replays every step at a fixed spacing and asks a [`Validity`] (preferably a slower, more exact one than
/// the planner's) about each state. In between, nothing may travel farther than the motion says, and the mode is constant.
#[derive(Debug, Clone)]
pub struct Replay<V> {
    oracle: V,
    spacing_m: f64,
}

impl<V> Replay<V> {
    /// A verifier that checks a state every `spacing_m` metres of travel (clamped to at least 1e-5 m).
    pub fn new(oracle: V, spacing_m: f64) -> Self {
        Self { oracle, spacing_m: spacing_m.max(1e-5) }
    }

    fn replay_step<D: Domain>(
        &self,
        m: &D,
        plan: &Plan<D>,
        index: usize,
        before: &State<D>,
    ) -> Result<State<D>, Refusal>
    where
        V: Validity<D>,
    {
        let refuse = |at: f64, reason: String| Refusal { step: Some(index), at, reason };
        let Some(step) = plan.steps().get(index) else { return Ok(before.clone()) };
        let length = step.instance.motion.length();
        if !(length.is_finite() && length >= 0.0) {
            return Err(refuse(0.0, format!("its length is {length} m, but must be finite and not negative")));
        }
        if !(step.until > 0.0 && step.until <= 1.0) {
            return Err(refuse(0.0, format!("it runs until {}, but must end in (0, 1]", step.until)));
        }
        let entry = step.instance.at(m, 0.0, before);
        if entry != *before {
            return Err(refuse(0.0, format!("it starts at {entry:?}, but the step before ends at {before:?}")));
        }
        let asked = (length * step.until / self.spacing_m).ceil().clamp(1.0, 1e7);
        // So many looks go between two questions to the oracle.
        let between = (LEAST_LOOKS / asked).ceil();
        let count = asked * between;
        let (mut state, mut last) = (before.clone(), before.clone());
        let mut mode = None;
        let mut i = 0.0;
        while i < count {
            i += 1.0;
            let s = if i >= count { 1.0 } else { i / count };
            step.instance.motion.at_into(m, s * step.until, &mut state);
            if let Some(what) = stray(m, before, &state, step.instance.moves) {
                return Err(refuse(s, format!("{what} moves, but the step does not move it")));
            }
            let bound = length * step.until / count;
            if let Some(what) = impossible(m, &last, &state, bound) {
                return Err(refuse(s, what));
            }
            // The mode changes at the ends of an instance only.
            if s * step.until < 1.0 && *mode.get_or_insert_with(|| state.mode.clone()) != state.mode {
                return Err(refuse(s, format!("the mode changes on the way, to {:?}", state.mode)));
            }
            if i % between == 0.0 {
                self.oracle.check(m, &state, &step.instance.contacts).map_err(|blame| refuse(s, blame.to_string()))?;
            }
            last.clone_from(&state);
        }
        Ok(state)
    }
}

/// A step is looked at in at least so many states, however short it says it is.
const LEAST_LOOKS: f64 = 64.0;
/// Rounding that is forgiven between two looks, metres.
const SLACK_M: f64 = 1e-6;

/// What makes it impossible that `now` follows `last`, from which nothing travels farther than `bound_m` metres.
fn impossible<D: Domain>(m: &D, last: &State<D>, now: &State<D>, bound_m: f64) -> Option<String> {
    if now.objects.len() != last.objects.len() {
        return Some(format!("{} objects, but there were {}", now.objects.len(), last.objects.len()));
    }
    let jumps = |metres: f64, id: ComponentId| {
        // Also if it is no number.
        let is_far = metres.is_nan() || metres > bound_m + SLACK_M;
        is_far.then(|| format!("{} jumps {metres} m, {bound_m} m are possible", m.component_name(id)))
    };
    let robot = jumps(m.robot().distance(&last.robot, &now.robot), ComponentId::Robot);
    let mut objects = m.objects().iter().zip(last.objects.iter().zip(&now.objects)).enumerate();
    robot.or_else(|| {
        objects.find_map(|(i, (space, (p, q)))| jumps(space.distance(p, q), ComponentId::Object(ObjectId::new(i))))
    })
}

/// A component that is not in `moves` and yet differs.
fn stray<D: Domain>(m: &D, before: &State<D>, now: &State<D>, moves: crate::state::ComponentSet) -> Option<String> {
    if !moves.contains(ComponentId::Robot) && before.robot != now.robot {
        return Some(m.component_name(ComponentId::Robot).into_owned());
    }
    let strays = before.objects.iter().zip(&now.objects).enumerate().find_map(|(i, (a, b))| {
        let id = ComponentId::Object(ObjectId::new(i));
        (a != b && !moves.contains(id)).then_some(id)
    })?;
    Some(m.component_name(strays).into_owned())
}

impl<D: Domain, V: Validity<D>> Verifier<D> for Replay<V> {
    fn verify(&self, m: &D, start: &State<D>, goal: &dyn Goal<D>, plan: &Plan<D>) -> Result<Verified, Refusal> {
        let whole = |reason: String| Refusal { step: None, at: 0.0, reason };
        if plan.start() != start {
            return Err(whole("the plan does not start at the start of the problem".to_owned()));
        }
        if !m.robot().contains(&start.robot) {
            return Err(whole("the start lies outside the robot's space".to_owned()));
        }
        let mut state = start.clone();
        for index in 0..plan.steps().len() {
            state = self.replay_step(m, plan, index, &state)?;
        }
        if !goal.is_satisfied(m, &state) {
            return Err(whole("the plan does not end in the goal".to_owned()));
        }
        // Its oracle says yes or no, not how near.
        Ok(Verified::default())
    }
}
