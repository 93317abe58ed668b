//! Right plans with wrong clocks.

use darrt_core::budget::Cancel;
use darrt_pr2::robot::Pr2;
use darrt_pr2::verify;
use darrt_primitives::contract::HandUse;
use darrt_task::clock::{MotionLimits, TimedPlan, give_clock};
use darrt_task::plan_file::PlanFile;
use darrt_task::plan_file::timing::Phase;
use darrt_task::robot::{RobotFacts, TaskRobot as _};
use darrt_task::verify::{RefusalKind, VerifyOptions, verify_clock};

use super::refused;
use crate::verify_plans::builder::PLATE;
use crate::verify_plans::plans;

/// Makes a good plan a wrong one.
type Edit = fn(&mut PlanFile);

fn facts(plan: &PlanFile) -> RobotFacts {
    Pr2::facts(&plan.problem.robot).unwrap()
}

fn timed(mut plan: PlanFile) -> PlanFile {
    let facts = facts(&plan);
    give_clock(&mut plan, &facts, &VerifyOptions::default(), &Cancel::new()).unwrap_or_else(|why| panic!("{why}"));
    plan
}

/// Seconds of the phases, as the file must say it.
fn settle(plan: &mut PlanFile) {
    let timing = plan.timing.as_mut().unwrap();
    timing.duration_s = timing.steps.iter().map(darrt_task::plan_file::timing::StepTiming::duration_s).sum();
}

/// The first phase of the first step of such a kind, with the number of its step.
fn phase(plan: &mut PlanFile, is_wanted: impl Fn(&PlanFile, usize, &Phase) -> bool) -> (u32, &mut Phase) {
    let timing = plan.timing.clone().unwrap();
    let phases = timing.steps.iter().enumerate();
    let mut phases = phases.flat_map(|(step, timing)| timing.phases.iter().enumerate().map(move |p| (step, p.0, p.1)));
    let (step, index, _) = phases.find(|(step, _, phase)| is_wanted(plan, *step, phase)).expect("such a phase");
    let number = u32::try_from(step).unwrap() + 1;
    (number, &mut plan.timing.as_mut().unwrap().steps[step].phases[index])
}

fn drives(plan: &PlanFile, step: usize, phase: &Phase) -> bool {
    plan.contracts[&plan.steps[step].primitive].drives() && phase.knots.len() == 2
}

/// A profile of this length at this peak speed, jerk as small as that allows; or at this jerk for so long.
fn even(length: f64, peak: f64) -> Vec<[f64; 2]> {
    let t = 0.9 * length / (2.0 * peak);
    let jerk = peak / (t * t);
    vec![[t, jerk], [t, -jerk], [(length - 2.0 * peak * t) / peak, 0.0], [t, -jerk], [t, jerk]]
}

#[test]
fn right_clocks_are_accepted() {
    for plan in [plans::push(), plans::carry(), plans::wave()] {
        let untimed = verify(&plan).unwrap();
        assert_eq!(untimed.duration_s, None);
        let plan = timed(plan);
        let proof = verify(&plan).unwrap();
        assert_eq!(proof.duration_s, plan.timing.as_ref().map(|timing| timing.duration_s));
        assert!(proof.duration_s.unwrap() > 1.0);
        let again = PlanFile::from_json(&plan.to_json().unwrap(), "text").unwrap();
        assert_eq!(again, plan);
        assert_eq!(verify(&again).unwrap(), proof);
    }
}

#[test]
fn a_waypoint_that_the_clock_leaves_out_lies_on_its_line() {
    let mut plan = plans::wave();
    let step =
        plan.steps.iter().position(|step| step.primitive.as_str() == "Arm-Transit").expect("a free way of the arm");
    let [.., from, to] = &plan.steps[step].waypoints[..] else { panic!("a step has two waypoints") };
    let mut middle = from.clone();
    for (name, value) in &mut middle.joints {
        *value = f64::midpoint(*value, to.joints[name]);
    }
    let at = plan.steps[step].waypoints.len() - 1;
    plan.steps[step].waypoints.insert(at, middle);
    let mut plan = timed(plan);
    verify(&plan).unwrap_or_else(|why| panic!("{why}"));
    let is_left_out = |phase: &Phase| phase.knots.windows(2).any(|pair| pair[0] < at && at < pair[1]);
    assert!(plan.timing.as_ref().unwrap().steps[step].phases.iter().any(is_left_out));
    *plan.steps[step].waypoints[at].joints.get_mut("r_elbow_flex_joint").unwrap() -= 1e-3;
    let refusal = verify(&plan).unwrap_err();
    assert_eq!((refusal.kind, refusal.step), (RefusalKind::Clock, u32::try_from(step + 1).ok()), "{refusal}");
    assert!(refusal.message.contains(&format!("leaves out waypoint {at}, which is 0.00")), "{refusal}");
}

