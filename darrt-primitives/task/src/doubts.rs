//! Will a problem have a plan? Before the search its own actions are tried where they will be needed: at the start and at the
//! goals. What can be said for certain is an error; what is only likely is a doubt, and the search goes on.

use std::collections::BTreeMap;

use darrt_core::budget::Cancel;
use darrt_core::goal::Goal as _;
use darrt_core::observe::accounts::Bucket;
use darrt_core::primitive::{Infeasible, PrimitiveId};
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_geom::{Scene, Shape};
use darrt_primitives::action::pick::{lies_flat, pick};
use darrt_primitives::action::place::place;
use darrt_primitives::action::push::push;
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::goal::{Grip, TabletopGoal};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::mode::Held;
use darrt_primitives::primitive::{PICK, PLACE, PUSH};
use darrt_primitives::tabletop::{Movable, Tabletop, TabletopState};
use nalgebra::{Isometry3, Translation3};
use rand::{Rng, RngExt as _};

use crate::goal_feasibility::Feasibility;
use crate::grasp_families::why_none_holds;
use crate::planning_error::PlanningError;
use crate::problem_file::{Object, ProblemFile, ShapeSpec};
use crate::text::counted;

/// How often an action is tried before it is doubted; a push, which has one direction that may be right, more often.
const TRIES: u64 = 32;
const PUSHES: u64 = 256;
/// A push that ends so near to the goal has come to it, metres.
const NEARLY_M: f64 = 0.02;
/// What is named as being in the way at most.
const REASONS: usize = 3;
/// Objects that may be moved out of the way are lifted so far, metres.
const ASIDE_M: f64 = 100.0;
/// A mesh that is wider is doubted, metres.
const WIDEST_M: f64 = 20.0;
/// How far it is tried to push an object, metres.
const NEAR_M: f64 = 0.1;
const FAR_M: f64 = 1.5;

/// What makes a plan unlikely, or may not be meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Doubt {
    /// In words.
    pub words: String,
    /// What a plan shows all the same, in words; `None` for what stays in doubt when there is a plan.
    pub refuted: Option<String>,
}

impl Doubt {
    /// What a plan does not refute.
    fn of_input(words: String) -> Self {
        Self { words, refuted: None }
    }
}

impl std::fmt::Display for Doubt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.words)
    }
}

/// What the problem file alone leaves in doubt: meshes that are probably not in metres or not closed.
pub(crate) fn of_meshes(problem: &ProblemFile, scene: &Scene, movables: &[Movable]) -> Vec<Doubt> {
    let bodies = scene.bodies().iter().map(|fixed| &fixed.body);
    let obstacles = problem.obstacles.iter().map(|obstacle| &obstacle.shape).zip(bodies);
    let bodies = movables.iter().map(|movable| &movable.body);
    let objects = problem.objects.iter().map(|object| &object.shape).zip(bodies);
    let mut doubts = Vec::new();
    for (shape, body) in obstacles.chain(objects) {
        let ShapeSpec::Mesh { scale, .. } = shape else { continue };
        let name = &body.name;
        let (low, high) = body.local_aabb();
        let width_m = (high - low).max();
        if width_m > WIDEST_M {
            let smaller = scale / 1000.0;
            let words = format!(
                "`{name}` is {width_m:.0} m wide: is its mesh in millimetres? Then it needs `scale = {smaller}`"
            );
            doubts.push(Doubt::of_input(words));
        }
        let open: usize =
            body.parts.iter().map(|part| if let Shape::Mesh(mesh) = &part.shape { mesh.open_edges() } else { 0 }).sum();
        if open > 0 {
            let edges = counted(open as u64, "edge");
            let words = format!(
                "the mesh of `{name}` is not closed ({edges} with nothing on one side): it counts as a shell, and what is inside \
                 it does not touch it"
            );
            doubts.push(Doubt::of_input(words));
        }
    }
    doubts
}

/// A problem whose actions are tried.
pub(crate) struct Outlook<'a, M: Manipulator> {
    pub(crate) problem: &'a ProblemFile,
    pub(crate) allowed: &'a [(PrimitiveId, Contract)],
    pub(crate) m: &'a Tabletop<M>,
    pub(crate) start: &'a TabletopState<M>,
    pub(crate) goal: &'a TabletopGoal<M::Joints>,
    /// Ends the tries: then nothing is doubted.
    pub(crate) cancel: &'a Cancel,
}

