//! Judges the clock of a plan: can the robot follow it, is it slow where it must be, and is the curve that it follows free?
//!
//! What the file says of a clock is worked out here once more, from `docs/timed-plan.md` and not by the code that makes clocks.
//!
//! | question | file |
//! |---|---|
//! | where is the robot when, and how fast? | `curve` |
//! | do joints and base keep their limits? | here |
//! | does the hand, does the robot wait where it must? | `work` |
//! | which waypoints does the rounded curve have? | `rounded` |

mod curve;
mod rounded;
mod work;

use darrt_core::budget::Cancel;

use super::hands::Hands;
use super::judge::Judge;
use super::options::VerifyOptions;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::Robot;
use crate::clock::limits::{Bounds, MotionLimits};
use crate::plan_file::timing::{Phase, Timing};
use crate::plan_file::{PlanFile, Step};
use crate::robot::RobotFacts;
use curve::{Curve, Rates, points};

/// How far a limit of a joint or of the base may be exceeded, as a part of it: what rounding may do.
const ROUNDING: f64 = 1e-6;
/// A waypoint that is left out may be so far beside the line, rad or m of every coordinate.
const ON_LINE: f64 = 1e-5;
/// How fast a coordinate may jump where a corner is not rounded, rad/s or m/s: what rounding may do.
const JUMP: f64 = 1e-6;
/// At how many times a motion is looked at between two at which its jerk, its line or its corner changes.
const LOOKS: u32 = 4;

/// A step with its clock.
struct Timed<'a> {
    site: Site<'a>,
    step: &'a Step,
    /// With the hand of the step at work.
    robot: &'a Robot,
    phases: &'a [Phase],
    /// By waypoint: x, y, yaw, then the variables of the tree.
    points: Vec<Vec<f64>>,
    /// Seconds of the whole step.
    duration_s: f64,
}

impl Timed<'_> {
    /// A fault at `t_s` of the step.
    fn refusal(&self, t_s: f64, kind: RefusalKind, message: String) -> Refusal {
        let time = if self.duration_s > 0.0 { (t_s / self.duration_s).clamp(0.0, 1.0) } else { 0.0 };
        self.site.refusal(time, kind, message)
    }

    /// A waypoint that the clock leaves out lies on the line that it has there: the file says one motion.
    fn check_left_out(&self) -> Result<(), Refusal> {
        let mut begin_s = 0.0;
        for phase in self.phases {
            for pair in phase.knots.windows(2) {
                let [from, to] = *pair else { continue };
                let far = (from + 1..to).map(|at| (at, beside(&self.points, from, at, to)));
                if let Some((at, off)) = far.into_iter().find(|(_, off)| *off > ON_LINE) {
                    let text = format!(
                        "leaves out waypoint {at}, which is {off:.6} beside the line from {from} to {to}, at most {ON_LINE} is allowed"
                    );
                    return Err(self.refusal(begin_s, RefusalKind::Clock, text));
                }
            }
            begin_s += phase.duration_s();
        }
        Ok(())
    }

    /// Does it go elsewhere than in straight lines from waypoint to waypoint?
    fn rounds_corners(&self) -> bool {
        self.phases.iter().flat_map(|phase| &phase.blends).any(|radius| *radius > 0.0)
    }
}

/// How far the point `at` is beside the line between two others, in the coordinate in which it is farthest.
fn beside(points: &[Vec<f64>], from: usize, at: usize, to: usize) -> f64 {
    let (Some(a), Some(p), Some(b)) = (points.get(from), points.get(at), points.get(to)) else { return f64::INFINITY };
    let squares = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (y - x).powi(2)).sum::<f64>();
    let length = squares(a, b);
    let along = if length > 0.0 { (length + squares(a, p) - squares(p, b)) / (2.0 * length) } else { 0.0 };
    let along = along.clamp(0.0, 1.0);
    let off = |((a, b), p): ((&f64, &f64), &f64)| (a + along * (b - a) - p).abs();
    a.iter().zip(b).zip(p).map(off).fold(0.0, f64::max)
}

/// Judges the clock of a plan whose waypoints have been judged.
///
/// # Errors
/// The first fault.
pub(super) fn check(
    plan: &PlanFile,
    timing: &Timing,
    facts: &RobotFacts,
    options: &VerifyOptions,
    cancel: &Cancel,
) -> Result<(), Refusal> {
    crate::clock::check::check(plan, timing)
        .map_err(|error| Refusal::whole(RefusalKind::Clock, format!("the clock: {error}")))?;
    let limits = &facts.motion;
    if let Some((name, value)) = limits.flaw() {
        let text = format!("the robot's motion limit `{name}` is {value}, which is out of its range");
        return Err(Refusal::whole(RefusalKind::Problem, text));
    }
    let hands = Hands::new(facts)?;
    let bounds = joint_bounds(&hands.first, facts);
    let mut steps = Vec::with_capacity(plan.steps.len());
    for ((number, step), clock) in (1..).zip(&plan.steps).zip(&timing.steps) {
        let contract = plan.contracts.get(&step.primitive).copied().ok_or_else(|| {
            let text = format!("`contracts` says nothing of {}, a primitive of the plan", step.primitive);
            Refusal::whole(RefusalKind::Primitive, text)
        })?;
        let site = Site { step: number, primitive: &step.primitive, contract };
        let robot = &**hands.of_step(site, step, facts)?;
        let points = points(step, robot).map_err(|flaw| site.refusal(0.0, RefusalKind::Malformed, flaw))?;
        let timed = Timed { site, step, robot, phases: &clock.phases, points, duration_s: clock.duration_s() };
        timed.check_left_out()?;
        check_limits(&timed, limits, &bounds)?;
        work::check(&timed, plan, limits)?;
        steps.push(timed);
    }
    if !steps.iter().any(Timed::rounds_corners) {
        return Ok(());
    }
    let rounded = rounded::rounded(plan, &steps)?;
    // OPTIMIZATION: steps that stay as they are have been judged.
    let same = steps.iter().filter(|timed| !timed.rounds_corners()).map(|timed| timed.site.step);
    let judged = Judge::new(&rounded, facts, options, cancel)?.knowing(same).run();
    judged.map(|_| ()).map_err(|mut refusal| {
        refusal.message = format!("where the clock rounds corners: {}", refusal.message).into();
        refusal
    })
}