/// Judged with differences of the places where the clock has the robot, and nothing else.
#[test]
fn joints_and_base_keep_their_limits_by_differences_too() {
    for plan in [plans::push(), plans::carry(), plans::wave()] {
        let plan = timed(plan);
        let facts = facts(&plan);
        let clock = TimedPlan::new(&plan, &facts).unwrap();
        let MotionLimits { turning_joint, drive, turn, .. } = facts.motion.clone();
        let h = 1e-3;
        let mut before = [0; 3].map(|_| clock.at(0.0));
        let mut t = h;
        while t < clock.duration_s() {
            let now = clock.at(t);
            let [a, b, c] = &before;
            let differences = |of: &dyn Fn(&darrt_task::clock::Moment) -> f64| {
                let [p, q, r, s] = [of(a), of(b), of(c), of(&now)];
                [(s - r) / h, (s - 2.0 * r + q) / (h * h), (s - 3.0 * r + 3.0 * q - p) / (h * h * h)].map(f64::abs)
            };
            for (i, variable) in clock.tree().variables().iter().enumerate() {
                let [v, acceleration, jerk] = differences(&|moment| moment.joints[i]);
                if v > 0.0 {
                    let name = &variable.name;
                    assert!(v <= variable.max_velocity * 1.001, "{name} {t}: {v}");
                    assert!(acceleration <= turning_joint.acceleration * 1.001, "{name} {t}: {acceleration}");
                    assert!(jerk <= turning_joint.jerk * 1.01, "{name} {t}: {jerk}");
                }
            }
            for (i, bounds) in [(0, drive), (1, drive), (2, turn)] {
                let [v, acceleration, jerk] = differences(&|moment| moment.base[i]);
                assert!(v <= bounds.velocity * 1.001 && acceleration <= bounds.acceleration * 1.001, "{t}: {v}");
                assert!(jerk <= bounds.jerk * 1.01, "{t}: {jerk}");
            }
            before.rotate_left(1);
            before[2] = now;
            t += h;
        }
        assert_eq!(clock.at(t).joint_velocity.iter().filter(|v| **v != 0.0).count(), 0, "it ends at rest");
    }
}

#[test]
fn the_clock_goes_by_the_waypoints_where_it_does_not_round() {
    let plan = timed(plans::carry());
    let clock = TimedPlan::new(&plan, &facts(&plan)).unwrap();
    for (index, step) in plan.steps.iter().enumerate() {
        let times = clock.waypoint_times_s(index).unwrap();
        assert_eq!(times.len(), step.waypoints.len());
        assert!(times.is_sorted() && times[0] == 0.0);
        let begin_s = clock.step_start_s(index).unwrap();
        for (waypoint, time_s) in step.waypoints.iter().zip(times) {
            let moment = clock.at(begin_s + time_s);
            let off = (moment.base[0] - waypoint.base[0]).hypot(moment.base[1] - waypoint.base[1]);
            assert!(off < 0.021, "step {index}: {off}");
        }
    }
    assert_eq!(clock.waypoint_times_s(plan.steps.len()), None);
}

