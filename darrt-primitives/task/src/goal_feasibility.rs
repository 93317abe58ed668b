//! Has the problem the means that its goal needs? Asked before the search, so that a goal for which a primitive or the
//! grasps are missing is an error with a name instead of a search to the end of the budget.
//!
//! Only what is certain counts: an object rests until it is picked, a push leaves it on its surface or on one that lies flush
//! with it, and only Place lets go of it.

use darrt_core::primitive::PrimitiveId;
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::primitive::{PICK, PUSH};
use darrt_primitives::push::Friction;
use darrt_primitives::push::steady::SlidingDisc;

use crate::grasp_families::{why_none_fits_tilt, why_none_holds};
use crate::planning_error::PlanningError;
use crate::problem_file::{GoalState, GoalTarget, Object, ObjectGoal, ProblemFile};
use crate::tied_hand::{why_not_lifted, why_not_pushed};

/// Checks that for every object some goal may hold at the start, or that it can be moved as that goal needs.
///
/// # Errors
/// [`PlanningError::InfeasibleGoal`] with the object, the goals and what is missing for each.
pub fn check_feasibility(
    problem: &ProblemFile,
    allowed: impl IntoIterator<Item = (PrimitiveId, Contract)>,
    robot: &impl Manipulator,
) -> Result<(), PlanningError> {
    let allowed: Vec<_> = allowed.into_iter().collect();
    let mut in_the_hand = None;
    for (name, alternatives) in problem.goal.by_object() {
        let Some(object) = problem.object(name) else { continue };
        let means = Feasibility::new(problem, object, &allowed, robot);
        let lacks: Vec<_> = alternatives.iter().map(|goal| means.lack(problem, goal)).collect();
        let refuse = |why: String| Err(PlanningError::InfeasibleGoal { object: name.to_owned(), why });
        if lacks.iter().all(Option::is_some) {
            return refuse(lacks.into_iter().flatten().collect::<Vec<_>>().join("; and "));
        }
        let must_be_held = alternatives.iter().all(|goal| goal.state() == GoalState::Held);
        if must_be_held && let Some(first) = in_the_hand.replace(name) {
            return refuse(format!("it must be in the hand at the end, and so must `{first}`; there is one hand"));
        }
    }
    Ok(())
}

/// What can be done with one object, each with the reason why not.
pub(crate) struct Feasibility<'a> {
    pub(crate) object: &'a Object,
    pub(crate) pick: Result<(), String>,
    pub(crate) place: Result<(), String>,
    pub(crate) push: Result<(), String>,
}

impl<'a> Feasibility<'a> {
    pub(crate) fn new(
        problem: &ProblemFile,
        object: &'a Object,
        allowed: &[(PrimitiveId, Contract)],
        robot: &impl Manipulator,
    ) -> Self {
        let fit = |is_fit: bool, lack: &str| if is_fit { Ok(()) } else { Err(lack.to_owned()) };
        let any = |does: fn(&Contract) -> bool| allowed.iter().any(|(_, contract)| does(contract));
        let is_allowed = |id: PrimitiveId| allowed.iter().any(|(other, _)| *other == id);
        let holds = |()| match why_none_holds(object, robot.hand(), robot.payload_kg()) {
            Some(why) => Err(format!("no grasp holds it: {why}")),
            None => Ok(()),
        };
        // Of a primitive that is not the paper's nothing is known but what it may do.
        let takes = any(|contract| contract.hand == HandUse::Takes);
        let lets_go = any(|contract| contract.hand == HandUse::LetsGo);
        let slides = any(Contract::slides);
        let is_own = |does: bool, id: PrimitiveId| does && !is_allowed(id);
        let pick = fit(takes, "`Pick` is not among the primitives");
        let ties = robot.hand_ties();
        let lifts = || why_not_lifted(&ties).map_or(Ok(()), Err);
        let fits = |()| why_none_fits_tilt(object, robot.hand(), &ties).map_or(Ok(()), Err);
        let pick = if is_own(takes, PICK) {
            pick
        } else {
            lifts()
                .and(pick)
                .and(fit(!object.grasps.is_empty(), "it has no `grasps` for Pick"))
                .and_then(fits)
                .and_then(holds)
        };
        let place = pick.clone().and(fit(lets_go, "`Place` is not among the primitives"));
        let push = fit(slides, "`Push` is not among the primitives");
        let push = if is_own(slides, PUSH) {
            push
        } else {
            let is_beside = |()| why_not_pushed(problem, object, robot).map_or(Ok(()), Err);
            let push = push.and(fit(object.pushable(), "it is not `pushable`")).and_then(is_beside);
            push.and_then(|()| steady(problem, object, robot))
        };
        Self { object, pick, place, push }
    }

