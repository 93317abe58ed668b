//! `darrt why-not`: what is wrong with a state, a place of the hand, a grasp or a plan that a person has in mind.

use std::path::Path;

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_task::diagnosis::cause::Stage;
use darrt_task::diagnosis::why_not::{Fault, Idea, Variant, WhyNot, WhyNotRequest, Wrong};
use darrt_task::file_kind::FileKind;
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::PlanRequest;
use darrt_task::program::Program;
use darrt_task::replan::ReplanRequest;
use darrt_task::text::{counted, on_one_line};
use darrt_task::verify::{VerifyOptions, verify_with};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use super::source::{Given, on_stdin};
use super::{check, plan};
use crate::args::WhyNotOptions;
use crate::diagnosis;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};

/// Looks at the idea and tells what it finds.
///
/// # Errors
/// What cannot be read, or is no idea for the problem.
pub(crate) fn run(program: &dyn Program, options: &WhyNotOptions, output: &mut Output) -> Result<Exit, Failure> {
    let is_plan = program.problems().find(&options.source).is_none()
        && FileKind::of_file(Path::new(&options.source)) == Some(FileKind::Plan);
    let problem = match on_stdin(program, &options.source)? {
        Some(Given::Plan(plan)) => return of_plan(program, options, *plan, output),
        Some(Given::Problem(problem)) => Some(*problem),
        None if is_plan => {
            let plan = check::read(program, Path::new(&options.source))?;
            return of_plan(program, options, plan, output);
        }
        None => None,
    };
    let idea = match (options.tool, options.base, &options.joints) {
        (Some([x, y, z, roll, pitch, yaw]), None, None) => Idea::Hand {
            world_from_tool: Isometry3::from_parts(
                Translation3::new(x, y, z),
                UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            ),
            takes: options.take.clone(),
        },
        (None, None, None) => {
            let text = format!(
                "{}: say what you have in mind: a place of the hand (--tool), the robot (--base, --joints), or give a plan",
                options.source
            );
            return Err(Failure::input(text));
        }
        (_, base, joints) => Idea::State { base, joints: joints.clone() },
    };
    let problem = problem.map_or_else(|| program.open(&options.source), Ok)?;
    let request = WhyNotRequest { problem, idea };
    let answer = program.why_not(&request).map_err(|error| Failure::input(format!("{}: {error}", options.source)))?;
    if options.json {
        output.print(&output::json(&answer, "the answer")?)?;
    } else {
        // Its lines are options to be copied.
        output.print(&words(&request.idea, &answer))?;
    }
    Ok(if answer.fault.is_none() { Exit::Solved } else { Exit::NotSolved })
}

/// Judges a plan; one that is refused, or only the beginning of one, is planned on from its last step that is right.
fn of_plan(
    program: &dyn Program,
    options: &WhyNotOptions,
    from: PlanFile,
    output: &mut Output,
) -> Result<Exit, Failure> {
    if options.tool.is_some() || options.base.is_some() || options.joints.is_some() {
        let text = format!("{}: is a plan; --tool, --base and --joints are asked of a problem", options.source);
        return Err(Failure::input(text));
    }
    let is_partial = from.partial.is_some();
    let mut request = PlanRequest::new(from.problem.clone(), options.seed);
    request.iterations = Some(options.iterations);
    let of = from.steps.len();
    let remains = diagnosis::text::of_parts(from.partial.as_ref());
    let cancel = Cancel::new();
    plan::listen(&cancel);
    let failed = |error: darrt_task::planning_error::PlanningError| {
        Failure::input(on_one_line(&format!("{}: {error}", options.source)))
    };
    let facts = program.facts(&from.problem).map_err(|error| Failure::input(error.to_string()))?;
    let refusal = verify_with(&from, &facts, &VerifyOptions::default()).err();
    if refusal.is_none() && !is_partial {
        output.print(&if options.json {
            output::json(&serde_json::json!({ "plan": options.source, "wrong": null }), "the answer")?
        } else {
            format!("{}: nothing is wrong with it", options.source)
        })?;
        return Ok(Exit::Solved);
    }
    let mut lines = vec![match &refusal {
        Some(refusal) => format!("wrong first: {refusal}"),
        None => format!("its {} are right; {remains}", counted(of as u64, "step")),
    }];
    let whole = ReplanRequest { plan: request.clone(), from, keep: None };
    let replanned = program.replan(&whole, &cancel, &mut Silent).map_err(failed)?;
    if cancel.is_cancelled() {
        return Err(Failure::new(Exit::Interrupted, format!("{}: interrupted", options.source)));
    }
    let kept = match (replanned.kept, replanned.tail) {
        (0, 0) => "planned anew".to_owned(),
        (kept, 0) => format!("with the first {} kept", counted(kept as u64, "step")),
        (kept, tail) => format!("with the first {kept} and the last {} kept", counted(tail as u64, "step")),
    };
    let mut causes = Vec::new();
    if let Some(plan) = &replanned.result.plan {
        let steps = counted(plan.steps.len() as u64, "step");
        lines.push(format!("nearest that works: {kept}, {steps} in all, verified (`darrt plan --from` writes it)"));
    } else {
        let iterations = counted(replanned.result.iterations, "iteration");
        lines.push(format!("{kept}, none was found that works in {iterations}"));
        causes = program.diagnose(&request, &replanned.result, &cancel).map_err(failed)?.causes;
        lines.extend(causes.iter().flat_map(diagnosis::text::of_cause));
    }
    if options.json {
        let answer = serde_json::json!({
            "plan": options.source,
            "wrong": refusal.as_ref().map(check::refusal),
            "is_partial": is_partial,
            "nearest": replanned.result.plan.as_ref().map(|plan| serde_json::json!({
                "first_kept": replanned.kept, "last_kept": replanned.tail, "steps": plan.steps.len() })),
            "iterations": replanned.result.iterations,
            "causes": causes,
        });
        output.print(&output::json(&answer, "the answer")?)?;
    } else {
        output.tell(&format!("{}: {}", options.source, lines.join("\n  ")))?;
    }
    Ok(Exit::NotSolved)
}

