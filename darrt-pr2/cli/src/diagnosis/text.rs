//! One cause in words: a line, or a few that lead from one to the next.

use std::path::Path;

use darrt_task::diagnosis::cause::{Blocker, Cause, EdgeReach, Floor, Hands, Place, Pushes, Stage};
use darrt_task::diagnosis::relax::Relaxation;
use darrt_task::plan_file::{Partial, PlanFile};
use darrt_task::problem_file::GraspFamily;
use darrt_task::text::counted;

/// Bodies that are named.
const NAMED: usize = 3;
/// Edges that are told.
const EDGES: usize = 4;

/// The lines of a cause.
pub(crate) fn of_cause(cause: &Cause) -> Vec<String> {
    match cause {
        Cause::GoalOccupied { object, by, occupant, at: [x, y, z] } => {
            vec![format!("the goal of `{object}` at ({x:.3}, {y:.3}, {z:.3}) is taken by `{by}`{occupant}")]
        }
        Cause::InfeasibleGoal { object, lack } => vec![format!("the goal of `{object}` cannot be reached: {lack}")],
        Cause::MissingPrimitive { primitive, needs } => {
            vec![format!("`{primitive}` is made of `{needs}`, which is not among the primitives")]
        }
        Cause::NoRoom { object, tried, inside_m, wanted_m } => vec![match inside_m {
            Some(inside_m) => format!(
                "goals of `{object}`: 0 of {tried} on what it may stand on and far enough from the edges: {:.0} mm inside at \
                 best, {:.0} mm are kept",
                inside_m * 1000.0,
                wanted_m * 1000.0
            ),
            None => format!("goals of `{object}`: 0 of {tried} on what it may stand on"),
        }],
        Cause::NoHand { hands } => vec![of_hands(hands)],
        Cause::NoCommonGrasp { object, at_start, tries, blockers } => vec![format!(
            "`{object}` can be taken and set down, but by no grasp both: 0 of {at_start} grasps from the start fit one of \
             {tries} places at the goal{}",
            in_the_way(blockers)
        )],
        Cause::NoPush { pushes, edges } => of_pushes(pushes, edges),
        Cause::CutOff { object, place, floor } => vec![of_floor(object, *place, floor)],
        Cause::Behind { object, place, others } => vec![format!(
            "`{object}` {}: must wait until another object is moved: {} in the way",
            at(*place),
            names(others)
        )],
        Cause::NoRobotGoal { tried: 0, beyond_m: Some(metres), .. } => {
            vec![format!(
                "the goal of the robot: its tool is beyond the arm by {metres:.2} m or more from every base tried"
            )]
        }
        Cause::NoRobotGoal { tried: 0, .. } => {
            vec!["the goal of the robot: no base and arm were found that meet all its parts together".to_owned()]
        }
        Cause::NoRobotGoal { tried, blockers, .. } => {
            vec![format!("the goal of the robot: 0 of {tried} places free{}", in_the_way(blockers))]
        }
        Cause::Doubted { what } => vec![format!("doubted before the search, and not refuted: {what}")],
        Cause::InfeasibleRule { rule, lack } => vec![format!("`steer[{rule}]` requires what no step can do: {lack}")],
        Cause::Steered { steps } => vec![format!("`steer` forbids what was tried: {}", plain_names(steps))],
        Cause::Refused { reason } => vec![format!("a plan was found, but the verifier refused it: {reason}")],
    }
}

fn at(place: Place) -> &'static str {
    match place {
        Place::Start => "where it stands",
        Place::Goal => "at its goal",
        Place::Edge => "at an edge",
    }
}

/// `post 1, post 2 and post 6`, those with running numbers put together.
fn names(blockers: &[Blocker]) -> String {
    let mut shown: Vec<_> = blockers.iter().take(NAMED).map(|blocker| format!("`{}`", blocker.body)).collect();
    let last = shown.pop().unwrap_or_default();
    if shown.is_empty() { last } else { format!("{} and {last}", shown.join(", ")) }
}

