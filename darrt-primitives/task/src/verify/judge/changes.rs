//! What differs between two waypoints, and whether the step may change it.

use std::f64::consts::TAU;

use darrt_primitives::contract::HandUse;
use nalgebra::Vector3;

use super::{Judge, Place, Trial};
use crate::verify::motion::{Changes, Segment};
use crate::verify::refusal::{Refusal, RefusalKind};
use crate::verify::robot::Role;

/// How far a base that drives along its heading may be off it, metres and radians.
const ALONG: f64 = 1e-6;
/// How far the hand opens at least to let go, metres.
const LET_GO_M: f64 = 8e-4;

impl<'a> Judge<'a> {
    /// Only what the step moves differs between the ends of a segment.
    pub(super) fn check_changes(&self, trial: &Trial<'a>, place: Place, segment: &Segment<'_>) -> Result<(), Refusal> {
        let site = trial.site;
        let stray = |text: String| Err(site.refusal(place.time(0.0), RefusalKind::Stray, text));
        if let Some(what) = segment.half_turn(&self.robot) {
            let text = format!("{what} turns by half a turn, so that neither way is the shorter one");
            return Err(site.refusal(place.time(0.0), RefusalKind::Joints, text));
        }
        let changes = segment.changes(&self.robot);
        if let Some(joint) = changes.parked {
            return stray(format!("`{}` moves, but must stand still", self.robot.joint_name(joint)));
        }
        if !site.contract.is_free() {
            let moved = segment.joints.iter().zip(&self.robot.roles).zip(&self.robot.is_own);
            let other = moved.into_iter().position(|((way, role), own)| *way != 0.0 && *role == Role::Arm && !own);
            if let Some(joint) = other {
                return stray(format!(
                    "`{}` moves, which does not move the hand of `{}`: at an object one hand goes alone",
                    self.robot.joint_name(joint),
                    self.robot.tool_name()
                ));
            }
        }
        if changes.base && self.robot.is_bolted {
            return stray("the base moves, which is bolted down".to_owned());
        }
        if changes.base
            && self.robot.drives_along_heading
            && let Some(how) = off_heading(&segment.from.base, &segment.to.base, self.options.rounding.max(ALONG))
        {
            return stray(format!("the base drives along its heading only, and {how}"));
        }
        if changes.base && !site.contract.drives() {
            return stray(format!("the base moves in {}", site.primitive));
        }
        if changes.arm && site.contract.drives() {
            let joint = segment.joints.iter().zip(&self.robot.roles).position(|(d, r)| *d != 0.0 && *r == Role::Arm);
            let name = joint.map_or("the arm", |joint| self.robot.joint_name(joint));
            return stray(format!("`{name}` moves in {}", site.primitive));
        }
        check_finger(trial, place, changes)?;
        for (object, (a, b)) in segment.from.objects.iter().zip(&segment.to.objects).enumerate() {
            let is_held = trial.act.holding.is_some_and(|holding| holding.object == object);
            if a == b || is_held {
                continue;
            }
            let name = self.world.object_name(object);
            if trial.act.pushed != Some(object) {
                return stray(format!("{name} moves, but the step does not move it"));
            }
            let slack = self.options.rounding;
            let risen = (a.translation.z - b.translation.z).abs();
            let lean = (a.rotation * Vector3::z()).angle(&(b.rotation * Vector3::z()));
            if risen > slack || lean > slack.max(1e-7) {
                let text = format!(
                    "{name} is pushed and must neither rise nor lean; it rises {risen:.6} m, leans {lean:.6} rad"
                );
                return Err(site.refusal(place.time(1.0), RefusalKind::Push, text));
            }
            if changes.finger != 0.0 {
                return stray(format!("{name} is pushed by the opening hand"));
            }
        }
        Ok(())
    }
}

/// How a straight move of the base is none along its heading, nor a turn on the spot; `None` if it is one.
fn off_heading(from: &[f64; 3], to: &[f64; 3], slack: f64) -> Option<String> {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    if x.hypot(y) <= slack {
        return None;
    }
    let turned = (to[2] - from[2]).rem_euclid(TAU);
    let turned = turned.min(TAU - turned);
    if turned > slack {
        return Some(format!("it turns by {:.3} degrees while it drives {:.3} m", turned.to_degrees(), x.hypot(y)));
    }
    let (sin, cos) = from[2].sin_cos();
    let sideways = (cos * y - sin * x).abs();
    (sideways > slack).then(|| format!("it moves {:.3} mm sideways", 1e3 * sideways))
}

/// The hand opens and closes alone, at the ends of steps, and only where it must while something is held.
fn check_finger(trial: &Trial<'_>, place: Place, changes: Changes) -> Result<(), Refusal> {
    let refuse =
        |text: &str| Err(trial.site.refusal(place.time(0.0), RefusalKind::Gripper, format!("the hand {text}")));
    let opens = changes.finger;
    if opens != 0.0 && (changes.arm || changes.base) {
        return refuse("opens or closes while arm or base move");
    }
    match trial.site.contract.hand {
        HandUse::Takes if place.is_first() && opens >= 0.0 => {
            refuse("must close between the first two waypoints of the step that takes an object")
        }
        HandUse::Takes if !place.is_first() && opens != 0.0 => refuse("opens or closes after it has picked"),
        HandUse::LetsGo if place.is_last() && opens < LET_GO_M => {
            refuse("must open between the last two waypoints of the step that lets go of an object")
        }
        HandUse::LetsGo if !place.is_last() && opens != 0.0 => refuse("opens or closes before it has placed"),
        HandUse::Takes | HandUse::LetsGo => Ok(()),
        _ if opens != 0.0 && trial.act.holding.is_some() => refuse("opens or closes on what it carries"),
        _ if opens != 0.0 && !place.is_first() && !place.is_last() => refuse("opens or closes in the middle of a step"),
        _ => Ok(()),
    }
}