#[test]
fn what_is_too_fast_is_refused() {
    let mut plan = timed(plans::around());
    let (step, around) = phase(&mut plan, |plan, step, _| plan.contracts[&plan.steps[step].primitive].drives());
    assert!(around.knots == [0, 1, 2] && around.blends[0] > 0.0, "{around:?}");
    // Stop at the corner, so that what follows is about straight lines.
    let [first, second] = [[0, 1], [1, 2]].map(|knots| Phase {
        knots: knots.to_vec(),
        lengths: vec![3.2],
        blends: Vec::new(),
        profile: even(3.2, 0.9),
        wait_s: 0.0,
        rest_s: 0.0,
    });
    plan.timing.as_mut().unwrap().steps[0].phases = vec![first, second];
    settle(&mut plan);
    assert!(verify(&plan).unwrap().duration_s.is_some());
    // A peak above full speed, reached gently.
    refused(plan.clone(), step, RefusalKind::Velocity, |plan| {
        let (_, phase) = phase(plan, drives);
        phase.profile = even(phase.length(), 1.05);
        settle(plan);
    });
    // At full jerk for longer than the acceleration allows.
    refused(plan.clone(), step, RefusalKind::Acceleration, |plan| {
        let limits = facts(plan).motion;
        let (_, phase) = phase(plan, drives);
        let jerk = limits.drive.jerk / limits.drive.velocity;
        let t = 1.2 * limits.drive.acceleration / limits.drive.jerk;
        let peak = jerk * t * t;
        let cruise = (phase.length() - 2.0 * peak * t) / peak;
        assert!(cruise > 0.0 && peak < 1.0);
        phase.profile = vec![[t, jerk], [t, -jerk], [cruise, 0.0], [t, -jerk], [t, jerk]];
        settle(plan);
    });
    // The same motion in a quarter of the time.
    refused(plan, step, RefusalKind::Jerk, |plan| {
        let (_, phase) = phase(plan, drives);
        phase.profile.iter_mut().for_each(|[seconds, jerk]| (*seconds, *jerk) = (*seconds / 4.0, *jerk * 64.0));
        settle(plan);
    });
}

#[test]
fn corners_are_not_passed_without_being_rounded() {
    let plan = timed(plans::push());
    let bend = |_: &PlanFile, _: usize, phase: &Phase| phase.blends.iter().any(|radius| *radius > 1e-3);
    let (step, _) = phase(&mut plan.clone(), bend);
    for radius in [0.0, 1e-13] {
        refused(plan.clone(), step, RefusalKind::Acceleration, |plan| {
            let (_, phase) = phase(plan, bend);
            phase.blends.iter_mut().for_each(|blend| *blend = radius);
        });
    }
}

/// A corner that is rounded is judged as it is driven.
#[test]
fn a_rounded_corner_passes_nothing_that_stands_in_it() {
    let rounded = |brick: [f64; 3]| {
        let mut plan = plans::around();
        plan.problem.obstacles.push(super::block("brick", brick, [0.1, 0.1, 0.2]));
        let mut plan = timed(plan);
        assert!(verify(&plan).is_ok());
        let step = &mut plan.timing.as_mut().unwrap().steps[0];
        let mut round = step.phases[0].clone();
        (round.knots, round.lengths, round.blends) = (vec![0, 1, 2], vec![5.0; 2], vec![4.75]);
        round.profile = even(10.0, 0.9);
        step.phases = vec![round];
        settle(&mut plan);
        verify(&plan)
    };
    assert!(rounded([2.0, 2.0, 0.1]).is_ok());
    // Beside both ways, inside of the corner.
    let refusal = rounded([-1.85, 0.55, 0.1]).unwrap_err();
    assert!(refusal.message.starts_with("where the clock rounds corners: "), "{refusal}");
    assert_eq!((refusal.step, refusal.kind), (Some(1), RefusalKind::Collision), "{refusal}");
}

/// A clock that cuts corners is another motion than that of the waypoints, free or not.
#[test]
fn waypoints_are_not_left_out_unless_they_lie_on_the_line() {
    let mut plan = plans::around();
    // Beside both ways, and on the straight line between their ends.
    plan.problem.obstacles.push(super::block("brick", [-1.6, 0.8, 0.1], [0.2, 0.2, 0.2]));
    let mut plan = timed(plan);
    assert!(verify(&plan).is_ok());
    let cut = &mut plan.timing.as_mut().unwrap().steps[0].phases[0];
    (cut.knots, cut.lengths, cut.blends) = (vec![0, 2], vec![10.0], Vec::new());
    cut.profile = even(10.0, 0.9);
    settle(&mut plan);
    let refusal = verify(&plan).unwrap_err();
    assert!(refusal.message.starts_with("leaves out waypoint 1, which is 0.8"), "{refusal}");
    assert_eq!((refusal.step, refusal.kind), (Some(1), RefusalKind::Clock), "{refusal}");
    let is_push = |plan: &PlanFile, step: usize, phase: &Phase| {
        plan.contracts[&plan.steps[step].primitive].slides() && phase.knots.len() > 2
    };
    let plan = timed(plans::push());
    let (step, _) = phase(&mut plan.clone(), is_push);
    refused(plan, step, RefusalKind::Clock, |plan| {
        let (_, phase) = phase(plan, is_push);
        let (first, last) = (phase.knots[0], *phase.knots.last().unwrap());
        (phase.knots, phase.lengths, phase.blends) = (vec![first, last], vec![30.0], Vec::new());
        phase.profile = even(30.0, 1.5);
        settle(plan);
    });
}