impl<'a, M: Manipulator> Outlook<'a, M> {
    /// The objects that nothing can move.
    pub(crate) fn immovable(&self) -> Vec<ObjectId> {
        let is_fixed = |(id, object)| {
            let means = self.means(object);
            (means.pick.is_err() && means.push.is_err()).then_some(id)
        };
        self.objects().filter_map(is_fixed).collect()
    }

    /// Checks that no object which must move lies flat, with grasps only by a rim that must overhang, and without a push.
    ///
    /// # Errors
    /// [`PlanningError::InfeasibleGoal`] with the object and what would help.
    pub(crate) fn check_rims(&self) -> Result<(), PlanningError> {
        for (id, object) in self.objects().filter(|(id, _)| self.must_move(*id)) {
            let Err(no_push) = self.means(object).push else { continue };
            if self.is_ours(PICK, |contract| contract.hand == HandUse::Takes) && lies_flat(self.m, self.start, id) {
                let why = if object.grasps.is_empty() {
                    format!("it has no `grasps` for Pick, and it is not pushed: {no_push}")
                } else {
                    format!(
                        "it is only taken by its rim, where it stands on `{}` its rim does not overhang an edge, and it is not \
                         pushed to one: {no_push}",
                        object.on
                    )
                };
                return Err(PlanningError::InfeasibleGoal { object: object.name.clone(), why });
            }
        }
        Ok(())
    }

    /// What makes a plan unlikely; empty for most problems. `immovable` is [`Outlook::immovable`].
    pub(crate) fn doubts(&self, immovable: &[ObjectId]) -> Vec<Doubt> {
        let wanted = self.objects().filter(|(id, _)| self.must_move(*id));
        let actions = wanted.flat_map(|(id, object)| {
            let alone = self.alone(id, immovable);
            let means = self.means(object);
            [self.of_leaving(id, &means, &alone), self.of_arriving(id, &means, &alone)]
        });
        self.of_grasps().chain(actions.flatten()).collect()
    }

    /// Objects that must move and have grasps none of which holds them; else that they are only pushed would not be said.
    fn of_grasps(&self) -> impl Iterator<Item = Doubt> + use<'_, 'a, M> {
        let robot = self.m.manipulator();
        self.objects().filter(|(id, object)| self.must_move(*id) && !object.grasps.is_empty()).filter_map(
            |(_, object)| {
                let why = why_none_holds(object, robot.hand(), robot.payload_kg())?;
                Some(Doubt::of_input(format!("no grasp holds `{}`, so that it can only be pushed: {why}", object.name)))
            },
        )
    }

