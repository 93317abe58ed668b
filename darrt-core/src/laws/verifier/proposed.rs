//! Does a verifier accept what the primitives propose and the validity finds free, and refuse what it blocks?

use std::collections::BTreeMap;
use std::sync::Arc;

use rand::RngExt;

use super::each_primitive::{Ledger, its_end};
use super::{Broken, WAYS_IN};
use crate::domain::Domain;
use crate::laws::feed::{components, drift, elsewhere};
use crate::laws::motion::component_travel;
use crate::laws::watch::{drawing, entering};
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::problem::Problem;
use crate::random::{Purpose, Stream, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};
use crate::tree::Tree;
use crate::validity::{Blame, BlockKind};

/// So deep in what is in the way, whichever way one moves from there, a verifier that is content with less room than the
/// validity refuses as well, metres.
const DEEP_M: f64 = 0.05;
/// How many directions are tried to get out.
const WAYS_OUT: usize = 12;
/// So many looks are taken behind the border of what is in the way.
const LOOKS: u32 = 32;
/// How many targets there are for each plan that is wanted.
const TARGETS: usize = 24;
/// So many plans of one primitive into the same thing are shown.
const EACH: usize = 8;

/// Lets primitives propose motions from the nodes of `tree` to all kinds of targets. Those that are free go to the `ledger`; of
/// those that are blocked up to `most` are shown to the verifier, as far as the first place well inside of what blocks them.
pub(super) fn check<D: Domain>(
    problem: &Problem<D>,
    tree: &Tree<D>,
    ledger: &mut Ledger,
    seed: u64,
    most: usize,
) -> Result<(), Broken> {
    let m = problem.domain();
    let ways: Vec<(Plan<D>, &State<D>)> =
        tree.iter().filter_map(|(id, node)| Some((Plan::to_node(tree, id)?, &node.state))).collect();
    let (mut shown, mut count) = (BTreeMap::new(), 0);
    let targets = TARGETS.saturating_mul(most);
    for i in 0..targets {
        let mut rng = stream(seed, 27, i as u64, Purpose::Attempt);
        let Some((way, from)) = ways.get(rng.random_range(0..ways.len().max(1))) else { return Ok(()) };
        let to = target(m, from, &mut rng);
        // What is met everywhere does not use up what is rare.
        let each = 1 + EACH * i / targets;
        for (primitive, proposer) in (0_u16..).zip(problem.primitives()) {
            entering("useful");
            if !proposer.useful(m, from, &to) {
                continue;
            }
            let draws = stream(seed, 28, i as u64, Purpose::Extend);
            let found = drawing("propagate", draws, |rng| proposer.propagate(m, from, &to, rng))?;
            let mut steps = way.steps().to_vec();
            let mut here = (*from).clone();
            for instance in found.into_iter().flatten().map(Arc::new) {
                entering("free_prefix");
                let free = problem.validity().free_prefix(m, &instance, &here);
                let Some(blame) = free.blame else {
                    here = instance.at(m, 1.0, &here);
                    let is_open = ledger.is_open(&instance);
                    steps.push(Step { instance, until: 1.0, primitive });
                    if is_open {
                        ledger.judge(problem, &Plan::new(way.start().clone(), steps.clone()));
                    }
                    continue;
                };
                let of = (instance.primitive.index(), Arc::clone(&blame.first), Arc::clone(&blame.second));
                let known: &mut usize = shown.entry(of).or_default();
                let into = Into { problem, instance: &instance, from: &here };
                let depth = (*known < each).then(|| into.depth(free.fraction, &mut rng)).flatten();
                let Some((until, blame)) = depth else { break };
                (*known, count) = (*known + 1, count + 1);
                let name = instance.primitive.name();
                steps.push(Step { instance, until, primitive });
                let plan = Plan::new(way.start().clone(), steps);
                entering("verify");
                if problem.verifier().verify(m, problem.start(), &its_end(m, &plan), &plan).is_ok() {
                    let found = format!("accepted: {} steps that end in {:?}", plan.steps().len(), plan.end(m));
                    let against = format!("refused: by the validity {blame}, {DEEP_M} m deep at least");
                    return Err(Broken::new(WAYS_IN, found, against).of(name).at(until));
                }
                break;
            }
            if count >= most {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// The robot or an object anywhere, or an object nearly where another one is.
fn target<D: Domain>(m: &D, from: &State<D>, rng: &mut Stream) -> PartialState<D> {
    let there = elsewhere(m, from, rng);
    let target = PartialState::anywhere(m);
    let count = from.objects.len();
    if count == 0 || rng.random_bool(0.3) {
        return target.with_robot(m, there.robot);
    }
    let id = rng.random_range(0..count);
    // Another one, if there is any.
    let other = ObjectId::new((id + rng.random_range(1..count.max(2))) % count);
    let id = ObjectId::new(id);
    let share = if rng.random_bool(0.5) { rng.random_range(0.0..0.2) } else { 1.0 };
    let (Some(space), Some(near), Some(far)) = (m.objects().get(id.index()), from.object(other), there.object(id))
    else {
        return target;
    };
    let at = space.interpolate(near, far, if id == other { 1.0 } else { share });
    target.with_object(id, if space.contains(&at) { at } else { far.clone() })
}

/// A motion that leads into something.
struct Into<'a, D: Domain> {
    problem: &'a Problem<D>,
    instance: &'a Instance<D>,
    from: &'a State<D>,
}

impl<D: Domain> Into<'_, D> {
    /// The first parameter behind the border at which it is deep inside, and what it is inside of.
    fn depth(&self, border: f64, rng: &mut Stream) -> Option<(f64, Blame)> {
        let m = self.problem.domain();
        let step = DEEP_M / self.instance.motion.length().max(DEEP_M);
        let looks = (1..=LOOKS).map(|k| border + f64::from(k) * step).take_while(|t| *t <= 1.0);
        for t in looks {
            let state = self.instance.at(m, t, self.from);
            entering("check");
            let bare = self.problem.validity().check(m, &state, &D::Contacts::default());
            let Err(blame) = self.problem.validity().check(m, &state, &self.instance.contacts) else { continue };
            if bare.is_err() && self.is_deep(&state, &blame, rng) {
                return Some((t, blame));
            }
        }
        None
    }

    /// Does no small move of what is in the way of something free it? Asked as if nothing were held, so that it may be moved
    /// alone: the robot where it is, or, if it is to do with objects only, where it started.
    fn is_deep(&self, state: &State<D>, blame: &Blame, rng: &mut Stream) -> bool {
        let (m, start) = (self.problem.domain(), self.problem.start());
        let mut resting = State { objects: state.objects.clone(), ..start.clone() };
        let component = match blame.kind {
            BlockKind::RobotFixed | BlockKind::RobotObject => {
                resting.robot.clone_from(&state.robot);
                ComponentId::Robot
            }
            BlockKind::ObjectFixed | BlockKind::ObjectObject => {
                let is_its = |component: &ComponentId| {
                    let name = m.component_name(*component);
                    *component != ComponentId::Robot && (*blame.first == *name || *blame.second == *name)
                };
                let moved = components(m, self.instance.moves).into_iter().find(is_its);
                let Some(moved) = moved else { return false };
                moved
            }
            // Other rules may be the validity's own.
            _ => return false,
        };
        (0..=WAYS_OUT).all(|i| {
            let mut near = resting.clone();
            let there = elsewhere(m, &resting, rng);
            let (before, mut after) = (near.clone(), near.clone());
            drift(m, &mut after, &there, component, 1.0);
            let far_m = component_travel(m, &before, &after);
            // The first time where it is.
            if i > 0 && far_m > DEEP_M {
                drift(m, &mut near, &there, component, DEEP_M / far_m);
            }
            entering("check");
            let found = self.problem.validity().check(m, &near, &D::Contacts::default());
            found.is_err_and(|other| other.kind == blame.kind)
        })
    }
}