fn words(idea: &Idea, answer: &WhyNot) -> String {
    let mut lines = vec![match &answer.fault {
        None => format!("{}: nothing is wrong with it", answer.problem),
        Some(fault) => format!("{}: wrong first: {}", answer.problem, of_fault(fault)),
    }];
    match (&answer.fault, &answer.variant) {
        (None, Some(variant)) if matches!(idea, Idea::Hand { .. }) => {
            lines.push(format!("the robot then stands {}", standing(variant)));
        }
        (Some(_), Some(variant)) => {
            let far = match idea {
                Idea::State { .. } => format!(
                    "the base {} farther and turned by {:.1} degrees, the joints by {:.1} degrees at most",
                    metres(variant.away_m),
                    variant.turned_rad.to_degrees(),
                    variant.joint_most.to_degrees()
                ),
                Idea::Hand { .. } => format!(
                    "the hand {} farther and turned by {:.1} degrees",
                    metres(variant.away_m),
                    variant.turned_rad.to_degrees()
                ),
            };
            lines.push(format!("nearest found that works: {far}"));
            let [x, y, z, roll, pitch, yaw] = variant.tool;
            lines.push(format!("--tool {x:.4},{y:.4},{z:.4},{roll:.4},{pitch:.4},{yaw:.4}"));
            lines.push(standing(variant));
        }
        (Some(_), None) => lines.push("none was found nearby that works".to_owned()),
        (None, _) => {}
    }
    lines.join("\n  ")
}

/// As the options take it.
fn standing(variant: &Variant) -> String {
    let [x, y, yaw] = variant.base;
    let joints: Vec<_> = variant.joints.iter().map(|value| format!("{value:.4}")).collect();
    format!("--base {x:.4},{y:.4},{yaw:.4} --joints {}", joints.join(","))
}

fn metres(metres: f64) -> String {
    if metres < 0.1 { format!("{:.0} mm", metres * 1000.0) } else { format!("{metres:.2} m") }
}

fn of_fault(fault: &Fault) -> String {
    let Fault { wrong, names, by, is_angle, bases } = fault;
    let both = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" and ");
    let amount = by.map(|by| if *is_angle { format!("{:.1} degrees", by.to_degrees()) } else { metres(by) });
    let deep = amount.as_ref().map_or_else(
        || "are nearer to each other than their margin, or touch".to_owned(),
        |amount| format!("overlap by {amount}"),
    );
    let from = if *bases > 1 { format!(" (the best of {bases} bases tried)") } else { String::new() };
    match wrong {
        Wrong::Limit => format!("the joint {both} is {} beyond its limit", amount.unwrap_or_default()),
        Wrong::Bounds => match amount {
            Some(amount) => format!("the base is {amount} out of its bounds{from}"),
            None => format!("the base is out of its bounds{from}"),
        },
        Wrong::Base => format!("the base cannot stand there: {both} {deep}{from}"),
        Wrong::Robot => format!("{both} {deep}{from}"),
        Wrong::Hand => format!("the hand alone, without an arm: {both} {deep}"),
        Wrong::Grasp => {
            format!("it is no grasp of {both}: the nearest one that holds is {} away", amount.unwrap_or_default())
        }
        Wrong::Reach => format!("the arm reaches it from none of {} tried", counted(*bases, "base")),
        Wrong::Pick(stage) => {
            let object = names.first().map_or_else(String::new, |name| format!("`{name}`"));
            let way = names.get(1).map_or_else(String::new, |name| format!(", `{name}` is in the way"));
            let bases = counted(*bases, "base");
            match stage {
                Stage::Overhang => format!("the rim of {object} overhangs no edge, so it cannot be taken by it"),
                Stage::Hold => format!("no grasp of {object} holds it"),
                Stage::Support => format!("{object} does not stand on what it may stand on"),
                Stage::Room => format!("{object} itself has no room there{way}"),
                Stage::Hand => format!("the hand has no room at {object}{way}"),
                Stage::Approach => format!("there is no room for the straight way to {object}{way}"),
                Stage::Reach => format!("the arm reaches {object} so from none of {bases} tried"),
                Stage::Stand => format!("nowhere can the base stand from which {object} is reached so{way} ({bases})"),
                Stage::Arm => format!("the arm has no room where the hand takes {object} so{way} ({bases})"),
                Stage::Line => format!("hand and arm have no straight way to {object}, or up with it{way} ({bases})"),
                Stage::Drive => format!("the base cannot drive to where {object} is reached so"),
            }
        }
    }
}