#[test]
fn pushes_are_quasi_static_and_full_things_are_carried_gently() {
    let plan = timed(plans::push());
    let judged = |plan: &PlanFile| verify_clock(plan, &facts(plan), &VerifyOptions::default(), &Cancel::new());
    assert_eq!(judged(&plan), Ok(()));
    let pushing = u32::try_from(plan.steps.iter().position(|step| step.pushes.is_some()).unwrap()).unwrap() + 1;
    let mut slippery = plan;
    slippery.problem.objects.iter_mut().for_each(|object| object.friction.table = 0.05);
    let refusal = judged(&slippery).unwrap_err();
    assert_eq!((refusal.kind, refusal.step), (RefusalKind::Pace, Some(pushing)), "{refusal}");
    let mut full = timed(plans::carry());
    assert_eq!(judged(&full), Ok(()));
    full.problem.objects.iter_mut().filter(|object| object.name == PLATE).for_each(|o| o.max_tilt_deg = Some(0.5));
    let refusal = judged(&full).unwrap_err();
    assert_eq!(refusal.kind, RefusalKind::Pace, "{refusal}");
    assert!(refusal.message.contains("accelerates by"), "{refusal}");
}

#[test]
fn grasps_take_their_time() {
    let takes = |plan: &PlanFile, step: usize, phase: &Phase| {
        plan.contracts[&plan.steps[step].primitive].hand == HandUse::Takes && phase.rest_s > 0.0
    };
    let lets_go = |plan: &PlanFile, step: usize, phase: &Phase| {
        plan.contracts[&plan.steps[step].primitive].hand == HandUse::LetsGo && phase.wait_s > 0.0
    };
    let plan = timed(plans::carry());
    let (step, _) = phase(&mut plan.clone(), takes);
    refused(plan.clone(), step, RefusalKind::Wait, |plan| {
        phase(plan, takes).1.rest_s = 0.2;
        settle(plan);
    });
    let (step, _) = phase(&mut plan.clone(), lets_go);
    refused(plan, step, RefusalKind::Wait, |plan| {
        phase(plan, lets_go).1.wait_s = 0.0;
        settle(plan);
    });
}

#[test]
fn what_is_no_clock_is_refused_and_said_where() {
    let plan = timed(plans::wave());
    let edits: [(&str, Edit); 8] = [
        ("timing.duration_s", |plan| plan.timing.as_mut().unwrap().duration_s += 1.0),
        ("timing.steps", |plan| drop(plan.timing.as_mut().unwrap().steps.pop())),
        ("timing.steps[0]", |plan| plan.timing.as_mut().unwrap().steps[0].phases.clear()),
        ("timing.steps[0].phases[0]", |plan| plan.timing.as_mut().unwrap().steps[0].phases[0].knots[0] = 1),
        ("timing.steps[0].phases[0]", |plan| plan.timing.as_mut().unwrap().steps[0].phases[0].lengths[0] = -1.0),
        ("timing.steps[0].phases[0]", |plan| plan.timing.as_mut().unwrap().steps[0].phases[0].rest_s = f64::NAN),
        ("timing.steps[0].phases[0]", |plan| {
            let _ = plan.timing.as_mut().unwrap().steps[0].phases[0].profile.pop();
        }),
        ("timing.steps[0].phases[0]", |plan| {
            plan.timing.as_mut().unwrap().steps[0].phases[0].profile.insert(0, [0.1, -5.0]);
        }),
    ];
    for (place, edit) in edits {
        let refusal = refused(plan.clone(), 0, RefusalKind::Clock, edit);
        assert!(refusal.message.contains(&format!("`{place}`")), "{place}: {refusal}");
    }
}