    /// Why `goal` can certainly not be reached; `None` if it may be.
    fn lack(&self, problem: &ProblemFile, goal: &ObjectGoal) -> Option<String> {
        let index = problem.goal.objects.iter().position(|other| std::ptr::eq(other, goal)).unwrap_or(0);
        let key = format!("`goal.object[{index}]`");
        if goal.state() == GoalState::Held {
            return self.pick.as_ref().err().map(|lack| format!("{key} wants it in the hand, but {lack}"));
        }
        let by_hand = if goal.state() == GoalState::Released { &self.place } else { &self.pick };
        let lack = by_hand.as_ref().err()?;
        let start = &self.object.on;
        let is_across = |on: &str| problem.surfaces_across(self.object).iter().any(|name| name == on);
        let elsewhere = goal.on.as_deref().filter(|on| on != start && !is_across(on));
        if elsewhere.is_none() && self.may_hold_at_start(goal) {
            return None;
        }
        match elsewhere {
            Some(on) => Some(format!("{key} wants it on `{on}`, it starts on `{start}`, and {lack}")),
            None => self.push.as_ref().err().map(|push| format!("{key} wants it to move, but {lack}, and {push}")),
        }
    }

    /// Whether the object may already be where the goal wants it, if that is on what it stands on; by x and y alone, so that
    /// "no" is certain.
    fn may_hold_at_start(&self, goal: &ObjectGoal) -> bool {
        let [x, y] = self.object.at;
        let beside = match goal.target() {
            Some(GoalTarget::On { at: [u, v], .. } | GoalTarget::At { position: [u, v, _] }) => [x - u, y - v],
            Some(GoalTarget::Within { region, .. }) => {
                let ([u, v], [w, z]) = (region.min, region.max);
                [x - x.max(u).min(w), y - y.max(v).min(z)]
            }
            None => return true,
        };
        beside[0].hypot(beside[1]) <= goal.tolerance_m
    }
}

