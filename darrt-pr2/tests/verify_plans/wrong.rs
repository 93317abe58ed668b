//! Right plans made wrong: each is refused at the right step, for the right reason, with the right bodies.

#[path = "wrong/clock.rs"]
mod clock;
#[path = "wrong/collisions.rs"]
mod collisions;
#[path = "wrong/contracts.rs"]
mod contracts;
#[path = "wrong/ends.rs"]
mod ends;
#[path = "wrong/hold.rs"]
mod hold;
#[path = "wrong/manipulation.rs"]
mod manipulation;
#[path = "wrong/margins.rs"]
mod margins;
#[path = "wrong/motions.rs"]
mod motions;

use darrt_pr2::verify;
use darrt_task::plan_file::{PlanFile, Pose, Waypoint};
use darrt_task::problem_file::{Obstacle, ShapeSpec};
use darrt_task::verify::{Refusal, RefusalKind};

use crate::verify_plans::builder::PLATE;

/// Edits the plan and checks what is said; `step` 0 means the plan as a whole.
fn refused(mut plan: PlanFile, step: u32, kind: RefusalKind, edit: impl FnOnce(&mut PlanFile)) -> Refusal {
    edit(&mut plan);
    let refusal = verify(&plan).expect_err("the plan is wrong");
    assert_eq!((refusal.step.unwrap_or(0), refusal.kind), (step, kind), "{refusal}");
    assert_eq!(refusal.primitive, refusal.step.map(|step| plan.steps[step as usize - 1].primitive.clone()));
    assert!((0.0..=1.0).contains(&refusal.time), "{refusal}");
    refusal
}

/// The bodies are these two, or start like these two, in either order.
fn about(refusal: &Refusal, a: &str, b: &str) {
    let (x, y) = refusal.bodies.as_deref().expect("two bodies");
    let fits = |x: &str, y: &str| x.starts_with(a) && y.starts_with(b);
    assert!(fits(x, y) || fits(y, x), "{refusal}");
}

fn waypoint(plan: &mut PlanFile, step: usize, index: usize) -> &mut Waypoint {
    &mut plan.steps[step - 1].waypoints[index]
}

/// Edits every waypoint from this one on, over the following steps too, so that the chain holds.
fn from_here_on(plan: &mut PlanFile, step: usize, index: usize, edit: impl Fn(&mut Waypoint)) {
    plan.steps[step - 1].waypoints.iter_mut().skip(index).for_each(&edit);
    plan.steps.iter_mut().skip(step).flat_map(|step| &mut step.waypoints).for_each(&edit);
}

fn plate(at: &mut Waypoint) -> &mut Pose {
    at.objects.get_mut(PLATE).unwrap()
}

fn joint<'a>(at: &'a mut Waypoint, name: &str) -> &'a mut f64 {
    at.joints.get_mut(name).unwrap()
}

fn block(name: &str, at: [f64; 3], size: [f64; 3]) -> Obstacle {
    Obstacle {
        name: name.to_owned(),
        shape: ShapeSpec::Box { size },
        at: at.to_vec(),
        standing_on: None,
        yaw: None,
        rpy: None,
        quaternion: None,
    }
}
