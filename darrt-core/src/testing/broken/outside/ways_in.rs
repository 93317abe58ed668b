//! Verifiers that let plans into something, or refuse what one primitive does.

use std::sync::Arc;

use super::super::{Case, seed};
use crate::goal::Goal;
use crate::laws::verifier::{ACCEPTS, WAYS_IN};
use crate::laws::{Broken, check_ways};
use crate::motion::Instance;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::state::{ComponentSet, State};
use crate::testing::puck::{Judge, Obstacle, Oracle, Outline, PuckWorld, Setup, paper_strategy};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};
use crate::verify::{Refusal, Replay, Verified, Verifier};

/// Is this blame overlooked?
type Overlooks = fn(&State<PuckWorld>, &Blame) -> bool;

/// The oracle of the pucks, which overlooks something.
struct Lenient(Oracle, Overlooks);

impl Validity<PuckWorld> for Lenient {
    fn check(&self, m: &PuckWorld, state: &State<PuckWorld>, contacts: &ComponentSet) -> Result<(), Blame> {
        self.0.check(m, state, contacts).or_else(|blame| if (self.1)(state, &blame) { Ok(()) } else { Err(blame) })
    }

    // Replays look at states.
    fn free_prefix(&self, _: &PuckWorld, _: &Instance<PuckWorld>, _: &State<PuckWorld>) -> FreePrefix {
        FreePrefix::FREE
    }
}

/// The judge of the pucks, who accepts only some.
struct Picky(Judge, fn(&PuckWorld, &Plan<PuckWorld>, usize) -> bool);

impl Verifier<PuckWorld> for Picky {
    fn verify(
        &self,
        m: &PuckWorld,
        start: &State<PuckWorld>,
        goal: &dyn Goal<PuckWorld>,
        plan: &Plan<PuckWorld>,
    ) -> Result<Verified, Refusal> {
        let verified = self.0.verify(m, start, goal, plan)?;
        match (0..plan.steps().len()).find(|step| !(self.1)(m, plan, *step)) {
            Some(step) => Err(Refusal { step: Some(step), at: 0.5, reason: "not as it should be".to_owned() }),
            None => Ok(verified),
        }
    }
}

const LOWER: [f64; 2] = [1.9, 0.0];
const UPPER: [f64; 2] = [2.1, 1.8];

/// Everything of a room with a wall, a pillar and two pucks, one of which can be picked; but the goal asks for the robot only.
fn judged<V: Verifier<PuckWorld> + 'static>(verifier: impl FnOnce(Vec<Obstacle>) -> V) -> Result<(), Broken> {
    let malformed = |error: crate::error::Error| {
        Broken::new("testing.bench: the honest twin can be built", error.to_string(), "a problem")
    };
    let setup = Setup::new([4.0, 3.0], 0.15).robot_at([0.6, 0.6]).robot_goal([3.4, 0.6]);
    let setup = setup.graspable_puck("red", 0.12, [1.2, 1.2]).puck("blue", 0.12, [3.0, 2.2]);
    let problem = setup.wall("wall", LOWER, UPPER).pillar("pillar", [1.0, 2.4], 0.25).problem().map_err(malformed)?;
    let obstacle = |name: &str, outline| Obstacle { name: name.into(), outline };
    let obstacles = vec![
        obstacle("wall", Outline::Rectangle { lower: LOWER, upper: UPPER }),
        obstacle("pillar", Outline::Disc { centre: [1.0, 2.4], radius_m: 0.25 }),
    ];
    let (goal, primitives, validity, _) = problem.shared_parts();
    let parts = (goal, primitives, validity, Arc::new(verifier(obstacles)) as Arc<dyn Verifier<PuckWorld>>);
    let problem = Problem::of_shared(problem.shared_domain(), problem.start().clone(), parts);
    // What `check_everything` asks for at its default effort.
    check_ways(&problem.map_err(malformed)?, &paper_strategy().map_err(malformed)?, seed(), 180, 192)
}

fn lenient(overlooks: Overlooks) -> Result<(), Broken> {
    judged(|obstacles| Replay::new(Lenient(Oracle::new(obstacles), overlooks), 1e-3))
}

fn picky(accepts: fn(&PuckWorld, &Plan<PuckWorld>, usize) -> bool) -> Result<(), Broken> {
    judged(|obstacles| Picky(Judge::new(obstacles), accepts))
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || judged(Judge::new) };
    vec![
        case("objects among themselves", "whether two objects overlap is not looked at", WAYS_IN, || {
            lenient(|_, blame| blame.kind == BlockKind::ObjectObject)
        }),
        case("what is held is thin air", "what is in the hand may be led through the wall", WAYS_IN, || {
            lenient(|state, blame| blame.kind == BlockKind::ObjectFixed && state.mode.held().is_some())
        }),
        case("no hands allowed", "refuses every plan with something in the hand", ACCEPTS, || {
            picky(|m, plan, step| plan.at(m, step, 1.0).is_some_and(|state| state.mode.held().is_none()))
        }),
        case("keeps its distance", "a touch is an overlap: of a millimetre, which was to be allowed", ACCEPTS, || {
            picky(|m, plan, step| {
                let ends = plan.at(m, step, 1.0);
                ends.is_some_and(|state| m.ids().all(|id| m.gap(&state, id) > 1e-3))
            })
        }),
        case("no pushes allowed", "takes the puck that is pushed for one that moves by itself", ACCEPTS, || {
            picky(|m, plan, step| {
                let ends = [0.0, 1.0].map(|s| plan.at(m, step, s));
                let [Some(before), Some(after)] = ends else { return false };
                before.objects == after.objects || before.mode.held().is_some()
            })
        }),
    ]
}