/// Whether two fingers push the object: why not, with the numbers.
fn steady(problem: &ProblemFile, object: &Object, robot: &impl Manipulator) -> Result<(), String> {
    let friction = |value| Friction::new(value).map_err(|error| error.to_string());
    let Some(radius_m) = object.shape.round_radius() else { return Ok(()) };
    let (table, fingers) = (friction(object.friction.table)?, friction(object.friction.fingers)?);
    let disc = SlidingDisc { radius_m, mass_kg: object.mass_kg, table, fingers };
    let gap_m = disc.finger_gap_m(problem.push.gap_m.min(robot.hand().max_gap_m()));
    let push = disc.steady_push(gap_m, problem.push.position_error_m, robot.push_force_n());
    push.map(|_| ()).map_err(|why| why.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem_file::GraspFamily;
    use crate::problem_file::PrimitiveName;
    use crate::testing::{Pr2, registry};
    use crate::testing::{builtin, builtin_names};

    fn checked(problem: &ProblemFile) -> Result<(), PlanningError> {
        let (robot, _) = <Pr2 as crate::robot::TaskRobot>::build(&problem.robot).unwrap();
        check_feasibility(problem, registry().allowed(problem), &robot)
    }

    /// What is said about an edited Plate1, whose plate goes from the central table to the side table.
    fn said(edit: impl Fn(&mut ProblemFile)) -> Option<String> {
        let mut problem = builtin("plate1").unwrap();
        edit(&mut problem);
        checked(&problem).err().map(|error| error.to_string())
    }

    fn without(problem: &mut ProblemFile, name: &PrimitiveName) {
        problem.primitives.retain(|other| other != name);
    }

    #[test]
    fn the_built_in_problems_have_what_they_need() {
        for name in builtin_names() {
            checked(&builtin(name).unwrap()).unwrap();
        }
    }

    #[test]
    fn goals_on_another_surface_need_pick_place_and_grasps() {
        assert_eq!(
            said(|p| without(p, &PrimitiveName::PICK)).unwrap(),
            "the goal of `plate` cannot be reached: `goal.object[0]` wants it on `side table`, it starts on `central \
             table`, and `Pick` is not among the primitives"
        );
        assert!(said(|p| without(p, &PrimitiveName::PLACE)).unwrap().contains("`Place` is not among the primitives"));
        assert!(said(|p| p.objects[0].grasps.clear()).unwrap().contains("it has no `grasps` for Pick"));
        // In the hand over the other table is good enough.
        let any = |p: &mut ProblemFile| {
            without(p, &PrimitiveName::PLACE);
            p.goal.objects[0].state = Some(GoalState::Any);
        };
        assert_eq!(said(any), None);
    }

    #[test]
    fn what_no_grasp_holds_is_not_carried() {
        let lack = |edit: fn(&mut Object)| said(|p| edit(&mut p.objects[0])).unwrap();
        let heavy = lack(|plate| plate.mass_kg = 50.0);
        assert!(heavy.ends_with("and no grasp holds it: it weighs 50 kg, the arm carries 1.8"), "{heavy}");
        let long = lack(|plate| plate.mass_kg = 0.6);
        let tips = "against tipping out of the pads it needs 57.9 N of grip, the gripper has 50";
        assert!(long.ends_with(tips), "{long}");
        let smooth = lack(|plate| plate.friction.fingers = 0.0);
        assert!(smooth.ends_with("no grasp holds it: the fingers have no friction with it"), "{smooth}");
        // By the side it holds, by the rim it does not: one is enough.
        let tin = |plate: &mut Object| {
            plate.shape = crate::problem_file::ShapeSpec::Cylinder { radius: 0.04, height: 0.05 };
            plate.rim.insertion_m = 0.002;
            plate.grasps = vec![GraspFamily::Rim];
        };
        assert!(lack(tin).contains("N of grip"));
        let by_the_side = said(|p| {
            tin(&mut p.objects[0]);
            p.objects[0].grasps.push(GraspFamily::Side);
        });
        assert_eq!(by_the_side, None);
        // What is only pushed may weigh more than the hand can hold, as long as the arm can push it.
        let pushed = |mass_kg: f64| {
            said(|p| {
                p.objects[0].mass_kg = mass_kg;
                p.goal.objects[0].on = Some("central table".to_owned());
                p.goal.objects[0].at = Some([-0.2, -0.2]);
            })
        };
        assert_eq!(pushed(5.0), None);
        assert!(pushed(50.0).unwrap().ends_with("and the arm pushes with 30.0 N"));
    }

    #[test]
    fn goals_on_the_same_surface_need_a_push_or_pick_and_place() {
        let here = |p: &mut ProblemFile| {
            p.goal.objects[0].on = Some("central table".to_owned());
            p.goal.objects[0].at = Some([-0.2, -0.2]);
            p.objects[0].grasps.clear();
        };
        assert_eq!(said(here), None, "it can be pushed");
        let still = said(|p| {
            here(p);
            p.objects[0].pushable = Some(false);
        });
        assert!(
            still.unwrap().ends_with("wants it to move, but it has no `grasps` for Pick, and it is not `pushable`")
        );
        let heavy = said(|p| {
            here(p);
            p.objects[0].mass_kg = 50.0;
        });
        let heavy = heavy.unwrap();
        assert!(
            heavy.ends_with("a push needs 147.2 N, with reserve 220.7 N, and the arm pushes with 30.0 N"),
            "{heavy}"
        );
        let there_already = said(|p| {
            here(p);
            without(p, &PrimitiveName::PUSH);
            p.goal.objects[0].at = Some(p.objects[0].at);
        });
        assert_eq!(there_already, None);
    }

    #[test]
    fn a_push_may_lead_to_a_surface_that_lies_flush() {
        let onto_leaf = |gap_m: f64| {
            let edit = move |p: &mut ProblemFile| {
                let table = p.geometry().unwrap().scene.surface("central table").unwrap().clone();
                let ((low, high), z) = (table.bounds(), table.height());
                let polygon = vec![
                    [high.x + gap_m, low.y],
                    [high.x + 1.0, low.y],
                    [high.x + 1.0, high.y],
                    [high.x + gap_m, high.y],
                ];
                let mut leaf = p.surfaces[0].clone();
                (leaf.name, leaf.top_of, leaf.polygon, leaf.z) = ("leaf".to_owned(), None, Some(polygon), Some(z));
                p.surfaces.push(leaf);
                p.goal.objects[0].on = Some("leaf".to_owned());
                p.goal.objects[0].at = Some([high.x + 0.3, 0.0]);
                p.objects[0].grasps.clear();
            };
            said(edit)
        };
        assert_eq!(onto_leaf(0.001), None);
        assert!(onto_leaf(0.1).unwrap().contains("it has no `grasps`"));
    }

    #[test]
    fn one_alternative_is_enough_and_all_that_fail_are_told() {
        let both = |p: &mut ProblemFile| {
            let mut held = p.goal.objects[0].clone();
            (held.on, held.at, held.position, held.state) = (None, None, Some([-1.0, 0.0, 0.9]), None);
            p.goal.objects.push(held);
            without(p, &PrimitiveName::PLACE);
        };
        assert_eq!(said(both), None);
        let neither = said(|p| {
            both(p);
            without(p, &PrimitiveName::PICK);
        });
        let neither = neither.unwrap();
        assert!(neither.contains("`goal.object[0]`") && neither.contains("`goal.object[1]` wants it in the hand"));
    }

    /// Anywhere on another surface is not where it stands, whatever x and y.
    #[test]
    fn anywhere_on_another_surface_needs_a_hand() {
        let why = said(|p| {
            without(p, &PrimitiveName::PICK);
            p.goal.objects[0].at = None;
        });
        assert!(why.is_some_and(|why| why.contains("wants it on `side table`") && why.contains("`Pick` is not among")));
    }

    #[test]
    fn one_hand_holds_one_object() {
        let two = said(|p| {
            let mut second = p.objects[0].clone();
            second.name = "bowl".to_owned();
            p.objects.push(second);
            let mut held = p.goal.objects[0].clone();
            held.state = Some(GoalState::Held);
            p.goal.objects = vec![held.clone(), ObjectGoal { object: "bowl".to_owned(), ..held }];
        });
        assert!(two.unwrap().ends_with("in the hand at the end, and so must `plate`; there is one hand"));
    }
}