    pub(crate) fn objects(&self) -> impl Iterator<Item = (ObjectId, &'a Object)> + use<'a, M> {
        self.problem.objects.iter().enumerate().map(|(index, object)| (ObjectId::new(index), object))
    }

    pub(crate) fn means(&self, object: &'a Object) -> Feasibility<'a> {
        Feasibility::new(self.problem, object, self.allowed, self.m.manipulator())
    }

    /// Does only this primitive of ours do that? Of a user's own nothing is known.
    pub(crate) fn is_ours(&self, id: PrimitiveId, does: impl Fn(&Contract) -> bool) -> bool {
        self.allowed.iter().all(|(other, contract)| *other == id || !does(contract))
    }

    pub(crate) fn must_move(&self, id: ObjectId) -> bool {
        let mut groups = self.goal.groups().iter().filter(|group| group.iter().any(|goal| goal.object == id));
        groups.any(|group| !group.iter().any(|goal| goal.is_met(self.start)))
    }

    /// The start, with the objects that may be moved out of the way of `id` out of its way.
    pub(crate) fn alone(&self, id: ObjectId, immovable: &[ObjectId]) -> TabletopState<M> {
        let mut state = self.start.clone();
        for (index, pose) in state.objects.iter_mut().enumerate() {
            let other = ObjectId::new(index);
            if other != id && !immovable.contains(&other) {
                *pose = Translation3::new(0.0, 0.0, ASIDE_M) * *pose;
            }
        }
        state
    }

    /// Can the object leave where it stands?
    fn of_leaving(&self, id: ObjectId, means: &Feasibility<'_>, state: &TabletopState<M>) -> Option<Doubt> {
        let is_known =
            self.is_ours(PICK, |contract| contract.hand == HandUse::Takes) && self.is_ours(PUSH, Contract::slides);
        if !is_known {
            return None;
        }
        let pose = *state.object(id)?;
        let name = &means.object.name;
        let no_pick = match &means.pick {
            Ok(()) if lies_flat(self.m, state, id) => "it is only taken by its rim, which lies flat".to_owned(),
            Ok(()) => self.tried(TRIES, "pick", |rng| pick(self.m, state, id, rng).map(drop))?,
            Err(why) => why.clone(),
        };
        let no_push = match &means.push {
            Ok(()) => self.tried(PUSHES, "push", |rng| push(self.m, state, id, &around(rng, &pose), rng).map(drop))?,
            Err(why) => why.clone(),
        };
        Some(Doubt {
            words: format!("`{name}` can hardly leave where it stands: {no_pick}; {no_push}"),
            refuted: Some(format!("`{name}` can leave where it stands, which was doubted")),
        })
    }

    /// Has the object a goal on what it stands on, to which a push may lead?
    pub(crate) fn may_be_pushed_there(&self, means: &Feasibility<'_>) -> bool {
        let object = means.object;
        let across = self.problem.surfaces_across(object);
        let goals = self.problem.goal.objects.iter().filter(|goal| goal.object == object.name);
        let is_near = |on: &str| on == object.on || across.iter().any(|name| *name == on);
        let mut goals = goals.map(|goal| goal.on.as_deref());
        means.push.is_ok() && goals.any(|on| on.is_none_or(is_near))
    }

    /// Can the object be set down at its goal?
    fn of_arriving(&self, id: ObjectId, means: &Feasibility<'_>, state: &TabletopState<M>) -> Option<Doubt> {
        let is_known = self.is_ours(PLACE, |contract| contract.hand == HandUse::LetsGo);
        let groups = self.goal.groups().iter();
        let needs_hand = groups.flatten().filter(|goal| goal.object == id).all(|goal| goal.grip == Grip::Released);
        if !is_known || !needs_hand || means.place.is_err() {
            return None;
        }
        // Where the robot shall be is not what keeps an object away.
        let goal = self.goal.of_objects();
        let target = |rng: &mut dyn Rng| {
            let target = goal.sample(self.m, rng).ok_or(Infeasible::OffSupport)?;
            target.object(id).copied().ok_or(Infeasible::OffSupport)
        };
        let no_place = self.tried(TRIES, "set it down", |rng| {
            let target = target(rng)?;
            let held = self.held(state, id, rng).ok_or(Infeasible::NoHold)?;
            place(self.m, &held, &target, rng).map(drop)
        })?;
        let name = &means.object.name;
        let refuted = format!("`{name}` can come to its goal, which was doubted");
        if !self.may_be_pushed_there(means) {
            let words = format!("`{name}` can hardly be set down at its goal: {no_place}");
            return Some(Doubt { words, refuted: Some(refuted) });
        }
        let no_push = self.tried(PUSHES, "push it there", |rng| {
            let target = target(rng)?;
            let way = push(self.m, state, id, &target, rng)?;
            let end = way.last().map(|last| last.at(self.m, 1.0, state));
            let there = end.as_ref().and_then(|end| end.object(id)).ok_or(Infeasible::NoProgress)?;
            let off_m = (there.translation.vector - target.translation.vector).norm();
            if off_m <= NEARLY_M { Ok(()) } else { Err(Infeasible::NoProgress) }
        })?;
        let words = format!("`{name}` can hardly come to its goal: {no_place}; {no_push}");
        Some(Doubt { words, refuted: Some(refuted) })
    }

    /// Tries until it succeeds; what was in the way if it never does.
    fn tried(
        &self,
        tries: u64,
        what: &str,
        mut action: impl FnMut(&mut dyn Rng) -> Result<(), Infeasible>,
    ) -> Option<String> {
        let mut reasons = BTreeMap::<String, u64>::new();
        for i in 0..tries {
            if self.cancel.is_cancelled() {
                return None;
            }
            match action(&mut stream(0, 0, i, Purpose::Attempt)) {
                Ok(()) => return None,
                Err(why) => *reasons.entry(in_words(&why)).or_default() += 1,
            }
        }
        let mut reasons: Vec<_> = reasons.into_iter().collect();
        reasons.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let reasons: Vec<_> =
            reasons.into_iter().take(REASONS).map(|(reason, count)| format!("{reason} ({count})")).collect();
        Some(format!("all of {tries} tries to {what} fail: {}", reasons.join(", ")))
    }

    /// The object in the hand, by one of its grasps.
    fn held(&self, from: &TabletopState<M>, id: ObjectId, rng: &mut dyn Rng) -> Option<TabletopState<M>> {
        let (m, movable) = (self.m, self.m.movable(id)?);
        let family = movable.grasps.get(rng.random_range(0..movable.grasps.len()))?;
        let grasp = family.sample(rng);
        let hold = m.hold(0, movable, &**family, &grasp).ok()?;
        let tool_from_object = grasp.object_from_tool.inverse();
        let held = Held { object: id, tool_from_object, max_tilt_rad: hold.max_tilt_rad };
        let mut state = from.clone();
        state.mode = state.mode.engaged_with(id)?.attached(held, grasp.closed_gap_m)?;
        *state.objects.get_mut(id.index())? = m.manipulator().world_from_tool(&state.robot) * tool_from_object;
        Some(state)
    }
}

/// A place around the object, also beyond the edge of what it stands on: a push to there ends at the edge.
fn around(rng: &mut dyn Rng, pose: &Isometry3<f64>) -> Isometry3<f64> {
    let (y, x) = rng.random_range(-std::f64::consts::PI..std::f64::consts::PI).sin_cos();
    let far_m = rng.random_range(NEAR_M..FAR_M);
    Translation3::new(far_m * x, far_m * y, 0.0) * pose
}

fn in_words(why: &Infeasible) -> String {
    match why {
        Infeasible::Blocked(blame) => format!("{} meets {}", blame.first, blame.second),
        Infeasible::Unreachable | Infeasible::Limits => "out of the arm's reach".to_owned(),
        Infeasible::NoProgress => "the pushes end before".to_owned(),
        Infeasible::OffSupport => "too near to an edge, or beside what it may stand on".to_owned(),
        other => Bucket::from(other).heading().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planning::prepare;
    use crate::problem_file::PrimitiveName;
    use crate::testing::{builtin, builtin_names, registry};

    fn prepared(edit: impl Fn(&mut ProblemFile)) -> Result<Vec<Doubt>, PlanningError> {
        let mut problem = builtin("plate1").unwrap();
        edit(&mut problem);
        prepare(&registry(), &problem).map(|prepared| prepared.doubts)
    }

    #[test]
    fn what_has_a_plan_is_not_doubted() {
        for name in builtin_names() {
            let doubts = prepare(&registry(), &builtin(name).unwrap()).unwrap().doubts;
            assert!(doubts.is_empty(), "{name}: {doubts:?}");
        }
    }

    #[test]
    fn a_rim_that_lies_flat_without_a_push_is_an_error() {
        let message = prepared(|p| p.primitives.retain(|name| *name != PrimitiveName::PUSH)).unwrap_err().to_string();
        let why = "its rim does not overhang an edge, and it is not pushed to one: `Push` is not among the primitives";
        assert!(message.contains("`plate`") && message.ends_with(why), "{message}");
    }

    #[test]
    fn grasps_that_never_hold_are_told_though_a_push_does_it() {
        let doubts = prepared(|p| {
            p.objects[0].friction.fingers = 0.0;
            p.goal.objects[0].on = Some("central table".to_owned());
            p.goal.objects[0].at = Some([-0.2, -0.2]);
        });
        let doubts = doubts.unwrap();
        let told = doubts.iter().find(|doubt| doubt.refuted.is_none()).unwrap();
        assert!(told.words.contains("no grasp holds `plate`") && told.words.contains("no friction"), "{told}");
    }

    #[test]
    fn a_goal_where_no_hand_comes_is_doubted() {
        // In the middle of a table a hand at the rim has the table in its way.
        let doubts = prepared(|p| p.goal.objects[0].at = Some([-2.4, -1.45])).unwrap();
        assert!(
            doubts.iter().any(|doubt| doubt.words.contains("`plate` can hardly be set down at its goal")),
            "{doubts:?}"
        );
    }
}