/// The limits of the variables of the tree: the description's speed, or a lower one that the robot names.
fn joint_bounds(robot: &Robot, facts: &RobotFacts) -> Vec<Bounds> {
    use darrt_primitives::kinematics::urdf::JointKind;
    let variables = robot.tree.variables().iter();
    let bounds = variables.map(|variable| {
        let joint = facts.description.joints.iter().find(|joint| joint.name == variable.name);
        let slides = joint.is_some_and(|joint| joint.kind == JointKind::Sliding);
        let mut bounds = if slides { facts.motion.sliding_joint } else { facts.motion.turning_joint };
        let described = joint.map_or(0.0, |joint| joint.max_velocity);
        let named = facts.motion.joint_velocities.iter().filter(|(name, _)| **name == *variable.name);
        let named = named.map(|(_, speed)| *speed).fold(f64::INFINITY, f64::min);
        match (described > 0.0, named < f64::INFINITY) {
            (true, _) => bounds.velocity = described.min(named),
            (false, true) => bounds.velocity = named,
            (false, false) => {}
        }
        bounds
    });
    bounds.collect()
}

/// Joints and base keep their limits all along.
fn check_limits(timed: &Timed<'_>, limits: &MotionLimits, joints: &[Bounds]) -> Result<(), Refusal> {
    let share = if timed.site.contract.begins_holding() { limits.loaded_base_share } else { 1.0 };
    let [drive, turn] = [limits.drive, limits.turn].map(|bounds| bounds.scaled(share));
    let mut begin_s = 0.0;
    for phase in timed.phases {
        let curve = Curve::new(phase, &timed.points);
        let arm = curve.moving().iter().filter_map(|coordinate| Some((*coordinate, coordinate.checked_sub(3)?)));
        let arm: Vec<_> = arm
            .filter_map(|(coordinate, joint)| {
                Some((coordinate, format!("`{}`", timed.robot.joint_name(joint)), joints.get(joint)?))
            })
            .collect();
        for (knot, t_s, jump) in curve.jumps(phase) {
            if jump > JUMP {
                let at = phase.knots.get(knot).copied().unwrap_or(knot);
                let text = format!("the velocity jumps by {jump:.6} at waypoint {at}, a corner that is not rounded");
                return Err(timed.refusal(begin_s + phase.wait_s + t_s, RefusalKind::Acceleration, text));
            }
        }
        for (t_s, jerk) in curve.looks(phase, LOOKS) {
            let rates = curve.rates(phase, t_s, jerk);
            let here_s = begin_s + phase.wait_s + t_s;
            within(timed, here_s, "the base's drive", &rates.over(&[0, 1]), &drive)?;
            within(timed, here_s, "the base's turn", &rates.over(&[2]), &turn)?;
            let wheels = rates.over(&[0, 1])[0] / drive.velocity + rates.over(&[2])[0] / turn.velocity;
            let one = Bounds { velocity: 1.0, ..Bounds::NONE };
            within(timed, here_s, "the sum of the shares of the base's drive and turn", &[wheels, 0.0, 0.0], &one)?;
            for (coordinate, name, bounds) in &arm {
                within(timed, here_s, name, &rates.over(&[*coordinate]), bounds)?;
            }
        }
        begin_s += phase.duration_s();
    }
    Ok(())
}

fn within(timed: &Timed<'_>, t_s: f64, what: &str, [v, a, j]: &[f64; 3], bounds: &Bounds) -> Result<(), Refusal> {
    let kinds = [
        (RefusalKind::Velocity, "velocity", v, bounds.velocity),
        (RefusalKind::Acceleration, "acceleration", a, bounds.acceleration),
        (RefusalKind::Jerk, "jerk", j, bounds.jerk),
    ];
    for (kind, word, found, bound) in kinds {
        // Written so that what is no number is at fault.
        let is_kept = *found <= bound * (1.0 + ROUNDING);
        if !is_kept {
            let text =
                format!("{what} has the {word} {found:.6} at {t_s:.3} s of the step, at most {bound} is allowed");
            return Err(timed.refusal(t_s, kind, text));
        }
    }
    Ok(())
}

impl Rates {
    /// Sizes of velocity, acceleration and jerk over these coordinates together.
    fn over(&self, coordinates: &[usize]) -> [f64; 3] {
        [&self.velocity, &self.acceleration, &self.jerk].map(|rates| {
            let squares = coordinates.iter().map(|i| rates.get(*i).copied().unwrap_or(0.0).powi(2));
            squares.sum::<f64>().sqrt()
        })
    }
}