/// `Push of plate 120 times and Pick of plate 7 times`.
fn plain_names(steps: &[Blocker]) -> String {
    let times = |step: &Blocker| format!("{} {}", step.body, counted(step.count, "time"));
    steps.iter().take(NAMED).map(times).collect::<Vec<_>>().join(", ")
}

fn in_the_way(blockers: &[Blocker]) -> String {
    if blockers.is_empty() { String::new() } else { format!(", {} in the way", names(blockers)) }
}

/// What becomes of the poses of the hand, at the last stage to which any of them came.
fn of_hands(hands: &Hands) -> String {
    let Hands { object, place, tried, blockers, bases, beyond_m, .. } = hands;
    let subject = match place {
        Place::Start => format!("grasps of `{object}` where it stands"),
        Place::Goal => format!("hand poses at the goal of `{object}`"),
        Place::Edge => format!("grasps of `{object}` at the edge"),
    };
    let (stage, bodies) = (hands.last_stage().unwrap_or(Stage::Hold), names(blockers));
    let came = hands.came_to(stage);
    let beyond = beyond_m.map(|metres| format!(" by {metres:.2} m or more"));
    match stage {
        Stage::Overhang => format!("`{object}` is only taken by its rim, which overhangs no edge {}", at(*place)),
        Stage::Hold => format!("{subject}: 0 of {tried} hold it"),
        Stage::Support => format!("{subject}: 0 of {tried} on what it may stand on"),
        Stage::Room => format!("{subject}: 0 of {came} with room for `{object}` itself, which meets {bodies}"),
        Stage::Hand => format!("{subject}: 0 of {came} free, the hand meets {bodies}"),
        Stage::Approach => format!("{subject}: 0 of {came} with room for the straight way there, {bodies} in the way"),
        Stage::Reach => match beyond {
            Some(beyond) => {
                format!("{subject}: 0 of {came} reachable, all beyond the arm{beyond} (from {bases} base poses)")
            }
            None => format!("{subject}: 0 of {came} reachable, from none of {bases} base poses"),
        },
        Stage::Stand => {
            let nearer = beyond.map_or_else(String::new, |beyond| format!("; they are too far in{beyond}"));
            format!(
                "{subject}: 0 of {came} reachable from where the base can stand: {bodies} in its way ({bases} base poses){nearer}"
            )
        }
        Stage::Arm => format!("{subject}: 0 of {came} free for the arm, which meets {bodies} ({bases} base poses)"),
        Stage::Line => format!(
            "{subject}: 0 of {came} with a straight way for hand and arm{} ({bases} base poses)",
            in_the_way(blockers)
        ),
        Stage::Drive => format!("{subject}: 0 of {came} from where the base can drive"),
    }
}

fn of_pushes(pushes: &Pushes, edges: &[EdgeReach]) -> Vec<String> {
    let Pushes { object, tried, made, blockers, unreachable, .. } = pushes;
    let mut ends = Vec::new();
    ends.extend(blockers.iter().take(NAMED).map(|b| format!("`{}` stops {}", b.body, share(b.count, *tried))));
    if *unreachable > 0 {
        ends.push(format!("{} are out of the arm's reach", share(*unreachable, *tried)));
    }
    let ends = if ends.is_empty() { String::new() } else { format!(": {}", ends.join(", ")) };
    if edges.is_empty() {
        return vec![format!("pushes of `{object}`: {made} of {tried} possible, none to where it helps{ends}")];
    }
    let first =
        format!("`{object}` must be at an edge to be taken by its rim; 0 of {tried} pushes bring it to one{ends}");
    let of_edge = |edge: &EdgeReach| {
        let [x, y] = edge.outward;
        let hands = of_hands(&edge.hands);
        let what = hands.split_once(": ").map_or(hands.as_str(), |(_, what)| what).to_owned();
        let what = if edge.hands.good > 0 { "can be taken there, if it came there".to_owned() } else { what };
        format!("edge of `{}` towards ({x:.1}, {y:.1}): {what}", edge.surface)
    };
    std::iter::once(first).chain(edges.iter().take(EDGES).map(of_edge)).collect()
}

