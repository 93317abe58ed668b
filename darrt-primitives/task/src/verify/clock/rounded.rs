//! The plan with the waypoints of the curve that its clock follows.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Timed;
use super::curve::Curve;
use crate::plan_file::{PlanFile, Pose, Step, Waypoint};
use crate::verify::motion::turn_between;
use crate::verify::refusal::{Refusal, RefusalKind};
use crate::verify::robot::world_from_robot;
use crate::verify::world::World;

/// How far the curve of a corner may be from the straight lines that are judged in its place, metres.
const CHORD_M: f64 = 5e-5;
/// Most lines for a corner.
const MOST_CHORDS: f64 = 64.0;
/// Places nearer to each other than this are one, as a part of the radius of a corner.
const SAME: f64 = 1e-6;

/// The same plan, without a clock, in which every phase goes along its curve: straight lines, and corners cut into short ones.
pub(super) fn rounded(plan: &PlanFile, steps: &[Timed<'_>]) -> Result<PlanFile, Refusal> {
    let world = World::new(&plan.problem)?;
    let mut out = PlanFile { timing: None, ..plan.clone() };
    for (step, timed) in out.steps.iter_mut().zip(steps) {
        if timed.rounds_corners() {
            step.waypoints = waypoints(timed, &world)?;
        }
    }
    Ok(out)
}

fn waypoints(timed: &Timed<'_>, world: &World<'_>) -> Result<Vec<Waypoint>, Refusal> {
    let (step, robot) = (timed.step, timed.robot);
    let held_m = step.holds.as_ref().map_or(0.0, |hold| {
        let held = world.object(&hold.object).and_then(|object| world.movables.get(object));
        let reach = held.map_or(0.0, |held| held.solid.reach());
        Vector3::from(hold.tool_from_object.position).norm() + reach
    });
    let rates = robot.travel_rates(&robot.extents(held_m));
    let lost = || timed.refusal(0.0, RefusalKind::Clock, "the clock names a waypoint that is not there".to_owned());
    let mut out: Vec<Waypoint> = step.waypoints.first().cloned().into_iter().collect();
    for phase in timed.phases {
        let curve = Curve::new(phase, &timed.points);
        let mut last = 0.0;
        for (place, knot) in phase.knots.iter().enumerate().skip(1) {
            let radius = curve.radius(place);
            if radius <= 0.0 {
                out.push(step.waypoints.get(*knot).cloned().ok_or_else(lost)?);
                continue;
            }
            let mark = curve.at_knot(place);
            let [a, b, c] = [mark - radius, mark, mark + radius].map(|gone| curve.at(gone));
            let corner = timed.points.get(*knot).ok_or_else(lost)?;
            // The curve passes the corner by 3/8 of how far the middle of its ends does, and n chords by 2 / n^2 of that.
            let bend: Vec<f64> =
                a.iter().zip(&c).zip(corner).map(|((a, c), at)| 0.375 * ((a + c) / 2.0 - at)).collect();
            debug_assert!(b.iter().zip(corner).zip(&bend).all(|((b, at), bend)| (b - at - bend).abs() < 1e-6));
            let chords = (2.0 * travel_m(&bend, &rates) / CHORD_M).sqrt().ceil().clamp(2.0, MOST_CHORDS);
            let mut i = 0.0;
            while i <= chords {
                let gone = mark - radius + 2.0 * radius * i / chords;
                i += 1.0;
                // Where two corners meet.
                if gone - last <= SAME * radius {
                    continue;
                }
                last = gone;
                out.push(waypoint(timed, phase.knots.as_slice(), &curve, gone).ok_or_else(lost)?);
            }
        }
    }
    Ok(out)
}

/// How far anything travels at most while the coordinates change by so much, metres.
fn travel_m(change: &[f64], rates: &[f64]) -> f64 {
    let [x, y, yaw] = [0, 1, 2].map(|i| change.get(i).copied().unwrap_or(0.0));
    let turns = change.iter().skip(3).chain([&yaw]).zip(rates).map(|(turn, rate)| turn.abs() * rate);
    x.hypot(y) + turns.sum::<f64>()
}

/// Where everything is when so much of a phase has been gone.
fn waypoint(timed: &Timed<'_>, knots: &[usize], curve: &Curve<'_>, gone: f64) -> Option<Waypoint> {
    let robot = timed.robot;
    let Step { holds, pushes, waypoints, .. } = timed.step;
    let point = curve.at(gone);
    let (line, share) = curve.pace(gone);
    let (from, to) = (waypoints.get(*knots.get(line)?)?, waypoints.get(*knots.get(line + 1)?)?);
    let base = [0, 1, 2].map(|i| point.get(i).copied().unwrap_or(0.0));
    let variables = point.get(3..)?;
    let mut objects = from.objects.clone();
    if let Some(hold) = holds {
        let mut links = Vec::new();
        robot.link_poses(variables, &mut links);
        let world_from_tool = world_from_robot(&base) * *links.get(robot.tool)?;
        *objects.get_mut(hold.object.as_str())? = (world_from_tool * Isometry3::from(hold.tool_from_object)).into();
    }
    if let Some(name) = pushes {
        let slid = slid(from.objects.get(name.as_str())?, to.objects.get(name.as_str())?, share);
        *objects.get_mut(name.as_str())? = slid;
    }
    Some(Waypoint { base, joints: robot.table.complete(variables), objects })
}

/// An object that slides goes straight, or about the one vertical axis about which it turns so far.
fn slid(from: &Pose, to: &Pose, share: f64) -> Pose {
    let (a, b): (Isometry3<f64>, Isometry3<f64>) = ((*from).into(), (*to).into());
    let turn = turn_between(&a, &b);
    let mut pose = a;
    pose.translation.vector = a.translation.vector.lerp(&b.translation.vector, share);
    if turn != 0.0 {
        let chord = b.translation.vector - a.translation.vector;
        let left = Vector3::new(-chord.y, chord.x, 0.0);
        let axis = a.translation.vector + chord / 2.0 + left / (2.0 * (turn / 2.0).tan());
        let part = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn * share);
        let mut at = axis + part * (a.translation.vector - axis);
        at.z = pose.translation.z;
        pose = Isometry3::from_parts(at.into(), part * a.rotation);
    }
    pose.into()
}