fn share(count: u64, of: u64) -> String {
    format!("{:.0} %", 100.0 * count as f64 / of.max(1) as f64)
}

fn of_floor(object: &str, place: Place, floor: &Floor) -> String {
    let Floor { free_m2, cell_m, cell_rad, wanted, walls } = floor;
    format!(
        "the base is shut in: it has {free_m2:.2} square metres of floor, and none of {wanted} poses from which `{object}` is \
         reached {} is there{} (cells of {:.0} cm and {:.0} degrees)",
        at(place),
        in_the_way(walls),
        cell_m * 100.0,
        cell_rad.to_degrees()
    )
}

/// What the beginning of a plan leads to, and what remains.
pub(crate) fn of_partial(plan: &PlanFile, path: &Path) -> String {
    let steps = counted(plan.steps.len() as u64, "step");
    format!("its beginning is in {}: {steps}, {}", path.display(), of_parts(plan.partial.as_ref()))
}

/// Which parts of the goal hold, and which remain.
pub(crate) fn of_parts(partial: Option<&Partial>) -> String {
    let Some(Partial { met, remains, robot_remains }) = partial else { return "the whole goal holds".to_owned() };
    let met = if met.is_empty() {
        "no part of the goal holds".to_owned()
    } else {
        format!("the goal of {} holds", list(met))
    };
    let robot = robot_remains.then(|| "the robot's".to_owned());
    let objects = (!remains.is_empty()).then(|| format!("that of {}", list(remains)));
    let left: Vec<_> = objects.into_iter().chain(robot).collect();
    format!("{met}, {} remains", left.join(" and "))
}

/// A change in words.
pub(crate) fn of_relaxation(relaxation: &Relaxation) -> String {
    match relaxation {
        Relaxation::HardLimits => "with `robot.limits = \"hard\"`".to_owned(),
        Relaxation::Lift { to_m } => format!("with `robot.torso_m = {to_m:.2}`"),
        Relaxation::Allow { primitive } => format!("with `{primitive}` among the primitives"),
        Relaxation::Grasp { object, family } => format!("with {} grasps of `{object}`", family_name(*family)),
        Relaxation::Shorter { key, least_m } => format!("with {least_m} m as the least of `{key}`"),
        Relaxation::LessMargin { to_m } => format!("with `safety.least_margin_m = {to_m}`"),
        Relaxation::Tolerance { object, to_m } => format!("with `tolerance_m = {to_m}` at the goal of `{object}`"),
        Relaxation::Lean { object, to_deg } => format!("with `max_tilt_deg = {to_deg}` of `{object}`"),
        Relaxation::WiderBounds { by_m } => format!("with `bounds` wider by {by_m} m"),
        Relaxation::Lower { obstacle, by_m } => format!("with `{obstacle}` lower by {by_m:.2} m"),
        Relaxation::Shrink { obstacle, share } => format!("with `{obstacle}` at {:.0} % of its size", share * 100.0),
        Relaxation::Without { obstacles } => format!("without {}", list(obstacles)),
        Relaxation::WithoutObject { object } => format!("without `{object}`"),
        Relaxation::WithoutGoal { object: Some(object) } => format!("without the goal of `{object}`"),
        Relaxation::WithoutGoal { object: None } => "without the goal of the robot".to_owned(),
        Relaxation::WithoutRule { index } => format!("without `steer[{index}]`"),
        Relaxation::MoreTime { iterations } => format!("with {iterations} iterations"),
    }
}

fn family_name(family: GraspFamily) -> &'static str {
    match family {
        GraspFamily::Rim => "rim",
        GraspFamily::Overhead => "overhead",
        GraspFamily::Side => "side",
    }
}

/// `a`, `b` and `c`.
fn list(names: &[String]) -> String {
    let mut shown: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
    let last = shown.pop().unwrap_or_default();
    if shown.is_empty() { last } else { format!("{} and {last}", shown.join(", ")) }
}
